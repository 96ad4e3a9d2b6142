"""The kernel that changes a stretch of a path."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.search.arrays import room
from pymoo_gridpath.search.route import DX, DY, find_route, last_reached, unwind, work_for
from pymoo_gridpath.search.sequences import append_without_loops, heading_between
from pymoo_gridpath.search.splice import write
from pymoo_gridpath.search.terrain import Terrain

#: Ways to change a stretch.
REROUTE, STRAIGHTEN, SHIFT = 0, 1, 2

# How far around a shifted stretch, and how long, a way back to the path is looked for.
JOIN_MARGIN, JOIN_LIMIT = np.int64(2), np.int64(128)


class Changes(NamedTuple):
    """What is to change in each of N paths.

    Attributes
    ----------
    way : numpy.ndarray of int64, shape (N,)
        `REROUTE` takes the cheapest route between the two ends of the stretch, or the last of its cells to which the search for
        that has found one; `STRAIGHTEN` the way with one turn,
        a diagonal and a straight run, or two straight ones where there are no diagonal steps; `SHIFT` moves what lies between
        the ends one cell along a heading.
    begin, end : numpy.ndarray of int64, shape (N,)
        Positions in the path of the two ends of the stretch, which stay.
    heading : numpy.ndarray of int64, shape (N,)
        Where to shift to, 0 to 7; even, where to straighten, for the diagonal run first, or that along x.
    weights : numpy.ndarray of int64, shape (N, K)
        See `find_route`, as for ``noise``.
    noise : numpy.ndarray of int64, shape (N, 3)
    """

    way: np.ndarray
    begin: np.ndarray
    end: np.ndarray
    heading: np.ndarray
    weights: np.ndarray
    noise: np.ndarray


def vary(terrain: Terrain, paths: Sequences, changes: Changes, margin: int, limit: int, max_cells: int) -> Sequences:
    """Return paths with a stretch changed.

    Parameters
    ----------
    terrain : Terrain
    paths : Sequences
        N legal paths of the terrain's query.
    changes : Changes
    margin, limit : int
        How far from a stretch its new route may lead, and the cells to expand in search of it, see `find_route`.
    max_cells : int

    Returns
    -------
    Sequences
        N legal paths; those that cannot be changed so, or would have more than ``max_cells`` cells, are as they were.
    """
    with work_for(terrain) as work:
        return Sequences(*_vary(terrain, work, *paths, changes, margin, limit, max_cells))


@kernel
def _vary(terrain, work, cells, offsets, changes, margin, limit, max_cells):
    out, ends = np.empty(2 * len(cells), dtype=np.int64), np.zeros(len(offsets), dtype=np.int64)
    path = np.empty(1024, dtype=np.int64)
    total = 0
    for i in range(len(offsets) - 1):
        old = cells[offsets[i] : offsets[i + 1]]
        begin, end = changes.begin[i], changes.end[i]
        path, n = write(old, 0, begin + 1, path, 0)
        weight, noise = changes.weights[i], changes.noise[i]
        if changes.way[i] == REROUTE:
            if not find_route(terrain, work, old[begin], old[end], weight, noise, margin, limit):
                end = last_reached(terrain, work, old, begin, end, weight)
            done = end > begin
            if done:
                path, n = unwind(terrain, work, old[begin], old[end], path, n)
        elif changes.way[i] == STRAIGHTEN:
            path, n, done = _straight(terrain, old[begin], old[end], changes.heading[i] % 2 == 0, path, n)
        else:
            path, n, done = _shifted(terrain, work, old, begin, end, changes.heading[i], weight, path, n)
        if done:
            path, n = write(old, end + 1, len(old), path, n)
            out, total = append_without_loops(path, n, work.place, out, total)
        if not done or total - ends[i] > max_cells:
            out, total = append_without_loops(old, len(old), work.place, out, ends[i])
        ends[i + 1] = total
    return out[:total], ends


@kernel
def _straight(terrain, source, target, diagonal_first, path, n):
    """Append the way with one turn from one cell to another, or with the runs in the other order; say whether one is legal."""
    width = terrain.width
    for order in range(2):
        cell = source
        k = n
        while cell != target:
            dx, dy = target % width - cell % width, target // width - cell // width
            sx, sy = (1 if dx > 0 else 0) - (1 if dx < 0 else 0), (1 if dy > 0 else 0) - (1 if dy < 0 else 0)
            if terrain.square:
                if diagonal_first == (order == 0) and dx != 0:
                    sy = 0
                elif dy != 0:
                    sx = 0
            elif diagonal_first == (order == 1) and abs(dx) != abs(dy):
                # The straight run along the longer axis comes first.
                if abs(dx) > abs(dy):
                    sy = 0
                else:
                    sx = 0
            cell_next = cell + sy * width + sx
            if heading_between(terrain, cell, cell_next) < 0:
                break
            cell = cell_next
            path = room(path, k + 1)
            path[k] = cell
            k += 1
        if cell == target:
            return path, k, True
    return path, n, False


@kernel
def _shifted(terrain, work, old, begin, end, heading, weight, path, n):
    """Append what lies between two cells of a path, moved one cell along a heading; say whether that is legal."""
    if end - begin < 2:
        return path, n, False
    width = terrain.width
    by = terrain.offsets[heading]
    height = len(terrain.legal) // width
    for k in range(begin + 1, end):
        x, y = old[k] % width + DX[heading], old[k] // width + DY[heading]
        if x < 0 or x >= width or y < 0 or y >= height:
            return path, n, False
        if k > begin + 1 and heading_between(terrain, old[k - 1] + by, old[k] + by) < 0:
            return path, n, False
    noise = np.zeros(3, dtype=np.int64)
    if not find_route(terrain, work, old[begin], old[begin + 1] + by, weight, noise, JOIN_MARGIN, JOIN_LIMIT):
        return path, n, False
    path, n = unwind(terrain, work, old[begin], old[begin + 1] + by, path, n)
    path = room(path, n + end - begin)
    for k in range(begin + 2, end):
        path[n] = old[k] + by
        n += 1
    if not find_route(terrain, work, old[end - 1] + by, old[end], weight, noise, JOIN_MARGIN, JOIN_LIMIT):
        return path, n, False
    path, n = unwind(terrain, work, old[end - 1] + by, old[end], path, n)
    return path, n, True
