"""Cheapest routes between two cells of a terrain, as kernels."""

from __future__ import annotations

import weakref
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np

from pymoo_gridpath.compiled import inlined, kernel
from pymoo_gridpath.neighbourhood import HEADINGS
from pymoo_gridpath.search.arrays import grown, room
from pymoo_gridpath.search.heap import drop_first, push
from pymoo_gridpath.search.shortest import UNREACHABLE
from pymoo_gridpath.search.terrain import Terrain

DX, DY = HEADINGS[:, 0].copy(), HEADINGS[:, 1].copy()

# Random numbers of cells keep to 31 bits, so that their products stay below 2**63.
MASK = 2**31 - 1

#: The target of a search for routes to all cells.
NOWHERE = np.int64(-1)

# More than any route costs.
ENDLESS = np.int64(2**62)


class Work(NamedTuple):
    """What searches write to, made once for many of them; see `work_for`.

    Attributes
    ----------
    run : numpy.ndarray of int64, shape (3,)
        Number of the search that is on, and of the cells that it has expanded; if it has found no route, the bound of the whole
        cost below which all cells have been expanded.
    stamp : numpy.ndarray of int32, shape (n_cells,)
        The last search that reached each cell; the other arrays hold for cells of the search that is on.
    cost : numpy.ndarray of int64, shape (n_cells,)
        Least cost of a route to each cell so far.
    came : numpy.ndarray of uint8, shape (n_cells,)
        Heading along which that route comes.
    place : numpy.ndarray of int32, shape (n_cells,)
        For the positions of cells in a path.
    heap : numpy.ndarray of int64, shape (n, 3)
    """

    run: np.ndarray
    stamp: np.ndarray
    cost: np.ndarray
    came: np.ndarray
    place: np.ndarray
    heap: np.ndarray


def make_work(terrain: Terrain) -> Work:
    """Return new working arrays for searches of a terrain."""
    n = len(terrain.legal)
    # No wider than need be, for the memory alone: searches take as long with wider ones.
    return Work(
        np.zeros(3, dtype=np.int64),
        np.zeros(n, dtype=np.int32),
        np.empty(n, dtype=np.int64),
        np.empty(n, dtype=np.uint8),
        np.empty(n, dtype=np.int32),
        np.empty((4096, 3), dtype=np.int64),
    )


# What is free for the next searches of a terrain, by the identity of its steps: arrays that are made anew cost an eighth to a
# quarter of the searches of a mutation, since the system hands out and clears the memory that these touch.
_FREE: dict[int, list[Work]] = {}

# Searches are numbered in 32 bits; from here on the arrays are left to go.
_LAST_RUN = 2**30


@contextmanager
def work_for(terrain: Terrain) -> Iterator[Work]:
    """Lend the working arrays for searches of a terrain; nobody else has them meanwhile."""
    key = id(terrain.legal)
    if key not in _FREE:
        _FREE[key] = []
        weakref.finalize(terrain.legal, _FREE.pop, key, None)
    free = _FREE[key]
    try:
        work = free.pop()
    except IndexError:
        work = make_work(terrain)
    yield work
    if work.run[0] < _LAST_RUN:
        free.append(work)


@kernel
def find_route(terrain, work, source, target, weight, noise, margin, limit):
    """Find a cheapest route from one cell to another, by A*; return whether there is one.

    Parameters
    ----------
    terrain, work
    source : int
    target : int
        `NOWHERE`: find routes to all cells that can be reached, of a terrain whose bounds need not hold.
    weight : int64, shape (K,)
        Weight of each term, 0 to `FULL_WEIGHT`; 1 or more of the length.
    noise : int64, shape (3,)
        The cost of each step is multiplied by a random number from 1 to ``1 + noise[0] / 1024``, the same for all steps
        into a square block of ``2 ** noise[1]`` cells a side; ``noise[2]`` is the seed, 0 to 2**31 - 1.
    margin : int
        The route keeps to the bounding box of the two cells, grown by so many cells on each side.
    limit : int
        Cells to expand before giving up.
    """
    if target >= 0 and terrain.bounds[target, 0] >= UNREACHABLE:
        return False
    width = terrain.width
    tx, ty = target % width, target // width
    x, y = source % width, source // width
    if target < 0:
        tx, ty, margin = x, y, len(terrain.legal)
    x0, x1 = min(x, tx) - margin, max(x, tx) + margin
    y0, y1 = min(y, ty) - margin, max(y, ty) + margin
    straight, diagonal = weight[0] * terrain.straight, weight[0] * terrain.diagonal
    work.run[0] += 1
    run = work.run[0]
    work.run[1] = 0
    heap = work.heap
    work.stamp[source] = run
    work.cost[source] = 0
    ahead = least_rest(terrain, weight, source, target, abs(tx - x), abs(ty - y))
    push(heap, 0, ahead, ahead, source)
    n = 1
    while n > 0:
        bound = heap[0, 0]
        reached = bound - heap[0, 1]
        cell = heap[0, 2]
        drop_first(heap, n)
        n -= 1
        if reached > work.cost[cell]:
            continue
        if cell == target:
            return True
        work.run[1] += 1
        if work.run[1] > limit:
            work.run[2] = bound
            return False
        if n + 8 > len(heap):
            heap = grown(heap)
        x, y = cell % width, cell // width
        steps = terrain.legal[cell]
        for m in range(8):
            if not (steps >> m) & 1:
                continue
            nx, ny = x + DX[m], y + DY[m]
            if nx < x0 or nx > x1 or ny < y0 or ny > y1:
                continue
            other = cell + terrain.offsets[m]
            step = straight if m & 1 == 0 else diagonal
            for k in range(terrain.fields.shape[1]):
                step += weight[k + 1] * terrain.fields[other, k]
            if noise[0] > 0:
                step += (step * noise[0] >> 10) * block_noise(nx >> noise[1], ny >> noise[1], noise[2]) >> 10
            total = reached + step
            if work.stamp[other] == run and total >= work.cost[other]:
                continue
            work.stamp[other] = run
            work.cost[other] = total
            work.came[other] = m
            ahead = least_rest(terrain, weight, other, target, abs(tx - nx), abs(ty - ny))
            push(heap, n, total + ahead, ahead, other)
            n += 1
    work.run[2] = ENDLESS
    return False


