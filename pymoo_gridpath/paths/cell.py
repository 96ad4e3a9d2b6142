"""Paths given by their cells."""

from __future__ import annotations

import functools

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.grid import OccupancyGrid, check_grid
from pymoo_gridpath.paths.base import Paths, check_chosen
from pymoo_gridpath.paths.sequences import Sequences


class CellPaths(Paths):
    """N paths given by their cells, which may lead anywhere on a grid.

    Measures are those of `Paths`, equal to the bit to those of `ColumnPaths` on paths that both can hold. A cell that follows
    itself counts once: it is padding, or a pause.

    Parameters
    ----------
    grid : OccupancyGrid
    rows : numpy.ndarray of int, shape (N, n)
        Indices of cells, ``y * width + x``, n at least 1.

    Examples
    --------
    A path that turns back, padded with its last cell:

    >>> grid = OccupancyGrid([[0, 0, 0], [0, 1, 0], [0, 0, 0]])
    >>> path = CellPaths(grid, np.array([[2, 1, 0, 3, 6, 7, 8, 8, 8]]))
    >>> path.cells(0).tolist()
    [[2, 0], [1, 0], [0, 0], [0, 1], [0, 2], [1, 2], [2, 2]]
    >>> path.length.tolist(), path.turn.tolist(), path.interfering_cells.tolist()
    ([6.0], [180], [0])
    """

    # The signs of the steps along x and y that are no steps back, of paths which may not take those; set by `_unchecked`.
    _forward: tuple[int, int] | None = None

    def __init__(self, grid: OccupancyGrid, rows: np.ndarray):
        self.grid = check_grid(grid)
        n_cells = grid.width * grid.height
        expected = f"indices of cells, whole numbers from 0 to {n_cells - 1} of shape (N, n), n at least 1"
        self.rows = checks.array("rows", rows, (None, None), "iu", expected=expected)
        if not self.rows.shape[1] or not checks.within(self.rows, 0, n_cells - 1):
            raise GridPathError(f"rows is {checks.shown(self.rows)} with other values, expected {expected}")

    @classmethod
    def _unchecked(cls, grid: OccupancyGrid, rows: np.ndarray, forward: tuple[int, int] | None = None) -> CellPaths:
        """Return paths of cells that the package itself worked out, without the time to look at them again.

        Of paths that may not go back, ``forward`` holds the signs of the steps along x and y that they may take besides 0.
        """
        paths = cls.__new__(cls)
        paths.grid, paths.rows, paths._forward = grid, rows, forward
        return paths

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, index) -> CellPaths:
        """Return the paths at a slice, a mask or an array of indices."""
        return CellPaths._unchecked(self.grid, self.rows[check_chosen(index, len(self))], self._forward)

    @functools.cached_property
    def sequences(self) -> Sequences:
        """The cells that the paths visit, in order, none following itself, as `Sequences`."""
        moved = np.ones(self.rows.shape, dtype=bool)
        np.not_equal(self.rows[:, 1:], self.rows[:, :-1], out=moved[:, 1:])
        offsets = np.zeros(len(self) + 1, dtype=np.int64)
        np.cumsum(np.count_nonzero(moved, axis=1), out=offsets[1:])
        return Sequences(self.rows[moved].astype(np.int64, copy=False), offsets)

    @property
    def interfering_cells(self) -> np.ndarray:
        """As of `Paths`; where paths may not go back, each step that does counts as one more."""
        count = super().interfering_cells
        if self._forward is None:
            return count
        back = [(steps != 0) & (np.sign(steps) != sign) for steps, sign in zip(self._steps, self._forward, strict=True)]
        return count + self._sum((back[0] | back[1]).astype(np.int64))
