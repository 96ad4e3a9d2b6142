"""What the ground costs: how hard each cell is to cross, and how much a path climbs."""

from __future__ import annotations

import os

import numpy as np
from numpy.typing import ArrayLike

from pymoo_gridpath import checks
from pymoo_gridpath.checks import shown
from pymoo_gridpath.errors import GridError, GridPathError
from pymoo_gridpath.fields import check_costs, check_field
from pymoo_gridpath.grid import check_grid
from pymoo_gridpath.maps import read_raster
from pymoo_gridpath.neighbourhood import HEADINGS, LENGTHS
from pymoo_gridpath.objectives.base import OBJECTIVES, Objective

#: What the cost of a cell is multiplied by: the distance that a path walks in it, or nothing, once for each visit.
PER = ("distance", "entry")


class _OfRaster(Objective):
    """An objective that is made of a number for each cell."""

    def __repr__(self) -> str:
        settings = {key: value for key, value in vars(self).items() if not isinstance(value, np.ndarray) and key != "label"}
        return f"{type(self).__name__}({', '.join(f'{key}={value!r}' for key, value in settings.items())})"


@OBJECTIVES.register
class GroundCost(_OfRaster):
    """What the ground costs that a path leads over, such as mud, grass, or the price of a toll.

    Parameters
    ----------
    cost : array_like of shape (height, width), str or path-like
        Of each cell, row 0 at the bottom, zero or more; or the file of a raster, see `pymoo_gridpath.maps.read_raster`. Where
        there is no data, NaN, paths may not go: such a cell has to be occupied.
    weight : float, default 1.0
        What all costs are multiplied by.
    per : {"distance", "entry"}, default "distance"
        With "distance" a cost is that of walking the width of a cell, and a step, which lies half in the cell that it leaves
        and half in the one that it enters, costs the mean of both times its length. With "entry" a cell costs what it does
        each time that it is visited, start included, whether straight or diagonally.
    name : str, default "ground"
        What tables and files call it; several in a problem need names of their own.
    label : str, optional
        What figures call it.

    Raises
    ------
    GridPathError
        If an argument is of another kind or out of its range; once the grid is known, if the costs are of another shape,
        negative, or not finite in a free cell.
    MapError
        If the file cannot be read.

    Attributes
    ----------
    cost : numpy.ndarray of float, shape (height, width)

    Notes
    -----
    The mean of both ends times the distance is what ``MCP_Geometric`` of scikit-image adds up, too, and most tools that work
    out cost distances from rasters.

    Examples
    --------
    >>> from pymoo_gridpath import GridPathProblem, OccupancyGrid
    >>> mud = np.ones((4, 6))
    >>> mud[:3, 2:4] = 5.0
    >>> problem = GridPathProblem(OccupancyGrid(np.zeros((4, 6))), (0, 0), (5, 0), "cells", ["length", GroundCost(mud)])
    >>> problem.pareto_front().round(2).tolist()
    [[5.0, 13.0], [8.66, 8.66]]
    """

    name = "ground"
    label = "Cost of the ground"
    best = "cheapest"
    files = ("cost",)

    def __init__(
        self,
        cost: ArrayLike | str | os.PathLike[str],
        weight: float = 1.0,
        per: str = "distance",
        name: str = "ground",
        label: str | None = None,
    ):
        self.cost = _raster("cost", cost)
        self.weight = checks.number("weight", weight, 0.0, expected="a number, zero or more")
        self.per = checks.one_of("per", per, PER)
        self.name, self.label = _names(name, label, self.label)

    def field(self, grid):
        costs = self._costs(check_grid(grid))
        return costs if self.per == "entry" else None

    def moves(self, grid):
        costs = self._costs(check_grid(grid))
        if self.per == "entry":
            return None
        return np.stack([(costs + left_values(costs, dx, dy)) / 2.0 * LENGTHS[m] for m, (dx, dy) in enumerate(HEADINGS)])

    def _costs(self, grid) -> np.ndarray:
        """Return what each cell costs, once it is known to be a cost; 0 in occupied cells without data."""
        return self.weight * check_costs(f"the cost of the objective {shown(self.name)}", self.cost, grid)


