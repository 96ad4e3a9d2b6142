"""Constrained MOEA/D with a smoothness tie-break."""

from __future__ import annotations

import copy
import math
import pickle
from typing import Any

import numpy as np
import pytest
from pymoo.algorithms.moo.moead import MOEAD
from pymoo.core.mating import Mating
from pymoo.core.population import Population
from pymoo.decomposition.pbi import PBI
from pymoo.decomposition.tchebicheff import Tchebicheff
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.bitflip import BitflipMutation
from pymoo.operators.mutation.pm import PM
from pymoo.operators.repair.rounding import RoundingRepair
from pymoo.optimize import minimize
from pymoo.problems.many.dtlz import DTLZ2

from pymoo_gridpath import GridPathProblem
from pymoo_gridpath.algorithms import SmoothMOEAD, make_algorithm, reference_directions
from pymoo_gridpath.errors import CapabilityError, GridPathError
from pymoo_gridpath.operators import paper_operators, path_operators
from pymoo_gridpath.operators.mating import FirstChildMating, NeighborSelection
from pymoo_gridpath.problems.scenarios import random_dense_grid


def population(F, cv, turn, X=None):
    X = np.arange(len(F))[:, None] if X is None else X
    return Population.new("X", X, "F", np.array(F, float), "G", np.array(cv, float)[:, None], "turn", np.array(turn))


def prepared(make_problem, F, cv, turn, **kwargs):
    """Return an algorithm that is about to replace members of a hand-made population."""
    n = len(F)
    algorithm = SmoothMOEAD(reference_directions(2, n), **{"n_neighbors": n, "n_replace": n} | kwargs)
    algorithm.setup(make_problem(2, "constraint"), termination=("n_gen", 1), seed=1)
    algorithm.pop = population(F, cv, turn)
    algorithm.ideal = np.full(2, np.inf)
    algorithm._read_population()
    algorithm._rescale()
    return algorithm


def replaced(algorithm, F, cv, turn, genes=-1):
    """Return whom a child replaces."""
    children = population([F], [cv], [turn], np.array([[genes]]))
    algorithm._replace(np.array([0]), children)
    places = [k for k, individual in enumerate(algorithm.pop) if individual is children[0]]
    check_arrays(algorithm)
    return places


def check_arrays(algorithm):
    """The arrays beside the population follow it."""
    assert np.array_equal(algorithm._F, algorithm.pop.get("F")) and np.array_equal(algorithm._X, algorithm.pop.get("X"))
    assert np.array_equal(algorithm._cv, algorithm.pop.get("CV")[:, 0])


F3 = [[4.0, 0.0], [2.0, 2.0], [0.0, 4.0]]  # directions (0, 1), (1/2, 1/2), (1, 0)


def test_equal_objectives_are_decided_by_turn(make_problem):
    assert replaced(prepared(make_problem, F3, [0, 0, 0], [90, 90, 90]), [2, 2], 0, 45) == [1]
    assert replaced(prepared(make_problem, F3, [0, 0, 0], [90, 90, 90]), [2, 2], 0, 90) == []
    assert replaced(prepared(make_problem, F3, [0, 0, 0], [90, 90, 90], smoothness=False), [2, 2], 0, 45) == []


def test_turn_decides_within_a_band(make_problem):
    """The front is 4 wide, so that a band of 0.01 is 0.04: from 2 up to 2.04."""
    within, beyond, better = [2.02, 2.03], [2.02, 2.05], [1.98, 1.98]
    turns = [90, 90, 90]
    assert replaced(prepared(make_problem, F3, [0, 0, 0], turns), within, 0, 45) == [1]
    assert replaced(prepared(make_problem, F3, [0, 0, 0], turns), within, 0, 90) == []
    assert replaced(prepared(make_problem, F3, [0, 0, 0], turns), beyond, 0, 45) == []
    assert replaced(prepared(make_problem, F3, [0, 0, 0], turns), better, 0, 900) == [1]
    assert replaced(prepared(make_problem, F3, [0, 0, 0], turns, band=0), within, 0, 45) == []
    # Of equal turns the better path stays, if only by less than a step.
    F = [[4.0, 0.0], [2.02, 2.03], [0.0, 4.0]]
    assert replaced(prepared(make_problem, F, [0, 0, 0], turns), [2.02, 2.01], 0, 90) == [1]
    assert replaced(prepared(make_problem, F, [0, 0, 0], turns), [2.03, 2.01], 0, 90) == []


