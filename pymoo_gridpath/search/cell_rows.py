"""Kernels on rows of cells: random greedy walks, crossing at a shared cell, changing single cells and regrowing tails.

A row holds the cells of a path and then the goal to its end, legal or not; cells are counted as `Moves` counts them.
"""

from __future__ import annotations

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.search.arrays import copy
from pymoo_gridpath.search.route import DX, DY
from pymoo_gridpath.search.sequences import append_without_loops
from pymoo_gridpath.search.splice import write
from pymoo_gridpath.search.terrain import Terrain


def walks(terrain: Terrain, draws: np.ndarray) -> Sequences:
    """Return random walks from the start that make for the goal.

    Each step is a legal one to a cell not visited before: to the one nearest to the goal, as the crow flies, with probability
    1/2, to the second nearest with 1/4, and so on, the last taking what is left. Of cells as near, the first by heading is the
    nearer.

    Parameters
    ----------
    terrain : Terrain
    draws : numpy.ndarray of float, shape (N, n)
        Random numbers from [0, 1), one a step; a walk has at most n cells.

    Returns
    -------
    Sequences
        N legal paths, without cells where a walk came to a dead end or was too long.
    """
    return Sequences(*_walks(terrain, draws))


def cross_at_shared_cells(rows: np.ndarray, goal: int, n_cells: int, draws: np.ndarray) -> np.ndarray:
    """Return two children of each pair of rows: the head of one and the tail of the other, joined at a cell of both.

    Parameters
    ----------
    rows : numpy.ndarray of int64, shape (2, n_matings, n_var)
        Negative numbers are no cells, and skipped.
    goal, n_cells : int
        The index of the goal, and how many cells there are.
    draws : numpy.ndarray of float, shape (n_matings,)
        Random numbers from [0, 1): which of the shared cells between the ends.

    Returns
    -------
    numpy.ndarray of int64, shape (2, n_matings, n_var)
        Without loops. Where two parents share no cell between their ends, and where a child does not fit, they are the parents.
    """
    return _cross(np.ascontiguousarray(rows), goal, n_cells, draws)


def change_cells(terrain: Terrain, rows: np.ndarray, rate: float, regrow: float, draws: np.ndarray) -> np.ndarray:
    """Return rows of which each cell between the ends has changed with a probability.

    It becomes another cell beside both of its neighbours in the path, free or not, or what comes after it becomes a new walk,
    see `walks`, with which the changes of a row end. Where there is no such cell or the walk fails, all stays as it was. Loops
    are cut.

    Parameters
    ----------
    terrain : Terrain
    rows : numpy.ndarray of int64, shape (N, n_var)
        As in `cross_at_shared_cells`.
    rate : float
        Probability of each cell to change.
    regrow : float
        Share of the changes that are new walks.
    draws : numpy.ndarray of float, shape (4, N, n_var)
        Random numbers from [0, 1): for each cell, whether it changes, how, and into which; and one for each step of a walk.

    Returns
    -------
    numpy.ndarray of int64, shape (N, n_var)
    """
    return _change(terrain, np.ascontiguousarray(rows), rate, regrow, draws)


@kernel
def _walks(terrain, draws):
    out, ends = np.empty(1024, dtype=np.int64), np.zeros(len(draws) + 1, dtype=np.int64)
    path = np.empty(draws.shape[1], dtype=np.int64)
    seen = np.zeros(len(terrain.legal), dtype=np.int64)
    total = 0
    for i in range(len(draws)):
        path[0] = terrain.start
        seen[terrain.start] = i + 1
        n = _walk(terrain, path, 1, draws[i], seen, i + 1)
        out, total = write(path, 0, n, out, total)
        ends[i + 1] = total
    return out[:total].copy(), ends


