"""Occupancy grids: which cells are occupied, how large they are, where they lie, and how corners are passed."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import math
import warnings
from collections.abc import Sequence
from numbers import Real
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy import ndimage, sparse
from scipy.sparse import csgraph

from pymoo_gridpath import checks
from pymoo_gridpath.checks import shown
from pymoo_gridpath.errors import GridError, GridPathError, GridPathWarning, UnreachableError

Cell = tuple[int, int]

SQRT2 = math.sqrt(2.0)

# Numbers of cells that a float holds without gaps, with one bit to spare.
_FARTHEST = 2.0**52

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
        True where a cell is occupied. Row 0 is the bottom row. The array is copied, unless it is one of booleans that is
        read-only, row by row, and no view of another.
    resolution : float, default 1.0
        Side of a cell in metres.
    origin : (float, float) or (float, float, float), default (0, 0, 0)
        Pose of the bottom-left *corner* of cell (0, 0): x and y in metres and yaw in radians, as in ROS.
    corner_cutting : bool, default False
        Whether a diagonal step may touch an occupied cell. False is the rule of MovingAI's benchmarks and of a robot with a
        body: both cells beside the step must be free. True is the world of Ahmed and Deb (2013).
    name : str, default "grid"
        What figures and files call this grid.
    unknown : array_like of bool, shape (height, width), optional
        True where the map did not say whether a cell is free; ``occupied`` says what it was taken for. None, the default, where
        maps of this kind know no unknown cells. Copied as ``occupied``, and no part of what makes two grids equal.

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
        unknown: ArrayLike | None = None,
    ):
        self._occupied = _as_cells("occupied", occupied)
        self._unknown = None if unknown is None else _as_cells("unknown", unknown)
        if self._unknown is not None and self._unknown.shape != self.shape:
            raise GridError(f"unknown has the shape {self._unknown.shape}, expected that of the grid, {self.shape}")
        self._resolution = checks.number(
            "resolution", resolution, 0.0, above=True, expected="a positive number of metres per cell", error=GridError
        )
        self._origin = _as_pose(origin)
        if not math.isfinite(self._resolution * max(self.shape) + max(abs(v) for v in self._origin)):
            raise GridError(f"resolution {resolution} and origin {origin!r} put the map beyond what numbers can hold")
        self._corner_cutting = checks.flag("corner_cutting", corner_cutting, GridError)
        self._name = checks.text("name", name, GridError)

    # -- what it is ---------------------------------------------------------------------------------------------------

    @property
    def occupied(self) -> np.ndarray:
        """Occupied cells, bool, shape (height, width), read-only."""
        return self._occupied

    @property
    def unknown(self) -> np.ndarray | None:
        """Cells of which the map did not say whether they are free, bool, shape (height, width), read-only; None as above."""
        return self._unknown

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
        return int(np.count_nonzero(self._occupied))

    @functools.cached_property
    def digest(self) -> str:
        """SHA-256, in hexadecimal, of the size and of which cells are occupied; the one by which files and runs know a grid.

        Of the text ``"{width} {height} "`` and the cells, row by row from the bottom, eight a byte, the first highest.
        """
        cells = np.packbits(self._occupied).data
        return hashlib.sha256(b"".join((f"{self.width} {self.height} ".encode(), cells))).hexdigest()

    def replace(self, **changes) -> OccupancyGrid:
        """Return a copy in which the named constructor arguments are changed.

        Unknown cells are forgotten if ``occupied`` has another shape.
        """
        if "occupied" in changes:
            changes["occupied"] = _as_cells("occupied", changes["occupied"])
        arguments = {
            "occupied": self._occupied,
            "resolution": self._resolution,
            "origin": self._origin,
            "corner_cutting": self._corner_cutting,
            "name": self._name,
            "unknown": self._unknown if changes.get("occupied", self._occupied).shape == self.shape else None,
        }
        unknown = set(changes) - set(arguments)
        if unknown:
            raise TypeError(f"replace() has no argument {shown(sorted(unknown)[0])}, expected one of {', '.join(arguments)}")
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
        arguments = self._occupied, self._resolution, self._origin, self._corner_cutting, self._name, self._unknown
        return OccupancyGrid, arguments

    def __repr__(self) -> str:
        rule = "may be cut" if self._corner_cutting else "may not be cut"
        return (
            f"<OccupancyGrid {self._name!r}: {self.width} x {self.height} cells of {self._resolution:g} m, "
            f"{self.n_occupied} occupied, corners {rule}>"
        )

    # -- cells --------------------------------------------------------------------------------------------------------

    def contains(self, cell: Sequence[int]) -> bool:
        """Whether a cell lies on the grid."""
        x, y = _as_cell("cell", cell)
        return 0 <= x < self.width and 0 <= y < self.height

    def is_free(self, cell: Sequence[int]) -> bool:
        """Whether a cell lies on the grid and is not occupied."""
        x, y = _as_cell("cell", cell)
        return self.contains((x, y)) and not self._occupied[y, x]

    def nearest_free(self, cell: Sequence[int], joined_with: Sequence[int] | None = None) -> Cell | None:
        """Return the free cell nearest to ``cell`` (Euclidean; ties: lower y, then lower x), or None if all are occupied.

        Parameters
        ----------
        cell : sequence of two ints
            The cell (x, y), on the grid or off it.
        joined_with : sequence of two ints, optional
            A free cell; only others that a path joins with it count, and None says that there are none.
        """
        cell, wanted = _as_cell("cell", cell), ~self._occupied
        if joined_with is not None:
            x, y = self.check_cell(joined_with, "joined_with")
            wanted = self.regions == self.regions[y, x]
            wanted[y, x] = False
        ys, xs = np.nonzero(wanted)
        if len(xs) == 0:
            return None
        # Squares of larger numbers would overflow.
        far = 10**6
        x, y = (min(max(v, -far), size + far) for v, size in zip(cell, (self.width, self.height), strict=True))
        k = int(np.argmin((xs - x) ** 2 + (ys - y) ** 2))
        return int(xs[k]), int(ys[k])

    def check_cell(self, cell: Sequence[int], role: str = "cell", other: Sequence[int] | None = None) -> Cell:
        """Return ``cell`` as a pair of ints if it is a free cell of this grid.

        Parameters
        ----------
        cell : sequence of two ints
            The cell (x, y).
        role : str
            What the error message calls it, for instance ``"start"``.
        other : sequence of two ints, optional
            The other end of the path that is wanted, a free cell or not.

        Raises
        ------
        GridError
            If it is not a pair of whole numbers, lies outside the grid or is occupied; the message names the nearest free
            cell, and if the other end is one, the nearest that a path joins with it.
        """
        x, y = _as_cell(checks.text("role", role, GridError), cell)
        if self.is_free((x, y)):
            return x, y
        hint = self._hint((x, y), other)
        if not self.contains((x, y)):
            raise GridError(
                f"{role} {shown((x, y))} lies outside the grid {shown(self.name)} of {self.width} x {self.height} cells "
                f"(x from 0 to {self.width - 1}, y from 0 to {self.height - 1}, y up); {hint}"
            )
        raise GridError(f"{role} ({x}, {y}) lies on an obstacle of the grid {shown(self.name)}; {hint}")

    def _hint(self, cell: Cell, other: Sequence[int] | None) -> str:
        """Return the part of a message that names a cell to take instead."""
        end = None
        if other is not None:
            # If the other end is no better, it tells nothing.
            with contextlib.suppress(GridError):
                end = self.check_cell(other)
        near = self.nearest_free(cell, end)
        if end is None:
            return "the grid has no free cell" if near is None else f"the nearest free cell is ({near[0]}, {near[1]})"
        joined = f"that a path joins with ({end[0]}, {end[1]})"
        return (
            f"there is no free cell {joined}" if near is None else f"the nearest free cell {joined} is ({near[0]}, {near[1]})"
        )

    def check_query(self, start: Sequence[int], goal: Sequence[int]) -> tuple[Cell, Cell]:
        """Return ``start`` and ``goal`` as pairs of ints if a path can lead from one to the other.

        Raises
        ------
        GridError
            If either is not a free cell of the grid, or both are the same cell.
        UnreachableError
            If no path joins them under the corner rule of the grid.
        """
        start, goal = self.check_cell(start, "start", goal), self.check_cell(goal, "goal", start)
        if start == goal:
            raise GridError(f"start and goal are the same cell ({start[0]}, {start[1]}), expected two different cells")
        region = self.regions
        if region[start[1], start[0]] != region[goal[1], goal[0]]:
            raise UnreachableError(
                f"goal ({goal[0]}, {goal[1]}) cannot be reached from start ({start[0]}, {start[1]}) on the grid "
                f"{shown(self.name)}: obstacles separate them; expected two cells of the same free region"
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
        local = (_pairs("cells", cells, "cells (x, y)").astype(float) + 0.5) * self._resolution
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

        Raises
        ------
        GridError
            If the points are no pairs of finite numbers, or lie more than 2**52 cells away.
        """
        x0, y0, yaw = self._origin
        cos, sin = math.cos(yaw), math.sin(yaw)
        local = (_pairs("points", points, "points (x, y) in metres") - np.array([x0, y0])) @ np.array([[cos, -sin], [sin, cos]])
        with np.errstate(over="ignore"):
            cells = np.floor(local / self._resolution)
        if not (np.abs(cells) <= _FARTHEST).all():
            raise GridError("points lie further away than cells can be counted, expected metres in the frame of the map")
        return cells.astype(int)

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

        Raises
        ------
        GridError
            If it is no cell of the grid.
        """
        x, y = _as_cell("start", start)
        if not self.contains((x, y)):
            self.check_cell((x, y), "start")
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
        box = check_box(box, self)
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

        Warns
        -----
        GridPathWarning
            If the radius is not zero but too small to have an effect: at most half a cell.
        """
        radius = checks.number("robot radius", radius, 0.0, expected="a number of metres, zero or more", error=GridError)
        cells = radius / self._resolution
        reach = math.ceil(min(cells + 0.5, max(self.shape)))
        offset = np.maximum(np.abs(np.arange(-reach, reach + 1)) - 0.5, 0.0) ** 2
        disc = np.sqrt(offset[:, None] + offset[None, :]) < cells - 1e-9
        if disc.sum() <= 1:
            if radius > 0:
                warnings.warn(
                    f"the robot radius of {radius:g} m is at most half a cell of {self._name!r}, {self._resolution:g} m "
                    "wide, so that no obstacle grows",
                    GridPathWarning,
                    stacklevel=2,
                )
            return self
        # It takes as long to import as the rest of the package, and is used by this method alone.
        from scipy import signal

        # No other cell can change, nor can one further away change any.
        part = self._free_box.grown(reach, self.shape).slices
        hits = signal.oaconvolve(self._occupied[part].astype(float), disc.astype(float), mode="same")
        inflated = self._occupied.copy()
        inflated[part] |= hits > 0.5
        inflated.flags.writeable = False
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
        index = np.arange(free.size, dtype=np.int32).reshape(free.shape)  # what csgraph takes before scipy 1.15
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
        start = self.check_cell(start, "start")
        limit = checks.number("limit", limit, 0.0, infinite=True, expected="a length in cells, zero or more", error=GridError)
        box = self.box_of(start)
        lengths = np.full(self.shape, np.inf)
        lengths[box.slices] = self._lengths_in(box, start, limit)
        return lengths

    def shortest_length(self, start: Sequence[int], goal: Sequence[int]) -> float:
        """Return the length in cells of the shortest path between two free cells; ``inf`` if no path joins them."""
        start, (x, y) = self.check_cell(start, "start", goal), self.check_cell(goal, "goal", start)
        if self.regions[start[1], start[0]] != self.regions[y, x]:
            return math.inf
        box = self.box_of(start)
        return float(self._lengths_in(box, start)[y - box.y0, x - box.x0])

    def _lengths_in(self, box: Box, start: Cell, limit: float = math.inf) -> np.ndarray:
        """Return what `shortest_lengths` does, in the box of the start alone."""
        x, y = start
        if box not in self._graphs:
            self._graphs[box] = self.crop(box).move_graph()
        found = csgraph.dijkstra(self._graphs[box], indices=(y - box.y0) * box.shape[1] + x - box.x0, limit=limit)
        return found.reshape(box.shape)

    @functools.cached_property
    def _graphs(self) -> dict[Box, sparse.csr_array]:
        return {}


