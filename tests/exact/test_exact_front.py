"""What the exact front is to users: of problems, as an algorithm, under budgets, with and without numba."""

from __future__ import annotations

import json
import os
import pickle
import subprocess
import sys

import numpy as np
import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.optimize import minimize
from pymoo.problems import get_problem

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import ExactFront
from pymoo_gridpath.decision import TradeOffSet
from pymoo_gridpath.decision.export import json_text
from pymoo_gridpath.errors import CapabilityError, GridPathError
from pymoo_gridpath.exact import Budget, exact_front
from pymoo_gridpath.maps import load_map, shipped_maps
from pymoo_gridpath.objectives import Objective
from pymoo_gridpath.operators import default_operators
from pymoo_gridpath.problems import random_dense_grid
from pymoo_gridpath.representations import CellSequence
from pymoo_gridpath.search import DIAGONAL, UNREACHABLE, Moves, backward_costs


def random_grid(size, seed, density=0.2):
    occupied = np.random.default_rng(seed).random((size, size)) < density
    occupied[0] = occupied[:, -1] = False
    return OccupancyGrid(occupied)


class NoField(Objective):
    name = label = "mystery"

    def __call__(self, paths, sums=None):
        return paths.length**2


class Negative(Objective):
    name = label = "negative"

    def field(self, grid):
        return np.full(grid.shape, -1.0)

    def __call__(self, paths, sums):
        return paths.total(sums)


class Inconsistent(Objective):
    name = label = "inconsistent"

    def field(self, grid):
        return np.ones(grid.shape)

    def __call__(self, paths, sums):
        return 2.0 * paths.total(sums)


@pytest.mark.parametrize("item", shipped_maps(), ids=lambda item: item.name)
def test_ends_of_the_front_are_the_shortest_path_and_the_safest(item):
    grid = load_map(item.name)
    problem = GridPathProblem(grid, item.start, item.goal, representation="cells")
    F = problem.pareto_front()
    x, y = item.goal
    assert F[0, 0] == pytest.approx(grid.shortest_lengths(item.start)[y, x], abs=1e-9)
    safest = GridPathProblem(grid, item.start, item.goal, representation="cells", objectives=["vulnerability"])
    assert F[-1, 1] == safest.pareto_front()[0, 0] == F[:, 1].min()
    assert (np.diff(F[:, 0]) > 0).all() and (np.diff(F[:, 1]) < 0).all()


def test_front_and_set_of_a_problem_belong_together():
    problem = GridPathProblem(random_grid(24, 1), (0, 0), (23, 23))
    front, paths = problem.pareto_front(), problem.pareto_set()
    np.testing.assert_array_equal(problem.evaluate(paths), front)
    assert (problem.decode(paths).interfering_cells == 0).all()
    assert len(front) > 5


def test_the_front_of_any_path_dominates_that_of_monotone_ones():
    grid = random_grid(24, 1)
    monotone = GridPathProblem(grid, (0, 0), (23, 23)).pareto_front()
    any_path = GridPathProblem(grid, (0, 0), (23, 23), representation="cells").pareto_front()
    assert all((any_path <= f).all(axis=1).any() for f in monotone)


def test_more_objectives_keep_every_point():
    grid = random_grid(16, 2)
    two = GridPathProblem(grid, (0, 0), (15, 15)).pareto_front()
    three = GridPathProblem(grid, (0, 0), (15, 15), objectives=["length", "vulnerability", "turn"]).pareto_front()
    assert {tuple(f) for f in two} <= {tuple(f[:2]) for f in three}
    assert len(three) > len(two)


