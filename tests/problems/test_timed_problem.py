"""Paths in time as a problem: scores and legality are those of an enumeration by rules that are written down a second time."""

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

from pymoo_gridpath import GridPathProblem, OccupancyGrid, make_algorithm, path_operators
from pymoo_gridpath.errors import CapabilityError, GridError, GridPathError, GridPathWarning, UnreachableError
from pymoo_gridpath.operators import SpliceCrossover, paper_operators
from pymoo_gridpath.paths import CellPaths, Trajectories
from pymoo_gridpath.problems import TimedPathProblem
from pymoo_gridpath.quality import hypervolume_ratio
from pymoo_gridpath.representations import TimedPaths
from pymoo_gridpath.testing.timed import enumerated, measured, wander

START, GOAL = (0, 0), (3, 3)


def small(seed, corner_cutting, horizon=7, **options):
    """A random problem of 4 x 4 cells that can be solved, with what an enumeration wants."""
    rng = np.random.default_rng([7, seed])
    while True:
        occupied = rng.random((4, 4)) < 0.2
        occupied[0], occupied[:, -1] = False, False
        ways = [wander(rng, 4, horizon) for _ in range(int(rng.integers(1, 4)))]
        grid = OccupancyGrid(occupied, corner_cutting=corner_cutting)
        try:
            return TimedPathProblem(grid, START, GOAL, ways, horizon, **options), occupied, ways
        except UnreachableError:
            continue


