"""What every path representation offers."""

from __future__ import annotations

import functools
from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.checks import shown
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.fields import BoxedField, check_field
from pymoo_gridpath.grid import Box, Cell, OccupancyGrid, check_grid
from pymoo_gridpath.paths import Paths, check_paths
from pymoo_gridpath.paths.sequences import Sequences, check_sequences
from pymoo_gridpath.registry import Registry
from pymoo_gridpath.search.moves import Moves


class Representation(ABC):
    """A coding of paths as rows of a decision matrix.

    One of your own needs `decode` and `from_sequences`, a name, and a constructor that calls this one and sets `n_var`, `xl`
    and `xu`. All else follows from these, and may be overridden where the coding knows better or faster.
    `pymoo_gridpath.testing.RepresentationSuite` tests it; `pymoo_gridpath.registry.register` makes it known by its name.

    Parameters
    ----------
    grid : OccupancyGrid
    start, goal : (int, int)
        Free cells (x, y) that a path joins.

    Raises
    ------
    GridError, UnreachableError
        If start or goal is no free cell, both are the same, or no path joins them.

    Attributes
    ----------
    name : str
        What the representation is called by name.
    vtype : type
        ``int`` (the default), ``bool`` or ``float``, the type of a gene.
    n_var : int
        Number of genes.
    xl, xu : numpy.ndarray, shape (n_var,)
        Bounds of the genes, both included.
    grid : OccupancyGrid
    start, goal : (int, int)
        The query that it codes paths for.
    max_cells : int or None
        The most cells that a path can visit, None (the default) if a row has room for every path.
    paper : bool
        Whether its default operators are those of Ahmed and Deb (2013), `paper_operators`, rather than `path_operators`.
    monotone : bool
        Whether its paths advance along an axis, which its constructor takes as ``axis``.
    codes_detours : bool
        Whether a path that takes two steps where a single one leads has a code, too.
    codes_all : bool
        Whether each legal path along its `moves` but such detours has a code, if a row has room for it; else `fits` says which
        have, `path_operators` are not for it, and there is no exact front of what it can say.
    wants_fields : bool
        Whether its constructor takes ``fields``, the costs of cells that paths are to be scored by, and ``spare``, by what
        factor paths worth coding may be longer than the cheapest, see `make_representation`.
    backtracking : bool
        Whether steps of its paths may lead away from the goal along x or y; if not, each that does counts as an interfering
        cell.
    timed : bool
        Whether its paths are paths in time, a cell a tick, as those of `TimedPaths`.

    Examples
    --------
    The headings of the steps, and 8 to stay; a row that does not lead to the goal jumps there at its end:

    >>> from pymoo_gridpath.neighbourhood import HEADING_OF, HEADINGS
    >>> from pymoo_gridpath.paths import CellPaths
    >>> class Headings(Representation):
    ...     name = "headings"
    ...
    ...     def __init__(self, grid, start, goal):
    ...         super().__init__(grid, start, goal)
    ...         self.n_var = self.max_cells = self.moves.n_cells
    ...         self.xl, self.xu = np.zeros(self.n_var, dtype=int), np.full(self.n_var, 8)
    ...
    ...     def decode(self, X):
    ...         steps = np.vstack([HEADINGS, [[0, 0]]])[self.genes(X)]
    ...         cells = np.clip(self.start + np.cumsum(steps, axis=1), 0, [self.grid.width - 1, self.grid.height - 1])
    ...         ends = np.broadcast_to([[self.start], [self.goal]], (2, len(cells), 2))
    ...         x, y = np.moveaxis(np.concatenate([ends[0][:, None], cells, ends[1][:, None]], axis=1), 2, 0)
    ...         return CellPaths(self.grid, y * self.grid.width + x)
    ...
    ...     def from_sequences(self, sequences):
    ...         cells = self.moves.cells(sequences.cells)
    ...         X = np.full((len(sequences.lengths), self.n_var), 8)
    ...         for row, first, end in zip(X, sequences.offsets, sequences.offsets[1:]):
    ...             dx, dy = np.diff(cells[first:end], axis=0).T
    ...             row[: len(dx)] = HEADING_OF[dy + 1, dx + 1]
    ...         return X
    >>> from pymoo_gridpath.problems import GridPathProblem
    >>> grid = OccupancyGrid([[0, 0, 0], [0, 1, 0], [0, 0, 0]])
    >>> problem = GridPathProblem(grid, (2, 0), (2, 2), Headings)
    >>> problem.pareto_set().tolist()
    [[2, 2, 8, 8, 8, 8, 8, 8, 8]]
    """

    name: str
    vtype: type = int
    n_var: int
    xl: np.ndarray
    xu: np.ndarray
    max_cells: int | None = None
    paper: bool = False
    monotone: bool = False
    codes_detours: bool = True
    codes_all: bool = True
    wants_fields: bool = False
    backtracking: bool = True
    timed: bool = False

    def __init__(self, grid: OccupancyGrid, start: Sequence[int], goal: Sequence[int]):
        self.grid: OccupancyGrid = check_grid(grid)
        self.start: Cell
        self.goal: Cell
        self.start, self.goal = grid.check_query(start, goal)

    # -- what every coding has of its own -----------------------------------------------------------------------------

    @abstractmethod
    def decode(self, X: np.ndarray) -> Paths:
        """Return the paths that rows of genes code, without drawing a random number.

        Parameters
        ----------
        X : numpy.ndarray, shape (N, n_var)
            Not changed; `genes` checks them, and rounds real numbers.

        Returns
        -------
        Paths
            N paths, legal or not; those that are legal lead from the start to the goal.
        """

    @abstractmethod
    def from_sequences(self, sequences: Sequences) -> np.ndarray:
        """Return the rows of genes that code paths given by the cells that they visit.

        Parameters
        ----------
        sequences : Sequences
            N paths from the start to the goal, by the indices of cells that `moves` has; its ``cells`` returns them as (x, y).

        Returns
        -------
        numpy.ndarray, shape (N, n_var), dtype `vtype`
            The same paths, or else such as are no longer and visit no other cell. One path has one row, so that duplicates are
            found by their genes.

        Raises
        ------
        GridPathError
            If one of them has no code.
        """

    # -- what follows from that -----------------------------------------------------------------------------------------

    @functools.cached_property
    def box(self) -> Box:
        """The part of the grid in which legal paths lie, see `OccupancyGrid.box_of`; searches work on it alone."""
        return self.grid.box_of(self.start)

    @functools.cached_property
    def moves(self) -> Moves:
        """The legal steps of the paths that can be coded, in the `box`; all eight headings by default."""
        return Moves(self.grid, box=self.box)

    def fits(self, sequences: Sequences) -> np.ndarray:
        """Return which paths have a code, bool, shape (N,); by default those of no more than `max_cells`."""
        lengths = check_sequences(sequences, self.moves.n_cells).lengths
        return np.ones(len(lengths), dtype=bool) if self.max_cells is None else lengths <= self.max_cells

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

    def encode(self, paths: Paths) -> np.ndarray:
        """Return the rows of genes that code paths, see `from_sequences`.

        Parameters
        ----------
        paths : Paths
            N paths from the start to the goal, in the `box`.

        Returns
        -------
        numpy.ndarray, shape (N, n_var), dtype `vtype`

        Raises
        ------
        GridPathError
            If they are of another grid, lead between other cells, or have no code.
        """
        return self.from_sequences(self._checked_ends(self._in_box(self._on_grid(paths))))

    def prepare(self, field: np.ndarray | BoxedField) -> np.ndarray | BoxedField:
        """Return a field over the grid in the form that ``paths.total`` wants.

        Parameters
        ----------
        field : numpy.ndarray, shape (height, width)

        Returns
        -------
        numpy.ndarray of float
            By default by the index of the cell, shape (height * width,).
        """
        if isinstance(field, BoxedField):
            return field
        return check_field("field", field, self.grid).astype(float).ravel()

    def repair(self, X: np.ndarray, random_state: np.random.Generator) -> np.ndarray:
        """Return X with genes rewritten by what rules the coding has for rows that are no paths; `PathRepair` mends the rest.

        Parameters
        ----------
        X : numpy.ndarray, shape (N, n_var)
        random_state : numpy.random.Generator
            The only source of randomness.

        Returns
        -------
        numpy.ndarray, shape (N, n_var), dtype `vtype`
            A new array. By default the genes within their bounds, whatever they code.
        """
        return self.genes(X).astype(self.vtype)

    def genes(self, X: np.ndarray) -> np.ndarray:
        """Return X as numbers within the bounds; real ones, from operators that know no integers, are rounded to int64.

        Where `vtype` is float they stay as they are.

        Raises
        ------
        GridPathError
            If X has another number of columns or holds what is no number.
        """
        X = self._numbers(X)
        if X.dtype.kind == "b" and self.vtype is bool:
            return X.astype(np.int64, order="C")
        kind = float if self.vtype is float else np.int64
        # What `numpy.clip` does, in less time.
        within = np.maximum(X, self.xl)
        return np.minimum(within, self.xu, out=within, casting="unsafe").astype(kind, order="C", copy=False)

    # -- what codings use -------------------------------------------------------------------------------------------------

    def _numbers(self, X: np.ndarray) -> np.ndarray:
        """Return X as numbers of whatever size, real ones rounded, but not if `vtype` is float."""
        expected = f"rows of {self.n_var} genes of the {self.name} representation"
        X = np.atleast_2d(checks.array("X", X, kinds="biufO", expected=expected))
        if X.ndim != 2:
            raise GridPathError(f"X is {shown(X)}, expected {expected}")
        if X.shape[1] != self.n_var:
            raise GridPathError(f"X has {X.shape[1]} columns, expected {self.n_var} genes of the {self.name} representation")
        if X.dtype.kind not in "biu":
            try:
                X = X.astype(float)
            except (TypeError, ValueError, OverflowError):
                X = np.full(X.shape, np.nan)
            if not np.isfinite(X).all():
                raise GridPathError(
                    f"X holds values that are no finite numbers, expected genes of the {self.name} representation"
                )
            return X if self.vtype is float else np.rint(X)
        return X

    def _checked_ends(self, sequences: Sequences) -> Sequences:
        return check_ends(sequences, self, self.moves.index(self.start), self.moves.index(self.goal), self.moves.n_cells)

    def _on_grid(self, paths: Paths) -> Paths:
        """Return paths if they are of the grid."""
        check_paths(paths)
        if paths.grid is not self.grid and paths.grid != self.grid:
            raise GridPathError(f"paths are of another grid than the {self.name} representation, expected its own")
        return paths

    def _in_box(self, paths: Paths) -> Sequences:
        """Return the cells that decoded paths visit by the indices that `moves` has."""
        cells, offsets = paths.sequences
        return Sequences(self.moves.from_grid(cells), offsets)


