"""What every algorithm must do that is to plan paths, as tests to inherit."""

from __future__ import annotations

import copy
import hashlib
import pickle
import random
import warnings
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest
from pymoo.core.callback import Callback
from pymoo.optimize import minimize

from pymoo_gridpath.algorithms import Capability, find_algorithm, make_algorithm
from pymoo_gridpath.algorithms.arguments import parameters
from pymoo_gridpath.algorithms.known import class_of
from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.operators import default_operators, path_operators
from pymoo_gridpath.problems import GridPathProblem
from pymoo_gridpath.problems.members import Members
from pymoo_gridpath.study import ProblemSpec, Study, plan_study
from pymoo_gridpath.study.planning.build import build_termination
from pymoo_gridpath.study.running.execute import execute
from pymoo_gridpath.study.running.record import from_bytes
from pymoo_gridpath.testing.elsewhere import elsewhere
from pymoo_gridpath.testing.global_state import global_state

# One of the paper's codings, one of its bits, and one in which paths may turn back.
CODINGS = ("integer", "binary", "cells")
OPERATORS = ("sampling", "crossover", "mutation", "repair")
# More than any run here takes.
MOST_STEPS = 60


class Watch(Callback):
    """A callback that keeps how many evaluations there were until each generation, and how many members it has."""

    def __init__(self):
        super().__init__()
        self.seen: list[tuple[int, int]] = []

    def _update(self, algorithm: Any) -> None:
        self.seen.append((algorithm.evaluator.n_eval, len(algorithm.pop)))


class CountingProblem(GridPathProblem):
    """A problem that counts the rows that it is asked to evaluate, whoever asks, and those of them that are no legal paths."""

    n_rows = n_illegal = 0

    def _evaluate(self, x, out, *args, **kwargs):
        super()._evaluate(x, out, *args, **kwargs)
        self.n_rows += len(x)
        self.n_illegal += int(np.count_nonzero(out["interfering_cells"]))


