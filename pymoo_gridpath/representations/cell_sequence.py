"""The coding of any path: the cells that it visits."""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Sequence

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError, UnreachableError
from pymoo_gridpath.fields import BoxedField, check_costs, obstacle_potential
from pymoo_gridpath.grid import Box, OccupancyGrid
from pymoo_gridpath.neighbourhood import HEADINGS
from pymoo_gridpath.paths import CellPaths, Paths
from pymoo_gridpath.paths.cell import visited
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.representations.base import Representation, check_ends
from pymoo_gridpath.search import UNREACHABLE
from pymoo_gridpath.search.lengths import cells_of_shortest, cheapest_length
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.sequences import cut_loops, mend
from pymoo_gridpath.search.terrain import steps_through

# Of up to so many fields sums are looked at for the default length of a row: as many as an exact front has objectives.
_MOST_TOGETHER = 3

# More genes than any map has cells to visit; arrays of more would be of gigabytes.
MOST_GENES = 2**24


class CellSequence(Representation):
    """The genes are the cells that a path visits, in order, and the goal again to the end of the row.

    A path may lead anywhere, back and around included, which the monotone codings cannot say. Gene k is the index
    ``y * width + x`` of a cell; gene 0 is fixed to the start and the last one to the goal. A cell that follows itself counts
    once.

    Nearly no row of random genes is a path. Rows with jumps or occupied cells are measured by the rules of `CellPaths`,
    never as legal, and `repair` makes legal paths of them. Searches need operators that change whole stretches of a path;
    those that change single genes find nothing.

    Parameters
    ----------
    grid : OccupancyGrid
    start, goal : (int, int)
        Cells (x, y).
    max_cells : int, optional
        Genes of a row, the most cells that a path can visit. The default is the larger of two numbers, and no more than
        the free cells that can be reached. One is 1 more than the length of the shortest among the least vulnerable paths,
        room for every path that is not dominated in length and vulnerability: each step is at least 1 long, and a longer
        path would be dominated by that one. The other is 1.5 times the cells of a shortest
        path and 8 more.
    fields : sequence of numpy.ndarray, shape (height, width), optional
        Costs of cells, the sums of which paths are to be scored by; there is room then for the cheapest paths in each, and in
        any sum of them if there are two or three, rather than for the safest in the default potential. A problem that is given
        the representation by name or class passes those of its objectives.
    spare : float, default 1
        Factor on the default of ``max_cells``, 1 or more. Paths that turn little, and compromises between several fields, may
        be longer than the cheapest ones; `make_representation` passes 2 for problems with such objectives.
    backtracking : bool, default True
        Whether steps may lead away from the goal along x or y. If not, they lead towards it along one of these or both, a row
        has room for all such paths by default, and what goes back is no legal path: each step back is measured as an
        interfering cell.

    Raises
    ------
    GridError, UnreachableError
        If start or goal is no free cell, both are the same, or no path joins them.
    GridPathError
        If max_cells is no whole number, too small for a shortest path or over 16 million, a field has another shape or negative
        costs, spare is less than 1, or backtracking is neither True nor False.

    Attributes
    ----------
    max_cells : int

    Examples
    --------
    >>> grid = OccupancyGrid([[0, 0, 0], [0, 1, 0], [0, 0, 0]])
    >>> coding = CellSequence(grid, (2, 0), (2, 2), max_cells=8)
    >>> X = np.array([[2, 1, 0, 3, 6, 7, 8, 8]])
    >>> coding.decode(X).cells(0).tolist()
    [[2, 0], [1, 0], [0, 0], [0, 1], [0, 2], [1, 2], [2, 2]]
    >>> coding.from_sequences(coding.to_sequences(X)).tolist()
    [[2, 1, 0, 3, 6, 7, 8, 8]]
    """

    name = "cells"
    wants_fields = True
    max_cells: int

    def __init__(
        self,
        grid: OccupancyGrid,
        start: Sequence[int],
        goal: Sequence[int],
        max_cells: int | None = None,
        fields=(),
        spare: float = 1.0,
        backtracking: bool = True,
    ):
        super().__init__(grid, start, goal)
        self.backtracking = checks.flag("backtracking", backtracking)
        spare = checks.number("spare", spare, 1.0, expected="a factor of 1 or more")
        self.max_cells = _room(self, max_cells, fields, spare)
        self.n_var = self.max_cells
        self.xl = np.zeros(self.n_var, dtype=int)
        self.xu = np.full(self.n_var, grid.occupied.size - 1)
        self.xl[0] = self.xu[0] = self.start[1] * grid.width + self.start[0]
        self.xl[-1] = self.xu[-1] = self.goal[1] * grid.width + self.goal[0]

    @functools.cached_property
    def moves(self) -> Moves:
        """The legal steps: along all eight headings, or along those that do not go back."""
        if self._forward is None:
            return Moves(self.grid, box=self.box)
        towards = [(HEADINGS[:, k] == 0) | (HEADINGS[:, k] == self._forward[k]) for k in range(2)]
        return Moves(self.grid, np.flatnonzero(towards[0] & towards[1]).tolist(), self.box)

    @property
    def _forward(self) -> tuple[int, int] | None:
        """The signs of steps along x and y towards the goal, where none may go back."""
        if self.backtracking:
            return None
        dx, dy = np.sign(np.subtract(self.goal, self.start)).tolist()
        return dx, dy

    def decode(self, X: np.ndarray) -> CellPaths:
        """Return the paths that the rows of X code.

        Parameters
        ----------
        X : numpy.ndarray, shape (N, n_var)
            Genes. Real numbers are rounded to the nearest gene.

        Returns
        -------
        CellPaths
            N paths from the start to the goal, legal or not.
        """
        X = self._numbers(X)
        rows = X if X.dtype.kind == "i" else self.genes(X)
        return CellPaths._visiting(self.grid, visited(rows, self.xl, self.xu), self._forward)

    def encode(self, paths: Paths) -> np.ndarray:
        """Return the genes of paths of any representation, see `from_sequences`, int, shape (N, n_var)."""
        sequences = self._on_grid(paths).sequences
        return self._rows(check_ends(sequences, self, int(self.xl[0]), int(self.xl[-1]), self.grid.occupied.size))

    def from_sequences(self, sequences: Sequences) -> np.ndarray:
        """Return the rows of genes that code paths given by the cells that they visit.

        Parameters
        ----------
        sequences : Sequences
            N paths from the start to the goal. Of those that do not fit, loops are left out.

        Returns
        -------
        numpy.ndarray of int, shape (N, n_var)
            Padded with the goal.

        Raises
        ------
        GridPathError
            If a path leads from or to another cell, or has more than ``max_cells`` cells even without loops.
        """
        cells, offsets = self._checked_ends(sequences)
        return self._rows(Sequences(self.moves.to_grid(cells), offsets))

    def _rows(self, sequences: Sequences) -> np.ndarray:
        """Return the rows of genes that code paths given by the indices of cells in the whole grid."""
        fits = sequences.lengths <= self.max_cells
        if fits.all():
            return self._padded(sequences)
        X = np.empty((len(fits), self.n_var), dtype=np.int64)
        X[fits] = self._padded(sequences.take(fits))
        X[~fits] = self._padded(cut_loops(sequences.take(~fits), self.grid.occupied.size))
        return X

    def _padded(self, sequences: Sequences) -> np.ndarray:
        """Return the rows of paths, filled up with the goal."""
        lengths = sequences.lengths
        if (lengths > self.max_cells).any():
            raise GridPathError(
                f"a path visits {lengths.max()} cells, expected at most {self.max_cells}, the max_cells of the {self.name} "
                f"representation; give CellSequence a larger one"
            )
        X = np.full((len(lengths), self.n_var), self.xu[-1], dtype=np.int64)
        X[np.arange(self.n_var) < lengths[:, None]] = sequences.cells
        return X

    def repair(self, X: np.ndarray, random_state: np.random.Generator) -> np.ndarray:
        """Return X with rows rewritten that are no legal paths.

        Parameters
        ----------
        X : numpy.ndarray, shape (N, n_var)
        random_state : numpy.random.Generator
            Not drawn from.

        Returns
        -------
        numpy.ndarray of int, shape (N, n_var)
            A new array of legal paths, each with its pauses moved to the end. Of a row that was none, what can be followed is
            joined by shortest ways, see `pymoo_gridpath.search.sequences.mend`; if that does not fit into the row, it becomes a
            shortest path.
        """
        paths = self.decode(X)
        broken = paths.interfering_cells > 0
        repaired = np.empty((len(paths), self.n_var), dtype=np.int64)
        repaired[~broken] = self.encode(paths[~broken])
        if broken.any():
            ends = self.moves.index(self.start), self.moves.index(self.goal)
            repaired[broken] = self.from_sequences(mend(self._in_box(paths[broken]), self.moves, *ends, self.max_cells))
        return repaired


