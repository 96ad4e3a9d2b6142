"""Swarms that shorten a road: never longer than it, the optimum of small ones, seeds, and evaluations that are counted."""

from __future__ import annotations

import copy
import logging
import pickle
import random
import subprocess
import sys

import numpy as np
import pytest
from pymoo.algorithms.soo.nonconvex.pso import PSO
from pymoo.core.problem import Problem
from pymoo.optimize import minimize
from pymoo.problems.multi import ZDT1
from pymoo.problems.single import G1, Sphere

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import AntColony, BeeColony
from pymoo_gridpath.errors import CapabilityError, GridPathError
from pymoo_gridpath.problems import ShorteningProblem
from pymoo_gridpath.testing.enumeration import random_query
from pymoo_gridpath.testing.global_state import global_state
from pymoo_gridpath.testing.reference import is_legal, walk

RIVALS = [PSO, AntColony, BeeColony]


@pytest.fixture(params=RIVALS, ids=lambda rival: rival.__name__)
def rival(request):
    """A maker of one of the rivals."""
    if request.param is BeeColony:
        pytest.importorskip("niapy", reason="the bee colony needs NiaPy, the extra swarm, which wants numpy 2.3.5 or newer")
    return lambda: request.param(pop_size=20)


class Counting(ShorteningProblem):
    """Counts the rows that it rates."""

    n_rows = 0

    def _evaluate(self, x, out, *args, **kwargs):
        self.n_rows += len(x)
        super()._evaluate(x, out, *args, **kwargs)


def problem_of(seed, n_points, least, most, radius=0.0, kind=Counting):
    """A problem whose road makes a detour by a random cell."""
    rng = np.random.default_rng(seed)
    while True:
        grid, start, goal = random_query(rng, least, most, 0.4)
        free = np.argwhere(~grid.occupied)
        y, x = free[rng.integers(len(free))].tolist()
        parts = walk(grid, start, (x, y), rng), walk(grid, (x, y), goal, rng)
        if all(parts) and len(parts[0]) + len(parts[1]) - 3 >= n_points:
            return kind(grid, parts[0] + parts[1][1:], radius, n_points)


def digest(algorithm):
    return algorithm.pop.get("X").tobytes() + algorithm.pop.get("F").tobytes() + algorithm.opt.get("X").tobytes()


def test_the_optimum_of_small_problems_is_found(rival):
    found = tried = 0
    for seed in range(12):
        problem = problem_of(seed, 3, 4, 8)
        cells = problem.moves.cells(problem.road)
        best = ShorteningProblem(problem.grid, cells, 0, max(len(cells) - 2, 1)).pareto_front()[0, 0]
        # Where so few genes are too few, the best follows the road out of sight, which ants do at the end alone.
        if best < problem.pareto_front()[0, 0] - 1e-9 or best > problem.travelled[-1] - 1e-9:
            continue
        tried += 1
        found += minimize(problem, rival(), ("n_gen", 40), seed=seed).F[0] <= best + 1e-9
    # A swarm that has drawn together stays where it is.
    assert tried >= 8 and found >= (tried if not isinstance(rival(), PSO) else 0.75 * tried)


def test_no_result_is_longer_than_its_road_or_illegal(rival):
    for seed in range(4):
        problem = problem_of(seed, 8, 20, 30, radius=float(seed % 2))
        result = minimize(problem, rival(), ("n_gen", 15), seed=seed, save_history=True)
        best = [step.opt[0].F[0] for step in result.history]
        assert best == sorted(best, reverse=True), "the best is lost"
        assert problem.pareto_front()[0, 0] - 1e-9 <= result.F[0] <= problem.travelled[-1] + 1e-9
        assert result.F[0] < problem.travelled[-1] or problem.pareto_front()[0, 0] == problem.travelled[-1]
        road = problem.moves.cells(problem.road).tolist()
        for x in [result.X, *result.pop.get("X")]:
            cells = [tuple(cell) for cell in problem.cells(x).tolist()]
            assert is_legal(cells, problem.grid, road[0], road[-1])
        X, F = result.pop.get("X", "F")
        assert np.array_equal(problem.evaluate(X), F) and X.dtype == float and X.min() >= 0 and X.max() <= 1


def test_evaluations_are_counted_and_end_a_run(rival):
    problem = problem_of(1, 6, 20, 30)
    result = minimize(problem, rival(), ("n_eval", 200), seed=1)
    n_eval = result.algorithm.evaluator.n_eval
    # Whole iterations; bees leave sources for others now and then, which are evaluated besides.
    assert n_eval == problem.n_rows and 200 <= n_eval < 240
    assert result.pop.get("F").shape[0] <= 20


