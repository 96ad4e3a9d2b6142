"""Quadrant selection as a pymoo algorithm."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import counted
from pymoo_gridpath.neighbourhood import TURN_UNIT
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.planners.base import Plan, Planner, settled
from pymoo_gridpath.registry import register
from pymoo_gridpath.representations.base import representation_of
from pymoo_gridpath.search.alternatives import GOAL, NOWHERE, cost_of, measure, quickest, unfold
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.quadrant import Branches, branches, octile
from pymoo_gridpath.search.sight import smoothed
from pymoo_gridpath.search.waypoints import Waypoints

# Larger numbers of paths say no more than their size.
_MOST_WRITTEN = 10**12

# More alternatives are no list that anybody reads, and take gigabytes.
_MOST_PATHS = 1000


@dataclass(frozen=True)
class QuadrantPaths:
    """What quadrant selection has found.

    Attributes
    ----------
    raw : list of numpy.ndarray, each of shape (n, 2)
        Cells (x, y) of the alternatives before they are smoothed, the quickest first; as many as ``max_paths``, if there are.
        They are worked out when they are asked for.
    seconds : numpy.ndarray, shape (len(raw),)
        Travel time of each of them.
    waypoints : list of Waypoints
        Of each path that is returned.
    n_alternatives : int
        How many ways there are to pass each obstacle that is hit on one side or the other.
    probes : int
        How often a step was tested, the same one again included.
    cells, free_cells : int
        How many cells were looked at, each counted once, and how many of these are free: the number to compare with the
        ``n_cells`` of a `CountedPath`, which counts no occupied ones.
    """

    seconds: np.ndarray
    waypoints: list[Waypoints]
    n_alternatives: int
    probes: int
    cells: int
    free_cells: int
    _moves: Moves = field(repr=False)
    _paths: list[np.ndarray] = field(repr=False)

    @cached_property
    def raw(self) -> list[np.ndarray]:
        if not self._paths:
            return []
        ends = np.cumsum([len(path) for path in self._paths])
        return np.split(self._moves.cells(np.concatenate(self._paths)), ends[:-1])


@register
class QuadrantSelection(Planner):
    """Go straight for the goal, around obstacles both ways, and take the quickest of the paths.

    From each cell the path steps in the direction of the signs of what is left in x and y. Where that step is not legal, it
    branches: one path follows the obstacle clockwise, the other counter-clockwise, until it comes to a cell nearer to the goal
    than where it hit the obstacle that lies on the unhindered way from there, or from which the next step to the goal is legal.
    The paper has no such rule, so that by its letter most queries among walls have no path; with it every query that has one
    is solved. Of all paths the one of least travel time is smoothed: from its start it jumps to the last cell in line of sight,
    and so on. The objectives of the problem are not looked at.

    Parameters
    ----------
    speed : float, default 0.24
        Metres per second; the paper's robot. On a map in cells, which says nothing of metres, cells per second.
    turn_seconds : float, default 0.02
        Seconds that a turn of one degree takes. The first step turns by nothing.
    alternatives : int, default 1
        How many paths to return, the quickest first; those that are the same once smoothed count once.
    smooth : bool, default True
        Whether to smooth them.
    max_paths : int, default 64
        How many alternatives to list in ``found``. They are the quickest by the time of the walk that finds them; loops are cut
        then, and the list sorted by the time of what is left. So the first is the quickest of all where there are no more
        alternatives than that, and nearly always where there are. Time and memory grow with it.
    strict : bool, default False
        Whether to keep to the letter of the paper: at an obstacle only the two cells beside the blocked step are tried, and no
        obstacle is followed. It often finds nothing, and then says so.
    **kwargs
        What every pymoo algorithm takes, such as ``callback``.

    Attributes
    ----------
    found : QuadrantPaths
        Once it has run.

    Raises
    ------
    CapabilityError
        If an argument is unknown; when the run begins, if the coding knows only paths that never turn back, or the grid has no
        diagonal steps.
    GridPathError
        If a number is not positive, alternatives is larger than max_paths, or max_paths larger than 1,000.

    Notes
    -----
    The paper multiplies the distance by the speed in its equation 1; here it is divided. Of paths that take the same time the
    shorter comes first, then the one that turns less, then the one that goes clockwise.

    References
    ----------
    K. Rajchandar, R. Baskaran, K. Padmanabhan Panchu and M. Rajmohan, "An approach to improve multi-objective path planning for
    mobile robot navigation using the novel quadrant selection method", Defence Science Journal 71(6), 2021, sections 2.1 and 3.

    Examples
    --------
    >>> from pymoo.optimize import minimize
    >>> from pymoo_gridpath import GridPathProblem, OccupancyGrid
    >>> grid = OccupancyGrid([[0, 0, 0, 0, 0], [0, 0, 1, 1, 0], [0, 0, 0, 0, 0]])
    >>> problem = GridPathProblem(grid, (0, 0), (4, 2))
    >>> planner = QuadrantSelection()
    >>> result = minimize(problem, planner)
    >>> result.message
    'found 2 paths, which branch in 1 place'
    >>> found = result.algorithm.found
    >>> found.seconds.round(1).tolist(), found.raw[0].tolist()
    ([25.3, 37.2], [[0, 0], [1, 1], [1, 2], [2, 2], [3, 2], [4, 2]])
    >>> found.waypoints[0].cells.tolist()
    [[0, 0], [1, 2], [4, 2]]
    """

    name = "qsa"
    turns_back = True
    goes_diagonally = True

    def __init__(
        self,
        speed: float = 0.24,
        turn_seconds: float = 0.02,
        alternatives: int = 1,
        smooth: bool = True,
        max_paths: int = 64,
        strict: bool = False,
        **kwargs,
    ):
        super().__init__(**kwargs)
        self.speed = checks.number("speed", speed, 0.0, above=True, expected="a positive number of metres per second")
        self.turn_seconds = checks.number("turn_seconds", turn_seconds, 0.0, expected="a number of seconds, zero or more")
        self.max_paths = checks.whole("max_paths", max_paths, 1, _MOST_PATHS)
        self.alternatives = checks.whole(
            "alternatives", alternatives, 1, self.max_paths, expected=f"a whole number from 1 to max_paths, {self.max_paths}"
        )
        self.smooth = checks.flag("smooth", smooth)
        self.strict = checks.flag("strict", strict)

    def plan(self, problem) -> Plan:
        moves, grid = representation_of(problem).moves, problem.grid
        start, goal = moves.index(problem.start), moves.index(problem.goal)
        found = branches(moves, grid, start, goal, self.strict)
        order = np.argsort([octile(moves.width, hit, goal) for hit in found.hits], kind="stable").astype(np.int64)
        raw, seconds = self._listed(found, order, moves, grid.resolution or 1.0)
        chosen = self._chosen(raw, moves)
        self.found = QuadrantPaths(
            seconds,
            [Waypoints(grid, moves.cells(waypoints)) for waypoints, _ in chosen],
            _count(found.to, order),
            found.n_probes,
            found.n_cells,
            found.n_free,
            moves,
            raw,
        )
        paths = [path for _, path in chosen]
        cells = np.concatenate(paths) if paths else np.empty(0, dtype=np.int64)
        offsets = np.cumsum([0, *map(len, paths)], dtype=np.int64)
        return settled(problem, Sequences(cells, offsets), self._message(found))

    def _listed(self, found: Branches, order: np.ndarray, moves: Moves, resolution: float) -> tuple[list, np.ndarray]:
        """Return the cells of the quickest alternatives and their travel times."""
        per_cell, per_turn = resolution / self.speed, TURN_UNIT * self.turn_seconds
        measures = found.measures, found.first, found.last
        ways, _, then = quickest(found.to, *measures, order, self.max_paths, per_cell, per_turn)
        cells, offsets = unfold(found.cells, found.ends, found.to, ways, then, moves.n_cells)
        counts, _, _ = measure(moves.legal, moves.offsets, cells, offsets)
        straight, diagonal, turn = counts.T.copy()
        time, length, _ = cost_of(straight, diagonal, turn, per_cell, per_turn)
        by_time = np.lexsort((turn, length, time))
        seconds = (length * per_cell + turn * per_turn)[by_time]
        return [cells[offsets[k] : offsets[k + 1]] for k in by_time], seconds

    def _chosen(self, raw: list[np.ndarray], moves: Moves) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return waypoints and cells of the paths to return."""
        chosen: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}
        for path in raw:
            waypoints, cells = smoothed(moves, path) if self.smooth else (path, path)
            chosen.setdefault(cells.tobytes(), (waypoints, cells))
            if len(chosen) == self.alternatives:
                break
        return list(chosen.values())

    def _message(self, found: Branches) -> str:
        if not len(found.hits):
            return "met no obstacle"
        places = counted(len(found.hits), "place")
        if self.found.n_alternatives:
            return f"found {_counted_paths(self.found.n_alternatives)}, which branch in {places}"
        stuck = np.count_nonzero((found.to[1::2] == NOWHERE) & (found.to[2::2] == NOWHERE))
        return f"found no path: in {stuck} of {places} where it met an obstacle, both steps beside the blocked one are illegal"


def _counted_paths(n: int) -> str:
    """Return the number of paths in words; of very many, which Python itself may refuse to write out, the power of ten."""
    return counted(n, "path") if n < _MOST_WRITTEN else f"about 10^{math.floor(math.log10(2) * (n.bit_length() - 1))} paths"


def _count(to: np.ndarray, order: np.ndarray) -> int:
    """Return the number of ways from the start to the goal, as large as it may be."""
    ways = {int(GOAL): 1, int(NOWHERE): 0}
    ends = to.tolist()
    for hit in order.tolist():
        ways[hit] = ways[ends[1 + 2 * hit]] + ways[ends[2 + 2 * hit]]
    return ways[ends[0]]
