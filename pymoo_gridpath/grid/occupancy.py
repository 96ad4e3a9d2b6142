"""The occupancy grid: cells that have a place and a size in metres, and what is asked of them."""

from __future__ import annotations

import contextlib
import functools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse
from scipy.sparse import csgraph

from pymoo_gridpath import checks, pictures
from pymoo_gridpath.checks import shown
from pymoo_gridpath.errors import GridError, UnreachableError
from pymoo_gridpath.grid.arguments import Cell, CornerCutting, as_cell, as_cells, as_resolution
from pymoo_gridpath.grid.box import Box
from pymoo_gridpath.grid.grown import GrownCells, Growth
from pymoo_gridpath.grid.occupancy_values import blocks_of, cells_of_occupancy, decimal_of
from pymoo_gridpath.grid.picture import html_of, scene_of, size_of
from pymoo_gridpath.neighbourhood import steps_in_words

# Grids of fewer cells are worked on whole, and so are those of which a start can reach more than this share: a part would
# save nothing.
_LEAST_BOXED, _MOST_REACHED = 2**16, 0.25


class OccupancyGrid(GrownCells):
    """A rectangular grid of free and occupied cells, immutable in use.

    A cell is ``(x, y)`` with x to the right and y *up*, from ``(0, 0)`` at the bottom left; arrays are indexed ``[y, x]``.

    Parameters
    ----------
    occupied : array_like of bool, shape (height, width)
        True where a cell is occupied. Row 0 is the bottom row. The array is copied, unless it is one of booleans that is
        read-only, row by row, and no view of another.
    resolution : float, optional
        Side of a cell in metres, if that is known. Without it the map is one in cells: nothing on it has metres, and what
        needs them says so.
    origin : (float, float) or (float, float, float), default (0, 0, 0)
        Pose of the bottom-left *corner* of cell (0, 0): x and y in metres and yaw in radians, as in ROS. A map in cells has no
        other than the default.
    corner_cutting : bool or "one side", default False
        Whether a diagonal step may touch an occupied cell. False is the rule of MovingAI's benchmarks and of a robot with a
        body: both cells beside the step must be free. True is the world of Ahmed and Deb (2013). With "one side" at most one of
        the two may be occupied, as in the demo of PathFinding.js.
    name : str, default "grid"
        What figures and files call this grid.
    unknown : array_like of bool, shape (height, width), optional
        True where the map did not say whether a cell is free; ``occupied`` says what it was taken for. None, the default, where
        maps of this kind know no unknown cells. Copied as ``occupied``, and no part of what makes two grids equal.
    moves : {8, 4}, default 8
        How many neighbours a cell has. With 4 there are no diagonal steps, and ``corner_cutting`` makes no difference.

    Raises
    ------
    GridError
        If the array is not two-dimensional, is empty or holds other values than 0 and 1, or if another argument is out of
        its range, or an origin is given without a resolution.

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
        resolution: float | None = None,
        origin: Sequence[float] = (0.0, 0.0, 0.0),
        corner_cutting: CornerCutting = False,
        name: str = "grid",
        unknown: ArrayLike | None = None,
        moves: int = 8,
    ):
        super().__init__(occupied, resolution, origin, corner_cutting, name, unknown, moves)

    @classmethod
    def from_occupancy(
        cls,
        occupancy: ArrayLike,
        width: int | None = None,
        resolution: float | None = None,
        origin: Sequence[float] = (0.0, 0.0, 0.0),
        occupied_from: float = 65,
        free_up_to: float = 25,
        unknown: str = "occupied",
        corner_cutting: CornerCutting = False,
        name: str = "grid",
        moves: int = 8,
    ) -> OccupancyGrid:
        """Return the grid of occupancies in percent, such as ``data`` of the ROS message nav_msgs/OccupancyGrid.

        Parameters
        ----------
        occupancy : array_like of int, shape (height, width), or flat, shape (height * width,)
            -1 where nothing is known, else 0 (free) to 100 (occupied) percent. Row 0 is the bottom row, as in the message.
        width : int, optional
            Columns, ``info.width``, needed where the array is flat.
        resolution : float, optional
            ``info.resolution``. The message has it in single precision; 0.05000000074505806 is taken for 0.05.
        origin : (float, float) or (float, float, float), default (0, 0, 0)
            Pose of the bottom-left corner of cell (0, 0), x and y in metres and yaw in radians; of ``info.origin`` the yaw is
            ``2 * atan2(orientation.z, orientation.w)``.
        occupied_from, free_up_to : float, default 65 and 25
            A cell of at least, and of at most, so many percent is occupied, and free; between them it is unknown.
        unknown : {"occupied", "free"}, default "occupied"
            What unknown cells are.
        corner_cutting, name, moves
            As of `OccupancyGrid`.

        Returns
        -------
        OccupancyGrid

        Raises
        ------
        GridError
            If a value is no such number, as where a costmap's 0 to 255 are given, or booleans; or if an argument is out of its
            range.

        Examples
        --------
        >>> grid = OccupancyGrid.from_occupancy([0, 100, -1, 0, 20, 80], width=3, resolution=0.05)
        >>> grid.occupied.astype(int).tolist(), grid.unknown.astype(int).tolist()
        ([[0, 1, 1], [0, 0, 1]], [[0, 0, 1], [0, 0, 0]])
        """
        occupied, unseen = cells_of_occupancy(occupancy, width, occupied_from, free_up_to, unknown)
        metres = as_resolution(resolution)
        return cls(occupied, None if metres is None else decimal_of(metres), origin, corner_cutting, name, unseen, moves)

    # -- what it is ---------------------------------------------------------------------------------------------------

    def replace(self, **changes) -> OccupancyGrid:
        """Return a copy in which the named constructor arguments are changed.

        Unknown cells are forgotten if ``occupied`` has another shape, and what obstacles were grown from if it is changed.
        """
        if "occupied" in changes:
            changes["occupied"] = as_cells("occupied", changes["occupied"])
        arguments = {
            "occupied": self._occupied,
            "resolution": self._resolution,
            "origin": self._origin,
            "corner_cutting": self._corner_cutting,
            "name": self._name,
            "unknown": self._unknown if changes.get("occupied", self._occupied).shape == self.shape else None,
            "moves": self._moves,
        }
        unknown = set(changes) - set(arguments)
        if unknown:
            raise TypeError(f"replace() has no argument {shown(sorted(unknown)[0])}, expected one of {', '.join(arguments)}")
        made = OccupancyGrid(**{**arguments, **changes})
        if "occupied" in changes:
            return made
        shared = {key: value for key, value in changes.items() if key != "unknown"}
        return self._with_growth(made, lambda original: original.replace(**shared), made._cell / self._cell)

    def __eq__(self, other) -> bool:
        if not isinstance(other, OccupancyGrid):
            return NotImplemented
        return self._key() == other._key() and np.array_equal(self._occupied, other._occupied)

    def __hash__(self) -> int:
        return hash((self._key(), self._occupied.tobytes()))

    def _key(self):
        return self.shape, self._resolution, self._origin, self._corner_cutting, self._name, self._moves

    def __reduce__(self):
        # Through the constructor, because pickling an array drops its read-only flag.
        arguments = self._occupied, self._resolution, self._origin, self._corner_cutting, self._name, self._unknown
        return _restored, ((*arguments, self._moves), self._growth)

    def __repr__(self) -> str:
        return (
            f"<OccupancyGrid {self._name!r}: {size_of(self)}, {self.n_occupied} occupied, "
            f"{steps_in_words(self._moves, self._corner_cutting)}>"
        )

    def _repr_png_(self) -> bytes:
        return pictures.png(scene_of(self))

    def _repr_html_(self) -> str:
        return html_of(self)

    # -- cells --------------------------------------------------------------------------------------------------------

    def nearest_free(self, cell: Sequence[int], joined_with: Sequence[int] | None = None) -> Cell | None:
        """Return the free cell nearest to ``cell`` (Euclidean; ties: lower y, then lower x), or None if all are occupied.

        Parameters
        ----------
        cell : sequence of two ints
            The cell (x, y), on the grid or off it.
        joined_with : sequence of two ints, optional
            A free cell; only others that a path joins with it count, and None says that there are none.
        """
        cell, wanted = as_cell("cell", cell), ~self._occupied
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
        x, y = as_cell(checks.text("role", role, GridError), cell)
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
            If no path joins them by the steps of the grid.
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

    # -- the whole grid -----------------------------------------------------------------------------------------------

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
        x, y = as_cell("start", start)
        if not self.contains((x, y)):
            self.check_cell((x, y), "start")
        if self._occupied.size < _LEAST_BOXED or self._occupied[y, x]:
            return self.whole
        rows, columns = self._region_slices[self.regions[y, x] - 1]
        left, low = self._free_box[:2]
        box = Box(left + columns.start, low + rows.start, left + columns.stop, low + rows.stop).grown(1, self.shape)
        return box if math.prod(box.shape) <= _MOST_REACHED * self._occupied.size else self.whole

    def crop(self, box: Box) -> OccupancyGrid:
        """Return the grid of the cells in a box, each where it was in metres; the grid itself if these are all."""
        box = check_box(box, self)
        if box == self.whole:
            return self
        cells = {
            "occupied": self._occupied[box.slices],
            "unknown": None if self._unknown is None else self._unknown[box.slices],
        }
        if self._resolution is None:
            return self._with_growth(self.replace(**cells), lambda original: original.crop(box))
        x0, y0, yaw = self._origin
        dx, dy = box.x0 * self._resolution, box.y0 * self._resolution
        cos, sin = math.cos(yaw), math.sin(yaw)
        made = self.replace(**cells, origin=(x0 + cos * dx - sin * dy, y0 + sin * dx + cos * dy, yaw))
        return self._with_growth(made, lambda original: original.crop(box))

    def downsample(self, factor: int) -> OccupancyGrid:
        """Return a grid of larger cells, each of ``factor`` x ``factor`` of these, occupied where any of them is.

        Rows and columns at the top and the right that fill no larger cell make one that is occupied, since what lies beyond
        the edge is not known.

        Raises
        ------
        GridError
            If the factor is no whole number of at least 1, or larger than the grid.
        """
        most = max(self.shape)
        factor = checks.whole("factor", factor, 1, most, expected=f"a whole number of cells from 1 to {most}", error=GridError)
        unknown = None if self._unknown is None else blocks_of(self._unknown, factor, False)
        occupied = blocks_of(self._occupied, factor, True)
        resolution = None if self._resolution is None else factor * self._resolution
        made = self.replace(occupied=occupied, unknown=unknown, resolution=resolution)
        return self._with_growth(made, lambda original: original.downsample(factor))

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


def _restored(arguments: tuple, growth: Growth | None) -> OccupancyGrid:
    """Return the grid of constructor arguments, grown from another if it was."""
    grid = OccupancyGrid(*arguments)
    grid._growth = growth
    return grid


def check_box(box: Box, grid: OccupancyGrid) -> Box:
    """Return what is given as a box of cells of a grid if it is one."""
    expected = f"a Box of cells of the grid of {check_grid(grid).width} x {grid.height}"
    ends = [checks.whole("box", end, expected=expected) for end in checks.items("box", box, expected, most=4)]
    if len(ends) == 4:
        x0, y0, x1, y1 = ends
        if 0 <= x0 < x1 <= grid.width and 0 <= y0 < y1 <= grid.height:
            return Box(x0, y0, x1, y1)
    raise GridError(f"box is {shown(ends)}, expected {expected}")


def check_grid(grid: OccupancyGrid) -> OccupancyGrid:
    """Return what is given as a grid if it is one."""
    return checks.instance("grid", grid, OccupancyGrid, "; load_map reads one", error=GridError)