def test_bands_are_checked(make_problem):
    for band in (-0.1, 0.6, "wide", float("nan")):
        with pytest.raises(CapabilityError, match=r"^band is .*, expected a share from 0 to 0.5"):
            SmoothMOEAD(np.eye(2), band=band)
    with pytest.raises(CapabilityError, match=r"band is 0\.1 and smoothness is False, expected no band"):
        make_algorithm("MOEAD", make_problem(), 10, smoothness=False, band=0.1)
    assert make_algorithm("MOEAD", make_problem(), 10, smoothness=False).band == 0
    assert make_algorithm("MOEAD", make_problem(), 10).band == 0.01


@pytest.mark.parametrize("operators", [paper_operators, path_operators])
def test_the_band_smooths_fronts(operators):
    grid = random_dense_grid(16, 0.15, 2)
    problem = GridPathProblem(grid, (0, 0), (15, 15), "integer")
    turns = []
    for band in (0.0, 0.05):
        algorithm = make_algorithm("MOEAD", problem, 50, operators=operators(problem), band=band)
        result: Any = minimize(problem, algorithm, ("n_gen", 40), seed=1)
        turns.append(np.mean(result.opt.get("turn")))
    assert turns[1] < turns[0]


def test_replacements_are_limited_and_copies_are_not_spread(make_problem):
    assert replaced(prepared(make_problem, F3, [0, 0, 0], [90, 90, 90]), [0, 0], 0, 90) == [0, 1, 2]
    picked = [replaced(prepared(make_problem, F3, [0, 0, 0], [90, 90, 90], n_replace=2), [0, 0], 0, 90) for _ in range(3)]
    assert all(len(places) == 2 for places in picked)
    assert replaced(prepared(make_problem, F3, [0, 0, 0], [90, 90, 90]), [0, 0], 0, 90, genes=1) == []
    for name in ("n_replace", "batch_size"):
        with pytest.raises(CapabilityError, match=f"{name} is 0"):
            SmoothMOEAD(np.eye(2), **{name: 0})


def test_violation_goes_before_objectives_and_turn(make_problem):
    assert replaced(prepared(make_problem, F3, [0, 1, 2], [0, 0, 0]), [9, 9], 1, 900) == [2]
    assert replaced(prepared(make_problem, F3, [0, 0, 0], [90, 90, 90]), [0, 0], 1, 0) == []


def test_dominance_goes_before_turn(make_problem):
    """In direction (1, 0) only the first objective counts, in which all three tie."""
    F = [[4.0, 4.0], [4.0, 3.0], [4.0, 2.0]]
    assert 2 not in replaced(prepared(make_problem, F, [0, 0, 0], [90, 90, 90]), [4, 3], 0, 0)
    assert 2 in replaced(prepared(make_problem, F, [0, 0, 0], [0, 0, 0]), [4, 1], 0, 900)


def expected(weights, F, cv, turn, child, band):
    """Say whom a child replaces, one neighbour at a time."""

    def scale(f):
        scaled = [(x - low) / width for x, low, width in zip(f, ideal, span, strict=True)]
        return [math.floor(x / band) * band for x in scaled] if band else scaled

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
        a, b = scale(f), scale(F[k])
        new, old = (max(x * abs(y) for x, y in zip(w, point, strict=True)) for point in (a, b))
        if v != cv[k]:
            wins = v < cv[k]
        elif abs(old - new) > 1e-9 * (1 + abs(old)):
            wins = new < old
        elif a != b and all(x <= y for x, y in zip(a, b, strict=True)):
            wins = True
        elif a != b and all(x >= y for x, y in zip(a, b, strict=True)):
            wins = False
        elif a == b and t == turn[k]:
            wins = all(f <= F[k]) and any(f < F[k])
        else:
            wins = t < turn[k]
        places += [k] if wins else []
    return places


