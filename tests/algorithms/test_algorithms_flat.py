"""Constant objectives, fronts of one point and of two: no algorithm crashes, computes what is no number, or stands still."""

from __future__ import annotations

import importlib.util
import math
import warnings

import numpy as np
import pytest
from pymoo.algorithms.moo.rvea import APDSurvival
from pymoo.algorithms.moo.spea2 import SPEA2Survival
from pymoo.core.population import Population
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import CAPABILITIES, StrengthAndSmoothness, make_algorithm, reference_directions
from pymoo_gridpath.algorithms.known import _PACKAGES
from pymoo_gridpath.algorithms.rvea import FiniteAPDSurvival
from pymoo_gridpath.algorithms.spea2 import ArraySPEA2Survival
from pymoo_gridpath.objectives import Objective

ALL = ("length", "vulnerability", "turn")
#: What survivals leave behind: on themselves, and on individuals.
STATE, VALUES = ("V", "gamma", "nadir", "ideal"), ("SPEA_F", "SPEA_D", "crowding", "apd", "theta")


class Constant(Objective):
    """The same for all paths, and a number that binary fractions do not hold."""

    name, label = "constant", "Constant"

    def __call__(self, paths, prepared):
        return np.full(len(paths), 0.3)


class Mud(Objective):
    """Dear cells in the middle of the map, so that there is something to trade."""

    name, label = "mud", "Mud"

    def field(self, grid):
        cost = np.zeros(grid.shape)
        cost[1:-1, 1:-1] = 1.5
        return cost


def empty(width, height, goal, objectives, obstacles="penalty", representation="integer"):
    grid = OccupancyGrid(np.zeros((height, width)))
    return GridPathProblem(grid, (0, 0), goal, representation, objectives, obstacles)


#: Width, height, goal and objectives.
PROBLEMS = {
    "one point of two": (3, 3, (2, 1), ("vulnerability", "turn")),
    "one point of three": (5, 5, (4, 4), ALL),
    "all equal": (6, 6, (5, 2), (Constant(), "vulnerability")),
    "one constant of three": (6, 6, (5, 5), ("length", Mud(), "vulnerability")),
    "one path": (4, 1, (3, 0), ("length", "turn")),
    "two columns": (2, 5, (1, 4), ("length", "vulnerability")),
}


def arguments_of(row, n_obj):
    return {"ref_points": [[5.0, 1.0, 90.0][:n_obj]]} if row.needs == "ref_points" else {}


def suits(row, problem):
    installed = not row.extra or importlib.util.find_spec(_PACKAGES.get(row.extra, row.extra))
    # A decision maker is asked about pairs, which a front of one point does not have.
    able = not row.unfit and row.takes(problem.n_obj) and (row.constraints or not problem.has_constraints())
    return installed and able and row.needs != "automated_dm"


def not_numbers(algorithm):
    """Return the names of what is not a number in the state of a survival and the values of the survivors."""
    found = []
    for key in STATE:
        value = getattr(getattr(algorithm, "survival", None), key, None)
        if isinstance(value, np.ndarray) and np.isnan(value).any():
            found.append(key)
    for key in VALUES:
        # The infeasible have none.
        values = [value for value in algorithm.pop.get(key) if value is not None]
        if np.isnan(np.array(values, dtype=float)).any():
            found.append(key)
    return found


@pytest.mark.parametrize("obstacles", ["penalty", "constraint"])
@pytest.mark.parametrize("kind", PROBLEMS)
@pytest.mark.parametrize("name", [name for name, row in CAPABILITIES.items() if not row.unfit])
def test_every_algorithm_on_flat_problems(name, kind, obstacles):
    row = CAPABILITIES[name]
    problem = empty(*PROBLEMS[kind], obstacles)
    if not suits(row, problem):
        pytest.skip(f"{name} is not for this problem, or not here")
    algorithm = make_algorithm(name, problem, 12, **arguments_of(row, problem.n_obj))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = minimize(problem, algorithm, ("n_gen", 4), seed=1)
    assert result.F is not None and np.isfinite(result.F).all()
    assert not_numbers(result.algorithm) == []


