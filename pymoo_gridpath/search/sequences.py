"""Kernels that say whether cell sequences are legal paths, and make legal paths of them."""

from __future__ import annotations

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.search.arrays import room
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.route import descend, downhill, find_route, unwind, work_for
from pymoo_gridpath.search.shortest import UNREACHABLE
from pymoo_gridpath.search.terrain import FULL_WEIGHT, Terrain, plain_terrain

# How far around the two ends of a broken stretch, and how long, a way to join them is looked for.
JOIN_MARGIN, JOIN_LIMIT = np.int64(8), np.int64(4096)

# How many cells all these searches may expand for one path.
MEND_LIMIT = np.int64(16384)


def are_legal(sequences: Sequences, terrain: Terrain) -> np.ndarray:
    """Return whether each sequence is a path from the start to the goal by legal steps, bool, shape (N,)."""
    return _are_legal(terrain, sequences.cells, sequences.offsets)


def cut_loops(sequences: Sequences, n_cells: int) -> Sequences:
    """Return the paths without what lies between the first and the last visit of a cell.

    Parameters
    ----------
    sequences : Sequences
    n_cells : int
        Number of cells of the grid.
    """
    return Sequences(*_cut_loops(sequences.cells, sequences.offsets, np.empty(n_cells, dtype=np.int64)))


def mend(sequences: Sequences, moves: Moves, start: int, goal: int, max_cells: int | None = None) -> Sequences:
    """Return legal paths that keep to sequences of cells as far as these can be followed.

    Cells that no path from the start to the goal visits are dropped, what is then broken is joined by shortest routes, a cell
    that cannot be reached from the ones before it nearby is left out, and loops are cut. So are cells left out from which the
    goal is too far for a path of ``max_cells`` cells, and all that come after so long a search that it is given up.

    Parameters
    ----------
    sequences : Sequences
        N sequences of whole numbers; those that are no cells are dropped like occupied ones.
    moves : Moves
    start, goal : int
        Indices of two cells that a path joins.
    max_cells : int, optional
        No path has more cells, unless the shortest has.

    Returns
    -------
    Sequences
        N paths from the start to the goal.
    """
    terrain = plain_terrain(moves, start, goal)
    most = moves.n_cells if max_cells is None else max_cells
    with work_for(terrain) as work:
        return Sequences(*_mend(terrain, work, sequences.cells, sequences.offsets, most))


@kernel
def _are_legal(terrain, cells, offsets):
    legal = np.zeros(len(offsets) - 1, dtype=np.bool_)
    for i in range(len(legal)):
        first, last = offsets[i], offsets[i + 1] - 1
        if last < first or cells[first] != terrain.start or cells[last] != terrain.goal:
            continue
        k, m = first, 0
        while k < last:
            # Mostly the same heading as before; the first cell is one of the grid, and so is what a legal step leads to.
            if not ((terrain.legal[cells[k]] >> m) & 1 and cells[k] + terrain.offsets[m] == cells[k + 1]):
                m = heading_between(terrain, cells[k], cells[k + 1])
                if m < 0:
                    break
            k += 1
        legal[i] = k == last
    return legal


@kernel
def heading_between(terrain, cell, other):
    """Return the heading of the legal step from one cell to another, or -1."""
    if cell < 0 or cell >= len(terrain.legal):
        return -1
    # Not by the function below: arrays that are handed on cost as much again as all the rest.
    for m in range(8):
        if (terrain.legal[cell] >> m) & 1 and cell + terrain.offsets[m] == other:
            return m
    return -1


@kernel
def step_heading(legal, offsets, cell, other):
    """Return the heading of the legal step from a cell of the grid to another, or -1."""
    for m in range(8):
        if (legal[cell] >> m) & 1 and cell + offsets[m] == other:
            return m
    return -1


@kernel
def _cut_loops(cells, offsets, place):
    out, ends = np.empty(len(cells), dtype=np.int64), np.zeros(len(offsets), dtype=np.int64)
    n = 0
    for i in range(len(offsets) - 1):
        path = cells[offsets[i] : offsets[i + 1]]
        out, n = append_without_loops(path, len(path), place, out, n)
        ends[i + 1] = n
    return out[:n].copy(), ends


@kernel
def append_without_loops(path, length, place, out, n):
    """Append the ``length`` cells of a path, without loops, to the ``n`` cells of another array; return both anew."""
    for i in range(length):
        place[path[i]] = i
    out = room(out, n + length)
    i = 0
    while i < length:
        # Mostly each cell is visited once: then the processor need not wait for its place to know the next one.
        while i < length and place[path[i]] == i:
            out[n] = path[i]
            n += 1
            i += 1
        if i < length:
            out[n] = path[i]
            n += 1
            i = place[path[i]] + 1
    return out, n


@kernel
def _mend(terrain, work, cells, offsets, max_cells):
    out, ends = np.empty(len(cells) + 1, dtype=np.int64), np.zeros(len(offsets), dtype=np.int64)
    path = np.empty(1024, dtype=np.int64)
    left = np.zeros(len(terrain.legal), dtype=np.int64)
    total = 0
    for i in range(len(offsets) - 1):
        path, n = _follow(terrain, work, cells[offsets[i] : offsets[i + 1]], left, max_cells, path)
        out, total = append_without_loops(path, n, work.place, out, total)
        ends[i + 1] = total
    return out[:total].copy(), ends


@kernel
def _follow(terrain, work, cells, left, max_cells, path):
    """Write the path from the start to the goal that follows cells as far as they can be; return it and its length."""
    width = terrain.width
    weight = np.zeros(terrain.fields.shape[1] + 1, dtype=np.int64)
    weight[0] = FULL_WEIGHT
    noise = np.zeros(3, dtype=np.int64)
    path[0] = terrain.start
    n = 1
    budget = MEND_LIMIT
    for cell in cells:
        last = path[n - 1]
        if cell == last or cell < 0 or cell >= len(terrain.legal) or terrain.bounds[cell, 0] >= UNREACHABLE:
            continue
        # What is left of the room when the path goes on from the cell to the goal, for the way to the cell.
        room_left = max_cells - n - _steps_left(terrain, left, cell)
        if max(abs(cell % width - last % width), abs(cell // width - last // width)) > room_left:
            continue
        if heading_between(terrain, last, cell) >= 0:
            path = room(path, n + 1)
            path[n] = cell
            n += 1
            continue
        if budget <= 0:
            break
        found = find_route(terrain, work, last, cell, weight, noise, JOIN_MARGIN, min(JOIN_LIMIT, budget))
        budget -= work.run[1]
        if found:
            path, longer = unwind(terrain, work, last, cell, path, n)
            if longer - n <= room_left:
                n = longer
    return descend(terrain, path, n)


@kernel
def _steps_left(terrain, left, cell):
    """Return the number of steps that `descend` takes from a cell; ``left`` holds those known already, 0 for unknown."""
    steps = 0
    other = cell
    while other != terrain.goal and left[other] == 0:
        other = downhill(terrain, other)
        steps += 1
    steps += left[other]
    other, known = cell, steps
    while other != terrain.goal and left[other] == 0:
        left[other] = known
        known -= 1
        other = downhill(terrain, other)
    return steps
