"""Algorithms of pymoo, of ours and of others pass the suite for algorithms, and it catches what is planted in one."""

from __future__ import annotations

import copy
import pickle
import warnings
from importlib.util import find_spec
from typing import ClassVar

import numpy as np
import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.algorithm import Algorithm
from pymoo.core.population import Population

from pymoo_gridpath.algorithms import SmoothMOEAD
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.operators import RandomSampling
from pymoo_gridpath.testing import AlgorithmSuite


class TestNSGA2(AlgorithmSuite):
    algorithm = "NSGA2"


class TestSPEA2(AlgorithmSuite):
    algorithm = "SPEA2"


class TestMOEAD(AlgorithmSuite):
    algorithm = SmoothMOEAD
    arguments: ClassVar = {"n_neighbors": 5}


class TestRVEA(AlgorithmSuite):
    algorithm = "RVEA"


class TestNSGA3(AlgorithmSuite):
    """It pickles not, and is another each time with constraints, as its row says."""

    algorithm = "NSGA3"


class TestCTAEA(AlgorithmSuite):
    """Needs a crossover that gives one child."""

    algorithm = "CTAEA"


class TestParallelMOEAD(AlgorithmSuite):
    """Takes no constraints."""

    algorithm = "ParallelMOEAD"


@pytest.mark.skipif(find_spec("numba") is None, reason="numba is not installed")
class TestAGEMOEA(AlgorithmSuite):
    """Of which make_algorithm changes a part after it is made."""

    algorithm = "AGEMOEA"


class TestGDE3(AlgorithmSuite):
    """Takes no crossover."""

    algorithm = "GDE3"


class Sound(NSGA2):
    """Of others, by the class."""


class TestSound(AlgorithmSuite):
    algorithm = Sound


class Walk(Algorithm):
    """From nothing: keeps what is no worse of itself and a mutated copy; has members of its own number."""

    def __init__(self, n_walkers=6, sampling=None, mutation=None, **kwargs):
        super().__init__(**kwargs)
        self.n_walkers, self.sampling, self.mutation = n_walkers, sampling or RandomSampling(), mutation

    def _initialize_infill(self):
        return self.sampling(self.problem, self.n_walkers, random_state=self.random_state)

    def _initialize_advance(self, infills=None, **kwargs):
        self.pop = infills

    def _infill(self):
        copies = Population.new("X", self.pop.get("X").copy())
        return self.mutation(self.problem, copies, random_state=self.random_state)

    def _advance(self, infills=None, **kwargs):
        was, now = (pop.get("F").sum(axis=1) + 1e6 * pop.get("CV")[:, 0] for pop in (self.pop, infills))
        self.pop = Population.create(*np.where(now <= was, infills, self.pop))


class TestWalk(AlgorithmSuite):
    algorithm = Walk
    arguments: ClassVar = {"n_walkers": 9}


# -- planted faults -----------------------------------------------------------------------------------------------------------


class Global(Sound):
    def _infill(self):
        np.random.random()  # noqa: NPY002
        return super()._infill()


class Unseeded(Sound):
    def _advance(self, infills=None, **kwargs):
        super()._advance(infills=infills, **kwargs)
        self.pop = self.pop[np.random.default_rng().permutation(len(self.pop))]


class Seedless(Sound):
    def _setup(self, problem, **kwargs):
        super()._setup(problem, **kwargs)
        self.random_state = np.random.default_rng(4)


class Remembering(Sound):
    runs: ClassVar[list] = []

    def _setup(self, problem, **kwargs):
        super()._setup(problem, **kwargs)
        self.runs.append(1)
        self.random_state.random(len(self.runs))


class Endless(Sound):
    def has_next(self):
        return True


class Uncounted(Sound):
    def _advance(self, infills=None, **kwargs):
        self.problem.evaluate(infills.get("X"))
        super()._advance(infills=infills, **kwargs)


class Stale(Sound):
    def _advance(self, infills=None, **kwargs):
        super()._advance(infills=infills, **kwargs)
        self.pop[0].F = self.pop[0].F - 1.0


