"""The numbers of a report in full precision, as CSV."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from pymoo_gridpath.study.planning.canonical import steps_of
from pymoo_gridpath.study.planning.plan import PlannedProblem
from pymoo_gridpath.study.report.references import gist, kind_of
from pymoo_gridpath.study.report.results import Results
from pymoo_gridpath.study.report.statistics.comparisons import Comparison, could_tell
from pymoo_gridpath.study.report.statistics.summaries import quartiles
from pymoo_gridpath.study.report.tables.moving import epoch_rows, moving_problems
from pymoo_gridpath.study.report.tables.summary import n_reached
from pymoo_gridpath.study.report.tables.table import csv_text
from pymoo_gridpath.study.specification import own
from pymoo_gridpath.study.specification.kinds import objective_name
from pymoo_gridpath.study.specification.moving import n_epochs

_MEASURES = ("ratio", "igd_plus", "share", "turn", "evaluations_to_target", "seconds_to_target", "n_eval", "seconds")
_TIMES = ("seconds_to_target", "seconds")


class Family(NamedTuple):
    """Tests whose p values are corrected together.

    Attributes
    ----------
    level : {"problem", "group", "study"}
        What each comparison is of.
    comparisons : list of (str, Comparison)
        By the name of the problem or group.
    """

    level: str
    comparisons: list[tuple[str, Comparison]]


def csv_files(results: Results, families: Sequence[Family], times: bool) -> dict[str, str]:
    """Return the contents of all CSV files by name.

    Parameters
    ----------
    results : Results
    families : sequence of Family
    times : bool
        Whether seconds are among the columns.
    """
    measures = [measure for measure in _MEASURES if times or measure not in _TIMES]
    moves = bool(moving_problems(results, range(len(results.plan.problems))))
    return {
        **({"epochs.csv": csv_text(*epoch_rows(results))} if moves else {}),
        "runs.csv": csv_text(*_runs(results, measures)),
        "problems.csv": csv_text(*_problems(results, times)),
        "summary.csv": csv_text(*_summary(results, measures)),
        "tests.csv": csv_text(*_tests(results, families)),
    }


def _runs(results: Results, measures: list[str]) -> tuple[list[str], Iterator[list]]:
    """Return header and rows of the tidy table of all runs."""
    header = ["group", "problem", "algorithm", "seed", "key", "status", "feasible", "reference", "reference_points"]
    numbers = ["n_points", *measures, "n_gen"]

    def rows() -> Iterator[list]:
        for run in results.runs:
            problem, front = results.plan.problems[run.problem], results.references[run.problem].front
            feasible = _truth(run.feasible) if run.finished else None
            complete = _truth(run.complete) if run.finished else None
            names = [problem.group, problem.label, results.algorithms[run.algorithm], run.seed, run.key]
            kind = kind_of(front)
            values = [getattr(run, number) for number in numbers]
            certified = [None, None] if run.certified is None else [run.certified.epsilon, run.certified.share]
            yield [*names, run.status, feasible, kind, len(front), *values, complete, *certified, gist(run.message)]

    return [*header, *numbers, "complete", "certified_epsilon", "certified_share", "message"], rows()


def _problems(results: Results, times: bool) -> tuple[list[str], Iterator[list]]:
    """Return header and rows of the problems and the fronts that their runs are measured against."""
    grid = ["width", "height", "corner_cutting", "moves", "p0", "grid_seed", "map", "map_digest"]
    given = ["representation", "axis", "obstacles", "penalty", "potential_limit"]
    header = ["group", "problem", *grid, "start", "goal", "objectives", *given]
    header += ["reference", "reference_points", "reason", "exceeded"]
    moves = bool(moving_problems(results, range(len(results.plan.problems))))
    header += ["movers", "every", "epochs"] * moves

    def rows() -> Iterator[list]:
        for problem, reference in zip(results.plan.problems, results.references, strict=True):
            kind = kind_of(reference.front)
            spec = problem.spec
            row = [problem.group, problem.label, *_grid(problem)]
            row += [" ".join(map(str, spec[key])) for key in ("start", "goal")]
            row.append(" ".join(map(objective_name, spec["objectives"])))
            row += [own.shown(spec[key]) if key == "representation" else spec[key] for key in given]
            row += [kind, len(reference.front), reference.reason, _truth(reference.exceeded)]
            if moves:
                moving = spec.get("moving")
                row += [None] * 3 if moving is None else [len(moving["movers"]), moving["every"], n_epochs(moving)]
            yield [*row, reference.seconds] if times else row

    return [*header, "exact_seconds"] if times else header, rows()


def _summary(results: Results, measures: list[str]) -> tuple[list[str], Iterator[list]]:
    """Return header and rows of the summary: of each problem, of each group, and of all, for each algorithm."""
    header = ["level", "group", "problem", "algorithm", "reference", "planned", "finished", "failed", "missing"]
    header += [
        "feasible_rate",
        "target",
        "reached_target",
        *(f"{measure}_{part}" for measure in measures for part in ("q1", "median", "q3")),
    ]

    def rows() -> Iterator[list]:
        plan = results.plan
        scopes: list[tuple] = [("problem", problem.group, problem.label, [k]) for k, problem in enumerate(plan.problems)]
        scopes += [("group", group, None, problems) for group, problems in results.groups.items()]
        scopes.append(("study", None, None, list(range(len(plan.problems)))))
        for level, group, problem, problems in scopes:
            kinds = {kind_of(results.references[k].front) for k in problems}
            kind = kinds.pop() if len(kinds) == 1 else "mixed"
            for k, label in enumerate(results.algorithms):
                planned, finished = results.planned(k, problems), results.finished(k, problems)
                failed = sum(run.status == "failed" for run in planned)
                rate = float(np.mean([run.feasible for run in finished])) if finished else None
                counts = [len(planned), len(finished), failed, len(planned) - len(finished) - failed, rate]
                spreads = [value for measure in measures for value in quartiles(results.values(measure, k, problems)).tolist()]
                yield [level, group, problem, label, kind, *counts, results.target, n_reached(results, k, problems), *spreads]

    return header, rows()


def _tests(results: Results, families: Sequence[Family]) -> tuple[list[str], Iterator[list]]:
    """Return header and rows of all tests: of pairs of algorithms, and Friedman's with the average ranks."""
    header = ["level", "scope", "measure", "test", "first", "second", "n_first", "n_second", "statistic", "p", "p_holm"]
    header += ["significant", "effect_name", "effect", "better", "equal", "worse"]

    def rows() -> Iterator[list]:
        labels = results.algorithms
        for level, comparisons in families:
            conclusive = could_tell([comparison for _, comparison in comparisons])
            for scope, item in comparisons:
                seeds = item.over == "seeds"
                test, effect = ("mann-whitney", "A12") if seeds else ("wilcoxon", "rank-biserial")
                for pair in item.pairs:
                    head = [level, scope, item.measure, test, labels[pair.first], labels[pair.second]]
                    verdict = _truth(pair.significant) if conclusive else "too few values"
                    wins = [None] * 3 if seeds else [pair.better, pair.equal, pair.worse]
                    head += [pair.n_first, pair.n_second]
                    yield [*head, pair.statistic, pair.p, pair.p_holm, verdict, effect, pair.effect, *wins]
                if item.friedman is not None:
                    n, outcome = item.n_blocks, item.friedman
                    for k, rank in zip(item.algorithms, outcome.ranks.tolist(), strict=True):
                        head = [level, scope, item.measure, "friedman", labels[k], None, n, None, outcome.statistic, outcome.p]
                        yield [*head, None, None, "average rank", rank, None, None, None]

    return header, rows()


def _grid(problem: PlannedProblem) -> list:
    """Return size, steps and origin of a grid; of random ones there is no map, of maps no probability and seed."""
    grid = problem.spec["grid"]
    corners, moves = steps_of(grid).values()
    steps = [corners if isinstance(corners, str) else _truth(corners), moves]
    if "random" in grid:
        family = grid["random"]
        return [family["size"], family["size"], *steps, family["p0"], family["seed"], None, None]
    return [grid["width"], grid["height"], *steps, None, None, problem.source, grid["digest"]]


def _truth(value: bool) -> str:
    return "true" if value else "false"