def test_penalty_and_constraint_leave_the_front_as_it_is_and_a_limit_cuts_it():
    grid = random_grid(20, 3)
    F = GridPathProblem(grid, (0, 0), (19, 19)).pareto_front()
    constrained = GridPathProblem(grid, (0, 0), (19, 19), obstacles="constraint").pareto_front()
    np.testing.assert_array_equal(constrained, F)
    limit = float(np.median(F[:, 1]))
    limited = GridPathProblem(grid, (0, 0), (19, 19), obstacles="limit", potential_limit=limit).pareto_front()
    np.testing.assert_array_equal(limited, F[F[:, 1] <= limit])


def test_objectives_that_do_not_add_up_have_no_exact_front():
    grid = random_grid(8, 0)
    for extra, word in ((NoField(), "has no field"), (Negative(), "negative or infinite")):
        problem = GridPathProblem(grid, (0, 0), (7, 7), objectives=["length", extra])
        assert problem.pareto_front() is None
        assert problem.pareto_set() is None
        with pytest.raises(CapabilityError, match=word):
            minimize(problem, ExactFront())
    with pytest.raises(GridPathError, match="'inconsistent' scores a path otherwise"):
        exact_front(GridPathProblem(grid, (0, 0), (7, 7), objectives=["length", Inconsistent()]))


def test_more_than_three_objectives_are_refused():
    class Cost(Objective):
        def __init__(self, name):
            self.name = self.label = name

        def field(self, grid):
            return np.ones(grid.shape)

        def __call__(self, paths, sums):
            return paths.total(sums)

    problem = GridPathProblem(random_grid(8, 0), (0, 0), (7, 7), objectives=["length", "turn", Cost("a"), Cost("b")])
    assert problem.pareto_front() is None
    with pytest.raises(CapabilityError, match="4 objectives, expected at most 3"):
        exact_front(problem)


def test_fronts_for_which_a_row_is_too_short():
    """Of two objectives the front is that of the paths that fit; of three, points whose paths do not fit are left out."""
    grid = OccupancyGrid(np.pad(np.ones((3, 3)), ((3, 3), (3, 3))))
    coding = CellSequence(grid, (0, 4), (8, 4), max_cells=9)
    for objectives in (("length", "vulnerability"), ("length", "vulnerability", "turn")):
        roomy, problem = (GridPathProblem(grid, (0, 4), (8, 4), rows, objectives) for rows in ("cells", coding))
        whole, found = exact_front(roomy), exact_front(problem)
        cells = roomy.representation.to_sequences(whole.X).lengths
        fits = cells <= 9
        assert whole.complete and 0 < fits.sum() < len(fits)
        assert found.complete == (len(objectives) == 2)
        if found.complete:
            assert found.message == (
                f"all {len(found.F)} points found of paths that visit at most 9 cells, the max_cells of the representation; "
                f"without that limit the front has paths of up to {cells.max()}"
            )
            # A point that only longer paths dominate comes in besides.
            assert len(found.F) == fits.sum() + 1 and {*map(tuple, whole.F[fits])} < {*map(tuple, found.F)}
            np.testing.assert_array_equal(problem.pareto_front(), found.F)
            continue
        np.testing.assert_array_equal(found.F, whole.F[fits])
        assert f"left out {(~fits).sum()} points" in found.message and "expected at most 9, the max_cells" in found.message
        with pytest.warns(UserWarning, match="left out"):
            assert problem.pareto_front() is None
        # What breaks the limit is no part of the front, whether it fits or not.
        options = {"obstacles": "limit", "potential_limit": whole.F[:, 1].min() / 2}
        assert exact_front(GridPathProblem(grid, (0, 4), (8, 4), coding, objectives, **options)).complete


