"""Algorithms of others, known by name."""

from __future__ import annotations

import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.optimize import minimize

from pymoo_gridpath.algorithms import ALGORITHMS, Capability, find_algorithm, make_algorithm
from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.registry import register


@pytest.fixture(autouse=True)
def forget(monkeypatch):
    monkeypatch.setattr(ALGORITHMS, "_known", dict(ALGORITHMS._known))
    monkeypatch.setattr(ALGORITHMS, "_names", dict(ALGORITHMS._names))


def test_a_registered_algorithm_works_by_name(make_problem):
    @register
    class MySearch(NSGA2):
        pass

    row = find_algorithm("my-search")
    assert (row.takes_operators, row.takes_pop_size, row.deterministic, row.needs) == (True, True, False, "")
    problem = make_problem()
    algorithm = make_algorithm("my search", problem, 10)
    assert type(algorithm) is MySearch
    assert len(minimize(problem, algorithm, ("n_gen", 2), seed=1).pop) == 10
    with pytest.raises(CapabilityError, match="did you mean 'MySearch'"):
        make_algorithm("MySerch", problem)
    with pytest.raises(CapabilityError, match="MySearch takes no argument 'speed'"):
        make_algorithm("MySearch", problem, speed=3)


def test_what_it_says_itself_counts(make_problem):
    @register
    class Unconstrained(NSGA2):
        capability = Capability("any", "any", constraints=False)

    with pytest.raises(CapabilityError, match="Unconstrained cannot solve problems with constraints"):
        make_algorithm("unconstrained", make_problem(2, "constraint"))


def test_names_of_pymoo_are_taken(make_problem):
    register(type("NSGA2", (NSGA2,), {}))
    with pytest.raises(CapabilityError, match="two algorithms are called 'nsga2'"):
        make_algorithm("nsga2", make_problem())
