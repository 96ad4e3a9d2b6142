"""Line of sight: which cells see one another, and paths that follow such lines.

A cell sees another where two tests hold. The straight line between their centres crosses no occupied cell, and passes no
corner that may not be cut; and its digital line, the cells that stand for it on the grid, is a chain of legal steps. The second
does not follow from the first: where corners may not be cut, rounding may lead diagonally past an obstacle that the line itself
misses. With both, a polyline of such lines can be driven as it is, and as a path of cells.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.neighbourhood import HEADING_OF
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.search.arrays import room
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.nearest import Nearest, distance
from pymoo_gridpath.search.sequences import cut_loops

# A gain below this, in cells, is rounding of numbers.
_ROUNDING = 1e-9

# A pass that shortens a path by less, in cells, is no reason for another: centres of cells stand for points half a cell around.
_LEAST_GAIN = 0.1

# What a line has to spare must be more, in cells, so that few points of it tell.
_LEAST_SPARE = 1.0 / 64.0

# So much nearer than the robot is wide a line may come, in cells, where the path just passes: else stairs would be left there.
_GRAZE = 1.0 / 32.0


class Promise(NamedTuple):
    """How clear of obstacles a line must be that replaces a stretch of a path.

    Each point of the line, at some share of its length, shall be at most ``tolerance`` nearer to an obstacle than the path is
    at the same share of the stretch, and no nearer than the robot is wide, by more than a 32nd of a cell, unless the path is. A
    stretch that is straight already is kept as it is.

    Attributes
    ----------
    above, below : numpy.ndarray of int32
        Of a `Nearest` of the obstacles.
    x, y : numpy.ndarray of float, shape (n,)
        The path's cells, counted as in those arrays.
    along : numpy.ndarray of float, shape (n,)
        The length of the path up to each.
    tolerance, robot : float
        The tolerance, and the radius of the robot from whose centre distances are, in cells.
    """

    above: np.ndarray
    below: np.ndarray
    x: np.ndarray
    y: np.ndarray
    along: np.ndarray
    tolerance: float
    robot: float

    @classmethod
    def of(cls, nearest: Nearest, cells: np.ndarray, tolerance: float, robot: float) -> Promise:
        """Return the promise for a path of cells (x, y), shape (n, 2)."""
        x, y = np.ascontiguousarray((cells - nearest.corner).T, dtype=float)
        along = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
        return cls(nearest.above, nearest.below, x, y, along, float(tolerance), float(robot))


# Planners ask of a line no more than that it is one of sight.
_NO_CELLS, _NO_ROWS = np.empty(0), np.empty((0, 0), dtype=np.int32)
_NO_PROMISE = Promise(_NO_ROWS, _NO_ROWS, _NO_CELLS, _NO_CELLS, _NO_CELLS, np.inf, 0.0)


def path_length(moves: Moves, path: np.ndarray) -> float:
    """Return the Euclidean length, in cells, of the line from each cell to the next, given by their indices."""
    y = path // moves.width
    x = path - y * moves.width
    return float(np.hypot(x[1:] - x[:-1], y[1:] - y[:-1]).sum())


def visible(moves: Moves, cells: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Return whether each cell sees another, both tests, bool, shape (N,).

    Parameters
    ----------
    moves : Moves
        Both tests are of its steps, so that where it has not all headings, lines keep to those that it has.
    cells, others : numpy.ndarray of int, shape (N,)
        Indices of free cells. The digital line is that from the cell to the other, which need not be the one back.
    """
    cells, others = (np.ascontiguousarray(index, dtype=np.int64) for index in (cells, others))
    return _visible(moves.legal, moves.offsets, moves.width, cells, others)


def digital_line(moves: Moves, cell: int, other: int) -> np.ndarray:
    """Return the indices of the cells that stand for the line from a cell to another, int64, shape (n + 1,).

    Cell k of them is the one nearest to the point k steps of n along it, halves rounded up, where n is the larger of the
    distances in x and y.
    """
    line, n = append_line(moves.width, cell, other, np.array([cell]), 1)
    return line[:n].copy()


def farthest_seen(moves: Moves, path: np.ndarray, backward: bool = False, promise: Promise = _NO_PROMISE) -> np.ndarray:
    """Return which cells of a path are left when each sees the next: the first, the last that it sees, and so on.

    Parameters
    ----------
    moves : Moves
    path : numpy.ndarray of int64, shape (n,)
        Indices of cells, each of which a legal step leads to from the one before.
    backward : bool
        Whether the path leads from its end to its start: then each must be seen by the next.
    promise : Promise, optional
        What lines must keep besides.

    Returns
    -------
    numpy.ndarray of int64, shape (m,)
    """
    return path[places_of_farthest(moves, path, backward, promise)]


