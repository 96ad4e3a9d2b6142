"""The front of a single objective: the same path as by the search for two, and what a budget leaves of it."""

from __future__ import annotations

import numpy as np
import pytest
from exact_fronts import Cost, random_grid

from pymoo_gridpath import GridPathProblem
from pymoo_gridpath.exact import Budget, exact_front
from pymoo_gridpath.exact.budget import Meter
from pymoo_gridpath.exact.costs import integer_costs
from pymoo_gridpath.exact.one import front_of_one
from pymoo_gridpath.exact.two import front_of_two
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.search import Moves

OBJECTIVES = {
    "length": lambda grid, draw: "length",
    "vulnerability": lambda grid, draw: "vulnerability",
    "nothing": lambda grid, draw: Cost("nothing", np.zeros(grid.shape)),
    "ties": lambda grid, draw: Cost("ties", draw.integers(0, 3, grid.shape) * 1.0),
}


@pytest.mark.parametrize("name", OBJECTIVES)
def test_its_path_is_that_of_the_search_for_two(name):
    draw = np.random.default_rng(4)
    for seed in range(30):
        grid = random_grid(9, seed) if seed % 2 else OccupancyGrid(np.zeros((5, 7)))
        ends = (0, 0), (grid.width - 1, grid.height - 1)
        problem = GridPathProblem(grid, *ends, "cells", [OBJECTIVES[name](grid, draw)])
        moves = Moves(grid)
        costs = integer_costs(problem.objectives, grid, moves)
        start, goal = (moves.index(end) for end in ends)
        one = front_of_one(moves, costs, start, goal, Meter(Budget()))
        two = front_of_two(moves, costs.take([0, 0]), start, goal, Meter(Budget()))
        np.testing.assert_array_equal(one.points[:, 0], two.points[:, 0])
        np.testing.assert_array_equal(one.paths[0], two.paths[0])


def test_without_time_there_is_no_path():
    grid = OccupancyGrid(np.zeros((40, 40)))
    found = exact_front(GridPathProblem(grid, (0, 0), (39, 39), "cells", ["length"]), Budget(max_seconds=0.0))
    assert not found.complete and found.F.shape == (0, 1) and "time budget" in found.message