@pytest.mark.parametrize("seed", range(60))
def test_replacement_matches_a_loop(seed, make_problem):
    rng = np.random.default_rng(seed)
    n = 9
    F, cv, turn = rng.integers(1, 5, (n, 2)).astype(float), rng.integers(0, 2, n), rng.integers(0, 3, n)
    band = (0.0, 0.01, 0.4)[seed % 3]
    if seed % 4 == 0:
        cv += 1
    child = rng.integers(1, 5, 2).astype(float), int(rng.integers(0, 2)), int(rng.integers(0, 3))
    algorithm = prepared(make_problem, F, cv, turn, band=band)
    # The neighbourhood holds everybody, nearest first.
    assert sorted(algorithm.neighbors[0]) == list(range(n))
    assert replaced(algorithm, *child) == expected(algorithm.ref_dirs, F, cv, turn, child, band)


@pytest.mark.parametrize("seed", range(60))
def test_children_of_a_batch_replace_one_after_another(seed, make_problem):
    rng = np.random.default_rng(seed)
    n, n_children = 12, 30
    F, cv, turn = rng.integers(1, 6, (n, 2)), rng.integers(0, 2, n), rng.integers(0, 3, n)
    genes = rng.integers(0, 40, (n_children, 1))
    children = population(
        rng.integers(0, 6, (n_children, 2)), rng.integers(0, 2, n_children), turn.repeat(3)[:n_children], genes
    )
    subproblems = rng.integers(0, n, n_children)
    at_once, alone = (prepared(make_problem, F, cv, turn, n_neighbors=6, n_replace=2) for _ in range(2))
    at_once._replace(subproblems, children)
    alone._move_ideal(children.get("F"), children.get("CV")[:, 0] <= 0.0)
    for k in range(n_children):
        alone._replace(subproblems[k : k + 1], children[k : k + 1])
    check_arrays(at_once)
    assert at_once.pop.get("X").tolist() == alone.pop.get("X").tolist()
    assert at_once.random_state.random() == alone.random_state.random()


@pytest.mark.parametrize("decomposition", [PBI(), Tchebicheff()])
def test_without_its_additions_it_is_pymoos(decomposition):
    """One child at a time, no scaling, no limit, and no ties of neighbours or of children: the same bits."""
    dirs = np.random.default_rng(1).dirichlet(np.ones(3), 15)
    # With a type of genes of their own, operators go pymoo's way in both.
    operators = {"crossover": SBX(eta=15, prob=1.0, vtype=float), "mutation": PM(eta=20, prob_var=1.0, vtype=float)}
    settings: dict[str, Any] = {"n_neighbors": 6, "decomposition": decomposition} | operators
    ours = SmoothMOEAD(dirs, smoothness=False, normalize=False, n_replace=6, batch_size=1, **settings)
    results = [minimize(DTLZ2(n_var=6), algorithm, ("n_gen", 12), seed=1) for algorithm in (ours, MOEAD(dirs, **settings))]
    assert np.array_equal(*(result.pop.get("X") for result in results))
    assert np.array_equal(*(result.F for result in results))


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


@pytest.mark.parametrize("batch_size", [1, 4, None, 100])
def test_a_generation_has_a_child_a_direction(batch_size, make_problem):
    problem, seen = make_problem(3), []
    algorithm = make_algorithm("MOEAD", problem, 20, batch_size=batch_size, callback=lambda a: seen.append(a.evaluator.n_eval))
    result = minimize(problem, algorithm, ("n_eval", 40), seed=1)
    assert len(result.pop) == 15 and seen == [15, 30, 45] and result.algorithm.n_gen == 4


