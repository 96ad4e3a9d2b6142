"""Algorithms of others, known by name, or given as a class or an object."""

from __future__ import annotations

from importlib.metadata import EntryPoint

import numpy as np
import pytest
from pymoo.algorithms.moo.moead import MOEAD
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.optimize import minimize

from pymoo_gridpath.algorithms import ALGORITHMS, CAPABILITIES, Capability, SmoothMOEAD, find_algorithm, make_algorithm
from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.exact import exact_front
from pymoo_gridpath.operators import path_operators
from pymoo_gridpath.planners import ExactFront, Plan, Planner
from pymoo_gridpath.registry import register


@pytest.fixture(autouse=True)
def forget(monkeypatch):
    monkeypatch.setattr(ALGORITHMS, "_known", dict(ALGORITHMS._known))
    monkeypatch.setattr(ALGORITHMS, "_names", dict(ALGORITHMS._names))


def test_an_installed_package_that_is_broken_is_named_and_hinders_nobody(make_problem, monkeypatch):
    points = {"mine": EntryPoint("mine", f"{__name__}:NSGA2", "x"), "gone": EntryPoint("gone", "no_such_module:X", "x")}
    monkeypatch.setattr(ALGORITHMS, "_entry_points", points)
    assert find_algorithm("Mine").takes_operators
    with pytest.warns(UserWarning, match="'gone'"), pytest.raises(CapabilityError, match="did you mean 'mine'"):
        find_algorithm("mines")
    with pytest.raises(CapabilityError, match="the algorithm 'gone' of the installed package cannot be imported from no_such"):
        make_algorithm("gone", make_problem())


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


class Greedy(NSGA2):
    """With arguments that it checks itself, or needs."""

    def __init__(self, pop_size=50, strength=1.0, version="old", **kwargs):
        self.strength, self.version = strength, version
        super().__init__(pop_size=pop_size, **kwargs)


class Directed(SmoothMOEAD):
    def __init__(self, ref_dirs, hurry, **kwargs):
        self.hurry = hurry
        super().__init__(ref_dirs=ref_dirs, **kwargs)


class Patient(Planner):
    def __init__(self, target, patience=1, max_seconds=None, **kwargs):
        super().__init__(**kwargs)
        self.target, self.patience, self.max_seconds = target, patience, max_seconds

    def plan(self, problem):
        return Plan(exact_front(problem).X, message="was patient")


class Blunt(Planner):
    """Takes nothing, not even what every algorithm takes."""

    def __init__(self):
        super().__init__()

    def plan(self, problem):
        return Plan(exact_front(problem).X, message="was blunt")


def test_a_class_is_made_with_what_it_takes(make_problem):
    problem = make_problem()
    made = make_algorithm(Greedy, problem, 10, operators=path_operators(problem), strength=[1, 2], version="new")
    assert (type(made), made.pop_size, made.strength, made.version) == (Greedy, 10, [1, 2], "new")
    assert type(made.mating.crossover) is type(path_operators(problem)["crossover"])
    assert len(minimize(problem, made, ("n_gen", 2), seed=1).pop) == 10
    directed = make_algorithm(Directed, problem, 10, hurry=3, smoothness=False)
    assert (len(directed.ref_dirs), directed.hurry, directed.smoothness) == (10, 3, False)


def test_classes_of_the_table_and_planners_are_what_their_names_are(make_problem):
    assert find_algorithm(NSGA2) is CAPABILITIES["NSGA2"]
    assert find_algorithm(MOEAD) is find_algorithm(SmoothMOEAD) is CAPABILITIES["MOEAD"]
    assert find_algorithm(ExactFront) is ExactFront
    problem = make_problem()
    X = [minimize(problem, make_algorithm(one, problem, 10), ("n_gen", 3), seed=1).pop.get("X") for one in ("nsga2", NSGA2)]
    assert np.array_equal(*X)


def test_another_class_of_a_name_of_the_table_is_not_that_one(make_problem):
    mine = type("CTAEA", (NSGA2,), {})
    made = make_algorithm(mine, make_problem(), 10)
    assert type(made) is mine and made.pop_size == 10


def test_an_object_is_copied(make_problem):
    problem = make_problem()
    for given in (Greedy(pop_size=12, strength=3.0), ExactFront(max_labels=7)):
        made = make_algorithm(given, problem)
        assert made is not given and type(made) is type(given)
        assert getattr(made, "strength", None) == getattr(given, "strength", None)
        with pytest.raises(CapabilityError, match="is made already and takes no argument 'seed'"):
            make_algorithm(given, problem, seed=1)
    begun = Greedy(pop_size=12)
    begun.setup(problem, seed=1)
    with pytest.raises(CapabilityError, match="Greedy has begun a run"):
        make_algorithm(begun, problem)


@pytest.mark.parametrize(
    ("cls", "arguments", "message"),
    [
        (Greedy, {"strengh": 1}, "Greedy takes no argument 'strengh'; did you mean 'strength'"),
        (Greedy, {"n_offsprings": 0}, "n_offsprings is 0"),
        (Directed, {}, "Directed needs 1 more argument: hurry"),
        (Patient, {"target": 1, "patients": 3}, "Patient takes no argument 'patients'; did you mean 'patience'"),
        (Patient, {"patience": 2}, "Patient needs 1 more argument: target"),
        (Patient, {"target": 1, "pop_size": 5}, "Patient takes no argument 'pop_size'"),
        (Blunt, {"patience": 2}, "Blunt takes no argument 'patience'; it takes none"),
        (int, {}, "the algorithm is the class int, expected one derived from pymoo's Algorithm"),
    ],
)
def test_wrong_arguments_are_refused_in_a_sentence(make_problem, cls, arguments, message):
    with pytest.raises(CapabilityError) as error:
        make_algorithm(cls, make_problem(), **arguments)
    assert message in str(error.value) and "\n" not in str(error.value)
    assert minimize(make_problem(), make_algorithm(Blunt, make_problem())).message == "was blunt"
