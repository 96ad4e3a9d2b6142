"""The frame that turns any start, goal and grid into the paper's plain case."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from pymoo_gridpath import checks
from pymoo_gridpath.checks import shown
from pymoo_gridpath.errors import GridError, UnreachableError
from pymoo_gridpath.fields import check_field
from pymoo_gridpath.grid import OccupancyGrid, check_grid

Axis = Literal["auto", "x", "y"]


def check_axis(axis: Axis) -> Axis:
    """Return an axis if it is one."""
    if not (isinstance(axis, str) and axis in ("auto", "x", "y")):
        raise GridError(f"axis is {shown(axis)}, expected 'auto', 'x' or 'y'")
    return axis


class MonotoneFrame:
    """A view of a grid in which paths advance one column at a time, from the start on the left to a goal no lower.

    Ahmed and Deb (2013, section 2) code paths from the bottom-left to the top-right corner of a square grid. The frame swaps
    and flips axes so that every other query looks like theirs: *column* 0 holds the start, the last column holds the goal, and
    *rows* count from the edge that makes the goal's row at least the start's. Columns before the start and behind the
    goal are cut off, since a monotone path never visits them.

    Parameters
    ----------
    grid : OccupancyGrid
    start, goal : (int, int)
        Cells (x, y).
    axis : {"auto", "x", "y"}, default "auto"
        The axis along which paths advance. "auto" takes the one along which start and goal lie further apart (x if they are
        equal), or the other one if only that admits a path.

    Raises
    ------
    GridError
        If the start or the goal cannot be used, or both share their coordinate on the chosen axis.
    UnreachableError
        If no path joins start and goal, or none that is monotone along the axis.

    Attributes
    ----------
    axis : {"x", "y"}
        The axis along which paths advance.
    n_columns, n_rows : int
        Size of the frame.
    start_row, goal_row : int
        Rows of the start (column 0) and of the goal (last column).
    occupied : numpy.ndarray of bool, shape (n_columns, n_rows)
    """

    def __init__(self, grid: OccupancyGrid, start: Sequence[int], goal: Sequence[int], axis: Axis = "auto"):
        check_axis(axis)
        self.grid = check_grid(grid)
        self.start, self.goal = grid.check_query(start, goal)
        apart = (abs(self.goal[0] - self.start[0]), abs(self.goal[1] - self.start[1]))
        if axis == "auto":
            axes: list[Axis] = ["x", "y"] if apart[0] >= apart[1] else ["y", "x"]
            axes = [a for a in axes if apart["xy".index(a)] > 0]
        elif apart["xy".index(axis)] == 0:
            raise GridError(
                f"start {self.start} and goal {self.goal} have the same {axis}, so no path advances along axis {axis!r}"
            )
        else:
            axes = [axis]
        for candidate in axes:
            self._lay_out(candidate)
            if self.admits_path():
                return
        raise UnreachableError(
            f"no path from {self.start} to {self.goal} on the grid {shown(grid.name)} is monotone along "
            f"{' or '.join(axes)}: every one turns back, which the monotone representations cannot code; expected a query that "
            f"can be crossed one column (or row) at a time, or representation='cells', which can code every path"
        )

    def _lay_out(self, axis: Axis) -> None:
        self.axis = axis
        u, v = (0, 1) if axis == "x" else (1, 0)
        first, last = self.start[u], self.goal[u]
        self._step = 1 if last > first else -1
        self._flip = self.goal[v] < self.start[v]
        self.n_columns = abs(last - first) + 1
        self.n_rows = (self.grid.height, self.grid.width)[u]
        self.start_row = self._row(self.start[v])
        self.goal_row = self._row(self.goal[v])
        self.occupied = self.columns(self.grid.occupied)
        for cached in ("flanks", "occupied_sums"):
            self.__dict__.pop(cached, None)

    def _row(self, v):
        return self.n_rows - 1 - v if self._flip else v

    # -- between grid and frame ---------------------------------------------------------------------------------------

    def columns(self, field: np.ndarray) -> np.ndarray:
        """Return a field over the grid, shape (height, width), as seen in the frame, shape (n_columns, n_rows)."""
        u = 0 if self.axis == "x" else 1
        field = check_field("field", field, self.grid)
        view = field.T if self.axis == "x" else field
        low = min(self.start[u], self.goal[u])
        view = view[low : low + self.n_columns]
        return np.ascontiguousarray(view[:: self._step, :: -1 if self._flip else 1])

    def to_cells(self, column: ArrayLike, row: ArrayLike) -> np.ndarray:
        """Return the grid cells (x, y) of columns and rows of the frame, shape (..., 2)."""
        column, row = (_whole_numbers(name, values) for name, values in (("column", column), ("row", row)))
        if column.shape != row.shape:
            raise GridError(f"column has the shape {column.shape} and row {row.shape}, expected the same")
        along = self.start[0 if self.axis == "x" else 1] + self._step * column
        across = self._row(row)
        return np.stack([along, across] if self.axis == "x" else [across, along], axis=-1)

    def from_cells(self, cells: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Return the columns and rows of grid cells (x, y), shape (..., 2); the inverse of `to_cells`."""
        cells = _whole_numbers("cells", cells)
        if cells.shape[-1:] != (2,):
            raise GridError(f"cells is {shown(cells)}, expected cells (x, y) of shape (..., 2)")
        u, v = (0, 1) if self.axis == "x" else (1, 0)
        return self._step * (cells[..., u] - self.start[u]), self._row(cells[..., v])

    # -- what paths need to know --------------------------------------------------------------------------------------

    @functools.cached_property
    def flanks(self) -> np.ndarray:
        """Number of cells that each step to the next column crosses beside it, int8, shape (3, n_columns - 1, n_rows).

        Entry [1 + s, c, r] belongs to the step from (c, r) to (c + 1, r + s), s in -1, 0, 1; it is 0 for s = 0. Where corners
        may be cut no step crosses any.
        """
        occupied, crossings = self.occupied, self.grid.neighbourhood.crossings
        flanks = np.zeros((3, self.n_columns - 1, self.n_rows), dtype=np.int8)
        flanks[2, :, :-1] = crossings(occupied[:-1, 1:], occupied[1:, :-1])
        flanks[0, :, 1:] = crossings(occupied[:-1, :-1], occupied[1:, 1:])
        return flanks

    @functools.cached_property
    def occupied_sums(self) -> np.ndarray:
        """Prefix sums of the occupied cells, see `prefix_sums`."""
        return self.prefix_sums(self.grid.occupied)

    def prefix_sums(self, field: np.ndarray) -> np.ndarray:
        """Return the sums of a field up each column, for `pymoo_gridpath.paths.ColumnPaths.total`.

        Parameters
        ----------
        field : numpy.ndarray, shape (height, width)
            Over the grid.

        Returns
        -------
        numpy.ndarray, shape (n_columns, n_rows + 1)
            Entry [c, r] is the sum of column c below row r.
        """
        framed = self.columns(field)
        kind = float if framed.dtype.kind == "f" else np.int64
        sums = np.zeros((self.n_columns, self.n_rows + 1), dtype=kind)
        np.cumsum(framed, axis=1, out=sums[:, 1:])
        return sums

    def flanks_at(self, row: np.ndarray, step: np.ndarray) -> np.ndarray:
        """Return `flanks` for steps that leave all columns but the last, both arguments of shape (N, n_columns - 1)."""
        n = self.n_columns - 1
        expected = f"whole numbers of shape (N, {n}), within the frame of {self.n_rows} rows"
        row, step = (checks.array(k, v, (None, n), "iu", expected=expected) for k, v in (("row", row), ("step", step)))
        if row.shape != step.shape or not (checks.within(row, 0, self.n_rows - 1) and checks.within(step, -1, 1)):
            raise GridError(f"row and step hold other numbers, or are of different lengths, expected {expected}")
        return self._flanks_at(row, step)

    def _flanks_at(self, row: np.ndarray, step: np.ndarray) -> np.ndarray:
        n = self.n_columns - 1
        index = row + np.arange(n) * self.n_rows
        # Before numpy 2, a sum of small whole numbers and a number stays small.
        index += (step.astype(np.int64) + 1) * (n * self.n_rows)
        return self.flanks.ravel().take(index)

    def admits_path(self) -> bool:
        """Whether a legal path leads through the frame, one column at a time and up or down within columns."""
        free = ~self.occupied
        # Rows of one column that are joined by free cells share a run number.
        run = np.cumsum(self.occupied, axis=1)
        reached = np.zeros(self.n_rows, dtype=bool)
        reached[self.start_row] = True
        for column in range(self.n_columns):
            runs = np.unique(run[column, reached & free[column]])
            reached = np.isin(run[column], runs) & free[column]
            if column == self.n_columns - 1:
                break
            rising, falling = reached[:-1], reached[1:]
            if self.grid.neighbourhood.restricts:
                rising = rising & (self.flanks[2, column, :-1] == 0)
                falling = falling & (self.flanks[0, column, 1:] == 0)
            reached = reached.copy()
            reached[1:] |= rising
            reached[:-1] |= falling
        return bool(reached[self.goal_row])


def _whole_numbers(name: str, values: ArrayLike) -> np.ndarray:
    """Return an array of whole numbers, signed, since flips subtract them."""
    return checks.array(name, values, None, "iu", expected="an array of whole numbers", error=GridError).astype(
        np.int64, copy=False
    )
