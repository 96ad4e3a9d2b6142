"""The array-based generation against pymoo's own, individual by individual and draw by draw."""

from __future__ import annotations

import copy
import pickle
import types

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymoo.algorithms.moo.nsga2 import NSGA2, binary_tournament
from pymoo.algorithms.moo.spea2 import SPEA2, SPEA2Survival, spea_binary_tournament
from pymoo.core.callback import Callback
from pymoo.core.individual import Individual
from pymoo.core.population import Population
from pymoo.core.problem import ElementwiseProblem
from pymoo.core.repair import NoRepair
from pymoo.operators.sampling.rnd import IntegerRandomSampling
from pymoo.operators.survival.rank_and_crowding import RankAndCrowding
from pymoo.operators.survival.rank_and_crowding.metrics import calc_crowding_distance
from pymoo.optimize import minimize
from pymoo.util.nds.non_dominated_sorting import NonDominatedSorting

from pymoo_gridpath.algorithms import make_algorithm
from pymoo_gridpath.algorithms.evaluator import ArrayEvaluator
from pymoo_gridpath.algorithms.spea2 import ArraySPEA2Survival, FitnessTournament, by_fitness, truncate
from pymoo_gridpath.operators import ArrayMating, DiscretePolynomialMutation, DiscreteSBX, paper_operators
from pymoo_gridpath.operators.array_population import ArrayPopulation
from pymoo_gridpath.operators.selection import CrowdingTournament, by_dominance_and_crowding
from pymoo_gridpath.operators.survival import ArrayRankAndCrowding

CONSTRAINED = types.SimpleNamespace(has_constraints=lambda: True)
SEEDS = st.integers(0, 2**32 - 1)


def population(rng, n=40, n_obj=2, infeasible=0.0, levels=6):
    """Return individuals with many equal objectives and, some of them, violations."""
    pop = Population.new("X", np.arange(n)[:, None], "F", rng.integers(0, levels, (n, n_obj)).astype(float))
    violation = (rng.random(n) < infeasible) * rng.integers(1, 4, n)
    return pop.set("G", violation[:, None].astype(float), "H", np.zeros((n, 0)))


def names(pop):
    return pop.get("X")[:, 0].tolist()


@given(SEEDS)
def test_array_population_reads_and_writes_as_pymoos(seed):
    rng = np.random.default_rng(seed)
    pop = population(rng, infeasible=0.5)
    pop[:10].apply(lambda individual: individual.set("config", Individual.default_config() | {"cv_eps": 1.0}))
    pop[5:20].set("rank", rng.integers(0, 3, 15), "word", "same for all")
    fast = pop.view(ArrayPopulation)
    for key in ("X", "F", "G", "H", "CV", "FEAS", "feas", "dF", "rank", "word", "unknown", "evaluated", "x", "f", "cv"):
        expected, actual = Population.get(pop, key), fast.get(key)
        assert expected.dtype == actual.dtype and np.array_equal(expected, actual), key
    assert [a.tolist() for a in fast.get("X", "F")] == [pop.get("X").tolist(), pop.get("F").tolist()]
    pairs = rng.integers(0, 40, (5, 2))
    assert np.array_equal(fast[pairs].get("F"), pop[pairs].get("F"))
    values = {
        "F": rng.random((40, 3)),
        "new": rng.random((40, 2)),
        "number": rng.random(40),
        "word": "x",
        "H": np.zeros((40, 0)),
    }
    other = copy.deepcopy(pop)
    fast.set(**values)
    other.set(**values)
    for key in values:
        assert np.array_equal(fast.get(key), other.get(key))
    # No individual keeps the array of all alive.
    assert all(individual.F.base is None and individual.get("new").base is None for individual in fast)
    with pytest.raises(ValueError, match="3 values for a population of 40"):
        fast.set("F", np.zeros((3, 2)))


