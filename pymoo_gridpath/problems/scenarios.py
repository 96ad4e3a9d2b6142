"""Scenario generators: grids with a path that is sure to exist."""

from __future__ import annotations

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.paths import ColumnPaths
from pymoo_gridpath.paths.frame import MonotoneFrame

#: The largest grid to draw has so many cells a side.
MOST_CELLS = 4096


def random_dense_grid(size: int, p0: float, random_state: np.random.Generator | int) -> OccupancyGrid:
    """Return a square grid of the paper's section 6: a random valid path kept free, the rest occupied with probability p0.

    The path leads from the bottom-left to the top-right corner. The paper does not say how it is drawn; here each
    column but the last is left at a uniformly random row, the rows in ascending order, and the cells are those of the
    integer coding. Over 200 draws such paths have 10.8, 21.8 and 43.7 cells on average for sizes 8, 16 and 32; Table 1
    implies 10, 23 and 57.

    Parameters
    ----------
    size : int
        Cells a side, 2 to 4096.
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
        If an argument is of another kind or out of its range.

    References
    ----------
    Ahmed and Deb (2013), section 6.
    """
    size = checks.whole("size", size, 2, MOST_CELLS, expected=f"2 to {MOST_CELLS:,} cells a side", error=GridError)
    p0 = checks.number("p0", p0, 0.0, 1.0, expected="a probability from 0 to 1", error=GridError)
    if not isinstance(random_state, np.random.Generator):
        random_state = checks.whole(
            "random_state", random_state, 0, expected="a seed or a numpy.random.Generator", error=GridError
        )
        random_state = np.random.default_rng(random_state)
    empty = OccupancyGrid(np.zeros((size, size), dtype=bool), corner_cutting=True)
    frame = MonotoneFrame(empty, (0, 0), (size - 1, size - 1))
    rows = np.sort(random_state.integers(0, size, size=size - 1))
    path = ColumnPaths.through(frame, rows[None, :]).cells(0)
    occupied = random_state.random((size, size)) < p0
    occupied[path[:, 1], path[:, 0]] = False
    return OccupancyGrid(occupied, corner_cutting=True, name=f"random {size} x {size}, p0 = {p0:g}")
