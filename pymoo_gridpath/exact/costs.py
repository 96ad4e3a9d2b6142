"""Objectives as whole numbers that add up along a path."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.grid import SQRT2, Box, OccupancyGrid
from pymoo_gridpath.neighbourhood import DIAGONAL, turn_units
from pymoo_gridpath.objectives import Length, Objective, Turn, field_of
from pymoo_gridpath.paths import TURN_UNIT

#: One cell of length. Two lengths s + d * sqrt(2) that differ, with d below 200,000, differ by more than the rounding of d
#: diagonals to this unit, so they compare as they should.
LENGTH_UNIT = 2**36

# No sum along a path may come near 2**61.
_LARGEST_SUM = 2.0**58

# Parts of 1 in which decimal costs are counted at most.
_FINEST_DECIMAL = 10**9

# Bits, from the first of the largest cost, that costs may have to be taken as they are; potentials of the package have 33.
_BITS = 44


class Costs(NamedTuple):
    """k objectives as costs of steps and of cells.

    Attributes
    ----------
    step : numpy.ndarray of int64, shape (k, 9, 8)
        Cost of a step along heading m (last index) after one along heading h (8: none before).
    field : numpy.ndarray of int64, shape (k, n_cells)
        Cost of entering each cell.
    unit : numpy.ndarray of float, shape (k,)
        What a cost of 1 is in the objective.
    rounded : numpy.ndarray of bool, shape (k,)
        Whether costs had to be rounded to whole numbers.
    """

    step: np.ndarray
    field: np.ndarray
    unit: np.ndarray
    rounded: np.ndarray

    @property
    def with_heading(self) -> bool:
        """Whether some cost depends on the heading before a step."""
        return bool((self.step[:, :8] != self.step[:, :1]).any())

    def take(self, order) -> Costs:
        """Return the costs of some objectives, in that order."""
        order = list(order)
        return Costs(self.step[order].copy(), self.field[order].copy(), self.unit[order], self.rounded[order])

    def values(self, points: np.ndarray) -> np.ndarray:
        """Return points, shape (N, k), in the units of the objectives: the same for equal sums in whatever unit."""
        # The nearest number to a product with 0.1 is not always the nearest to a tenth; with a power of two it is.
        with np.errstate(over="ignore"):
            per_one = np.rint(1 / self.unit)
        decimal = (per_one > 1) & (per_one <= _FINEST_DECIMAL)
        return np.where(decimal, points / np.where(decimal, per_one, 1.0), points * self.unit)


def integer_costs(objectives, grid: OccupancyGrid, usable: np.ndarray | None = None, box: Box | None = None) -> Costs:
    """Return objectives as whole numbers.

    Lengths are counted in 1 / `LENGTH_UNIT` cells and turns in 45 degrees. Costs of cells are counted in a power of two if they
    have no more than 44 bits, as potentials have, else in the one of 0.1, 0.01, ..., 1e-9 of which they are multiples; if there
    is none, they are rounded to a power of two, at most 2**-57 of their sum over all usable cells.

    Parameters
    ----------
    objectives : sequence of Objective
    grid : OccupancyGrid
    usable : numpy.ndarray of bool, shape (n_cells,), optional
        The cells that paths may visit, by default all that are free; the others cost nothing.
    box : Box, optional
        The cells that are counted, as in `Moves`; by default all of the grid.

    Raises
    ------
    CapabilityError
        If an objective does not add up along a path, since it is neither `Length` nor `Turn` and has no field; or if the sum of
        a field over all usable cells is not finite.
    GridPathError
        If a field is no field of costs, see `pymoo_gridpath.objectives.field_of`.
    """
    box = grid.whole if box is None else box
    usable = ~grid.occupied[box.slices].ravel() if usable is None else usable
    step = np.zeros((len(objectives), 9, 8), dtype=np.int64)
    field = np.zeros((len(objectives), len(usable)), dtype=np.int64)
    unit, rounded = np.ones(len(objectives)), np.zeros(len(objectives), dtype=bool)
    for k, objective in enumerate(objectives):
        if type(objective) is Length:
            step[k] = np.where(DIAGONAL, round(SQRT2 * LENGTH_UNIT), LENGTH_UNIT)
            unit[k] = 1 / LENGTH_UNIT
        elif type(objective) is Turn:
            step[k] = turn_units()
            unit[k] = TURN_UNIT
        else:
            field[k], unit[k], rounded[k] = _field(objective, grid, usable, box)
    return Costs(step, field, unit, rounded)


def _field(objective: Objective, grid: OccupancyGrid, usable: np.ndarray, box: Box) -> tuple[np.ndarray, float, bool]:
    """Return the costs of cells, their unit, and whether they had to be rounded."""
    values = field_of(objective, grid, box)
    if values is None:
        raise CapabilityError(
            f"the objective {objective.name!r} has no field, so it does not add up along a path and no exact front is known; "
            f"expected length, turn, or objectives that are sums of a field over the visited cells"
        )
    free = np.where(usable, np.ravel(values), 0.0)
    with np.errstate(over="ignore"):
        total = free.sum()
    if not np.isfinite(total):
        raise CapabilityError(
            f"the field of the objective {objective.name!r} has values up to {free.max():g}, whose sum over the free cells "
            f"is more than a floating point number can hold; expected smaller ones for an exact front"
        )
    unit, rounded = _unit(free, total)
    return np.rint(free / unit).astype(np.int64), unit, rounded


def _unit(values: np.ndarray, total: float) -> tuple[float, bool]:
    """Return the unit in which values with a sum are counted, and whether they are rounded to it."""
    if total == 0.0:
        return 1.0, False
    finest = max(2.0 ** np.ceil(np.log2(total) - np.log2(_LARGEST_SUM)), np.finfo(float).smallest_subnormal)
    # Numbers that need more bits than these are taken for results of a calculation, with its noise in their last bits.
    short = max(finest, 2.0 ** (np.ceil(np.log2(values.max())) - _BITS))
    if (np.rint(values / short) * short == values).all():
        return float(short), False
    for per_one in (10**k for k in range(1, 10)):
        if total * per_one <= _LARGEST_SUM and (np.rint(values * per_one) / per_one == values).all():
            return 1 / per_one, False
    return float(finest), True
