"""One valid call of every public name, and which names are public."""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import itertools
import pkgutil
import re
from collections.abc import Callable, Iterator
from functools import cached_property, partial
from pathlib import Path
from typing import Any, cast

import numpy as np
from pymoo.optimize import minimize
from pymoo.termination import get_termination

import pymoo_gridpath
import pymoo_gridpath.study.running.runner
from pymoo_gridpath import (
    GridPathProblem,
    OccupancyGrid,
    algorithms,
    cli,
    convergence,
    decision,
    exact,
    fields,
    maps,
    objectives,
    operators,
    plotting,
    problems,
    progress,
    quality,
    representations,
    study,
)
from pymoo_gridpath.maps.shipped import ShippedMap
from pymoo_gridpath.paths import CellPaths, ColumnPaths
from pymoo_gridpath.paths.frame import MonotoneFrame
from pymoo_gridpath.study.planning.expand import plan_study

REFERENCE = Path(__file__).resolve().parents[2] / "docs" / "reference.md"

#: Kernels, which trust their callers; the reference does not list them.
INTERNAL = ("pymoo_gridpath.search", "pymoo_gridpath.testing")

# What extensions are made of. It is called with what the package hands over, and does not check that.
BUILDING_BLOCKS = (
    "CountedPath",
    "CountedSearch",
    "QuadrantPaths",
    "Waypoints",
    "Moves",
    "Plan",
    "ReferenceFront",
    "Registry",
    "SequencePaths",
    "Sequences",
    "check_paths",
    "check_size",
    "make_grid",
    "reference_planner",
    "settled",
)

Call = tuple[Callable, dict[str, Any]]


class World:
    """What calls are made with: a small grid with everything that grows from it, and files in a folder of their own."""

    def __init__(self, folder: Path):
        self.folder = folder
        occupied = np.zeros((6, 8), dtype=bool)
        occupied[2:4, 3:5] = True
        self.occupied = occupied
        self.grid = OccupancyGrid(occupied, resolution=0.5, origin=(1.0, 2.0, 0.3), name="small")
        self.query: dict[str, Any] = {"start": (0, 0), "goal": (7, 5)}
        self.field = np.arange(48.0).reshape(6, 8) / 8
        self.enter = np.arange(384.0).reshape(8, 6, 8) / 8
        self.random = np.random.default_rng(1)

    @cached_property
    def codings(self) -> dict[str, Any]:
        known: Any = representations.REPRESENTATIONS
        return {name: known[name](self.grid, **self.query) for name in known}

    @cached_property
    def frame(self) -> MonotoneFrame:
        return MonotoneFrame(self.grid, **self.query)

    @cached_property
    def problem(self) -> GridPathProblem:
        return GridPathProblem(self.grid, **self.query, representation="integer")

    @cached_property
    def limited(self) -> GridPathProblem:
        return GridPathProblem(
            self.grid,
            **self.query,
            representation="integer",
            obstacles="limit",
            potential_limit=5.0,
            objectives=["vulnerability"],
        )

    @cached_property
    def result(self):
        options = operators.default_operators(self.problem)
        algorithm = algorithms.make_algorithm("NSGA2", self.problem, pop_size=12, operators=options)
        return minimize(self.problem, algorithm, ("n_gen", 3), seed=1, callback=convergence.ConvergenceRecorder())

    @property
    def recorder(self) -> convergence.ConvergenceRecorder:
        return cast(Any, self.result).algorithm.callback

    @cached_property
    def trade_off(self) -> decision.TradeOffSet:
        return decision.TradeOffSet.from_results(self.result)

    def rows(self, coding) -> np.ndarray:
        return np.random.default_rng(3).integers(coding.xl, coding.xu + 1, (5, coding.n_var))

    @cached_property
    def legal_rows(self) -> np.ndarray:
        return exact.exact_front(self.problem).X

    @cached_property
    def study(self):
        return study.Study(
            problems=[study.ProblemSpec(name="one", random={"size": 8, "p0": 0.2, "seeds": 1})],
            algorithms=[study.AlgorithmSpec(name="nsga2", algorithm="NSGA2", pop_size=12)],
            seeds=1,
            budget={"generations": 2},
        )

    @cached_property
    def store(self):
        folder = self.folder / "study"
        study.run_study(self.study, folder)
        return study.Store(folder)

    def file(self, name: str, data: bytes) -> Path:
        path = self.folder / name
        if not path.exists():
            path.write_bytes(data)
        return path

    @cached_property
    def text_map(self) -> Path:
        return self.file("map.txt", b"....\n.##.\n....\n")

    @cached_property
    def movingai_map(self) -> Path:
        return self.file("map.map", b"type octile\nheight 3\nwidth 4\nmap\n....\n.@@.\n....\n")

    @cached_property
    def scen(self) -> Path:
        return self.file("map.scen", b"version 1\n0\tmap.map\t4\t3\t0\t0\t3\t2\t4.41421356\n")

    @cached_property
    def image(self) -> Path:
        return self.file("map.pgm", b"P2\n4 3\n255\n" + b"254 254 254 254 254 0 0 254 254 254 254 254\n")

    @cached_property
    def ros_map(self) -> Path:
        text = "image: {}\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
        return self.file("map.yaml", text.format(self.image.name).encode())

    @cached_property
    def npy_map(self) -> Path:
        path = self.folder / "map.npy"
        np.save(path, self.occupied)
        return path

    @cached_property
    def json(self) -> Path:
        return self.trade_off.to_json(self.folder / "set.json")

    @cached_property
    def toml(self) -> Path:
        text = (
            'name = "one"\nseeds = 1\nbudget = { generations = 2 }\n[[problems]]\nrandom = { size = 8, p0 = 0.2, seeds = 1 }\n'
            '[[algorithms]]\nalgorithm = "NSGA2"\npop_size = 12\n'
        )
        return self.file("study.toml", text.encode())


