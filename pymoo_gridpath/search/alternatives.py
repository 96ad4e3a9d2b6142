"""Paths through the stretches that a walk has found: how many seconds they take, which are the quickest, and their cells."""

from __future__ import annotations

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.grid import SQRT2
from pymoo_gridpath.neighbourhood import turn_units
from pymoo_gridpath.search.arrays import room
from pymoo_gridpath.search.sequences import append_without_loops, step_heading

#: Where a stretch leads that ends at the goal, or nowhere.
GOAL, NOWHERE = np.int64(-1), np.int64(-2)
TURNS = turn_units()


@kernel
def measure(legal, offsets, cells, ends):
    """Return straight steps, diagonal steps and turn of paths, shape (N, 3), and the headings of their first and last steps."""
    n = len(ends) - 1
    measures = np.zeros((n, 3), dtype=np.int64)
    first, last = np.full(n, -1, dtype=np.int64), np.full(n, -1, dtype=np.int64)
    for e in range(n):
        for k in range(ends[e], ends[e + 1] - 1):
            m = step_heading(legal, offsets, cells[k], cells[k + 1])
            measures[e, m & 1] += 1
            if first[e] < 0:
                first[e] = m
            else:
                measures[e, 2] += turn_of(last[e], m)
            last[e] = m
    return measures, first, last


@kernel
def turn_of(before, after):
    """Return the turn between two headings in units of 45 degrees; 0 if there is none before or after."""
    # Of no heading before, -1, there is a last row.
    return TURNS[before, after] if after >= 0 else 0


@kernel
def quickest(to, measures, first, last, order, most, per_cell, per_turn):
    """Return the quickest ways on from the begin of each stretch to the goal, at most so many.

    Of ways that take the same time the shorter comes first, then the one that turns less, then the one that goes clockwise.

    Parameters
    ----------
    to, measures, first, last
        As in `Branches`.
    order : int64, shape (n,)
        The hits, the one nearest to the goal first.
    most : int
    per_cell, per_turn : float
        Seconds for a straight step, and for a turn of 45 degrees.

    Returns
    -------
    ends : int64, shape (2 n + 1, 2)
        The first way from each stretch, and the one after its last, among all.
    rest : int64, shape (m, 3)
        Straight steps, diagonal steps and turn of each.
    then : int64, shape (m,)
        By which way it goes on from where its first stretch ends; -1 at the goal.
    """
    ends = np.zeros((len(to), 2), dtype=np.int64)
    rest, then = np.empty((1024, 3), dtype=np.int64), np.empty(1024, dtype=np.int64)
    n = 0
    for k in range(len(order) + 1):
        for side in range(2 if k < len(order) else 1):
            e = 1 + 2 * order[k] + side if k < len(order) else 0
            if n + most > len(then):
                longer, then_ = np.empty((2 * (n + most), 3), dtype=np.int64), np.empty(2 * (n + most), dtype=np.int64)
                longer[:n], then_[:n] = rest[:n], then[:n]
                rest, then = longer, then_
            ends[e, 0] = n
            if to[e] == GOAL:
                rest[n] = measures[e]
                then[n] = -1
                n += 1
            elif to[e] >= 0:
                n = _merge(e, 1 + 2 * to[e], ends, rest, then, n, most, measures, first, last, per_cell, per_turn)
            ends[e, 1] = n
    return ends, rest[:n].copy(), then[:n].copy()


@kernel
def _merge(e, other, ends, rest, then, n, most, measures, first, last, per_cell, per_turn):
    """Append the quickest ways from stretch e by either of the two that follow it; return how many there then are in all."""
    i, j = ends[other, 0], ends[other + 1, 0]
    most += n
    while n < most and (i < ends[other, 1] or j < ends[other + 1, 1]):
        by, way = other, i
        if i == ends[other, 1]:
            by, way = other + 1, j
        elif j < ends[other + 1, 1]:
            bend_i, bend_j = turn_of(last[e], first[other]), turn_of(last[e], first[other + 1])
            # What stretch e takes is the same for both.
            if cost_of(rest[j, 0], rest[j, 1], rest[j, 2] + bend_j, per_cell, per_turn) < cost_of(
                rest[i, 0], rest[i, 1], rest[i, 2] + bend_i, per_cell, per_turn
            ):
                by, way = other + 1, j
        rest[n] = measures[e] + rest[way]
        rest[n, 2] += turn_of(last[e], first[by])
        then[n] = way
        n += 1
        if by == other:
            i += 1
        else:
            j += 1
    return n


@kernel
def cost_of(straight, diagonal, turn, per_cell, per_turn):
    """Return what ways are compared by: time in whole nanoseconds, length in cells, turn in units of 45 degrees."""
    length = straight + SQRT2 * diagonal
    return np.rint(1e9 * (length * per_cell + turn * per_turn)), length, turn


@kernel
def unfold(cells, ends, to, ways, then, n_cells):
    """Return the cells of the ways from the start, and where each begins and ends, without loops.

    Parameters
    ----------
    cells, ends, to
        As in `Branches`.
    ways : int64, shape (2 n + 1, 2)
    then : int64, shape (m,)
        What `quickest` returned.
    n_cells : int
        Number of cells of the grid.
    """
    out, offsets = np.empty(4096, dtype=np.int64), np.zeros(ways[0, 1] - ways[0, 0] + 1, dtype=np.int64)
    path, place = np.empty(4096, dtype=np.int64), np.empty(n_cells, dtype=np.int64)
    total = 0
    for k in range(len(offsets) - 1):
        n, e, way = 0, 0, ways[0, 0] + k
        while True:
            # The hit that it begins with is there already.
            first = ends[e] + (1 if n > 0 else 0)
            path = room(path, n + ends[e + 1] - first)
            for i in range(first, ends[e + 1]):
                path[n] = cells[i]
                n += 1
            way = then[way]
            if way < 0:
                break
            e = 1 + 2 * to[e] + (0 if way < ways[1 + 2 * to[e], 1] and way >= ways[1 + 2 * to[e], 0] else 1)
        out, total = append_without_loops(path, n, place, out, total)
        offsets[k + 1] = total
    return out[:total].copy(), offsets
