"""Lengths of the shortest paths, of all or of those that are cheapest in costs of cells, without a graph beside the grid.

Memory is that of one number a cell, twice where costs are given; lists and heaps take what the front of the search takes.
"""

from __future__ import annotations

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.neighbourhood import LENGTHS
from pymoo_gridpath.search.heap import drop_key, push_key
from pymoo_gridpath.search.moves import Moves

# Costs are compared up to this share of them: those that are sums of potentials are exact, others nearly.
_SAME = 1e-12

# Cells that cost more than the goal by this share lie on no path to it that is cheapest up to the rounding above.
_BEYOND = 1e-4

# Cells taken from the list of a whole number of cells of length lead to the next and the one after it.
_LISTS = 3

_NO_COSTS = np.empty(0)


def cells_of_shortest(moves: Moves, start: int, goal: int) -> int:
    """Return how many cells a shortest path between two cells visits, 0 if there is none.

    Steps lead both ways.
    """
    length = _lengths(moves, _NO_COSTS, _NO_COSTS, goal, start)
    return _n_cells(moves.legal, moves.offsets, LENGTHS, length, start, goal)


def cheapest_length(moves: Moves, field: np.ndarray, start: int, goal: int) -> float:
    """Return the length of the shortest of the paths that are cheapest by the sum of costs of their cells.

    Steps lead both ways.

    Parameters
    ----------
    moves : Moves
    field : numpy.ndarray of float, shape (n_cells,)
        Costs, not negative.
    start, goal : int
        Cells that a path joins.

    Returns
    -------
    float
        Cells, ``inf`` if there is no path. Sums of costs that differ by no more than a share of 1e-12 are the same.
    """
    cost = np.full(moves.n_cells, np.inf)
    cost[start] = 0.0
    keys, cells = np.zeros(1024), np.full(1024, start, dtype=np.int32)
    n = 1
    while n > 0:
        n = _spread(moves.legal, moves.offsets, field, goal, 1 + _BEYOND, cost, keys, cells, n)
        if n > 0:
            keys, cells = (np.concatenate([part, np.empty_like(part)]) for part in (keys, cells))
    return float(_lengths(moves, field, cost, goal, start)[start])


def _lengths(moves: Moves, field: np.ndarray, cost: np.ndarray, begin: int, end: int) -> np.ndarray:
    """Return the lengths of the shortest ways from cells to ``begin``, of those that are needed to know that of ``end``.

    Where ``cost`` is given, ways are of steps alone that the cheapest paths from ``end`` take.
    """
    length = np.full(moves.n_cells, np.inf)
    lists = np.empty((_LISTS, 1024), dtype=np.int32)
    lists[0, 0], length[begin] = begin, 0.0
    # What is in each list, how many cells of the first have been taken, and the whole number of cells of length of it.
    counts = np.array([1, 0, 0, 0, 0])
    while _follow(moves.legal, moves.offsets, LENGTHS, field, cost, 1 + _SAME, end, length, lists, counts):
        lists = np.concatenate([lists, np.empty_like(lists)], axis=1)
    return length


@kernel
def _spread(legal, offsets, field, goal, beyond, cost, keys, cells, n):
    """Lower the costs of cells, cheapest first, until all that the goal may need are known or there is no room; return n.

    ``keys`` and ``cells`` are a heap of n entries, of four below each; 0 are left when all is done.
    """
    while n > 0:
        if n + 8 > len(keys):
            return n
        key = keys[0]
        cell = cells[0]
        n -= 1
        drop_key(keys, cells, n)
        if key > cost[goal] * beyond:
            return 0
        if key > cost[cell]:
            continue
        steps = legal[cell]
        for m in range(8):
            if (steps >> m) & 1:
                head = cell + offsets[m]
                total = key + field[head]
                if total < cost[head]:
                    cost[head] = total
                    push_key(keys, cells, n, total, head)
                    n += 1
    return 0


@kernel
def _follow(legal, offsets, lengths, field, cost, same, end, length, lists, counts):
    """Go back from cell to cell, nearest first, until the end is reached or all is; return whether room is wanting.

    No step is shorter than a cell, so that of cells whose lengths have the same whole part none leads to another.
    """
    n_lists, room = lists.shape
    while True:
        now = counts[n_lists + 1]
        here = now % n_lists
        while counts[n_lists] < counts[here]:
            for k in range(n_lists):
                if k != here and counts[k] + 8 > room:
                    return True
            cell = lists[here, counts[n_lists]]
            counts[n_lists] += 1
            # Some have been found to be nearer since.
            if np.int64(length[cell]) != now:
                continue
            if cell == end:
                return False
            steps = legal[cell]
            for m in range(8):
                if not (steps >> m) & 1:
                    continue
                tail = cell + offsets[m]
                total = length[cell] + lengths[m]
                if total >= length[tail]:
                    continue
                if len(cost) > 0 and not cost[tail] + field[cell] <= cost[cell] * same:
                    continue
                # It stands in that list already if its length has the same whole part.
                at = np.int64(total)
                if length[tail] == np.inf or np.int64(length[tail]) != at:
                    lists[at % n_lists, counts[at % n_lists]] = tail
                    counts[at % n_lists] += 1
                length[tail] = total
        counts[here] = 0
        counts[n_lists] = 0
        counts[n_lists + 1] = now + 1
        left = 0
        for k in range(n_lists):
            left += counts[k]
        if left == 0:
            return False


@kernel
def _n_cells(legal, offsets, lengths, length, cell, goal):
    """Return how many cells there are from one to a goal along lengths that fall to 0 there; 0 where they are infinite."""
    if length[cell] == np.inf:
        return 0
    n = 1
    while cell != goal:
        for m in range(8):
            if (legal[cell] >> m) & 1 and length[cell + offsets[m]] + lengths[m] == length[cell]:
                cell += offsets[m]
                break
        n += 1
    return n