def calls(w: World) -> dict[str, Call]:
    """Return a valid call of every public name."""
    return {
        name.removeprefix("pymoo_gridpath."): call
        for part in (_grids, _maps, _problems, _codings, _paths, _search, _operators, _algorithms, _results, _studies)
        for name, call in part(w).items()
    }


def _grids(w: World) -> dict[str, Call]:
    grid, cell = w.grid, (1, 1)
    return {
        "OccupancyGrid": (
            OccupancyGrid,
            {"occupied": w.occupied, "resolution": 0.5, "origin": (1.0, 2.0, 0.3), "corner_cutting": True, "name": "own"},
        ),
        "OccupancyGrid.box_of": (grid.box_of, {"start": cell}),
        "OccupancyGrid.check_cell": (grid.check_cell, {"cell": cell, "role": "start"}),
        "OccupancyGrid.check_query": (grid.check_query, w.query),
        "OccupancyGrid.contains": (grid.contains, {"cell": cell}),
        "OccupancyGrid.crop": (grid.crop, {"box": grid.whole}),
        "OccupancyGrid.inflate": (grid.inflate, {"radius": 0.5}),
        "OccupancyGrid.is_free": (grid.is_free, {"cell": cell}),
        "OccupancyGrid.move_graph": (grid.move_graph, {}),
        "OccupancyGrid.nearest_free": (grid.nearest_free, {"cell": cell}),
        "OccupancyGrid.replace": (grid.replace, {"resolution": 2.0, "occupied": w.occupied}),
        "OccupancyGrid.shortest_length": (grid.shortest_length, {"start": cell, "goal": cell}),
        "OccupancyGrid.shortest_lengths": (grid.shortest_lengths, {"start": cell, "limit": 5.0}),
        "OccupancyGrid.to_cells": (grid.to_cells, {"points": np.array([[1.0, 2.0], [3.0, 4.0]])}),
        "OccupancyGrid.to_metres": (grid.to_metres, {"cells": np.array([[1, 2], [3, 4]])}),
        "obstacle_potential": (fields.obstacle_potential, {"grid": grid, "variance": 2.0}),
        "clearance": (fields.clearance, {"grid": grid}),
    }


