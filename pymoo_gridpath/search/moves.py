"""The legal steps of a grid as arrays that kernels read."""

from __future__ import annotations

import copy
from collections.abc import Iterable

import numpy as np

from pymoo_gridpath.grid import OccupancyGrid

#: The step (dx, dy) of each heading, counter-clockwise from the right in steps of 45 degrees; odd ones are diagonal.
HEADINGS = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)])

#: The heading of a step (dx, dy) at [dy + 1, dx + 1].
HEADING_OF = np.full((3, 3), -1)
HEADING_OF[HEADINGS[:, 1] + 1, HEADINGS[:, 0] + 1] = np.arange(8)

#: Whether each heading is diagonal.
DIAGONAL = np.arange(8) % 2 == 1


def turn_units() -> np.ndarray:
    """Return the turn between headings in units of 45 degrees, int, shape (9, 8); row 8 is for a path that just starts."""
    apart = np.abs(np.arange(8)[:, None] - np.arange(8)[None, :])
    return np.concatenate([np.minimum(apart, 8 - apart), np.zeros((1, 8), dtype=int)])


def taken_backwards(legal: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """Return the legal steps that lead back along others; see `Moves` for both arrays."""
    back = np.zeros_like(legal)
    for m in range(8):
        leads = np.flatnonzero(legal >> np.uint8(m) & 1)
        back[leads + offsets[m]] |= np.uint8(1 << (m + 4) % 8)
    return back


class Moves:
    """The legal steps from each cell of a grid.

    Cell (x, y) has the index ``y * width + x``, as in `OccupancyGrid.move_graph`.

    Parameters
    ----------
    grid : OccupancyGrid
    headings : iterable of int, optional
        Indices into `HEADINGS` of the steps to allow; all eight by default.

    Attributes
    ----------
    legal : numpy.ndarray of uint8, shape (n_cells,)
        Bit m is set where the step along heading m stays on the grid, ends in a free cell and cuts no corner that the grid
        forbids to cut. No bit is set in occupied cells.
    offsets : numpy.ndarray of int64, shape (8,)
        What each step adds to the index of a cell.
    """

    def __init__(self, grid: OccupancyGrid, headings: Iterable[int] = range(8)):
        self.width, self.height = grid.width, grid.height
        # A rim of occupied cells stands for the edge of the grid.
        free = np.pad(~grid.occupied, 1)
        legal = np.zeros(grid.shape, dtype=np.uint8)
        for m in headings:
            dx, dy = HEADINGS[m]
            possible = self._shifted(free, 0, 0) & self._shifted(free, dx, dy)
            if dx and dy and not grid.corner_cutting:
                possible &= self._shifted(free, dx, 0) & self._shifted(free, 0, dy)
            legal |= possible.astype(np.uint8) << np.uint8(m)
        self.legal = legal.ravel()
        self.offsets = (HEADINGS[:, 1] * grid.width + HEADINGS[:, 0]).astype(np.int64)

    def _shifted(self, padded: np.ndarray, dx: int, dy: int) -> np.ndarray:
        return padded[1 + dy : 1 + dy + self.height, 1 + dx : 1 + dx + self.width]

    def backward(self) -> Moves:
        """Return the steps that lead back: along the opposite heading wherever a step leads forth."""
        back = copy.copy(self)
        back.legal = taken_backwards(self.legal, self.offsets)
        return back

    def within(self, usable: np.ndarray) -> Moves:
        """Return the steps that lead from and to usable cells, bool, shape (n_cells,)."""
        kept = copy.copy(self)
        kept.legal = np.zeros_like(self.legal)
        for m in range(8):
            leads = np.flatnonzero((self.legal >> np.uint8(m) & 1).astype(bool) & usable)
            leads = leads[usable[leads + self.offsets[m]]]
            kept.legal[leads] |= np.uint8(1 << m)
        return kept

    @property
    def n_cells(self) -> int:
        """Number of cells of the grid."""
        return self.width * self.height

    def index(self, cell) -> int:
        """Return the index of a cell (x, y)."""
        return int(cell[1]) * self.width + int(cell[0])

    def cells(self, index: np.ndarray) -> np.ndarray:
        """Return the cells (x, y) of indices, shape (..., 2)."""
        return np.stack([index % self.width, index // self.width], axis=-1)
