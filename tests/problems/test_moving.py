"""Moving obstacles: each epoch is a problem that stands still, and nothing of another map is ever used or returned."""

from __future__ import annotations

import pickle
from importlib.util import find_spec

import numpy as np
import pytest
from pymoo.core.callback import Callback
from pymoo.core.population import Population
from pymoo.optimize import minimize
from pymoo.problems.dyn import DynamicTestProblem, TimeSimulation

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import CAPABILITIES, make_algorithm, minimize_runs
from pymoo_gridpath.errors import CapabilityError, GridError, GridPathError, UnreachableError
from pymoo_gridpath.operators import path_operators
from pymoo_gridpath.operators.path_terrain import terrain_of
from pymoo_gridpath.planners import PathOutput
from pymoo_gridpath.problems import MovingObstaclesProblem, ObstacleClock, random_movers
from pymoo_gridpath.quality import hypervolume_ratio, mean_hypervolume_ratio
from pymoo_gridpath.representations import CellSequence

START, GOAL = (0, 0), (11, 11)
ALGORITHMS = ("DNSGA2", "KGB", "NSGA2", "SPEA2")


def make(seed=1, taut=3, n_epochs=5):
    rng = np.random.default_rng(seed)
    occupied = rng.random((12, 12)) < 0.1
    occupied[[0, 11], [0, 11]] = False
    grid = OccupancyGrid(occupied, corner_cutting=True)
    movers, _ = random_movers(grid, START, GOAL, 12, n_epochs, rng)
    return grid, movers, MovingObstaclesProblem(grid, movers, START, GOAL, taut)


def still_of(grid, movers, epoch, problem):
    """The problem of an epoch, made by hand."""
    occupied = grid.occupied.copy()
    for way in movers:
        x, y = way[min(epoch, len(way) - 1)]
        occupied[y, x] = True
    there = grid.replace(occupied=occupied)
    return GridPathProblem(there, START, GOAL, CellSequence(there, START, GOAL, problem.n_var))


def need(name):
    if name == "KGB" and find_spec("sklearn") is None:
        pytest.skip("scikit-learn is not installed")