@pytest.mark.parametrize("objectives", [("length", "turn"), ("turn", "vulnerability"), ("length", "vulnerability", "turn")])
def test_cells_have_room_for_paths_that_turn_little(objectives):
    """A straight way around a slalom turns little, and is far longer than the shortest and the safest path."""
    width, height = 21, 31
    occupied = np.ones((height, width), dtype=bool)
    occupied[:3] = False
    for x in range(1, width - 1, 2):
        occupied[slice(1, 3) if x // 2 % 2 else slice(0, 2), x] = True
    occupied[:, [0, -1]] = occupied[-1] = False
    problem = GridPathProblem(OccupancyGrid(occupied), (0, 0), (width - 1, 0), "cells", objectives)
    front = problem.pareto_front()
    assert front[:, objectives.index("turn")].min() == 180.0


class Sum(Objective):
    def __init__(self, name, field):
        self.name = self.label = name
        self._field = np.asarray(field, dtype=float)

    def field(self, grid):
        return self._field

    def __call__(self, paths, sums=None):
        return paths.total(sums)


def test_ways_that_cost_nothing_lead_straight_to_the_goal_and_fit_default_rows():
    """However far the search wanders over open land, where no cell costs anything."""
    for size in (6, 13, 24, 40):
        occupied = np.zeros((size, size), dtype=bool)
        occupied[0, -1] = True
        rare = np.zeros((size, size))
        rare[size // 2, :-1:2] = 1.5
        free = np.zeros((size, size))
        grid = OccupancyGrid(occupied)
        for objectives in (["vulnerability"], [Sum("rare", rare)], ["vulnerability", Sum("rare", rare), Sum("free", free)]):
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
            problem = GridPathProblem(OccupancyGrid(occupied), (0, 1), (4, 1), "cells", [Sum("a", a), Sum("b", b)])
            np.testing.assert_allclose(exact_front(problem).F, [[0.6, 0.3]])


def test_a_potential_limit_is_kept_by_sums_that_rounding_alone_sets_apart_from_it():
    occupied = np.zeros((3, 5), dtype=bool)
    occupied[1, 1:4] = True
    for rows in ((0, 2), (2, 0)):
        cost = np.zeros((3, 5))
        cost[rows[0], 1:4], cost[rows[1], 1:4] = [0.1, 0.2, 0.3], [0.3, 0.2, 0.1]
        objectives = ["length", Sum("vulnerability", cost)]
        for limit, expected in ((0.6, 1), (0.6 + 1e-9, 1), (0.6 - 1e-9, 0)):
            problem = GridPathProblem(
                OccupancyGrid(occupied), (0, 1), (4, 1), "cells", objectives, obstacles="limit", potential_limit=limit
            )
            found = exact_front(problem)
            assert len(found.F) == expected
            feasible = problem.evaluate(found.X, return_as_dictionary=True)["G"] <= 0 if expected else []
            assert np.all(feasible)


@pytest.mark.parametrize("max_labels", [20, 30, 40, 50])
def test_a_monotone_path_with_a_detour_counts_as_the_direct_way(max_labels):
    """Which its genes code; a search that has ended early may hold such paths."""
    a, b = np.random.default_rng(1160).integers(0, 4, (2, 8, 8)) / 10
    grid = OccupancyGrid(np.zeros((8, 8)))
    problem = GridPathProblem(grid, (0, 0), (7, 7), objectives=[Sum("a", a), Sum("b", b)], axis="x")
    found = exact_front(problem, Budget(max_labels=max_labels))
    assert not found.complete and len(found.F) > 1
    np.testing.assert_array_equal(problem.evaluate(found.X), found.F)
    worse = (found.F[:, None] >= found.F).all(axis=2) & (found.F[:, None] > found.F).any(axis=2)
    assert not worse.any()


def test_a_budget_keeps_paths_that_fit_into_rows_that_are_too_short():
    grid, random_state = OccupancyGrid(np.zeros((64, 64))), np.random.default_rng(0)
    costs = [Sum(name, random_state.integers(0, 4, (64, 64))) for name in ("a", "b")]
    coding = CellSequence(grid, (0, 0), (63, 63), max_cells=70)
    problem = GridPathProblem(grid, (0, 0), (63, 63), coding, costs)
    whole = exact_front(problem)
    assert whole.complete and whole.message.startswith(f"all {len(whole.F)} points found of paths that visit at most 70 cells")
    # Enough for the front of all paths.
    roomy = exact_front(GridPathProblem(grid, (0, 0), (63, 63), "cells", costs))
    found = exact_front(problem, Budget(max_labels=roomy.n_labels + 100))
    assert not found.complete and "paths found that visit at most 70 cells, the max_cells" in found.message
    np.testing.assert_array_equal(problem.evaluate(found.X), found.F)
    for k in range(2):
        assert found.F[:, k].min() == whole.F[:, k].min()


def test_what_is_no_path_problem_or_no_budget_is_refused():
    other = get_problem("zdt1")
    run = minimize(other, NSGA2(pop_size=4), ("n_gen", 1))
    for use in (
        lambda: minimize(other, ExactFront()),
        lambda: default_operators(other),
        lambda: TradeOffSet.from_results(run),
    ):
        with pytest.raises(GridPathError, match="the problem is of the class ZDT1, expected a path problem"):
            use()
    problem = GridPathProblem(OccupancyGrid(np.zeros((4, 4))), (0, 0), (3, 3))
    with pytest.raises(GridPathError, match="budget is 3, expected a Budget"):
        exact_front(problem, 3)  # pyright: ignore[reportArgumentType]
    with pytest.raises(GridPathError, match="max_labels is 1j, expected a number, zero or more"):
        Budget(max_labels=1j)  # pyright: ignore[reportArgumentType]
    assert exact_front(problem, Budget(max_memory=np.inf)).complete  # pyright: ignore[reportArgumentType]
    with pytest.raises(GridPathError, match="watch is 3, expected a function"):
        ExactFront(watch=3)


def test_a_front_that_took_too_long_is_looked_for_again():
    problem = GridPathProblem(random_grid(20, 4), (0, 0), (19, 19), "cells")
    for look in (problem.pareto_front, problem.pareto_set):
        with pytest.warns(UserWarning, match="time budget of 0 s"):
            assert look(max_seconds=0) is None
    assert len(problem.pareto_front()) == len(problem.pareto_set()) > 1
    assert problem.pareto_front() is problem.pareto_front()
    with pytest.raises(GridPathError, match="max_seconds is -1"):
        GridPathProblem(random_grid(20, 4), (0, 0), (19, 19)).pareto_front(max_seconds=-1)


def test_files_say_whether_a_front_is_complete():
    problem = GridPathProblem(random_grid(20, 4), (0, 0), (19, 19), "cells")
    for max_labels, complete in ((None, True), (10, False)):
        result = minimize(problem, ExactFront(max_labels=max_labels))
        run = json.loads(json_text(TradeOffSet.from_results(result)))["settings"]["runs"][0]
        assert run["complete"] is complete and run["message"] == result.message
        assert run["budget"] == ({} if max_labels is None else {"max_labels": 10})
    three = GridPathProblem(problem.grid, (0, 0), (19, 19), "cells", ("length", "vulnerability", "turn"))
    with pytest.raises(GridPathError, match="Result 0 holds no paths: ended early, the budget of 10 labels is used up"):
        TradeOffSet.from_results(minimize(three, ExactFront(max_labels=10)))


def test_a_front_of_one_point_is_told_in_the_singular():
    assert exact_front(GridPathProblem(OccupancyGrid(np.zeros((4, 4))), (0, 0), (3, 3))).message == "all 1 point found"


def test_as_an_algorithm():
    problem = GridPathProblem(random_grid(20, 4), (0, 0), (19, 19), obstacles="constraint")
    result = minimize(problem, ExactFront(), seed=3)
    np.testing.assert_array_equal(result.F, problem.pareto_front())
    assert result.success is True
    assert result.message == f"all {len(result.F)} points found"
    assert result.algorithm.evaluator.n_eval == len(result.F)
    assert result.algorithm.n_gen == 2  # as for any algorithm after its first generation
    trade_off = TradeOffSet.from_results(result)
    np.testing.assert_array_equal(trade_off.F, result.F)
    again = pickle.loads(pickle.dumps(result.algorithm))
    np.testing.assert_array_equal(again.found.F, result.F)


TWO, THREE = ("length", "vulnerability"), ("length", "vulnerability", "turn")


@pytest.mark.parametrize(
    ("objectives", "budget"),
    [
        (TWO, {"max_labels": 2000}),
        (TWO, {"max_seconds": 0.0}),
        (TWO, {"max_memory": 60_000}),
        (THREE, {"max_labels": 2000}),
        (THREE, {"max_seconds": 0.0}),
        (THREE, {"max_memory": 160_000}),
    ],
    ids=str,
)
def test_a_budget_ends_the_search_with_the_part_found(objectives, budget):
    problem = GridPathProblem(random_grid(80, 5), (0, 0), (79, 79), objectives=objectives, representation="cells")
    result = minimize(problem, ExactFront(**budget))
    assert result.success is False
    assert result.message.startswith("ended early, the ")
    assert "is used up" in result.message
    found = result.algorithm.found
    assert found.n_labels <= 2000 + 16 or "max_labels" not in budget
    assert found.n_bytes <= 250_000 or "max_memory" not in budget
    if len(found.F):
        # Every path is legal, and none claims more than the front holds.
        assert (problem.decode(found.X).interfering_cells == 0).all()
        front = problem.pareto_front()
        assert all((front <= f).all(axis=1).any() for f in found.F)


@pytest.mark.parametrize("objectives", [("length",), TWO, THREE], ids=str)
def test_a_budget_of_time_ends_a_search_for_bounds(objectives):
    """On a map whose single-objective searches alone take longer: what is left of them asks no more."""
    problem = GridPathProblem(random_grid(150, 5), (0, 0), (149, 149), objectives=objectives, representation="cells")
    asked = []
    found = exact_front(problem, Budget(watch=lambda meter: not asked.append(meter)))
    assert len(asked) == 1 and found.message == "ended early, stopped by who watched it; 0 paths found"
    result = minimize(problem, ExactFront(max_seconds=0.0))
    assert (result.X, result.success) == (None, False)
    assert result.message == "ended early, the time budget of 0 s is used up; 0 paths found"


def test_a_search_for_bounds_ends_where_it_is_told_to():
    moves, nothing = Moves(random_grid(150, 5)), np.zeros((2, 150 * 150), dtype=np.int64)
    steps = np.ones((2, 9, 8), dtype=np.int64)
    whole, ended = (backward_costs(moves, steps, nothing, 0, stop=stop)[0] for stop in (None, lambda: True))
    n_whole, n_ended = (np.count_nonzero(cost[0] < UNREACHABLE) for cost in (whole, ended))
    assert 2**13 <= n_ended < n_whole


def test_what_watches_ends_the_search_and_is_not_in_the_result():
    problem = GridPathProblem(random_grid(60, 2), (0, 0), (59, 59), "cells")
    seen = []
    algorithm = ExactFront(watch=lambda meter: not seen.append(meter.elapsed))
    result = minimize(problem, algorithm, save_history=True)
    assert len(seen) == 1 and result.success is False and "stopped by who watched it" in result.message
    again = pickle.loads(pickle.dumps(result))
    assert again.message == again.algorithm.found.message == result.message
    np.testing.assert_array_equal(again.F, result.F)
    # minimize() ran a copy: the algorithm that it was given still watches.
    assert minimize(problem, algorithm).message == result.message and len(seen) == 2


def test_a_pareto_front_that_takes_too_long_is_none_and_says_so():
    problem = GridPathProblem(random_grid(32, 6), (0, 0), (31, 31))
    with pytest.warns(UserWarning, match="no Pareto front: the search ended early, the time budget of 0 s is used up"):
        assert problem.pareto_front(max_seconds=0.0) is None
    assert len(problem.pareto_front()) > 5


def test_memory_of_the_search_for_two_objectives_is_at_most_48_bytes_a_label():
    found = exact_front(GridPathProblem(random_grid(128, 7), (0, 0), (127, 127), representation="cells"))
    assert found.n_labels > 20_000
    assert found.n_bytes / found.n_labels <= 48


def test_the_least_budget_of_memory_is_what_is_free():
    from pymoo_gridpath.exact.budget import Meter, free_memory

    meter = Meter(Budget())
    assert 0 < meter.memory < free_memory() * 1.5


class Cost(Objective):
    """The sum of given costs of cells."""

    def __init__(self, name, values):
        self.name = self.label = name
        self.values = np.asarray(values)

    def field(self, grid):
        return self.values

    def __call__(self, paths, sums):
        return paths.total(sums).astype(float)


@pytest.mark.parametrize("scale", [1e-100, 1e-10, 1e-3, 1 / 3, 1e7, 1e12, 1e200])
def test_the_front_does_not_depend_on_the_unit_of_a_cost(scale):
    for seed in range(12):
        random_state = np.random.default_rng(seed)
        grid = random_grid(7, seed)
        whole = random_state.integers(0, 10, size=(2, 7, 7))
        plain, scaled = (
            GridPathProblem(grid, (0, 0), (6, 6), "cells", [Cost("a", costs[0]), Cost("b", costs[1])]).pareto_front()
            for costs in (whole, whole * scale)
        )
        np.testing.assert_allclose(scaled / scale, plain, rtol=1e-12)


def test_a_single_dear_cell_keeps_its_point():
    field = np.zeros((3, 3))
    field[1, 1] = 1e7
    grid = OccupancyGrid(np.zeros((3, 3)), corner_cutting=True)
    front = GridPathProblem(grid, (0, 0), (2, 2), "cells", ["length", Cost("risk", field)]).pareto_front()
    np.testing.assert_allclose(front, [[2 * 2**0.5, 1e7], [2 + 2**0.5, 0.0]])


def test_decimal_costs_make_no_twins():
    field = np.zeros((4, 5))
    field[0, 2], field[3, 1:4] = 0.3, 0.1
    occupied = np.zeros((4, 5))
    occupied[1:3, 1:4] = 1
    problem = GridPathProblem(OccupancyGrid(occupied), (0, 1), (4, 1), "cells", ["length", Cost("toll", field)])
    np.testing.assert_array_equal(problem.pareto_front(), [[6.0, 0.3]])


def test_costs_far_apart_keep_the_cheap_part_of_the_front():
    """Cells too dear to be wanted leave the front of the others as it is where they are occupied."""
    toll, occupied = np.random.default_rng(1).random((20, 20)), random_grid(20, 4).occupied
    dear, walled = (
        GridPathProblem(OccupancyGrid(cells, corner_cutting=True), (0, 0), (19, 19), "cells", ["length", Cost("toll", field)])
        for cells, field in ((np.zeros((20, 20)), np.where(occupied, 1e20, toll)), (occupied, toll))
    )
    front = dear.pareto_front()
    cheap = front[:, 1] < 1e19
    np.testing.assert_allclose(front[cheap], walled.pareto_front(), rtol=1e-12)
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
        two = GridPathProblem(grid, (0, 0), goal, "cells", [first, cost]).pareto_front()
        three = GridPathProblem(grid, (0, 0), goal, "cells", [first, cost, again]).pareto_front()
        np.testing.assert_allclose(two, three[:, :2], rtol=1e-12)


def test_the_default_room_of_cells_holds_the_front_of_a_cost_of_ones_own():
    """A field whose cheapest path winds through the whole grid."""
    field = np.full((12, 12), 50)
    field[::4] = field[2::4] = 0
    field[1::4, -1] = field[3::4, 0] = 0
    problem = GridPathProblem(OccupancyGrid(np.zeros((12, 12))), (0, 0), (11, 11), "cells", ["length", Cost("wet", field)])
    assert problem.pareto_front()[-1, 0] > 50


def test_a_limit_that_no_path_keeps():
    problem = GridPathProblem(random_grid(10, 1), (0, 0), (9, 9), obstacles="limit", potential_limit=1e-12)
    result = minimize(problem, ExactFront())
    assert result.F is None
    assert result.message == "no legal path keeps the potential limit of 1e-12"


def test_arguments_are_checked():
    with pytest.raises(CapabilityError, match="takes no argument 'seconds'"):
        ExactFront(seconds=3)
    for value in (-1, float("nan"), "1G"):
        with pytest.raises(GridPathError, match="expected a number, zero or more"):
            ExactFront(max_memory=value)


def test_both_ends_of_a_front_of_two_are_found_where_their_searches_are_short():
    problem = GridPathProblem(random_grid(60, 2), (0, 0), (59, 59), "cells")
    found = exact_front(problem, Budget(max_seconds=0.0))
    front = problem.pareto_front()
    np.testing.assert_array_equal(found.F[[0, -1]], front[[0, -1]])
    assert not found.complete


SCRIPT = """
import hashlib, sys
{block}
import numpy as np
from pymoo_gridpath import GridPathProblem
from pymoo_gridpath.compiled import COMPILED
from pymoo_gridpath.exact import exact_front
from pymoo_gridpath.problems import random_dense_grid
print(COMPILED)
for seed, objectives, coding in ((1, ["length", "vulnerability"], "cells"), (2, ["length", "vulnerability", "turn"], "integer"),
                                 (3, ["turn", "vulnerability"], "cells")):
    grid = random_dense_grid(14, 0.3, seed)
    found = exact_front(GridPathProblem(grid, (0, 0), (13, 13), objectives=objectives, representation=coding))
    print(len(found.F), hashlib.sha256(found.X.tobytes() + found.F.tobytes()).hexdigest(), found.n_labels)
"""


@pytest.mark.parametrize("without", ["numba", "its compiler"])
def test_kernels_give_the_same_bits_compiled_and_plain(without):
    def run(block, **environment):
        done = subprocess.run(
            [sys.executable, "-c", SCRIPT.format(block=block)],
            env={**os.environ, **environment},
            capture_output=True,
            text=True,
            check=True,
        )
        return done.stdout.splitlines()

    compiled = run("")
    if without == "numba":
        # A finder that knows no numba stands for a machine without it.
        block = (
            "import importlib.util as u; find = u.find_spec\n"
            "u.find_spec = lambda name, *rest: None if name == 'numba' else find(name, *rest)\n"
            "sys.modules['numba'] = None"
        )
        plain = run(block)
        assert plain[0] == "False"
    else:
        plain = run("", NUMBA_DISABLE_JIT="1")
    assert len(compiled) == 4
    assert plain[1:] == compiled[1:]


def test_threads_change_nothing(monkeypatch):
    for objectives in (TWO, ("length", "turn")):
        problem = GridPathProblem(random_grid(48, 3), (0, 0), (47, 47), objectives=objectives, representation="cells")
        plain = exact_front(problem)
        with monkeypatch.context() as changed:
            changed.setattr("pymoo_gridpath.exact.supported._CELLS_WORTH_THREADS", 0)
            threaded = exact_front(problem)
        np.testing.assert_array_equal(threaded.X, plain.X)
        np.testing.assert_array_equal(threaded.F, plain.F)
        assert threaded.n_labels == plain.n_labels and len(plain.F) > 3


def test_dense_scenarios_have_a_front_of_few_paths():
    # With p0 = 1 only the cells of one path are free.
    for seed in range(5):
        grid = random_dense_grid(16, 1.0, seed)
        assert len(GridPathProblem(grid, (0, 0), (15, 15)).pareto_front()) >= 1
