"""What every planner must do, as tests to inherit."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from pymoo.optimize import minimize

from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.planners import Planner
from pymoo_gridpath.problems import GridPathProblem
from pymoo_gridpath.problems.grid_path import Obstacles
from pymoo_gridpath.testing.enumeration import RULES
from pymoo_gridpath.testing.global_state import global_state
from pymoo_gridpath.testing.reference import is_legal

CODINGS = ("cells", "integer", "binary", "mixed", "absolute")


class PlannerSuite:
    """Tests of a planner; a class of tests derives from it and has `make`.

    Paths must be legal, the Result must say how the search went, a planner that says that it is deterministic must be so, and
    what has run must pickle, with every coding and every treatment of obstacles; codings that cannot say that a path turns back
    are refused by a planner whose paths may.
    """

    def make(self) -> Planner:
        """Return a new planner."""
        raise NotImplementedError("the suite needs a method make(self) that returns a new planner")

    def problem(self, coding: str = "cells", obstacles: Obstacles = "penalty", limit: float | None = None) -> Any:
        """Return a small problem that a planner has to solve: override it for one that takes others only."""
        occupied = np.zeros((7, 8), dtype=bool)
        occupied[2:5, 3], occupied[3, 5] = True, True
        grid = OccupancyGrid(occupied, corner_cutting=False)
        return GridPathProblem(grid, (0, 0), (7, 6), coding, obstacles=obstacles, potential_limit=limit)

    def run(self, problem: Any, seed: int = 1) -> Any:
        """Return the Result of a new planner."""
        return minimize(problem, self.make(), seed=seed)

    @pytest.mark.parametrize("coding", CODINGS)
    @pytest.mark.parametrize("obstacles", ["penalty", "constraint"])
    def test_paths_are_legal_in_every_coding(self, coding, obstacles):
        problem = self.problem(coding, obstacles)
        if self.make().turns_back and problem.representation.monotone:
            with pytest.raises(CapabilityError, match="representation='cells'"):
                self.run(problem)
            return
        result = self.run(problem)
        X = result.pop.get("X")
        assert len(X), "no path for a query that has one"
        assert (problem.decode(X).interfering_cells == 0).all()
        assert np.array_equal(problem.score(problem.decode(X)), result.pop.get("F"))

    @pytest.mark.parametrize("steps", RULES, ids=str)
    def test_paths_keep_to_the_steps_of_the_grid(self, steps):
        usual = self.problem()
        grid = usual.grid.replace(**steps)
        problem: Any = GridPathProblem(grid, usual.start, usual.goal, "cells", objectives=usual.objectives)
        if self.make().goes_diagonally and not grid.neighbourhood.diagonal:
            with pytest.raises(CapabilityError, match="moves=8"):
                self.run(problem)
            return
        paths = problem.decode(self.run(problem).pop.get("X"))
        assert len(paths), f"no path on a grid of {steps}"
        for k in range(len(paths)):
            assert is_legal([tuple(cell) for cell in paths.cells(k).tolist()], grid, problem.start, problem.goal)

    def test_the_result_says_how_it_went(self):
        result = self.run(self.problem())
        assert isinstance(result.success, bool) and isinstance(result.message, str) and result.message

    def test_a_limit_that_no_path_keeps_leaves_no_path(self):
        result = self.run(self.problem(obstacles="limit", limit=1e-12))
        assert result.F is None and len(result.pop) == 0

    def test_paths_keep_a_limit_that_can_be_kept(self):
        result = self.run(self.problem(obstacles="limit", limit=3.0))
        assert all(cv <= 0 for cv in result.pop.get("CV").ravel())

    def test_flags_are_truth_values_and_the_same_run_is_the_same(self):
        planner = self.make()
        names = "deterministic", "reference", "turns_back", "goes_diagonally", "takes_operators", "takes_pop_size"
        assert all(isinstance(getattr(planner, name), bool) for name in names)
        problem = self.problem()
        first, second = (self.run(problem, 1 if not planner.deterministic else seed).pop.get("X") for seed in (1, 2))
        assert np.array_equal(first, second), "not the same twice"

    def test_nothing_is_drawn_from_numpys_global_generator(self):
        before = global_state()
        self.run(self.problem())
        assert global_state() == before

    def test_it_says_the_truth_if_it_is_a_reference(self):
        problem = self.problem()
        result = self.run(problem)
        if self.make().reference and result.success:
            assert np.allclose(np.sort(result.F, axis=0), np.sort(problem.pareto_front(max_seconds=60), axis=0))

    def test_what_has_run_pickles(self):
        result = self.run(self.problem())
        again = pickle.loads(pickle.dumps(result))
        assert again.message == result.message and np.array_equal(again.pop.get("X"), result.pop.get("X"))

    def test_unknown_arguments_are_refused(self):
        with pytest.raises(Exception, match="no_such_argument"):
            type(self.make())(no_such_argument=1)
