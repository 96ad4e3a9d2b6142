"""Jump point search: A* that opens only cells where shortest paths may have to bend.

Among shortest paths between two cells it keeps to those that go diagonally first. From a cell that was come to along a heading,
all neighbours are then left out that a path around the cell reaches as well; those that stay are the natural ones, which are
there on an open field, and forced ones, beside an obstacle. A jump goes on along a heading over cells that have no forced
neighbour, and what it passes is tested, not opened.
"""

from __future__ import annotations

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.neighbourhood import Neighbourhood
from pymoo_gridpath.search.arrays import grown
from pymoo_gridpath.search.counted import DIAGONAL, HEURISTICS, STRAIGHT, Found, estimate
from pymoo_gridpath.search.heap import drop_first, push
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.sight import towards

# The rules by which a jump ends: diagonal steps past an occupied cell, none such, and straight steps alone.
_ROUNDING, _KEEPING, _ORTHOGONAL = np.int64(0), np.int64(1), np.int64(2)


def jump_points(moves: Moves, start: int, goal: int, neighbourhood: Neighbourhood, heuristic: str = "octile") -> Found:
    """Search for a shortest path by jumps.

    Parameters
    ----------
    moves : Moves
        With all eight headings.
    start, goal : int
    neighbourhood : Neighbourhood
        The steps of the grid. Without diagonal ones jumps are those of `orthogonal_jump_points`.
    heuristic : str
        As of `best_first`; with "manhattan" the path need not be a shortest one.

    References
    ----------
    D. Harabor and A. Grastien, "Online graph pruning for pathfinding on grid maps", AAAI 2011; for corners that may not be cut,
    the same authors, "Improving jump point search", ICAPS 2014.
    """
    rule = _ORTHOGONAL if not neighbourhood.diagonal else _ROUNDING if neighbourhood.rounds else _KEEPING
    return _search(moves, start, goal, rule, HEURISTICS[heuristic])


def orthogonal_jump_points(moves: Moves, start: int, goal: int) -> Found:
    """Search for a shortest path of straight steps by jumps, up and down first; what is left in x and y is the estimate."""
    return _search(moves, start, goal, _ORTHOGONAL, HEURISTICS["manhattan"])


def _search(moves: Moves, start: int, goal: int, rule: np.int64, heuristic: int) -> Found:
    path, counts = _jump_points(moves.legal, moves.offsets, moves.width, start, goal, rule, heuristic)
    return Found(path, *(int(count) for count in counts))


@kernel
def _has(steps, m):
    return (steps >> (m & 7)) & 1 == 1


@kernel
def kept_headings(legal, offsets, cell, m, rule):
    """Return along which headings to go on from a cell that was come to along heading m, a bit each; 8 for the start."""
    steps = np.int64(legal[cell])
    if rule == _ORTHOGONAL:
        straight = steps & 0b01010101
        if m == 8 or m & 3 == 2:
            # All but back.
            return straight if m == 8 else straight & ~(1 << ((m + 4) & 7))
        return straight & ((1 << m) | forced_headings(legal, offsets, cell, m, rule))
    if m == 8:
        return steps
    natural = 1 << m
    if m & 1:
        natural |= 1 << ((m + 1) & 7) | 1 << ((m - 1) & 7)
    return steps & (natural | forced_headings(legal, offsets, cell, m, rule))


@kernel
def forced_headings(legal, offsets, cell, m, rule):
    """Return along which headings the forced neighbours lie of a cell that was come to along heading m, a bit each."""
    steps = np.int64(legal[cell])
    found = 0
    for side in (-1, 1):
        if rule == _ORTHOGONAL:
            # What is beside was blocked one cell before.
            if m & 3 == 0 and _has(steps, m + 2 * side) and not _has(legal[cell - offsets[m]], m + 2 * side):
                found |= 1 << ((m + 2 * side) & 7)
        elif m & 1:
            # Only where one occupied cell may be passed can the cell behind be such.
            if rule == _ROUNDING and not _has(steps, m + 3 * side) and _has(steps, m + 2 * side):
                found |= 1 << ((m + 2 * side) & 7)
        elif rule == _ROUNDING:
            if not _has(steps, m + 2 * side) and _has(steps, m + side):
                found |= 1 << ((m + side) & 7)
        elif _has(steps, m + 2 * side) and not _has(steps, m + 3 * side):
            found |= 1 << ((m + 2 * side) & 7)
            if _has(steps, m + side):
                found |= 1 << ((m + side) & 7)
    return found


