"""The best path by a single objective: one search from the goal, and the cells of all that are as good, from the start."""

from __future__ import annotations

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.exact.budget import Meter
from pymoo_gridpath.exact.costs import Costs
from pymoo_gridpath.exact.labels import Front
from pymoo_gridpath.exact.nearness import WHOLE
from pymoo_gridpath.exact.tie_break import smoothest_paths
from pymoo_gridpath.search import UNREACHABLE, Moves
from pymoo_gridpath.search.arrays import grown
from pymoo_gridpath.search.heap import drop_key, push_key

# Cells that are taken from the heap between two looks at the budget.
_POPS_AT_A_TIME = 2**16


def front_of_one(moves: Moves, costs: Costs, start: int, goal: int, meter: Meter) -> Front:
    """Return the path of least cost; of several, that which `smoothest_paths` chooses.

    Parameters
    ----------
    moves : Moves
    costs : Costs
        Of one objective that does not depend on headings.
    start, goal : int
    meter : Meter
        Ends the search when a budget is used up; there is no path then.
    """
    step, field = np.ascontiguousarray(costs.step[0, 8]), costs.field[0]
    enter = None if costs.enter is None else costs.enter[0]
    ahead = np.full(moves.n_cells, UNREACHABLE)
    ahead[goal] = 0
    keys, cells = np.zeros(1024, dtype=np.int64), np.full(1024, goal, dtype=np.int32)
    meter.n_fixed = ahead.nbytes + costs.nbytes
    n = 1
    while n > 0:
        meter.check(n, keys.nbytes + cells.nbytes)
        if meter.message:
            return Front([], np.empty((0, 1), dtype=np.int64))
        arrays = moves.legal, moves.offsets, step, field, enter
        n = _search(*arrays, start, ahead, keys, cells, n, _POPS_AT_A_TIME)
        if n + 8 > len(keys):
            keys, cells = (np.concatenate([part, np.empty_like(part)]) for part in (keys, cells))
    closed = _best(moves.legal, moves.offsets, step, field, enter, start, goal, ahead)
    meter.note(len(closed), closed.nbytes)
    end = np.flatnonzero(closed[:, 0] == goal)
    paths = smoothest_paths(moves, costs, closed, end, meter)
    return Front(paths, ahead[start].reshape(1, 1), WHOLE)


@kernel
def _search(legal, offsets, step, field, enter, start, ahead, keys, cells, n, max_pops):
    """Take cells from a heap, those with the least cost to the goal first, until all that may lead there from the start are.

    Return how many are in the heap: 0 when all is done, else it has no room or ``max_pops`` have been taken.
    """
    pops = 0
    while n > 0 and pops < max_pops:
        if n + 8 > len(keys):
            return n
        key = keys[0]
        cell = cells[0]
        n -= 1
        drop_key(keys, cells, n)
        if key > ahead[start]:
            return 0
        if key > ahead[cell]:
            continue
        pops += 1
        for m in range(8):
            before = cell - offsets[m]
            if before < 0 or before >= len(legal) or not (legal[before] >> m) & 1:
                continue
            total = key + step[m] + field[cell]
            if enter is not None:
                total += enter[cell, m]
            if total < ahead[before]:
                ahead[before] = total
                push_key(keys, cells, n, total, before)
                n += 1
    return n


@kernel
def _best(legal, offsets, step, field, enter, start, goal, ahead):
    """Return the cells of all paths of least cost, each with the number of one before it, int32, shape (n, 2)."""
    closed = np.empty((1024, 2), dtype=np.int32)
    seen = np.zeros(len(legal), dtype=np.bool_)
    closed[0, 0] = start
    closed[0, 1] = -1
    seen[start] = True
    n = 1
    k = 0
    while k < n:
        if n + 8 > len(closed):
            closed = grown(closed)
        k, n = _add_next(legal, offsets, step, field, enter, goal, ahead, seen, closed, k, n)
    return closed[:n].copy()


@kernel
def _add_next(legal, offsets, step, field, enter, goal, ahead, seen, closed, k, n):
    """Add the cells behind the ``n`` that are closed, from number ``k`` on, as long as there is room; return both then."""
    while k < n and n + 8 <= len(closed):
        cell = np.int64(closed[k, 0])
        if cell != goal:
            for m in range(8):
                if not (legal[cell] >> m) & 1:
                    continue
                after = cell + offsets[m]
                total = ahead[after] + step[m] + field[after]
                if enter is not None:
                    total += enter[after, m]
                if total == ahead[cell] and not seen[after]:
                    seen[after] = True
                    closed[n, 0] = after
                    closed[n, 1] = k
                    n += 1
        k += 1
    return k, n
