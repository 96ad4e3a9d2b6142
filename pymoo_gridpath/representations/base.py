"""What every path representation offers, and the parts that the monotone ones share."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.frame import Axis, MonotoneFrame
from pymoo_gridpath.grid import Cell, OccupancyGrid
from pymoo_gridpath.paths import ColumnPaths


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
    """

    name: str
    vtype: type
    n_var: int
    xl: np.ndarray
    xu: np.ndarray
    grid: OccupancyGrid
    start: Cell
    goal: Cell

    @abstractmethod
    def decode(self, X: np.ndarray) -> ColumnPaths:
        """Return the paths that rows of genes code, without drawing a random number.

        Parameters
        ----------
        X : numpy.ndarray, shape (N, n_var)

        Returns
        -------
        ColumnPaths
            N paths.
        """

    @abstractmethod
    def encode(self, paths) -> np.ndarray:
        """Return the rows of genes that code paths.

        Parameters
        ----------
        paths : ColumnPaths
            N paths.

        Returns
        -------
        numpy.ndarray, shape (N, n_var), dtype `vtype`
        """

    @abstractmethod
    def prepare(self, field: np.ndarray) -> np.ndarray:
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
        """Return X with genes rewritten where a path would leave the grid."""

    def genes(self, X: np.ndarray) -> np.ndarray:
        """Return X as int64 within the bounds; real numbers, from operators that know no integers, are rounded.

        Raises
        ------
        GridPathError
            If X has another number of columns or holds what is no number.
        """
        X = np.atleast_2d(X)
        if X.shape[1] != self.n_var:
            raise GridPathError(f"X has {X.shape[1]} columns, expected {self.n_var} genes of the {self.name} representation")
        if X.dtype.kind == "b":
            return X.astype(np.int64)
        if X.dtype.kind not in "iu":
            X = X.astype(float)
            if not np.isfinite(X).all():
                raise GridPathError(
                    f"X holds values that are no finite numbers, expected genes of the {self.name} representation"
                )
            X = np.rint(X)
        return np.clip(X, self.xl, self.xu).astype(np.int64, copy=False)


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

    def __init__(self, grid: OccupancyGrid, start: Sequence[int], goal: Sequence[int], axis: Axis = "auto"):
        self.frame = MonotoneFrame(grid, start, goal, axis)
        self.grid, self.start, self.goal = grid, self.frame.start, self.frame.goal

    def prepare(self, field: np.ndarray) -> np.ndarray:
        """Return a field over the grid as prefix sums up each column of the frame."""
        return self.frame.prefix_sums(field)

    @property
    def _n_moves(self) -> int:
        """Number of coded moves: the climb in the start column and every step but the last."""
        return self.frame.n_columns - 1

    @abstractmethod
    def moves(self, X: np.ndarray) -> np.ndarray:
        """Return the rows gained by each coded move, int, shape (N, n_columns - 1); move 0 is the climb at the start."""

    def exit_rows(self, X: np.ndarray) -> np.ndarray:
        """Return the row at which each column but the last is left, int, shape (N, n_columns - 1).

        A move that would leave the grid ends at the edge, without drawing a number.
        """
        return _rows_within(self.moves(X), self.frame)

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
        return ColumnPaths.through(self.frame, self.exit_rows(X))

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
        X = self.genes(X).astype(self.vtype)
        moves = self.moves(X)
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
    fixed = moves.copy()
    draws = random_state.random(moves.shape)
    # Each round mends the first offending move of every path, since what follows shifts with it.
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