def test_the_same_seed_gives_the_same_bits_and_nothing_global_is_drawn(rival):
    problem = problem_of(2, 6, 20, 30)
    before = global_state(), random.getstate()
    first, other, again = (digest(minimize(problem, rival(), ("n_gen", 6), seed=s).algorithm) for s in (1, 2, 1))
    assert first == again != other
    assert (global_state(), random.getstate()) == before


@pytest.mark.parametrize(
    "how", [copy.deepcopy, lambda algorithm: pickle.loads(pickle.dumps(algorithm))], ids=["copy", "pickle"]
)
def test_what_has_begun_is_copied_and_goes_on_alike(rival, how):
    algorithm = rival()
    algorithm.setup(problem_of(3, 6, 20, 30), termination=("n_gen", 6), seed=1)
    for _ in range(3):
        algorithm.next()
    twin = how(algorithm)
    for one in (algorithm, twin):
        one.run()
    assert twin.pop is not algorithm.pop and digest(twin) == digest(algorithm)
    assert twin.evaluator.n_eval == algorithm.evaluator.n_eval


def test_asked_and_told_it_does_the_same(rival):
    problem = problem_of(4, 6, 20, 30)
    algorithm = rival()
    algorithm.setup(problem, termination=("n_gen", 5), seed=1)
    while algorithm.has_next():
        infills = algorithm.ask()
        algorithm.evaluator.eval(problem, infills)
        algorithm.tell(infills)
    assert digest(algorithm) == digest(minimize(problem, rival(), ("n_gen", 5), seed=1).algorithm)


def test_one_step_is_all_there_is(rival):
    problem = ShorteningProblem(OccupancyGrid(np.zeros((1, 2))), [(0, 0), (1, 0)], n_points=1)
    assert minimize(problem, rival(), ("n_gen", 3), seed=1).F.tolist() == [1.0]


# -- ants -------------------------------------------------------------------------------------------------------------


def test_pheromone_stays_within_its_bounds_and_gathers_on_the_best():
    problem = problem_of(5, 4, 20, 30)
    ants = minimize(problem, AntColony(evaporation=0.5), ("n_gen", 60), seed=1).algorithm
    pheromone = ants._pheromone
    assert pheromone.min() == 1e-3 and 0.99 < pheromone.max() <= 1.0
    (places,) = problem.decode(ants.opt[0].X[None])
    assert (pheromone[places[:-1], places[1:]] > 1e-3).all()
    # All it takes, none beside it.
    assert minimize(problem, AntColony(evaporation=1.0, beta=0.0), ("n_gen", 3), seed=1).F[0] > 0
    assert minimize(problem, AntColony(beta=1e6), ("n_gen", 3), seed=1).F[0] > 0


def test_ants_walk_along_edges_until_their_genes_are_used_up():
    problem = problem_of(6, 5, 20, 30)
    algorithm = AntColony(pop_size=200, beta=0.0)
    algorithm.setup(problem, seed=1)
    places = problem.decode(algorithm.ask().get("X"))
    steps = np.diff(places, axis=1)
    begin, end = places[:, :-1], places[:, 1:]
    assert (
        (problem.sight[begin, end] | (steps == 0))[:, :-1].all() and (steps == 0).any() and len(np.unique(places, axis=0)) > 50
    )


# -- bees -------------------------------------------------------------------------------------------------------------


@pytest.fixture
def _niapy():
    pytest.importorskip("niapy", reason="the bee colony needs NiaPy, the extra swarm, which wants numpy 2.3.5 or newer")


@pytest.mark.usefixtures("_niapy")
def test_bees_solve_other_problems_of_real_variables():
    result = minimize(Sphere(n_var=5), BeeColony(limit=20), ("n_gen", 150), seed=1)
    assert result.F[0] < 1e-4 and len(result.pop) == 12


