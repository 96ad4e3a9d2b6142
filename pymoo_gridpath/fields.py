"""Scalar fields over a grid: the potential of obstacles and the clearance from them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy import ndimage

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridError
from pymoo_gridpath.grid import Box, OccupancyGrid, check_box, check_grid

# Potentials are rounded to multiples of this, about 9e-10. Sums of such numbers are exact in double precision (up to
# 2**23), whatever their order, so paths over the same cells never differ by rounding noise.
QUANTUM = 2.0**-30

#: The paper's variance, in squared cells.
PAPER_VARIANCE = 0.5

# The robot's bell: standard deviation in metres and at least in cells, and where it is cut off.
ROBOT_SIGMA_M, LEAST_SIGMA, ROBOT_CUTOFF = 0.3, 2.0, 1e-6

# Standard deviations in cells.
_NARROWEST, _WIDEST = 1e-100, 1e12

# Distances that differ by less than this share are the same.
_SAME = 1e-9


class Bell(NamedTuple):
    """The shape of a potential with everything written out that a map decides where it is not given.

    Attributes
    ----------
    variance : float or None
        In squared cells.
    sigma_m : float or None
        Standard deviation in metres; either this or the variance is None.
    nearest : bool
    cutoff : float
    """

    variance: float | None
    sigma_m: float | None
    nearest: bool
    cutoff: float

    def in_cells(self, grid: OccupancyGrid) -> float:
        """Return the variance in squared cells.

        Raises
        ------
        GridError
            If the bell is in metres, and the map is one in cells.
        """
        if self.sigma_m is None:
            assert self.variance is not None
            return self.variance
        # Its square has to be a number, and none is wider than any map or narrower than the rounding.
        return min(max(self.sigma_m / grid.check_resolution("a risk in metres"), _NARROWEST), _WIDEST) ** 2


def settled_bell(
    grid: OccupancyGrid,
    variance: float | None = None,
    sigma_m: float | None = None,
    nearest: bool | None = None,
    cutoff: float | None = None,
) -> Bell:
    """Return the bell of the obstacles' potential on a map, by the one place that says what it is by default.

    Parameters
    ----------
    grid : OccupancyGrid
    variance, sigma_m, nearest, cutoff : optional
        See `obstacle_potential`.

    Raises
    ------
    GridError
        See `obstacle_potential`.
    """
    given = given_bell(variance, sigma_m, nearest, cutoff)
    if variance is None and sigma_m is None:
        if grid.resolution is None:
            given["variance"] = PAPER_VARIANCE
        else:
            given["sigma_m"] = max(ROBOT_SIGMA_M, LEAST_SIGMA * grid.resolution)
    alone = given.setdefault("nearest", "sigma_m" in given)
    given.setdefault("cutoff", ROBOT_CUTOFF if alone else 0.0)
    return Bell(**{"variance": None, "sigma_m": None, **given})


def given_bell(
    variance: float | None = None, sigma_m: float | None = None, nearest: bool | None = None, cutoff: float | None = None
) -> dict[str, Any]:
    """Return what of a bell is given, see `obstacle_potential`, if it can be.

    Raises
    ------
    GridError
        If the variance or standard deviation is no positive number or both are given, or the cutoff is not from 0 to below 1.
    """
    found: dict[str, Any] = {}
    if variance is not None and sigma_m is not None:
        raise GridError(
            f"variance is {checks.shown(variance)} and sigma_m is {checks.shown(sigma_m)}, expected one of them: both say how "
            f"wide a bell is"
        )
    if variance is not None:
        found["variance"] = check_variance(variance)
    if sigma_m is not None:
        what, expected = "sigma_m of the potential", "a positive number of metres"
        found["sigma_m"] = checks.number(what, sigma_m, 0.0, above=True, expected=expected, error=GridError)
    if nearest is not None:
        found["nearest"] = checks.flag("nearest", nearest, GridError)
    if cutoff is not None:
        # The largest number below 1.
        most, expected = math.nextafter(1.0, 0.0), "a share of the peak of a bell, from 0 to below 1"
        found["cutoff"] = checks.number("cutoff of the potential", cutoff, 0.0, most, expected=expected, error=GridError)
    return found


def obstacle_potential(
    grid: OccupancyGrid,
    variance: float | None = None,
    box: Box | None = None,
    *,
    sigma_m: float | None = None,
    nearest: bool | None = None,
    cutoff: float | None = None,
) -> np.ndarray:
    """Return the bell-shaped repulsive potential of the obstacles.

    Either the sum over all occupied cells, the cell itself included if it is occupied, of ``exp(-d**2 / (2 * variance))`` with
    d the distance of the two centres in cells, as in the paper; or that of the nearest occupied cell alone. Sums of wide bells
    mislead: thick regions weigh as if there were more to run into.

    What is not given the map decides. One that states its resolution is a robot's: the bell is that of the nearest obstacle,
    with a standard deviation of 0.3 m, at least two cells, and cut off at 1e-6. A map in cells is in the world of the paper:
    bells of all obstacles are added, with a variance of 0.5 squared cells, and nothing is cut off. A width that is given says
    which of the two is meant.

    Parameters
    ----------
    grid : OccupancyGrid
    variance : float, optional
        Variance of the bell in squared cells; larger values make paths keep further away. If given, ``nearest`` is False by
        default.
    box : Box, optional
        The cells whose potential is wanted; all by default.
    sigma_m : float, optional
        Standard deviation of the bell in metres, in place of the variance. If given, ``nearest`` is True by default.
    nearest : bool, optional
        Whether the nearest obstacle counts alone.
    cutoff : float, optional
        Potentials below this are 0, in units in which the peak of a bell, on the obstacle, is 1; from 0 to below 1. By default
        1e-6 if the nearest obstacle counts alone, which a bell reaches at 5.3 standard deviations (1.6 m of 0.3 m), else 0.
        The tail beyond says nothing of safety, and would decide between paths that are as safe as one another.

    Returns
    -------
    numpy.ndarray of float, shape (height, width) of the grid or of the box
        Rounded to multiples of 2**-30.

    Raises
    ------
    GridError
        If the grid is none, the box is none of its cells, the variance or the standard deviation is no positive number, or
        both are given, the cutoff is out of its range, or the map is in cells and has no metres.

    References
    ----------
    F. Ahmed and K. Deb, "Multi-objective optimal path planning using elitist non-dominated sorting genetic algorithms",
    Soft Computing 17(7), 2013, section 3.2 (variance of 50 % of the cell size).
    """
    bell = settled_bell(check_grid(grid), variance, sigma_m, nearest, cutoff)
    in_cells = bell.in_cells(grid)
    box = grid.whole if box is None else check_box(box, grid)
    field = _of_nearest(grid, in_cells, box) if bell.nearest else _of_all(grid, in_cells, box)
    if bell.cutoff > 0.0:
        field[field < bell.cutoff] = 0.0
    return np.round(field / QUANTUM) * QUANTUM


def _of_all(grid: OccupancyGrid, variance: float, box: Box) -> np.ndarray:
    """Return the sum of the bells of all occupied cells in a box, from those in reach."""
    # The bell is separable; beyond this reach it is below 2e-17, far under the rounding.
    reach = math.ceil(min(math.sqrt(76.0 * variance), max(grid.shape)))
    with np.errstate(over="ignore"):  # of the narrowest bells, which are 0 beyond their own cell
        kernel = np.exp(-(np.arange(-reach, reach + 1.0) ** 2) / (2.0 * variance))
    part = box.grown(reach, grid.shape)
    field = grid.occupied[part.slices].astype(float)
    for axis in (0, 1):
        field = ndimage.correlate1d(field, kernel, axis=axis, mode="constant")
    return field[box.within(part).slices]


def _of_nearest(grid: OccupancyGrid, variance: float, box: Box) -> np.ndarray:
    """Return the bell of the nearest occupied cell in a box, from those in reach."""
    # Beyond this reach it is less than half of what potentials are rounded to.
    reach = math.ceil(min(math.sqrt(2.0 * math.log(2.0 / QUANTUM) * variance), max(grid.shape)))
    distance = distance_to_occupied(grid, box, reach)
    with np.errstate(over="ignore"):
        return np.exp(-(distance**2) / (2.0 * variance))


def inflation_cost(
    grid: OccupancyGrid, cost_scaling_factor: float = 10.0, inflation_radius: float = 0.55, box: Box | None = None
) -> np.ndarray:
    """Return the cost of being near obstacles by the formula of navigation2's inflation layer.

    ``exp(-cost_scaling_factor * d)`` with d the distance in metres to the nearest occupied cell, centre to centre, and 0 where
    that is more than ``inflation_radius``. Obstacles of a grid that was grown by a robot's radius lie that much nearer: d is
    what navigation2 has for the distance less the inscribed radius. Its costs are 252 times these, whole numbers.

    Parameters
    ----------
    grid : OccupancyGrid
        One that states its resolution.
    cost_scaling_factor : float, default 10.0
        By how much the cost falls, 1 / m; larger values make it steeper.
    inflation_radius : float, default 0.55
        How far obstacles cost anything, in metres.
    box : Box, optional
        The cells whose cost is wanted; all by default.

    Returns
    -------
    numpy.ndarray of float, shape (height, width) of the grid or of the box
        1 in occupied cells; rounded to multiples of 2**-30.

    Raises
    ------
    GridError
        If the grid is none or one in cells, the box is none of its cells, or a number is not positive.

    References
    ----------
    ``InflationLayer::computeCost`` of the package nav2_costmap_2d; its defaults are those of the parameters here.
    """
    resolution = check_grid(grid).check_resolution("an inflation radius in metres")
    factor, radius = check_inflation(cost_scaling_factor, inflation_radius)
    box = grid.whole if box is None else check_box(box, grid)
    reach = math.ceil(grid.radius_in_cells(radius))
    metres = distance_to_occupied(grid, box, reach) * resolution
    with np.errstate(under="ignore", over="ignore", invalid="ignore"):
        cost = np.where(metres <= radius * (1 + _SAME), np.exp(-factor * metres), 0.0)
    return np.round(cost / QUANTUM) * QUANTUM


def distance_to_occupied(grid: OccupancyGrid, box: Box, reach: int) -> np.ndarray:
    """Return the distance in cells to the nearest occupied cell, centre to centre, as far as that is within a reach.

    Returns
    -------
    numpy.ndarray of float, shape (height, width) of the box
        Beyond the reach any larger number, ``inf`` among them.
    """
    part = box.grown(reach, grid.shape)
    occupied = grid.occupied[part.slices]
    if not occupied.any():
        return np.full(box.shape, np.inf)
    return np.asarray(ndimage.distance_transform_edt(~occupied))[box.within(part).slices]


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

    def within(self, box: Box) -> np.ndarray:
        """Return the values in a box, shape (height, width)."""
        return self.inside if box == self.box else np.asarray(self)[box.slices]

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


def check_inflation(cost_scaling_factor: float, inflation_radius: float) -> tuple[float, float]:
    """Return the numbers of an inflation if they are such."""
    return (
        checks.number(
            "cost_scaling_factor", cost_scaling_factor, 0.0, above=True, expected="a positive number", error=GridError
        ),
        checks.number(
            "inflation_radius", inflation_radius, 0.0, above=True, expected="a positive number of metres", error=GridError
        ),
    )


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
    # As most are; of numbers that are none neither is true.
    if costs.min() >= 0.0 and costs.max() < np.inf:
        return costs
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
