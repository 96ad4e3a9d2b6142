"""Objectives as whole numbers that add up along a path."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.grid import SQRT2, OccupancyGrid
from pymoo_gridpath.objectives import Length, Objective, Turn
from pymoo_gridpath.paths import TURN_UNIT
from pymoo_gridpath.search import DIAGONAL, turn_units

#: One cell of length. Two lengths s + d * sqrt(2) that differ, with d below 200,000, differ by more than the rounding of d
#: diagonals to this unit, so they compare as they should.
LENGTH_UNIT = 2**36

# No sum along a path may come near 2**61.
_LARGEST_SUM = 2.0**58

# Bits, from the first of the largest cost, that costs may have to be taken as they are; potentials of the package have 33.
_BITS = 44

# Between costs further apart than this, sums would lose the smaller ones.
_WIDEST = 2.0**32


class Costs(NamedTuple):
    """k objectives as costs of steps and of cells.

    Attributes
    ----------
    step : numpy.ndarray of int64, shape (k, 9, 8)
        Cost of a step along heading m (last index) after one along heading h (8: none before).
    field : numpy.ndarray of int64, shape (k, n_cells)
        Cost of entering each cell.
    with_heading : bool
        Whether some cost depends on the heading before a step.
    unit : numpy.ndarray of float, shape (k,)
        What a cost of 1 is in the objective.
    rounded : numpy.ndarray of bool, shape (k,)
        Whether costs had to be rounded to whole numbers.
    """

    step: np.ndarray
    field: np.ndarray
    with_heading: bool
    unit: np.ndarray
    rounded: np.ndarray

    def take(self, order) -> Costs:
        """Return the costs of some objectives, in that order."""
        order = list(order)
        return Costs(
            self.step[order].copy(), self.field[order].copy(), self.with_heading, self.unit[order], self.rounded[order]
        )


def integer_costs(objectives, grid: OccupancyGrid) -> Costs:
    """Return objectives as whole numbers.

    Lengths are counted in 1 / `LENGTH_UNIT` cells and turns in 45 degrees. Costs of cells are counted in a power of two if they
    have no more than 44 bits, as potentials have, else in the one of 0.1, 0.01, ..., 1e-9 of which they are multiples; if there
    is none, they are rounded to a power of two, at most 2**-57 of their sum over all free cells.

    Parameters
    ----------
    objectives : sequence of Objective
    grid : OccupancyGrid

    Raises
    ------
    CapabilityError
        If an objective does not add up along a path: it is neither `Length` nor `Turn` and has no field, or a field that is
        negative or not finite.
    """
    step = np.zeros((len(objectives), 9, 8), dtype=np.int64)
    field = np.zeros((len(objectives), grid.width * grid.height), dtype=np.int64)
    unit, rounded = np.ones(len(objectives)), np.zeros(len(objectives), dtype=bool)
    for k, objective in enumerate(objectives):
        if type(objective) is Length:
            step[k] = np.where(DIAGONAL, round(SQRT2 * LENGTH_UNIT), LENGTH_UNIT)
            unit[k] = 1 / LENGTH_UNIT
        elif type(objective) is Turn:
            step[k] = turn_units()
            unit[k] = TURN_UNIT
        else:
            field[k], unit[k], rounded[k] = _field(objective, grid)
    return Costs(step, field, any(type(objective) is Turn for objective in objectives), unit, rounded)


def _field(objective: Objective, grid: OccupancyGrid) -> tuple[np.ndarray, float, bool]:
    """Return the costs of cells, their unit, and whether they had to be rounded."""
    values = objective.field(grid)
    if values is None:
        raise CapabilityError(
            f"the objective {objective.name!r} has no field, so it does not add up along a path and no exact front is known; "
            f"expected length, turn, or objectives that are sums of a field over the visited cells"
        )
    free = np.where(grid.occupied, 0.0, values).ravel()
    if not np.isfinite(free).all() or free.min() < 0:
        raise CapabilityError(
            f"the field of the objective {objective.name!r} has negative or infinite values in free cells, expected costs of "
            f"zero or more for an exact front"
        )
    unit, rounded = _unit(free)
    if unit is None:
        raise CapabilityError(
            f"the field of the objective {objective.name!r} has values from {free[free > 0].min():g} to {free.max():g}, too "
            f"far apart to be added up exactly; mark the dearest cells as occupied instead"
        )
    return np.rint(free / unit).astype(np.int64), unit, rounded


def _unit(values: np.ndarray) -> tuple[float | None, bool]:
    """Return the unit in which values are counted, and whether they are rounded to it.

    The unit is None if the sum of the values overflows or the smaller half of them would be lost in it.
    """
    with np.errstate(over="ignore"):
        total = values.sum()
    if total == 0.0:
        return 1.0, False
    if not np.isfinite(total):
        return None, True
    finest = max(2.0 ** np.ceil(np.log2(total) - np.log2(_LARGEST_SUM)), np.finfo(float).tiny)
    # Numbers that need more bits than these are taken for results of a calculation, with its noise in their last bits.
    short = max(finest, 2.0 ** (np.ceil(np.log2(values.max())) - _BITS))
    if (np.rint(values / short) * short == values).all():
        return float(short), False
    for per_one in (10**k for k in range(1, 10)):
        if total * per_one <= _LARGEST_SUM and (np.rint(values * per_one) / per_one == values).all():
            return 1 / per_one, False
    return None if values.max() > _WIDEST * np.median(values[values > 0]) else float(finest), True
