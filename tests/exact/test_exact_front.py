"""What the exact front is to users: of problems, as an algorithm, under budgets, with and without numba."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys

import numpy as np
import pytest
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import ExactFront
from pymoo_gridpath.decision import TradeOffSet
from pymoo_gridpath.errors import CapabilityError, GridPathError
from pymoo_gridpath.exact import Budget, exact_front
from pymoo_gridpath.maps import load_map, shipped_maps
from pymoo_gridpath.objectives import Objective
from pymoo_gridpath.problems import random_dense_grid
from pymoo_gridpath.representations import CellSequence


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


def test_a_row_too_short_for_the_front_is_refused():
    grid = OccupancyGrid(np.pad(np.ones((3, 3)), ((3, 3), (3, 3))))
    problem = GridPathProblem(grid, (0, 4), (8, 4), representation=CellSequence(grid, (0, 4), (8, 4), max_cells=9))
    with pytest.raises(GridPathError, match="max_cells"):
        exact_front(problem)


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
        (TWO, {"labels": 2000}),
        (TWO, {"seconds": 0.0}),
        (TWO, {"memory": 60_000}),
        (THREE, {"labels": 2000}),
        (THREE, {"seconds": 0.0}),
        (THREE, {"memory": 160_000}),
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
    assert found.n_labels <= 2000 + 16 or "labels" not in budget
    assert found.n_bytes <= 250_000 or "memory" not in budget
    if len(found.F):
        # Every path is legal, and none claims more than the front holds.
        assert (problem.decode(found.X).interfering_cells == 0).all()
        front = problem.pareto_front()
        assert all((front <= f).all(axis=1).any() for f in found.F)


def test_a_pareto_front_that_takes_too_long_is_none_and_says_so():
    problem = GridPathProblem(random_grid(32, 6), (0, 0), (31, 31))
    with pytest.warns(UserWarning, match="no Pareto front: the search ended early, the time budget of 0 s is used up"):
        assert problem.pareto_front(max_seconds=0.0) is None
    assert len(problem.pareto_front(use_cache=False)) > 5


def test_memory_of_the_search_for_two_objectives_is_at_most_48_bytes_a_label():
    found = exact_front(GridPathProblem(random_grid(128, 7), (0, 0), (127, 127), representation="cells"))
    assert found.n_labels > 20_000
    assert found.n_bytes / found.n_labels <= 48


def test_the_least_budget_of_memory_is_what_is_free():
    from pymoo_gridpath.exact.budget import Meter, free_memory

    meter = Meter(Budget())
    assert 0 < meter.memory < free_memory() * 1.5


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


def test_dense_scenarios_have_a_front_of_few_paths():
    # With p0 = 1 only the cells of one path are free.
    for seed in range(5):
        grid = random_dense_grid(16, 1.0, seed)
        assert len(GridPathProblem(grid, (0, 0), (15, 15)).pareto_front()) >= 1