def check_box(box: Box, grid: OccupancyGrid) -> Box:
    """Return what is given as a box of cells of a grid if it is one."""
    expected = f"a Box of cells of the grid of {check_grid(grid).width} x {grid.height}"
    ends = [checks.whole("box", end, expected=expected) for end in checks.items("box", box, expected)]
    if len(ends) == 4:
        x0, y0, x1, y1 = ends
        if 0 <= x0 < x1 <= grid.width and 0 <= y0 < y1 <= grid.height:
            return Box(x0, y0, x1, y1)
    raise GridError(f"box is {shown(ends)}, expected {expected}")


def check_grid(grid: OccupancyGrid) -> OccupancyGrid:
    """Return what is given as a grid if it is one."""
    return checks.instance("grid", grid, OccupancyGrid, "; load_map reads one", error=GridError)


def _as_pose(origin) -> tuple[float, ...]:
    """Return (x, y, yaw)."""
    expected = "(x, y) or (x, y, yaw) in metres and radians"
    try:
        pose = tuple(checks.number("origin", v, expected=expected) for v in checks.items("origin", origin, expected))
    except GridPathError:
        pose = ()
    if len(pose) not in (2, 3):
        raise GridError(f"origin is {shown(origin)}, expected {expected}")
    return pose if len(pose) == 3 else (*pose, 0.0)


