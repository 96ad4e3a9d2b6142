"""What the codings of the paper share: paths that advance one column at a time, and its edge fixing."""

from __future__ import annotations

import functools
from abc import abstractmethod
from collections.abc import Sequence

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.compiled import COMPILED, kernel
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.fields import BoxedField, check_field
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.neighbourhood import HEADINGS
from pymoo_gridpath.paths import ColumnPaths
from pymoo_gridpath.paths.frame import Axis, MonotoneFrame
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.representations.base import Representation
from pymoo_gridpath.search.moves import Moves


class MonotoneRepresentation(Representation):
    """Base of the codings of Ahmed and Deb (2013, section 2): one step to the next column a gene.

    Parameters
    ----------
    grid : OccupancyGrid
    start, goal : (int, int)
        Cells (x, y).
    axis : {"auto", "x", "y"}, default "auto"
        The axis along which paths advance, see `MonotoneFrame`.

    Raises
    ------
    GridError, UnreachableError
        See `MonotoneFrame`.

    Attributes
    ----------
    frame : MonotoneFrame
    """

    monotone = True
    codes_detours = False
    paper = True

    def __init__(self, grid: OccupancyGrid, start: Sequence[int], goal: Sequence[int], axis: Axis = "auto"):
        self.frame = MonotoneFrame(grid, start, goal, axis)
        self.grid, self.start, self.goal = grid, self.frame.start, self.frame.goal

    def prepare(self, field: np.ndarray | BoxedField) -> np.ndarray | BoxedField:
        """Return a field over the grid as prefix sums up each column of the frame.

        If these lose the cost of a cell, as those of cheap cells beside dear ones, it is returned by the index of the cell, in
        float, shape (height * width,).
        """
        field = check_field("field", np.asarray(field) if isinstance(field, BoxedField) else field, self.grid).astype(float)
        with np.errstate(invalid="ignore", over="ignore"):
            sums = self.frame.prefix_sums(field)
            if np.array_equal(np.diff(sums, axis=1), self.frame.columns(field)):
                return sums
        return field.ravel()

    @functools.cached_property
    def moves(self) -> Moves:
        """The legal steps along the five headings that do not go back: forward, diagonally forward, and across."""
        k = 0 if self.frame.axis == "x" else 1
        forward = np.sign(self.goal[k] - self.start[k]) * HEADINGS[:, k] >= 0
        return Moves(self.grid, np.flatnonzero(forward).tolist(), self.box)

    def from_sequences(self, sequences: Sequences) -> np.ndarray:
        """Return the rows of genes that code paths given by the cells that they visit.

        Parameters
        ----------
        sequences : Sequences
            N paths from the start to the goal, monotone along the axis. What counts is where a path enters and leaves each
            column; a path that is longer than it need be between the two gets the genes of the direct way, see `encode`.

        Returns
        -------
        numpy.ndarray, shape (N, n_var), dtype `vtype`
            Genes of paths that are no longer, and legal where the given ones are.

        Raises
        ------
        GridPathError
            If a path leads from or to another cell, jumps, or goes back along the axis.
        """
        return self.encode(self._column_paths(sequences)).astype(self.vtype, copy=False)

    def _column_paths(self, sequences: Sequences) -> ColumnPaths:
        """Return the paths that enter and leave each column where the given ones do."""
        sequences = self._checked_ends(sequences)
        frame, shape = self.frame, (len(sequences.lengths), self.frame.n_columns)
        column, row = frame.from_cells(self.moves.cells(sequences.cells))
        first = np.zeros(len(column), dtype=bool)
        first[sequences.offsets[:-1]] = True
        gain, climb = np.diff(column)[~first[1:]], np.diff(row)[~first[1:]]
        if ((gain < 0) | (gain > 1) | (np.abs(climb) > 1)).any():
            raise GridPathError(
                f"a path jumps or goes back along the axis {frame.axis!r}, expected steps between neighbouring cells that the "
                f"{self.name} representation can code"
            )
        # A path is never back in a column that it left, so each run of equal columns is one column of one path.
        enters = first | (np.diff(column, prepend=-1) != 0)
        leaves = np.roll(enters, -1)
        return ColumnPaths._unchecked(
            frame, row[enters].astype(np.int32).reshape(shape), row[leaves].astype(np.int32).reshape(shape)
        )

    def _own(self, paths: ColumnPaths) -> ColumnPaths:
        """Return paths if they are of this frame."""
        frame = checks.instance("paths", paths, ColumnPaths, ", as decode returns them").frame
        if frame is not self.frame and any(
            getattr(frame, key) != getattr(self.frame, key) for key in ("axis", "start", "goal", "grid")
        ):
            raise GridPathError("paths are of another grid, start, goal or axis than the representation, expected its own")
        return paths

    @property
    def _n_moves(self) -> int:
        """Number of coded moves: the climb in the start column and every step but the last."""
        return self.frame.n_columns - 1

    @abstractmethod
    def row_moves(self, X: np.ndarray) -> np.ndarray:
        """Return the rows gained by each coded move, int, shape (N, n_columns - 1); move 0 is the climb at the start."""

    def exit_rows(self, X: np.ndarray) -> np.ndarray:
        """Return the row at which each column but the last is left, int, shape (N, n_columns - 1).

        A move that would leave the grid ends at the edge, without drawing a number.
        """
        return _rows_within(self.row_moves(X), self.frame)

    def decode(self, X: np.ndarray) -> ColumnPaths:
        """Return the paths that the rows of X code.

        Parameters
        ----------
        X : numpy.ndarray, shape (N, n_var)
            Genes. Real numbers are rounded to the nearest gene.

        Returns
        -------
        ColumnPaths
            N paths from the start to the goal; the last column is climbed to the goal whatever the genes (the paper's end
            fixing). A move that would leave the grid ends at its edge: `repair` is what draws the paper's random row.
        """
        return ColumnPaths._through_unchecked(self.frame, self.exit_rows(X))

    def repair(self, X: np.ndarray, random_state: np.random.Generator) -> np.ndarray:
        """Return X with the paper's random edge fixing written into the genes (section 2.1).

        A move that would leave the grid is replaced by one to a row between the vehicle's row and the edge, drawn with a
        probability that rises linearly from zero at the vehicle's row to its maximum at the edge. At the edge itself
        there is no such row, and the vehicle stays in its row.

        Parameters
        ----------
        X : numpy.ndarray, shape (N, n_var)
        random_state : numpy.random.Generator

        Returns
        -------
        numpy.ndarray, shape (N, n_var), dtype `vtype`
            A new array; rows that need no fixing are as they were.
        """
        checks.instance("random_state", random_state, np.random.Generator, " such as numpy.random.default_rng(1)")
        X = self.genes(X).astype(self.vtype)
        moves = self.row_moves(X)
        outside = _rows_and_outside(moves, self.frame)[1]
        if len(outside):
            fixed = _fix_edges(moves[outside], self.frame, random_state)
            X[outside] = self._rewrite(X[outside], moves[outside], fixed)
        return X

    @abstractmethod
    def _rewrite(self, X: np.ndarray, moves: np.ndarray, fixed: np.ndarray) -> np.ndarray:
        """Return X with the genes changed where ``fixed`` moves differ from ``moves``."""


