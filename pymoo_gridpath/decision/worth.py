"""Which of many paths are worth keeping."""

from __future__ import annotations

import numpy as np
from moocore import is_nondominated

from pymoo_gridpath.decision.measures import PathMeasures
from pymoo_gridpath.operators.bands import boxes, range_of_front


def worth_keeping(problem, measures: PathMeasures, X: np.ndarray, band: float = 0.0) -> tuple[np.ndarray, bool]:
    """Return the rows of genes that a trade-off set keeps, in its order, and whether they are legal; see `TradeOffSet`."""
    paths = problem.decode(X)
    legal = measures.legal(paths)
    feasible = bool(legal.any())
    if not feasible:
        crossed = np.asarray(paths.interfering_cells)
        legal = crossed == crossed.min()
    rows = np.flatnonzero(legal)
    paths = paths[rows]
    F, turn = np.asarray(problem.score(paths), dtype=float), np.asarray(paths.turn)
    point = boxes(F, *range_of_front(F), band) if band else F
    front = np.flatnonzero(is_nondominated(point, keep_weakly=True))
    order = sorted(front, key=lambda k: (*point[k].tolist(), turn[k], *F[k].tolist(), *np.ravel(X[rows[k]]).tolist()))
    first = np.ones(len(order), dtype=bool)
    first[1:] = (point[order[1:]] != point[order[:-1]]).any(axis=1)
    kept = sorted(np.array(order)[first], key=lambda k: F[k].tolist())
    return rows[kept], feasible
