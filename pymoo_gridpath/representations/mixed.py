"""The mixed coding: a bit for the direction and a whole number for the distance."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.paths import ColumnPaths
from pymoo_gridpath.paths.frame import Axis
from pymoo_gridpath.representations.monotone import MonotoneRepresentation


class MixedRepresentation(MonotoneRepresentation):
    """Each move is a bit (1 up, 0 down) and the number of rows gained by it.

    With n = n_columns, a row holds first n - 1 bits, then n - 1 integers, so that each part has operators of its own.
    Bit k - 1 and integer k, for k from 1 to n - 2, make the step into column k: 0 rows is a horizontal step whatever
    the bit, y > 0 rows are a diagonal step and then y - 1 cells straight on. Integer 0 is the climb in the start
    column, with a sign of its own where the start is not in the bottom row. The last bit is the step into the last
    column: 1 goes diagonally towards the goal's row (in the paper, up), 0 horizontally; from there the path goes
    straight to the goal.

    Integers lie in [0, n_rows], as in the paper; integer 0 keeps to what its column has room for.

    See `MonotoneRepresentation` for the parameters.

    References
    ----------
    Ahmed and Deb (2013), section 2.2.
    """

    name = "mixed"

    def __init__(self, grid: OccupancyGrid, start: Sequence[int], goal: Sequence[int], axis: Axis = "auto"):
        super().__init__(grid, start, goal, axis)
        n, frame = self._n_moves, self.frame
        self.n_var = 2 * n
        self.n_bits = n
        self.xl = np.zeros(2 * n, dtype=int)
        self.xu = np.concatenate([np.ones(n, dtype=int), np.full(n, frame.n_rows)])
        self.xl[n] = -frame.start_row
        self.xu[n] = frame.n_rows - 1 - frame.start_row

    def row_moves(self, X: np.ndarray) -> np.ndarray:
        X = self.genes(X)
        moves = X[:, self.n_bits :].copy()
        moves[:, 1:] *= 2 * X[:, : self.n_bits - 1] - 1
        return moves

    def decode(self, X: np.ndarray) -> ColumnPaths:
        paths = super().decode(X)
        horizontal = self.genes(X)[:, self.n_bits - 1] == 0
        paths.enter[horizontal, -1] = paths.leave[horizontal, -2]
        return paths

    def encode(self, paths: ColumnPaths) -> np.ndarray:
        """Return the genes of paths, int, shape (N, n_var).

        The inverse of `decode` but for the redundancy of the coding: the bit of a horizontal step is 1, and that of a
        horizontal last step 0. A last step away from the goal's row becomes a horizontal one; other paths that have no code of
        their own are treated as in `IntegerRepresentation.encode`.
        """
        moves = np.diff(self._own(paths).leave[:, :-1], axis=1, prepend=self.frame.start_row)
        ahead = np.sign(self.frame.goal_row - paths.leave[:, -2:-1])
        last = (ahead != 0) & (paths.enter[:, -1:] == paths.leave[:, -2:-1] + ahead)
        integers = np.concatenate([moves[:, :1], np.abs(moves[:, 1:])], axis=1)
        return np.concatenate([moves[:, 1:] >= 0, last, integers], axis=1).astype(np.int64)

    def _rewrite(self, X, moves, fixed):
        X = X.copy()
        integers = X[:, self.n_bits :]
        integers[:, 0] = fixed[:, 0]
        integers[:, 1:] = np.abs(fixed[:, 1:])
        return X
