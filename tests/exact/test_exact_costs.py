"""Exact fronts of costs of one's own: their units, their ranges, and cells that cost nothing."""

from __future__ import annotations

import numpy as np
import pytest
from exact_fronts import Cost, random_grid

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.exact import exact_front
from pymoo_gridpath.neighbourhood import DIAGONAL
from pymoo_gridpath.search import Moves, backward_costs


def test_ways_that_cost_nothing_lead_straight_to_the_goal_and_fit_default_rows():
    """However far the search wanders over open land, where no cell costs anything."""
    for size in (6, 13, 24, 40):
        occupied = np.zeros((size, size), dtype=bool)
        occupied[0, -1] = True
        rare = np.zeros((size, size))
        rare[size // 2, :-1:2] = 1.5
        free = np.zeros((size, size))
        grid = OccupancyGrid(occupied)
        for objectives in (["vulnerability"], [Cost("rare", rare)], ["vulnerability", Cost("rare", rare), Cost("free", free)]):
            problem = GridPathProblem(grid, (0, size - 1), (3, size - 1), "cells", objectives)
            found = exact_front(problem)
            assert found.complete and found.F.tolist() == [[0.0] * len(objectives)]
            assert problem.decode(found.X).length.tolist() == [3.0]


def test_sums_that_rounding_alone_sets_apart_are_the_same():
    """0.1 + 0.2 + 0.3 on one way round a block, 0.3 + 0.2 + 0.1 on the other; one cost is rounded since a third is so dear."""
    occupied = np.zeros((4, 5), dtype=bool)
    occupied[1, 1:4] = True
    for rows in ((0, 2), (2, 0)):
        a, b = np.zeros((4, 5)), np.zeros((4, 5))
        a[rows[0], 1:4], a[rows[1], 1:4] = [0.1, 0.2, 0.3], [0.3, 0.2, 0.1]
        a[3], b[3] = 9, 1e20
        for dear, cheap in (rows, rows[::-1]):
            b[dear, 1:4], b[cheap, 1:4] = 2.5, 0.1
            problem = GridPathProblem(OccupancyGrid(occupied), (0, 1), (4, 1), "cells", [Cost("a", a), Cost("b", b)])
            np.testing.assert_allclose(exact_front(problem).F, [[0.6, 0.3]])


def test_a_potential_limit_is_kept_by_sums_that_rounding_alone_sets_apart_from_it():
    occupied = np.zeros((3, 5), dtype=bool)
    occupied[1, 1:4] = True
    for rows in ((0, 2), (2, 0)):
        cost = np.zeros((3, 5))
        cost[rows[0], 1:4], cost[rows[1], 1:4] = [0.1, 0.2, 0.3], [0.3, 0.2, 0.1]
        objectives = ["length", Cost("vulnerability", cost)]
        for limit, expected in ((0.6, 1), (0.6 + 1e-9, 1), (0.6 - 1e-9, 0)):
            problem = GridPathProblem(
                OccupancyGrid(occupied), (0, 1), (4, 1), "cells", objectives, obstacles="limit", potential_limit=limit
            )
            found = exact_front(problem)
            assert len(found.F) == expected
            feasible = problem.evaluate(found.X, return_as_dictionary=True)["G"] <= 0 if expected else []
            assert np.all(feasible)


@pytest.mark.parametrize("scale", [1e-100, 1e-10, 1e-3, 1 / 3, 1e7, 1e12, 1e200])
def test_the_front_does_not_depend_on_the_unit_of_a_cost(scale):
    for seed in range(12):
        random_state = np.random.default_rng(seed)
        grid = random_grid(7, seed)
        whole = random_state.integers(0, 10, size=(2, 7, 7))
        plain, scaled = (
            GridPathProblem(grid, (0, 0), (6, 6), "cells", [Cost("a", costs[0]), Cost("b", costs[1])]).pareto_front(
                max_seconds=60
            )
            for costs in (whole, whole * scale)
        )
        np.testing.assert_allclose(scaled / scale, plain, rtol=1e-12)


def test_a_single_dear_cell_keeps_its_point():
    field = np.zeros((3, 3))
    field[1, 1] = 1e7
    grid = OccupancyGrid(np.zeros((3, 3)), corner_cutting=True)
    front = GridPathProblem(grid, (0, 0), (2, 2), "cells", ["length", Cost("risk", field)]).pareto_front(max_seconds=60)
    np.testing.assert_allclose(front, [[2 * 2**0.5, 1e7], [2 + 2**0.5, 0.0]])


def test_decimal_costs_make_no_twins():
    field = np.zeros((4, 5))
    field[0, 2], field[3, 1:4] = 0.3, 0.1
    occupied = np.zeros((4, 5))
    occupied[1:3, 1:4] = 1
    problem = GridPathProblem(OccupancyGrid(occupied), (0, 1), (4, 1), "cells", ["length", Cost("toll", field)])
    np.testing.assert_array_equal(problem.pareto_front(max_seconds=60), [[6.0, 0.3]])


def test_costs_far_apart_keep_the_cheap_part_of_the_front():
    """Cells too dear to be wanted leave the front of the others as it is where they are occupied."""
    toll, occupied = np.random.default_rng(1).random((20, 20)), random_grid(20, 4).occupied
    dear, walled = (
        GridPathProblem(OccupancyGrid(cells, corner_cutting=True), (0, 0), (19, 19), "cells", ["length", Cost("toll", field)])
        for cells, field in ((np.zeros((20, 20)), np.where(occupied, 1e20, toll)), (occupied, toll))
    )
    front = dear.pareto_front(max_seconds=60)
    cheap = front[:, 1] < 1e19
    np.testing.assert_allclose(front[cheap], walled.pareto_front(max_seconds=60), rtol=1e-12)
    assert not cheap.all() and cheap.sum() > 3


def test_paths_that_hide_behind_cheaper_ones_are_found_in_any_order():
    """Three corridors that cost (0, 0.4), (1000, 0) and (1000.4, 0), beside cells so dear that the last two look the same."""
    free = np.zeros((7, 9), dtype=bool)
    free[:, 0] = free[:, 6] = free[0, :7] = free[3, :7] = free[6, :7] = free[5, 2:5] = True
    free[6, 3] = False
    first, second = np.zeros((2, 7, 9))
    second[3, 3] = 0.4
    first[0, 2:4], first[6, 2] = (1000.0, 0.4), 1000.0
    expected = [[0.0, 0.4], [1000.0, 0.0]]
    for dear in (0.0, 2.0**58 + 1e10):
        first[3, 7], second[2, 7] = dear, dear
        free[2:4, 7] = dear > 0
        for order in ((0, 1), (1, 0)):
            objectives = [(Cost("first", first), Cost("second", second))[k] for k in order]
            found = exact_front(GridPathProblem(OccupancyGrid(~free), (0, 3), (6, 3), "cells", objectives))
            assert sorted(found.F[:, order].tolist()) == expected


def test_parts_of_a_front_that_meet_make_no_twins():
    first = np.array([[0, 0, 0], [0.125, 1e20, 0], [0.25, 0.125, 0]])
    second = np.array([[0, 0.5, 0.25], [0.125, 1e20, 0], [0, 0, 0]])
    grid = OccupancyGrid(np.zeros((3, 3)), corner_cutting=True)
    found = exact_front(GridPathProblem(grid, (0, 0), (2, 2), "cells", [Cost("first", first), Cost("second", second)]))
    assert found.F.tolist() == [[0.0, 0.5], [0.25, 0.125]]


def test_cells_are_expanded_once_where_steps_cost_nothing():
    moves, nothing = Moves(OccupancyGrid(np.zeros((200, 200)))), np.zeros((2, 200 * 200), dtype=np.int64)
    steps = np.stack([np.zeros((9, 8), dtype=np.int64), np.tile(np.where(DIAGONAL, 14, 10), (9, 1))])
    asked = []
    cost = backward_costs(moves, steps, nothing, 0, stop=lambda: bool(asked.append(1)))[0]
    assert len(asked) == 200 * 200 // 2**13 and cost[1, -1] == 199 * 14


def test_costs_whose_sum_is_no_number_are_refused():
    field = np.full((5, 5), 1e308)
    problem = GridPathProblem(OccupancyGrid(np.zeros((5, 5))), (0, 0), (4, 4), "cells", ["length", Cost("wall", field)])
    with pytest.raises(CapabilityError, match="values up to 1e\\+308, whose sum over the free cells is more"):
        exact_front(problem)


@pytest.mark.parametrize("seed", range(40))
def test_a_third_objective_equal_to_the_second_changes_nothing(seed):
    """Two searches that share no pruning agree, on grids too large to enumerate."""
    random_state = np.random.default_rng(seed)
    size = int(random_state.integers(8, 25))
    grid = random_grid(size, seed)
    values = [np.zeros(grid.shape), random_state.integers(0, 4, size=grid.shape), random_state.random(grid.shape)][seed % 3]
    cost, again, goal = Cost("cost", values), Cost("again", values), (size - 1, size - 1)
    for first in ("length", Cost("other", random_state.integers(0, 9, size=grid.shape))):
        two = GridPathProblem(grid, (0, 0), goal, "cells", [first, cost]).pareto_front(max_seconds=60)
        three = GridPathProblem(grid, (0, 0), goal, "cells", [first, cost, again]).pareto_front(max_seconds=60)
        np.testing.assert_allclose(two, three[:, :2], rtol=1e-12)


def test_the_default_room_of_cells_holds_the_front_of_a_cost_of_ones_own():
    """A field whose cheapest path winds through the whole grid."""
    field = np.full((12, 12), 50)
    field[::4] = field[2::4] = 0
    field[1::4, -1] = field[3::4, 0] = 0
    problem = GridPathProblem(OccupancyGrid(np.zeros((12, 12))), (0, 0), (11, 11), "cells", ["length", Cost("wet", field)])
    assert problem.pareto_front(max_seconds=60)[-1, 0] > 50