def _maps(w: World) -> dict[str, Call]:
    pose = {"resolution": 0.5, "origin": (1.0, 2.0)}
    return {
        "load_map": (maps.load_map, {"path": w.image, "threshold": 0.5, "unknown": "free", "corner_cutting": True, **pose}),
        "load_shipped": (maps.load_shipped, {"name": "office", "corner_cutting": True}),
        "format_of": (maps.format_of, {"path": w.ros_map}),
        "query_of": (maps.query_of, {"path": w.text_map}),
        "Query": (maps.Query, {**w.query, "radius": 0.1}),
        "read_string": (maps.read_string, {"path": w.text_map, "limit": 1000}),
        "read_image": (
            maps.read_image,
            {"path": w.image, "threshold": 0.5, "unknown": "free", "corner_cutting": True, **pose},
        ),
        "read_movingai": (maps.read_movingai, {"path": w.movingai_map, "corner_cutting": True, **pose}),
        "read_npy": (maps.read_npy, {"path": w.npy_map, "corner_cutting": True, **pose}),
        "read_ros": (maps.read_ros, {"path": w.ros_map, "unknown": "occupied", "corner_cutting": True}),
        "read_scen": (maps.read_scen, {"path": w.scen, "grid": maps.read_movingai(w.movingai_map)}),
        "read_text": (maps.read_text, {"path": w.text_map, "corner_cutting": True, **pose}),
        "read_text_header": (maps.read_text_header, {"path": w.text_map}),
        "shipped_maps": (maps.shipped_maps, {}),
        "ScenQuery": (
            maps.ScenQuery,
            {"bucket": 0, "map_name": "a", "width": 4, "height": 3, **w.query, "optimal_length": 4.0},
        ),
        "ShippedMap": (ShippedMap, {"name": "a", "title": "A", "path": w.text_map, **w.query, "radius": 0.1}),
        "TextHeader": (maps.TextHeader, {"name": "a", "title": "A", **pose, "corner_cutting": True, **w.query, "radius": 0.1}),
    }


def _problems(w: World) -> dict[str, Call]:
    problem, limited = w.problem, w.limited
    paths = problem.decode(w.legal_rows)
    own = {"grid": w.grid, **w.query, "representation": "integer", "objectives": ("length", "vulnerability"), "axis": "x"}
    return {
        "GridPathProblem": (
            GridPathProblem,
            {**own, "objectives": ["vulnerability"], "obstacles": "limit", "penalty": 9.0, "potential_limit": 5.0},
        ),
        "GridPathProblem.decode": (problem.decode, {"X": w.rows(problem)}),
        "GridPathProblem.evaluate": (partial(problem.evaluate, return_values_of=["F", "turn"]), {"X": w.rows(problem)}),
        "GridPathProblem.over_limit": (limited.over_limit, {"vulnerability": np.array([1.0, 9.0])}),
        "GridPathProblem.pareto_front": (_fresh(w, "pareto_front"), {"max_seconds": 2.0}),
        "GridPathProblem.pareto_set": (_fresh(w, "pareto_set"), {"max_seconds": 2.0}),
        "GridPathProblem.score": (problem.score, {"paths": paths}),
        "random_dense_grid": (problems.random_dense_grid, {"size": 8, "p0": 0.3, "random_state": 1}),
        "make_objectives": (objectives.make_objectives, {"objectives": ["length", "turn"]}),
        "Length": (objectives.Length, {}),
        **{
            f"{type(one).__name__}.{method}": (getattr(one, method), given)
            for one in (objectives.Length(), objectives.Turn(), objectives.Vulnerability(2.0))
            for method, given in (
                ("moves", {"grid": w.grid}),
                ("prepare", {"representation": w.problem.representation, "grid": w.grid}),
            )
        },
        "Objective.field": (objectives.Turn().field, {"grid": w.grid}),
        "Objective.field_in": (objectives.Turn().field_in, {"grid": w.grid, "box": w.grid.whole}),
        "Objective.moves": (objectives.Turn().moves, {"grid": w.grid}),
        "Objective.prepare": (objectives.Turn().prepare, {"representation": w.problem.representation, "grid": w.grid}),
        "register": (pymoo_gridpath.register, {"cls": objectives.Length}),
        "Length.field": (objectives.Length().field, {"grid": w.grid}),
        "Length.field_in": (objectives.Length().field_in, {"grid": w.grid, "box": w.grid.whole}),
        "Turn": (objectives.Turn, {}),
        "Turn.field": (objectives.Turn().field, {"grid": w.grid}),
        "Turn.field_in": (objectives.Turn().field_in, {"grid": w.grid, "box": w.grid.whole}),
        "Vulnerability": (objectives.Vulnerability, {"variance": 2.0}),
        "Vulnerability.field": (objectives.Vulnerability(2.0).field, {"grid": w.grid}),
        "Vulnerability.field_in": (objectives.Vulnerability(2.0).field_in, {"grid": w.grid, "box": w.grid.whole}),
        # An objective of one's own, whose field and values are arguments too.
        "Objective": (partial(_own_objective, w), {"field": w.field, "factor": np.ones(5)}),
    }


