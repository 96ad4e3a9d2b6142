"""Searches for one path, with counts of the cells that they look at, as pymoo algorithms."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import counted
from pymoo_gridpath.neighbourhood import Neighbourhood
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.planners.base import Plan, Planner, settled
from pymoo_gridpath.registry import register
from pymoo_gridpath.representations.base import representation_of
from pymoo_gridpath.search.counted import HEURISTICS, Found, best_first, breadth_first
from pymoo_gridpath.search.jump import jump_points, orthogonal_jump_points
from pymoo_gridpath.search.moves import Moves

_ESTIMATES = tuple(name for name in HEURISTICS if name != "none")


@dataclass(frozen=True)
class CountedPath:
    """The path that a search has found, and what it has looked at.

    Attributes
    ----------
    cells : numpy.ndarray of int, shape (n, 2)
        Cells (x, y) of the path; none if there is no path.
    opened : int
        Cells that were put on the list of those to go on from, each counted once.
    closed : int
        Cells that were gone on from, the goal included.
    tested : int
        Cells that a jump passed, as often as one did; 0 of searches without jumps.
    n_cells : int
        Cells that were opened, closed or tested, each counted once.
    """

    cells: np.ndarray
    opened: int
    closed: int
    tested: int
    n_cells: int

    @property
    def operations(self) -> int:
        """Cells that were opened, closed and tested, together: what the demo of PathFinding.js counts."""
        return self.opened + self.closed + self.tested


class CountedSearch(Planner):
    """Base of the searches for one path. They look at no objective, and take the length for the cost where they take any.

    Attributes
    ----------
    found : CountedPath
        Once it has run.
    """

    @abstractmethod
    def _search(self, moves: Moves, start: int, goal: int, neighbourhood: Neighbourhood) -> Found:
        """Return the path from a cell to another, by their indices, and what was looked at."""

    def plan(self, problem) -> Plan:
        moves = representation_of(problem).moves
        ends = moves.index(problem.start), moves.index(problem.goal)
        found = self._search(moves, *ends, problem.grid.neighbourhood)
        self.found = CountedPath(moves.cells(found.path), *found[1:])
        path = Sequences(found.path, np.array([0, len(found.path)] if len(found.path) else [0]))
        what = "found a path" if len(found.path) else "found no path"
        tested = f", {self.found.tested:,} tested" if self.found.tested else ""
        return settled(problem, path, f"{what}, {counted(found.opened, 'cell')} opened, {found.closed:,} closed{tested}")


def _heuristic(value: str) -> str:
    return checks.one_of("heuristic", value, _ESTIMATES)


@register
class AStar(CountedSearch):
    """A*: always on from the cell of least length so far and estimate of what is left, together.

    Parameters
    ----------
    heuristic : {"octile", "euclidean", "chebyshev", "manhattan"}, default "octile"
        The estimate: the length of the shortest path on an open grid, the straight line, the larger of what is left in x and in
        y, or both together. With all but the last the path is a shortest one. The last overrates what diagonal steps save: it
        looks at fewer cells, and the path may be longer.
    **kwargs
        What every pymoo algorithm takes, such as ``callback``.

    Attributes
    ----------
    found : CountedPath
        Once it has run.

    Raises
    ------
    CapabilityError
        If an argument is unknown.
    GridPathError
        If there is no such heuristic.

    Notes
    -----
    Of cells of equal sums the one with less left goes first. No cell is closed twice.

    References
    ----------
    P. E. Hart, N. J. Nilsson and B. Raphael, "A formal basis for the heuristic determination of minimum cost paths", IEEE
    Transactions on Systems Science and Cybernetics 4(2), 1968.

    Examples
    --------
    >>> from pymoo.optimize import minimize
    >>> from pymoo_gridpath import GridPathProblem, OccupancyGrid
    >>> problem = GridPathProblem(OccupancyGrid([[0, 0, 0, 0], [0, 1, 1, 0], [0, 0, 0, 0]]), (0, 0), (3, 1))
    >>> result = minimize(problem, AStar())
    >>> result.message, result.algorithm.found.cells.tolist()
    ('found a path, 6 cells opened, 5 closed', [[0, 0], [1, 0], [2, 0], [3, 0], [3, 1]])
    """

    name = "astar"

    def __init__(self, heuristic: str = "octile", **kwargs):
        super().__init__(**kwargs)
        self.heuristic = _heuristic(heuristic)

    def _search(self, moves: Moves, start: int, goal: int, neighbourhood: Neighbourhood) -> Found:
        return best_first(moves, start, goal, self.heuristic)


@register
class Dijkstra(CountedSearch):
    """Dijkstra's search: always on from the cell of least length so far, until the goal is closed. The path is a shortest one.

    Parameters
    ----------
    **kwargs
        What every pymoo algorithm takes, such as ``callback``.

    Attributes
    ----------
    found : CountedPath
        Once it has run.

    Raises
    ------
    CapabilityError
        If an argument is unknown.

    References
    ----------
    E. W. Dijkstra, "A note on two problems in connexion with graphs", Numerische Mathematik 1, 1959.
    """

    name = "dijkstra"

    def _search(self, moves: Moves, start: int, goal: int, neighbourhood: Neighbourhood) -> Found:
        return best_first(moves, start, goal)


@register
class BreadthFirst(CountedSearch):
    """Breadth-first search: on from cells in the order in which they were opened. The path has the fewest steps.

    Neighbours are opened in the order below, right, above, left, and then the diagonal ones counter-clockwise from below left.

    Parameters
    ----------
    **kwargs
        What every pymoo algorithm takes, such as ``callback``.

    Attributes
    ----------
    found : CountedPath
        Once it has run.

    Raises
    ------
    CapabilityError
        If an argument is unknown.
    """

    name = "breadth-first"

    def _search(self, moves: Moves, start: int, goal: int, neighbourhood: Neighbourhood) -> Found:
        return breadth_first(moves, start, goal)


@register
class BestFirst(CountedSearch):
    """Greedy best-first search: always on from the cell that is nearest to the goal by an estimate. It promises no length.

    Parameters
    ----------
    heuristic : {"octile", "euclidean", "chebyshev", "manhattan"}, default "octile"
        The estimate, see `AStar`. Of equal cells that of least length so far goes first.
    **kwargs
        What every pymoo algorithm takes, such as ``callback``.

    Attributes
    ----------
    found : CountedPath
        Once it has run.

    Raises
    ------
    CapabilityError
        If an argument is unknown.
    GridPathError
        If there is no such heuristic.
    """

    name = "best-first"

    def __init__(self, heuristic: str = "octile", **kwargs):
        super().__init__(**kwargs)
        self.heuristic = _heuristic(heuristic)

    def _search(self, moves: Moves, start: int, goal: int, neighbourhood: Neighbourhood) -> Found:
        return best_first(moves, start, goal, self.heuristic, greedy=True)


@register
class JumpPointSearch(CountedSearch):
    """Jump point search: A* that opens only cells where a shortest path may have to bend, and jumps over the others.

    Parameters
    ----------
    heuristic : {"octile", "euclidean", "chebyshev", "manhattan"}, default "octile"
        The estimate, see `AStar`. With all but the last the path is a shortest one.
    **kwargs
        What every pymoo algorithm takes, such as ``callback``.

    Attributes
    ----------
    found : CountedPath
        Once it has run.

    Raises
    ------
    CapabilityError
        If an argument is unknown; when the run begins, if the coding knows only paths that never turn back, since jumps rely on
        all eight steps.
    GridPathError
        If there is no such heuristic.

    References
    ----------
    D. Harabor and A. Grastien, "Online graph pruning for pathfinding on grid maps", AAAI 2011; for corners that may not be cut,
    the same authors, "Improving jump point search", ICAPS 2014.
    """

    name = "jps"
    turns_back = True

    def __init__(self, heuristic: str = "octile", **kwargs):
        super().__init__(**kwargs)
        self.heuristic = _heuristic(heuristic)

    def _search(self, moves: Moves, start: int, goal: int, neighbourhood: Neighbourhood) -> Found:
        return jump_points(moves, start, goal, neighbourhood, self.heuristic)


@register
class OrthogonalJumpPointSearch(CountedSearch):
    """Jump point search by straight steps alone, up and down first. The path is a shortest one of such steps.

    Where only diagonal steps between two occupied cells lead to the goal there is none, and the Result says so.

    Parameters
    ----------
    **kwargs
        What every pymoo algorithm takes, such as ``callback``.

    Attributes
    ----------
    found : CountedPath
        Once it has run.

    Raises
    ------
    CapabilityError
        If an argument is unknown; when the run begins, if the coding knows only paths that never turn back.
    """

    name = "orthogonal-jps"
    turns_back = True

    def _search(self, moves: Moves, start: int, goal: int, neighbourhood: Neighbourhood) -> Found:
        return orthogonal_jump_points(moves, start, goal)
