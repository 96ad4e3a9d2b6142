"""The kernel that makes a path of the head of one path and a stretch or the tail of another."""

from __future__ import annotations

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.search.arrays import room
from pymoo_gridpath.search.route import find_route, unwind, work_for
from pymoo_gridpath.search.sequences import append_without_loops
from pymoo_gridpath.search.terrain import Terrain

# How far around the two cells, and how long, a way between paths that only come near is looked for.
JOIN_MARGIN, JOIN_LIMIT = np.int64(8), np.int64(2048)


def splice(
    terrain: Terrain,
    paths: Sequences,
    first: np.ndarray,
    second: np.ndarray,
    draws: np.ndarray,
    weights: np.ndarray,
    reach: int,
    max_cells: int,
) -> Sequences:
    """Return children of pairs of paths.

    A child follows the first path and takes from the second one or more of the stretches, one after another, in which the
    two differ, but never all of them; so it leads from a cell that both share to another. Where the paths part and meet only
    once, it follows the first up to a random cell from which the second is near, and then the second, joined by a cheapest
    route. Where they do not even come near, it is the first path. Loops are cut.

    Parameters
    ----------
    terrain : Terrain
    paths : Sequences
        Legal paths of the terrain's query.
    first, second : numpy.ndarray of int64, shape (N,)
        Numbers of the paths to splice.
    draws : numpy.ndarray of float, shape (N, 2)
        Random numbers from [0, 1) that choose where.
    weights : numpy.ndarray of int64, shape (N, K)
        Weights of the terms for the routes that join paths.
    reach : int
        How many cells away, in the larger of x and y, is near.
    max_cells : int
        Where the child would have more cells, it is the first path.

    Returns
    -------
    Sequences
        N legal paths.
    """
    with work_for(terrain) as work:
        return Sequences(*_splice(terrain, work, *paths, first, second, draws, weights, reach, max_cells))


@kernel
def _splice(terrain, work, cells, offsets, first, second, draws, weights, reach, max_cells):
    out, ends = np.empty(len(cells) + 1, dtype=np.int64), np.zeros(len(first) + 1, dtype=np.int64)
    path = np.empty(1024, dtype=np.int64)
    total = 0
    for i in range(len(first)):
        a = cells[offsets[first[i]] : offsets[first[i] + 1]]
        b = cells[offsets[second[i]] : offsets[second[i] + 1]]
        path, n = _child(terrain, work, a, b, draws[i], weights[i], reach, path)
        out, total = append_without_loops(path, n, work.place, out, total)
        if total - ends[i] > max_cells:
            out, total = append_without_loops(a, len(a), work.place, out, ends[i])
        ends[i + 1] = total
    return out[:total], ends


@kernel
def _child(terrain, work, a, b, draw, weight, reach, path):
    """Write a child of two paths; return it and its number of cells, before loops are cut."""
    for j in range(len(b)):
        work.place[b[j]] = j
    head = 0
    while head < len(a) and head < len(b) and a[head] == b[head]:
        head += 1
    tail = 0
    while head + tail < len(a) and head + tail < len(b) and a[len(a) - 1 - tail] == b[len(b) - 1 - tail]:
        tail += 1
    # Where the paths part, the first time and again after having met; and where they meet for good.
    forks = np.empty(len(a) + 1, dtype=np.int64)
    n_forks = 0
    place = work.place
    for i in range(head - 1, len(a) - tail):
        # Not by `place_in`: arrays that are handed on cost several times as much as all the rest.
        j = place[a[i]]
        if 0 <= j < len(b) - 1 and b[j] == a[i] and a[i + 1] != b[j + 1]:
            forks[n_forks] = i
            n_forks += 1
    forks[n_forks] = len(a) - tail
    if n_forks == 0 or tail == 0:
        return write(a, 0, len(a), path, 0)
    if n_forks == 1:
        return _near_child(terrain, work, a, b, head, tail, draw, weight, reach, path)
    x = int(draw[0] * n_forks)
    last = n_forks - 1 if x == 0 else n_forks
    y = x + 1 + int(draw[1] * (last - x))
    i, k = forks[x], forks[y]
    if place_in(work, b, a[k]) <= place_in(work, b, a[i]):
        # The second path visits these two the other way round.
        k = len(a) - tail
    path, n = write(a, 0, i + 1, path, 0)
    path, n = write(b, place_in(work, b, a[i]) + 1, place_in(work, b, a[k]), path, n)
    return write(a, k, len(a), path, n)


@kernel
def _near_child(terrain, work, a, b, head, tail, draw, weight, reach, path):
    """Write a child of two paths that share no cell but their ``head`` first and their ``tail`` last ones."""
    width = terrain.width
    height = len(terrain.legal) // width
    i = head + int(draw[0] * (len(a) - tail - head))
    x, y = a[i] % width, a[i] // width
    noise = np.zeros(3, dtype=np.int64)
    for r in range(1, reach + 1):
        for oy in range(max(y - r, 0), min(y + r, height - 1) + 1):
            # The rim of a square of 2 r + 1 cells a side.
            across = 1 if abs(oy - y) == r else 2 * r
            for ox in range(x - r, x + r + 1, across):
                if ox < 0 or ox >= width:
                    continue
                other = oy * width + ox
                j = place_in(work, b, other)
                if j < head or j >= len(b) - tail or i >= len(a) - tail:
                    continue
                if find_route(terrain, work, a[i], other, weight, noise, JOIN_MARGIN, JOIN_LIMIT):
                    path, n = write(a, 0, i + 1, path, 0)
                    path, n = unwind(terrain, work, a[i], other, path, n)
                    return write(b, j + 1, len(b), path, n)
    return write(a, 0, len(a), path, 0)


@kernel
def place_in(work, path, cell):
    """Return the position of a cell in a path whose positions ``work.place`` holds, or -1."""
    j = work.place[cell]
    if 0 <= j < len(path) and path[j] == cell:
        return j
    return -1


@kernel
def write(source, begin, end, path, n):
    """Append a stretch of one path to the ``n`` cells of another; return both anew."""
    if end <= begin:
        return path, n
    path = room(path, n + end - begin)
    for k in range(begin, end):
        path[n] = source[k]
        n += 1
    return path, n