@pytest.mark.usefixtures("_niapy")
def test_bees_are_those_of_niapy():
    """Its own run, from the same generator, tries the same sources in the same order."""
    from niapy.algorithms.basic import ArtificialBeeColonyAlgorithm
    from niapy.problems import Problem as NiaPyProblem
    from niapy.task import Task

    problem, tried = problem_of(7, 5, 20, 30), []

    class Own(NiaPyProblem):
        def _evaluate(self, x):
            tried.append(x.copy())
            return float(problem.evaluate(x)[0])

    class Kept(Counting):
        def _evaluate(self, x, out, *args, **kwargs):
            seen.extend(x.copy())
            super()._evaluate(x, out, *args, **kwargs)

    task = Task(Own(5, np.zeros(5), np.ones(5)), max_iters=30)
    x, value = ArtificialBeeColonyAlgorithm(population_size=10, limit=3, seed=np.random.default_rng(11)).run(task)
    seen: list[np.ndarray] = []
    result = minimize(problem_of(7, 5, 20, 30, kind=Kept), BeeColony(10, 3), ("n_gen", 31), seed=11)
    assert np.array_equal(seen, tried) and len(tried) > 310, "no source was left"
    assert result.F[0] == value and np.array_equal(result.X, x)


@pytest.mark.usefixtures("_niapy")
def test_importing_niapy_leaves_logging_as_it_was():
    code = (
        "import logging\n"
        "from pymoo.optimize import minimize\nfrom pymoo.problems.single import Sphere\n"
        "from pymoo_gridpath.algorithms import BeeColony\n"
        "logging.getLogger('before').handlers.append(logging.NullHandler())\n"
        "minimize(Sphere(), BeeColony(), ('n_gen', 2), seed=1)\n"
        "assert 'niapy' in __import__('sys').modules and logging.getLogger().handlers == []\n"
        "logging.getLogger('mine').info('unheard')\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "unheard" not in done.stderr
    before = logging.getLogger().handlers[:]
    minimize(Sphere(), BeeColony(), ("n_gen", 2), seed=1)
    assert logging.getLogger().handlers == before


@pytest.mark.usefixtures("_niapy")
@pytest.mark.parametrize("value", [np.inf, np.nan, -1.0])
def test_objectives_that_onlookers_cannot_choose_by_are_refused(value):
    class Odd(Problem):
        def _evaluate(self, x, out, *args, **kwargs):
            out["F"] = np.full((len(x), 1), value)

    with pytest.raises(GridPathError, match=f"the objective of a bee is {value:g}, expected a finite number, zero or more"):
        minimize(Odd(n_var=2, n_obj=1, xl=0, xu=1), BeeColony(), ("n_gen", 2), seed=1)


def test_niapy_is_asked_for_when_a_run_begins(monkeypatch):
    monkeypatch.setitem(sys.modules, "niapy.algorithms.basic", None)
    monkeypatch.setitem(sys.modules, "niapy", None)
    algorithm = BeeColony()
    with pytest.raises(CapabilityError, match=r"BeeColony needs the package NiaPy, .* pip install 'pymoo_gridpath\[swarm\]'"):
        minimize(problem_of(1, 2, 5, 8), algorithm, ("n_gen", 2))


# -- what is refused --------------------------------------------------------------------------------------------------


GRID_PROBLEM = GridPathProblem(OccupancyGrid(np.zeros((5, 5))), (0, 0), (4, 4), "integer", ["length"])


@pytest.mark.parametrize("problem", [GRID_PROBLEM, ZDT1(), G1(), Problem(n_var=2, n_obj=1)])
def test_bees_refuse_what_they_cannot_search(problem):
    with pytest.raises(
        CapabilityError, match="BeeColony is for one objective of real variables with bounds and no constraints"
    ):
        minimize(problem, BeeColony(), ("n_gen", 2))


def test_ants_refuse_what_has_no_road():
    with pytest.raises(CapabilityError, match="AntColony walks on the road of a ShorteningProblem, the problem is an object"):
        minimize(GRID_PROBLEM, AntColony(), ("n_gen", 2))


@pytest.mark.parametrize(
    ("cls", "given", "said"),
    [
        (AntColony, {"pop_size": 0}, "pop_size is 0, expected a whole number of at least 1"),
        (AntColony, {"evaporation": 0}, "evaporation is 0, expected a number above 0 and at most 1"),
        (AntColony, {"evaporation": 1.5}, "evaporation is 1.5, expected a number above 0"),
        (AntColony, {"beta": -1}, "beta is -1, expected a number, zero or more"),
        (AntColony, {"betas": 1}, "AntColony takes no argument 'betas'; did you mean 'beta'"),
        (BeeColony, {"pop_size": 3}, "pop_size is 3, expected a whole number of at least 4"),
        (BeeColony, {"limit": 0}, "limit is 0, expected a whole number of at least 1"),
        (BeeColony, {"limits": 5}, "BeeColony takes no argument 'limits'; did you mean 'limit'"),
    ],
)
def test_wrong_arguments_are_refused(cls, given, said):
    with pytest.raises(GridPathError, match=said):
        cls(**given)
