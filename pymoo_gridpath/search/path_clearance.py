"""The least distance of whole paths from obstacles, measured to the sides of occupied cells, and exact."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pymoo_gridpath.grid import Box
from pymoo_gridpath.search.nearest import Nearest


def least_distances(occupied: np.ndarray, paths: Sequence[np.ndarray], box: Box) -> np.ndarray:
    """Return the least distance of each path from the nearest occupied cell, wherever on its way.

    Parameters
    ----------
    occupied : numpy.ndarray of bool, shape (height, width)
    paths : sequence of numpy.ndarray of int, each of shape (n_cells, 2)
        Cells (x, y), of which one and the next are neighbours; where a path that is not legal jumps, its ends count alone.
    box : Box
        The part of the array that is looked at first; more of it is, if an obstacle beyond may be nearer.

    Returns
    -------
    numpy.ndarray of float, shape (N,)
        Cells; ``inf`` if none is occupied.

    Notes
    -----
    Between the centres of two neighbours the distance is least at one of them or, on a diagonal, halfway: squares are as wide
    as steps, and the corners of squares that lie beside a diagonal step lie beside its ends or its middle.
    """
    if not len(paths):
        return np.empty(0)
    cells, first = np.concatenate(paths), np.cumsum([0, *map(len, paths[:-1])])
    step = np.diff(cells, axis=0)
    diagonal = (np.abs(step) == 1).all(axis=1)
    diagonal[first[1:] - 1] = False  # from one path to the next
    near = Nearest(occupied[box.slices], box[:2])
    at_cells = _distances(near, occupied, box, cells, 0.0)
    halfway = _distances(near, occupied, box, np.minimum(cells[:-1], cells[1:])[diagonal], 0.5)
    at_cells[:-1][diagonal] = np.minimum(at_cells[:-1][diagonal], halfway)
    return np.minimum.reduceat(at_cells, first)


def _distances(near: Nearest, occupied: np.ndarray, box: Box, cells: np.ndarray, aside: float) -> np.ndarray:
    """Return the distance of each cell's centre, moved up and to the right, float, shape (n,); each is worked out once."""
    height, width = occupied.shape
    keys: np.ndarray = cells[:, 0] + width * cells[:, 1]
    seen = np.zeros(occupied.size, dtype=bool)
    seen[keys] = True
    places = np.flatnonzero(seen)
    points = np.stack([places % width, places // width], axis=1) + aside
    found = near.distances(points)
    if (found > _known_up_to(points, box, Box(0, 0, width, height))).any():
        found = Nearest(occupied).distances(points)
    distances = np.empty(occupied.size)  # of which only these pages are touched
    distances[places] = found
    return distances[keys]


def _known_up_to(points: np.ndarray, box: Box, whole: Box) -> np.ndarray:
    """Return up to which distance from points nothing lies outside a box, float, shape (n,)."""
    x, y = points.T
    sides = [
        (x - box.x0, box.x0 > whole.x0),
        (y - box.y0, box.y0 > whole.y0),
        (box.x1 - 1 - x, box.x1 < whole.x1),
        (box.y1 - 1 - y, box.y1 < whole.y1),
    ]
    return np.min([np.where(ends, far + 0.5, np.inf) for far, ends in sides], axis=0)
