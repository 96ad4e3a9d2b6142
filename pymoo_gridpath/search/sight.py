"""Line of sight: which cells see one another, and the waypoints of paths that follow such lines.

A cell sees another where two tests hold. The straight line between their centres crosses no occupied cell, and passes no
corner that may not be cut; and its digital line, the cells that stand for it on the grid, is a chain of legal steps. The second
does not follow from the first: where corners may not be cut, rounding may lead diagonally past an obstacle that the line itself
misses. With both, a polyline of such lines can be driven as it is, and as a path of cells.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.neighbourhood import HEADING_OF
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.sequences import cut_loops

# A gain below this, in cells, is rounding of numbers.
_ROUNDING = 1e-9

# A pass that shortens a path by less, in cells, is no reason for another: centres of cells stand for points half a cell around.
_LEAST_GAIN = 0.1


class Waypoints(NamedTuple):
    """The corners of a polyline whose every piece is a line of sight, from the start to the goal.

    Attributes
    ----------
    cells : numpy.ndarray of int, shape (n, 2)
        Cells (x, y).
    metres : numpy.ndarray of float, shape (n, 2), or None
        Their centres in the frame of the map; None on a map in cells.
    """

    cells: np.ndarray
    metres: np.ndarray | None

    @classmethod
    def of(cls, grid: OccupancyGrid, cells: np.ndarray) -> Waypoints:
        """Return the waypoints at cells (x, y) of a grid, shape (n, 2)."""
        return cls(cells, None if grid.resolution is None else grid.to_metres(cells))

    @property
    def length(self) -> float:
        """Euclidean length in cells."""
        return _length(self.cells)

    @property
    def length_m(self) -> float | None:
        """Euclidean length in metres; None on a map in cells."""
        return None if self.metres is None else _length(self.metres)

    @property
    def curvature(self) -> tuple[float, float]:
        """Greatest and mean curvature, 1 / m, or one by the side of a cell on a map in cells.

        A polyline has none of its own: it is 0 along a piece and infinite at a corner. So the line is cut into pieces of one
        cell, as near as their number allows, and the curvature is Menger's, that of the circle through three of their ends.
        """
        line = self.cells if self.metres is None else self.metres
        along_it = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
        at = np.linspace(0.0, along_it[-1], max(round(self.length), 2) + 1)
        points = np.stack([np.interp(at, along_it, line[:, axis]) for axis in (0, 1)], axis=1)
        before, after, both = points[1:-1] - points[:-2], points[2:] - points[1:-1], points[2:] - points[:-2]
        product = np.hypot(*before.T) * np.hypot(*after.T) * np.hypot(*both.T)
        twice = 2.0 * np.abs(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0])
        curvature = np.divide(twice, product, out=np.zeros(len(product)), where=product > 0)
        return float(curvature.max()), float(curvature.mean())


def _length(points: np.ndarray) -> float:
    return float(np.hypot(*np.diff(points, axis=0).T).sum())


def path_length(moves: Moves, path: np.ndarray) -> float:
    """Return the Euclidean length, in cells, of the line from each cell to the next, given by their indices."""
    return _length(moves.cells(path))


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
        waypoints = farthest_seen(moves.legal, moves.offsets, moves.width, way, backward)
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
    if n + steps > len(path):
        longer = np.empty(2 * (n + steps), dtype=path.dtype)
        longer[:n] = path[:n]
        path = longer
    for k in range(1, steps + 1):
        path[n] = (y + (2 * k * dy + steps) // (2 * steps)) * width + x + (2 * k * dx + steps) // (2 * steps)
        n += 1
    return path, n


@kernel
def farthest_seen(legal, offsets, width, path, backward=False):
    """Return which cells of a path are left when each sees the next: the first, the last that it sees, and so on.

    Parameters
    ----------
    path : int64, shape (n,)
        Indices of cells, each of which a legal step leads to from the one before.
    backward : bool
        Whether the path leads from its end to its start: then each must be seen by the next.

    Returns
    -------
    int64, shape (m,)
        Their indices in the grid. What a cell sees along a path comes and goes, so that the search is from the end.
    """
    kept = np.empty(len(path), dtype=np.int64)
    kept[0] = path[0]
    n, i = 1, 0
    while i < len(path) - 1:
        j = len(path) - 1
        while j > i + 1:
            if backward and sees(legal, offsets, width, path[j], path[i]):
                break
            if not backward and sees(legal, offsets, width, path[i], path[j]):
                break
            j -= 1
        i = j
        kept[n] = path[i]
        n += 1
    return kept[:n].copy()


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
