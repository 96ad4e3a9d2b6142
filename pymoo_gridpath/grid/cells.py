"""Which cells of a grid are occupied, and which of the others hang together."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike
from scipy import ndimage, sparse

from pymoo_gridpath.errors import GridError
from pymoo_gridpath.grid.arguments import CornerCutting, as_cell, as_cells, as_corner_cutting, as_moves
from pymoo_gridpath.grid.box import Box
from pymoo_gridpath.neighbourhood import SQRT2, Neighbourhood, neighbourhood_of


class Cells:
    """What an `OccupancyGrid` is before its cells have a place and a size; see there for the parameters."""

    def __init__(self, occupied: ArrayLike, corner_cutting: CornerCutting, unknown: ArrayLike | None, moves: int):
        self._occupied = as_cells("occupied", occupied)
        self._unknown = None if unknown is None else as_cells("unknown", unknown)
        if self._unknown is not None and self._unknown.shape != self.shape:
            raise GridError(f"unknown has the shape {self._unknown.shape}, expected that of the grid, {self.shape}")
        self._corner_cutting: CornerCutting = as_corner_cutting(corner_cutting)
        self._moves = as_moves(moves)

    @property
    def occupied(self) -> np.ndarray:
        """Occupied cells, bool, shape (height, width), read-only."""
        return self._occupied

    @property
    def unknown(self) -> np.ndarray | None:
        """Cells of which the map did not say whether they are free, bool, shape (height, width), read-only, or None."""
        return self._unknown

    @property
    def corner_cutting(self) -> CornerCutting:
        """Whether a diagonal step may touch an occupied cell: True, False, or "one side"."""
        return self._corner_cutting

    @property
    def moves(self) -> int:
        """How many neighbours a cell has: 8, or 4 where paths take no diagonal steps."""
        return self._moves

    @functools.cached_property
    def neighbourhood(self) -> Neighbourhood:
        """The steps, as the rule by which all that deals with paths goes."""
        return neighbourhood_of(self._moves, self._corner_cutting)

    @property
    def width(self) -> int:
        """Number of columns."""
        return self._occupied.shape[1]

    @property
    def height(self) -> int:
        """Number of rows."""
        return self._occupied.shape[0]

    @property
    def shape(self) -> tuple[int, int]:
        """``(height, width)``, the shape of arrays over this grid."""
        return self.height, self.width

    @property
    def n_occupied(self) -> int:
        """Number of occupied cells."""
        return int(np.count_nonzero(self._occupied))

    @functools.cached_property
    def digest(self) -> str:
        """SHA-256, in hexadecimal, of the size and of which cells are occupied; the one by which files and runs know a grid.

        Of the text ``"{width} {height} "`` and the cells, row by row from the bottom, eight a byte, the first highest.
        """
        cells = np.packbits(self._occupied).data
        return hashlib.sha256(b"".join((f"{self.width} {self.height} ".encode(), cells))).hexdigest()

    def contains(self, cell: Sequence[int]) -> bool:
        """Whether a cell lies on the grid."""
        x, y = as_cell("cell", cell)
        return 0 <= x < self.width and 0 <= y < self.height

    def is_free(self, cell: Sequence[int]) -> bool:
        """Whether a cell lies on the grid and is not occupied."""
        x, y = as_cell("cell", cell)
        return self.contains((x, y)) and not self._occupied[y, x]

    @functools.cached_property
    def regions(self) -> np.ndarray:
        """Label of the connected free region of each cell, shape (height, width); 0 where occupied.

        Where a diagonal step may pass between two occupied cells, regions are those of all eight moves. Elsewhere it joins but
        what the four straight ones do.
        """
        structure = np.ones((3, 3)) if self.neighbourhood.squeezes else None
        part = self._free_box.slices
        labels = np.zeros(self.shape, dtype=np.int32)
        labels[part] = ndimage.label(~self._occupied[part], structure=structure)[0]  # pyright: ignore
        labels.flags.writeable = False
        return labels

    @property
    def whole(self) -> Box:
        """The box of all cells."""
        return Box(0, 0, self.width, self.height)

    @functools.cached_property
    def _free_box(self) -> Box:
        """The bounding box of the free cells; all cells if none is free."""
        xs, ys = (np.flatnonzero(~self._occupied.all(axis=axis)) for axis in (0, 1))
        return Box(int(xs[0]), int(ys[0]), int(xs[-1]) + 1, int(ys[-1]) + 1) if len(xs) else self.whole

    @functools.cached_property
    def _region_slices(self) -> list:
        return ndimage.find_objects(self.regions[self._free_box.slices])

    def move_graph(self) -> sparse.csr_array:
        """Return the legal moves as a sparse graph, for `scipy.sparse.csgraph`.

        Returns
        -------
        scipy.sparse.csr_array, shape (height * width, height * width)
            Entry [a, b] is the length in cells of the step from cell a to cell b, 1 or sqrt(2); cell (x, y) has the index
            ``y * width + x``. Each step is listed in both directions.
        """
        free = ~self._occupied
        index = np.arange(free.size, dtype=np.int32).reshape(free.shape)  # what csgraph takes before scipy 1.15
        pairs, lengths = [], []

        def add(a, b, legal, length):
            pairs.append(np.stack([a[legal], b[legal]]))
            lengths.append(np.full(pairs[-1].shape[1], length))

        add(index[:, :-1], index[:, 1:], free[:, :-1] & free[:, 1:], 1.0)
        add(index[:-1, :], index[1:, :], free[:-1, :] & free[1:, :], 1.0)
        (low_left, low_right), (high_left, high_right) = ((rows[:, :-1], rows[:, 1:]) for rows in (free[:-1], free[1:]))
        rising = low_left & high_right & self.neighbourhood.may_pass(low_right, high_left)
        falling = high_left & low_right & self.neighbourhood.may_pass(low_left, high_right)
        add(index[:-1, :-1], index[1:, 1:], rising, SQRT2)
        add(index[1:, :-1], index[:-1, 1:], falling, SQRT2)
        (a, b), length = np.concatenate(pairs, axis=1), np.concatenate(lengths)
        rows, cols = np.concatenate([a, b]), np.concatenate([b, a])
        return sparse.csr_array((np.tile(length, 2), (rows, cols)), shape=(free.size, free.size))
