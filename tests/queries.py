"""Random queries on random grids, for property tests."""

import numpy as np
from hypothesis import strategies as st

from pymoo_gridpath.errors import GridError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.paths.frame import MonotoneFrame
from pymoo_gridpath.testing.enumeration import RULES

# A spiral from the bottom left into the middle, which turns back along both axes.
SPIRAL = OccupancyGrid(
    [
        [0, 0, 0, 0, 0],
        [1, 1, 1, 1, 0],
        [0, 0, 0, 1, 0],
        [0, 1, 1, 1, 0],
        [0, 0, 0, 0, 0],
    ],
    name="spiral",
)


@st.composite
def queries(draw, density=0.15):
    """A random grid with a start and a goal that a monotone path joins, and the axis of the paths."""
    height, width = draw(st.integers(1, 9)), draw(st.integers(1, 9))
    seed = draw(st.integers(0, 2**32 - 1))
    rng = np.random.default_rng(seed)
    occupied = rng.random((height, width)) < density
    start = draw(st.integers(0, width - 1)), draw(st.integers(0, height - 1))
    goal = draw(st.integers(0, width - 1)), draw(st.integers(0, height - 1))
    axis = draw(st.sampled_from(["auto", "x", "y"]))
    for x, y in (start, goal):
        occupied[y, x] = False
    grid = OccupancyGrid(occupied, **draw(st.sampled_from(RULES)))
    try:
        MonotoneFrame(grid, start, goal, axis)
    except GridError:
        grid = grid.replace(occupied=np.zeros((height, width)))
    try:
        MonotoneFrame(grid, start, goal, axis)
    except GridError:
        start, goal, grid = (0, 0), (1, 0), OccupancyGrid(np.zeros((1, 2)))
        axis = "x"
    return grid, start, goal, axis, rng


def random_genes(coding, rng, n=20):
    return rng.integers(coding.xl, coding.xu, size=(n, coding.n_var), endpoint=True).astype(coding.vtype)
