"""Constrained MOEA/D with a smoothness tie-break."""

from __future__ import annotations

import numpy as np
import pytest
from pymoo.core.population import Population
from pymoo.operators.mutation.bitflip import BitflipMutation
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem
from pymoo_gridpath.algorithms import SmoothMOEAD, make_algorithm, reference_directions
from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.problems.scenarios import random_dense_grid


def population(F, cv, turn, X=None):
    X = np.arange(len(F))[:, None] if X is None else X
    return Population.new("X", X, "F", np.array(F, float), "G", np.array(cv, float)[:, None], "turn", np.array(turn))


def prepared(make_problem, F, cv, turn, **kwargs):
    """Return an algorithm that is about to replace members of a hand-made population."""
    n = len(F)
    algorithm = SmoothMOEAD(reference_directions(2, n), n_neighbors=n, **{"n_replace": n} | kwargs)
    algorithm.setup(make_problem(2, "constraint"), termination=("n_gen", 1), seed=1)
    algorithm.pop = population(F, cv, turn)
    algorithm.ideal = np.full(2, np.inf)
    algorithm._read_population()
    algorithm._rescale()
    return algorithm


def replaced(algorithm, F, cv, turn, genes=-1):
    """Return whom a child replaces."""
    child = population([F], [cv], [turn], np.array([[genes]]))[0]
    algorithm._move_ideal(child.F[None], child.CV <= 0)
    algorithm._replace(0, child)
    places = [k for k, individual in enumerate(algorithm.pop) if individual is child]
    # The arrays beside the population follow it.
    assert np.array_equal(algorithm._F, algorithm.pop.get("F")) and np.array_equal(algorithm._X, algorithm.pop.get("X"))
    assert np.array_equal(algorithm._cv, algorithm.pop.get("CV")[:, 0])
    return places


F3 = [[4.0, 0.0], [2.0, 2.0], [0.0, 4.0]]  # directions (0, 1), (1/2, 1/2), (1, 0)


def test_equal_objectives_are_decided_by_turn(make_problem):
    assert replaced(prepared(make_problem, F3, [0, 0, 0], [90, 90, 90]), [2, 2], 0, 45) == [1]
    assert replaced(prepared(make_problem, F3, [0, 0, 0], [90, 90, 90]), [2, 2], 0, 90) == []
    assert replaced(prepared(make_problem, F3, [0, 0, 0], [90, 90, 90], smoothness=False), [2, 2], 0, 45) == []


def test_replacements_are_limited_and_copies_are_not_spread(make_problem):
    assert replaced(prepared(make_problem, F3, [0, 0, 0], [90, 90, 90]), [0, 0], 0, 90) == [0, 1, 2]
    picked = [replaced(prepared(make_problem, F3, [0, 0, 0], [90, 90, 90], n_replace=2), [0, 0], 0, 90) for _ in range(3)]
    assert all(len(places) == 2 for places in picked)
    assert replaced(prepared(make_problem, F3, [0, 0, 0], [90, 90, 90]), [0, 0], 0, 90, genes=1) == []
    with pytest.raises(CapabilityError, match="n_replace is 0"):
        SmoothMOEAD(np.eye(2), n_replace=0)


def test_violation_goes_before_objectives_and_turn(make_problem):
    assert replaced(prepared(make_problem, F3, [0, 1, 2], [0, 0, 0]), [9, 9], 1, 900) == [2]
    assert replaced(prepared(make_problem, F3, [0, 0, 0], [90, 90, 90]), [0, 0], 1, 0) == []


def test_dominance_goes_before_turn(make_problem):
    """In direction (1, 0) only the first objective counts, in which all three tie."""
    F = [[4.0, 4.0], [4.0, 3.0], [4.0, 2.0]]
    assert 2 not in replaced(prepared(make_problem, F, [0, 0, 0], [90, 90, 90]), [4, 3], 0, 0)
    assert 2 in replaced(prepared(make_problem, F, [0, 0, 0], [0, 0, 0]), [4, 1], 0, 900)