def _room(coding: CellSequence, max_cells: int | None, fields, spare: float) -> int:
    """Return ``max_cells``, checked, or its default."""
    grid, box = coding.grid, coding.box
    start, goal = coding.moves.index(coding.start), coding.moves.index(coding.goal)
    if coding.backtracking:
        least = cells_of_shortest(coding.moves, start, goal)
    else:
        least = 1 + int(steps_through(coding.moves, start, goal)[start])
        if least > UNREACHABLE:
            raise UnreachableError(
                f"every path from {coding.start} to {coding.goal} on the grid {checks.shown(grid.name)} goes back along x or "
                f"y, expected a query that can be solved without, or backtracking=True"
            )
        if max_cells is None:
            # Straight steps alone.
            return 1 + sum(abs(goal - start) for start, goal in zip(coding.start, coding.goal, strict=True))
    if max_cells is None:
        regions = grid.regions[box.slices]
        reachable = np.count_nonzero(regions == regions.flat[start])
        given = [
            field if isinstance(field, BoxedField) else check_costs("a field", field, grid)
            for field in checks.items("fields", fields, "costs of cells")
        ]
        fields = [_scaled(field, box, alone=len(given) == 1) for field in given] or [obstacle_potential(grid, box=box)]
        # Of several together, too: a path that costs nothing in either may be longer than those that cost nothing in one.
        sizes = range(1, 1 + (len(fields) if len(fields) <= _MOST_TOGETHER else 1))
        together = (functools.reduce(np.add, some) for n in sizes for some in itertools.combinations(fields, n))
        lengths = (cheapest_length(coding.moves, field.ravel(), start, goal) for field in together)
        safest = max(1 + math.floor(length + 1e-6) for length in lengths)
        return min(math.ceil(spare * max(safest, math.ceil(1.5 * least) + 8)), int(reachable))
    expected = f"a whole number of at least {least}, the cells of a shortest path"
    return checks.whole("max_cells", max_cells, least, MOST_GENES, expected=expected)


def _scaled(field: np.ndarray | BoxedField, box: Box, alone: bool) -> np.ndarray:
    """Return the part of a field in a box, relative to the largest cost of the whole grid.

    Where it stands ``alone``, the scale does not matter, and no other part need be known.
    """
    if isinstance(field, BoxedField) and alone:
        inside = whole = field.inside
    else:
        whole = np.asarray(field)
        inside = whole[box.slices]
    return inside / (whole.max() or 1.0)
