"""How near to obstacles a path leads: in metres of a robot's map, in cells of the paper's, by the formula of navigation2."""

from __future__ import annotations

import copy
from abc import abstractmethod
from typing import Any

import numpy as np

from pymoo_gridpath.fields import (
    Bell,
    check_inflation,
    given_bell,
    inflation_cost,
    obstacle_potential,
    settled_bell,
)
from pymoo_gridpath.grid import Box, OccupancyGrid
from pymoo_gridpath.objectives.base import OBJECTIVES, Objective


class Risk(Objective):
    """How near to obstacles a path leads: the sum of a potential, of the obstacles in reach, over the visited cells.

    The safest of the paths of a problem is the one of which its risk is least.

    Attributes
    ----------
    wider : str
        How one of a wider reach is had, in words, for those who find nothing to choose from.
    """

    wider: str = ""

    @abstractmethod
    def potential(self, grid: OccupancyGrid, box: Box | None = None) -> np.ndarray:
        """Return the potential of the obstacles of a map, or the part in a box, shape (height, width) of the map or the box."""

    def field(self, grid):
        return self.potential(grid)

    @property
    def local(self) -> bool:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Whether the field is the potential: a class made from this one may have another."""
        return type(self).field is Risk.field

    def field_in(self, grid, box):
        """Return the potential in a box, from the obstacles in reach."""
        return self.potential(grid, box) if self.local else super().field_in(grid, box)


@OBJECTIVES.register
class Vulnerability(Risk):
    """Sum of the obstacles' potential over the visited cells, start and goal included.

    What is not given the map decides, see `pymoo_gridpath.fields.obstacle_potential`: on one that states its resolution the
    nearest obstacle counts alone, with a standard deviation of 0.3 m; on a map in cells it is the paper's sum of bells, which
    ``Vulnerability(variance=0.5)`` is on all maps.

    Parameters
    ----------
    variance : float, optional
        Variance of the bell-shaped potential in squared cells, see `pymoo_gridpath.fields.obstacle_potential`.
    sigma_m : float, optional
        Its standard deviation in metres, in place of the variance.
    nearest : bool, optional
        Whether the nearest obstacle counts alone; by default unless the variance is given, or the map is in cells.
    cutoff : float, optional
        Potentials below this are 0; the peak of a bell is 1. By default 1e-6 where the nearest obstacle counts alone, else 0.

    Raises
    ------
    GridError
        If the variance or standard deviation is no positive number or both are given, or the cutoff is not from 0 to below 1.

    References
    ----------
    Ahmed and Deb (2013), section 3.2.

    Examples
    --------
    >>> grid = OccupancyGrid([[0, 0, 0], [0, 1, 0]], resolution=0.05)
    >>> Vulnerability().on(grid)
    Vulnerability(sigma_m=0.3, nearest=True, cutoff=1e-06)
    >>> Vulnerability().on(grid.replace(resolution=None))
    Vulnerability(variance=0.5, nearest=False, cutoff=0.0)
    """

    name = "vulnerability"
    label = "Path vulnerability"
    best = "safest"

    # Attributes of an object are those that are given, or decided by a map.
    variance: float | None = None
    sigma_m: float | None = None
    nearest: bool | None = None
    cutoff: float | None = None

    def __init__(
        self,
        variance: float | None = None,
        sigma_m: float | None = None,
        nearest: bool | None = None,
        cutoff: float | None = None,
    ):
        vars(self).update(given_bell(variance, sigma_m, nearest, cutoff))

    @property
    def _bell(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in Bell._fields}

    def on(self, grid):
        """Return the objective with the bell written out that it has on a map."""
        settled = settled_bell(grid, **self._bell)._asdict()
        if settled == self._bell:
            return self
        made = copy.copy(self)
        vars(made).update({name: value for name, value in settled.items() if value is not None})
        return made

    @property
    def wider(self) -> str:  # pyright: ignore[reportIncompatibleVariableOverride]
        """How a wider one is had."""
        if self.sigma_m is not None:
            return f"a wider risk, such as sigma_m={2 * self.sigma_m:g} (--sigma-m {2 * self.sigma_m:g})"
        return "" if self.variance is None else f"a wider risk, such as variance={4 * self.variance:g}"

    def potential(self, grid, box=None):
        """Return the potential of the obstacles of a map, or the part in a box."""
        return obstacle_potential(grid, box=box, **self._bell)


@OBJECTIVES.register
class Inflation(Risk):
    """Sum over the visited cells of the cost of being near obstacles by the formula of navigation2's inflation layer.

    For comparison with what a controller of navigation2 would prefer; the map has to state its resolution. With the defaults it
    sees half a metre and is steep, so that fronts have few paths.

    Parameters
    ----------
    cost_scaling_factor : float, default 10.0
        By how much the cost falls, 1 / m, see `pymoo_gridpath.fields.inflation_cost`.
    inflation_radius : float, default 0.55
        How far obstacles cost anything, in metres.

    Raises
    ------
    GridError
        If a number is not positive.
    """

    name = "inflation"
    label = "Inflation cost"
    wider = "a smaller cost_scaling_factor and a larger inflation_radius"

    def __init__(self, cost_scaling_factor: float = 10.0, inflation_radius: float = 0.55):
        self.cost_scaling_factor, self.inflation_radius = check_inflation(cost_scaling_factor, inflation_radius)

    def potential(self, grid, box=None):
        """Return the costs of a map, or those in a box."""
        return inflation_cost(grid, self.cost_scaling_factor, self.inflation_radius, box)
