"""Batches of decoded paths and their measures."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.fields import BoxedField
from pymoo_gridpath.frame import MonotoneFrame, within
from pymoo_gridpath.grid import SQRT2, OccupancyGrid, check_grid
from pymoo_gridpath.search.moves import HEADINGS
from pymoo_gridpath.search.sequences import Sequences

#: Degrees of one unit of turning; headings on an eight-connected grid are multiples of it.
TURN_UNIT = 45

# The heading of a step by the signs of (dx, dy): entry 4 + sign(dx) + 3 * sign(dy).
_HEADING = np.zeros(9, dtype=np.int8)
_HEADING[4 + HEADINGS[:, 0] + 3 * HEADINGS[:, 1]] = np.arange(8)


class ColumnPaths:
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
        If the arrays are no such rows, as far as they are looked at: too long a step is found where it is measured.
    """

    def __init__(self, frame: MonotoneFrame, enter: np.ndarray, leave: np.ndarray):
        self.frame = checks.instance("frame", frame, MonotoneFrame)
        self.enter = _rows("enter", enter, frame, frame.n_columns)
        self.leave = _rows("leave", leave, frame, frame.n_columns)
        if self.enter.shape != self.leave.shape:
            raise GridPathError(f"enter has {len(self.enter)} rows and leave {len(self.leave)}, expected one each for a path")

    @classmethod
    def through(cls, frame: MonotoneFrame, exit_rows: np.ndarray) -> ColumnPaths:
        """Return the paths that leave columns 0 to n_columns - 2 at the given rows and climb as soon as they can.

        Each step to the next column goes one row towards the row where that column is left (for the last column: the
        goal's row), diagonally, and the rest of the climb is made in that column. Where the grid forbids to cut a corner, a
        diagonal that would cut one is taken as a horizontal step instead.

        Parameters
        ----------
        frame : MonotoneFrame
        exit_rows : numpy.ndarray of int, shape (N, n_columns - 1)
            Within 0 and n_rows - 1.
        """
        checks.instance("frame", frame, MonotoneFrame)
        exit_rows = _rows("exit_rows", exit_rows, frame, frame.n_columns - 1)
        leave = np.empty((len(exit_rows), frame.n_columns), dtype=np.int32)
        leave[:, :-1] = exit_rows
        leave[:, -1] = frame.goal_row
        step = np.sign(leave[:, 1:] - leave[:, :-1])
        if not frame.grid.corner_cutting:
            step *= frame.flanks_at(leave[:, :-1], step) == 0
        enter = np.empty_like(leave)
        enter[:, 0] = frame.start_row
        np.add(leave[:, :-1], step, out=enter[:, 1:])
        return cls(frame, enter, leave)

    def __len__(self) -> int:
        return len(self.enter)

    def __getitem__(self, index) -> ColumnPaths:
        """Return the paths at a slice, a mask or an array of indices."""
        index = _some(index, len(self))
        return ColumnPaths(self.frame, self.enter[index], self.leave[index])

    @functools.cached_property
    def _step(self) -> np.ndarray:
        """Rows gained by the step into each column but the first: -1, 0 or 1, int8, shape (N, n_columns - 1)."""
        step = self.enter[:, 1:] - self.leave[:, :-1]
        if not within(step, -1, 1):
            raise GridPathError(
                "a path enters a column more than one row from where it left the one before, expected one at most"
            )
        return step.astype(np.int8)

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

    @property
    def length(self) -> np.ndarray:
        """Length in cells: straight steps count 1, diagonal ones sqrt(2); shape (N,)."""
        return self.n_straight + SQRT2 * self.n_diagonal

    @property
    def turn(self) -> np.ndarray:
        """Total turn in degrees, the sum of the absolute heading changes along the path; int, shape (N,)."""
        # In units of 45 degrees a step s has the heading -1, 0 or 1 and a climb of sign v the heading 2 v, so that the turn
        # between them is |2 v - s| = 2 - v s. No two headings differ by more than 180 degrees.
        step, sign = self._step, np.sign(self._climb).astype(np.int8)
        climbing = sign != 0
        units = 2 * (climbing[:, 1:].sum(axis=1) + climbing[:, :-1].sum(axis=1))
        units -= (step * (sign[:, 1:] + sign[:, :-1])).sum(axis=1)
        units += (np.abs(step[:, 1:] - step[:, :-1]) * ~climbing[:, 1:-1]).sum(axis=1)
        return TURN_UNIT * units

    def total(self, sums: np.ndarray) -> np.ndarray:
        """Return the sum of a field over the visited cells, start and goal included.

        Parameters
        ----------
        sums : numpy.ndarray, shape (n_columns, n_rows + 1) or (height * width,)
            The field as `MonotoneFrame.prefix_sums` returns it, or by the index of the cell, which is slower.

        Returns
        -------
        numpy.ndarray, shape (N,)
        """
        frame = self.frame
        shapes = (frame.n_columns, frame.n_rows + 1), (frame.grid.width * frame.grid.height,)
        sums = _summed(sums, *shapes)
        if sums.ndim == 1:
            return _sums(sums.take(self.sequences.cells), self.sequences.offsets)
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

        Where the grid forbids to cut corners, an occupied cell beside a diagonal step counts as crossed by that step.
        """
        count = self.total(self.frame.occupied_sums)
        if not self.frame.grid.corner_cutting:
            count += self.frame.flanks_at(self.leave[:, :-1], self._step).sum(axis=1)
        return count

    def cells(self, index: int) -> np.ndarray:
        """Return the grid cells (x, y) of one path in the order in which it visits them, int, shape (n_cells, 2)."""
        index = _place(index, len(self))
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
        if not self.rows.shape[1] or not within(self.rows, 0, n_cells - 1):
            raise GridPathError(f"rows is {checks.shown(self.rows)} with other values, expected {expected}")

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, index) -> CellPaths:
        """Return the paths at a slice, a mask or an array of indices."""
        return CellPaths(self.grid, self.rows[_some(index, len(self))])

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
        return _sums(values, self.sequences.offsets)

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
        return self._sum(_summed(field, (self.grid.width * self.grid.height,)).take(self.sequences.cells))

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
        visited = self[[_place(index, len(self))]].sequences.cells
        return np.stack([visited % self.grid.width, visited // self.grid.width], axis=-1)


def _sums(values: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """Return the sum of the values of each path, which begin at its offset, shape (N,)."""
    return np.add.reduceat(values, offsets[:-1]) if len(offsets) > 1 else values[:0]


def check_paths(paths):
    """Return a batch of decoded paths if it is one; what a representation of one's own decodes to needs the same measures."""
    measures = ("length", "turn", "interfering_cells", "total", "cells")
    if isinstance(paths, ColumnPaths | CellPaths) or all(hasattr(paths, name) for name in ("__len__", *measures)):
        return paths
    raise GridPathError(f"paths is {checks.shown(paths)}, expected paths as decode returns them")


