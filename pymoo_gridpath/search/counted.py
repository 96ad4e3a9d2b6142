"""Searches for one path that count the cells they open and close: A*, its kin, and breadth-first."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.grid import SQRT2
from pymoo_gridpath.search.arrays import grown
from pymoo_gridpath.search.heap import drop_first, push
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.route import DX, DY

#: Lengths of steps in whole numbers, which order all lengths of paths across up to 10,000 x 10,000 cells correctly.
STRAIGHT = np.int64(2**32)
DIAGONAL = np.int64(round(SQRT2 * 2**32))

#: Estimates of what is left to the goal, by the number by which kernels know them.
HEURISTICS = {"none": 0, "octile": 1, "euclidean": 2, "chebyshev": 3, "manhattan": 4}

# The order in which neighbours are looked at: below, right, above, left, and then the diagonal ones, counter-clockwise from
# below left. It is that of PathFinding.js if rows count from the bottom.
_ORDER = np.array([6, 0, 2, 4, 5, 7, 1, 3])


class Found(NamedTuple):
    """The path that a search has found, and what it has looked at.

    Attributes
    ----------
    path : numpy.ndarray of int64, shape (n,)
        Indices of its cells; empty if there is no path.
    opened : int
        Cells that were put on the list of those to go on from, each counted once.
    closed : int
        Cells that were gone on from, the goal included.
    tested : int
        Cells that a jump passed, as often as one did.
    n_cells : int
        Cells that were opened, closed or tested, each counted once.
    """

    path: np.ndarray
    opened: int
    closed: int
    tested: int
    n_cells: int


def best_first(moves: Moves, start: int, goal: int, heuristic: str = "none", greedy: bool = False) -> Found:
    """Search for a path, always from the cell of least length so far and estimate of what is left, together.

    No cell is closed twice. With an estimate that never falls by more than a step costs, all but "manhattan", the path is a
    shortest one.

    Parameters
    ----------
    moves : Moves
    start, goal : int
    heuristic : str
        One of `HEURISTICS`; "none" is Dijkstra's search. Of equal cells the one with less left goes first.
    greedy : bool
        Whether the estimate alone counts; of cells that are equal in it, the one of least length so far goes first.
    """
    return _found(*_best_first(moves.legal, moves.offsets, moves.width, start, goal, HEURISTICS[heuristic], greedy))


def breadth_first(moves: Moves, start: int, goal: int) -> Found:
    """Search for a path of the fewest steps, from cells in the order in which they were opened."""
    return _found(*_breadth_first(moves.legal, moves.offsets, start, goal))


def _found(path: np.ndarray, counts: np.ndarray) -> Found:
    return Found(path, *(int(count) for count in counts))


@kernel
def estimate(rule, dx, dy):
    """Return an estimate of the length of a path to a cell that lies so far away in x and in y."""
    dx, dy = abs(dx), abs(dy)
    low = min(dx, dy)
    if rule == 1:
        return (max(dx, dy) - low) * STRAIGHT + low * DIAGONAL
    if rule == 2:
        return np.int64(np.sqrt(dx * dx + dy * dy) * STRAIGHT)
    if rule == 3:
        return max(dx, dy) * STRAIGHT
    if rule == 4:
        return (dx + dy) * STRAIGHT
    return np.int64(0)


@kernel
def _best_first(legal, offsets, width, start, goal, rule, greedy):
    cost, came = np.empty(len(legal), dtype=np.int64), np.empty(len(legal), dtype=np.int8)
    # 1 for cells that are opened, 2 for those that are closed.
    state = np.zeros(len(legal), dtype=np.uint8)
    heap = np.empty((1024, 3), dtype=np.int64)
    push(heap, 0, 0, 0, start)
    n = 1
    state[start] = 1
    cost[start] = 0
    counts = np.zeros(4, dtype=np.int64)
    counts[0] = 1
    while n > 0:
        if n + 8 > len(heap):
            heap = grown(heap)
        n = _take(legal, offsets, width, goal, rule, greedy, cost, came, state, counts, heap, n)
    counts[3] = counts[0]
    return back(offsets, came, start, goal, state[goal] == 2), counts


@kernel
def _take(legal, offsets, width, goal, rule, greedy, cost, came, state, counts, heap, n):
    """Take cells from a heap of ``n`` entries while there is room, and return how many it has then; none at the goal."""
    gx, gy = goal % width, goal // width
    while n > 0 and n + 8 <= len(heap):
        cell = heap[0, 2]
        drop_first(heap, n)
        n -= 1
        if state[cell] == 2:
            continue
        state[cell] = 2
        counts[1] += 1
        if cell == goal:
            return 0
        steps, so_far = legal[cell], cost[cell]
        dx, dy = gx - cell % width, gy - cell // width
        for m in range(8):
            if not (steps >> m) & 1:
                continue
            other = cell + offsets[m]
            if state[other] == 2:
                continue
            total = so_far + (DIAGONAL if m & 1 else STRAIGHT)
            if state[other] == 1 and total >= cost[other]:
                continue
            if state[other] == 0:
                state[other] = 1
                counts[0] += 1
            cost[other] = total
            came[other] = m
            left = estimate(rule, dx - DX[m], dy - DY[m])
            if greedy:
                push(heap, n, left, total, other)
            else:
                push(heap, n, total + left, left, other)
            n += 1
    return n


@kernel
def _breadth_first(legal, offsets, start, goal):
    came = np.full(len(legal), -1, dtype=np.int8)
    queue = np.empty(len(legal), dtype=np.int64)
    queue[0] = start
    came[start] = 8
    opened, closed = 1, 0
    while closed < opened:
        cell = queue[closed]
        closed += 1
        if cell == goal:
            break
        for m in _ORDER:
            other = cell + offsets[m]
            if (legal[cell] >> m) & 1 and came[other] < 0:
                came[other] = m
                queue[opened] = other
                opened += 1
    path = back(offsets, came, start, goal, came[goal] >= 0)
    return path, np.array([opened, closed, 0, opened])


@kernel
def back(offsets, came, start, goal, reached):
    """Return the cells from the start to the goal, by the headings along which each was come to."""
    n = 0
    cell = goal
    while reached and cell != start:
        cell -= offsets[came[cell]]
        n += 1
    path = np.empty(n + 1 if reached else 0, dtype=np.int64)
    cell = goal
    for k in range(len(path) - 1, -1, -1):
        path[k] = cell
        if k > 0:
            cell -= offsets[came[cell]]
    return path
