"""Batches of decoded paths and their measures."""

from __future__ import annotations

import functools

import numpy as np

from pymoo_gridpath.frame import MonotoneFrame
from pymoo_gridpath.grid import SQRT2

#: Degrees of one unit of turning; headings on an eight-connected grid are multiples of it.
TURN_UNIT = 45


class ColumnPaths:
    """N paths that advance one column at a time, in the frame of a `MonotoneFrame`.

    A path enters column c at row ``enter[:, c]``, moves straight up or down to row ``leave[:, c]``, and goes on to the
    next column by a horizontal or diagonal step. Measures cost O(columns) a path, however far it climbs.

    Parameters
    ----------
    frame : MonotoneFrame
    enter, leave : numpy.ndarray of int, shape (N, n_columns)
        Rows of the frame; ``|enter[:, c + 1] - leave[:, c]| <= 1``.
    """

    def __init__(self, frame: MonotoneFrame, enter: np.ndarray, leave: np.ndarray):
        self.frame = frame
        self.enter = enter
        self.leave = leave

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
        return ColumnPaths(self.frame, self.enter[index], self.leave[index])

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
        sums : numpy.ndarray, shape (n_columns, n_rows + 1)
            The field as `MonotoneFrame.prefix_sums` returns it.

        Returns
        -------
        numpy.ndarray, shape (N,)
        """
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
        enter, leave = self.enter[index], self.leave[index]
        columns, rows = [], []
        for column, (low, high) in enumerate(zip(enter, leave, strict=True)):
            run = np.arange(low, high + 1) if high >= low else np.arange(low, high - 1, -1)
            columns.append(np.full(len(run), column))
            rows.append(run)
        return self.frame.to_cells(np.concatenate(columns), np.concatenate(rows))
