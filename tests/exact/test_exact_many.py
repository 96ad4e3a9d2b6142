"""Many fronts at once against one after another."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool

import numpy as np
import pytest

from pymoo_gridpath import GridPathProblem
from pymoo_gridpath.errors import CapabilityError, GridPathError
from pymoo_gridpath.exact import Budget, exact_front, exact_fronts
from pymoo_gridpath.objectives import Objective
from pymoo_gridpath.problems import random_dense_grid


@pytest.fixture(scope="module")
def problems():
    sizes = (12, 5, 9, 7)
    return [GridPathProblem(random_dense_grid(n, 0.1, n), (0, 0), (n - 1, n - 1), "cells") for n in sizes]


@pytest.mark.parametrize("kind", [None, ThreadPoolExecutor, ProcessPoolExecutor])
def test_fronts_are_those_of_single_searches_in_order(problems, kind):
    expected = [exact_front(problem) for problem in problems]
    if kind is None:
        found = exact_fronts(tuple(problems))
    else:
        with kind(2) as executor:
            found = exact_fronts(problems, executor=executor)
            # It is left open.
            assert executor.submit(max, 1, 2).result() == 2
    for one, other in zip(found, expected, strict=True):
        assert one.complete and np.array_equal(one.F, other.F) and np.array_equal(one.X, other.X)
        assert one.n_labels == other.n_labels


def test_each_may_be_as_far_from_its_front_as_is_asked(problems):
    with ThreadPoolExecutor(2) as executor:
        found = exact_fronts(problems, executor=executor, epsilon=0.5)
    expected = [exact_front(problem, epsilon=0.5) for problem in problems]
    for one, other in zip(found, expected, strict=True):
        assert np.array_equal(one.F, other.F) and one.certified == other.certified


def test_a_budget_is_of_each(problems):
    found = exact_fronts(problems, Budget(max_labels=1))
    assert [one.complete for one in found] == [exact_front(problem, Budget(max_labels=1)).complete for problem in problems]
    assert exact_fronts([]) == []


class Uncounted(Objective):
    """One of which no exact front is known."""

    name = "uncounted"

    def __call__(self, paths, prepared):
        return np.zeros(len(paths))


def test_the_first_error_is_raised_and_the_rest_cancelled(problems):
    problem = problems[1]
    unfit = GridPathProblem(problem.grid, problem.start, problem.goal, "cells", ["length", Uncounted()])
    with ThreadPoolExecutor(1) as executor, pytest.raises(CapabilityError):
        exact_fronts([unfit, *problems], executor=executor)
    with pytest.raises(GridPathError, match="path"):
        exact_fronts([problem, 3])
    with pytest.raises(GridPathError, match="executor is 2, expected an Executor"):
        exact_fronts(problems, executor=2)  # pyright: ignore
    with pytest.raises(GridPathError, match="problems is"):
        exact_fronts(problem)


def test_what_cannot_be_sent_and_a_pool_that_breaks_are_told(problems):
    watched = Budget(watch=lambda meter: False)
    with (
        ProcessPoolExecutor(1) as executor,
        pytest.raises(GridPathError, match="front of problem 0 could not be sent to another process"),
    ):
        exact_fronts(problems[:1], watched, executor)

    class Broken:
        def submit(self, function, *args):
            executor = ThreadPoolExecutor(1)
            with executor:
                return executor.submit(_break)

    with pytest.raises(GridPathError, match="front of problem 0 came to no end, since the executor broke down: a worker died"):
        exact_fronts(problems, executor=Broken())  # pyright: ignore


def _break():
    raise BrokenProcessPool("a worker died")
