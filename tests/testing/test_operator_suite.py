"""Our own operators pass the suite for operators, and the suite catches what is planted in one."""

from __future__ import annotations

import numpy as np
import pytest

from pymoo_gridpath.operators import (
    BitwiseMutation,
    CellMutation,
    DiscretePolynomialMutation,
    DiscreteSBX,
    GreedySampling,
    PathMutation,
    RandomSampling,
    ReachableSampling,
    SharedCellCrossover,
    SpliceCrossover,
    TwoPointCrossover,
)
from pymoo_gridpath.testing import OperatorSuite


class TestDiscreteSBX(OperatorSuite):
    def make(self):
        return DiscreteSBX()


class TestDiscretePolynomialMutation(OperatorSuite):
    def make(self):
        return DiscretePolynomialMutation()


class TestTwoPointCrossover(OperatorSuite):
    representation = "binary"

    def make(self):
        return TwoPointCrossover()


class TestBitwiseMutation(OperatorSuite):
    representation = "binary"

    def make(self):
        return BitwiseMutation()


class TestSpliceCrossover(OperatorSuite):
    representation = "cells"

    def make(self):
        return SpliceCrossover()


class TestPathMutation(OperatorSuite):
    representation = "cells"

    def make(self):
        return PathMutation()


class TestRandomSampling(OperatorSuite):
    def make(self):
        return RandomSampling()


class TestReachableSampling(OperatorSuite):
    def make(self):
        return ReachableSampling()


class TestGreedySampling(OperatorSuite):
    representation = "cells"

    def make(self):
        return GreedySampling()


class TestSharedCellCrossover(OperatorSuite):
    representation = "cells"

    def make(self):
        return SharedCellCrossover()


class TestCellMutation(OperatorSuite):
    representation = "cells"

    def make(self):
        return CellMutation(prob_var=0.3)


class TestCellMutationAnywhere(OperatorSuite):
    """Of which hardly any row is a path."""

    representation = "cells"

    def make(self):
        return CellMutation(prob_var=0.3, anywhere=True)


class Beyond(DiscretePolynomialMutation):
    def _do(self, problem, X, *args, **kwargs):
        return np.full_like(X, problem.xu.max() + 1)


class Fractions(DiscretePolynomialMutation):
    def _do(self, problem, X, *args, **kwargs):
        return np.clip(X + 0.5, problem.xl, problem.xu - 0.25)


class InPlace(DiscretePolynomialMutation):
    def _do(self, problem, X, *args, **kwargs):
        X[:] = problem.xl
        return X


class Unseeded(DiscretePolynomialMutation):
    def _do(self, problem, X, *args, random_state=None, **kwargs):
        return super()._do(problem, X, *args, random_state=np.random.default_rng(), **kwargs)


class Global(DiscretePolynomialMutation):
    def _do(self, problem, X, *args, **kwargs):
        np.random.random()  # noqa: NPY002
        return super()._do(problem, X, *args, **kwargs)


class FlaggedInVain(DiscretePolynomialMutation):
    arrays = True

    def do(self, problem, pop, *args, **kwargs):
        return pop.new("X", np.tile(problem.xl, (len(pop), 1)))


FAULTS = {
    Beyond: lambda suite: suite.test_rows_are_whole_numbers_within_the_bounds(0),
    Fractions: lambda suite: suite.test_rows_are_whole_numbers_within_the_bounds(0),
    InPlace: lambda suite: suite.test_input_is_not_changed(),
    Unseeded: lambda suite: suite.test_the_same_seed_gives_the_same(),
    Global: lambda suite: suite.test_nothing_is_drawn_from_numpys_global_generator(),
    FlaggedInVain: lambda suite: suite.test_the_array_hook_says_all_where_it_is_said_to(),
}


@pytest.mark.parametrize("operator", FAULTS)
def test_planted_faults_are_caught(operator):
    sound, faulty = (
        type("Suite", (OperatorSuite,), {"make": lambda self, cls=cls: cls(prob_var=0.5)})()
        for cls in (DiscretePolynomialMutation, operator)
    )
    FAULTS[operator](sound)
    with pytest.raises(AssertionError):
        FAULTS[operator](faulty)