class Fractions(Sound):
    def _infill(self):
        off = super()._infill()
        off.set("X", np.clip(off.get("X") + 0.5, self.problem.xl, self.problem.xu))
        return off


class Flying(Sound):
    """Sets genes past all operators."""

    def _infill(self):
        off = super()._infill()
        off.set("X", self.random_state.integers(self.problem.xl, self.problem.xu + 1, size=off.get("X").shape))
        return off


class Deaf(Sound):
    def __init__(self, pop_size=100, crossover=None, **kwargs):
        super().__init__(pop_size=pop_size, **kwargs)


class Overfull(Sound):
    def __init__(self, pop_size=100, **kwargs):
        super().__init__(pop_size=2 * pop_size, **kwargs)


class Unpicklable(Sound):
    def _setup(self, problem, **kwargs):
        super()._setup(problem, **kwargs)
        self.kept = lambda: 0


class Shared(Sound):
    """Copies that go on with the generator of what they were copied from."""

    def __deepcopy__(self, memo):
        memo[id(self.random_state)] = self.random_state
        made = type(self).__new__(type(self))
        made.__dict__ = {key: copy.deepcopy(value, memo) for key, value in vars(self).items()}
        return made


class Fragile(Sound):
    def _advance(self, infills=None, **kwargs):
        F = infills.get("F")
        (F - F.min(axis=0)) / np.ptp(F, axis=0)
        super()._advance(infills=infills, **kwargs)


class Forgetful(Sound):
    """Keeps the longest paths only."""

    def _advance(self, infills=None, **kwargs):
        super()._advance(infills=infills, **kwargs)
        self.pop = self.pop[np.argsort(-self.pop.get("F")[:, 0])[:5]]


class Hopeful(Sound):
    def __init__(self, pop_size=100, **kwargs):
        super().__init__(pop_size=pop_size, return_least_infeasible=True, **kwargs)


def pickled(algorithm):
    return pickle.loads(pickle.dumps(algorithm))


FAULTS = {
    Global: lambda suite: suite.test_nothing_is_drawn_from_global_generators(),
    Unseeded: lambda suite: suite.test_the_same_seed_gives_the_same_bits(),
    Seedless: lambda suite: suite.test_the_same_seed_gives_the_same_bits(),
    Remembering: lambda suite: suite.test_the_same_seed_gives_the_same_bits(),
    Endless: lambda suite: suite.test_generations_end_a_run(),
    Uncounted: lambda suite: suite.test_evaluations_are_counted_and_end_a_run(),
    Stale: lambda suite: suite.test_genes_and_objectives_are_those_of_the_problem("integer", "penalty"),
    Fractions: lambda suite: suite.test_genes_and_objectives_are_those_of_the_problem("integer", "penalty"),
    Flying: lambda suite: suite.test_paths_are_legal_where_operators_see_to_it("cells"),
    Deaf: lambda suite: suite.test_operators_are_called_where_it_takes_them(),
    Overfull: lambda suite: suite.test_it_has_no_more_members_than_it_is_told(),
    Unpicklable: lambda suite: suite.test_what_has_begun_is_copied_and_goes_on_alike(pickled),
    Shared: lambda suite: suite.test_what_has_begun_is_copied_and_goes_on_alike(copy.deepcopy),
    Fragile: lambda suite: suite.test_a_constant_objective_is_no_trouble("integer"),
    Forgetful: lambda suite: suite.test_a_constant_objective_is_no_trouble("cells"),
    Hopeful: lambda suite: suite.test_a_problem_without_a_legal_path_has_no_front(),
}


@pytest.mark.parametrize("algorithm", FAULTS)
def test_planted_faults_are_caught(algorithm):
    sound, faulty = (type("Suite", (AlgorithmSuite,), {"algorithm": cls})() for cls in (Sound, algorithm))
    FAULTS[algorithm](sound)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with pytest.raises((AssertionError, AttributeError, GridPathError, RuntimeWarning)):
            FAULTS[algorithm](faulty)
