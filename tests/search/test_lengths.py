"""Lengths of shortest and of cheapest paths are those of scipy's searches on a graph."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse import csgraph

from pymoo_gridpath.fields import obstacle_potential
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.search import Moves
from pymoo_gridpath.search.lengths import cells_of_shortest, cheapest_length

RULES = [*itertools.product((True, False, "one side"), (8,)), (False, 4)]
FIELDS = {
    "potential": lambda grid, draw: obstacle_potential(grid),
    "any": lambda grid, draw: draw.random(grid.shape),
    "decimal": lambda grid, draw: draw.integers(0, 10, grid.shape) / 10,
    "nothing": lambda grid, draw: np.zeros(grid.shape),
    "here and there": lambda grid, draw: (draw.random(grid.shape) < 0.3) * 1.0,
}


def grids(rule, n, most=16):
    """Yield random grids, on some of which no path leads from the first cell to the last."""
    draw = np.random.default_rng(len(str(rule)))
    for _ in range(n):
        occupied = draw.random(draw.integers(2, most, 2)) < draw.random() * 0.5
        occupied.flat[[0, -1]] = False
        corner_cutting, moves = rule
        yield OccupancyGrid(occupied, corner_cutting=corner_cutting, moves=moves), draw


def length_of_cheapest(graph, field, start, goal):
    """Return the length of the shortest of the cheapest paths, by two searches of a graph."""
    tail = np.repeat(np.arange(field.size), np.diff(graph.indptr))
    head = graph.indices
    least = csgraph.dijkstra(sparse.csr_array((field[head], head, graph.indptr), shape=graph.shape), indices=start)
    with np.errstate(invalid="ignore"):
        needed = least[tail] + field[head] <= least[head] * (1 + 1e-12)
    pairs = tail[needed].astype(np.int32), head[needed].astype(np.int32)
    return csgraph.dijkstra(sparse.csr_array((graph.data[needed], pairs), shape=graph.shape), indices=start)[goal]


@pytest.mark.parametrize("rule", RULES, ids=str)
def test_shortest_paths_have_as_many_cells_as_scipys(rule):
    n_joined = 0
    for grid, _ in grids(rule, 60):
        goal = grid.occupied.size - 1
        _, before = csgraph.dijkstra(grid.move_graph(), indices=0, return_predecessors=True)
        n, cell = 1, goal
        while cell > 0 and before[cell] >= 0:
            cell, n = before[cell], n + 1
        joined = cell == 0
        n_joined += joined
        assert cells_of_shortest(Moves(grid), 0, goal) == (n if joined else 0)
    assert 20 < n_joined < 60


@pytest.mark.parametrize("rule", RULES, ids=str)
@pytest.mark.parametrize("field", FIELDS)
def test_cheapest_paths_are_as_long_as_scipys(rule, field):
    for grid, draw in grids(rule, 25):
        costs, goal = np.asarray(FIELDS[field](grid, draw)).ravel(), grid.occupied.size - 1
        expected = length_of_cheapest(grid.move_graph(), costs, 0, goal)
        assert cheapest_length(Moves(grid), costs, 0, goal) == pytest.approx(expected, rel=1e-12)


def test_heaps_and_lists_grow():
    """Of an open map more cells lie at the front of a search than there is room for at first."""
    moves, middle = Moves(OccupancyGrid(np.zeros((700, 700)))), 350 * 701
    assert cheapest_length(moves, np.zeros(moves.n_cells), middle, 0) == pytest.approx(350 * np.sqrt(2))
    assert cells_of_shortest(moves, 0, middle) == 351
