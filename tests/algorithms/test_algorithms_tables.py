"""Individuals in tables against pymoo's own population: what others see of them is the same, whatever was done before."""

from __future__ import annotations

import copy
import gc
import pickle
import weakref

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.callback import Callback
from pymoo.core.evaluator import Evaluator
from pymoo.core.individual import Individual
from pymoo.core.population import Population
from pymoo.optimize import minimize
from pymoo.util.archive import MultiObjectiveArchive

from pymoo_gridpath.algorithms import make_algorithm
from pymoo_gridpath.algorithms.evaluator import ArrayEvaluator
from pymoo_gridpath.operators import paper_operators
from pymoo_gridpath.operators.array_population import ArrayPopulation
from pymoo_gridpath.operators.individual_table import Table, TableIndividual
from pymoo_gridpath.operators.mating import ArrayMating
from pymoo_gridpath.operators.selection import CrowdingTournament
from pymoo_gridpath.operators.survival import ArrayRankAndCrowding
from pymoo_gridpath.problems.members import Members

KEYS = ("X", "F", "G", "H", "CV", "FEAS", "feas", "cv", "x", "f", "dF", "rank", "crowding", "mark", "word", "unknown", "pair")


class Pair:
    """A population in tables and one of pymoo's, to which the same is done."""

    def __init__(self, rng: np.random.Generator):
        self.rng = rng
        self.ours, self.stock = self.fresh(), self.fresh(stock=True)
        self.grow(), self.grow()

    def fresh(self, stock: bool = False):
        genes = np.arange(12).reshape(4, 3) % 5
        return Population.new("X", genes) if stock else ArrayPopulation.in_table(genes)

    def grow(self) -> None:
        """Add new ones; those of pymoo have to have the same genes."""
        more = self.rng.integers(0, 9, (int(self.rng.integers(1, 6)), 3))
        self.ours = Population.merge(self.ours, ArrayPopulation.in_table(more)).view(ArrayPopulation)
        self.stock = Population.merge(self.stock, Population.new("X", more))

    def some(self) -> np.ndarray:
        """Return a few places, some of them twice."""
        return self.rng.integers(0, len(self.ours), int(self.rng.integers(1, len(self.ours) + 1)))

    def set(self) -> None:
        places = self.some() if self.rng.random() < 0.5 else np.unique(self.some())
        n = len(places)
        key, values = [
            ("F", self.rng.random((n, 2))),
            ("G", self.rng.integers(-1, 2, (n, 1)).astype(float)),
            ("rank", self.rng.integers(0, 4, n)),
            ("crowding", self.rng.random(n)),
            ("word", "same for all"),
            ("mark", 3),
            ("mark", [int(value) for value in self.rng.integers(0, 9, n)]),
            ("pair", self.rng.random((n, 2))),
            ("CV", self.rng.random((n, 1))),
        ][int(self.rng.integers(9))]
        for pop in (self.ours, self.stock):
            pop[places].set(key, values)

    def touch(self) -> None:
        k = int(self.rng.integers(len(self.ours)))
        for pop in (self.ours, self.stock):
            one = pop[k]
            what = k % 5
            if what == 0:
                one.F = np.array([1.0, 2.0])
            elif what == 1:
                one.set("mark", 7)
            elif what == 2:
                one.X[0] += 1
            elif what == 3:
                one.data["word"] = "own"
            else:
                pop[k] = one.copy()

    def evaluate(self) -> None:
        places = np.unique(self.some())
        for pop in (self.ours, self.stock):
            (ArrayEvaluator if pop is self.ours else Evaluator)()._eval(Halves(), pop[places], ["F", "G", "H"])

    def choose(self) -> None:
        places = self.rng.permutation(len(self.ours))[: max(4, len(self.ours) // 2)]
        self.ours, self.stock = self.ours[places].settled(self.ours), self.stock[places]

    def copy(self) -> None:
        if self.rng.random() < 0.5:
            self.ours, self.stock = pickle.loads(pickle.dumps((self.ours, self.stock)))
        else:
            self.ours, self.stock = copy.deepcopy((self.ours, self.stock))
        self.ours = self.ours.view(ArrayPopulation)

    def is_same(self) -> None:
        order = self.rng.permutation(len(KEYS))
        for key in (KEYS[k] for k in order):
            try:
                expected = self.stock.get(key)
            except (ValueError, IndexError):
                # Of unequal lengths, which no array holds.
                continue
            found = self.ours.get(key)
            assert found.dtype == expected.dtype and np.array_equal(found, expected), key
            found[...] = 0


class Halves:
    """Two objectives and a constraint, without pymoo's checks of shapes."""

    def has_constraints(self):
        return True

    def evaluate(self, X, **kwargs):
        return {"F": X[:, :2] / 2.0, "G": X[:, 2:] - 3.0, "H": np.zeros((len(X), 0)), "mark": X.sum(axis=1)}


STEPS = st.sampled_from(["grow", "set", "set", "touch", "evaluate", "choose", "copy", "is_same"])


@given(st.integers(0, 2**32 - 1), st.lists(STEPS, min_size=3, max_size=12))
def test_whatever_is_done_to_them_others_see_what_pymoos_population_shows(seed, steps):
    pair = Pair(np.random.default_rng(seed))
    for step in steps:
        getattr(pair, step)()
    pair.is_same()
    for one, other in zip(pair.ours.tolist(), pair.stock.tolist(), strict=True):
        assert isinstance(one, Individual)
        assert one.evaluated == other.evaluated and one.config == other.config and one.data.keys() == other.data.keys()
        for key, value in other.data.items():
            assert type(one.data[key]) is type(value) and np.array_equal(one.data[key], value), key
        for key in ("X", "F", "G", "H", "CV", "dF"):
            assert np.array_equal(getattr(one, key), getattr(other, key)), key


def test_one_that_is_asked_is_the_same_one_and_ordinary():
    pop = ArrayPopulation.in_table(np.arange(6).reshape(3, 2))
    one = pop[1]
    assert type(one) is TableIndividual and not hasattr(one, "nothing") and type(one) is not TableIndividual
    assert vars(one).keys() == {"_X", "evaluated", "data", "config"} and one is pop[1] and {one: 1}[pop[1]] == 1
    one.X[0] = 9
    assert pop.get("X").tolist() == [[0, 1], [9, 3], [4, 5]] and type(pop[2]) is TableIndividual
    shallow = copy.copy(pop[2])
    shallow.X[0] = 8
    assert pop[2].X[0] == 8
    del pop[0].evaluated
    assert type(pop[0]) is not TableIndividual


class Touching(Callback):
    """Reads and writes a few individuals, in ways of their own."""

    def notify(self, algorithm):
        one = algorithm.pop[algorithm.n_gen % len(algorithm.pop)]
        assert one.F is one.F and vars(one)["_X"] is one.X
        one.data["seen"] = algorithm.n_gen
        algorithm.off[0].mark = algorithm.n_gen
        self.data.setdefault("opt", []).append(algorithm.opt)


@pytest.mark.parametrize("obstacles", ["penalty", "constraint"])
def test_runs_are_pymoos_whoever_looks_on(obstacles, make_problem, capsys):
    problem, found = make_problem(2, obstacles), []
    for own in (True, False):
        operators = paper_operators(problem)
        given = {"selection": CrowdingTournament(), "survival": ArrayRankAndCrowding(), "evaluator": ArrayEvaluator()}
        kind = ArrayMating if own else OrdinaryMating
        given["mating"] = kind(given["selection"], *(operators[key] for key in ("crossover", "mutation", "repair")))
        archive = MultiObjectiveArchive()
        algorithm = NSGA2(pop_size=20, archive=archive, callback=Touching(), **given, **operators)
        found.append(minimize(problem, algorithm, ("n_gen", 12), seed=3, save_history=True, verbose=True))
    first, second = found
    for key in ("X", "F", "CV", "rank", "crowding", "seen", "turn", "n_gen"):
        assert np.array_equal(first.pop.get(key), second.pop.get(key)), key
        assert np.array_equal(first.history[6].pop.get(key), second.history[6].pop.get(key)), key
    assert np.array_equal(first.archive.get("F"), second.archive.get("F"))
    opts = (result.algorithm.callback.data["opt"] for result in found)
    assert all(np.array_equal(one.get("X"), other.get("X")) for one, other in zip(*opts, strict=True))
    printed = capsys.readouterr().out.splitlines()
    assert printed[: len(printed) // 2] == printed[len(printed) // 2 :]


class OrdinaryMating(ArrayMating):
    """The same, with values in the individuals from the first."""

    def do(self, *args, **kwargs):
        return ArrayPopulation.of(super().do(*args, **kwargs).get("X"))


@pytest.mark.parametrize("name", ["NSGA2", "SPEA2"])
@pytest.mark.parametrize("obstacles", ["penalty", "constraint"])
def test_a_run_makes_no_individual_unless_somebody_asks(name, obstacles, make_problem, monkeypatch):
    made = []
    ordinary = TableIndividual.become_ordinary
    monkeypatch.setattr(TableIndividual, "become_ordinary", lambda one: made.append(one) or ordinary(one))
    problem = make_problem(2, obstacles)
    result = minimize(problem, make_algorithm(name, problem, 20), ("n_gen", 12), seed=1, callback=_Counting())
    assert result.algorithm.callback.data["n"] == [Members(result.algorithm).n_legal] and made == []
    assert result.opt[0].F.shape == (2,) and len(made) == 1


class _Counting(Callback):
    def notify(self, algorithm):
        self.data["n"] = [Members(algorithm).n_legal]


def test_who_keeps_an_individual_keeps_no_generation(make_problem):
    problem = make_problem(2, "penalty")
    algorithm = make_algorithm("NSGA2", problem, 20).setup(problem, termination=("n_gen", 40), seed=1)
    tables, kept = [], []
    while algorithm.has_next():
        algorithm.next()
        kept += algorithm.off.tolist()[:3] + algorithm.pop.tolist()[:3]
        tables += [weakref.ref(one._table) for one in kept if type(one) is TableIndividual]
    gc.collect()
    alive = {id(table) for table in (reference() for reference in tables) if isinstance(table, Table)}
    # Those of the last generation and of the one before.
    assert len({id(reference) for reference in tables}) > 20 and len(alive) <= 4
