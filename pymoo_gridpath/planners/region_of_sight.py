"""Region of sight as a pymoo algorithm."""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import CapabilityError, counted
from pymoo_gridpath.fields import clearance
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.planners.base import Plan, Planner, settled
from pymoo_gridpath.registry import register
from pymoo_gridpath.representations.base import Representation, representation_of
from pymoo_gridpath.search.counted import best_first
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.road import way_to, with_legal_steps
from pymoo_gridpath.search.sight import path_length, shorten
from pymoo_gridpath.search.waypoints import Waypoints

_ROADS, _SEARCHES = ("skeleton", "shortest"), ("best", "shortest")

# The paper's distance to obstacles, as a share of the shorter side of the map.
_SHARE = 0.01

# Lengths that differ by less, in cells, are equal.
_ROUNDING = 1e-9

# No obstacle grows by so few cells or less.
_NO_GROWTH = 0.5


@dataclass(frozen=True)
class SightPaths:
    """What region of sight has found: one path, or with ``sweep`` one for each radius that changes it.

    Attributes
    ----------
    grid : OccupancyGrid
        Without the growth.
    radius : numpy.ndarray of float, shape (n,)
        Cells by which the obstacles were grown for each path; with ``sweep`` the largest number that gives the path.
    initial : list of numpy.ndarray, each of shape (m, 2)
        Cells (x, y) of each path before it was shortened.
    cells : list of numpy.ndarray, each of shape (m, 2)
        And after.
    waypoints : list of Waypoints
    lengths : list of numpy.ndarray
        Euclidean length in cells before the first pass, and after each.
    fallback : numpy.ndarray of bool, shape (n,)
        Whether each path began as a shortest one, since the road did not join start and goal or the path by it had no room in a
        row of genes.
    """

    grid: OccupancyGrid
    radius: np.ndarray
    initial: list[np.ndarray]
    cells: list[np.ndarray]
    waypoints: list[Waypoints]
    lengths: list[np.ndarray]
    fallback: np.ndarray

    @property
    def passes(self) -> np.ndarray:
        """Number of passes of each path, int, shape (n,), those at the end that gained next to nothing included."""
        return np.array([len(lengths) - 1 for lengths in self.lengths], dtype=int)

    @functools.cached_property
    def clearance(self) -> np.ndarray:
        """Least distance in cells of each path from the centre of a cell to that of an obstacle, shape (n,)."""
        field = clearance(self.grid)
        return np.array([field[cells[:, 1], cells[:, 0]].min() for cells in self.cells])

    @property
    def curvature(self) -> np.ndarray:
        """Greatest and mean curvature of each path, 1 / m, shape (n, 2); see `Waypoints`."""
        return np.array([waypoints.curvature for waypoints in self.waypoints]).reshape(-1, 2)


class _Query:
    """A query, with the distance between its ends, and the length of its shortest path, which few radii ask for.

    Parameters
    ----------
    problem : GridPathProblem
    """

    def __init__(self, problem):
        self.representation: Representation = representation_of(problem)
        self.moves: Moves = self.representation.moves
        self.grid: OccupancyGrid = problem.grid
        self.start, self.goal = self.moves.index(problem.start), self.moves.index(problem.goal)
        self.apart = math.dist(problem.start, problem.goal)

    @functools.cached_property
    def shortest(self) -> float:
        """Length of the shortest path in cells."""
        return path_length(self.moves, best_first(self.moves, self.start, self.goal, "octile").path)

    def fits(self, cells: np.ndarray) -> bool:
        """Return whether a row of genes has room for a path."""
        return bool(self.representation.fits(Sequences(cells, np.array([0, len(cells)])))[0])


class _Sighted(NamedTuple):
    """A path at one radius, by indices of cells."""

    radius: float
    initial: np.ndarray
    waypoints: np.ndarray
    cells: np.ndarray
    lengths: np.ndarray
    fallback: bool


