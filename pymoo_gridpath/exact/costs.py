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

#: One unit of a cell's cost; potentials are multiples of 1 / FIELD_UNIT.
FIELD_UNIT = 2**30

# No sum along a path may come near 2**61.
_LARGEST_SUM = 2.0**58


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
    """

    step: np.ndarray
    field: np.ndarray
    with_heading: bool
    unit: np.ndarray

    def take(self, order) -> Costs:
        """Return the costs of some objectives, in that order."""
        order = list(order)
        return Costs(self.step[order].copy(), self.field[order].copy(), self.with_heading, self.unit[order])


def integer_costs(objectives, grid: OccupancyGrid) -> Costs:
    """Return objectives as whole numbers.

    Lengths are counted in `LENGTH_UNIT`, turns in 45 degrees, and costs of cells in `FIELD_UNIT` (in coarser units if the sum
    over all cells could otherwise overflow), to which they are rounded.

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
    unit = np.ones(len(objectives))
    for k, objective in enumerate(objectives):
        if type(objective) is Length:
            step[k] = np.where(DIAGONAL, round(SQRT2 * LENGTH_UNIT), LENGTH_UNIT)
            unit[k] = 1 / LENGTH_UNIT
        elif type(objective) is Turn:
            step[k] = turn_units()
            unit[k] = TURN_UNIT
        else:
            field[k], unit[k] = _field(objective, grid)
    return Costs(step, field, any(type(objective) is Turn for objective in objectives), unit)


def _field(objective: Objective, grid: OccupancyGrid) -> tuple[np.ndarray, float]:
    """Return the costs of cells and their unit."""
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
    largest = free.sum()
    per_one = FIELD_UNIT
    while largest * per_one > _LARGEST_SUM:
        per_one /= 2
    return np.rint(free * per_one).astype(np.int64), 1 / per_one
