"""Paths given by their cells."""

from __future__ import annotations

import functools

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.grid import SQRT2, OccupancyGrid, check_grid
from pymoo_gridpath.neighbourhood import HEADINGS, TURN_UNIT
from pymoo_gridpath.paths.base import check_chosen, check_place, check_summed, sums_of
from pymoo_gridpath.paths.sequences import Sequences

# The heading of a step by the signs of (dx, dy): entry 4 + sign(dx) + 3 * sign(dy).
_HEADING = np.zeros(9, dtype=np.int8)
_HEADING[4 + HEADINGS[:, 0] + 3 * HEADINGS[:, 1]] = np.arange(8)


class CellPaths:
    """N paths given by their cells, which may lead anywhere on a grid.

    Measures are those of `ColumnPaths`, equal to the bit on paths that both can hold. A cell that follows itself counts once:
    it is padding, or a pause.

    Rows need be no legal paths; they are measured by these rules, and only a legal path has no interfering cell. The way
    between two cells that are no neighbours, a *jump*, is as long as the shortest way between them on an empty grid: with
    ``a >= b`` the distances along the two axes, b diagonal and ``a - b`` straight steps. It counts as ``a - 1`` interfering
    cells, those that it leaves out, and its heading is that of the signs of its dx and dy: straight along an axis, or
    else diagonal. Only cells in the row are visited.

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

    def __init__(self, grid: OccupancyGrid, rows: np.ndarray):
        self.grid = check_grid(grid)
        n_cells = grid.width * grid.height
        expected = f"indices of cells, whole numbers from 0 to {n_cells - 1} of shape (N, n), n at least 1"
        self.rows = checks.array("rows", rows, (None, None), "iu", expected=expected)
        if not self.rows.shape[1] or not checks.within(self.rows, 0, n_cells - 1):
            raise GridPathError(f"rows is {checks.shown(self.rows)} with other values, expected {expected}")

    @classmethod
    def _unchecked(cls, grid: OccupancyGrid, rows: np.ndarray) -> CellPaths:
        """Return paths of cells that the package itself worked out, without the time to look at them again."""
        paths = cls.__new__(cls)
        paths.grid, paths.rows = grid, rows
        return paths

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, index) -> CellPaths:
        """Return the paths at a slice, a mask or an array of indices."""
        return CellPaths._unchecked(self.grid, self.rows[check_chosen(index, len(self))])

    @functools.cached_property
    def sequences(self) -> Sequences:
        """The cells that the paths visit, in order, none following itself, as `Sequences`."""
        moved = np.ones(self.rows.shape, dtype=bool)
        np.not_equal(self.rows[:, 1:], self.rows[:, :-1], out=moved[:, 1:])
        offsets = np.zeros(len(self) + 1, dtype=np.int64)
        np.cumsum(np.count_nonzero(moved, axis=1), out=offsets[1:])
        return Sequences(self.rows[moved].astype(np.int64, copy=False), offsets)

    @functools.cached_property
    def _steps(self) -> tuple[np.ndarray, np.ndarray]:
        """The step (dx, dy) from each visited cell, (0, 0) from the last one of a path, each int, shape (n_cells,)."""
        cells, offsets = self.sequences
        y = cells // self.grid.width
        x = cells - y * self.grid.width
        dx, dy = np.zeros_like(cells), np.zeros_like(cells)
        np.subtract(x[1:], x[:-1], out=dx[:-1])
        np.subtract(y[1:], y[:-1], out=dy[:-1])
        dx[offsets[1:] - 1] = dy[offsets[1:] - 1] = 0
        return dx, dy

    @functools.cached_property
    def _reach(self) -> tuple[np.ndarray, np.ndarray]:
        """The longer and the shorter of |dx| and |dy| of each step, each int, shape (n_cells,)."""
        across, up = np.abs(self._steps[0]), np.abs(self._steps[1])
        return np.maximum(across, up), np.minimum(across, up)

    def _sum(self, values: np.ndarray) -> np.ndarray:
        """Return the sum over each path of a value for each of its cells, or of the steps from them, shape (N,)."""
        return sums_of(values, self.sequences.offsets)

    @functools.cached_property
    def n_diagonal(self) -> np.ndarray:
        """Number of diagonal steps, int, shape (N,)."""
        return self._sum(self._reach[1])

    @property
    def n_straight(self) -> np.ndarray:
        """Number of horizontal and vertical steps, int, shape (N,)."""
        return self._sum(self._reach[0]) - self.n_diagonal

    @property
    def length(self) -> np.ndarray:
        """Length in cells: straight steps count 1, diagonal ones sqrt(2); shape (N,)."""
        return self.n_straight + SQRT2 * self.n_diagonal

    @property
    def turn(self) -> np.ndarray:
        """Total turn in degrees, the sum of the absolute heading changes along the path; int, shape (N,)."""
        offsets = self.sequences.offsets
        dx, dy = self._steps
        heading = _HEADING.take(np.sign(dx) + 3 * np.sign(dy) + 4)
        apart = np.abs(heading[1:] - heading[:-1])
        units = np.zeros(len(heading), dtype=np.int64)
        np.minimum(apart, 8 - apart, out=units[1:])
        # No turn is made at the first and at the last cell of a path.
        units[offsets[:-1]] = units[offsets[1:] - 1] = 0
        return TURN_UNIT * self._sum(units)

    def total(self, field: np.ndarray) -> np.ndarray:
        """Return the sum of a field over the visited cells, start and goal included.

        Parameters
        ----------
        field : numpy.ndarray, shape (height * width,)
            By the index of the cell.

        Returns
        -------
        numpy.ndarray, shape (N,)
        """
        return self._sum(check_summed(field, (self.grid.width * self.grid.height,)).take(self.sequences.cells))

    @property
    def interfering_cells(self) -> np.ndarray:
        """Number of occupied cells that each path crosses, int, shape (N,); a legal path has 0, and no other has.

        Where the grid forbids to cut corners, an occupied cell beside a diagonal step counts as crossed by that step. A jump
        counts one for each cell that it leaves out.
        """
        occupied, cells, (dx, dy) = self.grid.occupied.ravel(), self.sequences.cells, self._steps
        long, short = self._reach
        count = np.maximum(long - 1, 0)
        count += occupied.take(cells)
        if not self.grid.corner_cutting:
            diagonal = np.flatnonzero((long == 1) & (short == 1))
            cell = cells[diagonal]
            count[diagonal] += occupied.take(cell + dx[diagonal])
            count[diagonal] += occupied.take(cell + dy[diagonal] * self.grid.width)
        return self._sum(count)

    def cells(self, index: int) -> np.ndarray:
        """Return the grid cells (x, y) of one path in the order in which it visits them, int, shape (n_cells, 2)."""
        visited = self[[check_place(index, len(self))]].sequences.cells
        return np.stack([visited % self.grid.width, visited // self.grid.width], axis=-1)