def _fresh(w: World, method: str) -> Callable:
    """Return a method of a problem that has not been asked before; the first answer is kept."""

    def ask(**arguments):
        return getattr(GridPathProblem(w.grid, **w.query, representation="integer"), method)(**arguments)

    return ask


def _own_objective(w: World, field, factor):
    class Own(objectives.Objective):
        name = label = "own"

        def field(self, grid):
            return field

        def __call__(self, paths, prepared):
            return factor

    problem = GridPathProblem(w.grid, **w.query, representation="integer", objectives=[Own()])
    return problem.evaluate(w.rows(problem))


def _codings(w: World) -> dict[str, Call]:
    found: dict[str, Call] = {
        "default_representation": (representations.default_representation, {"corner_cutting": True, "axis": "x"}),
        "make_representation": (representations.make_representation, {"name": "mixed", "grid": w.grid, **w.query, "axis": "x"}),
    }
    for coding in w.codings.values():
        cls = type(coding)
        X = w.rows(coding)
        own = {"axis": "x"} if isinstance(coding, representations.MonotoneRepresentation) else {}
        if cls is representations.CellSequence:
            own = {"max_cells": 20, "fields": [w.field], "spare": 2.0}
            X = coding.repair(X, w.random)
        paths = coding.decode(X)
        found[cls.__name__] = (cls, {"grid": w.grid, **w.query, **own})
        arguments: dict[str, dict[str, Any]] = {
            "decode": {"X": X},
            "encode": {"paths": paths},
            "exit_rows": {"X": X},
            "fits": {"sequences": paths.sequences},
            "from_sequences": {"sequences": paths.sequences},
            "genes": {"X": X},
            "prepare": {"field": w.field},
            "repair": {"X": X, "random_state": w.random},
            "row_moves": {"X": X},
            "to_sequences": {"X": X},
        }
        for method, given in arguments.items():
            if hasattr(coding, method):
                found[f"{cls.__name__}.{method}"] = (getattr(coding, method), given)
    return found


def _paths(w: World) -> dict[str, Call]:
    frame, paths = w.frame, cast(ColumnPaths, w.problem.decode(w.rows(w.problem)))
    cells = w.codings["cells"].decode(w.rows(w.codings["cells"]))
    n = frame.n_columns - 1
    return {
        "MonotoneFrame": (MonotoneFrame, {"grid": w.grid, **w.query, "axis": "x"}),
        "MonotoneFrame.admits_path": (frame.admits_path, {}),
        "MonotoneFrame.columns": (frame.columns, {"field": w.field}),
        "MonotoneFrame.flanks_at": (frame.flanks_at, {"row": paths.leave[:, :n], "step": np.ones((len(paths), n), dtype=int)}),
        "MonotoneFrame.from_cells": (frame.from_cells, {"cells": np.array([[1, 2], [3, 4]])}),
        "MonotoneFrame.prefix_sums": (frame.prefix_sums, {"field": w.field}),
        "MonotoneFrame.to_cells": (frame.to_cells, {"column": np.array([0, 1]), "row": np.array([0, 2])}),
        "ColumnPaths": (partial(_measured, ColumnPaths), {"frame": frame, "enter": paths.enter, "leave": paths.leave}),
        "ColumnPaths.cells": (paths.cells, {"index": 1}),
        "ColumnPaths.through": (ColumnPaths.through, {"frame": frame, "exit_rows": paths.leave[:, :n]}),
        "ColumnPaths.total": (paths.total, {"sums": w.problem.representation.prepare(w.field)}),
        "CellPaths": (partial(_measured, CellPaths), {"grid": w.grid, "rows": cells.rows}),
        "CellPaths.cells": (cells.cells, {"index": 1}),
        "CellPaths.total": (cells.total, {"field": w.field.ravel()}),
        "ColumnPaths.moves_total": (paths.moves_total, {"enter": w.enter}),
        "CellPaths.moves_total": (cells.moves_total, {"enter": w.enter}),
    }


