"""Shortening a path by line of sight, as a pymoo problem of real variables: what rivals of region of sight search."""

from __future__ import annotations

import functools

import numpy as np
from numpy.typing import ArrayLike
from pymoo.core.problem import Problem

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.grid import OccupancyGrid, check_grid
from pymoo_gridpath.neighbourhood import HEADING_OF
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.sight import along, visible
from pymoo_gridpath.search.waypoints import Waypoints


class ShorteningProblem(Problem):
    """Which cells of a road to pass, so that the way from one to the next is the shortest; the objective is its length.

    A gene is a place on the road: 0 at its start, 1 at its goal. Genes are decoded before anything is rated: scaled to the
    cells of the road, rounded, and sorted, with the start before and the goal behind; genes of the same cell count once. From
    one place to the next leads the straight line where one cell sees the other between the grown obstacles, and the road where
    it does not. So every row of genes stands for a legal path, what is lost by a bad choice is finite, and what swarms know
    to do with real numbers can be done.

    All rows are decoded and rated at once, lines of sight by one call of a compiled kernel.

    Parameters
    ----------
    grid : OccupancyGrid
        Without growth.
    road : array_like of int, shape (n, 2)
        Cells (x, y) of a path by legal steps, n at least 2, such as `SightPaths.initial` has.
    radius : float, default 0
        Cells by which obstacles grow for the lines of sight, such as `SightPaths.radius` has. Cells of the road stay free.
    n_points : int, default 10
        Genes of a row: the most places between start and goal; at most as many as the road has cells between them, or 1.

    Attributes
    ----------
    radius : float
    moves : Moves
        The legal steps between the grown obstacles.
    road : numpy.ndarray of int64, shape (n,)
        Indices of its cells, as ``moves`` counts them.
    travelled : numpy.ndarray of float, shape (n,)
        Euclidean length of the road from its start to each of its cells.

    Raises
    ------
    GridPathError
        If an argument is of another kind or out of its range, or the road is no path on the grid, with the first step that is
        none.

    Notes
    -----
    Places lie on the road alone, and every piece leads forward, so that the optimum is a shortest path with at most
    ``n_points + 1`` pieces in a graph without cycles. `pareto_front` and `pareto_set` find it by dynamic programming over all
    pairs of cells of the road: what the swarms are to be measured against. `RegionOfSight` begins every pass but the first on
    the cells of the path before, and so leaves the road.

    References
    ----------
    H. Hliwa and B. Atieh, "Multi objective path planning in static environment using region of sight", section III: the rivals
    of its tables shorten the same initial path. How they code it is not said; the coding is this package's own.

    Examples
    --------
    Around the end of a wall, where the road keeps away from it:

    >>> from pymoo.algorithms.soo.nonconvex.pso import PSO
    >>> from pymoo.optimize import minimize
    >>> occupied = np.zeros((8, 9))
    >>> occupied[:4, 4] = 1
    >>> road = [(1, y) for y in range(1, 7)] + [(x, 6) for x in range(2, 8)] + [(7, y) for y in range(5, 1, -1)]
    >>> problem = ShorteningProblem(OccupancyGrid(occupied), road, n_points=2)
    >>> result = minimize(problem, PSO(pop_size=20), ("n_gen", 20), seed=1)
    >>> result.F.round(3).tolist(), problem.pareto_front().round(3).tolist()
    ([10.831], [[10.831]])
    >>> problem.waypoints(result.X).cells.tolist()
    [[1, 1], [4, 6], [7, 2]]
    """

    def __init__(self, grid: OccupancyGrid, road: ArrayLike, radius: float = 0.0, n_points: int = 10):
        self.grid = check_grid(grid)
        self.radius = checks.number("radius", radius, 0.0, expected="a number of cells, zero or more")
        every = Moves(grid)
        self.road = _checked(road, grid, every)
        usable = ~grid.grow(self.radius).occupied.ravel()
        usable[self.road] = True
        self.moves = every.within(usable)
        self._cells = self.moves.cells(self.road)
        self.travelled = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(self._cells, axis=0).T))])
        n_points = checks.whole("n_points", n_points, 1, max(len(self.road) - 2, 1))
        super().__init__(n_var=n_points, n_obj=1, xl=0.0, xu=1.0)

    # -- from genes to paths --------------------------------------------------------------------------------------------------

    def decode(self, X: np.ndarray) -> np.ndarray:
        """Return the places that rows of genes stand for.

        Parameters
        ----------
        X : numpy.ndarray of float, shape (N, n_points)
            From 0 to 1.

        Returns
        -------
        numpy.ndarray of int64, shape (N, n_points + 2)
            Numbers of cells of the road, from 0, its start, to its last, rising; a place that stands twice counts once.

        Raises
        ------
        GridPathError
            If they are no such rows.
        """
        expected = f"rows of {self.n_var} numbers from 0 to 1"
        X = checks.array("X", X, (None, self.n_var), expected=expected, finite=True)
        if X.size and not (X.min() >= 0 and X.max() <= 1):
            raise GridPathError(f"X holds values below 0 or above 1, expected {expected}")
        last = len(self.road) - 1
        places = np.empty((len(X), self.n_var + 2), dtype=np.int64)
        places[:, 0], places[:, -1] = 0, last
        places[:, 1:-1] = np.rint(X * last)
        places.sort(axis=1)
        return places

    def encode(self, places: np.ndarray) -> np.ndarray:
        """Return genes of places: the inverse of `decode`.

        Parameters
        ----------
        places : numpy.ndarray of int, shape (N, n_points + 2)

        Returns
        -------
        numpy.ndarray of float, shape (N, n_points)
        """
        last = len(self.road) - 1
        expected = f"rows of {self.n_var + 2} whole numbers from 0 to {last}, rising"
        places = checks.array("places", places, (None, self.n_var + 2), "iu", expected=expected)
        ends = (places[:, 0] == 0) & (places[:, -1] == last)
        if not (ends.all() and (np.diff(places.astype(np.int64), axis=1) >= 0).all()):
            raise GridPathError(f"places hold other numbers, expected {expected}")
        return places[:, 1:-1] / last

    def waypoints(self, x: np.ndarray) -> Waypoints:
        """Return the corners of the path of one row of genes, shape (n_points,); each sees the next."""
        return Waypoints(self.grid, self.moves.cells(self._corners(x)))

    def cells(self, x: np.ndarray) -> np.ndarray:
        """Return the cells (x, y) of that path, shape (n, 2): a legal step leads from each to the next."""
        return self.moves.cells(along(self.moves.width, self._corners(x)))

    def _corners(self, x: np.ndarray) -> np.ndarray:
        """Return the indices of the corners of the path of a row of genes."""
        x = checks.array("x", x, (self.n_var,), expected=f"{self.n_var} numbers from 0 to 1")
        places = np.unique(self.decode(x[None]))
        kept = np.zeros(len(self.road), dtype=bool)
        kept[places] = True
        for begin, end in np.stack([places[:-1], places[1:]], axis=1)[~self._seen(places[:-1], places[1:])]:
            kept[begin:end] = True
        return self.road[kept]

    # -- what they are worth --------------------------------------------------------------------------------------------------

    def _evaluate(self, x, out, *args, **kwargs):
        places = self.decode(x)
        out["F"] = self._lengths(places[:, :-1], places[:, 1:]).sum(axis=1)[:, None]

    def _lengths(self, begin: np.ndarray, end: np.ndarray) -> np.ndarray:
        """Return the length of the piece from each of some places to another one, further on."""
        straight = np.hypot(*np.moveaxis(self._cells[end] - self._cells[begin], -1, 0))
        return np.where(self._seen(begin, end), straight, self.travelled[end] - self.travelled[begin])

    def _seen(self, begin: np.ndarray, end: np.ndarray) -> np.ndarray:
        """Return whether the cell at each of some places sees the one at another place."""
        return visible(self.moves, self.road[begin].ravel(), self.road[end].ravel()).reshape(begin.shape)

    @functools.cached_property
    def sight(self) -> np.ndarray:
        """Whether the cell at each place sees the one at another, further on, bool, shape (n, n); False below the diagonal."""
        n = len(self.road)
        seen = np.zeros((n, n), dtype=bool)
        for place in range(n - 1):
            ahead = np.arange(place + 1, n)
            seen[place, ahead] = self._seen(np.full_like(ahead, place), ahead)
        return seen

    # -- the optimum ----------------------------------------------------------------------------------------------------------

    def _calc_pareto_front(self, *args, **kwargs):
        return self.evaluate(self.pareto_set())

    def _calc_pareto_set(self, *args, **kwargs):
        n, cells = len(self.road), self._cells
        # Of k + 1 pieces from the start to each place: the least length, and the place before.
        least, before = np.full((self.n_var + 1, n), np.inf), np.zeros((self.n_var + 1, n), dtype=np.int64)
        for place in range(1, n):
            straight = np.hypot(*(cells[place] - cells[:place]).T)
            piece = np.where(self.sight[:place, place], straight, self.travelled[place] - self.travelled[:place])
            least[0, place] = piece[0]
            total = least[:-1, :place] + piece
            before[1:, place] = total.argmin(axis=1)
            least[1:, place] = total.min(axis=1)
        k, place = int(least[:, -1].argmin()), n - 1
        places = np.full((1, self.n_var + 2), n - 1)
        places[0, 0] = 0
        for piece in range(k, 0, -1):
            place = before[piece, place]
            places[0, piece] = place
        return self.encode(places)


