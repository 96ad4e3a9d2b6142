"""Shortest paths of other libraries, each called as its documentation says, behind one face: set up once, then query."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator
from importlib import import_module
from typing import Any

import numpy as np
from peer_libraries.base import Peer

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.errors import UnreachableError
from pymoo_gridpath.exact import exact_front
from pymoo_gridpath.grid import Cell, CornerCutting
from pymoo_gridpath.neighbourhood import ONE_SIDE, SQRT2
from pymoo_gridpath.search.counted import best_first
from pymoo_gridpath.search.jump import jump_points
from pymoo_gridpath.search.moves import Moves

# Where a path is asked for and there is none.
NO_PATH = np.empty((0, 2), dtype=int)

# The rule of MovingAI's benchmark.
NEVER = False


class PathPeer(Peer, ABC):
    """A library's shortest paths on a grid.

    Parameters
    ----------
    rule : bool or str
        How corners are passed, as `OccupancyGrid` has it: True for cut, False for never cut, or "one side".

    Attributes
    ----------
    diagonal : float
        What a diagonal step costs where a straight one costs 1.
    graph : bool
        Whether it knows graphs alone, so that corners are passed as whoever builds one has it.
    exact : bool
        Whether its paths are the cheapest at its cost of a diagonal.
    """

    diagonal = SQRT2
    graph = False
    exact = True

    def __init__(self, rule: CornerCutting = True):
        self.rule: CornerCutting = rule

    @abstractmethod
    def set_up(self, grid: OccupancyGrid) -> None:
        """Make what serves all queries on a grid, whose own corner rule is `rule`."""

    @abstractmethod
    def query(self, start: Cell, goal: Cell) -> np.ndarray:
        """Return the cells (x, y) of a path with both ends, shape (n, 2); `NO_PATH` if there is none."""


# -- ours ---------------------------------------------------------------------------------------------------------------------


class OurAStar(PathPeer):
    label = "pymoo_gridpath, A\\* (compiled)"

    def set_up(self, grid):
        self.moves, self.neighbourhood = Moves(grid), grid.neighbourhood

    def search(self, start: int, goal: int) -> Any:
        return best_first(self.moves, start, goal, "octile")

    def query(self, start, goal):
        return self.moves.cells(self.search(self.moves.index(start), self.moves.index(goal)).path)


class OurJumpPoints(OurAStar):
    label = "pymoo_gridpath, jump points (compiled)"

    def search(self, start, goal):
        return jump_points(self.moves, start, goal, self.neighbourhood)


class OurProblem(PathPeer):
    label = "pymoo_gridpath, `exact_front` of the length, problem included"

    def set_up(self, grid):
        self.grid = grid
        # Worked out once for all queries on a map.
        _ = grid.regions

    def query(self, start, goal):
        try:
            problem = GridPathProblem(self.grid, start, goal, "cells", ["length"])
        except UnreachableError:
            return NO_PATH
        return problem.decode(exact_front(problem).X).cells(0)


# -- graphs -------------------------------------------------------------------------------------------------------------------


def edges(grid: OccupancyGrid) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return tails, heads and lengths of the steps of a grid, each once; cell (x, y) is y * width + x.

    Written without the package's own rules, to be compared with them.
    """
    free = ~grid.occupied
    number = np.arange(free.size).reshape(free.shape)
    parts = []
    for dy, dx in ((0, 1), (1, 0), (1, 1), (1, -1)):
        here = slice(0, free.shape[0] - dy), slice(max(0, -dx), free.shape[1] - max(0, dx))
        there = slice(dy, None), slice(max(0, dx), free.shape[1] - max(0, -dx))
        legal = free[here] & free[there]
        if dx and dy and grid.corner_cutting is not True:
            beside = free[here[0], there[1]], free[there[0], here[1]]
            legal &= beside[0] | beside[1] if grid.corner_cutting == ONE_SIDE else beside[0] & beside[1]
        parts.append((number[here][legal], number[there][legal], np.full(legal.sum(), math.hypot(dx, dy))))
    tails, heads, lengths = (np.concatenate(part) for part in zip(*parts, strict=True))
    return tails, heads, lengths