FINDERS = [(name, seed) for name in ("NSGA2", "SPEA2", "AGEMOEA", "AGEMOEA2") for seed in range(3)]


# RVEA finds it from some seeds only, with the constant objective or without.
@pytest.mark.parametrize(("name", "seed"), [*FINDERS, ("RVEA", 0), ("RVEA", 2)])
def test_the_single_point_of_a_front_is_found(name, seed):
    """The diagonal is the shortest path, the safest, and turns nowhere."""
    problem = empty(12, 12, (11, 11), ALL)
    if not suits(CAPABILITIES[name], problem):
        pytest.skip(f"{name} needs a package that is not installed")
    result = minimize(problem, make_algorithm(name, problem, 100), ("n_eval", 4000), seed=seed)
    F = result.algorithm.pop.get("F")
    assert (np.abs(F - [11 * math.sqrt(2), 0.0, 0.0]) < 1e-9).all(axis=1).any()


def population(F, turn=0):
    return Population.new("F", np.array(F, float), "turn", np.full(len(F), turn), "name", np.arange(len(F)))


class Unconstrained:
    n_obj = 3

    @staticmethod
    def has_constraints():
        return False


@pytest.mark.parametrize("survival", [ArraySPEA2Survival, StrengthAndSmoothness])
def test_spea2_does_not_count_what_is_constant(survival):
    """Survivors are those of the same points without the constant objective."""
    rng = np.random.default_rng(4)
    F = rng.integers(0, 30, (40, 2)).astype(float)
    F[:, 1] = 30 - F[:, 0] + rng.integers(0, 3, 40)
    flat = np.column_stack([F, np.full(40, 0.3)])
    plain, constant = (
        survival().do(Unconstrained, population(points), n_survive=12).get("name").tolist() for points in (F, flat)
    )
    assert sorted(constant) == sorted(plain)
    if survival is ArraySPEA2Survival:
        pop = population(flat)
        SPEA2Survival(normalize=True).do(Unconstrained, pop, n_survive=12)
        assert np.isnan(pop.get("SPEA_D").astype(float)).any(), "what the guard is for"


class FakeRun:
    """What RVEA's survival asks of an algorithm."""

    def __init__(self, n_gen, n_max_gen=20):
        self.n_gen = n_gen
        self.termination = type("Budget", (), {"n_max_gen": n_max_gen})


@pytest.mark.parametrize("n_obj", [2, 3])
@pytest.mark.parametrize("seed", range(20))
def test_rvea_survival_is_pymoos_where_no_range_is_empty(seed, n_obj):
    rng = np.random.default_rng(seed)
    directions = reference_directions(n_obj, 20)
    stock, ours = APDSurvival(directions, alpha=1.5), FiniteAPDSurvival(directions, alpha=1.5)
    problem = type("Problem", (Unconstrained,), {"n_obj": n_obj})
    for n_gen in range(2, 8):
        F = rng.random((40, n_obj)) * [3.0, 70.0, 400.0][:n_obj] + 5
        pops = [population(F), population(F)]
        kept = [
            survival.do(problem, pop, n_survive=20, algorithm=FakeRun(n_gen))
            for survival, pop in zip((stock, ours), pops, strict=True)
        ]
        assert kept[0].get("name").tolist() == kept[1].get("name").tolist()
        for key in ("theta", "apd", "niche", "opt"):
            assert kept[0].get(key).tolist() == kept[1].get(key).tolist()
            assert pops[0].get(key).tolist() == pops[1].get(key).tolist()
        assert [list(niche) for niche in stock.niches] == ours.niches
        stock.adapt()
        ours.adapt()
        assert np.array_equal(stock.V, ours.V) and np.array_equal(stock.gamma, ours.gamma)