def places_of_farthest(moves: Moves, path: np.ndarray, backward: bool, promise: Promise) -> np.ndarray:
    """Return where in the path those cells stand, see `farthest_seen`."""
    return _farthest(moves.legal, moves.offsets, moves.width, path, backward, promise)


def smoothed(moves: Moves, path: np.ndarray, backward: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Return the waypoints of a path when each jumps to the last cell in sight, and the cells of the lines between them.

    Parameters
    ----------
    moves : Moves
    path : numpy.ndarray of int64, shape (n,)
        Indices of cells, each of which a legal step leads to from the one before.
    backward : bool
        Whether to jump from the end to the start. What is returned leads from the start to the end all the same.

    Returns
    -------
    waypoints : numpy.ndarray of int64, shape (m,)
    cells : numpy.ndarray of int64, shape (k,)
    """
    while True:
        way = path[::-1].copy() if backward else path
        waypoints = farthest_seen(moves, way, backward)
        waypoints = waypoints[::-1].copy() if backward else waypoints
        cells = along(moves.width, waypoints)
        path = cut_loops(Sequences(cells, np.array([0, len(cells)])), moves.n_cells).cells
        # Lines may cross one another; what is left then is smoothed anew.
        if len(path) == len(cells):
            return waypoints, cells


def shorten(moves: Moves, path: np.ndarray, max_passes: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Shorten a path by line of sight, forward and backward in turn, until neither gains a tenth of a cell.

    Each pass starts from all cells of the path before. It counts only if it is shorter, or as long with fewer waypoints:
    rounding to cells moves points, so that without this rule passes may run in circles.

    Parameters
    ----------
    moves : Moves
    path : numpy.ndarray of int64, shape (n,)
    max_passes : int

    Returns
    -------
    waypoints : numpy.ndarray of int64, shape (m,)
        Each sees the next.
    cells : numpy.ndarray of int64, shape (k,)
    lengths : numpy.ndarray of float, shape (passes + 1,)
        Euclidean length in cells before the first pass, and after each.

    References
    ----------
    Hliwa and Atieh, algorithm 1.
    """
    waypoints, cells = path, path
    lengths = [path_length(moves, path)]
    idle = 0
    while idle < 2 and len(lengths) <= max_passes:
        tried = smoothed(moves, cells, backward=len(lengths) % 2 == 0)
        gain = lengths[-1] - path_length(moves, tried[0])
        # The first pass of a straight path gains nothing but fewer waypoints.
        if gain > _ROUNDING or (gain > -_ROUNDING and len(tried[0]) < len(waypoints)):
            waypoints, cells = tried
        idle = 0 if gain >= _LEAST_GAIN else idle + 1
        lengths.append(path_length(moves, waypoints))
    return waypoints, cells, np.array(lengths)


@kernel
def _visible(legal, offsets, width, cells, others):
    found = np.zeros(len(cells), dtype=np.bool_)
    for k in range(len(cells)):
        found[k] = sees(legal, offsets, width, cells[k], others[k])
    return found


@kernel
def sees(legal, offsets, width, cell, other):
    """Return whether a cell sees another; see `visible`."""
    return line_is_free(legal, offsets, width, cell, other) and chain_is_legal(legal, width, cell, other)


@kernel
def line_is_free(legal, offsets, width, cell, other):
    """Return whether the line between the centres of two cells leads from cell to cell by legal steps.

    It leaves a cell through a side, or through a corner that it meets exactly: then the step is diagonal, and legal under the
    same rule for corners.
    """
    dx, dy = other % width - cell % width, other // width - cell // width
    nx, ny = abs(dx), abs(dy)
    sx, sy = (1 if dx > 0 else -1), (1 if dy > 0 else -1)
    ix = iy = 0
    while ix < nx or iy < ny:
        # Twice the distances along the line to the next side in x and in y, as fractions of the same whole.
        ahead = (2 * ix + 1) * ny - (2 * iy + 1) * nx
        stepx, stepy = (sx if ahead <= 0 else 0), (sy if ahead >= 0 else 0)
        m = HEADING_OF[stepy + 1, stepx + 1]
        if not (legal[cell] >> m) & 1:
            return False
        cell += offsets[m]
        ix += abs(stepx)
        iy += abs(stepy)
    return True


@kernel
def chain_is_legal(legal, width, cell, other):
    """Return whether the digital line from a cell to another is a chain of legal steps."""
    x, y = cell % width, cell // width
    dx, dy = other % width - x, other // width - y
    n = max(abs(dx), abs(dy))
    before_x = before_y = 0
    for k in range(1, n + 1):
        after_x, after_y = (2 * k * dx + n) // (2 * n), (2 * k * dy + n) // (2 * n)
        m = HEADING_OF[after_y - before_y + 1, after_x - before_x + 1]
        if not (legal[(y + before_y) * width + x + before_x] >> m) & 1:
            return False
        before_x, before_y = after_x, after_y
    return True


@kernel
def append_line(width, cell, other, path, n):
    """Append the digital line from a cell to another, without the former, to the ``n`` cells of a path; return both anew."""
    x, y = cell % width, cell // width
    dx, dy = other % width - x, other // width - y
    steps = max(abs(dx), abs(dy))
    path = room(path, n + steps)
    for k in range(1, steps + 1):
        path[n] = (y + (2 * k * dy + steps) // (2 * steps)) * width + x + (2 * k * dx + steps) // (2 * steps)
        n += 1
    return path, n


@kernel
def _farthest(legal, offsets, width, path, backward, promise):
    """Return the places of `farthest_seen`. What a cell sees comes and goes, so that the search is from the end."""
    kept = np.zeros(len(path), dtype=np.int64)
    n, i = 1, 0
    while i < len(path) - 1:
        j = len(path) - 1
        while j > i + 1:
            cell, other = (path[j], path[i]) if backward else (path[i], path[j])
            if sees(legal, offsets, width, cell, other) and keeps_clear(promise, i, j):
                break
            j -= 1
        i = j
        kept[n] = i
        n += 1
    return kept[:n].copy()


@kernel
def keeps_clear(promise, i, j):
    """Return whether the line that replaces the stretch from one place of a path to another keeps a promise.

    Both the line and the path come nearer to obstacles by no more than they move on, so that from what is to spare at one share
    follows how far on nothing has to be looked at.
    """
    if promise.tolerance == np.inf or promise.above.size == 0:
        return True
    dx, dy = promise.x[j] - promise.x[i], promise.y[j] - promise.y[i]
    moved = promise.along[j] - promise.along[i]
    line = math.sqrt(dx * dx + dy * dy)
    if moved - line < _ROUNDING:
        return True
    # Lines that do not are told soonest at points far apart.
    for k in (4, 2, 6, 1, 3, 5, 7):
        if _to_spare(promise, i, j, k / 8) < _LEAST_SPARE:
            return False
    share = 0.0
    while share < 1.0:
        spare = _to_spare(promise, i, j, share)
        if spare < _LEAST_SPARE:
            return False
        share += spare / (moved + line)
    return True


@kernel
def _to_spare(promise, i, j, share):
    """Return by how much the line is clearer than promised at a share of its length."""
    x, y, along = promise.x, promise.y, promise.along
    at = along[i] + share * (along[j] - along[i])
    low, high = i, j
    while high - low > 1:
        middle = (low + high) // 2
        if along[middle] <= at:
            low = middle
        else:
            high = middle
    part = (at - along[low]) / (along[high] - along[low])
    before = distance(promise.above, promise.below, x[low] + part * (x[high] - x[low]), y[low] + part * (y[high] - y[low]))
    after = distance(promise.above, promise.below, x[i] + share * (x[j] - x[i]), y[i] + share * (y[j] - y[i]))
    return after - max(before - promise.tolerance, min(before, promise.robot) - _GRAZE)


@kernel
def along(width, waypoints):
    """Return the cells of the digital lines from each waypoint to the next, int64, shape (n,)."""
    path, n = waypoints[:1].copy(), 1
    for k in range(len(waypoints) - 1):
        path, n = append_line(width, waypoints[k], waypoints[k + 1], path, n)
    return path[:n].copy()


@kernel
def towards(width, cell, other):
    """Return the heading of the signs of what is left in x and y from a cell to another; -1 if nothing is."""
    return sign_heading(other % width - cell % width, other // width - cell // width)


@kernel
def sign_heading(dx, dy):
    """Return the heading of the signs of a distance in x and in y; -1 if both are 0."""
    return HEADING_OF[1 + int(dy > 0) - int(dy < 0), 1 + int(dx > 0) - int(dx < 0)]
