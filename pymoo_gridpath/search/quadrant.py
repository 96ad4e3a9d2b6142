"""The walk of quadrant selection: straight for the goal, and around obstacles both ways.

From a cell the walk steps in the direction of the signs of what is left in x and y, until that step is not legal: it has hit
an obstacle. There it branches. Each branch follows the obstacle on its side until it may leave it, and runs on to the next hit
or to the goal. What follows a hit depends on its cell alone, and hits come ever nearer to the goal, so that all branches
together are a graph without cycles: its nodes are the cells of hits, its edges the stretches from one to the next.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.grid import SQRT2, OccupancyGrid
from pymoo_gridpath.search.alternatives import GOAL, NOWHERE, measure
from pymoo_gridpath.search.arrays import room
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.route import DX, DY
from pymoo_gridpath.search.sequences import append_without_loops
from pymoo_gridpath.search.sight import sign_heading, towards


def _scans() -> tuple[np.ndarray, np.ndarray]:
    """Return what a turn of headings comes to, clockwise and counter-clockwise, from each heading m on.

    Returns
    -------
    tried : numpy.ndarray of int64, shape (2, 8, 256)
        How many headings are tried until one is legal, that one included, by the legal ones as bits; 8 if there is none.
    headings : numpy.ndarray of uint8, shape (2, 8, 9)
        Which these are, a bit each, by their number.
    """
    tried, headings = np.full((2, 8, 256), 8, dtype=np.int64), np.zeros((2, 8, 9), dtype=np.uint8)
    for k in range(7, -1, -1):
        turned = (np.arange(8) + np.array([[-k], [k]])) % 8
        tried[(np.arange(256) >> turned[:, :, None]) & 1 == 1] = k + 1
        headings[:, :, k + 1 :] |= (1 << turned[:, :, None]).astype(np.uint8)
    return tried, headings


# Most of the time of the walk would go into these turns.
_TRIED, _HEADINGS_TRIED = _scans()


class Branches(NamedTuple):
    """All that the walk finds: stretches from hit to hit.

    Stretch 0 leads from the start; stretches ``1 + 2 i`` and ``2 + 2 i`` from hit i, clockwise and counter-clockwise.

    Attributes
    ----------
    hits : numpy.ndarray of int64, shape (n,)
        Indices of the cells where an obstacle is hit.
    to : numpy.ndarray of int64, shape (2 n + 1,)
        Number of the hit that each stretch leads to, `GOAL` or `NOWHERE`.
    cells : numpy.ndarray of int64
    ends : numpy.ndarray of int64, shape (2 n + 2,)
        Stretch e has the cells ``cells[ends[e]:ends[e + 1]]``, both hits included, without loops.
    measures : numpy.ndarray of int64, shape (2 n + 1, 3)
        Straight steps, diagonal steps and total turn, in units of 45 degrees, of each stretch.
    first, last : numpy.ndarray of int64, shape (2 n + 1,)
        Headings of its first and last step; -1 if it has none.
    n_probes, n_cells, n_free : int
        How often a step was tested; how many cells the tests looked at, and the start, each counted once; and how many of these
        are free.
    """

    hits: np.ndarray
    to: np.ndarray
    cells: np.ndarray
    ends: np.ndarray
    measures: np.ndarray
    first: np.ndarray
    last: np.ndarray
    n_probes: int
    n_cells: int
    n_free: int


def branches(moves: Moves, grid: OccupancyGrid, start: int, goal: int, strict: bool = False) -> Branches:
    """Return the stretches of the walk from a cell to another.

    Parameters
    ----------
    moves : Moves
        With all eight headings.
    grid : OccupancyGrid
        Of which the steps are.
    start, goal : int
        Indices of cells.
    strict : bool, default False
        The letter of the paper: whether a branch has but the cell to one side of the blocked step to go to, and follows
        nothing. It ends nowhere if that step is not legal.
    """
    found = _branch(moves.legal, moves.offsets, moves.width, start, goal, grid.neighbourhood.rounds, strict)
    hits, to, cells, ends, n_probes, seen = found
    measures, first, last = measure(moves.legal, moves.offsets, cells, ends)
    return Branches(hits, to, cells, ends, measures, first, last, int(n_probes), *_counted(seen, grid, moves))


def _counted(seen: np.ndarray, grid: OccupancyGrid, moves: Moves) -> tuple[int, int]:
    """Return how many cells were seen, and how many of these are free."""
    free = ~grid.occupied[moves.box.slices].ravel()
    return int(np.count_nonzero(seen)), int(np.count_nonzero(seen & free))


@kernel
def _branch(legal, offsets, width, start, goal, rounds, strict):
    number = np.full(len(legal), -1, dtype=np.int64)
    # The last hit on whose unhindered way to the goal each cell lies.
    way = np.full(len(legal), -1, dtype=np.int64)
    # The headings of the steps from each cell that were tested, a bit each.
    tested = np.zeros(len(legal), dtype=np.uint8)
    place = np.empty(len(legal), dtype=np.int64)
    hits, to, ends = np.empty(256, dtype=np.int64), np.empty(256, dtype=np.int64), np.zeros(256, dtype=np.int64)
    cells, path = np.empty(4096, dtype=np.int64), np.empty(4096, dtype=np.int64)
    counts = np.zeros(1, dtype=np.int64)
    n_hits = n_stretches = n = 0
    # Stretch 0, then two for every hit, while there are new ones.
    while n_stretches < 1 + 2 * n_hits:
        hit = (n_stretches - 1) // 2
        side = 1 if n_stretches > 0 and n_stretches % 2 == 0 else -1
        path[0] = start if n_stretches == 0 else hits[hit]
        length, led_on = 1, True
        if n_stretches > 0:
            blocked = towards(width, path[0], goal)
            if strict:
                m = (blocked + side) & 7
                led_on = probe(legal, path[0], m, tested, counts)
                if led_on:
                    path[1] = path[0] + offsets[m]
                    length = 2
            else:
                if side < 0:
                    mark_way(offsets, width, path[0], goal, way, hit)
                path, length, led_on = _follow(
                    legal, offsets, width, goal, rounds, hit, blocked, side, way, tested, counts, path
                )
        end = NOWHERE
        if led_on:
            path, length = _run(legal, offsets, width, goal, tested, counts, path, length)
            cell = path[length - 1]
            end = GOAL
            if cell != goal:
                if number[cell] < 0:
                    number[cell] = n_hits
                    hits = room(hits, n_hits + 1)
                    hits[n_hits] = cell
                    n_hits += 1
                end = number[cell]
        cells, n = append_without_loops(path, length, place, cells, n)
        to, ends = room(to, n_stretches + 1), room(ends, n_stretches + 2)
        to[n_stretches] = end
        n_stretches += 1
        ends[n_stretches] = n
    return (
        hits[:n_hits].copy(),
        to[:n_stretches].copy(),
        cells[:n].copy(),
        ends[: n_stretches + 1].copy(),
        counts[0],
        _seen(tested, width, start),
    )


@kernel
def octile(width, cell, goal):
    """Return the length of the shortest way between two cells if nothing is in it."""
    return _octile(goal % width - cell % width, goal // width - cell // width)


@kernel
def _octile(dx, dy):
    dx, dy = abs(dx), abs(dy)
    low = min(dx, dy)
    return max(dx, dy) - low + SQRT2 * low


@kernel
def probe(legal, cell, m, tested, counts):
    """Test whether the step from a cell along a heading is legal, count it, and note that it was tested."""
    counts[0] += 1
    tested[cell] |= 1 << m
    return (legal[cell] >> m) & 1 == 1


@kernel
def _seen(tested, width, start):
    """Return which cells lie where a tested step leads, on the grid, and the start."""
    height = len(tested) // width
    seen = np.zeros(len(tested), dtype=np.bool_)
    seen[start] = True
    for cell in np.flatnonzero(tested):
        for m in range(8):
            x, y = cell % width + DX[m], cell // width + DY[m]
            if (tested[cell] >> m) & 1 and x >= 0 and x < width and y >= 0 and y < height:
                seen[y * width + x] = True
    return seen


@kernel
def mark_way(offsets, width, cell, goal, way, hit):
    """Mark the cells of the way that the walk would go if nothing were in it."""
    while cell != goal:
        way[cell] = hit
        cell += offsets[towards(width, cell, goal)]
    way[goal] = hit


@kernel
def _run(legal, offsets, width, goal, tested, counts, path, n):
    """Append the cells to the next hit or the goal to the ``n`` of a path; return both anew."""
    x, y = path[n - 1] % width, path[n - 1] // width
    gx, gy = goal % width, goal // width
    while x != gx or y != gy:
        m = sign_heading(gx - x, gy - y)
        if not probe(legal, path[n - 1], m, tested, counts):
            break
        x += DX[m]
        y += DY[m]
        if n == len(path):
            path = room(path, n + 1)
        path[n] = y * width + x
        n += 1
    return path, n


@kernel
def _follow(legal, offsets, width, goal, rounds, hit, blocked, side, way, tested, counts, path):
    """Add the cells around an obstacle to the first of a path; return it, its length, and whether it may leave there."""
    height = len(legal) // width
    cell, n = path[0], 1
    x, y = cell % width, cell // width
    gx, gy = goal % width, goal // width
    far = _octile(gx - x, gy - y)
    m = (blocked + side) & 7
    # Each cell is come to along each heading once at most, before all begins anew.
    for _ in range(8 * len(legal)):
        tried = _TRIED[(side + 1) >> 1, m, legal[cell]]
        counts[0] += tried
        tested[cell] |= _HEADINGS_TRIED[(side + 1) >> 1, m, tried]
        m = (m + side * (tried - 1)) & 7
        if not (legal[cell] >> m) & 1:
            break
        x += DX[m]
        y += DY[m]
        cell = y * width + x
        if n + 2 > len(path):
            path = room(path, n + 2)
        path[n] = cell
        n += 1
        left = _octile(gx - x, gy - y)
        if left < far and (way[cell] == hit or probe(legal, cell, sign_heading(gx - x, gy - y), tested, counts)):
            return path, n, True
        # The way may be passed diagonally.
        nearest, onto = far, -1
        for k in range(8 if left < far + SQRT2 else 0):
            nx, ny = x + DX[k], y + DY[k]
            if nx < 0 or nx >= width or ny < 0 or ny >= height or way[cell + offsets[k]] != hit:
                continue
            ahead = _octile(gx - nx, gy - ny)
            if ahead < nearest and probe(legal, cell, k, tested, counts):
                nearest, onto = ahead, k
        if onto >= 0:
            path[n] = cell + offsets[onto]
            return path, n + 1, True
        # Back towards the obstacle: where one occupied cell may be passed, what lies behind a straight step is known to be one.
        back = 1 if rounds and m % 2 == 0 else 2
        m = (m - back * side) & 7
    return path, n, False
