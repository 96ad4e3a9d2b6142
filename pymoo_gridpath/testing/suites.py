"""What every suite of problems has to keep, as tests that a class of one's own inherits."""

from __future__ import annotations

import hashlib
import inspect
import json
import os
import pickle
import random
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.optimize import minimize

from pymoo_gridpath.errors import GridError, GridPathError
from pymoo_gridpath.fields import check_costs
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.objectives import Objective, moves_of
from pymoo_gridpath.operators import path_operators
from pymoo_gridpath.problems import SUITES, GridPathProblem, Suite, make_suite
from pymoo_gridpath.study import ProblemSpec, Study, plan_study
from pymoo_gridpath.study.planning.build import build_problem
from pymoo_gridpath.study.planning.plan import Plan
from pymoo_gridpath.study.running.execute import execute
from pymoo_gridpath.study.running.record import from_bytes
from pymoo_gridpath.testing.elsewhere import elsewhere
from pymoo_gridpath.testing.enumeration import STEPS, label_front
from pymoo_gridpath.testing.global_state import global_state
from pymoo_gridpath.testing.objectives import slow_scores
from pymoo_gridpath.testing.reference import walk

# Larger maps take too long in plain Python: of two objectives or three, and of one.
MOST_CELLS_OF_FRONTS, MOST_CELLS = 300, 1_000
# What no argument is: whatever is not taken is refused in a sentence.
NONSENSE = (None, object(), True, -1, 2.5, float("nan"), 10**30, "", "no such thing", [], [[]], {}, b"bytes")