def _rows_and_outside(moves: np.ndarray, frame: MonotoneFrame) -> tuple[np.ndarray, np.ndarray]:
    """Return the rows that moves lead to, and the indices of the paths among which one lies off the grid."""
    rows = np.cumsum(moves, axis=1, dtype=np.int32)
    rows += frame.start_row
    return rows, np.flatnonzero((rows.min(axis=1) < 0) | (rows.max(axis=1) >= frame.n_rows))


def _rows_within(moves: np.ndarray, frame: MonotoneFrame) -> np.ndarray:
    """Add up moves from the start row, stopping each at the edge of the grid."""
    rows, outside = _rows_and_outside(moves, frame)
    if len(outside):
        row = np.full(len(outside), frame.start_row)
        for k in range(moves.shape[1]):
            row = np.clip(row + moves[outside, k], 0, frame.n_rows - 1)
            rows[outside, k] = row
    return rows


def _fix_edges(moves: np.ndarray, frame: MonotoneFrame, random_state: np.random.Generator) -> np.ndarray:
    """Return moves that stay on the grid, redrawing by a linear distribution those that leave it."""
    draws = random_state.random(moves.shape)
    if COMPILED:
        return _fix_path_by_path(np.ascontiguousarray(moves), draws, frame.start_row, frame.n_rows)
    return _fix_move_by_move(moves, draws, frame)


@kernel
def _fix_path_by_path(moves, draws, start_row, n_rows):
    """Do what `_fix_move_by_move` does, several times as fast if compiled, and as much slower if not."""
    fixed = moves.copy()
    for i in range(len(moves)):
        row = start_row
        for k in range(moves.shape[1]):
            target = row + moves[i, k]
            if target < 0 or target >= n_rows:
                room = n_rows - 1 - row if target >= n_rows else row
                step = 0
                if room > 0:
                    weight = draws[i, k] * (room * (room + 1) / 2)
                    step = min(max(int(np.floor((np.sqrt(8.0 * weight + 1.0) + 1.0) / 2.0)), 1), room)
                fixed[i, k] = step if target >= n_rows else -step
                target = row + fixed[i, k]
            row = target
    return fixed


def _fix_move_by_move(moves: np.ndarray, draws: np.ndarray, frame: MonotoneFrame) -> np.ndarray:
    """Mend the first offending move of every path in each round, since what follows shifts with it."""
    fixed = moves.copy()
    rows, outside = _rows_and_outside(fixed, frame)
    left = outside
    while len(left):
        beyond = (rows[outside] < 0) | (rows[outside] >= frame.n_rows)
        k = beyond.argmax(axis=1)
        target = rows[outside, k].astype(np.int64)
        row = target - fixed[left, k]
        up = target >= frame.n_rows
        step = _draw_linear(np.where(up, frame.n_rows - 1 - row, row), draws[left, k])
        fixed[left, k] = np.where(up, step, -step)
        rows, outside = _rows_and_outside(fixed[left], frame)
        left = left[outside]
    return fixed


def _draw_linear(room: np.ndarray, draw: np.ndarray) -> np.ndarray:
    """Return whole numbers from 1 to ``room`` with probabilities proportional to themselves; 0 where there is no room."""
    weight = draw * (room * (room + 1) / 2)
    # Number j is drawn for weights in [j (j - 1) / 2, j (j + 1) / 2).
    number = np.floor((np.sqrt(8.0 * weight + 1.0) + 1.0) / 2.0).astype(np.int64)
    return np.where(room > 0, np.clip(number, 1, np.maximum(room, 1)), 0)