@kernel
def last_reached(terrain, work, path, begin, end, weight):
    """Return the last position in a stretch of a path to whose cell a search has found the cheapest route, ``begin`` for none.

    The search was one for a route from the first cell of the stretch to the last, and has found none.
    """
    width = terrain.width
    target = path[end]
    for k in range(end - 1, begin, -1):
        cell = path[k]
        if work.stamp[cell] != work.run[0]:
            continue
        dx, dy = abs(target % width - cell % width), abs(target // width - cell // width)
        # Bounds never fall along a route, so that what has yet to be expanded does not lie below the last one.
        if work.cost[cell] + least_rest(terrain, weight, cell, target, dx, dy) < work.run[2]:
            return k
    return begin


@inlined
def least_rest(terrain, weight, cell, target, dx, dy):
    """Return a lower bound of the cost from a cell to the target, consistent along every step; 0 where there is no target.

    In each term the rest costs no less than the difference of what the two cells need to the goal, and no less than the
    difference of what they need from the start; in the length also no less than the way without obstacles.
    """
    if target < 0:
        return 0
    low = min(dx, dy)
    bound = (max(dx, dy) - low) * terrain.straight + low * terrain.diagonal
    total = 0
    for k in range(len(weight)):
        bound = max(
            bound,
            terrain.bounds[cell, 2 * k] - terrain.bounds[target, 2 * k],
            terrain.bounds[target, 2 * k + 1] - terrain.bounds[cell, 2 * k + 1],
        )
        total += weight[k] * bound
        bound = 0
    return total


@inlined
def block_noise(x, y, seed):
    """Return a number from 0 to 1023 that looks random, the same for the same arguments."""
    h = (x * 73856093 ^ y * 19349663 ^ seed) & MASK
    h = ((h ^ (h >> 15)) * 0x2C1B3C6D) & MASK
    h = ((h ^ (h >> 12)) * 0x297A2D39) & MASK
    return (h ^ (h >> 15)) & 1023


@kernel
def unwind(terrain, work, source, target, path, n):
    """Append the route that `find_route` found, without its source, to the ``n`` cells of a path; return both anew."""
    count = 0
    cell = target
    while cell != source:
        cell -= terrain.offsets[work.came[cell]]
        count += 1
    path = room(path, n + count)
    cell = target
    for k in range(n + count - 1, n - 1, -1):
        path[k] = cell
        cell -= terrain.offsets[work.came[cell]]
    return path, n + count


@kernel
def descend(terrain, path, n):
    """Append a shortest route from the last of the ``n`` cells of a path to the goal; return both anew."""
    cell = path[n - 1]
    while cell != terrain.goal:
        cell = downhill(terrain, cell)
        path = room(path, n + 1)
        path[n] = cell
        n += 1
    return path, n


@kernel
def downhill(terrain, cell):
    """Return the next cell on a shortest route to the goal."""
    for m in range(8):
        if (terrain.legal[cell] >> m) & 1:
            step = terrain.straight if m & 1 == 0 else terrain.diagonal
            other = cell + terrain.offsets[m]
            if terrain.bounds[other, 0] + step == terrain.bounds[cell, 0]:
                return other
    return terrain.goal