class SuiteSuite:
    """Tests of a `Suite` of problems; a class of tests derives from it, and sets `suite` and `arguments`.

    Problems must have names of their own, be the same bits every time, in another process and as a study writes them down, lead
    from one free cell to another, and have objectives whose costs are costs and whose exact fronts are those of a label search
    in plain Python. What is no problem of the suite must be refused in a sentence.

    Attributes
    ----------
    suite : type of Suite
        The one to test, registered.
    arguments : sequence of mapping
        Those of some of its problems, as a study has them, the smallest one first.
    pathless : sequence of mapping
        Those of problems that are defined and do not have a path.
    wrong : sequence of mapping
        Those of what is no problem of the suite.

    Examples
    --------
    >>> from pymoo_gridpath.problems import RandomCostGrid
    >>> class TestRandomCosts(SuiteSuite):
    ...     suite = RandomCostGrid
    ...     arguments = ({"width": 3, "height": 4}, {"width": 3, "height": 4, "seed": 2})
    ...     wrong = ({"width": 1, "height": 4},)
    """

    suite: type[Suite]
    arguments: Sequence[Mapping[str, Any]]
    pathless: Sequence[Mapping[str, Any]] = ()
    wrong: Sequence[Mapping[str, Any]] = ()

    @property
    def takes(self) -> Mapping[str, inspect.Parameter]:
        """What its constructor takes."""
        return inspect.signature(self.suite).parameters

    def make(self, arguments: Mapping[str, Any]) -> Suite:
        """Return one of its problems by name."""
        return make_suite(self.suite.name, **arguments)

    def small(self) -> list[Suite]:
        """Return its problems on maps that are not too large for plain Python, of which there should be some."""
        made = [self.make(arguments) for arguments in self.arguments]
        found = [one for one in made if one.query[0].occupied.size <= MOST_CELLS]
        return found or pytest.skip(f"no map is of at most {MOST_CELLS:,} cells")

    def table(self, arguments: Mapping[str, Any]) -> dict[str, Any]:
        """Return what a study says of one of its problems."""
        return {"class": self.suite.name, **arguments}

    # -- names --------------------------------------------------------------------------------------------------------

    def test_it_is_known_by_its_name(self):
        assert SUITES[self.suite.name] is self.suite
        assert len(self.arguments), "the suite needs arguments of some problems"
        for arguments in self.arguments:
            assert digest_of(self.make(arguments)) == digest_of(self.suite(**arguments))

    def test_it_says_whose_definitions_it_follows(self):
        """As lists and reports print it."""
        assert isinstance(self.suite.follows, str) and self.suite.follows.strip() and "\n" not in self.suite.follows
        assert set(self.suite.files) <= set(self.takes), "files names what is no argument"

    def test_each_problem_has_a_label_of_its_own(self):
        labels = [self.make(arguments).label for arguments in self.arguments]
        assert all(isinstance(one, str) and one.strip() and one.isprintable() for one in labels), labels
        assert len(set(labels)) == len(labels), f"two problems have the same label: {labels}"

    def test_it_keeps_its_arguments(self):
        """A problem is made again of what it holds, and shown by it in one line."""
        for arguments in self.arguments:
            made = self.make(arguments)
            again = self.suite(**{key: getattr(made, key) for key in self.takes})
            assert (repr(again), again.label) == (repr(made), made.label) and "\n" not in repr(made)
            assert digest_of(again) == digest_of(made), f"not the same problem of its attributes: {made!r}"

    # -- bits ---------------------------------------------------------------------------------------------------------

    def test_the_same_arguments_give_the_same_bits(self):
        before = global_state(), random.getstate(), os.getcwd()
        for arguments in self.arguments:
            made = self.make(arguments)
            first = digest_of(made)
            assert digest_of(made) == first, "another problem when it is asked again"
            assert digest_of(self.make(arguments)) == first, "another problem when it is made again"
        assert (global_state(), random.getstate(), os.getcwd()) == before, "something that is global has changed"

    def test_the_same_bits_in_another_process(self):
        for arguments in self.arguments:
            made = self.make(arguments)
            assert elsewhere(_digest_there, self.suite, dict(arguments)) == digest_of(made), f"not the same there: {made!r}"

    def test_problems_of_different_arguments_differ(self):
        found = [digest_of(self.make(arguments)) for arguments in self.arguments]
        assert len(set(found)) == len(found), "arguments of which one has no effect"

    def test_it_pickles(self):
        for arguments in self.arguments:
            made = self.make(arguments)
            expected = digest_of(made)
            again = pickle.loads(pickle.dumps(made))
            assert repr(again) == repr(made) and digest_of(again) == expected
            problem = made.problem()
            X = rows_of(problem)
            np.testing.assert_array_equal(pickle.loads(pickle.dumps(problem)).evaluate(X), problem.evaluate(X))

    # -- queries ------------------------------------------------------------------------------------------------------

    def test_it_leads_from_a_free_cell_to_another(self):
        for arguments in self.arguments:
            grid, start, goal = self.make(arguments).query
            assert isinstance(grid, OccupancyGrid)
            for cell in (start, goal):
                assert isinstance(cell, tuple) and grid.contains(cell), f"{cell} is no cell (x, y) of the grid"
                assert not grid.occupied[cell[1], cell[0]], f"{cell} is occupied"
            assert start != goal, "it ends where it begins"

    def test_paths_are_there_and_are_coded(self):
        for made in self.small():
            grid, start, goal = made.query
            problem: Any = made.problem()
            assert problem.grid == grid and (problem.start, problem.goal) == (start, goal)
            steps, rng = {STEPS[m] for m in headings_of(made)}, np.random.default_rng(3)
            walks = [walk(grid, start, goal, rng, steps.__contains__) for _ in range(3)]
            paths = [cells for cells in walks if cells]
            assert len(paths) == len(walks), "no path joins the start and the goal"
            decoded = problem.decode(rows_of(problem, paths))
            assert (decoded.interfering_cells == 0).all(), "a legal path is coded as none"
            for k, path in enumerate(paths):
                assert [tuple(cell) for cell in decoded.cells(k).tolist()] == path

    def test_what_has_no_path_is_refused(self):
        for arguments in self.pathless:
            made = self.make(arguments)
            with pytest.raises(GridError) as info:
                made.problem()
            assert "\n" not in str(info.value)

    # -- objectives ---------------------------------------------------------------------------------------------------

    def test_objectives_go_by_their_names(self):
        for arguments in self.arguments:
            made = self.make(arguments)
            names = [one.name for one in made.objectives]
            assert all(isinstance(one, Objective) for one in made.objectives)
            assert names and len(set(names)) == len(names), f"two objectives have the same name: {names}"
            assert made.problem().objective_names == names
            for name in reversed(names):
                assert made.problem([name]).objective_names == [name]
            with pytest.raises(GridPathError, match="no_such_objective") as info:
                made.problem(["no_such_objective"])
            assert "\n" not in str(info.value)

    def test_costs_are_costs(self):
        """Nowhere negative, and finite wherever paths go."""
        for arguments in self.arguments:
            made = self.make(arguments)
            for one in made.objectives:
                field = one.field(made.query[0])
                if field is not None:
                    check_costs(f"the field of {one.name}", field, made.query[0])
                moves_of(one, made.query[0])

    def test_exact_fronts_are_those_of_a_plain_search(self):
        """Of one, two and three objectives that come one after another."""
        for made in self.small():
            grid, start, goal = made.query
            known = [one for one in made.objectives if one.additive or one.bottleneck]
            for n in (1, 2, 3) if grid.occupied.size <= MOST_CELLS_OF_FRONTS else (1,):
                for k in range(len(known) - n + 1):
                    chosen = known[k : k + n]
                    found = made.problem(chosen).pareto_front(max_seconds=60)
                    expected = label_front(grid, start, goal, chosen, headings_of(made))
                    assert found is not None, f"no exact front of {[one.name for one in chosen]}"
                    assert found.shape == expected.shape, f"another front of {[one.name for one in chosen]}"
                    np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-7)

    def test_a_search_scores_paths_as_the_objectives_say(self):
        made = self.make(self.arguments[0])
        problem: Any = made.problem()
        result: Any = minimize(problem, NSGA2(pop_size=8, **path_operators(problem)), ("n_gen", 3), seed=1)
        X = result.pop.get("X")
        paths = problem.decode(X)
        assert (paths.interfering_cells == 0).all(), "a search finds what is no path"
        grid, scores = problem.grid, problem.score(paths)
        cells = [tuple(map(tuple, paths.cells(k).tolist())) for k in range(len(paths))]
        for k, one in enumerate(made.objectives):
            if one.additive or one.bottleneck:
                np.testing.assert_allclose(scores[:, k], slow_scores(one, grid, cells), rtol=1e-9, atol=1e-9)

    # -- what is refused ----------------------------------------------------------------------------------------------

    def test_what_is_no_problem_is_refused_in_a_sentence(self):
        for arguments in self.wrong:
            said = self._refused(arguments)
            assert said is not None, f"it takes {arguments}"
            shown = [text for key, value in arguments.items() for text in (key, str(value))]
            assert any(text in said for text in shown), f"it does not say what is wrong: {said}"

    def test_arguments_that_it_does_not_take_are_refused(self):
        with pytest.raises(GridPathError, match=r"cannot be made: .*no_such_argument") as info:
            self.make({**self.arguments[0], "no_such_argument": 1})
        assert "\n" not in str(info.value)

    def test_nonsense_is_refused_in_a_sentence_or_taken(self):
        """In place of each argument; texts are misspelt besides."""
        usual = self.arguments[0]
        for key in self.takes:
            given = usual.get(key)
            misspelt = [given[:-1], f"{given}?", given.swapcase()] if isinstance(given, str) else []
            for value in (*NONSENSE, *misspelt):
                self._refused({**usual, key: value})

    def _refused(self, arguments: Mapping[str, Any]) -> str | None:
        """Return what is said of arguments; None if a problem is made of them."""
        try:
            self.make(arguments).problem()
        except GridPathError as error:
            assert str(error).strip() and "\n" not in str(error), f"not one line: {error}"
            return str(error)
        return None

    # -- in studies ---------------------------------------------------------------------------------------------------

    def test_a_study_means_the_same_problem_and_runs_it(self):
        for k, arguments in enumerate(self.arguments):
            made = self.make(arguments)
            # As a file holds it, and as Python may.
            for given in (json.loads(json.dumps(self.table(arguments))), made):
                plan = self._plan(given)
                (planned,) = plan.problems
                assert planned.label == made.label and made.follows in planned.source
                assert Plan.from_json(json.loads(json.dumps(plan.to_json()))).to_json() == plan.to_json()
                assert _digest(build_problem(planned.spec, planned.grid)) == digest_of(made), "a study has another problem"
            if k == 0:
                record = from_bytes(execute(plan.task(plan.runs[0])))
                assert record.status == "finished" and len(record.F), record.message

    def test_a_study_refuses_what_is_no_problem(self):
        for arguments in self.wrong:
            with pytest.raises(GridPathError) as info:
                self._plan(self.table(arguments))
            assert "\n" not in str(info.value)

    def _plan(self, given: Any) -> Plan:
        return plan_study(
            Study(
                problems=[ProblemSpec(suite=given)],
                algorithms=[{"algorithm": "NSGA2", "pop_size": 8}],
                seeds=1,
                budget={"generations": 2},
                reference=False,
            )
        )


