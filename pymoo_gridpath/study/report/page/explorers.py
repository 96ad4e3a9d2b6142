"""Pages to choose a path from, one for the merged front of each algorithm."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from pymoo_gridpath.decision import TradeOffSet
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.explorer.page import page_text
from pymoo_gridpath.problems import GridPathProblem
from pymoo_gridpath.quality import merge_fronts
from pymoo_gridpath.study.planning.build import build_problem
from pymoo_gridpath.study.report.page.blocks import LinkedPages
from pymoo_gridpath.study.report.results import Results
from pymoo_gridpath.study.running.store import Store
from pymoo_gridpath.study.specification import own

#: From the keys of finished runs of an algorithm on a problem to the problem, as these runs coded it, and the rows of each.
Rows = Callable[[int, Sequence[str]], tuple[GridPathProblem, list[np.ndarray]]]

_PACKAGE = __name__.partition(".")[0]

# Of the size of an objective; what differs by no more is the same point.
_SAME = 1e-6


def rows_of(store: Store, results: Results) -> Rows:
    """Return what reads rows of genes out of a study."""

    def read(problem: int, keys: Sequence[str]) -> tuple[GridPathProblem, list[np.ndarray]]:
        planned = results.plan.problems[problem]
        records, cells = (
            [store.read(key) for key in keys],
            (store.read_grid(planned), planned.place, store.read_original(planned)),
        )
        content = records[0].problem
        for thing in (*content["objectives"], content["representation"]):
            # Nothing is imported because a stored file names it.
            if not isinstance(thing, str) and not str(thing["class"]).startswith(f"{_PACKAGE}."):
                raise GridPathError(f"{own.shown(thing)} is of another package, expected things of {_PACKAGE} alone")
        return build_problem(content, *cells), [record.X for record in records]

    return read


def linked_pages(results: Results, problem: int, name: str, names: dict[str, str], rows: Rows) -> LinkedPages:
    """Return the pages of the merged fronts on a problem, not made yet.

    Parameters
    ----------
    results : Results
    problem : int
        Whose runs have kept their fronts.
    name : str
        Of the group, as it serves in file names.
    names : dict
        That of each algorithm, likewise.
    rows : callable
        See `Rows`.
    """
    label = results.plan.problems[problem].label
    pages = []
    for k, algorithm in enumerate(results.algorithms):
        runs = [run for run in results.finished(k, [problem]) if run.F is not None and len(run.F)]
        if runs:
            keys, fronts = [run.key for run in runs], [run.F for run in runs if run.F is not None]
            make = partial(_page, rows, problem, keys, fronts, f"{algorithm} on {label}")
            pages.append((algorithm, f"front-{name}-{names[algorithm]}.html", make))
    return LinkedPages(f"To look at and choose from, the paths of the merged front on {label} that was found by", tuple(pages))


def _page(rows: Rows, problem: int, keys: Sequence[str], fronts: list[np.ndarray], title: str) -> str | None:
    """Return a page, or None if the stored genes are not those of the front."""
    try:
        solved, genes = rows(problem, keys)
        found = TradeOffSet.from_genes(solved, np.concatenate(genes))
    except (GridPathError, ValueError):
        return None  # damaged since, of other genes than the problem has, or of an objective that is somebody's own
    merged = merge_fronts(fronts)
    far = np.abs(merged[:, None] - found.F) > _SAME * np.maximum(np.abs(merged), 1.0)[:, None]
    lost = np.all(np.any(far, axis=2), axis=1)
    return None if lost.any() else page_text(found, title)
