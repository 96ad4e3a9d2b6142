"""Objectives as whole numbers that add up along a path."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.grid import SQRT2, OccupancyGrid
from pymoo_gridpath.neighbourhood import DIAGONAL, HEADING_OF, HEADINGS, turn_units
from pymoo_gridpath.objectives import Objective, field_of, moves_of
from pymoo_gridpath.search import Moves

#: One cell of length. Two lengths s + d * sqrt(2) that differ, with d below 200,000, differ by more than the rounding of d
#: diagonals to this unit, so they compare as they should.
LENGTH_UNIT = 2**36

# The cost of a step along each heading, of objectives that are multiples of the length.
OCTILE = np.where(DIAGONAL, round(SQRT2 * LENGTH_UNIT), LENGTH_UNIT)

# No sum along a path may come near 2**61.
_LARGEST_SUM = 2.0**58

# Parts of 1 in which decimal costs are counted at most.
_FINEST_DECIMAL = 10**9

# Bits, from the first of the largest cost, that costs may have to be taken as they are; potentials of the package have 33.
_BITS = 44

#: What `turn_units` returns, worked out once.
TURN_UNITS = turn_units()

# No step turns by more than so many times 45 degrees.
_MOST_TURNS = 4


def _direct_headings() -> np.ndarray:
    known = {(int(dx), int(dy)): m for m, (dx, dy) in enumerate(HEADINGS)}
    known[0, 0] = 8
    sums = HEADINGS[:, None] + HEADINGS[None, :]
    return np.array([[known.get((int(dx), int(dy)), -1) for dx, dy in row] for row in sums], dtype=np.int64)


#: The heading of the one step that does what two do; 8 where the second step leads back, -1 where no single step does.
DIRECT = _direct_headings()


@dataclass(frozen=True, eq=False)
class Costs:
    """k objectives as costs of steps and of cells.

    Attributes
    ----------
    step : numpy.ndarray of int64, shape (k, 9, 8)
        Cost of a step along heading m (last index) after one along heading h (8: none before).
    field : numpy.ndarray of int64, shape (k, n_cells)
        Cost of entering each cell.
    unit : numpy.ndarray of float, shape (k,)
        What a cost of 1 is in the objective.
    off : numpy.ndarray of int64, shape (k,)
        By how many units the cost of a step may be off where costs had to be rounded to whole numbers; 0 where they were not.
    enter : numpy.ndarray of int64, shape (k, n_cells, 8), or None
        What entering each cell along each heading costs besides; None where that costs nothing in any of them.
    """

    step: np.ndarray
    field: np.ndarray
    unit: np.ndarray
    off: np.ndarray
    enter: np.ndarray | None

    @functools.cached_property
    def with_heading(self) -> bool:
        """Whether some cost depends on the heading before a step."""
        return bool((self.step[:, :8] != self.step[:, :1]).any())

    @property
    def turns(self) -> np.ndarray:
        """Whether each cost depends on the heading before a step, bool, shape (k,)."""
        return (self.step[:, :8] != self.step[:, :1]).any(axis=(1, 2))

    @functools.cached_property
    def on_the_spot(self) -> np.ndarray:
        """What turning from one heading to another costs, int64, shape (k, 8, 8)."""
        return self.step[:, :8] - self.step[:, 8:]

    @property
    def rounded(self) -> np.ndarray:
        """Whether costs had to be rounded to whole numbers, bool, shape (k,)."""
        return self.off > 0

    @functools.cached_property
    def direct(self) -> np.ndarray:
        """`DIRECT` with -1 where one step may cost more than the two, int64, shape (8, 8).

        A cost of cells is no more on the direct way, which leaves one out, and neither is turning. Costs of moves are what they
        are.
        """
        if self.enter is not None:
            return np.where(DIRECT == 8, 8, -1)
        one = self.step[:, 8, DIRECT % 8]
        two = self.step[:, 8, :, None] + self.step[:, 8, None, :]
        return np.where((DIRECT == 8) | (one <= two).all(axis=0), DIRECT, -1)

    @property
    def tells_steps(self) -> bool:
        """Whether paths of the same costs take the same number of steps: those that are of the same length do."""
        lengths = (self.step == OCTILE).all(axis=(1, 2)) & ~self.field.any(axis=1)
        return bool((lengths if self.enter is None else lengths & ~self.enter.any(axis=(1, 2))).any())

    @property
    def order(self) -> list[int]:
        """The order in which searches are quickest: what costs of cells play no part in comes first, and turns come last."""
        varied = self.field.any(axis=1) | (False if self.enter is None else self.enter.any(axis=(1, 2)))
        moves_alone = ~varied & self.step.any(axis=(1, 2))
        return np.argsort(np.where(self.turns, 2, np.where(moves_alone, 0, 1)), kind="stable").tolist()

    @property
    def nbytes(self) -> int:
        """Bytes of the arrays whose size is that of the grid."""
        return self.field.nbytes + (0 if self.enter is None else self.enter.nbytes)

    def take(self, order) -> Costs:
        """Return the costs of some objectives, in that order."""
        order = list(order)
        enter = None if self.enter is None else self.enter.take(order, axis=0)
        enter = enter if enter is not None and enter.any() else None
        return Costs(self.step.take(order, axis=0), self.field.take(order, axis=0), self.unit[order], self.off[order], enter)

    def within(self, moves: Moves, part: Moves) -> Costs:
        """Return the costs of the cells in a part of the box that ``moves`` are of."""
        enter = None if self.enter is None else moves.part_of(self.enter, part).reshape(len(self.enter), -1, 8)
        return Costs(self.step, moves.part_of(self.field, part), self.unit, self.off, enter)

    def of_path(self, path: np.ndarray, moves: Moves) -> np.ndarray:
        """Return the costs of a path, int64, shape (k,), without that of the start cell."""
        dx, dy = np.diff(moves.cells(path), axis=0).T
        heading = HEADING_OF[dy + 1, dx + 1]
        before = np.concatenate([[8], heading[:-1]])
        total = self.step[:, before, heading].sum(axis=1) + self.field[:, path[1:]].sum(axis=1)
        return total if self.enter is None else total + self.enter[:, path[1:], heading].sum(axis=1)

    def values(self, points: np.ndarray) -> np.ndarray:
        """Return points, shape (N, k), in the units of the objectives: the same for equal sums in whatever unit."""
        # The nearest number to a product with 0.1 is not always the nearest to a tenth; with a power of two it is.
        with np.errstate(over="ignore", divide="ignore"):
            per_one = np.rint(1 / self.unit)
            decimal = (per_one > 1) & (per_one <= _FINEST_DECIMAL) & (1 / per_one == self.unit)
        return np.where(decimal, points / np.where(decimal, per_one, 1.0), points * self.unit)


def integer_costs(objectives, grid: OccupancyGrid, moves: Moves | None = None, usable: np.ndarray | None = None) -> Costs:
    """Return objectives as whole numbers.

    Lengths are counted in 1 / `LENGTH_UNIT` cells and turns in 45 degrees. Other costs are counted in a power of two if they
    have no more than 44 bits, as potentials have, else in the one of 0.1, 0.01, ..., 1e-9 of which they are multiples; if there
    is none, they are rounded to a power of two, at most 2**-57 of their sum over all usable cells. In that sum each cell counts
    with the dearest way of entering it.

    Parameters
    ----------
    objectives : sequence of Objective
    grid : OccupancyGrid
    moves : Moves, optional
        The steps that paths may take, by default all that are legal; the others cost nothing.
    usable : numpy.ndarray of bool, shape (n_cells,), optional
        The cells that paths may visit, by default all that are free; the others cost nothing.

    Raises
    ------
    CapabilityError
        If an objective does not add up along a path, or the sum of its costs over all usable cells is not finite.
    GridPathError
        If costs are none, see `pymoo_gridpath.objectives.field_of` and `moves_of`.
    """
    moves = Moves(grid) if moves is None else moves
    usable = ~grid.occupied[moves.box.slices].ravel() if usable is None else usable
    found = [_costs(objective, grid, moves, usable) for objective in objectives]
    enter = None
    if any(one.enter is not None for one in found):
        nothing = np.zeros((moves.n_cells, 8), dtype=np.int64)
        enter = np.stack([nothing if one.enter is None else one.enter for one in found])
    step, field = (np.stack([getattr(one, name) for one in found]) for name in ("step", "field"))
    return Costs(step, field, np.array([one.unit for one in found], dtype=float), np.array([one.off for one in found]), enter)


class _One(NamedTuple):
    """The costs of a single objective, see `Costs`."""

    step: np.ndarray
    field: np.ndarray
    unit: float
    off: int = 0
    enter: np.ndarray | None = None


def check_adds_up(objective: Objective) -> None:
    """Raise a CapabilityError unless an objective is a sum of costs along a path, to be minimised."""
    name = objective.name
    if objective.combine != "sum":
        raise CapabilityError(
            f"the objective {name!r} is the {objective.combine} of costs along a path, to be "
            f"{'maximised' if objective.maximise else 'minimised'}, and no exact front is known of it; expected objectives "
            f"that add up, or by which the worst cell of a path decides"
        )
    if objective.maximise:
        raise CapabilityError(
            f"the objective {name!r} is a sum along a path that is to be maximised, and no exact front is known of it; "
            f"expected sums to be minimised"
        )
    if not objective.additive:
        raise _names_none(objective)


def _names_none(objective: Objective) -> CapabilityError:
    return CapabilityError(
        f"the objective {objective.name!r} has no field, costs of moves or turn_cost, so it does not add up along a path and "
        f"no exact front is known; expected length, turn, or objectives that are sums of such costs"
    )


def _costs(objective: Objective, grid: OccupancyGrid, moves: Moves, usable: np.ndarray) -> _One:
    check_adds_up(objective)
    name, turn = objective.name, objective.turn_cost
    cells, steps = field_of(objective, grid, moves.box), moves_of(objective, grid)
    if cells is None and steps is None and not turn:
        raise _names_none(objective)
    pair = np.array(steps if isinstance(steps, tuple) else (0.0, 0.0))
    nothing = np.zeros(moves.n_cells, dtype=np.int64)
    if cells is None and not isinstance(steps, np.ndarray):
        if not turn and pair[0] > 0.0 and pair[1] == SQRT2 * pair[0]:
            return _One(np.tile(OCTILE, (9, 1)), nothing, float(pair[0]) / LENGTH_UNIT)
        if turn and not pair.any():
            return _One(TURN_UNITS, nothing, turn)
    free = nothing if cells is None else np.where(usable, np.ravel(cells), 0.0)
    entries = np.empty((8, 0))
    if isinstance(steps, np.ndarray):
        entries = np.where(moves.entered, steps[(slice(None), *moves.box.slices)].reshape(8, -1), 0.0)
    with np.errstate(over="ignore"):
        each = pair.max() + _MOST_TURNS * turn
        total = free.sum() + entries.max(axis=0).sum() + np.count_nonzero(usable) * each
    values = np.concatenate([free, entries.ravel(), pair, [turn]])
    if not np.isfinite(total):
        raise CapabilityError(
            f"the {'costs' if steps is not None or turn else 'field'} of the objective {name!r} "
            f"{'have' if steps is not None or turn else 'has'} values up to {values.max():g}, whose sum over the free cells "
            f"is more than a floating point number can hold; expected smaller ones for an exact front"
        )
    unit, rounded = _unit(values, total)
    straight, diagonal, turning = (round(float(value) / unit) for value in (*pair, turn))
    return _One(
        np.where(DIAGONAL, diagonal, straight) + turning * TURN_UNITS,
        np.rint(free / unit).astype(np.int64),
        unit,
        # Half a unit for the cell, half a one for the move, and half a one for each 45 degrees of turning.
        int(rounded) * (1 + (_MOST_TURNS // 2 if turn else 0)),
        np.ascontiguousarray(np.rint(entries / unit).astype(np.int64).T) if entries.size else None,
    )


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
