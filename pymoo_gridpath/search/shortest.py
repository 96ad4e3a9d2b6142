"""Cheapest costs from every cell to a goal."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pymoo_gridpath.compiled import kernel
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
    heap = np.empty((1024, 2), dtype=np.int64)
    n = 0
    for state in range(8 * goal, 8 * goal + 8) if with_heading else (goal,):
        cost[:, state] = 0
        _push(heap, n, 0, state)
        n += 1
    if spent is None:
        spent = np.zeros(moves.n_cells, dtype=np.int64)
    while n > 0:
        arrays = step, field, with_heading, spent, limit, cost[0], cost[1], ahead
        heap, n = _expand(moves.legal, moves.offsets, *arrays, heap, n, _POPS_AT_A_TIME)
        if n > 0 and stop is not None and stop():
            break
    return cost, ahead


@kernel
def _expand(legal, offsets, step, field, with_heading, spent, limit, first, second, ahead, heap, n, max_pops):
    """Expand at most so many of the ``n`` states in a heap, cheapest first; return the heap and how many it then holds.

    States with the same first cost come in any order: one whose second cost falls afterwards comes again.
    """
    n_cells = len(legal)
    pops = 0
    while n > 0 and pops < max_pops:
        total1 = heap[0, 0]
        state = heap[0, 1]
        _drop_first(heap, n)
        n -= 1
        if total1 > first[state]:
            continue
        pops += 1
        if n + 64 > len(heap):
            heap = grown(heap)
        cell = state >> 3 if with_heading else state
        total1 += field[0, cell]
        total2 = second[state] + field[1, cell]
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
                origin1 = total1 + step[0, heading, m]
                if origin1 > first[origin] or origin1 + spent[before] >= limit:
                    continue
                origin2 = total2 + step[1, heading, m]
                if origin1 < first[origin] or origin2 < second[origin]:
                    first[origin] = origin1
                    second[origin] = origin2
                    ahead[origin] = m
                    _push(heap, n, origin1, origin)
                    n += 1
    return heap, n


# A heap of rows (cost, state). With one key and two columns it is a quarter faster here than that of `heap`.


@kernel
def _push(heap, n, cost, state):
    """Add an entry to the ``n`` that the heap holds."""
    i = n
    while i > 0:
        up = (i - 1) >> 1
        if heap[up, 0] <= cost:
            break
        heap[i, 0] = heap[up, 0]
        heap[i, 1] = heap[up, 1]
        i = up
    heap[i, 0] = cost
    heap[i, 1] = state


@kernel
def _drop_first(heap, n):
    """Remove the least entry, ``heap[0]``, of the ``n`` that the heap holds."""
    last = n - 1
    i = 0
    down = 1
    # The gap sinks to a leaf, where the last entry fits or nearly so.
    while down < last:
        if down + 1 < last and heap[down + 1, 0] < heap[down, 0]:
            down += 1
        heap[i, 0] = heap[down, 0]
        heap[i, 1] = heap[down, 1]
        i = down
        down = 2 * i + 1
    _push(heap, i, heap[last, 0], heap[last, 1])


@kernel
def grown(heap):
    """Return a copy of a heap with twice the room."""
    larger = np.empty((2 * heap.shape[0], heap.shape[1]), dtype=heap.dtype)
    larger[: heap.shape[0]] = heap
    return larger