#: The representations by name, those that are registered or of installed packages included.
REPRESENTATIONS: Registry[type[Representation]] = Registry("representation", "pymoo_gridpath.representations", Representation)


def check_representation(representation: Representation) -> Representation:
    """Return a representation if its constructor has set all that it must."""
    kind = type(representation).__name__
    for key in ("name", "n_var", "xl", "xu", "grid", "start", "goal"):
        if not hasattr(representation, key):
            raise GridPathError(f"the representation {kind} does not have {key!r}; expected its class or constructor to set it")
    if representation.vtype not in (int, bool, float):
        raise GridPathError(f"vtype of the representation {kind} is {shown(representation.vtype)}, expected int, bool or float")
    shapes = np.shape(representation.xl), np.shape(representation.xu)
    if shapes != ((representation.n_var,),) * 2:
        raise GridPathError(
            f"xl and xu of the representation {kind} have the shapes {shapes[0]} and {shapes[1]}, expected a bound for each of "
            f"its {representation.n_var} genes"
        )
    return representation


def representation_of(problem) -> Representation:
    """Return the representation of a path problem, or raise a GridPathError if it is none."""
    representation = getattr(problem, "representation", None)
    if not isinstance(representation, Representation):
        raise GridPathError(f"the problem is of the class {type(problem).__name__}, expected a path problem: GridPathProblem")
    return representation


def max_cells(problem) -> int:
    """Return the most cells that a path of the problem's representation can visit."""
    representation = problem.representation
    return representation.moves.n_cells if representation.max_cells is None else representation.max_cells


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
