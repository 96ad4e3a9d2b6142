"""How far it is to the nearest obstacle, from any point and along any line, measured to the sides of occupied cells."""

from __future__ import annotations

import functools
import math
from itertools import pairwise

import numpy as np

from pymoo_gridpath.compiled import kernel

# The row of no cell.
_FAR = 2**30

# Means along a line are those of so many points a cell.
_POINTS_A_CELL = 8


class Nearest:
    """Distances to the occupied cells of an array, which are squares of side 1.

    Parameters
    ----------
    occupied : numpy.ndarray of bool, shape (height, width)
    corner : (int, int), default (0, 0)
        The cell (x, y) of the grid that is the array's [0, 0].

    Attributes
    ----------
    above, below : numpy.ndarray of int32, shape (height, width)
        The row of the nearest occupied cell of the column at or above each cell, and at or below; of shape (0, 0) if none is
        occupied. With these the distance from a point takes a look at as many columns as it is cells away, see `distance`.

    Notes
    -----
    Points are in cells: the centre of cell (x, y) is (x, y). Distances are exact, not those from centre to centre. What lies
    outside of the array is free.

    Examples
    --------
    >>> nearest = Nearest(np.array([[0, 0, 1], [0, 0, 0]], dtype=bool))
    >>> nearest.distances(np.array([[0.0, 0.0], [2.0, 1.0], [1.25, 0.75]])).tolist()
    [1.5, 0.5, 0.3535533905932738]
    """

    def __init__(self, occupied: np.ndarray, corner: tuple[int, int] = (0, 0)):
        self.occupied, self.corner = occupied, np.array(corner)
        if not occupied.any():
            self.above = self.below = np.empty((0, 0), dtype=np.int32)
            return
        rows = np.arange(len(occupied), dtype=np.int32)[:, None]
        self.below = np.maximum.accumulate(np.where(occupied, rows, np.int32(-_FAR)), axis=0)
        above = np.minimum.accumulate(np.where(occupied, rows, np.int32(_FAR))[::-1], axis=0)
        self.above = np.ascontiguousarray(above[::-1])

    def distances(self, points: np.ndarray) -> np.ndarray:
        """Return the distance from points (x, y) of the array to the nearest obstacle, shape (N,); ``inf`` if there is none."""
        x, y = np.ascontiguousarray((points - self.corner).T, dtype=float)
        return _distances(self.above, self.below, x, y)

    def least(self, points: np.ndarray) -> float:
        """Return the least distance of the line through points, shape (N, 2), to an obstacle."""
        points = points - self.corner
        least = float(_distances(self.above, self.below, *np.ascontiguousarray(points.T, dtype=float)).min())
        if not 0.0 < least < np.inf:
            return least
        for a, b in pairwise(points):
            # Only cells nearer than what is known can make it less.
            low = np.maximum(np.floor(np.minimum(a, b) - least).astype(int), 0)
            high = np.ceil(np.maximum(a, b) + least).astype(int) + 1
            ys, xs = np.nonzero(self._rim[low[1] : high[1], low[0] : high[0]])
            if len(xs):
                least = min(least, float(_from_line(a, b, np.stack([xs, ys], axis=1) + low).min()))
        return least

    def mean(self, points: np.ndarray) -> float:
        """Return the mean distance along the line through points, shape (N, 2), from 8 points or more a cell."""
        if len(points) == 1 or not self.above.size:
            return float(self.distances(points[:1])[0])
        lengths = np.hypot(*np.diff(points, axis=0).T)
        parts = np.maximum(np.ceil(_POINTS_A_CELL * lengths), 1).astype(int)
        piece = np.repeat(np.arange(len(parts)), parts)
        # The middle of each part.
        share = (np.arange(len(piece)) - np.repeat(np.cumsum(parts) - parts, parts) + 0.5) / parts[piece]
        found = self.distances(points[piece] + share[:, None] * np.diff(points, axis=0)[piece])
        weights = lengths[piece] / parts[piece]
        return float(np.average(found, weights=weights)) if weights.any() else float(found[0])

    @functools.cached_property
    def _rim(self) -> np.ndarray:
        """The occupied cells that are not between four others: one of these is the nearest of any free point."""
        inner = np.pad(self.occupied, 1)
        return self.occupied & ~(inner[:-2, 1:-1] & inner[2:, 1:-1] & inner[1:-1, :-2] & inner[1:-1, 2:])


def _from_line(a: np.ndarray, b: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Return the distance of each cell's square, shape (N, 2), from the line between two points, shape (N,)."""
    found = np.minimum(*(np.hypot(*np.maximum(np.abs(end - cells) - 0.5, 0.0).T) for end in (a, b)))
    step = b - a
    square = float(step @ step)
    if square == 0.0:
        return found
    for side in ((-0.5, -0.5), (-0.5, 0.5), (0.5, -0.5), (0.5, 0.5)):
        to = cells + side - a
        share = np.clip(to @ step / square, 0.0, 1.0)
        found = np.minimum(found, np.hypot(*(to - share[:, None] * step).T))
    # Where the line passes through: the shares of it between the sides in x and in y overlap.
    begin, end = np.zeros(len(cells)), np.ones(len(cells))
    for axis in (0, 1):
        low, high = cells[:, axis] - 0.5 - a[axis], cells[:, axis] + 0.5 - a[axis]
        if step[axis] == 0.0:
            end = np.where((low > 0) | (high < 0), -1.0, end)
            continue
        shares = np.sort(np.stack([low, high]) / step[axis], axis=0)
        begin, end = np.maximum(begin, shares[0]), np.minimum(end, shares[1])
    return np.where(begin <= end, 0.0, found)


@kernel
def _distances(above, below, x, y):
    found = np.empty(len(x), dtype=np.float64)
    for k in range(len(x)):
        found[k] = distance(above, below, x[k], y[k])
    return found


@kernel
def distance(above, below, x, y):
    """Return the distance from a point to the nearest occupied cell, see `Nearest`; columns are looked at from it outwards."""
    height, width = above.shape
    best = np.inf
    if height == 0:
        return best
    row = min(max(math.floor(y + 0.5), 0), height - 1)
    column = min(max(math.floor(x + 0.5), 0), width - 1)
    k = 0
    while k <= max(column, width - 1 - column):
        done = True
        for side in (-1, 1):
            at = column + side * k
            across = max(side * (at - x) - 0.5, 0.0)
            if across * across >= best:
                continue
            done = False
            if at < 0 or at >= width:
                continue
            high, low = above[row, at], below[row, at]
            up = 0.0 if high == row else min(high - 0.5 - y, y - low - 0.5)
            # Half of the number for no row is more than any grid is high.
            if up < 0.5 * _FAR:
                best = min(best, across * across + up * up)
        if done:
            break
        k += 1
    return math.sqrt(best)