@kernel
def _along(legal, offsets, cell, m, goal, rule, seen, counts):
    """Return the first cell along a heading that is the goal or has a forced neighbour; -1 if there is none."""
    while _has(legal[cell], m):
        cell += offsets[m]
        seen[cell] = True
        counts[2] += 1
        if cell == goal or forced_headings(legal, offsets, cell, m, rule):
            return cell
    return -1


@kernel
def _jump(legal, offsets, cell, m, goal, rule, seen, counts):
    """Return the next cell along a heading that is to be opened; -1 if there is none."""
    if rule == _ORTHOGONAL and m & 3 == 2:
        first, second = 0, 4
    elif m & 1:
        first, second = (m + 1) & 7, (m - 1) & 7
    else:
        return _along(legal, offsets, cell, m, goal, rule, seen, counts)
    while _has(legal[cell], m):
        cell += offsets[m]
        seen[cell] = True
        counts[2] += 1
        if cell == goal or forced_headings(legal, offsets, cell, m, rule):
            return cell
        if _along(legal, offsets, cell, first, goal, rule, seen, counts) >= 0:
            return cell
        if _along(legal, offsets, cell, second, goal, rule, seen, counts) >= 0:
            return cell
    return -1


@kernel
def _jump_points(legal, offsets, width, start, goal, rule, heuristic):
    cost, came = np.empty(len(legal), dtype=np.int64), np.full(len(legal), -1, dtype=np.int64)
    state, seen = np.zeros(len(legal), dtype=np.uint8), np.zeros(len(legal), dtype=np.bool_)
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
        n = _take(legal, offsets, width, goal, rule, heuristic, cost, came, state, seen, counts, heap, n)
    counts[3] = np.count_nonzero(seen)
    return _between(offsets, width, came, start, goal, state[goal] == 2), counts


@kernel
def _take(legal, offsets, width, goal, rule, heuristic, cost, came, state, seen, counts, heap, n):
    """Take jump points from a heap of ``n`` entries while there is room, and return how many it has then; none at the goal."""
    gx, gy = goal % width, goal // width
    while n > 0 and n + 8 <= len(heap):
        cell = heap[0, 2]
        drop_first(heap, n)
        n -= 1
        if state[cell] == 2:
            continue
        state[cell] = 2
        seen[cell] = True
        counts[1] += 1
        if cell == goal:
            return 0
        m = 8 if came[cell] < 0 else towards(width, came[cell], cell)
        kept = kept_headings(legal, offsets, cell, m, rule)
        for m in range(8):
            if not _has(kept, m):
                continue
            other = _jump(legal, offsets, cell, m, goal, rule, seen, counts)
            if other < 0 or state[other] == 2:
                continue
            dx, dy = other % width - cell % width, other // width - cell // width
            total = cost[cell] + max(abs(dx), abs(dy)) * (DIAGONAL if m & 1 else STRAIGHT)
            if state[other] == 1 and total >= cost[other]:
                continue
            if state[other] == 0:
                state[other] = 1
                counts[0] += 1
            cost[other] = total
            came[other] = cell
            left = estimate(heuristic, gx - other % width, gy - other // width)
            push(heap, n, total + left, left, other)
            n += 1
    return n


@kernel
def _between(offsets, width, came, start, goal, reached):
    """Return the cells from the start to the goal, those that were jumped over included."""
    n = 1 if reached else 0
    cell = goal
    while reached and cell != start:
        before = came[cell]
        n += max(abs(cell % width - before % width), abs(cell // width - before // width))
        cell = before
    path = np.empty(n, dtype=np.int64)
    cell, before = goal, came[goal]
    for k in range(n - 1, -1, -1):
        path[k] = cell
        if cell != start:
            cell -= offsets[towards(width, before, cell)]
            if cell == before and cell != start:
                before = came[cell]
    return path
