"""Our own planners pass the suite for planners, and the suite catches what is planted in one."""

from __future__ import annotations

import numpy as np
import pytest
from pymoo.optimize import minimize

from pymoo_gridpath.algorithms import find_algorithm, make_algorithm
from pymoo_gridpath.errors import CapabilityError, GridPathError
from pymoo_gridpath.exact import exact_front
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.planners import ExactFront, Plan, Planner
from pymoo_gridpath.testing import PlannerSuite


class TestExactFront(PlannerSuite):
    def make(self):
        return ExactFront()


class Sound(Planner):
    def plan(self, problem):
        found = exact_front(problem)
        return Plan(found.X, found.complete, found.message)


class Illegal(Sound):
    def plan(self, problem):
        cells = np.array([problem.representation.moves.index(cell) for cell in (problem.start, problem.goal)])
        return Plan(Sequences(cells, np.array([0, 2])), message="flew")


class Silent(Sound):
    def plan(self, problem):
        return super().plan(problem)._replace(message="")


class Random(Sound):
    def plan(self, problem):
        plan = super().plan(problem)
        return plan._replace(paths=plan.paths[self.random_state.permutation(len(plan.paths))])


class Partial(Sound):
    reference = True

    def plan(self, problem):
        plan = super().plan(problem)
        return plan._replace(paths=plan.paths[:1])


class Unpicklable(Sound):
    def plan(self, problem):
        self.kept = lambda: 0
        return super().plan(problem)


class Lazy(Sound):
    def plan(self, problem):
        return Plan(super().plan(problem).paths[:0], message="did nothing")


FAULTS = {
    Illegal: lambda suite: suite.test_paths_are_legal_in_every_coding("cells", "penalty"),
    Silent: lambda suite: suite.test_the_result_says_how_it_went(),
    Random: lambda suite: suite.test_flags_are_truth_values_and_the_same_run_is_the_same(),
    Partial: lambda suite: suite.test_it_says_the_truth_if_it_is_a_reference(),
    Unpicklable: lambda suite: suite.test_what_has_run_pickles(),
    Lazy: lambda suite: suite.test_paths_are_legal_in_every_coding("integer", "penalty"),
}


@pytest.mark.parametrize("planner", FAULTS)
def test_planted_faults_are_caught(planner):
    for cls, passes in ((Sound, True), (planner, False)):
        suite = type("Suite", (PlannerSuite,), {"make": lambda self, cls=cls: cls()})()
        if passes:
            FAULTS[planner](suite)
        else:
            with pytest.raises((AssertionError, GridPathError, AttributeError, TypeError)):
                FAULTS[planner](suite)


def test_flags_answer_for_planners_and_algorithms_alike():
    flags = [
        (spec.deterministic, spec.reference, spec.takes_operators, spec.takes_pop_size)
        for spec in map(find_algorithm, ("exact", "ExactFront", "NSGA-II", "gde3"))
    ]
    planner, search, own_children = (True, True, False, False), (False, False, True, True), (False, False, False, True)
    assert flags == [planner, planner, search, own_children]
    with pytest.raises(CapabilityError, match="Sound takes no argument 'speed'"):
        Sound(speed=3)


def test_a_planner_of_ones_own_is_legal_or_named():
    problem = TestExactFront().problem()
    with pytest.raises(GridPathError, match="the planner Illegal returned 1 path of which number 0 crosses"):
        TestExactFront.run(type("S", (PlannerSuite,), {"make": lambda self: Illegal()})(), problem)
    assert make_algorithm("exact", problem, max_labels=3).budget.max_labels == 3


def test_a_planner_may_hand_over_plans_on_the_way():
    class Two(Planner):
        ends = True

        def plan(self, problem):
            *_, last = self.plans(problem)
            return last

        def plans(self, problem):
            X = problem.pareto_set()
            yield Plan(X[:1], False, "one found", final=False)
            if self.ends:
                yield Plan(X, message="all found")

    problem = TestExactFront().problem()
    seen = []
    result = minimize(
        problem, Two(), ("n_gen", 1), callback=lambda algorithm: seen.append((len(algorithm.opt), algorithm.message))
    )
    assert seen == [(1, "one found"), (len(problem.pareto_set()), "all found")] and seen[1][0] > 1
    assert result.success is True and result.algorithm.n_gen == 3
    with pytest.raises(GridPathError, match="the planner Two returned None, expected a Plan"):
        minimize(problem, type("Two", (Two,), {"ends": False})())
