"""Roads through the free cells of a grid: shortest ways to them, and what makes their steps legal."""

from __future__ import annotations

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.search.arrays import grown
from pymoo_gridpath.search.counted import DIAGONAL, STRAIGHT, back
from pymoo_gridpath.search.heap import drop_first, push
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.shortest import UNREACHABLE


def way_to(moves: Moves, start: int, wanted: np.ndarray) -> np.ndarray:
    """Return a shortest path from a cell to the nearest of some cells.

    Parameters
    ----------
    moves : Moves
    start : int
        Index of a cell.
    wanted : numpy.ndarray of bool, shape (n_cells,)

    Returns
    -------
    numpy.ndarray of int64, shape (n,)
        Indices of the cells of the path; the start alone if it is wanted, none if there is no path. Of cells that are equally
        near it leads to the one with the least index.
    """
    return _way_to(moves.legal, moves.offsets, start, np.ascontiguousarray(wanted))


def with_legal_steps(moves: Moves, road: np.ndarray) -> np.ndarray:
    """Return the cells of a road, and those beside its diagonal steps that lead around the illegal ones.

    A line that is one cell wide may step diagonally where a path may not: past an obstacle whose corner may not be cut. The
    cell on the other side of the step, if it is free, joins the two.

    Parameters
    ----------
    moves : Moves
    road : numpy.ndarray of bool, shape (n_cells,)
        Free cells.

    Returns
    -------
    numpy.ndarray of bool, shape (n_cells,)
    """
    lane = road.reshape(moves.height, moves.width)
    legal = moves.legal.reshape(lane.shape)
    # A cell that no step leads from joins nothing.
    free, wider = legal > 0, lane.copy()
    lower, upper, left, right = np.s_[:-1], np.s_[1:], np.s_[:-1], np.s_[1:]
    for here, there, heading in ((left, right, 1), (right, left, 3)):
        torn = lane[lower, here] & lane[upper, there] & (legal[lower, here] >> np.uint8(heading) & 1 == 0)
        wider[lower, there] |= torn & free[lower, there]
        wider[upper, here] |= torn & free[upper, here]
    return wider.ravel()


@kernel
def _way_to(legal, offsets, start, wanted):
    cost, came = np.full(len(legal), UNREACHABLE), np.empty(len(legal), dtype=np.int8)
    heap = np.empty((1024, 3), dtype=np.int64)
    push(heap, 0, 0, start, start)
    n = 1
    cost[start] = 0
    reached = -1
    while n > 0 and reached < 0:
        if n + 8 > len(heap):
            heap = grown(heap)
        n, reached = _take(legal, offsets, wanted, cost, came, heap, n)
    return back(offsets, came, start, reached, True) if reached >= 0 else np.empty(0, dtype=np.int64)


@kernel
def _take(legal, offsets, wanted, cost, came, heap, n):
    """Take cells from a heap of ``n`` entries while there is room; return how many it has then, and a wanted cell, or -1."""
    while n > 0 and n + 8 <= len(heap):
        so_far, cell = heap[0, 0], heap[0, 2]
        drop_first(heap, n)
        n -= 1
        if so_far > cost[cell]:
            continue
        if wanted[cell]:
            return n, cell
        for m in range(8):
            if not (legal[cell] >> m) & 1:
                continue
            other = cell + offsets[m]
            total = so_far + (DIAGONAL if m & 1 else STRAIGHT)
            if total < cost[other]:
                cost[other] = total
                came[other] = m
                push(heap, n, total, other, other)
                n += 1
    return n, -1