def test_each_epoch_is_a_problem_that_stands_still():
    grid, movers, problem = make()
    assert isinstance(problem, DynamicTestProblem) and not problem.has_constraints()
    rng, bounds = np.random.default_rng(2), (problem.n_var, problem.xl.tolist(), problem.xu.tolist())
    X = np.vstack([path_operators(problem)["sampling"].do(problem, 20, random_state=rng).get("X") for _ in range(2)])
    seen = set()
    for generation in range(problem.n_epochs * problem.taut + 4):
        epoch = min(generation // 3, 4)
        assert (problem.tau, problem.epoch) == (generation, epoch)
        still = still_of(grid, movers, epoch, problem)
        assert problem.grid == still.grid and (problem.n_var, problem.xl.tolist(), problem.xu.tolist()) == bounds
        out = problem.evaluate(X, return_values_of=["F", "interfering_cells", "epoch"])
        assert np.array_equal(out[0], still.evaluate(X, return_values_of=["F"])) and set(out[2]) == {epoch}
        if generation % 3 != 1:
            np.testing.assert_array_equal(problem.pareto_front(), still.pareto_front())
            np.testing.assert_array_equal(problem.pareto_set(), still.pareto_set())
            np.testing.assert_array_equal(problem.ideal_point(), still.ideal_point())
        # What operators know is of this map: all that they make is legal.
        assert np.array_equal(terrain_of(problem).legal, terrain_of(still).legal)
        made = path_operators(problem)["mutation"].do(problem, Population.new("X", X.copy()), random_state=rng).get("X")
        assert (still.decode(made).interfering_cells == 0).all()
        seen.add(out[0].tobytes())
        problem.tic()
    # Or nothing would have moved.
    assert len(seen) > 3


def test_the_clock_can_be_set():
    *_, problem = make()
    first = problem.pareto_front()
    problem.tic(7)
    assert (problem.tau, problem.epoch) == (7, 2)
    later, grid = problem.pareto_front(), problem.grid
    problem.tau = 0
    assert problem.epoch == 0 and problem.pareto_front().tolist() == first.tolist()
    problem.time = 2
    assert problem.epoch == 2 and problem.grid == grid and problem.pareto_front().tolist() == later.tolist()
    problem.tic(3)
    assert problem.epoch == 2
    problem.time = None
    assert (problem.tau, problem.epoch) == (3, 1)
    again = pickle.loads(pickle.dumps(problem))
    assert again.epoch == 1 and again.grid == problem.grid
    again.tic(3)
    assert again.grid == grid and problem.epoch == 1


@pytest.mark.parametrize("name", ALGORITHMS)
@pytest.mark.parametrize("n_gen", [7, 9, 10])
@pytest.mark.filterwarnings("ignore:genes that are no whole numbers")
def test_no_stale_value_is_returned(name, n_gen):
    need(name)
    for seed in range(2):
        grid, movers, problem = make(seed)
        result = minimize(problem, make_algorithm(name, problem, 20), ("n_gen", n_gen), seed=seed, callback=ObstacleClock())
        epoch = (n_gen - 1) // 3
        assert problem.epoch == epoch and not problem.is_stale(result.pop).any()
        still = still_of(grid, movers, epoch, problem)
        for X, F in ((result.pop.get("X"), result.pop.get("F")), (np.atleast_2d(result.X), np.atleast_2d(result.F))):
            assert np.array_equal(still.evaluate(X, return_values_of=["F"]), F)
        crossed = np.asarray(result.pop.get("interfering_cells"))
        assert np.array_equal(crossed, still.decode(result.pop.get("X")).interfering_cells)
        assert (crossed == 0).any()


def test_with_pymoos_clock_values_may_be_stale_and_are_known_as_such():
    """What the clock of this package is for; a search that is told of nothing keeps what was good before."""
    stale = 0
    for seed in range(4):
        grid, movers, problem = make(seed, taut=4)
        result = minimize(problem, make_algorithm("NSGA2", problem, 20), ("n_gen", 8), seed=seed, callback=TimeSimulation())
        still = still_of(grid, movers, 2, problem)
        wrong = (still.evaluate(result.pop.get("X"), return_values_of=["F"]) != result.pop.get("F")).any(axis=1)
        assert not (wrong & ~problem.is_stale(result.pop)).any()
        stale += wrong.sum()
    assert stale > 0


def test_those_that_look_themselves_are_not_told():
    *_, problem = make()
    for name, told in (("DNSGA2", False), ("NSGA2", True)):
        algorithm = make_algorithm(name, problem, 10)
        problem.tau = 0
        algorithm.setup(problem, seed=1, termination=("n_gen", 9), callback=ObstacleClock())
        for _ in range(3):
            algorithm.next()
        assert problem.epoch == 1 and problem.is_stale(algorithm.pop).all() != told
    problem.tau = 0
    given = make_algorithm("DNSGA2", problem, 10)
    given.setup(problem, seed=1, termination=("n_gen", 9), callback=ObstacleClock(told=True))
    for _ in range(3):
        given.next()
    assert not problem.is_stale(given.pop).any()
    with pytest.raises(GridPathError, match=r"pop is .*, expected a Population"):
        problem.is_stale(np.array(["a", "b"]).view(Population))


def test_evaluations_anew_are_counted(monkeypatch):
    *_, problem = make()
    asked = []
    evaluate = problem._evaluate
    monkeypatch.setattr(problem, "_evaluate", lambda x, *args, **kwargs: asked.append(len(x)) or evaluate(x, *args, **kwargs))
    clock = ObstacleClock()
    result = minimize(problem, make_algorithm("NSGA2", problem, 10), ("n_gen", 7), seed=1, callback=clock)
    # Once a generation, all members when the map changed after the third and the sixth, and on the side as the epochs ended.
    assert len(asked) == 7 + 2 + 3 and result.algorithm.evaluator.n_eval == sum(asked) - 3 * len(result.pop)
    assert result.algorithm.callback.n_missed == 0


def test_an_algorithm_that_keeps_more_than_its_population_is_refused():
    *_, problem = make()
    with pytest.raises(CapabilityError, match="CTAEA keeps members beside its population"):
        make_algorithm("CTAEA", problem)
    given = make_algorithm("NSGA2", problem, 10)
    given.second = Population.new("X", np.zeros((2, problem.n_var), dtype=int))
    with pytest.raises(GridPathError, match=r"NSGA2 keeps members beside its population, .* expected another algorithm"):
        minimize(problem, given, ("n_gen", 2), callback=ObstacleClock())
    minimize(problem, given, ("n_gen", 2), callback=ObstacleClock(renew=False))


def test_all_others_go_on_and_return_what_is_true():
    """Of those whose row says so; pymoo's own survivals among them, which keep ideal points and ranks."""
    for name, row in CAPABILITIES.items():
        if row.unfit or not row.moving or row.extra or row.needs in ("ref_points", "automated_dm") or name in ALGORITHMS:
            continue
        grid, movers, problem = make(1, taut=2, n_epochs=4)
        if not row.takes(2):
            problem = MovingObstaclesProblem(grid, movers, START, GOAL, 2, objectives=["length"])
        result = minimize(problem, make_algorithm(name, problem, 10), ("n_gen", 8), seed=1, callback=(clock := ObstacleClock()))
        assert clock.faults == [(0, 0, 0)] * 4 and all(map(len, clock.F)), name
        assert np.array_equal(problem.still.evaluate(result.pop.get("X"), return_values_of=["F"]), result.pop.get("F")), name


def test_the_distance_shown_is_that_to_the_front_of_now():
    *_, problem = make(taut=1, n_epochs=4)
    output = PathOutput()
    algorithm = make_algorithm("NSGA2", problem, 10, output=output)
    algorithm.setup(problem, seed=1, termination=("n_gen", 2))
    algorithm.next()
    shown = algorithm.output
    before = shown._reference(problem)
    assert shown._reference(problem) is before
    problem.tic()
    assert shown._reference(problem) is not before
    assert shown._reference(problem).igd_plus(problem.pareto_front()) == pytest.approx(0, abs=1e-12)


def test_movers_beyond_the_edge_are_gone_and_the_last_position_holds():
    grid = OccupancyGrid(np.zeros((3, 5)))
    problem = MovingObstaclesProblem(grid, [[(2, 1), (2, 3)], [(4, 0)]], (0, 1), (4, 1), taut=1)
    assert problem.n_epochs == 2 and problem.grid.n_occupied == 2
    problem.tic(10)
    assert problem.grid.n_occupied == 1 and problem.grid.occupied[0, 4]
    assert MovingObstaclesProblem(grid, [], (0, 1), (4, 1)).n_epochs == 1


@pytest.mark.parametrize(
    ("movers", "kind", "said"),
    [
        ([[(1, 1)], [(2, 2), (0, 1)]], GridError, r"in epoch 1 mover 1 stands on the start \(0, 1\)"),
        ([[(3, 1), (4, 1)]], GridError, r"in epoch 1 mover 0 stands on the goal \(4, 1\)"),
        ([[(2, 0)], [(2, 1)], [(3, 2), (2, 2)]], UnreachableError, r"^in epoch 1: goal \(4, 1\) cannot be reached"),
        ([[(1.5, 1)]], GridPathError, "mover 0 is .*, expected cells"),
        ([[]], GridPathError, "mover 0 "),
        ([(1, 1)], GridPathError, "mover 0 is "),
        (3, GridPathError, "movers is 3"),
    ],
)
def test_wrong_ways_are_refused_when_the_problem_is_made(movers, kind, said):
    with pytest.raises(kind, match=said):
        MovingObstaclesProblem(OccupancyGrid(np.zeros((3, 5)), corner_cutting=True), movers, (0, 1), (4, 1))


def test_wrong_arguments_are_refused():
    grid = OccupancyGrid(np.zeros((3, 5)))
    for bad in ({"taut": 0}, {"penalty": -1}, {"max_cells": 2}, {"objectives": ()}):
        with pytest.raises(GridPathError):
            MovingObstaclesProblem(grid, [[(2, 0)]], (0, 1), (4, 1), **bad)
    problem = MovingObstaclesProblem(grid, [[(2, 0)]], (0, 1), (4, 1))
    for name, bad in (("tau", -1), ("time", 0.5)):
        with pytest.raises(GridPathError, match=name):
            setattr(problem, name, bad)
    still = GridPathProblem(grid, (0, 1), (4, 1))
    with pytest.raises(GridPathError, match="ObstacleClock is for a MovingObstaclesProblem"):
        minimize(still, make_algorithm("NSGA2", still, 10), ("n_gen", 2), callback=ObstacleClock())


def test_random_movers_step_to_free_neighbours_and_leave_a_way():
    grid, movers, _ = make(n_epochs=40)
    ways = np.stack(movers, axis=1)
    assert ways.shape == (40, 12, 2)
    steps = np.abs(np.diff(ways, axis=0)).max(axis=2)
    assert set(np.unique(steps)) == {0, 1}
    again, n_skipped = random_movers(grid, START, GOAL, 12, 40, 3)
    assert (np.abs(np.diff(np.stack(again, axis=1), axis=0)).max(axis=2) == 0).sum() == n_skipped
    for places in ways:
        assert len(np.unique(places, axis=0)) == 12 and not grid.occupied[places[:, 1], places[:, 0]].any()
    with pytest.raises(GridError, match="there is room for 3 movers that leave a way, expected 4"):
        random_movers(OccupancyGrid(np.zeros((2, 3)), corner_cutting=True), (0, 0), (2, 1), 4, 2, 1)


class Seen(Callback):
    """Keeps the epoch of each generation, and whether its values are those of the map of then."""

    def __init__(self):
        super().__init__()
        self.seen = []

    def _update(self, algorithm):
        problem = algorithm.problem
        F = problem.evaluate(algorithm.pop.get("X"), return_values_of=["F"])
        self.seen.append((problem.epoch, np.array_equal(F, algorithm.pop.get("F"))))


def test_the_clock_keeps_what_was_found_in_each_epoch():
    grid, movers, problem = make(taut=2, n_epochs=4)
    clock = ObstacleClock(callback=Seen())
    result = minimize(problem, make_algorithm("NSGA2", problem, 20), ("n_gen", 11), seed=1, callback=clock)
    # The last map is that of all generations after it came.
    assert clock.epochs == [0, 1, 2, 3] and clock.evaluations[-1] == result.algorithm.evaluator.n_eval
    # Two generations, and all members anew when the map had changed.
    assert np.diff(clock.evaluations)[:2].tolist() == [60, 60]
    assert clock.callback.seen == [(min(k // 2, 3), True) for k in range(11)]
    for epoch, X, F in zip(clock.epochs, clock.X, clock.F, strict=True):
        still = still_of(grid, movers, epoch, problem)
        assert len(F) and np.array_equal(still.evaluate(X, return_values_of=["F"]), F)
        assert (still.decode(X).interfering_cells == 0).all()
        assert problem.stills[epoch].grid == still.grid
    assert clock.faults == [(0, 0, 0)] * 4 and clock.missed == [0] * 4
    np.testing.assert_array_equal(np.unique(result.F, axis=0), clock.F[-1])
    fronts = [still.pareto_front() for still in problem.stills]
    ratios = [hypervolume_ratio(F, front) for F, front in zip(clock.F, fronts, strict=True)]
    assert mean_hypervolume_ratio(clock.F, fronts) == pytest.approx(np.mean(ratios)) and min(ratios) < 1
    # A run that ends within an epoch ends that one.
    problem.restart()
    minimize(problem, make_algorithm("NSGA2", problem, 20), ("n_gen", 3), seed=1, callback=(clock := ObstacleClock()))
    assert clock.epochs == [0, 1] and len(clock.F) == len(clock.X) == 2


def test_a_clock_that_renews_nothing_keeps_what_is_true_all_the_same():
    *_, problem = make(taut=2, n_epochs=4)
    clock = ObstacleClock(renew=False)
    result = minimize(problem, make_algorithm("NSGA2", problem, 20), ("n_gen", 8), seed=1, callback=clock)
    # It is the search of pymoo's own clock.
    problem.restart()
    other = minimize(problem, make_algorithm("NSGA2", problem, 20), ("n_gen", 8), seed=1, callback=TimeSimulation())
    assert np.array_equal(result.pop.get("F"), other.pop.get("F")) and problem.is_stale(result.pop).any()
    assert result.algorithm.evaluator.n_eval == other.algorithm.evaluator.n_eval
    for epoch, X, F in zip(clock.epochs, clock.X, clock.F, strict=True):
        assert np.array_equal(problem.stills[epoch].evaluate(X, return_values_of=["F"]).reshape(F.shape), F)
    # The members that it returns are what the map of the end says of them.
    crossed = problem.still.decode(result.pop.get("X")).interfering_cells
    wrong = (problem.still.evaluate(result.pop.get("X"), return_values_of=["F"]) != result.pop.get("F")).any(axis=1)
    illegal = (np.asarray(result.pop.get("interfering_cells")) == 0) & (crossed > 0)
    assert clock.faults[-1] == (problem.is_stale(result.pop).sum(), wrong.sum(), illegal.sum())
    assert clock.faults[0] == (0, 0, 0) and clock.faults[-1].stale >= wrong.sum() > 0 and clock.missed == [0] * 4
    with pytest.raises(GridPathError, match="told is True and renew False"):
        ObstacleClock(told=True, renew=False)


def test_a_run_does_not_begin_where_another_one_ended():
    *_, problem = make()
    first = minimize(problem, make_algorithm("NSGA2", problem, 10), ("n_gen", 7), seed=1, callback=ObstacleClock())
    with pytest.raises(GridPathError, match=r"at generation 6, expected problem\.restart\(\)"):
        minimize(problem, make_algorithm("NSGA2", problem, 10), ("n_gen", 7), seed=1, callback=ObstacleClock())
    # What is set is meant.
    problem.tau = 3
    minimize(problem, make_algorithm("NSGA2", problem, 10), ("n_gen", 4), seed=1, callback=(clock := ObstacleClock()))
    assert clock.epochs == [1, 2]
    runs = minimize_runs(problem, make_algorithm("NSGA2", problem, 10), ("n_gen", 7), 2, seed=1, callback=ObstacleClock())
    assert np.array_equal(runs[0].F, first.F) and [run.algorithm.callback.epochs for run in runs] == [[0, 1, 2]] * 2
    still = GridPathProblem(problem.grid, START, GOAL)
    still.restart()
    assert still.stills == (still,)
