"""The report of runs that nobody planned as a study: plain Results of pymoo."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from pymoo.core.result import Result

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.problems import GridPathProblem, MovingObstaclesProblem, ObstacleClock
from pymoo_gridpath.problems.members import Members
from pymoo_gridpath.quality import ReferenceFront, merge_fronts
from pymoo_gridpath.study.planning.build import pack_grid
from pymoo_gridpath.study.planning.plan import Plan, PlannedAlgorithm, PlannedProblem
from pymoo_gridpath.study.report import moving
from pymoo_gridpath.study.report.figures.style import check_formats
from pymoo_gridpath.study.report.page.contents import Contents
from pymoo_gridpath.study.report.page.explorers import Rows
from pymoo_gridpath.study.report.references import ProblemReference
from pymoo_gridpath.study.report.results import Results, RunResult, measure
from pymoo_gridpath.study.report.tables.csv_files import csv_files
from pymoo_gridpath.study.report.writing import write_files
from pymoo_gridpath.study.running.epochs import Epochs
from pymoo_gridpath.study.running.record import RunRecord
from pymoo_gridpath.study.specification import moving as specified
from pymoo_gridpath.versions import versions

# Runs of a problem go by their numbers.
_RUN = "run "

_EXPECTED = "Results by problem and algorithm, such as {('maze', 'NSGA2'): [result, ...]}, or rows ('maze', 'NSGA2', result)"


def compare(
    results: Mapping[tuple[str, str], Any] | Iterable[tuple[str, str, Result]],
    output: str | os.PathLike[str] | None = None,
    *,
    name: str = "comparison",
    target: float = 0.95,
    formats: str | Sequence[str] = ("png", "pdf"),
    times: bool = True,
) -> dict[str, list[dict[str, str]]]:
    """Compare runs that were made with `pymoo.optimize.minimize`: the tables, tests and figures of a study's report.

    Runs of one problem are measured against its exact front where ``problem.pareto_front()`` has it, which takes at most two
    seconds unless it is known already; else against the merged front of all runs. Where obstacles move, what was found at the
    end of each epoch is measured, which the run's `ObstacleClock` keeps, against the front of that epoch.

    Parameters
    ----------
    results : mapping or iterable
        Lists of pymoo's Results, one a seed, by the names of problem and algorithm:
        ``{("maze", "NSGA2"): [result, ...], ...}``; or rows (problem, algorithm, Result). Results of one problem are of equal
        problems.
    output : path-like, optional
        A folder for the page, the tables and the figures, see `write_report`. By default nothing is written.
    name : str, default "comparison"
        What the page is called.
    target : float, default 0.95
        The hypervolume ratio that "to target" asks for. Histories are not known, so that it counts at the end of runs.
    formats : sequence of {"png", "pdf", "svg"}, default ("png", "pdf")
        Of the figures' files.
    times : bool, default True
        Whether to report seconds and versions.

    Returns
    -------
    dict of list of dict
        The rows of the tables "runs", "problems", "summary" and "tests", as in the CSV files: texts by the names of columns.

    Raises
    ------
    GridPathError
        If there are no Results, one is of no path problem, or those of one problem are of different problems; if obstacles
        move and a run has no clock that kept all epochs; if an argument is wrong, or a file cannot be written.

    Examples
    --------
    >>> from pymoo.optimize import minimize
    >>> from pymoo_gridpath.algorithms import make_algorithm
    >>> from pymoo_gridpath.problems import random_dense_grid
    >>> problem = GridPathProblem(random_dense_grid(8, 0.2, 1), (0, 0), (7, 7))
    >>> runs = {
    ...     ("dense", algorithm): [
    ...         minimize(problem, make_algorithm(algorithm, problem, pop_size=20), ("n_gen", 5), seed=seed)
    ...         for seed in (1, 2, 3)
    ...     ]
    ...     for algorithm in ("NSGA2", "SPEA2")
    ... }
    >>> tables = compare(runs)
    >>> [(row["algorithm"], row["seed"], row["reference"]) for row in tables["runs"]][:2]
    [('NSGA2', '1', 'exact'), ('NSGA2', '2', 'exact')]
    """
    checks.text("name", name)
    target = checks.number("target", target, 0.0, 1.0, above=True, expected="a share above 0, at most 1")
    times = checks.flag("times", times)
    forms = check_formats(checks.names("formats", formats))
    if output is not None:
        checks.file_path("output", output)
    by_problem = _by_problem(_rows(results))
    measured = _measured(by_problem, name, target)
    if output is not None:
        write_files(measured, Path(output), forms, times, _genes(by_problem))
    contents = Contents(measured, times)
    for _ in contents.blocks():
        """The tests are made on the way."""
    texts = csv_files(measured, contents.families, times)
    return {file.removesuffix(".csv"): list(csv.DictReader(io.StringIO(text))) for file, text in texts.items()}


def _rows(results: Any) -> list[tuple[str, str, Result]]:
    """Return Results with the names of problem and algorithm, one a row."""
    if isinstance(results, Mapping):
        rows = []
        for key, runs in results.items():
            if not isinstance(key, tuple) or len(key) != 2:
                raise GridPathError(f"results has the key {checks.shown(key)}, expected {_EXPECTED}")
            rows += [(*key, run) for run in ([runs] if isinstance(runs, Result) else checks.items("results", runs, _EXPECTED))]
    else:
        rows = checks.items("results", results, _EXPECTED)
    for row in rows:
        if not isinstance(row, tuple | list) or len(row) != 3 or not all(isinstance(part, str) and part for part in row[:2]):
            raise GridPathError(f"results holds {checks.shown(row)}, expected {_EXPECTED}")
        if not isinstance(row[2], Result) or not isinstance(getattr(row[2], "problem", None), GridPathProblem):
            raise GridPathError(
                f"a run of {row[1]!r} on {row[0]!r} is {checks.shown(row[2])}, expected a Result of a GridPathProblem"
            )
    if not rows:
        raise GridPathError(f"results holds no runs, expected {_EXPECTED}")
    return [tuple(row) for row in rows]


def _by_problem(rows: list[tuple[str, str, Result]]) -> dict[str, list[tuple[str, Result]]]:
    found: dict[str, list[tuple[str, Result]]] = {}
    for label, algorithm, result in rows:
        runs = found.setdefault(label, [])
        first: Any = runs[0][1].problem if runs else result.problem
        other: Any = result.problem
        same = first is other or (
            ([still.grid for still in first.stills], first.start, first.goal)
            == ([still.grid for still in other.stills], other.start, other.goal)
            and repr(first.objectives) == repr(other.objectives)
        )
        if not same:
            raise GridPathError(
                f"the runs on {label!r} are of problems that differ in grid, start, goal or objectives; give each a name of "
                "its own"
            )
        runs.append((algorithm, result))
    return found


def _measured(by_problem: dict[str, list[tuple[str, Result]]], name: str, target: float) -> Results:
    """Return runs as those of a study are when they have been read and measured."""
    algorithms: dict[str, PlannedAlgorithm] = {}
    for runs in by_problem.values():
        for label, result in runs:
            algorithms.setdefault(label, PlannedAlgorithm(label, _algorithm(result.algorithm), {}))
    problems = [PlannedProblem(label, label, _problem(runs[0][1].problem)) for label, runs in by_problem.items()]
    plan = Plan(name, {}, target, tuple(problems), tuple(algorithms.values()), ())
    measured = Results(plan, target)
    places = {label: k for k, label in enumerate(algorithms)}
    for k, runs in enumerate(by_problem.values()):
        records = [_record(label, result, number) for number, (label, result) in enumerate(runs, 1)]
        reference = _reference(runs[0][1].problem, records)
        measured.references.append(reference)
        for (label, _), record in zip(runs, records, strict=True):
            found = RunResult(record.key, k, places[label], record.seed, record.status)
            measure(found, record, reference, target, keep_front=True)
            measured.runs.append(found)
    return measured


def _genes(by_problem: dict[str, list[tuple[str, Result]]]) -> Rows:
    """Return what finds the genes of the runs that `_record` named."""
    all_runs = list(by_problem.values())

    def read(problem: int, keys: Sequence[str]) -> tuple[GridPathProblem, list[np.ndarray]]:
        runs: list[Any] = [all_runs[problem][int(key.removeprefix(_RUN)) - 1][1] for key in keys]
        return runs[0].problem, [np.atleast_2d(run.algorithm.pop.get("X")) for run in runs]

    return read


def _reference(problem: Any, records: list[RunRecord]) -> ProblemReference:
    reason = "the problem has no exact front, or none that was found in a short time"
    epochs = [record.epochs for record in records if record.epochs is not None]
    if epochs:
        exact = [still.pareto_front() for still in problem.stills]
        if any(front is None for front in exact):
            fronts = moving.merged(epochs, problem.n_obj)
            return ProblemReference(fronts[-1], reason, np.nan, False, fronts)
        fronts = tuple(ReferenceFront(front) for front in exact)
        exceeded = moving.exceeded(epochs, fronts)
        return ProblemReference(fronts[-1], "", np.nan, exceeded, fronts)
    front, found = problem.pareto_front(), [record.F for record in records]
    if front is None:
        return ProblemReference(ReferenceFront(merge_fronts(found), exact=False), reason, np.nan, False)
    known = ReferenceFront(front)
    return ProblemReference(known, "", np.nan, known.exceeded_by(np.concatenate(found)))


def _epochs(label: str, result: Result) -> Epochs | None:
    """Return what a run had found at the end of each epoch; None where obstacles do not move."""
    problem, clock = result.problem, getattr(result.algorithm, "callback", None)
    if not isinstance(problem, MovingObstaclesProblem):
        return None
    if not isinstance(clock, ObstacleClock) or clock.epochs != list(range(problem.n_epochs)):
        raise GridPathError(
            f"a run of {label!r} has no clock that kept all {problem.n_epochs} epochs, expected "
            "minimize(..., callback=ObstacleClock()) from the first to the last"
        )
    return Epochs.of(clock.F, clock.evaluations, clock.missed, clock.faults)


def _record(label: str, result: Result, number: int) -> RunRecord:
    """Return a run as a study would store it, but for its history."""
    algorithm: Any = result.algorithm
    problem: Any = result.problem
    members = Members(algorithm)
    front = members.front()
    seed = getattr(algorithm, "seed", None)
    return RunRecord(
        key=f"{_RUN}{number}",
        seed=number if seed is None else int(seed),
        status="finished",
        message=getattr(result, "message", None) or "",
        complete=getattr(result, "success", None) is not False,
        seconds=float(getattr(result, "exec_time", None) or 0.0),
        n_eval=int(algorithm.evaluator.n_eval),
        n_gen=int(algorithm.n_iter) - 1,
        started="",
        versions=versions(),
        machine={},
        problem={},
        algorithm={},
        budget=None,
        objectives=list(problem.objective_names),
        X=np.empty((len(front), 0)),
        F=members.F[front],
        turn=members.turn[front],
        n_legal=members.n_legal,
        n_members=members.n_members,
        history=None,
        epochs=_epochs(label, result),
        certified=getattr(result, "certified", None),
    )


def _problem(problem: Any) -> dict[str, Any]:
    """Return what a report says of a problem, in the form in which studies have it."""
    moves = {}
    if isinstance(problem, MovingObstaclesProblem):
        moves["moving"] = specified.entry(specified.held(problem.movers, problem.n_epochs), problem.taut)
    return {
        **moves,
        "grid": pack_grid(problem.stills[0].grid)[0],
        "start": list(problem.start),
        "goal": list(problem.goal),
        "objectives": [
            {"class": _path(one), "arguments": {}, "name": one.name, "label": one.label}
            | ({"maximise": True} if one.maximise else {})
            for one in problem.objectives
        ],
        "representation": {"class": problem.representation.name, "arguments": {}, "paper": False, "monotone": False},
        "obstacles": problem.obstacles,
        "penalty": problem.penalty,
        "potential_limit": problem.potential_limit,
        "axis": "auto",
    }


def _algorithm(algorithm: Any) -> dict[str, Any]:
    says = getattr(type(algorithm), "capability", type(algorithm))
    flags = {flag: bool(getattr(says, flag, False)) for flag in ("deterministic", "reference")}
    content = {"class": _path(algorithm), "arguments": {}, **flags}
    return {"algorithm": content, "parameters": {}} | {
        key: getattr(algorithm, key) for key in ("pop_size",) if isinstance(getattr(algorithm, key, None), int)
    }


def _path(thing: Any) -> str:
    return f"{type(thing).__module__}:{type(thing).__qualname__}"
