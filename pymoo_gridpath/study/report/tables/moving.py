"""Tables of runs among obstacles that move: how well each algorithm keeps up with them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from pymoo_gridpath.study.report.results import Results, RunResult
from pymoo_gridpath.study.report.statistics.summaries import quartiles
from pymoo_gridpath.study.report.tables.summary import reference_phrase
from pymoo_gridpath.study.report.tables.table import NOTHING, Table, ratio, significant, spread
from pymoo_gridpath.study.specification.moving import n_epochs

#: What is counted of members at the end of each epoch.
COUNTS = ("missed", "stale", "wrong", "illegal")


def moving_problems(results: Results, problems: Sequence[int]) -> list[int]:
    """Return those problems whose obstacles move."""
    return [k for k in problems if "moving" in results.plan.problems[k].spec]


def epochs_of(results: Results, problem: int) -> int:
    """Return how many epochs a problem has whose obstacles move."""
    return n_epochs(results.plan.problems[problem].spec["moving"])


def epochs_table(results: Results, problems: Sequence[int], name: str, place: str) -> Table:
    """Return how well each algorithm keeps up with the obstacles, and whether any of its values were those of another map."""
    header = ["#", "algorithm", "mean hypervolume ratio", "mean IGD+", "least ratio of an epoch", *COUNTS]
    rows = []
    for k, label in enumerate(results.algorithms):
        runs = [run for run in results.finished(k, problems) if run.epochs is not None]
        cells = [str(k + 1), label]
        for measure, show in (("ratio", ratio), ("igd_plus", significant)):
            cells.append(spread(quartiles(results.values(measure, k, problems)), show))
        cells.append(spread(quartiles(np.array([run.epochs.ratio.min() for run in runs if run.epochs is not None])), ratio))
        rows.append([*cells, *(str(_total(runs, count)) if runs else NOTHING for count in COUNTS)])
    what = (
        f"The {epochs_of(results, problems[0])} epochs {place}: what had been found at the end of each, measured against "
        f"{reference_phrase(results, problems)} of its own map."
    )
    notes = [
        "Median [quartiles] over all finished runs of the mean over the epochs, and of the epoch in which a run was worst. "
        "Counts are of members of populations, over all epochs and runs: missed, kept by the algorithm with values of an "
        "earlier map over a generation, and renewed then; at the end of an epoch stale, with values of another map, wrong, "
        "with objectives that were others by then, and illegal, taken for legal paths and none."
    ]
    return Table(f"{name}-epochs", what, header, rows, left=2, notes=notes)


def epoch_rows(results: Results) -> tuple[list[str], Iterator[list]]:
    """Return header and rows of the tidy table of all epochs of all runs."""
    measures = ("ratio", "igd_plus", "share", "n_points", "evaluations", *COUNTS)

    def rows() -> Iterator[list]:
        for run in results.runs:
            if run.epochs is None:
                continue
            problem, epochs = results.plan.problems[run.problem], results.references[run.problem].epochs
            for epoch, front in enumerate(epochs):
                names = [problem.group, problem.label, results.algorithms[run.algorithm], run.seed, run.key, epoch, len(front)]
                yield [*names, *(getattr(run.epochs, measure)[epoch].item() for measure in measures)]

    return ["group", "problem", "algorithm", "seed", "key", "epoch", "reference_points", *measures], rows()


def _total(runs: Sequence[RunResult], count: str) -> int:
    return sum(int(getattr(run.epochs, count).sum()) for run in runs)
