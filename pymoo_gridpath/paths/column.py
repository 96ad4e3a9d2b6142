"""Paths that advance one column at a time."""

from __future__ import annotations

import functools

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.fields import BoxedField
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.neighbourhood import TURN_UNIT
from pymoo_gridpath.paths.base import Paths, check_chosen, check_place, check_summed
from pymoo_gridpath.paths.frame import MonotoneFrame
from pymoo_gridpath.paths.sequences import Sequences


class ColumnPaths(Paths):
    """N paths that advance one column at a time, in the frame of a `MonotoneFrame`.

    A path enters column c at row ``enter[:, c]``, moves straight up or down to row ``leave[:, c]``, and goes on to the
    next column by a horizontal or diagonal step. Measures cost O(columns) a path, however far it climbs.

    Parameters
    ----------
    frame : MonotoneFrame
    enter, leave : numpy.ndarray of int, shape (N, n_columns)
        Rows of the frame; ``|enter[:, c + 1] - leave[:, c]| <= 1``.

    Raises
    ------
    GridPathError
        If the arrays are no such rows.
    """

    def __init__(self, frame: MonotoneFrame, enter: np.ndarray, leave: np.ndarray):
        self.frame = checks.instance("frame", frame, MonotoneFrame)
        self.enter = _rows("enter", enter, frame, frame.n_columns)
        self.leave = _rows("leave", leave, frame, frame.n_columns)
        if self.enter.shape != self.leave.shape:
            raise GridPathError(f"enter has {len(self.enter)} rows and leave {len(self.leave)}, expected one each for a path")
        if not checks.within(self.enter[:, 1:] - self.leave[:, :-1], -1, 1):
            raise GridPathError(
                "a path enters a column more than one row from where it left the one before, expected one at most"
            )

    @classmethod
    def _unchecked(cls, frame: MonotoneFrame, enter: np.ndarray, leave: np.ndarray) -> ColumnPaths:
        """Return paths of signed rows that the package itself worked out, without the time to look at them again."""
        paths = cls.__new__(cls)
        paths.frame, paths.enter, paths.leave = frame, enter, leave
        return paths

    @classmethod
    def through(cls, frame: MonotoneFrame, exit_rows: np.ndarray) -> ColumnPaths:
        """Return the paths that leave columns 0 to n_columns - 2 at the given rows and climb as soon as they can.

        Each step to the next column goes one row towards the row where that column is left (for the last column: the
        goal's row), diagonally, and the rest of the climb is made in that column. Where such a diagonal is not legal, for the
        corners that it passes or on a grid without diagonal steps, it is taken as a horizontal step instead.

        Parameters
        ----------
        frame : MonotoneFrame
        exit_rows : numpy.ndarray of int, shape (N, n_columns - 1)
            Within 0 and n_rows - 1.
        """
        checks.instance("frame", frame, MonotoneFrame)
        return cls._through_unchecked(frame, _rows("exit_rows", exit_rows, frame, frame.n_columns - 1))

    @classmethod
    def _through_unchecked(cls, frame: MonotoneFrame, exit_rows: np.ndarray) -> ColumnPaths:
        leave = np.empty((len(exit_rows), frame.n_columns), dtype=np.int32)
        leave[:, :-1] = exit_rows
        leave[:, -1] = frame.goal_row
        step = np.sign(leave[:, 1:] - leave[:, :-1])
        if frame.grid.neighbourhood.restricts:
            step *= frame._flanks_at(leave[:, :-1], step) == 0
        enter = np.empty_like(leave)
        enter[:, 0] = frame.start_row
        np.add(leave[:, :-1], step, out=enter[:, 1:])
        return cls._unchecked(frame, enter, leave)

    @property
    def grid(self) -> OccupancyGrid:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The grid of the frame."""
        return self.frame.grid

    def __len__(self) -> int:
        return len(self.enter)

    def __getitem__(self, index) -> ColumnPaths:
        """Return the paths at a slice, a mask or an array of indices."""
        index = check_chosen(index, len(self))
        return ColumnPaths._unchecked(self.frame, self.enter[index], self.leave[index])

    @functools.cached_property
    def _step(self) -> np.ndarray:
        """Rows gained by the step into each column but the first: -1, 0 or 1, int8, shape (N, n_columns - 1)."""
        return (self.enter[:, 1:] - self.leave[:, :-1]).astype(np.int8)

    @functools.cached_property
    def _climb(self) -> np.ndarray:
        """Rows gained within each column, shape (N, n_columns)."""
        return self.leave - self.enter

    @functools.cached_property
    def n_diagonal(self) -> np.ndarray:
        """Number of diagonal steps, int, shape (N,)."""
        return np.abs(self._step).sum(axis=1, dtype=np.int64)

    @property
    def n_straight(self) -> np.ndarray:
        """Number of horizontal and vertical steps, int, shape (N,)."""
        return np.abs(self._climb).sum(axis=1) + (self.frame.n_columns - 1) - self.n_diagonal

    @functools.cached_property
    def turn(self) -> np.ndarray:
        """Total turn in degrees, the sum of the absolute heading changes along the path; int, shape (N,)."""
        # In units of 45 degrees a step s has the heading -1, 0 or 1 and a climb of sign v the heading 2 v, so that the turn
        # between them is |2 v - s| = 2 - v s. No two headings differ by more than 180 degrees.
        step, sign = self._step, np.sign(self._climb).astype(np.int8)
        climbing = np.abs(sign)
        units = 2 * (climbing[:, 1:] + climbing[:, :-1]) - step * (sign[:, 1:] + sign[:, :-1])
        units[:, 1:] += np.abs(step[:, 1:] - step[:, :-1]) * (1 - climbing[:, 1:-1])
        return TURN_UNIT * units.sum(axis=1, dtype=np.int64)

    def total(self, field: np.ndarray | BoxedField) -> np.ndarray:
        """Return the sum of a field over the visited cells, start and goal included.

        Parameters
        ----------
        field : numpy.ndarray, shape (n_columns, n_rows + 1) or (height * width,)
            As `MonotoneFrame.prefix_sums` returns it, or by the index of the cell, which is slower.

        Returns
        -------
        numpy.ndarray, shape (N,)
        """
        frame = self.frame
        shapes = (frame.n_columns, frame.n_rows + 1), (frame.grid.occupied.size,)
        sums = check_summed(field, *shapes)
        if sums.ndim == 1:
            return super().total(sums)
        flat = sums.ravel()
        low, high = self._runs
        return (flat.take(high) - flat.take(low)).sum(axis=1)

    @functools.cached_property
    def _runs(self) -> tuple[np.ndarray, np.ndarray]:
        """Indices into flattened prefix sums of the bottom of each column's run, and of one above its top."""
        base = np.arange(self.frame.n_columns) * (self.frame.n_rows + 1)
        return np.minimum(self.enter, self.leave) + base, np.maximum(self.enter, self.leave) + (base + 1)

    @property
    def interfering_cells(self) -> np.ndarray:
        """Number of occupied cells that each path crosses, int, shape (N,); a legal path has 0.

        Steps to the next column count as those of `Paths` do.
        """
        count = self.total(self.frame.occupied_sums)
        if self.grid.neighbourhood.restricts:
            count += self.frame._flanks_at(self.leave[:, :-1], self._step).sum(axis=1)
        return count

    def cells(self, index: int) -> np.ndarray:
        """Return the grid cells (x, y) of one path in the order in which it visits them, int, shape (n_cells, 2)."""
        index = check_place(index, len(self))
        enter, leave = self.enter[index], self.leave[index]
        columns, rows = [], []
        for column, (low, high) in enumerate(zip(enter, leave, strict=True)):
            run = np.arange(low, high + 1) if high >= low else np.arange(low, high - 1, -1)
            columns.append(np.full(len(run), column))
            rows.append(run)
        return self.frame.to_cells(np.concatenate(columns), np.concatenate(rows))

    @functools.cached_property
    def sequences(self) -> Sequences:
        """The cells that the paths visit, in order, as `Sequences`."""
        n_cells = np.abs(self._climb) + 1
        ends = np.cumsum(n_cells.ravel())
        # Where each column's run begins in the joined array, and how far each cell has come from there.
        within = np.arange(ends[-1] if len(ends) else 0) - np.repeat(ends - n_cells.ravel(), n_cells.ravel())
        origin, along, across = self._cell_index()
        first = origin + along * np.arange(self.frame.n_columns) + across * self.enter.astype(np.int64)
        up = across * np.sign(self._climb).astype(np.int64)
        cells = np.repeat(first.ravel(), n_cells.ravel()) + np.repeat(up.ravel(), n_cells.ravel()) * within
        offsets = np.zeros(len(self) + 1, dtype=np.int64)
        np.cumsum(n_cells.sum(axis=1), out=offsets[1:])
        return Sequences(cells, offsets)

    def _cell_index(self) -> tuple[int, int, int]:
        """Return the cell index of column 0 and row 0, and what one column and one row add to it."""
        x, y = self.frame.to_cells([0, 1, 0], [0, 0, 1]).T
        origin, right, up = (y * self.frame.grid.width + x).tolist()
        return origin, right - origin, up - origin


def _rows(name: str, rows: np.ndarray, frame: MonotoneFrame, n_columns: int) -> np.ndarray:
    """Return rows of a frame, signed, since they are subtracted, if they are such."""
    expected = f"rows of the frame, whole numbers from 0 to {frame.n_rows - 1} of shape (N, {n_columns})"
    rows = checks.array(name, rows, (None, n_columns), "iu", expected=expected)
    if not checks.within(rows, 0, frame.n_rows - 1):
        raise GridPathError(f"{name} holds other numbers, expected {expected}")
    return rows if rows.dtype.kind == "i" and rows.itemsize >= 4 else rows.astype(np.int64)