class AlgorithmSuite:
    """Tests of an algorithm of pymoo's kind; a class of tests derives from it and has `algorithm`.

    The same seed must give the same bits, in another process and after a copy, too. Evaluations are counted and end a run.
    Genes are whole numbers within their bounds, and paths are what operators have made. Constant objectives, fronts of one
    point and problems without a legal path are no trouble. A study runs it as `minimize` does. What it says of itself, in a
    `Capability` or by the signature of its constructor, must be so.
    """

    #: Its class, at the top of a module, or the name that it is known by.
    algorithm: Any = None
    #: Further arguments for `make_algorithm`.
    arguments: Mapping[str, Any] = MappingProxyType({})
    #: Members of a population, if it takes so many.
    pop_size = 20
    #: Generations of a run.
    n_gen = 4

    @property
    def row(self) -> Capability:
        """What it can do."""
        row = find_algorithm(self.algorithm)
        assert isinstance(row, Capability), "a planner has a suite of its own, PlannerSuite"
        return row

    @property
    def takes(self) -> set[str]:
        """What its constructor takes."""
        return set(parameters(class_of(self.row), self.row.name))

    def problem(self, coding: str = "cells", obstacles: str = "penalty", kind: Any = GridPathProblem) -> Any:
        """Return a small problem of two objectives: override it for an algorithm that takes others only."""
        occupied = np.zeros((8, 8), dtype=bool)
        occupied[2:5, 3], occupied[5, 5], occupied[1, 6] = True, True, True
        return kind(OccupancyGrid(occupied, corner_cutting=True), (0, 0), (7, 7), coding, obstacles=obstacles)

    def make(self, problem: Any, **more: Any) -> Any:
        """Return a new algorithm for a problem."""
        size = {"pop_size": self.pop_size} if self.row.takes_pop_size else {}
        return make_algorithm(self.algorithm, problem, **{**size, **self.arguments, **more})

    def run(self, problem: Any, seed: int = 1, **more: Any) -> Any:
        """Return the Result of a new algorithm."""
        return minimize(problem, self.make(problem, **more), ("n_gen", self.n_gen), seed=seed)

    def begin(self, problem: Any, budget: Mapping[str, int], **more: Any) -> tuple[Any, Watch]:
        """Return a new algorithm that is ready for its first generation, with a budget of a study, and what watches it."""
        algorithm, watch = self.make(problem, **more), Watch()
        algorithm.setup(problem, termination=build_termination(budget, algorithm), seed=1, callback=watch)
        return algorithm, watch

    # -- what it makes ------------------------------------------------------------------------------------------------

    @pytest.mark.parametrize("coding", CODINGS)
    @pytest.mark.parametrize("obstacles", ["penalty", "constraint"])
    def test_genes_and_objectives_are_those_of_the_problem(self, coding, obstacles):
        problem = self.problem(coding, obstacles)
        if obstacles == "constraint" and not self.row.constraints:
            with pytest.raises(CapabilityError, match="constraints"):
                self.make(problem)
            return
        result = self.run(problem)
        X, F = result.pop.get("X"), result.pop.get("F")
        assert len(X), "no member is left"
        assert X.dtype.kind in "ib", f"genes are {X.dtype}"
        assert ((problem.xl <= X) & (problem.xu >= X)).all(), "genes are out of their bounds"
        assert np.array_equal(problem.evaluate(X, return_values_of=["F"]), F), "objectives are not those of the genes"
        if result.X is not None:
            best = np.atleast_2d(result.X), np.atleast_2d(result.F)
            assert np.array_equal(problem.evaluate(best[0], return_values_of=["F"]), best[1])

    @pytest.mark.parametrize("coding", CODINGS)
    def test_paths_are_legal_where_operators_see_to_it(self, coding):
        if not self.row.takes_operators:
            pytest.skip("it makes children in a way of its own")
        problem = self.problem(coding, kind=CountingProblem)
        operators = {slot: one for slot, one in path_operators(problem).items() if slot in self.takes}
        algorithm, _ = self.begin(problem, {"generations": self.n_gen}, operators=operators)
        before = problem.n_illegal
        _go_on(algorithm)
        assert problem.n_illegal == before, "paths were made that no operator made"

    def test_operators_are_called_where_it_takes_them(self):
        problem = self.problem("integer")
        operators, called = default_operators(problem), set()
        wanted = {slot for slot in OPERATORS if slot in self.takes and (slot != "repair" or self.row.repair)}
        if not self.row.takes_operators:
            wanted -= {"crossover", "mutation"}
            with pytest.raises(CapabilityError, match="takes no argument 'crossover'"):
                self.make(problem, operators=operators)
        for slot in wanted:
            _spy(operators[slot], slot, called)
        given = {slot: operators[slot] for slot in wanted}
        self.run(problem, operators=given)
        assert called == wanted, f"{', '.join(sorted(wanted - called))} was not called"

    def test_it_has_no_more_members_than_it_is_told(self):
        problem = self.problem()
        if not self.row.takes_pop_size:
            with pytest.raises(CapabilityError, match="takes no argument 'pop_size'"):
                make_algorithm(self.algorithm, problem, pop_size=self.pop_size, **self.arguments)
            return
        for pop_size in (self.pop_size, self.pop_size // 2 + 1):
            algorithm, watch = self.begin(problem, {"generations": 3}, pop_size=pop_size)
            _go_on(algorithm)
            assert max(n_members for _, n_members in watch.seen) <= pop_size
            assert 0 < watch.seen[0][0] <= pop_size, "the first population is of another size"

    # -- seeds --------------------------------------------------------------------------------------------------------

    def test_the_same_seed_gives_the_same_bits(self):
        for obstacles, same in (("penalty", self.row.reproducible), ("constraint", self.row.reproducible_constrained)):
            if not same or (obstacles == "constraint" and not self.row.constraints):
                continue
            problem = self.problem("integer", obstacles)
            # Another run in between leaves no trace.
            first, other, again = (self.run(problem, seed).pop for seed in (1, 2, 1))
            assert _digest(first) == _digest(again), f"another result of the same seed, with obstacles={obstacles!r}"
            if self.row.deterministic:
                assert _digest(first) == _digest(other), "it says that it is deterministic"
            else:
                assert _digest(first) != _digest(other), "the seed does not count"

    def test_the_same_bits_in_another_process(self):
        if not self.row.reproducible:
            pytest.skip("it says that it is not reproducible")
        assert elsewhere(self._digest_here) == self._digest_here()

    def _digest_here(self) -> str:
        return _digest(self.run(self.problem("cells")).pop)

    def test_nothing_is_drawn_from_global_generators(self):
        problem = self.problem()
        before = global_state(), random.getstate()
        self.run(problem)
        assert (global_state(), random.getstate()) == before

    # -- how it runs --------------------------------------------------------------------------------------------------

    def test_generations_end_a_run(self):
        algorithm, watch = self.begin(self.problem(), {"generations": 3})
        _go_on(algorithm)
        assert len(watch.seen) == 3 or (self.row.deterministic and len(watch.seen) < 3)

    def test_evaluations_are_counted_and_end_a_run(self):
        problem = self.problem(kind=CountingProblem)
        budget = self.pop_size * 3
        algorithm, watch = self.begin(problem, {"evaluations": budget})
        before = problem.n_rows
        _go_on(algorithm)
        counts = [0, *(n_eval for n_eval, _ in watch.seen)]
        assert counts[-1] == problem.n_rows - before, "not every evaluation is counted"
        assert counts[-2] < budget, "it goes on when the evaluations are used up"
        assert counts[-1] >= budget or self.row.deterministic, "it ends before the evaluations are used up"

    @pytest.mark.parametrize(
        "how", [copy.deepcopy, lambda algorithm: pickle.loads(pickle.dumps(algorithm))], ids=["copy", "pickle"]
    )
    def test_what_has_begun_is_copied_and_goes_on_alike(self, how):
        if how is not copy.deepcopy and not self.row.pickles:
            pytest.skip("it says that it does not pickle")
        algorithm, _ = self.begin(self.problem("integer"), {"generations": self.n_gen})
        for _ in range(2):
            if algorithm.has_next():
                algorithm.next()
        twin = how(algorithm)
        for one in (algorithm, twin):
            _go_on(one)
        assert twin.pop is not algorithm.pop
        assert _digest(twin.pop) == _digest(algorithm.pop)

    # -- odd problems -------------------------------------------------------------------------------------------------

    @pytest.mark.parametrize("coding", CODINGS)
    def test_a_constant_objective_is_no_trouble(self, coding):
        # Nothing is near an obstacle where there is none.
        grid = OccupancyGrid(np.zeros((8, 8)), corner_cutting=True)
        problem = GridPathProblem(grid, (0, 0), (7, 5), coding, ["length", "vulnerability"])
        algorithm, _ = self.begin(problem, {"generations": self.n_gen})
        with warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)
            algorithm.next()
            shortest = algorithm.pop.get("F")[:, 0].min()
            _go_on(algorithm)
        F = algorithm.pop.get("F")
        assert np.isfinite(F).all() and F[:, 0].min() <= shortest, "it has lost its shortest path"

    @pytest.mark.parametrize("coding", CODINGS)
    def test_a_front_of_one_point_is_no_trouble(self, coding):
        # The only path there is, but for one that turns back.
        problem = GridPathProblem(OccupancyGrid(np.zeros((1, 8)), corner_cutting=True), (0, 0), (7, 0), coding)
        with warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)
            result = self.run(problem)
        assert np.unique(np.atleast_2d(result.F), axis=0).tolist() == [[7.0, 0.0]]

    def test_a_problem_without_a_legal_path_has_no_front(self):
        if not self.row.constraints:
            pytest.skip("it says that it takes no constraints")
        # No path is so far from all obstacles.
        grid, query = self.problem().grid, ((0, 0), (7, 7))
        result = self.run(GridPathProblem(grid, *query, "integer", obstacles="limit", potential_limit=1e-12))
        assert (result.pop.get("CV") > 0).all()
        assert result.F is None, "what is infeasible is given as a result"

    # -- where it is used ---------------------------------------------------------------------------------------------

    def test_unknown_arguments_are_refused(self):
        with pytest.raises(CapabilityError, match="takes no argument 'no_such_argument'"):
            make_algorithm(self.algorithm, self.problem(), **self.arguments, no_such_argument=1)

    def test_a_study_runs_it_as_minimize_does(self):
        size = {"pop_size": self.pop_size} if self.row.takes_pop_size else {}
        plan = plan_study(
            Study(
                problems=[ProblemSpec(grid=self.problem().grid, start=(0, 0), goal=(7, 7), representation="integer")],
                algorithms=[{"algorithm": self.algorithm, **size, "parameters": dict(self.arguments)}],
                seeds=[3],
                budget={"generations": self.n_gen},
                reference=False,
            )
        )
        record = from_bytes(execute(plan.task(plan.runs[0])))
        assert record.status == "finished", record.message
        members = Members(self.run(self.problem("integer"), 3).algorithm)
        assert np.array_equal(record.F, members.F[members.front()]), "a study has another result"


def _go_on(algorithm: Any) -> None:
    """Run to the end, or fail where there is none."""
    for _ in range(MOST_STEPS):
        if not algorithm.has_next():
            return
        algorithm.next()
    assert not algorithm.has_next(), "it heeds no termination"


def _spy(operator: Any, slot: str, called: set[str]) -> None:
    """Have an operator say that it is called, and its copies, too."""
    kind = type(operator)

    def spied(self, *args, **kwargs):
        called.add(slot)
        return kind._do(self, *args, **kwargs)

    operator.__class__ = type(kind.__name__, (kind,), {"_do": spied})


def _digest(pop: Any) -> str:
    X = np.ascontiguousarray(pop.get("X"), dtype=np.int64)
    return hashlib.sha256(X.tobytes() + np.ascontiguousarray(pop.get("F"), dtype=float).tobytes()).hexdigest()