def headings_of(suite: Suite) -> list[int]:
    """Return the headings along which paths of a suite may go."""
    _, start, goal = suite.query
    forward = [(b > a) - (b < a) for a, b in zip(start, goal, strict=True)]
    return [
        m for m, step in enumerate(STEPS) if suite.backtracking or all(a in (0, b) for a, b in zip(step, forward, strict=True))
    ]


def rows_of(problem: GridPathProblem, paths: Sequence[Sequence[Any]] = ()) -> np.ndarray:
    """Return the genes that code paths by their cells, or else some that are drawn, whatever they code."""
    coding = problem.representation
    if not paths:
        return np.random.default_rng(1).integers(coding.xl, coding.xu, size=(9, coding.n_var), endpoint=True)
    rows = np.full((len(paths), coding.n_var), coding.xu[-1])
    for row, cells in zip(rows, paths, strict=True):
        assert len(cells) <= coding.n_var, f"a path of {len(cells)} cells does not fit into {coding.n_var} genes"
        row[: len(cells)] = [y * problem.grid.width + x for x, y in cells]
    return rows


def digest_of(suite: Suite) -> str:
    """Return a hash of all that a problem is: its map, its query, how paths are coded, and what is scored."""
    return _digest(suite.problem())


def _digest_there(cls: type[Suite], arguments: dict[str, Any]) -> str:
    return digest_of(cls(**arguments))


def _digest(problem: Any) -> str:
    X = rows_of(problem)
    coding = repr((problem.grid.digest, problem.grid.resolution, problem.start, problem.goal, problem.objective_names))
    arrays = [problem.xl, problem.xu, X, problem.score(problem.decode(X)), problem.decode(X).interfering_cells]
    for one in problem.objectives:
        arrays += [part for part in (one.field(problem.grid), one.moves(problem.grid)) if part is not None]
    bits = b"".join(np.ascontiguousarray(part, dtype=float).tobytes() for part in arrays)
    return hashlib.sha256(coding.encode() + bits).hexdigest()