def _measured(cls, **arguments):
    paths = cls(**arguments)
    return paths.length, paths.turn, paths.interfering_cells


def _search(w: World) -> dict[str, Call]:
    front = np.array([[0.0, 4.0], [1.0, 1.0], [4.0, 0.0]])
    return {
        "ExactFront.plan": (algorithms.ExactFront().plan, {"problem": w.problem}),
        "ExactFront.parameters": (algorithms.ExactFront.parameters, {}),
        "ExactFront.refuse": (algorithms.ExactFront.refuse, {"problem": w.problem}),
        **_planners(w),
        "find_algorithm": (algorithms.find_algorithm, {"name": "nsga2"}),
        "hypervolume_ratio": (quality.hypervolume_ratio, {"F": front + 0.5, "front": front}),
        "igd_plus": (quality.igd_plus, {"F": front + 0.5, "front": front}),
        "share_found": (quality.share_found, {"F": front, "front": front}),
        "Budget": (exact.Budget, {"max_seconds": 1.0, "max_labels": 1000, "max_memory": 10**8, "watch": lambda meter: False}),
        "exact_front": (exact.exact_front, {"problem": w.problem, "budget": exact.Budget(max_seconds=2.0)}),
        "ExactResult": (
            exact.ExactResult,
            {
                "X": w.legal_rows,
                "F": np.zeros((1, 2)),
                "complete": True,
                "message": "",
                "n_labels": 1,
                "n_bytes": 1,
                "seconds": 1.0,
            },
        ),
    }


