"""The kernels that draw whole paths."""

from __future__ import annotations

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.search.arrays import room
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.route import NOWHERE, find_route, unwind, work_for
from pymoo_gridpath.search.sequences import append_without_loops, mend
from pymoo_gridpath.search.splice import write
from pymoo_gridpath.search.terrain import Terrain, backwards


def cheapest_paths(terrain: Terrain, moves: Moves, weights: np.ndarray, noise: np.ndarray, max_cells: int) -> Sequences:
    """Return cheapest paths from the start to the goal.

    Parameters
    ----------
    terrain : Terrain
    moves : Moves
        What it was made of.
    weights : numpy.ndarray of int64, shape (N, K)
    noise : numpy.ndarray of int64, shape (N, 3)
        See `find_route`, as for ``weights``.
    max_cells : int
        A path of more cells is replaced by a shortest one.

    Returns
    -------
    Sequences
        N legal paths.
    """
    with work_for(terrain) as work:
        found = Sequences(*_cheapest_paths(terrain, work, weights, noise, max_cells))
    return _completed(found, terrain, moves)


def paths_through(
    terrain: Terrain,
    moves: Moves,
    points: np.ndarray,
    trees: np.ndarray,
    weights: np.ndarray,
    noise: np.ndarray,
    max_cells: int,
) -> Sequences:
    """Return paths through given cells, along trees of cheapest routes from the start and to the goal.

    See `cheapest_paths` for what is not listed, with a row of ``weights`` and ``noise`` for each of T trees.

    Parameters
    ----------
    points : numpy.ndarray of int64, shape (N,)
        Useful cells of the terrain.
    trees : numpy.ndarray of int64, shape (N, 2)
        Numbers, from 0 to T - 1, of the trees that lead to the cell and from it.
    """
    heads = _branches(terrain, points, trees[:, 0], weights, noise)
    tails = _branches(backwards(terrain), points, trees[:, 1], weights, noise)
    with work_for(terrain) as work:
        found = Sequences(*_join(work, *heads, *tails, max_cells))
    return _completed(found, terrain, moves)


def _completed(paths: Sequences, terrain: Terrain, moves: Moves) -> Sequences:
    """Return paths with a shortest one, which fits every row, in place of those without cells."""
    if paths.lengths.all():
        return paths
    # Legal paths stay as they are where there is room enough.
    return mend(paths, moves, terrain.start, terrain.goal, 2 * moves.n_cells)


def _branches(terrain: Terrain, points: np.ndarray, trees: np.ndarray, weights: np.ndarray, noise: np.ndarray) -> Sequences:
    """Return the routes from the terrain's start to cells, each in a tree of its own choice."""
    order = np.argsort(trees, kind="stable")
    with work_for(terrain) as work:
        cells, ends = _grow(terrain, work, points[order], trees[order], weights, noise)
    # Back into the order of the points.
    lengths = np.diff(ends)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    offsets = np.concatenate([[0], np.cumsum(lengths[rank])])
    within = np.arange(offsets[-1]) - np.repeat(offsets[:-1], lengths[rank])
    return Sequences(cells[np.repeat(ends[rank], lengths[rank]) + within], offsets)


@kernel
def _cheapest_paths(terrain, work, weights, noise, max_cells):
    """Return cheapest paths, without the cells of those that are too long."""
    out, ends = np.empty(1024, dtype=np.int64), np.zeros(len(weights) + 1, dtype=np.int64)
    path = np.empty(1024, dtype=np.int64)
    path[0] = terrain.start
    total = 0
    everywhere = len(terrain.legal)
    for i in range(len(weights)):
        n = 0
        if find_route(terrain, work, terrain.start, terrain.goal, weights[i], noise[i], everywhere, everywhere):
            path, n = unwind(terrain, work, terrain.start, terrain.goal, path, 1)
        if n <= max_cells:
            out, total = write(path, 0, n, out, total)
        ends[i + 1] = total
    return out[:total].copy(), ends


@kernel
def _grow(terrain, work, points, trees, weights, noise):
    """Return the routes from the start to cells in ascending order of their trees."""
    out, ends = np.empty(1024, dtype=np.int64), np.zeros(len(points) + 1, dtype=np.int64)
    total = 0
    everywhere = len(terrain.legal)
    for i in range(len(points)):
        tree = trees[i]
        if i == 0 or trees[i - 1] != tree:
            find_route(terrain, work, terrain.start, NOWHERE, weights[tree], noise[tree], everywhere, everywhere)
        out = room(out, total + 1)
        out[total] = terrain.start
        total += 1
        out, total = unwind(terrain, work, terrain.start, points[i], out, total)
        ends[i + 1] = total
    return out[:total].copy(), ends


@kernel
def _join(work, heads, head_ends, tails, tail_ends, max_cells):
    """Return the paths of routes from the start to a cell and of those from the goal to it, without cells if too long."""
    out, ends = np.empty(len(heads) + len(tails), dtype=np.int64), np.zeros(len(head_ends), dtype=np.int64)
    path = np.empty(1024, dtype=np.int64)
    total = 0
    for i in range(len(ends) - 1):
        path, n = write(heads, head_ends[i], head_ends[i + 1], path, 0)
        tail = tails[tail_ends[i] : tail_ends[i + 1]]
        path, n = write(tail[::-1].copy(), 1, len(tail), path, n)
        out, total = append_without_loops(path, n, work.place, out, total)
        if total - ends[i] > max_cells:
            total = ends[i]
        ends[i + 1] = total
    return out[:total].copy(), ends