def elsewhere():
    """Return operators that are not this package's."""
    return {"crossover": SBX(vtype=float, repair=RoundingRepair()), "mutation": PM(vtype=float, repair=RoundingRepair())}


@pytest.mark.parametrize("operators", [{}, elsewhere()], ids=["own", "elsewhere"])
@pytest.mark.parametrize("copied", [lambda a: pickle.loads(pickle.dumps(a)), copy.deepcopy], ids=["pickled", "copied"])
def test_a_run_goes_on_from_a_copy_within_a_generation(operators, copied, make_problem):
    problem = make_problem(2, "constraint")
    algorithm = make_algorithm("MOEAD", problem, 14, batch_size=4, **operators)
    algorithm.setup(problem, termination=("n_gen", 6), seed=1)
    for _ in range(7):  # the first population, a generation of four batches and two more batches
        algorithm.next()
    other = copied(algorithm)
    assert algorithm.evaluator.n_eval == 28 + 8 and algorithm.n_gen == 3
    F = [run.run().pop.get("F") for run in (algorithm, other)]
    assert np.array_equal(*F) and other.evaluator.n_eval == 84


def test_operators_from_elsewhere_are_called_as_pymoo_does(make_problem):
    problem = make_problem()
    assert isinstance(make_algorithm("MOEAD", problem, 10).mating, FirstChildMating)
    algorithm = make_algorithm("MOEAD", problem, 20, **elsewhere())
    assert type(algorithm.mating) is Mating
    result = minimize(problem, algorithm, ("n_gen", 10), seed=1)
    # Their own repair is heeded, which the array hook knows nothing of.
    assert np.array_equal(result.pop.get("X"), np.rint(result.pop.get("X"))) and result.algorithm.evaluator.n_eval == 200


def test_ask_and_tell_is_a_run(make_problem):
    problem = make_problem()
    algorithm = make_algorithm("MOEAD", problem, 10)
    expected = minimize(problem, algorithm, ("n_gen", 5), seed=1).F
    algorithm.setup(problem, termination=("n_gen", 5), seed=1)
    while algorithm.has_next():
        children = algorithm.ask()
        assert len(children) == 10
        algorithm.tell(infills=algorithm.evaluator.eval(problem, children))
    assert np.array_equal(algorithm.result().F, expected)


def test_parents_are_different_neighbors():
    rng = np.random.default_rng(1)
    neighbors = np.array([rng.permutation(9)[:4] for _ in range(6000)])
    pop = Population.empty(9)
    P = NeighborSelection(0.75).do(None, pop, 6000, 2, to_pop=False, neighbors=neighbors, random_state=rng)
    assert (P[:, 0] != P[:, 1]).all() and np.array_equal(np.unique(P), np.arange(9))
    # A quarter is drawn from all, of which (4 * 3) / (9 * 8) are neighbours by chance.
    near = (P[:, :, None] == neighbors[:, None]).any(axis=2).all(axis=1)
    assert near.mean() == pytest.approx(0.75 + 0.25 / 6, abs=0.02)
    # Any of the neighbours as often, first and second.
    places = (P[near][:, :, None] == neighbors[near][:, None]).argmax(axis=2)
    assert np.allclose([np.bincount(column) / len(places) for column in places.T], 0.25, atol=0.025)
    with pytest.raises(GridPathError, match="5 different parents cannot be chosen among 4"):
        NeighborSelection().do(None, pop, 1, 5, neighbors=neighbors[:1], random_state=rng)


def test_directions_are_checked(make_problem):
    with pytest.raises(CapabilityError, match="two or more reference directions"):
        SmoothMOEAD(np.eye(2)[:1])
    with pytest.raises(CapabilityError, match="3 columns, the problem 2 objectives"):
        SmoothMOEAD(np.eye(3)).setup(make_problem(2))