@register
class RegionOfSight(Planner):
    """Grow the obstacles, find a path on a road between them, and shorten it by jumping to the last of its cells in sight.

    A path so keeps a distance to the obstacles, and is shortened forward and backward in turn until neither pass gains a tenth
    of a cell. Start and goal that lie closer to an obstacle leave by the shortest way. Where no path is left between the grown
    obstacles, none that has room in a row of genes, or both ways out together are as long as a path from start to goal, they
    grow by one cell less, and so on, at last not at all, so that every query that has a path is solved. The objectives of the
    problem are not looked at.

    Parameters
    ----------
    radius : float, optional
        Metres by which to grow the obstacles, besides what the map was inflated by; by default 1 % of the shorter side of the
        map, rounded up to whole cells, as in the paper.
    road : {"skeleton", "shortest"}, default "skeleton"
        Where to look for the path: on the lines midway between obstacles, found by topological thinning, which needs
        scikit-image, the ``planners`` extra; or anywhere, and then it is a shortest path.
    search : {"best", "shortest"}, default "best"
        The search on the road: best-first by the straight line to the goal, as in the paper, or for the shortest path.
    sweep : bool, default False
        Whether to return a path for each radius of 0, 1, 2 and so on cells while there is one: a set of trade-offs between
        length and distance to obstacles. Those that are the same count once.
    max_passes : int, default 100
        Passes of shortening at most.
    **kwargs
        What every pymoo algorithm takes, such as ``callback``.

    Attributes
    ----------
    found : SightPaths
        Once it has run.

    Raises
    ------
    CapabilityError
        If an argument is unknown; if the road is "skeleton" and scikit-image is not installed; when the run begins, if the
        coding knows only paths that never turn back.
    GridPathError
        If an argument is out of its range, or a radius is given to a sweep.

    Notes
    -----
    The radius is a floor: no cell of a path is nearer to an obstacle, but for the ways out at both ends. Steps and lines of
    sight may pass a corner of the growth, never one of an obstacle that the grid forbids to cut. The paper's equation 1 for the
    radius gives distances a hundred times wider than its maps; this is its equation 7. Its region of sight, a sector of a
    circle, is but a way to find the last cell in sight. Its algorithm 1 need not end, since rounding to cells moves points;
    here a pass counts only if the path is shorter after it. Of cells that are equally near to the goal the search goes on from
    that of least length so far. Thinning is of the grid as it lies: that of its mirror image may differ.

    References
    ----------
    H. Hliwa and B. Atieh, "Multi objective path planning in static environment using region of sight".

    Examples
    --------
    >>> from pymoo.optimize import minimize
    >>> from pymoo_gridpath import GridPathProblem, OccupancyGrid
    >>> occupied = np.zeros((7, 9))
    >>> occupied[:4, 4] = 1
    >>> problem = GridPathProblem(OccupancyGrid(occupied), (1, 1), (7, 1))
    >>> result = minimize(problem, RegionOfSight(road="shortest"))
    >>> result.message
    'found a path at a radius of 1 cell in 4 passes'
    >>> found = result.algorithm.found
    >>> found.waypoints[0].cells.tolist(), found.clearance.tolist()
    ([[1, 1], [2, 4], [3, 5], [5, 5], [6, 4], [7, 1]], [2.0])
    """

    name = "ros"
    turns_back = True

    def __init__(
        self,
        radius: float | None = None,
        road: str = "skeleton",
        search: str = "best",
        sweep: bool = False,
        max_passes: int = 100,
        **kwargs,
    ):
        super().__init__(**kwargs)
        self.sweep = checks.flag("sweep", sweep)
        expected = "a number of metres, zero or more" if not self.sweep else "None: sweep=True takes one radius after another"
        most = -1.0 if self.sweep else math.inf
        self.radius = None if radius is None else checks.number("radius", radius, 0.0, most, expected=expected)
        self.road = checks.one_of("road", road, _ROADS)
        self.search = checks.one_of("search", search, _SEARCHES)
        self.max_passes = checks.whole("max_passes", max_passes, 1)
        if self.road == "skeleton":
            _skeletonize()

    def plan(self, problem) -> Plan:
        query = _Query(problem)
        moves, grid = query.moves, query.grid
        if self.sweep:
            # Without an obstacle nothing grows, and the radius makes no difference.
            radii = map(float, itertools.count() if grid.n_occupied else range(1))
            every = itertools.takewhile(lambda one: one is not None, (self._at(radius, query) for radius in radii))
        else:
            every = (self._at(radius, query) for radius in self._radii(grid))
            every = itertools.islice((one for one in every if one is not None), 1)
        paths: dict[bytes, _Sighted] = {}
        for one in every:
            assert one is not None
            paths.pop(one.cells.tobytes(), None)
            paths[one.cells.tobytes()] = one
        sighted = list(paths.values())
        self.found = SightPaths(
            grid,
            np.array([one.radius for one in sighted]),
            [moves.cells(one.initial) for one in sighted],
            [moves.cells(one.cells) for one in sighted],
            [Waypoints(grid, moves.cells(one.waypoints)) for one in sighted],
            [one.lengths for one in sighted],
            np.array([one.fallback for one in sighted], dtype=bool),
        )
        cells = np.concatenate([one.cells for one in sighted])
        offsets = np.cumsum([0, *(len(one.cells) for one in sighted)], dtype=np.int64)
        return settled(problem, Sequences(cells, offsets), self._message(grid))

    def _wanted(self, grid: OccupancyGrid) -> float:
        """Return the radius that was asked for, in cells."""
        return float(math.ceil(_SHARE * min(grid.shape))) if self.radius is None else grid.radius_in_cells(self.radius)

    def _radii(self, grid: OccupancyGrid) -> Iterator[float]:
        """Yield the radius that was asked for, and then lower ones down to none."""
        cells = self._wanted(grid)
        yield cells
        while cells > 0:
            cells = cells - 1 if cells - 1 > _NO_GROWTH else 0.0
            yield cells

    def _at(self, radius: float, query: _Query) -> _Sighted | None:
        """Return a path between obstacles that are grown by so many cells, or None if there is none."""
        moves, start, goal = query.moves, query.start, query.goal
        # No grid is made of them, which would take a tenth of the time.
        usable = ~query.grid._grown(radius)[moves.box.slices].ravel()
        ways = [way_to(moves, end, usable) for end in (start, goal)]
        if not all(map(len, ways)):
            return None
        out = sum(path_length(moves, way) for way in ways)
        # No path is shorter than the straight line, which costs no search.
        if out >= query.apart and out >= query.shortest - _ROUNDING:
            return None
        usable[np.concatenate(ways)] = True
        inside = moves.within(usable)
        shortest = best_first(inside, start, goal, "octile").path
        if not len(shortest):
            return None
        if self.road == "skeleton":
            on_road = self._search(_road(inside, usable, start, goal), start, goal)
            if len(on_road):
                sighted = _Sighted(radius, on_road, *shorten(inside, on_road, self.max_passes), False)
                if query.fits(sighted.cells):
                    return sighted
        sighted = _Sighted(radius, shortest, *shorten(inside, shortest, self.max_passes), self.road == "skeleton")
        # Of the last of all radii it is returned even so: the message then says that it has no room.
        return sighted if radius == 0 or query.fits(sighted.cells) else None

    def _search(self, road: Moves, start: int, goal: int) -> np.ndarray:
        """Return a path on a road; of no cells if there is none."""
        if self.search == "best":
            return best_first(road, start, goal, "euclidean", greedy=True).path
        return best_first(road, start, goal, "octile").path

    def _message(self, grid: OccupancyGrid) -> str:
        found, most = self.found, int(self.found.passes.max())
        if self.sweep:
            message = f"found {counted(len(found.radius), 'path')} at radii up to {_in_cells(found.radius[-1])}"
        else:
            wanted, held = self._wanted(grid), found.radius[0]
            message = f"found a path at a radius of {_in_cells(held)} in {most} pass{'es' * (most > 1)}"
            message += f"; none at {_in_cells(wanted)}" * bool(held < wanted)
        fallback = np.count_nonzero(found.fallback)
        return message + f"; {fallback} of {counted(len(found.radius), 'path')} not by the road" * bool(fallback)


def _in_cells(radius: float) -> str:
    return "1 cell" if radius == 1 else f"{radius:g} cells"


def _road(moves: Moves, usable: np.ndarray, start: int, goal: int) -> Moves:
    """Return the steps on the lines midway between obstacles, and on the shortest ways there from the start and the goal."""
    # The edge of the map is an obstacle like any other: without a rim of walls the thinning does not see it.
    walled = np.pad(usable.reshape(moves.height, moves.width), 1)
    road = with_legal_steps(moves, _skeletonize()(walled)[1:-1, 1:-1].ravel())
    ways = [way_to(moves, end, road) for end in (start, goal)]
    road[np.concatenate(ways)] = True
    return moves.within(road)


def _skeletonize() -> Callable[..., Any]:
    """Return the function that thins."""
    try:
        # The rest of the package does without it.
        from skimage.morphology import skeletonize
    except ImportError as error:
        raise CapabilityError(
            f"RegionOfSight needs the package scikit-image for its road, which cannot be imported ({error}); "
            "pip install 'pymoo_gridpath[planners]', or give road='shortest'"
        ) from None
    return skeletonize
