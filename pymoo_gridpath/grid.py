"""Occupancy grids: which cells are occupied, how large they are, where they lie, and how corners are passed."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy import ndimage, sparse
from scipy.sparse import csgraph

from pymoo_gridpath.errors import GridError, UnreachableError

Cell = tuple[int, int]

SQRT2 = math.sqrt(2.0)

# Grids of fewer cells are worked on whole, and so are those of which a start can reach more than this share: a part would
# save nothing.
_LEAST_BOXED, _MOST_REACHED = 2**16, 0.25


class Box(NamedTuple):
    """A rectangle of cells, from (x0, y0) on and up to (x1, y1), which are not in it."""

    x0: int
    y0: int
    x1: int
    y1: int

    @property
    def slices(self) -> tuple[slice, slice]:
        """What takes the part out of an array over the grid."""
        return slice(self.y0, self.y1), slice(self.x0, self.x1)

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width."""
        return self.y1 - self.y0, self.x1 - self.x0

    def grown(self, margin: int, shape: tuple[int, int]) -> Box:
        """Return the box with so many more cells on each side, as far as an array of that shape goes."""
        height, width = shape
        return Box(
            max(self.x0 - margin, 0), max(self.y0 - margin, 0), min(self.x1 + margin, width), min(self.y1 + margin, height)
        )


