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
        Cells (x, y), of which one and the next are neighbours; where a path that is not legal jumps, the middle of the jump
        stands for the way.
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
    # Twice the coordinates of centres and of middles of steps, all of them whole, each looked up once.
    visited = [np.concatenate([2 * cells, cells[1:] + cells[:-1]]) for cells in paths]
    height, width = occupied.shape
    places, where = np.unique(np.concatenate(visited) @ (1, 2 * width), return_inverse=True)
    points = np.stack([places % (2 * width), places // (2 * width)], axis=1) / 2
    whole = Box(0, 0, width, height)
    distances = Nearest(occupied[box.slices], box[:2]).distances(points)
    if (distances > _known_up_to(points, box, whole)).any():
        distances = Nearest(occupied).distances(points)
    first = np.cumsum([0, *map(len, visited[:-1])])
    return np.minimum.reduceat(distances[where.reshape(-1)], first)


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