def test_new_individuals_are_ordinary_ones():
    genes = np.arange(6).reshape(3, 2)
    pop, stock = ArrayPopulation.of(genes), Population.new("X", genes)
    for one, other in zip(pop, stock, strict=True):
        assert isinstance(one, Individual)
        for key in vars(other):
            assert np.array_equal(getattr(one, key), getattr(other, key)), key
        assert vars(one.copy())["_X"].tolist() == one.X.tolist()
    pop[0].evaluated.add("F")
    pop[0].set("mark", 1)
    pop[0].F = np.ones(2)
    assert pop[1].evaluated == set() and pop[1].get("mark") is None and len(pop[1].F) == 0
    genes[:] = 0
    assert pop[2].X.tolist() == [4, 5]


@given(SEEDS, st.sampled_from([0.0, 0.4]), st.sampled_from(["comp_by_dom_and_crowding", "comp_by_rank_and_crowding"]))
def test_crowding_tournament_is_pymoos_draw_by_draw(seed, infeasible, tournament_type):
    rng = np.random.default_rng(seed)
    pop = population(rng, infeasible=infeasible)
    feasible = pop[pop.get("feas")]
    feasible.set("rank", rng.integers(0, 3, len(feasible)), "crowding", rng.choice([1.0, 2.0, np.inf], len(feasible)))
    P = rng.integers(0, len(pop), (100, 2))
    won = []
    for function in (binary_tournament, by_dominance_and_crowding):
        state = np.random.default_rng(seed)
        algorithm = types.SimpleNamespace(tournament_type=tournament_type, random_state=state)
        won.append((function(pop, P, algorithm=algorithm, random_state=state).tolist(), state.random()))
    assert won[0] == won[1]


@given(SEEDS, st.sampled_from([0.0, 0.4]))
def test_fitness_tournament_is_pymoos_draw_by_draw(seed, infeasible):
    rng = np.random.default_rng(seed)
    pop = population(rng, infeasible=infeasible)
    feasible = pop[pop.get("feas")]
    feasible.set("SPEA_F", rng.integers(0, 3, len(feasible)) / 2)
    P = rng.integers(0, len(pop), (100, 2))
    won = []
    for function in (spea_binary_tournament, by_fitness):
        state = np.random.default_rng(seed)
        won.append((function(pop, P, algorithm=None, random_state=state).tolist(), state.random()))
    assert won[0] == won[1]


def survive(survival, pop, seed, n_survive):
    state, pop = np.random.default_rng(seed), copy.deepcopy(pop)
    survivors = survival.do(CONSTRAINED, pop, n_survive=n_survive, random_state=state)
    return survivors, state.random()


@pytest.mark.filterwarnings("ignore:invalid value:RuntimeWarning", "ignore:divide by zero:RuntimeWarning")
@pytest.mark.parametrize("function", ["cd", "ce", "mnn", calc_crowding_distance])
@given(SEEDS, st.sampled_from([1, 2, 3]), st.sampled_from([0.0, 0.4, 1.0]), st.integers(1, 40))
def test_rank_and_crowding_is_pymoos_with_the_same_draws(function, seed, n_obj, infeasible, n_survive):
    pop = population(np.random.default_rng(seed), n_obj=n_obj, infeasible=infeasible)
    (stock, after), (fast, fast_after) = (
        survive(kind(crowding_func=function), pop, seed, n_survive) for kind in (RankAndCrowding, ArrayRankAndCrowding)
    )
    assert names(fast) == names(stock) and fast_after == after and isinstance(fast, ArrayPopulation)
    for key in ("rank", "crowding"):
        assert np.array_equal(fast.get(key), stock.get(key))


def test_a_sorting_that_ranks_all_fronts_leaves_no_more_survivors():
    class All(NonDominatedSorting):
        def do(self, F, n_stop_if_ranked=None, **kwargs):
            return super().do(F, **kwargs)

    pop = population(np.random.default_rng(0), levels=100)
    for n_survive in (1, 5, 17, 40):
        stock, fast = (
            names(survive(kind(nds=All()), pop, 0, n_survive)[0]) for kind in (RankAndCrowding, ArrayRankAndCrowding)
        )
        assert fast == stock and len(fast) == n_survive