@kernel
def _walk(terrain, path, n, draws, seen, mark):
    """Continue a path of n cells to the goal over cells that do not bear a mark; return its new length, 0 if that fails."""
    width = terrain.width
    gx, gy = terrain.goal % width, terrain.goal // width
    near, far = np.empty(8, dtype=np.int64), np.empty(8, dtype=np.int64)
    while path[n - 1] != terrain.goal:
        cell = path[n - 1]
        count = 0
        for m in range(8):
            if not (terrain.legal[cell] >> m) & 1:
                continue
            other = cell + terrain.offsets[m]
            if seen[other] == mark:
                continue
            distance = (other % width - gx) ** 2 + (other // width - gy) ** 2
            j = count
            while j > 0 and far[j - 1] > distance:
                near[j], far[j] = near[j - 1], far[j - 1]
                j -= 1
            near[j], far[j] = other, distance
            count += 1
        if count == 0 or n == len(path):
            return 0
        rank, draw = 0, draws[n]
        while rank < count - 1 and draw < 0.5:
            draw *= 2.0
            rank += 1
        path[n] = near[rank]
        seen[near[rank]] = mark
        n += 1
    return n


@kernel
def _cross(rows, goal, n_cells, draws):
    _, n_matings, n_var = rows.shape
    children = np.empty_like(rows)
    place = np.full(n_cells, -1, dtype=np.int64)
    a, b = np.empty(n_var, dtype=np.int64), np.empty(n_var, dtype=np.int64)
    path, out = np.empty(2 * n_var, dtype=np.int64), np.empty(2 * n_var, dtype=np.int64)
    at, to = np.empty(n_var, dtype=np.int64), np.empty(n_var, dtype=np.int64)
    for i in range(n_matings):
        n_a, n_b = _cells_of(rows[0, i], a), _cells_of(rows[1, i], b)
        for j in range(1, n_b - 1):
            place[b[j]] = j
        shared = 0
        for k in range(1, n_a - 1):
            if place[a[k]] >= 0:
                at[shared], to[shared] = k, place[a[k]]
                shared += 1
        # The numbers in `place` are those of this mating alone.
        for j in range(1, n_b - 1):
            place[b[j]] = -1
        children[0, i], children[1, i] = rows[0, i], rows[1, i]
        if shared == 0:
            continue
        chosen = int(draws[i] * shared)
        k, j = at[chosen], to[chosen]
        path, n = write(a, 0, k, path, 0)
        path, n = write(b, j, n_b, path, n)
        out = _write_row(path, n, place, out, goal, children[0, i])
        path, n = write(b, 0, j, path, 0)
        path, n = write(a, k, n_a, path, n)
        out = _write_row(path, n, place, out, goal, children[1, i])
    return children


@kernel
def _change(terrain, rows, rate, regrow, draws):
    n_rows, n_var = rows.shape
    changed = rows.copy()
    width = terrain.width
    place = np.full(len(terrain.legal), -1, dtype=np.int64)
    seen = np.zeros(len(terrain.legal), dtype=np.int64)
    path, walk, out = np.empty(n_var, dtype=np.int64), np.empty(n_var, dtype=np.int64), np.empty(n_var, dtype=np.int64)
    mark = 0
    for i in range(n_rows):
        n = _cells_of(rows[i], path)
        touched = False
        k = 1
        while k < n - 1:
            if draws[0, i, k] < rate:
                if draws[1, i, k] < regrow:
                    mark += 1
                    for j in range(k + 1):
                        walk[j] = path[j]
                        seen[path[j]] = mark
                    longer = _walk(terrain, walk, k + 1, draws[3, i], seen, mark)
                    if longer:
                        copy(walk, path, longer)
                        n, touched = longer, True
                        break
                else:
                    other = _beside(path[k - 1], path[k], path[k + 1], width, len(place) // width, draws[2, i, k])
                    touched |= other != path[k]
                    path[k] = other
            k += 1
        if touched:
            out = _write_row(path, n, place, out, terrain.goal, changed[i])
    return changed


@kernel
def _beside(before, cell, after, width, height, draw):
    """Return another cell beside two cells, or the cell itself if there is none."""
    found = np.empty(8, dtype=np.int64)
    n = 0
    x, y = before % width, before // width
    for m in range(8):
        ox, oy = x + DX[m], y + DY[m]
        if ox < 0 or ox >= width or oy < 0 or oy >= height:
            continue
        other = oy * width + ox
        apart = max(abs(ox - after % width), abs(oy - after // width))
        if apart == 1 and other != cell:
            found[n] = other
            n += 1
    return cell if n == 0 else found[int(draw * n)]


@kernel
def _cells_of(row, path):
    """Write the cells of a row, none following itself; return how many there are."""
    n = 0
    for cell in row:
        if cell >= 0 and (n == 0 or path[n - 1] != cell):
            path[n] = cell
            n += 1
    return n


@kernel
def _write_row(path, length, place, out, goal, row):
    """Write the first cells of a path into a row, without loops and filled up with the goal, if they fit; return ``out``."""
    out, n = append_without_loops(path, length, place, out, 0)
    for k in range(length):
        place[path[k]] = -1
    if n <= len(row):
        copy(out, row, n)
        row[n:] = goal
    return out