@OBJECTIVES.register
class Climb(_OfRaster):
    """How much a path rises in all, up being dear and down free.

    Parameters
    ----------
    elevation : array_like of shape (height, width), str or path-like
        Height of each cell in metres, row 0 at the bottom; or the file of a raster, see `pymoo_gridpath.maps.read_raster`.
        Where there is no data, NaN, paths may not go: such a cell has to be occupied.
    name : str, default "climb"
    label : str, optional
        What figures call it.

    Raises
    ------
    GridPathError
        If an argument is of another kind; once the grid is known, if the heights are of another shape, or not finite in a free
        cell.
    MapError
        If the file cannot be read.

    Attributes
    ----------
    elevation : numpy.ndarray of float, shape (height, width)

    References
    ----------
    The ascent of J. Weise and S. Mostaghim, "Scalable many-objective pathfinding benchmark suite", arXiv 2010.04501, 2020.

    Examples
    --------
    >>> from pymoo_gridpath import GridPathProblem, OccupancyGrid
    >>> hill = np.zeros((3, 5))
    >>> hill[:2, 1:4] = [[1, 3, 1], [1, 2, 1]]
    >>> problem = GridPathProblem(OccupancyGrid(np.zeros((3, 5))), (0, 0), (4, 0), "cells", ["length", Climb(hill)])
    >>> problem.pareto_front().round(2).tolist()
    [[4.0, 3.0], [4.83, 2.0], [6.24, 1.0], [6.83, 0.0]]
    """

    name = "climb"
    label = "Climb [m]"
    best = "flattest"
    files = ("elevation",)

    def __init__(self, elevation: ArrayLike | str | os.PathLike[str], name: str = "climb", label: str | None = None):
        self.elevation = _raster("elevation", elevation)
        self.name, self.label = _names(name, label, self.label)

    def moves(self, grid):
        what = f"the elevation of the objective {shown(self.name)}"
        heights = check_field(what, self.elevation, check_grid(grid))
        wrong = ~np.isfinite(heights) & ~grid.occupied
        if wrong.any():
            y, x = np.argwhere(wrong)[0]
            raise GridError(
                f"{what} is {heights[y, x]:g} in the free cell ({x}, {y}), expected a finite number; mark cells that no path "
                f"may enter as occupied"
            )
        return climbed(heights)


def _raster(what: str, given) -> np.ndarray:
    """Return the numbers of cells that are given or read from a file."""
    if isinstance(given, str | os.PathLike):
        return read_raster(given)
    expected = "numbers of shape (height, width), or the name of a file"
    found = checks.array(what, given, (None, None), expected=expected).astype(float)
    if not found.size:
        raise GridPathError(f"{what} is {shown(given)}, expected {expected}")
    return found


def _names(name: str, label: str | None, default: str) -> tuple[str, str]:
    name = checks.text("name", name)
    return name, default if label is None else checks.text("label", label)


def climbed(heights: np.ndarray) -> np.ndarray:
    """Return what each step rises, shape (8, height, width); NaN where it would come from beyond the edge."""
    with np.errstate(invalid="ignore"):
        return np.stack([np.maximum(heights - left_values(heights, dx, dy), 0.0) for dx, dy in HEADINGS])


def left_values(values: np.ndarray, dx: int, dy: int) -> np.ndarray:
    """Return for each cell the value of the one that a step (dx, dy) to it leaves; NaN where that is beyond the edge."""
    height, width = values.shape
    left = np.full(values.shape, np.nan)
    to = slice(max(dy, 0), height + min(dy, 0)), slice(max(dx, 0), width + min(dx, 0))
    come = slice(max(-dy, 0), height + min(-dy, 0)), slice(max(-dx, 0), width + min(-dx, 0))
    left[to] = values[come]
    return left