def cells_of(row, width=4):
    return [(int(cell) % width, int(cell) // width) for cell in row]


def wandering_rows(problem, rng, n):
    """Rows of steps to neighbours, some of which an obstacle bars, that jump to the goal if they do not come there."""
    grid, rows = problem.grid, np.empty((n, problem.n_var), dtype=int)
    cells = np.tile(problem.start, (n, 1))
    for tick in range(problem.n_var):
        rows[:, tick] = cells @ (1, grid.width)
        cells = np.clip(cells + rng.choice([-1, 0, 1, 1], (n, 2)), 0, (grid.width - 1, grid.height - 1))
    rows[:, -1] = np.dot(problem.goal, (1, grid.width))
    return rows


# -- scores and legality ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("corner_cutting", [False, True])
def test_scores_and_legality_are_those_of_the_rules(corner_cutting):
    n_legal = n_barred = 0
    for seed in range(6):
        problem, occupied, ways = small(seed, corner_cutting)
        X = np.concatenate([wandering_rows(problem, np.random.default_rng(seed), 300), problem.pareto_set()])
        found = problem.evaluate(X, return_values_of=["F", "interfering_cells"], return_as_dictionary=True)
        still = CellPaths(problem.grid, X).interfering_cells
        for row, F, interfering, walls in zip(X, found["F"], found["interfering_cells"], still, strict=True):
            legal, expected = measured(occupied, corner_cutting, GOAL, ways, cells_of(row))
            assert (interfering == 0) == legal, cells_of(row)
            np.testing.assert_allclose(F, np.array(expected) + 2 * interfering, rtol=0, atol=1e-9)
            n_legal += legal
            n_barred += not legal and walls == 0
    assert n_legal > 40 and n_barred > 40


@pytest.mark.parametrize("corner_cutting", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_the_front_and_its_paths_are_those_of_an_enumeration(seed, corner_cutting):
    problem, occupied, ways = small(seed, corner_cutting)
    expected = np.reshape(enumerated(occupied, corner_cutting, START, GOAL, ways, problem.horizon), (-1, 3))
    np.testing.assert_allclose(problem.pareto_front(), expected, rtol=0, atol=1e-12)
    X = problem.pareto_set()
    np.testing.assert_array_equal(problem.evaluate(X), problem.pareto_front())
    found = minimize(problem, make_algorithm("exact", problem))
    assert found.success and found.message.startswith("all ")
    np.testing.assert_array_equal(found.F, problem.pareto_front())


# In each the path would be legal if nothing moved: rows, movers, and whether corners may be cut.
ILLEGAL = {
    "arrives on": ([[0, 0], [1, 0], [2, 0]], [[(2, 1), (1, 0), (2, 1)]], True),
    "waits where somebody comes": ([[0, 0], [1, 0], [1, 0], [2, 0]], [[(0, 2), (1, 1), (1, 0), (0, 1)]], True),
    "exchanges": ([[0, 0], [1, 0], [2, 0]], [[(2, 0), (2, 0), (1, 0)]], True),
    "exchanges diagonally": ([[0, 0], [1, 1], [2, 0]], [[(1, 1), (0, 0)]], True),
    "crosses diagonally": ([[0, 0], [1, 1], [2, 0]], [[(1, 0), (0, 1)]], True),
    "crosses diagonally, the other way": ([[0, 0], [1, 1], [2, 0]], [[(0, 1), (1, 0), (0, 1)]], True),
    "corner beside who was there": ([[0, 0], [1, 1], [2, 0]], [[(0, 1), (0, 2)]], False),
    "corner beside who comes": ([[0, 0], [1, 1], [2, 0]], [[(0, 2), (0, 1), (0, 2)]], False),
    "meets who stays": ([[0, 0], [0, 0], [0, 0], [0, 0], [1, 0], [2, 0]], [[(1, 2), (1, 1), (1, 0)]], True),
    "meets who waits to begin": ([[0, 0], [1, 0], [2, 0]], [{4: (1, 0), 5: (1, 1)}], True),
}


@pytest.mark.parametrize("kind", ILLEGAL)
def test_what_meets_an_obstacle_is_illegal(kind):
    cells, movers, cutting = ILLEGAL[kind]
    grid = OccupancyGrid(np.zeros((3, 3)), corner_cutting=cutting)
    row = np.array([[x + 3 * y for x, y in [*cells, *[[2, 0]] * 8]][:9]])

    def evaluated(movers, **options):
        problem = TimedPathProblem(grid, (0, 0), (2, 0), movers, 8, **options)
        return problem.evaluate(row, return_as_dictionary=True), problem

    there, problem = evaluated(movers)
    assert there["interfering_cells"].tolist() == [1]
    plain = problem.score(problem.decode(row))
    np.testing.assert_allclose(there["F"], plain + 2.0)
    assert evaluated(movers, penalty=7)[0]["F"].tolist() == (plain + 7).tolist()
    constrained, _ = evaluated(movers, obstacles="constraint")
    assert constrained["G"].tolist() == [[1.0]] and np.array_equal(constrained["F"], plain)
    assert evaluated([])[0]["interfering_cells"].tolist() == [0]


def test_who_follows_or_passes_is_legal():
    lane = OccupancyGrid(np.zeros((2, 4)), corner_cutting=True)
    for way in ([(1, 0), (2, 0), (3, 0), (3, 1)], [(3, 1), (2, 1), (1, 1), (0, 1)]):
        problem = TimedPathProblem(lane, (0, 0), (3, 0), [way], 5)
        assert problem.evaluate([[0, 1, 2, 3, 3, 3]], return_values_of=["interfering_cells"]).tolist() == [0]
    problem = TimedPathProblem(lane, (0, 0), (3, 0), Trajectories([[(1, 0)]], after="gone"), 5)
    assert problem.evaluate([[0, 1, 2, 3, 3, 3]], return_values_of=["interfering_cells"]).tolist() == [0]


def test_a_path_ends_when_it_first_reaches_the_goal():
    problem = TimedPathProblem(OccupancyGrid(np.zeros((1, 4))), (0, 0), (2, 0), [[(3, 0)]], 6)
    F = problem.evaluate([[0, 1, 2, 3, 2, 0, 2], [0, 1, 2, 2, 2, 2, 2]])
    assert np.array_equal(F[0], F[1]) and F[0, :2].tolist() == [2.0, 2.0]


# -- the front and its budget, as in GridPathProblem --------------------------------------------------------------------------


def test_a_budget_that_does_not_suffice_is_no_front():
    rng = np.random.default_rng(2)
    ways = [wander(rng, 12, 30) for _ in range(3)]
    problem = TimedPathProblem(OccupancyGrid(np.zeros((12, 12))), (0, 0), (11, 11), ways, 30)
    with pytest.warns(GridPathWarning, match=r"no Pareto front: the search gave up, the time budget of 0 s is used up"):
        assert problem.pareto_front(max_seconds=0) is None
    F = problem.pareto_front(max_seconds=60)
    assert len(F) > 3 and problem.pareto_front(max_seconds=0) is F


# -- what is refused ----------------------------------------------------------------------------------------------------------


def test_queries_that_cannot_be_solved_are_refused():
    lane = OccupancyGrid(np.zeros((1, 4)))
    query = {"grid": lane, "start": (0, 0), "goal": (3, 0), "horizon": 6}
    with pytest.raises(UnreachableError, match=r"at tick 0 mover 1 is on the start \(0, 0\)"):
        TimedPathProblem(movers=[[(2, 0)], [(0, 0), (1, 0)]], **query)
    with pytest.raises(UnreachableError, match="gave up at the horizon, tick 6: no path arrives by then"):
        TimedPathProblem(movers=[[(2, 0)]], **query)
    with pytest.raises(UnreachableError, match="no legal path: wherever the path could be, an obstacle comes by tick"):
        TimedPathProblem(movers=[[(3, 0), (2, 0), (1, 0), (0, 0)]], **query)
    for wrong, message in (
        ({"horizon": 0}, "horizon is 0"),
        ({"horizon": 2.5}, "horizon is 2.5"),
        ({"horizon": 99_999, "grid": OccupancyGrid(np.zeros((200, 200)))}, "crop the grid, or lower the horizon"),
        ({"movers": 5}, "movers is 5"),
        ({"movers": [[(1, 0), (3, 0)]]}, "at most one cell a tick"),
        ({"variance": 0}, "variance"),
        ({"obstacles": "limit"}, "obstacles is 'limit'"),
        ({"goal": (0, 0)}, "start and goal"),
    ):
        with pytest.raises(GridPathError, match=message):
            TimedPathProblem(**({"movers": []} | query | wrong))
    assert issubclass(UnreachableError, GridError)


def test_what_knows_nothing_of_time_refuses_it():
    problem, _, ways = small(0, False)
    coding = TimedPaths(problem.grid, START, GOAL, Trajectories(ways), 7)
    for representation in (coding, TimedPaths):
        with pytest.raises(GridPathError, match="paths in time, expected a TimedPathProblem"):
            GridPathProblem(problem.grid, START, GOAL, representation)
    for name in ("astar", "qsa", "ros", "jps"):
        with pytest.raises(CapabilityError, match="map that stands still"):
            make_algorithm(name, problem)
    with pytest.raises(GridPathError, match="these operators know nothing of time"):
        SpliceCrossover()._do(problem, problem.pareto_set()[[0, 0]][:, None], random_state=np.random.default_rng(1))
    with pytest.raises(GridPathError, match="the paper names no operators"):
        paper_operators(problem)
    with pytest.raises(GridPathError, match="decode of a TimedPathProblem"):
        problem.score(CellPaths(problem.grid, np.array([[0, 1, 2, 3]])))
    still = GridPathProblem(problem.grid, START, GOAL, "cells")
    for operator in path_operators(problem).values():
        if hasattr(operator, "_do") and not hasattr(operator, "arrays"):
            with pytest.raises(GridPathError, match="expected a TimedPathProblem"):
                operator._do(still, np.zeros((2, 1, still.n_var), dtype=int), random_state=np.random.default_rng(1))


# -- searches -----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("make", [lambda p: NSGA2(40, **path_operators(p, "random")), lambda p: make_algorithm("NSGA2", p, 40)])
def test_searches_find_most_of_the_front(make):
    rng = np.random.default_rng(5)
    ways = [wander(rng, 10, 24) for _ in range(3)]
    problem = TimedPathProblem(OccupancyGrid(np.zeros((10, 10))), (0, 0), (9, 9), ways, 24)
    result = minimize(problem, make(problem), ("n_gen", 30), seed=1)
    assert (result.pop.get("interfering_cells") == 0).all()
    assert hypervolume_ratio(result.F, problem.pareto_front(max_seconds=None)) > 0.97


def test_a_problem_pickles():
    problem, _, _ = small(1, False)
    copied = pickle.loads(pickle.dumps(problem))
    X = wandering_rows(problem, np.random.default_rng(1), 20)
    assert np.array_equal(copied.evaluate(X), problem.evaluate(X))
    np.testing.assert_array_equal(copied.pareto_front(), problem.pareto_front())


SCRIPT = """
import hashlib, json
import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.optimize import minimize
from pymoo_gridpath import OccupancyGrid, path_operators
from pymoo_gridpath.problems import TimedPathProblem
from pymoo_gridpath.testing.timed import wander

digests = []
ways = [wander(np.random.default_rng(k), 6, 9) for k in (0, 1)]
problem = TimedPathProblem(OccupancyGrid(np.zeros((6, 6))), (0, 0), (5, 5), ways, 9)
rng = np.random.default_rng(0)
X = rng.integers(problem.xl, problem.xu + 1, (10, problem.n_var))
arrays = [problem.evaluate(X), path_operators(problem)["repair"]._do(problem, X, random_state=rng), problem.pareto_set(None)]
for sampling in ("scalarized", "random"):
    arrays.append(minimize(problem, NSGA2(10, **path_operators(problem, sampling)), ("n_gen", 3), seed=5).pop.get("X"))
print(json.dumps([hashlib.md5(np.ascontiguousarray(a).tobytes()).hexdigest() for a in arrays]))
"""


def test_the_same_seed_gives_the_same_bits_compiled_and_plain():
    def run(**environment):
        done = subprocess.run([sys.executable, "-c", SCRIPT], env=os.environ | environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    assert run(NUMBA_DISABLE_JIT="1") == run()


def test_the_width_of_the_potential_may_be_said_in_metres():
    cells = np.zeros((3, 5))
    cells[0, 2] = 1
    grid, query = OccupancyGrid(cells, resolution=0.25), ((0, 1), (4, 1), [[(4, 2), (3, 2)]], 8)
    in_metres, in_cells = TimedPathProblem(grid, *query, sigma_m=0.5), TimedPathProblem(grid, *query, variance=4.0)
    assert in_metres.variance == 4.0 and TimedPathProblem(grid, *query).variance == 0.5
    np.testing.assert_array_equal(in_metres.potential, in_cells.potential)
    np.testing.assert_array_equal(in_metres.pareto_front(max_seconds=60), in_cells.pareto_front(max_seconds=60))
    with pytest.raises(GridPathError, match="expected one of them"):
        TimedPathProblem(grid, *query, variance=4.0, sigma_m=0.5)
    with pytest.raises(GridPathError, match="is in cells, and sigma_m"):
        TimedPathProblem(OccupancyGrid(cells), *query, sigma_m=0.5)