class GraphPeer(PathPeer):
    graph = True

    def set_up(self, grid):
        self.width, self.n_cells = grid.width, grid.occupied.size
        self.build(*edges(grid))

    @abstractmethod
    def build(self, tails: np.ndarray, heads: np.ndarray, lengths: np.ndarray) -> None: ...

    @abstractmethod
    def path(self, start: int, goal: int) -> Any: ...

    def query(self, start, goal):
        path = np.asarray(self.path(start[1] * self.width + start[0], goal[1] * self.width + goal[0]), dtype=int)
        return np.stack([path % self.width, path // self.width], axis=-1)

    def octile(self, node: int, goal: int) -> float:
        """Return the length of a shortest path on an open grid."""
        dx, dy = abs(node % self.width - goal % self.width), abs(node // self.width - goal // self.width)
        return max(dx, dy) + (SQRT2 - 1) * min(dx, dy)


class Scipy(GraphPeer):
    package, module, licence = "scipy", "scipy.sparse.csgraph", "BSD-3-Clause"
    label = "scipy, `csgraph.dijkstra`, to all cells"

    def build(self, tails, heads, lengths):
        sparse: Any = import_module("scipy.sparse")
        both = np.concatenate([tails, heads]).astype(np.int32), np.concatenate([heads, tails]).astype(np.int32)
        self.graph_of = sparse.csr_array((np.tile(lengths, 2), both), shape=(self.n_cells, self.n_cells))
        self.dijkstra = import_module(self.module).dijkstra

    def path(self, start, goal):
        before = self.dijkstra(self.graph_of, indices=start, return_predecessors=True)[1]
        path = [goal]
        while path[-1] != start:
            path.append(int(before[path[-1]]))
            if path[-1] < 0:
                return []
        return path[::-1]


class Networkx(GraphPeer):
    package = module = "networkx"
    licence = "BSD-3-Clause"
    label = "networkx, `dijkstra_path`"

    def build(self, tails, heads, lengths):
        self.nx: Any = import_module("networkx")
        self.graph_of = self.nx.Graph()
        self.graph_of.add_nodes_from(range(self.n_cells))
        self.graph_of.add_weighted_edges_from(zip(tails.tolist(), heads.tolist(), lengths.tolist(), strict=True))

    def search(self, start: int, goal: int) -> list[int]:
        return self.nx.dijkstra_path(self.graph_of, start, goal)

    def path(self, start, goal):
        try:
            return self.search(start, goal)
        except self.nx.NetworkXNoPath:
            return []


class NetworkxAStar(Networkx):
    label = "networkx, `astar_path`, octile"

    def search(self, start, goal):
        return self.nx.astar_path(self.graph_of, start, goal, self.octile)


class Rustworkx(GraphPeer):
    package = module = "rustworkx"
    licence = "Apache-2.0"
    label = "rustworkx, `dijkstra_shortest_paths`"

    def build(self, tails, heads, lengths):
        self.rx: Any = import_module("rustworkx")
        self.graph_of = self.rx.PyGraph(multigraph=False)
        self.graph_of.add_nodes_from(range(self.n_cells))
        self.graph_of.add_edges_from(list(zip(tails.tolist(), heads.tolist(), lengths.tolist(), strict=True)))

    def path(self, start, goal):
        found = self.rx.dijkstra_shortest_paths(self.graph_of, start, target=goal, weight_fn=float)
        return list(found[goal]) if goal in found else []


class RustworkxAStar(Rustworkx):
    label = "rustworkx, `astar_shortest_path`, octile"

    def path(self, start, goal):
        try:
            found = self.rx.astar_shortest_path(
                self.graph_of, start, lambda node: node == goal, float, lambda node: self.octile(node, goal)
            )
        except self.rx.NoPathFound:
            return []
        return list(found)


# -- grids --------------------------------------------------------------------------------------------------------------------


class Skimage(PathPeer):
    package, module, licence = "scikit-image", "skimage.graph", "BSD-3-Clause"
    label = "scikit-image, `route_through_array`"
    geometric = True

    def set_up(self, grid):
        self.costs = np.where(grid.occupied, -1.0, 1.0)
        self.route: Any = import_module(self.module).route_through_array

    def query(self, start, goal):
        try:
            path, _ = self.route(self.costs, start[::-1], goal[::-1], geometric=self.geometric)
        except ValueError:
            # That is how it says that there is none.
            return NO_PATH
        return np.array(path)[:, ::-1]


class SkimageNotGeometric(Skimage):
    label = "scikit-image, `geometric=False`"
    geometric = False
    diagonal = 1.0


class Pathfinding(PathPeer):
    package = module = "pathfinding"
    licence = "MIT"
    label = "pathfinding, `AStarFinder`"
    finder = "a_star", "AStarFinder"

    def set_up(self, grid):
        movement: Any = import_module("pathfinding.core.diagonal_movement").DiagonalMovement
        rules = {True: movement.always, ONE_SIDE: movement.if_at_most_one_obstacle, NEVER: movement.only_when_no_obstacle}
        self.grid: Any = import_module("pathfinding.core.grid").Grid(matrix=(~grid.occupied).astype(int).tolist())
        file, name = self.finder
        self.search: Any = getattr(import_module(f"pathfinding.finder.{file}"), name)(diagonal_movement=rules[self.rule])

    def query(self, start, goal):
        nodes, _ = self.search.find_path(self.grid.node(*start), self.grid.node(*goal), self.grid)
        return np.array([(node.x, node.y) for node in nodes], dtype=int).reshape(-1, 2)


class PathfindingDijkstra(Pathfinding):
    label = "pathfinding, `DijkstraFinder`"
    finder = "dijkstra", "DijkstraFinder"


class PathfindingBoth(Pathfinding):
    label = "pathfinding, `BiAStarFinder`"
    finder = "bi_a_star", "BiAStarFinder"
    # It ends where both searches meet, which need not be on a shortest path.
    exact = False


class Pyastar2d(PathPeer):
    package = module = "pyastar2d"
    licence = "MIT"
    label = "pyastar2d, `astar_path`, `allow_diagonal=True`"
    diagonal = 1.0

    def set_up(self, grid):
        self.weights = np.where(grid.occupied, np.inf, 1.0).astype(np.float32)
        self.search: Any = import_module(self.module).astar_path

    def query(self, start, goal):
        found = self.search(self.weights, start[::-1], goal[::-1], allow_diagonal=True)
        return NO_PATH if found is None else found[:, ::-1]


class TcodAStar(PathPeer):
    package, module, licence = "tcod", "tcod.path", "BSD-2-Clause"
    label = "tcod, `AStar`"
    # By default.
    diagonal = 1.41

    def set_up(self, grid):
        self.cost = (~grid.occupied).astype(np.int8)
        self.tcod: Any = import_module(self.module)
        self.build()

    def build(self) -> None:
        self.search: Any = self.tcod.AStar(self.cost)

    def steps(self, start: Cell, goal: Cell) -> Any:
        """Return the cells of a path but the first, as (y, x); they are the same to both ends."""
        return self.search.get_path(*start, *goal)

    def query(self, start, goal):
        (x, y), (goal_x, goal_y) = start, goal
        steps = [tuple(step) for step in self.steps((y, x), (goal_y, goal_x))]
        return np.array([(y, x), *steps])[:, ::-1] if steps else NO_PATH


class TcodDijkstra(TcodAStar):
    label = "tcod, `Dijkstra`, to all cells"
    # Its costs are the least ones; its path goes to the neighbour of least cost, without what the step costs.
    exact = False

    def build(self):
        self.search = self.tcod.Dijkstra(self.cost)

    def steps(self, start, goal):
        self.search.set_goal(*start)
        return self.search.get_path(*goal)


class TcodGraph(TcodAStar):
    label = "tcod, `SimpleGraph`, 2 : 3"
    cardinal, slant = 2, 3
    diagonal = 1.5

    def build(self):
        self.search = self.tcod.SimpleGraph(cost=self.cost, cardinal=self.cardinal, diagonal=self.slant)

    def steps(self, start, goal):
        finder = self.tcod.Pathfinder(self.search)
        finder.add_root(start)
        return finder.path_to(goal)[1:].tolist()


class TcodPath2d(TcodAStar):
    label = "tcod, `path2d`, 70 : 99"
    diagonal = 99 / 70

    def build(self):
        self.search = self.tcod.path2d

    def steps(self, start, goal):
        return self.search(self.cost, start_points=[start], end_points=[goal], cardinal=70, diagonal=99)[1:].tolist()


def path_peers() -> Iterator[PathPeer]:
    """Make every row of the tables, ours first."""
    for rule in (NEVER, ONE_SIDE, True):
        yield OurAStar(rule)
    yield OurJumpPoints(NEVER)
    yield OurProblem(NEVER)
    for graph in (Scipy, Networkx, NetworkxAStar, Rustworkx, RustworkxAStar):
        yield graph(NEVER)
    yield from (Skimage(), SkimageNotGeometric())
    for rule in (NEVER, ONE_SIDE, True):
        yield Pathfinding(rule)
    yield from (PathfindingDijkstra(NEVER), PathfindingBoth(NEVER), Pyastar2d())
    yield from (TcodAStar(), TcodDijkstra(), TcodGraph(), TcodPath2d())
