"""Cheapest costs from every cell to a goal."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.search.heap import drop_first, push
from pymoo_gridpath.search.moves import Moves

#: The cost where no path leads; sums of two such numbers do not overflow.
UNREACHABLE = 2**61

# Cells that are expanded before it is asked whether to stop: milliseconds when compiled.
_POPS_AT_A_TIME = 2**13


def backward_costs(
    moves: Moves,
    step: np.ndarray,
    field: np.ndarray,
    goal: int,
    with_heading: bool = False,
    spent: np.ndarray | None = None,
    limit: int = UNREACHABLE,
    stop: Callable[[], bool] | None = None,
    enter: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the costs of the lexicographically cheapest path to a goal from every cell, or from every cell and heading.

    Of all paths with the least first cost it is one with the least second cost.

    Parameters
    ----------
    moves : Moves
    step : numpy.ndarray of int64, shape (2, 9, 8)
        First and second cost of a step along heading m (last index) after one along heading h (8: none before).
    field : numpy.ndarray of int64, shape (2, n_cells)
        First and second cost of entering each cell.
    goal : int
        Index of the goal cell.
    with_heading : bool, default False
        Whether costs depend on the heading before a step.
    spent : numpy.ndarray of int64, shape (n_cells,), optional
        Least first cost of a path from somewhere to each cell, 0 by default.
    limit : int, optional
        Cells are left out, as if no path led on, where the least first cost of what is spent and what lies ahead reaches it.
    stop : callable, optional
        Asked many times a second; if it returns True the search ends, and what it has found so far holds for nothing.
    enter : numpy.ndarray of int64, shape (2, n_cells, 8), optional
        First and second cost of entering each cell along each heading, besides.

    Returns
    -------
    costs : numpy.ndarray of int64, shape (2, n_cells) or (2, 8 * n_cells)
        Entry ``8 * cell + heading`` of the latter belongs to a path that has come to the cell along the heading.
        `UNREACHABLE` where no path leads.
    ahead : numpy.ndarray of int8, shape (n_cells,) or (8 * n_cells,)
        Heading of the first step of that path; -1 at the goal, and where no path leads.
    """
    cost = np.full((2, moves.n_cells * (8 if with_heading else 1)), UNREACHABLE)
    ahead = np.full(cost.shape[1], -1, dtype=np.int8)
    heap = np.empty((1024, 3), dtype=np.int64)
    n = 0
    for state in range(8 * goal, 8 * goal + 8) if with_heading else (goal,):
        cost[:, state] = 0
        push(heap, n, 0, 0, state)
        n += 1
    if spent is None:
        spent = np.zeros(moves.n_cells, dtype=np.int64)
    while n > 0:
        arrays = step, field, enter, with_heading, spent, limit, cost, ahead
        heap, n = _expand(moves.legal, moves.offsets, *arrays, heap, n, _POPS_AT_A_TIME)
        if n > 0 and stop is not None and stop():
            break
    return cost, ahead


@kernel
def _expand(legal, offsets, step, field, enter, with_heading, spent, limit, cost, ahead, heap, n, max_pops):
    """Expand at most so many of the ``n`` states in a heap, cheapest first; return the heap and how many it then holds."""
    n_cells = len(legal)
    pops = 0
    while n > 0 and pops < max_pops:
        first = heap[0, 0]
        second = heap[0, 1]
        state = heap[0, 2]
        drop_first(heap, n)
        n -= 1
        if first > cost[0, state] or second > cost[1, state]:
            continue
        pops += 1
        if n + 64 > len(heap):
            heap = grown(heap)
        cell = state >> 3 if with_heading else state
        for m in range(8):
            # A state with a heading can only have been reached along it.
            if with_heading and m != state & 7:
                continue
            before = cell - offsets[m]
            if before < 0 or before >= n_cells or not (legal[before] >> m) & 1:
                continue
            for h in range(8 if with_heading else 1):
                origin = 8 * before + h if with_heading else before
                heading = h if with_heading else 8
                total1 = first + step[0, heading, m] + field[0, cell]
                total2 = second + step[1, heading, m] + field[1, cell]
                if enter is not None:
                    total1 += enter[0, cell, m]
                    total2 += enter[1, cell, m]
                if total1 + spent[before] >= limit:
                    continue
                if total1 < cost[0, origin] or (total1 == cost[0, origin] and total2 < cost[1, origin]):
                    cost[0, origin] = total1
                    cost[1, origin] = total2
                    ahead[origin] = m
                    push(heap, n, total1, total2, origin)
                    n += 1
    return heap, n


@kernel
def grown(heap):
    """Return a copy of a heap with twice the room."""
    larger = np.empty((2 * heap.shape[0], heap.shape[1]), dtype=heap.dtype)
    larger[: heap.shape[0]] = heap
    return larger