class OccupancyGrid:
    """A rectangular grid of free and occupied cells, immutable in use.

    A cell is ``(x, y)`` with x to the right and y *up*, from ``(0, 0)`` at the bottom left; arrays are indexed ``[y, x]``.

    Parameters
    ----------
    occupied : array_like of bool, shape (height, width)
        True where a cell is occupied. Row 0 is the bottom row. The array is copied.
    resolution : float, default 1.0
        Side of a cell in metres.
    origin : (float, float) or (float, float, float), default (0, 0, 0)
        Pose of the bottom-left *corner* of cell (0, 0): x and y in metres and yaw in radians, as in ROS.
    corner_cutting : bool, default False
        Whether a diagonal step may touch an occupied cell. False is the rule of MovingAI's benchmarks and of a robot with a
        body: both cells beside the step must be free. True is the world of Ahmed and Deb (2013).
    name : str, default "grid"
        What figures and files call this grid.

    Raises
    ------
    GridError
        If the array is not two-dimensional, is empty or holds other values than 0 and 1, or if another argument is out of
        its range.

    Examples
    --------
    >>> grid = OccupancyGrid([[0, 0, 0], [0, 1, 0]], resolution=0.5)
    >>> grid.width, grid.height, grid.n_occupied
    (3, 2, 1)
    >>> grid.is_free((1, 1)), grid.is_free((2, 1))
    (False, True)
    >>> grid.to_metres((2, 1))
    array([1.25, 0.75])
    """

    def __init__(
        self,
        occupied: ArrayLike,
        resolution: float = 1.0,
        origin: Sequence[float] = (0.0, 0.0, 0.0),
        corner_cutting: bool = False,
        name: str = "grid",
    ):
        self._occupied = _as_occupied(occupied)
        self._resolution = _as_float(resolution)
        if not (math.isfinite(self._resolution) and self._resolution > 0):
            raise GridError(f"resolution is {resolution}, expected a positive number of metres per cell")
        pose = tuple(_as_float(v) for v in origin)
        if len(pose) == 2:
            pose = (*pose, 0.0)
        if len(pose) != 3 or not all(math.isfinite(v) for v in pose):
            raise GridError(f"origin is {origin!r}, expected (x, y) or (x, y, yaw) in metres and radians")
        self._origin = pose
        if not math.isfinite(self._resolution * max(self.shape) + max(abs(v) for v in pose)):
            raise GridError(f"resolution {resolution} and origin {origin!r} put the map beyond what numbers can hold")
        if not isinstance(corner_cutting, bool | np.bool_):
            raise GridError(f"corner_cutting is {corner_cutting!r}, expected True or False")
        self._corner_cutting = bool(corner_cutting)
        self._name = str(name)

    # -- what it is ---------------------------------------------------------------------------------------------------

    @property
    def occupied(self) -> np.ndarray:
        """Occupied cells, bool, shape (height, width), read-only."""
        return self._occupied

    @property
    def resolution(self) -> float:
        """Side of a cell in metres."""
        return self._resolution

    @property
    def origin(self) -> tuple[float, ...]:
        """Pose (x, y, yaw) of the bottom-left corner of cell (0, 0), in metres and radians."""
        return self._origin

    @property
    def corner_cutting(self) -> bool:
        """Whether a diagonal step may touch an occupied cell."""
        return self._corner_cutting

    @property
    def name(self) -> str:
        """What figures and files call this grid."""
        return self._name

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
        return int(self._occupied.sum())

    def replace(self, **changes) -> OccupancyGrid:
        """Return a copy in which the named constructor arguments are changed."""
        arguments = {
            "occupied": self._occupied,
            "resolution": self._resolution,
            "origin": self._origin,
            "corner_cutting": self._corner_cutting,
            "name": self._name,
        }
        unknown = set(changes) - set(arguments)
        if unknown:
            raise TypeError(f"replace() has no argument {sorted(unknown)[0]!r}, expected one of {', '.join(arguments)}")
        return OccupancyGrid(**{**arguments, **changes})

    def __eq__(self, other) -> bool:
        if not isinstance(other, OccupancyGrid):
            return NotImplemented
        return self._key() == other._key() and np.array_equal(self._occupied, other._occupied)

    def __hash__(self) -> int:
        return hash((self._key(), self._occupied.tobytes()))

    def _key(self):
        return self.shape, self._resolution, self._origin, self._corner_cutting, self._name

    def __reduce__(self):
        # Through the constructor, because pickling an array drops its read-only flag.
        return OccupancyGrid, (self._occupied, self._resolution, self._origin, self._corner_cutting, self._name)

    def __repr__(self) -> str:
        rule = "may be cut" if self._corner_cutting else "may not be cut"
        return (
            f"<OccupancyGrid {self._name!r}: {self.width} x {self.height} cells of {self._resolution:g} m, "
            f"{self.n_occupied} occupied, corners {rule}>"
        )

    # -- cells --------------------------------------------------------------------------------------------------------

    def contains(self, cell: Sequence[int]) -> bool:
        """Whether a cell lies on the grid."""
        x, y = cell
        return 0 <= x < self.width and 0 <= y < self.height

    def is_free(self, cell: Sequence[int]) -> bool:
        """Whether a cell lies on the grid and is not occupied."""
        x, y = cell
        return self.contains(cell) and not self._occupied[y, x]

    def nearest_free(self, cell: Sequence[int]) -> Cell | None:
        """Return the free cell nearest to ``cell`` (Euclidean; ties: lower y, then lower x), or None if all are occupied."""
        ys, xs = np.nonzero(~self._occupied)
        if len(xs) == 0:
            return None
        # Squares of larger numbers would overflow.
        far = 10**6
        x, y = (min(max(int(v), -far), size + far) for v, size in zip(cell, (self.width, self.height), strict=True))
        k = int(np.argmin((xs - x) ** 2 + (ys - y) ** 2))
        return int(xs[k]), int(ys[k])

    def check_cell(self, cell: Sequence[int], role: str = "cell") -> Cell:
        """Return ``cell`` as a pair of ints if it is a free cell of this grid.

        Parameters
        ----------
        cell : sequence of two ints
            The cell (x, y).
        role : str
            What the error message calls it, for instance ``"start"``.

        Raises
        ------
        GridError
            If it is not a pair of whole numbers, lies outside the grid or is occupied; the message names the nearest free
            cell.
        """
        try:
            x, y = (int(v) for v in cell)
            whole = (x, y) == tuple(cell)
        except (TypeError, ValueError, OverflowError):
            whole, x, y = False, 0, 0
        if not whole:
            raise GridError(f"{role} is {cell!r}, expected a cell (x, y) of two whole numbers")
        if self.is_free((x, y)):
            return x, y
        near = self.nearest_free((x, y))
        hint = "the grid has no free cell" if near is None else f"the nearest free cell is ({near[0]}, {near[1]})"
        if not self.contains((x, y)):
            raise GridError(
                f"{role} ({x}, {y}) lies outside the grid {self.name!r} of {self.width} x {self.height} cells "
                f"(x from 0 to {self.width - 1}, y from 0 to {self.height - 1}, y up); {hint}"
            )
        raise GridError(f"{role} ({x}, {y}) lies on an obstacle of the grid {self.name!r}; {hint}")

    def check_query(self, start: Sequence[int], goal: Sequence[int]) -> tuple[Cell, Cell]:
        """Return ``start`` and ``goal`` as pairs of ints if a path can lead from one to the other.

        Raises
        ------
        GridError
            If either is not a free cell of the grid, or both are the same cell.
        UnreachableError
            If no path joins them under the corner rule of the grid.
        """
        start, goal = self.check_cell(start, "start"), self.check_cell(goal, "goal")
        if start == goal:
            raise GridError(f"start and goal are the same cell ({start[0]}, {start[1]}), expected two different cells")
        region = self.regions
        if region[start[1], start[0]] != region[goal[1], goal[0]]:
            raise UnreachableError(
                f"goal ({goal[0]}, {goal[1]}) cannot be reached from start ({start[0]}, {start[1]}) on the grid "
                f"{self.name!r}: obstacles separate them; expected two cells of the same free region"
            )
        return start, goal

    def to_metres(self, cells: ArrayLike) -> np.ndarray:
        """Return the centres of cells in the map's frame.

        Parameters
        ----------
        cells : array_like, shape (..., 2)
            Cells (x, y).

        Returns
        -------
        numpy.ndarray, shape (..., 2)
            Metres.
        """
        local = (np.asarray(cells, dtype=float) + 0.5) * self._resolution
        x0, y0, yaw = self._origin
        cos, sin = math.cos(yaw), math.sin(yaw)
        return local @ np.array([[cos, sin], [-sin, cos]]) + np.array([x0, y0])

    def to_cells(self, points: ArrayLike) -> np.ndarray:
        """Return the cells that hold points given in metres; the inverse of `to_metres` (cells may lie outside the grid).

        Parameters
        ----------
        points : array_like, shape (..., 2)
            Metres.

        Returns
        -------
        numpy.ndarray of int, shape (..., 2)
        """
        x0, y0, yaw = self._origin
        cos, sin = math.cos(yaw), math.sin(yaw)
        local = (np.asarray(points, dtype=float) - np.array([x0, y0])) @ np.array([[cos, -sin], [sin, cos]])
        return np.floor(local / self._resolution).astype(int)

    # -- the whole grid -----------------------------------------------------------------------------------------------

    @functools.cached_property
    def regions(self) -> np.ndarray:
        """Label of the connected free region of each cell, shape (height, width); 0 where occupied.

        Without corner cutting a diagonal step needs both cells beside it free, so regions are those of the four straight
        moves; with it, those of all eight.
        """
        structure = np.ones((3, 3)) if self._corner_cutting else None
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

    def box_of(self, start: Sequence[int]) -> Box:
        """Return the part of the grid that is enough to plan paths from a cell.

        It holds all cells that can be reached from the free cell, and one more on each side, so that every obstacle which is
        the nearest one of a reachable cell lies in it. A large grid of which little can be reached so takes no more time and
        memory than a small one. Of any other grid it is the whole.
        """
        x, y = start
        if self._occupied.size < _LEAST_BOXED or self._occupied[y, x]:
            return self.whole
        rows, columns = self._region_slices[self.regions[y, x] - 1]
        left, low = self._free_box[:2]
        box = Box(left + columns.start, low + rows.start, left + columns.stop, low + rows.stop).grown(1, self.shape)
        return box if math.prod(box.shape) <= _MOST_REACHED * self._occupied.size else self.whole

    @functools.cached_property
    def _region_slices(self) -> list:
        return ndimage.find_objects(self.regions[self._free_box.slices])

    def crop(self, box: Box) -> OccupancyGrid:
        """Return the grid of the cells in a box, each where it was in metres; the grid itself if these are all."""
        if box == self.whole:
            return self
        x0, y0, yaw = self._origin
        dx, dy = box.x0 * self._resolution, box.y0 * self._resolution
        cos, sin = math.cos(yaw), math.sin(yaw)
        return self.replace(
            occupied=self._occupied[box.slices], origin=(x0 + cos * dx - sin * dy, y0 + sin * dx + cos * dy, yaw)
        )

    def inflate(self, radius: float) -> OccupancyGrid:
        """Return a grid on which a disc of ``radius`` metres can be planned for as a point.

        A cell becomes occupied when a disc centred in it would overlap the square of an occupied cell. The edge of the grid
        is not an obstacle.

        Raises
        ------
        GridError
            If the radius is negative or not finite.
        """
        if not (math.isfinite(radius) and radius >= 0):
            raise GridError(f"robot radius is {radius}, expected a number of metres, zero or more")
        cells = radius / self._resolution
        reach = math.ceil(min(cells + 0.5, max(self.shape)))
        offset = np.maximum(np.abs(np.arange(-reach, reach + 1)) - 0.5, 0.0) ** 2
        disc = np.sqrt(offset[:, None] + offset[None, :]) < cells - 1e-9
        if disc.sum() <= 1:
            return self
        # It takes as long to import as the rest of the package, and is used by this method alone.
        from scipy import signal

        # No other cell can change, nor can one further away change any.
        part = self._free_box.grown(reach, self.shape).slices
        hits = signal.oaconvolve(self._occupied[part].astype(float), disc.astype(float), mode="same")
        inflated = self._occupied.copy()
        inflated[part] |= hits > 0.5
        return self.replace(occupied=inflated)

    def move_graph(self) -> sparse.csr_array:
        """Return the legal moves as a sparse graph, for `scipy.sparse.csgraph`.

        Returns
        -------
        scipy.sparse.csr_array, shape (height * width, height * width)
            Entry [a, b] is the length in cells of the step from cell a to cell b, 1 or sqrt(2); cell (x, y) has the index
            ``y * width + x``. Each step is listed in both directions.
        """
        free = ~self._occupied
        index = np.arange(free.size).reshape(free.shape)
        pairs, lengths = [], []

        def add(a, b, legal, length):
            pairs.append(np.stack([a[legal], b[legal]]))
            lengths.append(np.full(pairs[-1].shape[1], length))

        add(index[:, :-1], index[:, 1:], free[:, :-1] & free[:, 1:], 1.0)
        add(index[:-1, :], index[1:, :], free[:-1, :] & free[1:, :], 1.0)
        rising, falling = free[:-1, :-1] & free[1:, 1:], free[1:, :-1] & free[:-1, 1:]
        if not self._corner_cutting:
            rising, falling = rising & falling, rising & falling
        add(index[:-1, :-1], index[1:, 1:], rising, SQRT2)
        add(index[1:, :-1], index[:-1, 1:], falling, SQRT2)
        (a, b), length = np.concatenate(pairs, axis=1), np.concatenate(lengths)
        rows, cols = np.concatenate([a, b]), np.concatenate([b, a])
        return sparse.csr_array((np.tile(length, 2), (rows, cols)), shape=(free.size, free.size))

    def shortest_lengths(self, start: Sequence[int], limit: float = math.inf) -> np.ndarray:
        """Return the length in cells of the shortest path from ``start`` to every cell.

        Parameters
        ----------
        start : sequence of two ints
            A free cell.
        limit : float, optional
            Paths longer than this are not looked for.

        Returns
        -------
        numpy.ndarray, shape (height, width)
            ``inf`` where no path leads (within ``limit``).
        """
        x, y = self.check_cell(start, "start")
        box = self.box_of((x, y))
        if box not in self._graphs:
            self._graphs[box] = self.crop(box).move_graph()
        rows, columns = box.shape
        found = csgraph.dijkstra(self._graphs[box], indices=(y - box.y0) * columns + x - box.x0, limit=limit)
        lengths = np.full(self.shape, np.inf)
        lengths[box.slices] = found.reshape(rows, columns)
        return lengths

    @functools.cached_property
    def _graphs(self) -> dict[Box, sparse.csr_array]:
        return {}


def _as_float(value) -> float:
    """Return a number as a float, and what is no number as NaN."""
    try:
        return float(value)
    except (TypeError, ValueError):
        return math.nan


def _as_occupied(occupied: ArrayLike) -> np.ndarray:
    """Return a read-only bool copy of an array of 0 and 1."""
    array = np.asarray(occupied)
    if array.ndim != 2:
        raise GridError(f"a grid needs a two-dimensional array of occupied cells, got {array.ndim} dimensions")
    if array.size == 0:
        raise GridError(f"a grid needs at least one cell, got an array of shape {array.shape}")
    if array.dtype != bool and (array.dtype.kind not in "iuf" or not np.isin(array, (0, 1)).all()):
        raise GridError("a grid needs an array of booleans, or of 0 (free) and 1 (occupied), got other values")
    copy = array.astype(bool)
    copy.flags.writeable = False
    return copy
