"""One valid call of every public name, from operators to studies."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from pymoo.core.callback import Callback
from pymoo.core.evaluator import Evaluator
from pymoo.termination import get_termination
from world import Call, World

import pymoo_gridpath.study.running.runner
from pymoo_gridpath import (
    algorithms,
    cli,
    convergence,
    decision,
    explorer,
    operators,
    plotting,
    progress,
    study,
)
from pymoo_gridpath.study.planning.expand import plan_study


def _operators(w: World) -> dict[str, Call]:
    X = w.rows(w.problem)[:4].reshape(2, 2, -1)
    rows = w.rows(w.problem)
    bits = w.rows(w.codings["binary"]).astype(bool)
    bounds = {"xl": w.problem.xl, "xu": w.problem.xu}
    cross = {"prob": 0.9, "n_offsprings": 2}
    seed = {"random_state": w.random}
    sbx, mutation = operators.DiscreteSBX(), operators.DiscretePolynomialMutation()
    selection, splice, vary = operators.SmoothnessTournament(), operators.SpliceCrossover(), operators.PathMutation()
    return {
        "paper_operators": (operators.paper_operators, {"problem": w.problem, "eta_crossover": 5.0, "eta_mutation": 9.0}),
        "path_operators": (operators.path_operators, {"problem": w.problem, "sampling": "random"}),
        "cell_operators": (operators.cell_operators, {"problem": w.codings["cells"], "printed": ["start"]}),
        "default_operators": (operators.default_operators, {"problem": w.problem}),
        "RandomSampling": (operators.RandomSampling, {}),
        "DiscreteSBX": (operators.DiscreteSBX, {"eta": 5.0, "prob_var": 0.4, **cross}),
        "DiscreteSBX.cross": (sbx.cross, {"X": X, **bounds, **seed}),
        "PointCrossover": (operators.PointCrossover, {"n_points": 2, **cross}),
        "PointCrossover.cross": (operators.PointCrossover(2).cross, {"X": X, **seed}),
        "SinglePointCrossover": (operators.SinglePointCrossover, {"prob": 0.9}),
        "SinglePointCrossover.cross": (operators.SinglePointCrossover().cross, {"X": X, **seed}),
        "TwoPointCrossover": (operators.TwoPointCrossover, {"prob": 0.9}),
        "TwoPointCrossover.cross": (operators.TwoPointCrossover().cross, {"X": X, **seed}),
        "MixedCrossover": (operators.MixedCrossover, {"eta": 5.0, "prob_var": 0.4, **cross}),
        "DiscretePolynomialMutation": (operators.DiscretePolynomialMutation, {"eta": 5.0, "prob_var": 0.4, "prob": 0.9}),
        "DiscretePolynomialMutation.mutate": (mutation.mutate, {"X": rows, **bounds, "rate": 0.5, **seed}),
        "BitwiseMutation": (operators.BitwiseMutation, {"prob_var": 0.4, "final": 0.1, "prob": 0.9}),
        "BitwiseMutation.flip": (operators.BitwiseMutation().flip, {"X": bits, "rate": 0.5, **seed}),
        "BitwiseMutation.decay": (operators.BitwiseMutation().decay, {"algorithm": w.result.algorithm}),
        "MixedMutation": (operators.MixedMutation, {"eta": 5.0, "prob_var": 0.4, "final": 0.1, "prob": 0.9}),
        "EdgeFixing": (operators.EdgeFixing, {}),
        "ReachableSampling": (operators.ReachableSampling, {"roughness": 2.0, "detour": 1.5}),
        "ScalarizedSampling": (operators.ScalarizedSampling, {"noise": 0.3}),
        "SpliceCrossover": (operators.SpliceCrossover, {"reach": 3, **cross}),
        "PathMutation": (operators.PathMutation, {"ways": None, "margin": 8, "max_expansions": 100, "prob": 0.9}),
        "PathRepair": (operators.PathRepair, {}),
        "GreedySampling": (operators.GreedySampling, {"greedy": True}),
        "SharedCellCrossover": (operators.SharedCellCrossover, cross),
        "CellMutation": (operators.CellMutation, {"prob_var": 0.1, "regrow": 0.4, "anywhere": False, "prob": 0.9}),
        "TimedSampling": (operators.TimedSampling, {"noise": 0.3}),
        "RandomTimedSampling": (operators.RandomTimedSampling, {"roughness": 2.0, "detour": 1.5}),
        "TimedCrossover": (operators.TimedCrossover, {"reach": 3, **cross}),
        "TimedMutation": (operators.TimedMutation, {"ways": None, "shift": 2, "max_expansions": 100, "prob": 0.9}),
        "TimedRepair": (operators.TimedRepair, {}),
        "RouletteSelection": (operators.RouletteSelection, {"literal": False, "damping": 100.0}),
        "ElitistSurvival": (operators.ElitistSurvival, {"damping": 100.0}),
        "SmoothnessTournament": (operators.SmoothnessTournament, {}),
        "RankAndSmoothness": (operators.RankAndSmoothness, {"distinct": False, "band": 0.01}),
        "RowDuplicates": (operators.RowDuplicates, {}),
        "ArrayMating": (
            operators.ArrayMating,
            {
                "selection": selection,
                "crossover": splice,
                "mutation": vary,
                "repair": operators.PathRepair(),
                "n_max_iterations": 10,
            },
        ),
    }


def _algorithms(w: World) -> dict[str, Call]:
    algorithm = algorithms.make_algorithm("NSGA2", w.problem, pop_size=12)
    return {
        "make_algorithm": (
            algorithms.make_algorithm,
            {
                "name": "NSGA2",
                "problem": w.problem,
                "pop_size": 12,
                "smoothness": True,
                "operators": operators.default_operators(w.problem),
                "n_offsprings": 12,
            },
        ),
        "AntColony": (algorithms.AntColony, {"pop_size": 10, "evaporation": 0.2, "beta": 1.0}),
        "BeeColony": (algorithms.BeeColony, {"pop_size": 10, "limit": 20}),
        "PathOutput": (algorithms.PathOutput, {"distance": False}),
        "ExactFront": (
            algorithms.ExactFront,
            {"max_seconds": 1.0, "max_labels": 1000, "max_memory": 10**8, "watch": lambda meter: False, "epsilon": 0.02},
        ),
        "minimize_runs": (
            algorithms.minimize_runs,
            {
                "problem": w.problem,
                "algorithm": algorithm,
                "termination": ("n_gen", 2),
                "n_runs": 1,
                "seed": 1,
                "callback": convergence.ConvergenceRecorder(),
                "observe": lambda k, algorithm: True,
                "executor": None,
            },
        ),
        "ahmed_deb_2013": (
            algorithms.ahmed_deb_2013,
            {
                "grid": w.grid,
                **w.query,
                "representation": "integer",
                "objectives": ["length", "vulnerability"],
                "pop_size": 12,
                "n_gen": 2,
                "penalty": 3.0,
                "termination": get_termination("n_gen", 2),
                "axis": "x",
            },
        ),
        "variable_length_ga": (
            algorithms.variable_length_ga,
            {
                "grid": w.grid,
                **w.query,
                "pop_size": 12,
                "n_gen": 2,
                "printed": ["start", "roulette"],
                "termination": get_termination("n_gen", 2),
                "max_cells": 40,
            },
        ),
        "VariableLengthGA": (
            algorithms.VariableLengthGA,
            {
                "pop_size": 12,
                "printed": ["start", "roulette"],
                "output": algorithms.PathOutput(),
                "evaluator": Evaluator(),
                "callback": Callback(),
                "termination": get_termination("n_gen", 2),
                "seed": 1,
            },
        ),
        "Setup": (algorithms.Setup, {"problem": w.problem, "algorithm": algorithm, "termination": get_termination("n_gen", 2)}),
        "FirstLegalPath": (algorithms.FirstLegalPath, {"n_max_gen": 5}),
        "SmoothMOEAD": (
            algorithms.SmoothMOEAD,
            {
                "ref_dirs": algorithms.reference_directions(2, 12),
                "smoothness": True,
                "normalize": True,
                "n_replace": 3,
                "batch_size": 4,
                "band": 0.01,
            },
        ),
        "StrengthAndSmoothness": (algorithms.StrengthAndSmoothness, {}),
        "StrengthTournament": (algorithms.StrengthTournament, {}),
        "reference_directions": (algorithms.reference_directions, {"n_obj": 3, "n_points": 20}),
        "capability_table": (algorithms.capability_table, {}),
        "Capability.takes": (algorithms.CAPABILITIES["NSGA2"].takes, {"n_obj": 2}),
        "Capability": (algorithms.Capability, dict(vars(algorithms.CAPABILITIES["NSGA2"]))),
    }


def _results(w: World) -> dict[str, Call]:
    trade_off = w.trade_off
    line = trade_off[0].waypoints()
    settings = {"settings": {"note": "a"}}
    F = np.array([[0.0, 4.0], [1.0, 1.0], [4.0, 0.0]])
    return {
        "ConvergenceRecorder": (convergence.ConvergenceRecorder, {"reference_point": np.array([20.0, 20.0])}),
        "ConvergenceRecorder.hypervolume": (w.recorder.hypervolume, {"reference_point": np.array([30.0, 30.0])}),
        "common_reference_point": (convergence.common_reference_point, {"recorders": [w.recorder], "margin": 0.1}),
        "TradeOffSet": (decision.TradeOffSet, {"problem": w.problem, "X": w.legal_rows, "meta": {"a": 1}, "band": 0.01}),
        "TradeOffSet.from_genes": (
            decision.TradeOffSet.from_genes,
            {"problem": w.problem, "X": w.legal_rows, **settings, "band": 0.01},
        ),
        "TradeOffSet.from_results": (decision.TradeOffSet.from_results, {"results": [w.result], **settings, "band": 0.01}),
        "TradeOffSet.index": (trade_off.index, {"name": "knee"}),
        "TradeOffSet.names": (trade_off.names, {"index": 0}),
        "TradeOffSet.table": (trade_off.table, {"max_rows": 3}),
        "TradeOffSet.to_csv": (trade_off.to_csv, {"path": w.folder / "set.csv"}),
        "TradeOffSet.to_pandas": (trade_off.to_pandas, {}),
        "TradeOffSet.to_json": (trade_off.to_json, {"path": w.folder / "again.json"}),
        "PathRecord": (decision.PathRecord, trade_off[0].as_dict()),
        "PathRecord.as_dict": (trade_off[0].as_dict, {}),
        "PathRecord.waypoints": (trade_off[0].waypoints, {"tolerance": 0.1, "spacing": 0.5}),
        "Waypoints": (algorithms.Waypoints, {"grid": w.grid, "cells": np.array([[0, 0], [5, 0], [7, 5]])}),
        "Waypoints.resampled": (line.resampled, {"spacing": 0.5}),
        "Waypoints.to_csv": (line.to_csv, {"path": w.folder / "line.csv"}),
        "Waypoints.to_f1tenth": (line.to_f1tenth, {"path": w.folder / "raceline.csv", "speed": 2.0}),
        "Waypoints.to_nav_path": (line.to_nav_path, {"path": w.folder / "line.yaml", "frame_id": "odom"}),
        "knee_point": (decision.knee_point, {"F": F}),
        "load_json": (decision.load_json, {"path": w.json, "problem": w.problem}),
        "save_page": (explorer.save_page, {"trade_off": trade_off, "file": w.folder / "page.html", "title": "a"}),
        "explore": (explorer.explore, {"trade_off": trade_off, "title": "a", "height": 500}),
        "Explorer": (explorer.Explorer, {"trade_off": trade_off, "title": "a", "height": 500}),
        "plot_map": (
            plotting.plot_map,
            {"grid": w.grid, "potential": w.field, **w.query, "units": "m", "legend": True, "ax": None},
        ),
        "animate_moving": (
            plotting.animate_moving,
            {
                "run": w.moving_clock,
                "file": w.folder / "moving.gif",
                "reference": True,
                "potential": False,
                "units": "m",
                "fps": 2.0,
                "dpi": 10.0,
            },
        ),
        "plot_paths": (
            plotting.plot_paths,
            {
                "trade_off": trade_off,
                "which": ["knee"],
                "all_paths": True,
                "potential": w.field,
                "units": "m",
                "legend": True,
                "ax": None,
            },
        ),
        "plot_front": (
            plotting.plot_front,
            {
                "trade_off": trade_off,
                "reference": F + 9.0,
                "which": ["knee"],
                "objectives": ["length", "vulnerability"],
                "reference_label": "true",
                "ax": None,
            },
        ),
        "plot_convergence": (
            plotting.plot_convergence,
            {
                "history": [w.recorder],
                "quantity": "hypervolume",
                "reference_point": np.array([30.0, 30.0]),
                "label": "a",
                "color": "red",
                "ax": None,
            },
        ),
        "save_figures": (
            plotting.save_figures,
            {
                "trade_off": trade_off,
                "directory": w.folder / "figures",
                "history": None,
                "reference": F + 9.0,
                "formats": ["png"],
                "units": "m",
                "dpi": 20,
            },
        ),
        "Progress": (progress.Progress, {"n_runs": 1, "n_gen": 2, "stream": None, "interval": 0.1}),
        "Progress.note": (progress.Progress(1, 2).note, {"text": "a"}),
        "Progress.update": (progress.Progress(1, 2).update, {"run": 0, "algorithm": w.result.algorithm, "n_legal": len}),
        "main": (_command_line, {"argv": ["info", str(w.text_map)]}),
    }


def _command_line(argv):
    try:
        return cli.main(argv)
    except SystemExit as error:
        if error.code not in (0, 2):
            raise AssertionError(f"the command line ended with {error.code!r}") from None


def _studies(w: World) -> dict[str, Call]:
    plan = plan_study(w.study)
    key = plan.runs[0].key
    run = w.store.read(key)
    budget = {"generations": 2}
    own = vars(w.study)
    given = {"problems": own["problems"], "algorithms": own["algorithms"], "seeds": 1, "budget": budget}
    query = {"start": (0, 0), "goal": (7, 5)}
    return {
        "load_study": (study.load_study, {"path": w.toml}),
        "compare": (study.compare, {"results": [("small", "NSGA2", w.result)], "name": "a", "target": 0.9, "times": False}),
        "Study": (study.Study, {**given, "name": "a", "target": 0.9, "folder": w.folder, "reference": own["reference"]}),
        "Study.error": (w.study.error, {"message": "wrong", "where": ("problems", 0)}),
        "Study.from_dict": (study.Study.from_dict, {"data": w.study.to_dict()}),
        "Study.line": (w.study.line, {"where": ("problems", 0)}),
        "plan_study": (study.plan_study, {"study": w.study}),
        "Study.to_dict": (w.study.to_dict, {}),
        "ProblemSpec": (
            study.ProblemSpec,
            {
                "name": "a",
                "grid": w.grid,
                **query,
                "radius": 0.0,
                "footprint": [(0.1, 0.0), (-0.1, 0.1), (-0.1, -0.1)],
                "objectives": ["length", "turn"],
                "representation": "cells",
                "obstacles": "penalty",
                "penalty": 3.0,
                "axis": "auto",
            },
        ),
        "RandomFamily": (study.RandomFamily, {"size": 8, "p0": 0.2, "seeds": [1, 2], "corner_cutting": True}),
        "MovingObstacles": (study.MovingObstacles, {"movers": [[(3, 3), (3, 4)]], "every": 2, "epochs": 3}),
        "MovingObstacles.ways": (study.MovingObstacles(movers=[[(3, 3)]]).ways, {}),
        "QueryRange": (study.QueryRange, {"first": 0, "last": 5, "step": 2}),
        "AlgorithmSpec": (
            study.AlgorithmSpec,
            {
                "algorithm": "NSGA2",
                "name": "a",
                "pop_size": 12,
                "smoothness": True,
                "operators": "default",
                "parameters": {"n_offsprings": 12},
                "representation": "integer",
                "obstacles": "penalty",
                "penalty": 3.0,
                "axis": "x",
            },
        ),
        "run_study": (
            study.run_study,
            {
                "plan": plan,
                "folder": w.store.folder,
                "executor": None,
                "retry_failed": False,
                "study": "a",
                "stream": None,
                "tell": lambda line: None,
            },
        ),
        "Outcome": (
            pymoo_gridpath.study.running.runner.Outcome,
            {"n_planned": 1, "n_done_before": 1, "n_run": 1, "n_failed": 0, "messages": []},
        ),
        "LocalProcesses": (study.LocalProcesses, {"n_processes": 2}),
        "LocalProcesses.check": (study.LocalProcesses(1).check, {}),
        "LocalProcesses.recover": (study.LocalProcesses(1).recover, {"error": ValueError("a")}),
        "LocalProcesses.abort": (study.LocalProcesses(1).abort, {}),
        # Nobody answers at this address: the valid call is refused as well.
        "dask_executor": (study.dask_executor, {"address": "tcp://127.0.0.1:9", "timeout": 0.2}),
        "Store": (study.Store, {"folder": w.store.folder}),
        "Store.check": (w.store.check, {"keys": [key], "set_aside": False}),
        "Store.lock": (w.store.lock, {}),
        "Store.path": (w.store.path, {"key": key}),
        "Store.read": (w.store.read, {"key": key, "genes": True}),
        "Store.read_grid": (w.store.read_grid, {"planned": plan.problems[0]}),
        "Store.read_original": (w.store.read_original, {"planned": plan.problems[0]}),
        "Store.read_plan": (w.store.read_plan, {}),
        "Store.write": (w.store.write, {"key": key, "data": w.store.path(key).read_bytes()}),
        "Store.write_plan": (w.store.write_plan, {"plan": plan, "study": "a"}),
        "RunRecord": (study.RunRecord, _fields_of(run)),
        "History": (study.History, _fields_of(run.history)),
        "History.front": (run.history.front, {"k": 0}),
        "write_report": (
            study.write_report,
            {"folder": w.store.folder, "output": w.folder / "report", "target": 0.9, "formats": ["png"], "times": False},
        ),
    }


def _fields_of(thing) -> dict[str, Any]:
    return {field.name: getattr(thing, field.name) for field in dataclasses.fields(thing) if field.init}


CALLS = (_operators, _algorithms, _results, _studies)
