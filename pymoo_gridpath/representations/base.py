"""What every path representation offers, and the parts that the monotone ones share."""

from __future__ import annotations

import functools
from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.checks import shown
from pymoo_gridpath.compiled import COMPILED, kernel
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.fields import BoxedField, check_field
from pymoo_gridpath.grid import Box, Cell, OccupancyGrid
from pymoo_gridpath.neighbourhood import HEADINGS
from pymoo_gridpath.paths import CellPaths, ColumnPaths
from pymoo_gridpath.paths.frame import Axis, MonotoneFrame
from pymoo_gridpath.paths.sequences import Sequences, check_sequences
from pymoo_gridpath.search.moves import Moves


class Representation(ABC):
    """A coding of paths as rows of a decision matrix.

    Attributes
    ----------
    name : str
        What the representation is called by name.
    vtype : type
        ``int`` or ``bool``, the type of a gene.
    n_var : int
        Number of genes.
    xl, xu : numpy.ndarray of int, shape (n_var,)
        Bounds of the genes, both included.
    grid : OccupancyGrid
    start, goal : (int, int)
        The query that it codes paths for.
    codes_detours : bool
        Whether a path that takes two steps where a single one leads has a code, too.
    """

    codes_detours = True
    name: str
    vtype: type
    n_var: int
    xl: np.ndarray
    xu: np.ndarray
    grid: OccupancyGrid
    start: Cell
    goal: Cell

    @functools.cached_property
    def box(self) -> Box:
        """The part of the grid in which legal paths lie, see `OccupancyGrid.box_of`; searches work on it alone."""
        return self.grid.box_of(self.start)

    @property
    @abstractmethod
    def moves(self) -> Moves:
        """The legal steps of the paths that can be coded, in the `box`."""

    @abstractmethod
    def from_sequences(self, sequences: Sequences) -> np.ndarray:
        """Return the rows of genes that code paths given by the cells that they visit.

        Parameters
        ----------
        sequences : Sequences
            N paths from the start to the goal, by the indices of cells that `moves` has.

        Returns
        -------
        numpy.ndarray, shape (N, n_var), dtype `vtype`

        Raises
        ------
        GridPathError
            If one of them has no code.
        """

    def fits(self, sequences: Sequences) -> np.ndarray:
        """Return which paths are no longer than a row can code, bool, shape (N,); all, unless rows have limited room."""
        return np.ones(len(check_sequences(sequences, self.moves.n_cells).lengths), dtype=bool)

    def to_sequences(self, X: np.ndarray) -> Sequences:
        """Return the cells that the decoded paths visit, the inverse of `from_sequences`.

        Parameters
        ----------
        X : numpy.ndarray, shape (N, n_var)

        Returns
        -------
        Sequences
            N paths, by the indices of cells that `moves` has, -1 for those outside the box; no cell follows itself but these.
        """
        return self._in_box(self.decode(X))

    def _checked_ends(self, sequences: Sequences) -> Sequences:
        return check_ends(sequences, self, self.moves.index(self.start), self.moves.index(self.goal), self.moves.n_cells)

    def _in_box(self, paths) -> Sequences:
        """Return the cells that decoded paths visit by the indices that `moves` has."""
        cells, offsets = paths.sequences
        return Sequences(self.moves.from_grid(cells), offsets)

    @abstractmethod
    def decode(self, X: np.ndarray) -> ColumnPaths | CellPaths:
        """Return the paths that rows of genes code, without drawing a random number.

        Parameters
        ----------
        X : numpy.ndarray, shape (N, n_var)

        Returns
        -------
        ColumnPaths or CellPaths
            N paths.
        """

    @abstractmethod
    def encode(self, paths) -> np.ndarray:
        """Return the rows of genes that code paths.

        Parameters
        ----------
        paths : ColumnPaths or CellPaths
            N paths, as `decode` returns them.

        Returns
        -------
        numpy.ndarray, shape (N, n_var), dtype `vtype`
        """

    @abstractmethod
    def prepare(self, field: np.ndarray | BoxedField) -> np.ndarray | BoxedField:
        """Return a field over the grid in the form that ``paths.total`` wants.

        Parameters
        ----------
        field : numpy.ndarray, shape (height, width)

        Returns
        -------
        numpy.ndarray
        """

    @abstractmethod
    def repair(self, X: np.ndarray, random_state: np.random.Generator) -> np.ndarray:
        """Return X with genes rewritten where they code what is no path: one that leaves the grid, or one with gaps."""

    def genes(self, X: np.ndarray) -> np.ndarray:
        """Return X as int64 within the bounds; real numbers, from operators that know no integers, are rounded.

        Raises
        ------
        GridPathError
            If X has another number of columns or holds what is no number.
        """
        expected = f"rows of {self.n_var} genes of the {self.name} representation"
        X = np.atleast_2d(checks.array("X", X, kinds="biufO", expected=expected))
        if X.ndim != 2:
            raise GridPathError(f"X is {shown(X)}, expected {expected}")
        if X.shape[1] != self.n_var:
            raise GridPathError(f"X has {X.shape[1]} columns, expected {self.n_var} genes of the {self.name} representation")
        if X.dtype.kind == "b" and self.vtype is bool:
            return X.astype(np.int64, order="C")
        if X.dtype.kind not in "biu":
            try:
                X = X.astype(float)
            except (TypeError, ValueError, OverflowError):
                X = np.full(X.shape, np.nan)
            if not np.isfinite(X).all():
                raise GridPathError(
                    f"X holds values that are no finite numbers, expected genes of the {self.name} representation"
                )
            X = np.rint(X)
        return np.clip(X, self.xl, self.xu).astype(np.int64, order="C", copy=False)


def representation_of(problem) -> Representation:
    """Return the representation of a path problem, or raise a GridPathError if it is none."""
    representation = getattr(problem, "representation", None)
    if not isinstance(representation, Representation):
        raise GridPathError(f"the problem is of the class {type(problem).__name__}, expected a path problem: GridPathProblem")
    return representation


def max_cells(problem) -> int:
    """Return the most cells that a path of the problem's representation can visit."""
    representation = problem.representation
    return getattr(representation, "max_cells", representation.moves.n_cells)


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

    codes_detours = False

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
        return ColumnPaths(frame, row[enters].astype(np.int32).reshape(shape), row[leaves].astype(np.int32).reshape(shape))

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


def check_ends(sequences: Sequences, representation: Representation, first: int, last: int, n_cells: int) -> Sequences:
    """Return sequences if each leads from the start to the goal of a representation, the cells first and last of n_cells.

    Raises
    ------
    GridPathError
    """
    sequences = check_sequences(sequences, n_cells)
    cells, offsets, lengths = *sequences, sequences.lengths
    if (lengths < 1).any() or (cells[offsets[:-1]] != first).any() or (cells[offsets[1:] - 1] != last).any():
        raise GridPathError(
            f"a path leads between other cells than start {representation.start} and goal {representation.goal}, "
            f"expected paths of the query"
        )
    return sequences


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
