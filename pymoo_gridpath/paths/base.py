"""What a batch of decoded paths is, with measures computed from the cells that the paths visit."""

from __future__ import annotations

import functools
from abc import ABC, abstractmethod
from typing import Any

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.fields import BoxedField
from pymoo_gridpath.grid import SQRT2, OccupancyGrid, check_grid
from pymoo_gridpath.neighbourhood import TURN_UNIT
from pymoo_gridpath.paths.counts import Counts, counts_of, headings_of, steps_of, sums_of
from pymoo_gridpath.paths.sequences import Sequences, check_sequences


class Paths(ABC):
    """N paths on a grid, and what they measure.

    What a representation decodes to. A class of paths of your own needs `grid` and `sequences`; every measure is computed from
    these, unless the class knows a faster way. For paths that are at hand as sequences there is `SequencePaths`.

    Paths need not be legal; they are measured by these rules, and only a legal path has no interfering cell. The way between
    two cells that are no neighbours, a *jump*, is as long as the shortest way between them on an empty grid: with ``a >= b``
    the distances along the two axes, b diagonal and ``a - b`` straight steps. It counts as ``a - 1`` interfering cells, those
    that it leaves out, and its heading is that of the signs of its dx and dy: straight along an axis, or else diagonal. Only
    cells in the sequence are visited. On a grid without diagonal steps one leaves out a cell, and is as long as elsewhere.

    Attributes
    ----------
    grid : OccupancyGrid
        May be a property.
    """

    grid: OccupancyGrid

    @property
    @abstractmethod
    def sequences(self) -> Sequences:
        """The cells that the paths visit, in order, as `Sequences` of cells of the whole grid.

        Every path visits a cell, and none follows itself. Measures ask for it again and again: a ``functools.cached_property``.
        """

    def __len__(self) -> int:
        return len(self.sequences.offsets) - 1

    def __getitem__(self, index) -> Paths:
        """Return the paths at a slice, a mask or an array of indices."""
        return SequencePaths(self.grid, self.sequences.take(check_chosen(index, len(self))))

    @functools.cached_property
    def _counts(self) -> Counts:
        return counts_of(self.sequences, self.grid)

    @property
    def n_diagonal(self) -> np.ndarray:
        """Number of diagonal steps, int, shape (N,)."""
        return self._counts.diagonal

    @property
    def n_straight(self) -> np.ndarray:
        """Number of horizontal and vertical steps, int, shape (N,)."""
        return self._counts.straight

    @property
    def length(self) -> np.ndarray:
        """Length in cells: straight steps count 1, diagonal ones sqrt(2); float, shape (N,)."""
        return self.n_straight + SQRT2 * self.n_diagonal

    @property
    def turn(self) -> np.ndarray:
        """Total turn in degrees, the sum of the absolute heading changes along the path; int, shape (N,)."""
        return TURN_UNIT * self._counts.turns

    def total(self, field: np.ndarray | BoxedField) -> np.ndarray:
        """Return the sum of a field over the visited cells, start and goal included.

        Parameters
        ----------
        field : numpy.ndarray, shape (height * width,)
            By the index of the cell, as `Representation.prepare` returns it.

        Returns
        -------
        numpy.ndarray, shape (N,)
        """
        cells, offsets = self.sequences
        return sums_of(check_summed(field, (self.grid.occupied.size,)).take(cells), offsets)

    def moves_total(self, enter: np.ndarray) -> np.ndarray:
        """Return the sum of the costs of the steps.

        A step costs what it costs to enter the cell where it ends along its heading, whether or not it is legal. A jump is one
        step along the heading of the signs of its dx and dy.

        Parameters
        ----------
        enter : numpy.ndarray, shape (8, height, width)
            By [heading, y, x] of the cell entered; row k is for the k-th of `pymoo_gridpath.neighbourhood.HEADINGS`.

        Returns
        -------
        numpy.ndarray, shape (N,)
        """
        expected = "a cost for each heading and cell, as an objective's moves returns them"
        enter = checks.array("enter", enter, (8, *self.grid.shape), expected=expected)
        cells, offsets = self.sequences
        heading = headings_of(*steps_of(self.sequences, self.grid.width))
        costs = np.zeros(len(cells), dtype=enter.dtype)
        costs[1:] = enter.take(heading[:-1].astype(np.int64) * self.grid.occupied.size + cells[1:])
        # The start is not entered.
        costs[offsets[:-1]] = 0
        return sums_of(costs, offsets)

    @property
    def mover_distance(self) -> np.ndarray:
        """Least distance from an obstacle that moves, in cells, float, shape (N,): infinite for paths that know of none."""
        return np.full(len(self), np.inf)

    @property
    def interfering_cells(self) -> np.ndarray:
        """Number of occupied cells that each path crosses, int, shape (N,); a legal path has 0, and no other has.

        Where the grid forbids to cut corners, an occupied cell beside a diagonal step counts as crossed by that step; where it
        allows to do so on one side, both do if both are occupied. A jump counts one for each cell that it leaves out, and so
        does a diagonal step where there are none.
        """
        return self._counts.interfering

    def cells(self, index: int) -> np.ndarray:
        """Return the grid cells (x, y) of one path in the order in which it visits them, int, shape (n_cells, 2)."""
        index = check_place(index, len(self))
        cells, offsets = self.sequences
        visited = cells[offsets[index] : offsets[index + 1]]
        return np.stack([visited % self.grid.width, visited // self.grid.width], axis=-1)


class SequencePaths(Paths):
    """N paths given by the cells that they visit.

    Parameters
    ----------
    grid : OccupancyGrid
    sequences : Sequences
        Indices of cells, ``y * width + x``, at least one a path. A cell that follows itself counts once: it is a pause.

    Raises
    ------
    GridPathError
        If a path visits no cell, or one that is not on the grid.

    Examples
    --------
    >>> grid = OccupancyGrid([[0, 0, 0], [0, 1, 0], [0, 0, 0]])
    >>> paths = SequencePaths(grid, Sequences(np.array([0, 1, 2, 5, 8, 0, 4, 8]), np.array([0, 5, 8])))
    >>> paths.length.round(3).tolist(), paths.turn.tolist(), paths.interfering_cells.tolist()
    ([4.0, 2.828], [90, 0], [0, 1])
    """

    def __init__(self, grid: OccupancyGrid, sequences: Sequences):
        self.grid = check_grid(grid)
        cells, offsets = check_sequences(sequences, grid.width * grid.height)
        if not (np.diff(offsets) > 0).all():
            raise GridPathError("a path of the sequences visits no cell, expected at least one")
        moved = np.ones(len(cells), dtype=bool)
        np.not_equal(cells[1:], cells[:-1], out=moved[1:])
        moved[offsets[:-1]] = True
        if not moved.all():
            cells, offsets = cells[moved], np.concatenate([[0], np.cumsum(moved)])[offsets]
        self._sequences = Sequences(cells, offsets)

    @property
    def sequences(self) -> Sequences:
        """The cells that the paths visit, in order, none following itself."""
        return self._sequences


def check_paths(paths: Paths) -> Paths:
    """Return a batch of decoded paths if it is one."""
    return checks.instance("paths", paths, Paths, ", as decode returns them")


def check_summed(field: np.ndarray | BoxedField, *shapes: tuple[int, ...]) -> Any:
    """Return a prepared field if it has one of the shapes, or is known in a box."""
    if isinstance(field, BoxedField) or (type(field) is np.ndarray and field.shape in shapes and field.dtype.kind in "iuf"):
        return field
    expected = f"numbers of shape {' or '.join(map(str, shapes))}, as the representation prepares them"
    field = checks.array("field", field, expected=expected)
    if field.shape not in shapes:
        raise GridPathError(f"field is {checks.shown(field)}, expected {expected}")
    return field


def check_chosen(index, n_paths: int):
    """Return a slice, a mask or an array of indices if it chooses among so many paths."""
    if isinstance(index, slice):
        return index
    expected = f"a slice, a mask or an array of indices of {n_paths} paths"
    chosen = checks.array("index", index, (None,), "biu", expected=expected)
    if chosen.dtype.kind == "b" and len(chosen) == n_paths:
        return chosen
    if chosen.dtype.kind == "b" or not checks.within(chosen, -n_paths, n_paths - 1):
        raise IndexError(f"index is {checks.shown(index)}, expected {expected}")
    return chosen.astype(np.int64, copy=False)


def check_place(index: int, n_paths: int) -> int:
    """Return the index of one path, counted from the end where it is negative, from the start."""
    return checks.whole("index", index, -n_paths, n_paths - 1) % n_paths