def _planners(w: World) -> dict[str, Call]:
    """Calls of the planners that plan cells."""
    problem = GridPathProblem(w.grid, **w.query, representation="cells")
    arguments: dict[type, dict[str, Any]] = {
        algorithms.QuadrantSelection: {
            "speed": 0.5,
            "turn_seconds": 0.1,
            "alternatives": 2,
            "smooth": False,
            "max_paths": 9,
            "strict": True,
        },
        algorithms.AStar: {"heuristic": "euclidean"},
        algorithms.Dijkstra: {},
        algorithms.BreadthFirst: {},
        algorithms.BestFirst: {"heuristic": "manhattan"},
        algorithms.JumpPointSearch: {"heuristic": "chebyshev"},
        algorithms.OrthogonalJumpPointSearch: {},
    }
    found: dict[str, Call] = {}
    for cls, given in arguments.items():
        found[cls.__name__] = (cls, given)
        found[f"{cls.__name__}.plan"] = (cls().plan, {"problem": problem})
        found[f"{cls.__name__}.parameters"] = (cls.parameters, {})
        found[f"{cls.__name__}.refuse"] = (cls.refuse, {"problem": problem})
    return found


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
        "SmoothnessTournament": (operators.SmoothnessTournament, {}),
        "RankAndSmoothness": (operators.RankAndSmoothness, {"distinct": True}),
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
        "PathOutput": (algorithms.PathOutput, {"distance": False}),
        "ExactFront": (
            algorithms.ExactFront,
            {"max_seconds": 1.0, "max_labels": 1000, "max_memory": 10**8, "watch": lambda meter: False},
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
    settings = {"settings": {"note": "a"}}
    F = np.array([[0.0, 4.0], [1.0, 1.0], [4.0, 0.0]])
    return {
        "ConvergenceRecorder": (convergence.ConvergenceRecorder, {"reference_point": np.array([20.0, 20.0])}),
        "ConvergenceRecorder.hypervolume": (w.recorder.hypervolume, {"reference_point": np.array([30.0, 30.0])}),
        "common_reference_point": (convergence.common_reference_point, {"recorders": [w.recorder], "margin": 0.1}),
        "TradeOffSet": (decision.TradeOffSet, {"problem": w.problem, "X": w.legal_rows, "meta": {"a": 1}}),
        "TradeOffSet.from_genes": (decision.TradeOffSet.from_genes, {"problem": w.problem, "X": w.legal_rows, **settings}),
        "TradeOffSet.from_results": (decision.TradeOffSet.from_results, {"results": [w.result], **settings}),
        "TradeOffSet.index": (trade_off.index, {"name": "knee"}),
        "TradeOffSet.names": (trade_off.names, {"index": 0}),
        "TradeOffSet.table": (trade_off.table, {"max_rows": 3}),
        "TradeOffSet.to_csv": (trade_off.to_csv, {"path": w.folder / "set.csv"}),
        "TradeOffSet.to_json": (trade_off.to_json, {"path": w.folder / "again.json"}),
        "PathRecord": (decision.PathRecord, trade_off[0].as_dict()),
        "PathRecord.as_dict": (trade_off[0].as_dict, {}),
        "knee_point": (decision.knee_point, {"F": F}),
        "load_json": (decision.load_json, {"path": w.json}),
        "plot_map": (
            plotting.plot_map,
            {"grid": w.grid, "potential": w.field, **w.query, "units": "m", "legend": True, "ax": None},
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
        "Progress.update": (progress.Progress(1, 2).update, {"run": 0, "algorithm": w.result.algorithm}),
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
                "radius": 0.1,
                "objectives": ["length", "turn"],
                "representation": "cells",
                "obstacles": "penalty",
                "penalty": 3.0,
                "axis": "auto",
            },
        ),
        "RandomFamily": (study.RandomFamily, {"size": 8, "p0": 0.2, "seeds": [1, 2], "corner_cutting": True}),
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


# -- which names are public ---------------------------------------------------------------------------------------------------


def documented() -> Iterator[tuple[str, str]]:
    """Yield the module and the name of everything that the reference lists, and of everything in an ``__all__``."""
    module = ""
    for line in REFERENCE.read_text().splitlines():
        if match := re.match(r"\.\. currentmodule:: (\S+)", line):
            module = match[1]
        elif match := re.fullmatch(r"   ([A-Za-z_]\w*)", line):
            yield module, match[1]
    for found in itertools.chain([pymoo_gridpath.__name__], (info.name for info in _modules())):
        for name in getattr(importlib.import_module(found), "__all__", ()):
            yield found, name


def _modules():
    for info in pkgutil.walk_packages(pymoo_gridpath.__path__, "pymoo_gridpath."):
        if not info.name.endswith("__main__") and info.name not in INTERNAL:
            yield info


def public_names() -> set[str]:
    """Return all public functions, classes that can be made, and methods of these, as the keys of `calls`."""
    names: set[str] = set()
    for module, name in documented():
        if module.startswith(INTERNAL) or name in BUILDING_BLOCKS:
            continue
        thing = getattr(importlib.import_module(module), name)
        if not inspect.isclass(thing):
            names |= {name} if callable(thing) else set()
        elif not (inspect.isabstract(thing) or issubclass(thing, BaseException)):
            names |= {name, *(f"{name}.{method}" for method in _methods(thing))}
    return names


def _methods(cls: type) -> Iterator[str]:
    """Yield the public methods of a class that are ours; those that replace another package's are called by it alone."""
    for name in dir(cls):
        if name.startswith("_") or inspect.isclass(getattr(cls, name)):
            continue
        homes = [base for base in cls.__mro__ if name in vars(base)]
        ours = all(base.__module__.startswith("pymoo_gridpath") for base in homes)
        if ours and callable(getattr(cls, name)):
            yield name
