"""What every crossover, mutation, repair and sampling must do on a path problem, as tests to inherit."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from pymoo.core.crossover import Crossover
from pymoo.core.mutation import Mutation
from pymoo.core.operator import Operator
from pymoo.core.population import Population
from pymoo.core.sampling import Sampling

from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.operators.mating import mates_on_arrays
from pymoo_gridpath.problems import GridPathProblem
from pymoo_gridpath.testing.elsewhere import elsewhere
from pymoo_gridpath.testing.global_state import global_state

N = 12


class OperatorSuite:
    """Tests of an operator; a class of tests derives from it and has `make`.

    Children have the right shape, whole numbers within the bounds, are the same for the same seed, in another process too, and
    leave their parents as they were.
    """

    #: The representation that it is for.
    representation = "integer"

    def make(self) -> Operator:
        """Return a new operator."""
        raise NotImplementedError("the suite needs a method make(self) that returns a new operator")

    def problem(self) -> Any:
        """Return a small problem."""
        return GridPathProblem(OccupancyGrid(np.zeros((8, 8)), corner_cutting=True), (0, 0), (7, 7), self.representation)

    def parents(self, problem: Any) -> np.ndarray:
        """Return N rows of genes that code paths."""
        rng = np.random.default_rng(5)
        X = rng.integers(problem.xl, problem.xu, size=(N, problem.n_var), endpoint=True)
        return problem.representation.repair(X.astype(problem.vtype), rng)

    def apply(self, operator: Any, problem: Any, X: np.ndarray, seed: int) -> np.ndarray:
        """Return the rows that an operator makes of rows, called as pymoo calls it."""
        rng: Any = np.random.default_rng(seed)
        pop: Any = Population.new("X", X)
        if isinstance(operator, Sampling):
            drawn: Any = operator(problem, N, random_state=rng)
            return drawn.get("X")
        if isinstance(operator, Crossover):
            pairs = np.arange(N).reshape(-1, operator.n_parents)
            crossed: Any = operator(problem, pop, pairs, random_state=rng)
            return crossed.get("X")
        changed: Any = operator(problem, pop, random_state=rng)
        return changed.get("X")

    @pytest.mark.parametrize("seed", range(3))
    def test_rows_are_whole_numbers_within_the_bounds(self, seed):
        problem, operator = self.problem(), self.make()
        X = self.apply(operator, problem, self.parents(problem), seed)
        n = N // operator.n_parents * operator.n_offsprings if isinstance(operator, Crossover) else N
        assert X.shape == (n, problem.n_var)
        assert np.array_equal(X, np.rint(X.astype(float)))
        assert (problem.xl <= X).all() and (problem.xu >= X).all()

    def test_input_is_not_changed(self):
        problem, operator = self.problem(), self.make()
        X = self.parents(problem)
        before = X.copy()
        arrays = X.reshape(operator.n_parents, -1, problem.n_var) if isinstance(operator, Crossover) else X
        if not isinstance(operator, Sampling):
            operator._do(problem, arrays, random_state=np.random.default_rng(1))
        assert np.array_equal(X, before)

    def test_the_same_seed_gives_the_same(self):
        problem = self.problem()
        X = self.parents(problem)
        first, second = (self.apply(self.make(), problem, X, 3) for _ in range(2))
        assert np.array_equal(first, second)

    def test_the_same_in_another_process(self):
        assert np.array_equal(elsewhere(self._made), self._made())

    def _made(self) -> np.ndarray:
        problem = self.problem()
        return self.apply(self.make(), problem, self.parents(problem), 3)

    def test_nothing_is_drawn_from_numpys_global_generator(self):
        problem = self.problem()
        before = global_state()
        self.apply(self.make(), problem, self.parents(problem), 1)
        assert global_state() == before

    def test_the_array_hook_says_all_where_it_is_said_to(self):
        operator: Any = self.make()
        if not isinstance(operator, Crossover | Mutation) or not mates_on_arrays(operator):
            return
        problem = self.problem()
        operator.__dict__["prob"] = 1.0
        X = self.parents(problem)
        arrays = X.reshape(-1, operator.n_parents, problem.n_var).swapaxes(0, 1) if isinstance(operator, Crossover) else X
        rng = np.random.default_rng(3)
        # pymoo draws who crosses before, and who mutates after.
        if isinstance(operator, Crossover):
            rng.random(arrays.shape[1])
        children: Any = operator._do(problem, arrays.copy(), random_state=rng)
        made = children.reshape(-1, problem.n_var)
        assert np.array_equal(made, self.apply(operator, problem, X, 3))

    def test_it_pickles(self):
        assert type(pickle.loads(pickle.dumps(self.make()))) is type(self.make())
