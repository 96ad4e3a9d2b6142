"""Scenario generators: grids with a path that is sure to exist."""

from __future__ import annotations

import numpy as np

from pymoo_gridpath.errors import GridError
from pymoo_gridpath.frame import MonotoneFrame
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.paths import ColumnPaths


def random_dense_grid(size: int, p0: float, random_state: np.random.Generator | int) -> OccupancyGrid:
    """Return a square grid of the paper's section 6: a random valid path kept free, the rest occupied with probability p0.

    The path leads from the bottom-left to the top-right corner. The paper does not say how it is drawn; here each
    column but the last is left at a uniformly random row, the rows in ascending order, and the cells are those of the
    integer coding. Over 200 draws such paths have 10.8, 21.8 and 43.7 cells on average for sizes 8, 16 and 32; Table 1
    implies 10, 23 and 57.

    Parameters
    ----------
    size : int
        Cells a side, at least 2.
    p0 : float
        Probability of an obstacle in every cell off the path, 0 to 1.
    random_state : numpy.random.Generator or int
        Source of randomness, or a seed.

    Returns
    -------
    OccupancyGrid
        With ``corner_cutting=True``, as in the paper.

    Raises
    ------
    GridError
        If size or p0 is out of its range.

    References
    ----------
    Ahmed and Deb (2013), section 6.
    """
    if size < 2:
        raise GridError(f"size is {size}, expected at least 2 cells a side")
    if not 0.0 <= p0 <= 1.0:
        raise GridError(f"p0 is {p0}, expected a probability from 0 to 1")
    random_state = np.random.default_rng(random_state)
    empty = OccupancyGrid(np.zeros((size, size), dtype=bool), corner_cutting=True)
    frame = MonotoneFrame(empty, (0, 0), (size - 1, size - 1))
    rows = np.sort(random_state.integers(0, size, size=size - 1))
    path = ColumnPaths.through(frame, rows[None, :]).cells(0)
    occupied = random_state.random((size, size)) < p0
    occupied[path[:, 1], path[:, 0]] = False
    return OccupancyGrid(occupied, corner_cutting=True, name=f"random {size} x {size}, p0 = {p0:g}")