def _rows(name: str, rows: np.ndarray, frame: MonotoneFrame, n_columns: int) -> np.ndarray:
    """Return rows of a frame, signed, since they are subtracted, if they are such."""
    expected = f"rows of the frame, whole numbers from 0 to {frame.n_rows - 1} of shape (N, {n_columns})"
    rows = checks.array(name, rows, (None, n_columns), "iu", expected=expected)
    if not within(rows, 0, frame.n_rows - 1):
        raise GridPathError(f"{name} holds other numbers, expected {expected}")
    return rows if rows.dtype.kind == "i" and rows.itemsize >= 4 else rows.astype(np.int64)


def _summed(field: np.ndarray | BoxedField, *shapes: tuple[int, ...]) -> Any:
    """Return a prepared field if it has one of the shapes, or is known in a box."""
    if isinstance(field, BoxedField):
        return field
    expected = f"numbers of shape {' or '.join(map(str, shapes))}, as the representation prepares them"
    field = checks.array("field", field, expected=expected)
    if field.shape not in shapes:
        raise GridPathError(f"field is {checks.shown(field)}, expected {expected}")
    return field


def _some(index, n_paths: int):
    """Return a slice, a mask or an array of indices if it chooses among so many paths."""
    if isinstance(index, slice):
        return index
    expected = f"a slice, a mask or an array of indices of {n_paths} paths"
    chosen = checks.array("index", index, (None,), "biu", expected=expected)
    if chosen.dtype.kind == "b" and len(chosen) == n_paths:
        return chosen
    if chosen.dtype.kind == "b" or not within(chosen, -n_paths, n_paths - 1):
        raise IndexError(f"index is {checks.shown(index)}, expected {expected}")
    return chosen.astype(np.int64, copy=False)


def _place(index: int, n_paths: int) -> int:
    """Return the index of one path, counted from the end where it is negative, from the start."""
    return checks.whole("index", index, -n_paths, n_paths - 1) % n_paths