@pytest.mark.filterwarnings("ignore:invalid value:RuntimeWarning", "ignore:divide by zero:RuntimeWarning")
@given(SEEDS, st.sampled_from([2, 3]), st.sampled_from([0.0, 0.4, 1.0]), st.integers(1, 40), st.booleans(), st.booleans())
def test_spea2_survival_is_pymoos(seed, n_obj, infeasible, n_survive, normalize, on_a_front):
    rng = np.random.default_rng(seed)
    pop = population(rng, n_obj=n_obj, infeasible=infeasible, levels=12)
    if on_a_front:
        F = pop.get("F")
        F[:, -1] = 30 - F[:, :-1].sum(axis=1)
        pop.set("F", F)
    (stock, _), (fast, _) = (
        survive(kind(normalize=normalize), pop, seed, n_survive) for kind in (SPEA2Survival, ArraySPEA2Survival)
    )
    assert names(fast) == names(stock)
    for key in ("SPEA_F", "SPEA_R", "SPEA_D"):
        assert np.array_equal(fast.get(key), stock.get(key))


@pytest.mark.parametrize("seed", range(30))
def test_truncation_by_distances_alone_matches_a_loop(seed):
    """SPEA2's definition: remove who has the smallest distances in lexicographic order, and look at all of them anew."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 30))
    points = rng.integers(0, 6, (n, 2)).astype(float)
    distances = np.sqrt(((points[:, None] - points) ** 2).sum(axis=2))
    np.fill_diagonal(distances, np.inf)
    n_survive, alive = int(rng.integers(1, n + 1)), list(range(n))
    while len(alive) > n_survive:
        alive.remove(min(alive, key=lambda i: (sorted(distances[i][j] for j in alive), i)))
    assert truncate(distances, n_survive).tolist() == alive


@pytest.mark.parametrize("obstacles", ["penalty", "constraint"])
@pytest.mark.parametrize(
    ("stock", "selection", "survival"),
    [(NSGA2, CrowdingTournament, ArrayRankAndCrowding), (SPEA2, FitnessTournament, ArraySPEA2Survival)],
)
@pytest.mark.parametrize("n_obj", [2, 3])
def test_whole_runs_are_pymoos(stock, selection, survival, n_obj, obstacles, make_problem):
    problem = make_problem(n_obj, obstacles)
    # All of pymoo's SPEA2 share one survival by default, which remembers what other runs have seen.
    own = {"survival": SPEA2Survival(normalize=True)} if stock is SPEA2 else {}
    first = minimize(problem, stock(pop_size=30, **own, **paper_operators(problem)), ("n_gen", 15), seed=3)
    fast = stock(
        pop_size=30, selection=selection(), survival=survival(), evaluator=ArrayEvaluator(), **paper_operators(problem)
    )
    second = minimize(problem, fast, ("n_gen", 15), seed=3)
    for key in ("X", "F", "CV"):
        assert np.array_equal(first.pop.get(key), second.pop.get(key))
        assert np.array_equal(first.opt.get(key), second.opt.get(key))
    assert first.algorithm.evaluator.n_eval == second.algorithm.evaluator.n_eval


@pytest.mark.parametrize("smoothness", [True, False])
@pytest.mark.parametrize("name", ["NSGA2", "SPEA2"])
@pytest.mark.parametrize("obstacles", ["penalty", "constraint"])
class TestOrdinaryAlgorithm:
    def make(self, name, smoothness, problem):
        return make_algorithm(name, problem, 20, smoothness=smoothness)

    def test_ask_and_tell_is_minimize(self, name, smoothness, obstacles, make_problem):
        problem = make_problem(2, obstacles)
        whole = minimize(problem, self.make(name, smoothness, problem), ("n_eval", 100), seed=2)
        algorithm = self.make(name, smoothness, problem).setup(problem, termination=("n_eval", 100), seed=2)
        while algorithm.has_next():
            children = algorithm.ask()
            algorithm.evaluator.eval(problem, children)
            algorithm.tell(infills=children)
        assert np.array_equal(algorithm.result().F, whole.F) and np.array_equal(algorithm.pop.get("X"), whole.pop.get("X"))
        assert algorithm.evaluator.n_eval == 100

    def test_a_pickled_or_copied_run_goes_on_as_it_would_have(self, name, smoothness, obstacles, make_problem):
        problem = make_problem(2, obstacles)
        algorithm = self.make(name, smoothness, problem).setup(problem, termination=("n_gen", 8), seed=2)
        for _ in range(4):
            algorithm.next()
        others = [pickle.loads(pickle.dumps(algorithm)), copy.deepcopy(algorithm)]
        expected = algorithm.run().pop.get("X")
        for other in others:
            assert np.array_equal(other.run().pop.get("X"), expected)

    def test_history_and_callbacks_see_each_generation(self, name, smoothness, obstacles, make_problem):
        class Watch(Callback):
            def notify(self, algorithm):
                pop, opt = algorithm.pop, algorithm.opt
                self.data.setdefault("seen", []).append((pop.get("F"), opt.get("F"), pop.get("n_gen")))

        problem = make_problem(2, obstacles)
        result = minimize(
            problem, self.make(name, smoothness, problem), ("n_gen", 5), seed=2, callback=Watch(), save_history=True
        )
        seen = result.algorithm.callback.data["seen"]
        assert len(seen) == len(result.history) == 5
        for k, (past, (F, opt, n_gen)) in enumerate(zip(result.history, seen, strict=True)):
            assert np.array_equal(past.pop.get("F"), F) and np.array_equal(past.opt.get("F"), opt)
            assert n_gen.max() <= k + 1
        assert np.array_equal(seen[-1][0], result.pop.get("F"))


class Knapsacks(ElementwiseProblem):
    """Whole numbers, two objectives, an inequality and an equality, evaluated one at a time."""

    def __init__(self, limit=12.0):
        super().__init__(n_var=5, n_obj=2, n_ieq_constr=2, n_eq_constr=1, xl=np.zeros(5), xu=np.full(5, 9), vtype=int)
        self.limit = limit

    def _evaluate(self, x, out, *args, **kwargs):
        out["F"] = [float(x.sum()), float(((x - 9) ** 2).sum())]
        out["G"] = [x[0] + x[1] - self.limit, 3.0 - x[2]]
        out["H"] = [x[3] - x[4]]
        out["note"] = int(x[0])


def knapsack_algorithm(**kwargs):
    mating = ArrayMating(CrowdingTournament(), DiscreteSBX(), DiscretePolynomialMutation(), NoRepair())
    survival = ArrayRankAndCrowding()
    return NSGA2(20, sampling=IntegerRandomSampling(), mating=mating, survival=survival, evaluator=ArrayEvaluator(), **kwargs)


def test_elementwise_problems_with_constraints():
    problem = Knapsacks()
    result = minimize(problem, knapsack_algorithm(), ("n_gen", 30), seed=1)
    pop = result.pop
    X, G, H = pop.get("X", "G", "H")
    violation = np.maximum(G, 0).sum(axis=1) + np.maximum(np.abs(H) - 1e-4, 0).sum(axis=1)
    assert pop.get("CV")[:, 0] == pytest.approx(violation)
    assert np.array_equal(pop.get("note"), X[:, 0])
    assert result.X is not None and (result.X[:, 3] == result.X[:, 4]).all() and (result.X[:, 2] >= 3).all()


def test_the_least_infeasible_is_returned_if_asked_for():
    problem = Knapsacks(limit=-1.0)  # never kept
    assert minimize(problem, knapsack_algorithm(), ("n_gen", 5), seed=1).X is None
    result = minimize(problem, knapsack_algorithm(), ("n_gen", 5), seed=1, return_least_infeasible=True)
    assert result.CV.min() == result.pop.get("CV").min() > 0


def test_evaluated_individuals_are_not_evaluated_again(make_problem):
    problem = make_problem()
    pop = ArrayPopulation.of(np.zeros((4, problem.n_var), dtype=int))
    evaluator = ArrayEvaluator()
    evaluator.eval(problem, pop[:1])
    evaluator.eval(problem, pop)
    evaluator.eval(problem, pop)
    assert evaluator.n_eval == 4
    assert pop.get("CV").tolist() == [[0.0]] * 4
    assert evaluator.eval(problem, pop[0]) is pop[0]


def test_attributes_that_a_callback_sets_are_read_back():
    pop = ArrayPopulation.of(np.arange(6).reshape(3, 2))
    pop[1].tag = 5
    assert pop.get("tag", to_numpy=False) == [None, 5, None]
    pop.set("tag", [1, 2, 3])
    assert pop.get("tag").tolist() == [1, 2, 3]
    assert pop[1].tag == 2