def _checked(road: ArrayLike, grid: OccupancyGrid, moves: Moves) -> np.ndarray:
    """Return the indices of the cells of a road if it is a path on a grid."""
    expected = "a path of at least 2 cells (x, y), shape (n, 2), each of which a legal step leads to from the one before"
    cells = checks.array("road", road, (None, 2), "iu", expected=expected)
    sides = np.array([grid.width, grid.height])
    if len(cells) < 2:
        raise GridPathError(f"road has {len(cells)} cells, expected {expected}")
    outside = ((cells < 0) | (cells >= sides)).any(axis=1)
    if outside.any():
        x, y = cells[outside.argmax()].tolist()
        raise GridPathError(f"road has the cell ({x}, {y}), which lies outside the grid, expected {expected}")
    cells = cells.astype(np.int64)
    road, steps = cells[:, 1] * grid.width + cells[:, 0], np.diff(cells, axis=0)
    near = np.abs(steps).max(axis=1) == 1
    heading = HEADING_OF[tuple((np.where(near[:, None], steps, 1) + 1).T[::-1])]
    legal = near & (moves.legal[road[:-1]] >> heading.astype(np.uint8) & 1).astype(bool)
    if not legal.all():
        k = int(legal.argmin())
        (ax, ay), (bx, by) = cells[k : k + 2].tolist()
        raise GridPathError(f"road steps from ({ax}, {ay}) to ({bx}, {by}), which is no legal step, expected {expected}")
    return road
