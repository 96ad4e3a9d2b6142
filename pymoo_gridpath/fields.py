"""Scalar fields over a grid: the potential of obstacles and the clearance from them."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike
from scipy import ndimage

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridError
from pymoo_gridpath.grid import Box, OccupancyGrid, check_box, check_grid

# Potentials are rounded to multiples of this, about 9e-10. Sums of such numbers are exact in double precision (up to
# 2**23), whatever their order, so paths over the same cells never differ by rounding noise.
QUANTUM = 2.0**-30


def obstacle_potential(grid: OccupancyGrid, variance: float = 0.5, box: Box | None = None) -> np.ndarray:
    """Return the bell-shaped repulsive potential of the obstacles.

    The potential of a cell is the sum over all occupied cells, itself included if it is occupied, of
    ``exp(-d**2 / (2 * variance))`` with d the distance of the two centres in cells.

    Parameters
    ----------
    grid : OccupancyGrid
    variance : float, default 0.5
        Variance of the bell in squared cells; larger values make paths keep further away.
    box : Box, optional
        The cells whose potential is wanted; all by default.

    Returns
    -------
    numpy.ndarray of float, shape (height, width) of the grid or of the box
        Rounded to multiples of 2**-30.

    Raises
    ------
    GridError
        If the grid is none, the box is none of its cells, or the variance is not a positive number.

    References
    ----------
    F. Ahmed and K. Deb, "Multi-objective optimal path planning using elitist non-dominated sorting genetic algorithms",
    Soft Computing 17(7), 2013, section 3.2 (variance of 50 % of the cell size).
    """
    check_grid(grid)
    variance = check_variance(variance)
    # The bell is separable; beyond this reach it is below 2e-17, far under the rounding.
    reach = math.ceil(min(math.sqrt(76.0 * variance), max(grid.shape)))
    with np.errstate(over="ignore"):  # of the narrowest bells, which are 0 beyond their own cell
        kernel = np.exp(-(np.arange(-reach, reach + 1.0) ** 2) / (2.0 * variance))
    box = grid.whole if box is None else check_box(box, grid)
    part = box.grown(reach, grid.shape)
    field = grid.occupied[part.slices].astype(float)
    for axis in (0, 1):
        field = ndimage.correlate1d(field, kernel, axis=axis, mode="constant")
    field = field[Box(box.x0 - part.x0, box.y0 - part.y0, box.x1 - part.x0, box.y1 - part.y0).slices]
    return np.round(field / QUANTUM) * QUANTUM


def clearance(grid: OccupancyGrid) -> np.ndarray:
    """Return the distance from each cell's centre to the centre of the nearest occupied cell.

    Returns
    -------
    numpy.ndarray of float, shape (height, width)
        Cells; ``inf`` everywhere if no cell is occupied.
    """
    if not check_grid(grid).occupied.any():
        return np.full(grid.shape, np.inf)
    return np.asarray(ndimage.distance_transform_edt(~grid.occupied))


class BoxedField:
    """A field over a grid that is known in a box, and worked out as a whole once a cell outside is asked for.

    Parameters
    ----------
    inside : numpy.ndarray of float, shape (height, width) of the box
    box : Box
    width : int
        Of the grid.
    whole : callable
        Called without arguments, returns the field over the grid, shape (height, width).
    """

    def __init__(self, inside: np.ndarray, box: Box, width: int, whole: Callable[[], np.ndarray]):
        self.inside, self.box = inside, box
        self._width, self._work_out, self._whole = width, whole, None

    def __array__(self, dtype=None, copy=None) -> np.ndarray:
        if self._whole is None:
            self._whole = np.asarray(self._work_out())
        return self._whole if dtype is None else self._whole.astype(dtype)

    def take(self, cells: np.ndarray) -> np.ndarray:
        """Return the values of cells, given by ``y * width + x`` in the grid."""
        x, y = cells % self._width - self.box.x0, cells // self._width - self.box.y0
        height, width = self.box.shape
        if ((x >= 0) & (x < width) & (y >= 0) & (y < height)).all():
            return self.inside.take(y * width + x)
        return np.asarray(self).take(cells)


def check_variance(variance: float) -> float:
    """Return the variance of a potential if it is one."""
    expected = "a positive number of squared cells"
    return checks.number("variance of the potential", variance, 0.0, above=True, expected=expected, error=GridError)


def check_field(name: str, field: ArrayLike, grid: OccupancyGrid) -> np.ndarray:
    """Return a field over a grid if it is one, shape (height, width), whatever its type of number."""
    return checks.array(
        name,
        field,
        grid.shape,
        expected=f"numbers of shape {grid.shape}, the (height, width) of the grid",
        error=GridError,
    )


def check_costs(name: str, field: ArrayLike, grid: OccupancyGrid) -> np.ndarray:
    """Return a field of costs of cells as floats.

    Returns
    -------
    numpy.ndarray of float, shape (height, width)
        A new array; zero in occupied cells where the given one is not finite.

    Raises
    ------
    GridError
        If it is of another shape, holds what is no number, or a negative one, or in a free cell one that is not finite.
    """
    costs = check_field(name, field, grid).astype(float, order="C")
    finite = np.isfinite(costs)
    for wrong, expected in (
        (finite & (costs < 0.0), "zero or more, also in cells without data"),
        (~finite & ~grid.occupied, "a finite number; mark cells that no path may enter as occupied"),
    ):
        if wrong.any():
            y, x = np.argwhere(wrong)[0]
            place = "occupied" if grid.occupied[y, x] else "free"
            raise GridError(f"{name} is {costs[y, x]:g} in the {place} cell ({x}, {y}), expected {expected}")
    return np.where(finite, costs, 0.0)