def _as_cell(role: str, cell) -> Cell:
    """Return a cell as a pair of ints, on the grid or not."""
    if type(cell) is tuple and len(cell) == 2 and type(cell[0]) is int and type(cell[1]) is int:
        return cell
    try:
        x, y = (int(v) for v in cell)
        whole = all(isinstance(v, Real) for v in cell) and (x, y) == tuple(cell)
    except Exception:
        whole, x, y = False, 0, 0
    if not whole or (isinstance(cell, np.ma.MaskedArray) and np.ma.getmaskarray(cell).any()):
        raise GridError(f"{role} is {shown(cell)}, expected a cell (x, y) of two whole numbers")
    return x, y


def _pairs(name: str, values: ArrayLike, what: str) -> np.ndarray:
    """Return an array of pairs of finite numbers, shape (..., 2)."""
    expected = f"{what} as numbers of shape (..., 2)"
    pairs = checks.array(name, values, expected=expected, finite=True, error=GridError)
    if pairs.shape[-1:] != (2,):
        raise GridError(f"{name} is {shown(pairs)}, expected {expected}")
    return pairs


def _as_cells(name: str, cells: ArrayLike) -> np.ndarray:
    """Return a read-only bool copy of an array of 0 and 1, or the array itself if it is as such a copy."""
    values = "0 (free) and 1 (occupied)" if name == "occupied" else "0 and 1"
    array = checks.array(name, cells, expected=f"a two-dimensional array of booleans, or of {values}", error=GridError)
    if array.ndim != 2:
        raise GridError(f"a grid needs a two-dimensional array of {name} cells, got {array.ndim} dimensions")
    if array.size == 0:
        raise GridError(f"a grid needs at least one cell, got an array of shape {array.shape}")
    if array.dtype != bool and not np.isin(array, (0, 1)).all():
        raise GridError(f"a grid needs an array of booleans, or of {values}, as {name} cells, got other values")
    flags = array.flags
    if type(array) is np.ndarray and array.dtype == bool and flags.owndata and flags.c_contiguous and not flags.writeable:
        return array  # nobody writes into it, and on large maps copies are what takes the memory
    # Row by row whatever the order of the given one, for its bytes and its flat view are those of the grid.
    copy = array.astype(bool, order="C")
    copy.flags.writeable = False
    return copy