def test_rvea_directions_stay_numbers_where_an_objective_is_constant():
    directions = reference_directions(3, 20)
    F = np.column_stack([np.random.default_rng(0).random((30, 2)), np.full(30, 0.3)])
    stock, ours = APDSurvival(directions), FiniteAPDSurvival(directions)
    for survival in (stock, ours):
        survival.do(Unconstrained, population(F), n_survive=20, algorithm=FakeRun(5))
        with np.errstate(invalid="ignore"):
            survival.adapt()
    assert np.isnan(stock.V).any() and np.isfinite(ours.V).all() and np.isfinite(ours.gamma).all()
    assert np.allclose(np.linalg.norm(ours.V, axis=1), 1.0)


def test_of_paths_on_their_direction_rvea_keeps_the_shortest():
    """The cosine of such an angle may round to a number above 1, whose angle pymoo takes for the least of all."""
    directions = reference_directions(3, 20)
    V = FiniteAPDSurvival(directions).V
    scales = np.linspace(3.0, 1.0, 21)
    for k in range(len(V)):
        if V[k].min() > 0:
            F = np.concatenate([np.zeros((1, 3)), scales[:, None] * V[k]])
            kept = FiniteAPDSurvival(directions).do(Unconstrained, population(F), n_survive=20, algorithm=FakeRun(10))
            # Beside the ideal point, which has no direction.
            assert 21 in kept.get("name").tolist()


def test_a_budget_of_the_first_population_alone():
    problem = empty(6, 6, (5, 5), ("length", Mud()))
    with np.errstate(divide="ignore"):
        result = minimize(problem, make_algorithm("RVEA", problem, 20), ("n_eval", 20), seed=1)
    assert not_numbers(result.algorithm) == []


@pytest.mark.parametrize("name", ["AGEMOEA", "AGEMOEA2"])
class TestAge:
    def survivals(self, name):
        pytest.importorskip("numba")
        from pymoo.algorithms.moo.age import AGEMOEASurvival
        from pymoo.algorithms.moo.age2 import AGEMOEA2Survival

        from pymoo_gridpath.algorithms.age import FiniteAGEMOEA2Survival, FiniteAGEMOEASurvival

        return {
            "AGEMOEA": (AGEMOEASurvival(), FiniteAGEMOEASurvival()),
            "AGEMOEA2": (AGEMOEA2Survival(), FiniteAGEMOEA2Survival()),
        }[name]

    def test_survivors_are_pymoos_where_no_range_is_empty(self, name):
        for seed in range(10):
            rng = np.random.default_rng(seed)
            F = rng.random((40, 3)) * [3.0, 70.0, 400.0] + 5
            pops = [survival.do(Unconstrained, population(F), n_survive=25) for survival in self.survivals(name)]
            for key in ("name", "rank", "crowding"):
                assert pops[0].get(key).tolist() == pops[1].get(key).tolist()

    def test_a_constant_objective_adds_nothing_to_distances(self, name):
        rng = np.random.default_rng(2)
        first = rng.random(30)
        F = np.column_stack([first, 1.0 - first**2, np.full(30, 10 * math.sqrt(2))])
        crowding, _, normalization = self.survivals(name)[1].survival_score(F.copy(), F.min(axis=0))
        assert not np.isnan(crowding).any() and (normalization > 0).all()
        other = F + np.array([0.0, 0.0, 1 / 3])
        again, *_ = self.survivals(name)[1].survival_score(other.copy(), other.min(axis=0))
        assert np.allclose(np.sort(crowding), np.sort(again), rtol=1e-6)

    @pytest.mark.parametrize("value", [0.0, 0.3, 10 * math.sqrt(2)])
    def test_a_front_of_one_point(self, name, value):
        survivors = self.survivals(name)[1].do(Unconstrained, population(np.full((20, 3), value)), n_survive=10)
        assert len(survivors) == 10 and not np.isnan(survivors.get("crowding").astype(float)).any()
