"""Paths given by their cells."""

from __future__ import annotations

import functools

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.compiled import COMPILED, kernel
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.grid import OccupancyGrid, check_grid
from pymoo_gridpath.paths.base import Paths, check_chosen
from pymoo_gridpath.paths.counts import steps_of, sums_of
from pymoo_gridpath.paths.sequences import Sequences, for_kernels


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

    # The signs of the steps along x and y that are no steps back, of paths which may not take those; set by `_visiting`.
    _forward: tuple[int, int] | None = None

    def __init__(self, grid: OccupancyGrid, rows: np.ndarray):
        self.grid = check_grid(grid)
        n_cells = grid.width * grid.height
        expected = f"indices of cells, whole numbers from 0 to {n_cells - 1} of shape (N, n), n at least 1"
        self.rows = checks.array("rows", rows, (None, None), "iu", expected=expected)
        if not self.rows.shape[1] or not checks.within(self.rows, 0, n_cells - 1):
            raise GridPathError(f"rows is {checks.shown(self.rows)} with other values, expected {expected}")

    @classmethod
    def _visiting(cls, grid: OccupancyGrid, sequences: Sequences, forward: tuple[int, int] | None = None) -> CellPaths:
        """Return paths of sequences that the package itself worked out, without the time to look at them again.

        Of paths that may not go back, ``forward`` holds the signs of the steps along x and y that they may take besides 0.
        """
        paths = cls.__new__(cls)
        paths.grid, paths.sequences, paths._forward = grid, sequences, forward
        return paths

    def __getitem__(self, index) -> CellPaths:
        """Return the paths at a slice, a mask or an array of indices."""
        return CellPaths._visiting(self.grid, self.sequences.take(check_chosen(index, len(self))), self._forward)

    @functools.cached_property
    def sequences(self) -> Sequences:
        """The cells that the paths visit, in order, none following itself, as `Sequences`."""
        n = self.rows.shape[1]
        return visited(self.rows, np.zeros(n, dtype=np.int64), np.full(n, self.grid.occupied.size - 1))

    @property
    def interfering_cells(self) -> np.ndarray:
        """As of `Paths`; where paths may not go back, each step that does counts as one more."""
        count = super().interfering_cells
        if self._forward is None:
            return count
        steps = steps_of(self.sequences, self.grid.width)
        back = [(step != 0) & (np.sign(step) != sign) for step, sign in zip(steps, self._forward, strict=True)]
        return count + sums_of((back[0] | back[1]).astype(np.int64), self.sequences.offsets)


def visited(rows: np.ndarray, low: np.ndarray, high: np.ndarray) -> Sequences:
    """Return the cells that rows of whole numbers visit, in order, none following itself.

    Parameters
    ----------
    rows : numpy.ndarray of int, shape (N, n)
    low, high : numpy.ndarray of int64, shape (n,)
        The least and the largest cell in each column; what lies beyond is taken for that.
    """
    offsets = np.zeros(len(rows) + 1, dtype=np.int64)
    if COMPILED:
        cells = _row_by_row(for_kernels(rows), for_kernels(low), for_kernels(high), offsets)
        return Sequences(cells[: offsets[-1]], offsets)
    rows = np.minimum(np.maximum(rows, low), high)
    moved = np.ones(rows.shape, dtype=bool)
    np.not_equal(rows[:, 1:], rows[:, :-1], out=moved[:, 1:])
    np.cumsum(np.count_nonzero(moved, axis=1), out=offsets[1:])
    return Sequences(rows[moved].astype(np.int64, copy=False), offsets)


@kernel
def _row_by_row(rows, low, high, offsets):
    """Return the cells that rows visit, and more behind them, and set the offsets."""
    n_rows, n = rows.shape
    cells = np.empty(n_rows * n, dtype=np.int64)
    total = 0
    for i in range(n_rows):
        before = np.int64(-1)
        for k in range(n):
            cell = min(max(rows[i, k], low[k]), high[k])
            # Written over if it follows itself.
            cells[total] = cell
            total += 1 if cell != before else 0
            before = cell
        offsets[i + 1] = total
    return cells
