"""The absolute coding: the row in each column."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.paths import ColumnPaths
from pymoo_gridpath.paths.frame import Axis
from pymoo_gridpath.representations.monotone import MonotoneRepresentation


class AbsoluteRepresentation(MonotoneRepresentation):
    """Gene k is the row at which column k is left, for every column but the last.

    Steps follow from the rows as in `IntegerRepresentation`. Genes lie in [0, n_rows - 1] (the paper counts from 1),
    and no path leaves the grid. The paper tried this coding and dropped it for its zig-zag paths.

    See `MonotoneRepresentation` for the parameters.

    References
    ----------
    Ahmed and Deb (2013), section 2.4.
    """

    name = "absolute"

    def __init__(self, grid: OccupancyGrid, start: Sequence[int], goal: Sequence[int], axis: Axis = "auto"):
        super().__init__(grid, start, goal, axis)
        self.n_var = self._n_moves
        self.xl = np.zeros(self.n_var, dtype=int)
        self.xu = np.full(self.n_var, self.frame.n_rows - 1)

    def row_moves(self, X: np.ndarray) -> np.ndarray:
        return np.diff(self.exit_rows(X), axis=1, prepend=self.frame.start_row)

    def exit_rows(self, X: np.ndarray) -> np.ndarray:
        return self.genes(X)

    def encode(self, paths: ColumnPaths) -> np.ndarray:
        """Return the genes of paths, the inverse of `decode` as in `IntegerRepresentation.encode`, int, shape (N, n_var)."""
        return self._own(paths).leave[:, :-1].copy()

    def _rewrite(self, X, moves, fixed):
        return self.frame.start_row + np.cumsum(fixed, axis=1)
