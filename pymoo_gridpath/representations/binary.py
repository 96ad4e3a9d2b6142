"""The binary coding: two bits for the direction and the distance in binary."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.paths import ColumnPaths
from pymoo_gridpath.paths.frame import Axis
from pymoo_gridpath.representations.monotone import MonotoneRepresentation


class BinaryRepresentation(MonotoneRepresentation):
    """Each move is two bits for the way into the next column and ceil(log2 n_rows) bits for the climb there.

    The direction bits: 11 diagonally up, then y up; 00 diagonally down, then y down; 10 horizontally, then y up; 01
    horizontally, then y down. The row of bits begins with the y of the climb in the start column, goes on with
    direction and y of each step, and ends with the direction bits of the step into the last column, where the path
    goes straight to the goal.

    The climb in the start column is upwards, as in the paper. Where the start is not in the bottom row, values that
    would pass the top edge count on from the bottom row, so that every row has a code; values of n_rows and more leave
    the grid. A step into the last column that would leave the grid is horizontal. Directions are taken as coded: where
    the grid forbids to cut corners, a diagonal that does so makes the path illegal. On a grid without diagonal steps all are
    horizontal, and the climb is what leads to the same row.

    See `MonotoneRepresentation` for the parameters.

    References
    ----------
    Ahmed and Deb (2013), section 2.1.
    """

    name = "binary"
    vtype = bool

    def __init__(self, grid: OccupancyGrid, start: Sequence[int], goal: Sequence[int], axis: Axis = "auto"):
        super().__init__(grid, start, goal, axis)
        self.n_bits = math.ceil(math.log2(self.frame.n_rows))
        self.n_var = self._n_moves * (2 + self.n_bits)
        self.xl = np.zeros(self.n_var, dtype=int)
        self.xu = np.ones(self.n_var, dtype=int)
        self._powers = 1 << np.arange(self.n_bits)[::-1]

    def _split(self, X: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return start climb (N,), directions as 0 to 3 (N, n_columns - 1) and climbs (N, n_columns - 2)."""
        X = self.genes(X)
        start = X[:, : self.n_bits] @ self._powers
        # The last gene has no climb; the start climb stands in for it to make the array rectangular.
        genes = np.concatenate([X[:, self.n_bits :], X[:, : self.n_bits]], axis=1).reshape(
            len(X), self._n_moves, 2 + self.n_bits
        )
        direction = 2 * genes[:, :, 0] + genes[:, :, 1]
        return start, direction, (genes[:, :, 2:] @ self._powers)[:, :-1]

    def _join(self, start: np.ndarray, direction: np.ndarray, climb: np.ndarray) -> np.ndarray:
        """Return the bits of what `_split` returns."""

        def bits(values):
            return (values[..., None] & self._powers) > 0

        genes = np.concatenate([(direction[:, :, None] & np.array([2, 1])) > 0, bits(np.column_stack([climb, start]))], axis=2)
        row = genes.reshape(len(genes), self.n_var)
        return np.concatenate([row[:, self.n_var - self.n_bits :], row[:, : self.n_var - self.n_bits]], axis=1)

    def row_moves(self, X: np.ndarray) -> np.ndarray:
        start, direction, climb = self._split(X)
        n_rows, start_row = self.frame.n_rows, self.frame.start_row
        wrapped = (start_row + start >= n_rows) & (start < n_rows)
        moves = np.empty((len(direction), self._n_moves), dtype=np.int64)
        moves[:, 0] = start - n_rows * wrapped
        moves[:, 1:] = _step(direction[:, :-1]) + np.where(direction[:, :-1] >= 2, climb, -climb)
        return moves

    def decode(self, X: np.ndarray) -> ColumnPaths:
        frame = self.frame
        direction = self._split(X)[1]
        leave = np.empty((len(direction), frame.n_columns), dtype=np.int32)
        leave[:, :-1] = self.exit_rows(X)
        leave[:, -1] = frame.goal_row
        step = _step(direction)
        target = leave[:, :-1] + step
        step[(target < 0) | (target >= frame.n_rows)] = 0
        if not frame.grid.neighbourhood.diagonal:
            step[:] = 0
        enter = np.empty_like(leave)
        enter[:, 0] = frame.start_row
        np.add(leave[:, :-1], step, out=enter[:, 1:])
        return ColumnPaths._unchecked(frame, enter, leave)

    def encode(self, paths: ColumnPaths) -> np.ndarray:
        """Return the bits of paths, bool, shape (N, n_var).

        The inverse of `decode` but for two redundancies: a horizontal step without a climb is 10, never 01, and a path
        that climbs back after a diagonal step, which the coding leaves out as dominated, gets the bits of the horizontal step.
        """
        frame, paths = self.frame, self._own(paths)
        start = (paths.leave[:, 0] - frame.start_row) % frame.n_rows
        step = paths.enter[:, 1:] - paths.leave[:, :-1]
        gain = np.diff(paths.leave[:, :-1], axis=1)
        direction, climb = _direction(step[:, :-1], gain)
        last = np.choose(step[:, -1:] + 1, [0, 2, 3])
        return self._join(start, np.concatenate([direction, last], axis=1), climb)

    def _rewrite(self, X, moves, fixed):
        start, direction, climb = self._split(X)
        changed = moves != fixed
        new_direction, new_climb = _direction(_step(direction[:, :-1]), fixed[:, 1:])
        direction[:, :-1] = np.where(changed[:, 1:], new_direction, direction[:, :-1])
        climb = np.where(changed[:, 1:], new_climb, climb)
        start = np.where(changed[:, 0], fixed[:, 0] % self.frame.n_rows, start)
        return self._join(start, direction, climb)


def _step(direction: np.ndarray) -> np.ndarray:
    """Return the rows gained by the way into the next column: 1 for 11, -1 for 00, else 0."""
    return (direction == 3).astype(np.int64) - (direction == 0)


def _direction(step: np.ndarray, gain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return direction bits (0 to 3) and climb for moves that gain ``gain`` rows, diagonally where ``step`` points there."""
    diagonal = (step * gain) > 0
    direction = np.where(gain >= 0, np.where(diagonal, 3, 2), np.where(diagonal, 0, 1))
    return direction, np.abs(gain) - diagonal
