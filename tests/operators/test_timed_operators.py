"""Operators of paths in time: what they make is legal by rules that are written down a second time, new, and the same again."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pymoo_gridpath import OccupancyGrid, path_operators
from pymoo_gridpath.errors import GridPathError, UnreachableError
from pymoo_gridpath.operators import (
    RandomTimedSampling,
    TimedCrossover,
    TimedMutation,
    TimedRepair,
    TimedSampling,
    path_timed,
)
from pymoo_gridpath.operators.path_timed import TIMED_WAYS
from pymoo_gridpath.paths import Sequences
from pymoo_gridpath.problems import TimedPathProblem
from pymoo_gridpath.testing import OperatorSuite
from pymoo_gridpath.testing.timed import measured, wander


def make(seed=0, size=9, horizon=20, n_movers=3, density=0.1, corner_cutting=False):
    """A problem that can be solved, with what the rules want."""
    rng = np.random.default_rng([11, seed])
    while True:
        height, width = (size, size) if np.ndim(size) == 0 else size
        occupied = rng.random((height, width)) < density
        occupied[0], occupied[:, -1] = False, False
        ways = [wander(rng, max(height, width), horizon) for _ in range(n_movers)]
        try:
            grid = OccupancyGrid(occupied, corner_cutting=corner_cutting)
            return TimedPathProblem(grid, (0, 0), (width - 1, height - 1), ways, horizon), ways
        except UnreachableError:
            continue


def all_legal(problem, ways, X):
    """Whether rows are legal paths by the rules, and the goal to their ends."""
    grid = problem.grid
    for row in X:
        cells = [(int(cell) % grid.width, int(cell) // grid.width) for cell in row]
        legal, (arrival, *_) = measured(grid.occupied, grid.corner_cutting, problem.goal, ways, cells)
        if cells[0] != problem.start or not legal or set(cells[arrival:]) != {problem.goal}:
            return False
    return True


def new_rows(X, before):
    return len({tuple(row) for row in X.tolist()} - {tuple(row) for row in before.tolist()})


@settings(max_examples=25, deadline=None)
@given(
    st.integers(0, 10**6), st.tuples(st.integers(1, 7), st.integers(2, 7)), st.integers(0, 4), st.integers(0, 6), st.booleans()
)
def test_whatever_operators_make_is_legal(seed, size, n_movers, spare, corner_cutting):
    problem, ways = make(seed, size, max(size) + spare, n_movers if min(size) > 2 else min(n_movers, 1), 0.2, corner_cutting)
    rng = np.random.default_rng(seed)
    bad = rng.integers(problem.xl, problem.xu, (8, problem.n_var), endpoint=True)
    for sampling in ("scalarized", "random"):
        made = path_operators(problem, sampling)
        good = made["sampling"]._do(problem, 8, random_state=rng)
        assert all_legal(problem, ways, good)
        for X in (good, bad):
            before = X.copy()
            for n_offsprings in (1, 2):
                children = TimedCrossover(n_offsprings=n_offsprings)._do(problem, X.reshape(2, 4, -1), random_state=rng)
                assert children.shape == (n_offsprings, 4, problem.n_var)
                assert all_legal(problem, ways, children.reshape(-1, problem.n_var))
            for way in TIMED_WAYS:
                assert all_legal(problem, ways, TimedMutation({way: 1})._do(problem, X, random_state=rng))
            assert all_legal(problem, ways, made["repair"]._do(problem, X, random_state=rng))
            assert np.array_equal(X, before)
        assert np.array_equal(made["repair"]._do(problem, good, random_state=rng), good)


# -- what they do -------------------------------------------------------------------------------------------------------------


def test_samples_contain_the_best_of_each_objective_and_few_duplicates():
    problem, _ = make()
    front = problem.pareto_front(max_seconds=None)
    X = TimedSampling()._do(problem, 60, random_state=np.random.default_rng(0))
    F = problem.evaluate(X)
    # The vulnerability's potential is scaled to whole numbers.
    np.testing.assert_allclose(F.min(axis=0), front.min(axis=0), atol=1e-3)
    assert len(np.unique(X, axis=0)) > 50
    assert len(np.unique(TimedSampling(noise=0)._do(problem, 60, random_state=np.random.default_rng(0)), axis=0)) < 50
    anywhere = RandomTimedSampling()._do(problem, 60, random_state=np.random.default_rng(0))
    assert len(np.unique(anywhere, axis=0)) > 50
    assert problem.decode(anywhere).arrival.mean() > problem.decode(X).arrival.min() + 2


def test_searches_for_samples_are_few(monkeypatch):
    searched = []
    draw = path_timed.draw_timed
    monkeypatch.setattr(
        path_timed, "draw_timed", lambda terrain, w, *rest: (searched.append(len(w)), draw(terrain, w, *rest))[1]
    )
    monkeypatch.setattr(path_timed, "SEARCH_STATES", 0)
    problem, ways = make()
    X = TimedSampling()._do(problem, 60, random_state=np.random.default_rng(0))
    assert sum(searched) <= path_timed.LEAST_SEARCHES
    assert all_legal(problem, ways, X) and len(np.unique(X, axis=0)) > 40


def test_most_children_are_new():
    problem, _ = make()
    rng = np.random.default_rng(0)
    X = RandomTimedSampling()._do(problem, 80, random_state=rng)
    children = TimedCrossover()._do(problem, X.reshape(2, 40, -1), random_state=rng).reshape(80, -1)
    assert new_rows(children, X) > 60
    for way, least in (("weighted", 25), ("random", 25), ("delay", 45), ("hurry", 20)):
        assert new_rows(TimedMutation({way: 1})._do(problem, X, random_state=rng), X) > least, way


def test_children_are_of_their_parents_where_these_meet():
    """From a cell that both visit at the same tick a child goes on as the second; each step is one of either."""
    problem, _ = make(n_movers=0, density=0)
    rng = np.random.default_rng(3)
    X = RandomTimedSampling()._do(problem, 40, random_state=rng)
    children = TimedCrossover(reach=0)._do(problem, X.reshape(2, 20, -1), random_state=rng)
    for k in range(20):
        steps = {pair for row in X.reshape(2, 20, -1)[:, k].tolist() for pair in itertools.pairwise(row)}
        for child in children[:, k]:
            # And waits for the tick of the second.
            assert all(a == b or (a, b) in steps for a, b in itertools.pairwise(child.tolist()))


def test_waits_are_inserted_and_dropped():
    problem, _ = make(size=(1, 5), n_movers=0, density=0, horizon=8)
    rng = np.random.default_rng(0)
    row = np.array([[0, 1, 2, 3, 4, 4, 4, 4, 4]] * 20)
    delayed = TimedMutation({"delay": 1}, shift=1)._do(problem, row, random_state=rng)
    assert set(problem.decode(delayed).arrival.tolist()) == {5} and len(np.unique(delayed, axis=0)) == 4
    hurried = TimedMutation({"hurry": 1})._do(problem, delayed, random_state=rng)
    assert np.array_equal(hurried, row)
    assert np.array_equal(TimedMutation({"hurry": 1})._do(problem, row, random_state=rng), row)


def test_repair_follows_a_row_as_long_as_it_can():
    problem, _ = make(size=(3, 5), n_movers=0, density=0, horizon=8)
    rows = [[0, 1, 1, 6, 14, 0, 14, 14, 14], [0, 5, 10, 10, 10, 10, 10, 10, 14], [0, 14, 0, 14, 0, 14, 0, 14, 14]]
    repaired = TimedRepair()._do(problem, np.array(rows), random_state=np.random.default_rng(0))
    paths = problem.decode(repaired)
    assert repaired[0].tolist()[:4] == [0, 1, 1, 6] and paths.length[0] == pytest.approx(4 + 2**0.5)
    # It waits as long as the goal can be reached in time.
    assert repaired[1].tolist()[:5] == [0, 5, 10, 10, 10] and paths.arrival.tolist() == [6, 8, 4]


def test_rows_of_paths_come_back():
    problem, _ = make()
    coding = problem.representation
    X = RandomTimedSampling()._do(problem, 20, random_state=np.random.default_rng(0))
    assert np.array_equal(coding.from_sequences(coding.to_sequences(X)), X)
    assert np.array_equal(coding.encode(coding.decode(X)), X)
    assert np.array_equal(coding.decode(X)[3:5].arrival, coding.decode(X).arrival[3:5])
    beyond = Sequences(np.array([0, 1, 80, 80, 79, 80]), np.array([0, 6]))
    assert coding.from_sequences(beyond)[0].tolist() == [0, 1, *[80] * 19]
    late = Sequences(np.array([*[0] * 21, 80]), np.array([0, 22]))
    with pytest.raises(GridPathError, match="arrives at tick 21, expected at most 20, the horizon"):
        coding.from_sequences(late)
    with pytest.raises(GridPathError, match="leads between other cells"):
        coding.from_sequences(Sequences(np.array([0, 1]), np.array([0, 2])))


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda: TimedSampling(noise=5), "noise is 5"),
        (lambda: RandomTimedSampling(roughness=-1), "roughness is -1"),
        (lambda: RandomTimedSampling(detour=-1), "detour is -1"),
        (lambda: TimedCrossover(reach=-1), "reach is -1"),
        (lambda: TimedCrossover(prob=2), "prob is 2"),
        (lambda: TimedCrossover(n_offsprings=3), "n_offsprings is 3"),
        (lambda: TimedMutation({"teleport": 1}), "there is no way 'teleport' to mutate a path, expected weighted, random"),
        (lambda: TimedMutation({"delay": 0}), "one or more are positive"),
        (lambda: TimedMutation(shift=0), "shift is 0"),
    ],
)
def test_wrong_parameters_are_refused(wrong, message):
    with pytest.raises(GridPathError, match=message):
        wrong()


# -- what every operator does -------------------------------------------------------------------------------------------------


class TimedSuite(OperatorSuite):
    def problem(self):
        return make(size=6, horizon=10)[0]


class TestTimedCrossover(TimedSuite):
    def make(self):
        return TimedCrossover()


class TestTimedMutation(TimedSuite):
    def make(self):
        return TimedMutation()
