"""The legal steps of a grid as arrays that kernels read."""

from __future__ import annotations

import copy
from collections.abc import Iterable

import numpy as np

from pymoo_gridpath.grid import Box, OccupancyGrid
from pymoo_gridpath.neighbourhood import DIAGONAL, HEADINGS, OPPOSITE

# A part of a box is worked on alone if it has no more than this share of its cells.
_WORTH_A_PART = 0.8


def taken_backwards(legal: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """Return the legal steps that lead back along others; see `Moves` for both arrays."""
    back = np.zeros_like(legal)
    for m, offset in enumerate(offsets.tolist()):
        at, to = _ends_of_steps(len(legal), offset)
        back[to] |= (legal[at] >> np.uint8(m) & np.uint8(1)) << np.uint8(OPPOSITE[m])
    return back


def _ends_of_steps(n_cells: int, offset: int) -> tuple[slice, slice]:
    """Return the indices of the cells where steps begin and where they end, as if each row ran into the next one."""
    later, earlier = slice(abs(offset), None), slice(max(0, n_cells - abs(offset)))
    return (earlier, later) if offset > 0 else (later, earlier)


def uncut(grid: OccupancyGrid, free: np.ndarray) -> np.ndarray:
    """Return the steps that pass no corner that the grid forbids to cut, bits as in `Moves.legal`, uint8, shape (h, w).

    ``free`` says which cells are free, with a rim of those around them, bool, shape (h + 2, w + 2).
    """
    bits = np.full((free.shape[0] - 2, free.shape[1] - 2), 255, dtype=np.uint8)
    if grid.neighbourhood.restricts:
        for m in np.flatnonzero(DIAGONAL):
            dx, dy = HEADINGS[m]
            cut = ~grid.neighbourhood.may_pass(_shifted(free, dx, 0), _shifted(free, 0, dy))
            bits ^= cut.astype(np.uint8) << np.uint8(m)
    return bits


def ending_in(free: np.ndarray, headings: Iterable[int] = range(8)) -> np.ndarray:
    """Return the steps along some headings that end in a free cell, bits as in `Moves.legal`; ``free`` as of `uncut`."""
    bits = np.zeros((free.shape[0] - 2, free.shape[1] - 2), dtype=np.uint8)
    for m in headings:
        bits |= _shifted(free, *HEADINGS[m]).astype(np.uint8) << np.uint8(m)
    return bits


def _shifted(padded: np.ndarray, dx: int, dy: int) -> np.ndarray:
    return padded[1 + dy : padded.shape[0] - 1 + dy, 1 + dx : padded.shape[1] - 1 + dx]


class Moves:
    """The legal steps from each cell of a grid, or of a part of it; what `Representation.moves` is.

    Cell (x, y) of the whole grid has the index ``y * width + x``, as in `OccupancyGrid.move_graph`. In a box, cells are counted
    in the same way from its own corner.

    Parameters
    ----------
    grid : OccupancyGrid
    headings : iterable of int, optional
        Indices into `HEADINGS` of the steps to allow; all eight by default.
    box : Box, optional
        The cells to step on; all by default.

    Attributes
    ----------
    box : Box
    width, height : int
        Of the box.
    diagonal : bool
        Whether the grid has diagonal steps at all.
    legal : numpy.ndarray of uint8, shape (n_cells,)
        Bit m is set where the step along heading m stays on the grid, ends in a free cell and cuts no corner that the grid
        forbids to cut. No bit is set in occupied cells.
    offsets : numpy.ndarray of int64, shape (8,)
        What each step adds to the index of a cell.

    Examples
    --------
    From the middle of the bottom row, below an obstacle, there are two steps: to the right, heading 0, and to the left, 4.

    >>> moves = Moves(OccupancyGrid([[0, 0, 0], [0, 1, 0], [0, 0, 0]]))
    >>> cell = moves.index((1, 0))
    >>> [m for m in range(8) if moves.legal[cell] >> m & 1]
    [0, 4]
    >>> moves.cells(cell + moves.offsets[[0, 4]]).tolist()
    [[2, 0], [0, 0]]
    """

    def __init__(self, grid: OccupancyGrid, headings: Iterable[int] = range(8), box: Box | None = None):
        self.box = grid.whole if box is None else box
        self._grid_width = grid.width
        self._is_whole = self.box == grid.whole
        self.height, self.width = self.box.shape
        # A rim of occupied cells stands for the edge of the grid.
        free = np.pad(~grid.occupied[self.box.slices], 1)
        legal = ending_in(free, headings) & uncut(grid, free)
        legal[~_shifted(free, 0, 0)] = 0
        self.legal = legal.ravel()
        self.diagonal = grid.neighbourhood.diagonal
        self.offsets = (HEADINGS[:, 1] * self.width + HEADINGS[:, 0]).astype(np.int64)

    @property
    def entered(self) -> np.ndarray:
        """Whether a step along each heading ends in each cell, bool, shape (8, n_cells)."""
        back = self.backward().legal
        return np.stack([(back >> np.uint8(OPPOSITE[m]) & 1).astype(bool) for m in range(8)])

    def backward(self) -> Moves:
        """Return the steps that lead back: along the opposite heading wherever a step leads forth."""
        back = copy.copy(self)
        back.legal = taken_backwards(self.legal, self.offsets)
        return back

    def within(self, usable: np.ndarray) -> Moves:
        """Return the steps that lead from and to usable cells, bool, shape (n_cells,)."""
        kept = copy.copy(self)
        one, leads = np.ascontiguousarray(usable).view(np.uint8), np.zeros_like(self.legal)
        for m, offset in enumerate(self.offsets.tolist()):
            # No step leads beyond the edge.
            at, to = _ends_of_steps(len(one), offset)
            leads[at] |= one[to] * np.uint8(1 << m)
        leads &= self.legal
        leads *= one
        kept.legal = leads
        return kept

    def without(self, steps: np.ndarray) -> Moves:
        """Return the steps but those along a heading to a cell, bool, shape (8, n_cells)."""
        kept, entered = copy.copy(self), self.entered
        kept.legal = self.legal.copy()
        for m in range(8):
            kept.legal[np.flatnonzero(entered[m] & steps[m]) - self.offsets[m]] &= np.uint8(255 - (1 << m))
        return kept

    def around(self, wanted: np.ndarray) -> Moves:
        """Return the steps within the bounding box of wanted cells, bool, shape (n_cells,); itself if that saves little."""
        wanted = wanted.reshape(self.height, self.width)
        xs, ys = (np.flatnonzero(wanted.any(axis=axis)) for axis in (0, 1))
        x0, x1, y0, y1 = int(xs[0]), int(xs[-1]) + 1, int(ys[0]), int(ys[-1]) + 1
        if (x1 - x0) * (y1 - y0) > _WORTH_A_PART * self.n_cells:
            return self
        part = copy.copy(self)
        part.box = Box(self.box.x0 + x0, self.box.y0 + y0, self.box.x0 + x1, self.box.y0 + y1)
        part._is_whole = False
        part.height, part.width = part.box.shape
        legal = self.legal.reshape(self.height, self.width)[y0:y1, x0:x1].copy()
        for edge, leaves in (
            (legal[:, 0], HEADINGS[:, 0] < 0),
            (legal[:, -1], HEADINGS[:, 0] > 0),
            (legal[0], HEADINGS[:, 1] < 0),
            (legal[-1], HEADINGS[:, 1] > 0),
        ):
            edge &= np.uint8(255 - sum(1 << m for m in np.flatnonzero(leaves).tolist()))
        part.legal = legal.ravel()
        part.offsets = (HEADINGS[:, 1] * part.width + HEADINGS[:, 0]).astype(np.int64)
        return part

    def part_of(self, values: np.ndarray, part: Moves) -> np.ndarray:
        """Return those of values for each cell, shape (k, n_cells * n), that are for cells of a part of the box."""
        y, x = part.box.y0 - self.box.y0, part.box.x0 - self.box.x0
        values = values.reshape(len(values), self.height, self.width, -1)
        return values[:, y : y + part.height, x : x + part.width].reshape(len(values), -1)

    @property
    def n_cells(self) -> int:
        """Number of cells of the box."""
        return self.width * self.height

    def index(self, cell) -> int:
        """Return the index of a cell (x, y) of the grid."""
        return (int(cell[1]) - self.box.y0) * self.width + int(cell[0]) - self.box.x0

    def cells(self, index: np.ndarray) -> np.ndarray:
        """Return the cells (x, y) of the grid that have these indices, shape (..., 2)."""
        return np.stack([index % self.width + self.box.x0, index // self.width + self.box.y0], axis=-1)

    def from_grid(self, index: np.ndarray) -> np.ndarray:
        """Return the indices of cells that are given by their indices in the whole grid; -1 for those outside the box."""
        if self._is_whole:
            return index
        x, y = index % self._grid_width - self.box.x0, index // self._grid_width - self.box.y0
        inside = (x >= 0) & (x < self.width) & (y >= 0) & (y < self.height)
        return np.where(inside, y * self.width + x, -1)

    def to_grid(self, index: np.ndarray) -> np.ndarray:
        """Return the indices in the whole grid of cells of the box, the inverse of `from_grid`."""
        if self._is_whole:
            return index
        return (index // self.width + self.box.y0) * self._grid_width + index % self.width + self.box.x0
