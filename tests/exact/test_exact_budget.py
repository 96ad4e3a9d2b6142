"""What a budget leaves of an exact front, and what it says."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from exact_fronts import Cost, random_grid
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import ExactFront
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.exact import Budget, budget, exact_front
from pymoo_gridpath.representations import CellSequence
from pymoo_gridpath.search import UNREACHABLE, Moves, backward_costs


@pytest.mark.parametrize("max_labels", [20, 30, 40, 50])
def test_a_monotone_path_with_a_detour_counts_as_the_direct_way(max_labels):
    """Which its genes code; a search that has ended early may hold such paths."""
    a, b = np.random.default_rng(1160).integers(0, 4, (2, 8, 8)) / 10
    grid = OccupancyGrid(np.zeros((8, 8)))
    problem = GridPathProblem(grid, (0, 0), (7, 7), objectives=[Cost("a", a), Cost("b", b)], axis="x")
    found = exact_front(problem, Budget(max_labels=max_labels))
    assert not found.complete and len(found.F) > 1
    np.testing.assert_array_equal(problem.evaluate(found.X), found.F)
    worse = (found.F[:, None] >= found.F).all(axis=2) & (found.F[:, None] > found.F).any(axis=2)
    assert not worse.any()


@pytest.mark.parametrize(("n_obj", "side", "max_cells"), [(2, 64, 95), (3, 24, 32)])
def test_a_budget_keeps_paths_that_fit_into_rows_that_are_too_short(n_obj, side, max_cells):
    grid, random_state = OccupancyGrid(np.zeros((side, side))), np.random.default_rng(0)
    costs = [Cost(name, random_state.integers(0, 4, (side, side))) for name in "abc"[:n_obj]]
    coding = CellSequence(grid, (0, 0), (side - 1, side - 1), max_cells=max_cells)
    roomy, problem = (GridPathProblem(grid, (0, 0), (side - 1, side - 1), rows, costs) for rows in ("cells", coding))
    whole = exact_front(problem)
    assert whole.complete and f"points found of paths with at most {max_cells} cells, the max_cells" in whole.message
    # Enough for the front of all paths, but not for the other.
    max_labels = exact_front(roomy).n_labels + 100
    assert max_labels < whole.n_labels
    found = exact_front(problem, Budget(max_labels=max_labels))
    assert not found.complete and f"paths found with at most {max_cells} cells, the max_cells" in found.message
    np.testing.assert_array_equal(problem.evaluate(found.X), found.F)
    np.testing.assert_array_equal(found.F.min(axis=0), whole.F.min(axis=0))


def test_what_did_not_do_is_remembered_and_only_more_time_is_another_attempt(monkeypatch):
    problem = GridPathProblem(random_grid(20, 4), (0, 0), (19, 19), "cells")
    attempts = []

    def attempt(problem, budget):
        attempts.append(budget.max_seconds)
        # Labels rather than seconds, so that what a slow machine does plays no part.
        return exact_front(problem, Budget(max_labels=None if len(attempts) == 4 else 0))

    monkeypatch.setattr("pymoo_gridpath.problems.grid_path.exact_front", attempt)
    for given in ({}, {}, {"max_seconds": 2.0}, {"max_seconds": 1}, {"max_seconds": 3.0}, {"max_seconds": 2.5}, {}):
        with pytest.warns(UserWarning, match="no Pareto front: the search ended early, the budget of 0 labels is used up"):
            assert problem.pareto_front(**given) is None and problem.pareto_set(**given) is None
    assert attempts == [2.0, 3.0]
    with pytest.warns(UserWarning, match="no Pareto front"):
        assert problem.pareto_front(max_seconds=100.0) is None
    front = problem.pareto_front(max_seconds=None)
    assert attempts == [2.0, 3.0, 100.0, None]
    np.testing.assert_array_equal(front, exact_front(problem).F)
    assert problem.pareto_front() is front and len(attempts) == 4


def test_a_front_that_took_too_long_is_looked_for_again():
    problem = GridPathProblem(random_grid(20, 4), (0, 0), (19, 19), "cells")
    for look in (problem.pareto_front, problem.pareto_set):
        with pytest.warns(UserWarning, match="time budget of 0 s") as caught:
            assert look(max_seconds=0) is None
        assert caught[0].filename == __file__
    assert len(problem.pareto_front(max_seconds=60)) == len(problem.pareto_set()) > 1
    assert problem.pareto_front() is problem.pareto_front(max_seconds=0)
    with pytest.raises(GridPathError, match="max_seconds is -1"):
        GridPathProblem(random_grid(20, 4), (0, 0), (19, 19), "integer").pareto_front(max_seconds=-1)


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
        front = problem.pareto_front(max_seconds=60)
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
    problem = GridPathProblem(random_grid(32, 6), (0, 0), (31, 31), "integer")
    with pytest.warns(UserWarning, match="no Pareto front: the search ended early, the time budget of 0 s is used up"):
        assert problem.pareto_front(max_seconds=0.0) is None
    assert len(problem.pareto_front(max_seconds=60)) > 5


def test_memory_of_the_search_for_two_objectives_is_at_most_48_bytes_a_label():
    found = exact_front(GridPathProblem(random_grid(128, 7), (0, 0), (127, 127), representation="cells"))
    assert found.n_labels > 20_000
    assert found.n_bytes / found.n_labels <= 48


def test_the_least_budget_of_memory_is_what_is_free():
    from pymoo_gridpath.exact.budget import Meter, free_memory

    meter = Meter(Budget())
    assert 0 < meter.memory < free_memory() * 1.5


@pytest.mark.parametrize(
    ("limit", "reclaimable", "expected"),
    [("1000000", "100000", 500_000), ("max", "100000", None), ("1000000", "", None), ("500000", "0", 0)],
    ids=["limited", "no limit", "nothing said of files", "over the limit"],
)
def test_free_memory_heeds_what_a_container_may_have(tmp_path, monkeypatch, limit, reclaimable, expected):
    files = [tmp_path / name for name in ("max", "current", "stat")]
    table = f"anon 7\ninactive_file {reclaimable}" if reclaimable else "anon 7"
    for file, text in zip(files, (limit, "600000", table), strict=True):
        file.write_text(text + "\n")
    absent = tuple(str(tmp_path / "absent" / name) for name in "abc")
    monkeypatch.setattr(budget, "_CGROUPS", ((*absent, b"inactive_file"), (*map(str, files), b"inactive_file")))
    found = budget.free_memory()
    # Of the machine, where the container says nothing.
    assert found == expected if expected is not None else found > 10**6
