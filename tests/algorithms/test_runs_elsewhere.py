"""Runs that an executor carries out against the same runs here."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pytest

from pymoo_gridpath import ConvergenceRecorder, OccupancyGrid, TradeOffSet, make_algorithm, minimize_runs
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.problems import MovingObstaclesProblem, ObstacleClock, random_movers


@pytest.mark.parametrize("kind", [ThreadPoolExecutor, ProcessPoolExecutor])
@pytest.mark.parametrize("name", ["NSGA2", "MOEAD"])
def test_results_are_those_of_runs_here(kind, name, make_problem):
    problem = make_problem(2, "penalty")
    algorithm = make_algorithm(name, problem, 20)
    here = minimize_runs(problem, algorithm, ("n_gen", 6), n_runs=3, seed=5, callback=ConvergenceRecorder())
    with kind(2) as executor:
        there = minimize_runs(
            problem, algorithm, ("n_gen", 6), n_runs=3, seed=5, callback=ConvergenceRecorder(), executor=executor
        )
    for one, other in zip(there, here, strict=True):
        for key in ("X", "F", "CV", "turn"):
            assert np.array_equal(one.pop.get(key), other.pop.get(key))
        assert np.array_equal(one.F, other.F) and one.problem is problem and one.algorithm.problem is problem
        fronts = one.algorithm.callback.fronts, other.algorithm.callback.fronts
        assert all(map(np.array_equal, *fronts)) and one.algorithm.n_gen == other.algorithm.n_gen
    assert np.array_equal(TradeOffSet.from_results(there).F, TradeOffSet.from_results(here).F)


def test_moving_obstacles_begin_anew_in_each_run():
    grid = OccupancyGrid(np.zeros((10, 10)), corner_cutting=True)
    movers, _ = random_movers(grid, (0, 0), (9, 9), 8, 5, np.random.default_rng(3))
    problem = MovingObstaclesProblem(grid, movers, (0, 0), (9, 9), 3)
    run = {"problem": problem, "algorithm": make_algorithm("NSGA2", problem, 10), "termination": ("n_gen", 7), "n_runs": 3}
    here = minimize_runs(**run, callback=ObstacleClock())
    with ThreadPoolExecutor(3) as executor:
        there = minimize_runs(**run, callback=ObstacleClock(), executor=executor)
    for one, other in zip(there, here, strict=True):
        assert np.array_equal(one.pop.get("F"), other.pop.get("F"))


def test_what_does_not_go_with_an_executor_is_refused(make_problem):
    problem = make_problem(2, "penalty")
    algorithm = make_algorithm("NSGA2", problem, 10)
    with ThreadPoolExecutor(1) as executor:
        with pytest.raises(GridPathError, match="observe is called after every generation"):
            minimize_runs(problem, algorithm, ("n_gen", 2), 2, observe=lambda k, algorithm: None, executor=executor)
        with pytest.raises(GridPathError, match="executor is 'two', expected an Executor"):
            minimize_runs(problem, algorithm, ("n_gen", 2), 2, executor="two")  # pyright: ignore
    algorithm.termination_of_mine = lambda: None
    with ProcessPoolExecutor(1) as executor, pytest.raises(GridPathError, match="run 0 could not be sent to another process"):
        minimize_runs(problem, algorithm, ("n_gen", 2), 2, executor=executor)