def expected(weights, F, cv, turn, child):
    """Say whom a child replaces, one neighbour at a time."""
    feasible = [f for f, v in zip(F, cv, strict=True) if v <= 0]
    known = feasible or F
    front = [f for f in known if not any(all(g <= f) and any(g < f) for g in known)]
    ideal = np.min(known, axis=0)
    span = np.max(front, axis=0) - ideal
    span = np.where(span > 0, span, 1.0)
    f, v, t = child
    if v <= 0 and not feasible:
        ideal = f
    elif v <= 0 or not feasible:
        ideal = np.minimum(ideal, f)
    places = []
    for k, w in enumerate(weights):
        old, new = (max(w * abs(x - ideal) / span) for x in (F[k], f))
        if v != cv[k]:
            wins = v < cv[k]
        elif abs(old - new) > 1e-9 * (1 + abs(old)):
            wins = new < old
        elif all(f <= F[k]) and any(f < F[k]):
            wins = True
        elif all(f >= F[k]) and any(f > F[k]):
            wins = False
        else:
            wins = t < turn[k]
        places += [k] if wins else []
    return places


@pytest.mark.parametrize("seed", range(60))
def test_replacement_matches_a_loop(seed, make_problem):
    rng = np.random.default_rng(seed)
    n = 9
    F, cv, turn = rng.integers(1, 5, (n, 2)).astype(float), rng.integers(0, 2, n), rng.integers(0, 3, n)
    if seed % 4 == 0:
        cv += 1
    child = rng.integers(1, 5, 2).astype(float), int(rng.integers(0, 2)), int(rng.integers(0, 3))
    algorithm = prepared(make_problem, F, cv, turn)
    # The neighbourhood holds everybody, nearest first.
    assert sorted(algorithm.neighbors[0]) == list(range(n))
    assert replaced(algorithm, *child) == expected(algorithm.ref_dirs, F, cv, turn, child)


def test_one_range_does_not_drown_another(make_problem):
    """The compromise (1, 50) of an objective in ones and one in hundreds is found only with scaling."""
    F = [[0.0, 100.0], [2.0, 0.0], [2.0, 0.0]]
    assert 1 in replaced(prepared(make_problem, F, [0, 0, 0], [0, 0, 0]), [0.9, 45], 0, 0)
    assert 1 not in replaced(prepared(make_problem, F, [0, 0, 0], [0, 0, 0], normalize=False), [0.9, 45], 0, 0)


@pytest.mark.parametrize("n_obj", [2, 3])
def test_finds_paths_free_of_obstacles(n_obj):
    grid = random_dense_grid(10, 0.1, 1)
    problem = GridPathProblem(grid, (0, 0), (9, 9), "integer", ("length", "vulnerability", "turn")[:n_obj], "constraint")
    result = minimize(problem, make_algorithm("MOEA/D", problem, 36), ("n_gen", 30), seed=1)
    assert result.X is not None
    paths = problem.decode(result.X)
    for k in range(len(result.X)):
        cells = paths.cells(k)
        assert not grid.occupied[cells[:, 1], cells[:, 0]].any()
        assert cells[0].tolist() == [0, 0] and cells[-1].tolist() == [9, 9]
        assert np.abs(np.diff(cells, axis=0)).max() == 1


def test_mating_is_told_the_algorithm(make_problem):
    told = []

    class Listening(BitflipMutation):
        def _do(self, problem, X, algorithm=None, **kwargs):
            told.append(algorithm.termination.perc)
            return X

    problem = make_problem(representation="binary")
    minimize(problem, make_algorithm("MOEAD", problem, 10, mutation=Listening()), ("n_gen", 5), seed=1)
    assert told == sorted(told) and told[0] == pytest.approx(0.2) and told[-1] == pytest.approx(0.8)


def test_population_is_the_directions(make_problem):
    problem = make_problem(3)
    result = minimize(problem, make_algorithm("MOEAD", problem, 20), ("n_gen", 3), seed=1)
    assert len(result.pop) == 15 and result.algorithm.evaluator.n_eval == 45


def test_directions_are_checked(make_problem):
    with pytest.raises(CapabilityError, match="two or more reference directions"):
        SmoothMOEAD(np.eye(2)[:1])
    with pytest.raises(CapabilityError, match="3 columns, the problem 2 objectives"):
        SmoothMOEAD(np.eye(3)).setup(make_problem(2))
