"""What every objective has to keep, as tests that a class of one's own inherits."""

from __future__ import annotations

import functools
import itertools
import pickle
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.optimize import minimize

from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.exact import exact_front
from pymoo_gridpath.fields import check_costs
from pymoo_gridpath.grid import Box, Cell, OccupancyGrid
from pymoo_gridpath.objectives import Objective, make_objectives, moves_of
from pymoo_gridpath.operators import path_operators
from pymoo_gridpath.problems import GridPathProblem
from pymoo_gridpath.representations import CellSequence
from pymoo_gridpath.testing.enumeration import STEPS, enumerate_paths, non_dominated, turn_between

_HEADINGS = {step: heading for heading, step in enumerate(STEPS)}


class ObjectiveSuite:
    """Tests of an objective. Inherit it, and set `objective`.

    Attributes
    ----------
    objective : Objective
        The one to test.

    Examples
    --------
    In a file of tests, ``class TestMud(ObjectiveSuite): objective = Mud()``.
    """

    objective: Objective

    def grids(self) -> list[OccupancyGrid]:
        """Return the grids of the tests, of some 14 free cells at most; override it if the objective is for others."""
        made = []
        for seed in range(8):
            draw = np.random.default_rng(seed)
            occupied = draw.random((3, 4 + seed % 2)) < 0.2
            # One way is always free.
            occupied[0] = occupied[:, -1] = False
            made.append(OccupancyGrid(occupied, corner_cutting=seed % 2 == 0))
        return made

    def _queries(self):
        """Yield each grid, the problem of the objective alone from its bottom left to its top right, and all paths."""
        for grid in self.grids():
            start, goal = (0, 0), (grid.width - 1, grid.height - 1)
            coding = CellSequence(grid, start, goal, max_cells=int((~grid.occupied).sum()))
            yield grid, GridPathProblem(grid, start, goal, coding, [self.objective]), _paths(grid)

    def test_it_has_a_name_and_a_label(self):
        assert make_objectives(self.objective) == (self.objective,)
        assert self.objective.name and isinstance(self.objective.label, str) and self.objective.label

    def test_its_costs_are_costs(self):
        """Of the right shape, nowhere negative, finite where paths go, the same every time, and the grid is not changed."""
        for grid in self.grids():
            before = grid.occupied.copy()
            for costs in (self.objective.field, self.objective.moves):
                first, again = costs(grid), costs(grid)
                assert (first is None) == (again is None)
                assert first is None or np.array_equal(np.asarray(first), np.asarray(again), equal_nan=True)
            field = self.objective.field(grid)
            if field is not None:
                check_costs("the field", field, grid)
            moves_of(self.objective, grid)
            assert np.array_equal(grid.occupied, before)

    def test_its_field_in_a_box_is_that_of_the_grid(self):
        for grid in self.grids():
            whole = self.objective.field(grid)
            for box in (grid.whole, Box(1, 0, grid.width, grid.height - 1)):
                part = self.objective.field_in(grid, box)
                assert (part is None) == (whole is None)
                if whole is not None and part is not None:
                    np.testing.assert_allclose(part, np.asarray(whole)[box.slices], rtol=1e-12, atol=1e-12)

    def test_a_score_is_what_it_says_of_cells_moves_and_turns(self):
        if self.objective.combine == "sum" and not (self.objective.additive or self.objective.maximise):
            pytest.skip("it scores paths by a rule of its own")
        for grid, problem, paths in self._queries():
            expected = slow_scores(self.objective, grid, paths)
            np.testing.assert_allclose(_scores(problem, paths), expected, rtol=1e-9, atol=1e-9)

    def test_a_batch_scores_as_its_paths_alone(self):
        for _, problem, paths in self._queries():
            some = paths[:: max(1, len(paths) // 10)]
            alone = [_scores(problem, [cells])[0] for cells in some]
            np.testing.assert_array_equal(_scores(problem, some), alone)
            assert len(problem.score(problem.decode(np.empty((0, problem.n_var), dtype=int)))) == 0

    def test_paths_that_are_none_score_a_number(self):
        for _, problem, _ in self._queries():
            coding = problem.representation
            X = np.random.default_rng(1).integers(coding.xl, coding.xu, size=(20, coding.n_var), endpoint=True)
            assert np.isfinite(problem.score(problem.decode(X))).all()

    def test_it_pickles(self):
        """As a problem does that goes to another process."""
        for _, problem, paths in self._queries():
            again = pickle.loads(pickle.dumps(problem))
            np.testing.assert_array_equal(_scores(again, paths[:20]), _scores(problem, paths[:20]))

    def test_it_is_shown_in_one_line(self):
        assert repr(self.objective) and "\n" not in repr(self.objective)

    def test_its_exact_fronts_are_those_of_all_paths(self):
        for grid, _, paths in self._queries():
            for others in ((), ("length",), ("vulnerability", "turn")):
                if self.objective.name in others:
                    continue
                objectives = [self.objective, *others]
                coding = CellSequence(grid, (0, 0), (grid.width - 1, grid.height - 1), int((~grid.occupied).sum()))
                problem = GridPathProblem(grid, coding.start, coding.goal, coding, objectives)
                if not (self.objective.additive or self.objective.bottleneck):
                    with pytest.raises(CapabilityError):
                        exact_front(problem)
                    continue
                rows = np.column_stack([slow_scores(one, grid, paths) for one in problem.objectives])
                # Sums of the same costs in another order count as the same.
                expected = non_dominated(tuple(row) for row in np.round(rows, 9).tolist())
                found = exact_front(problem)
                assert found.complete and found.F.shape == expected.shape
                np.testing.assert_allclose(found.F, expected, rtol=1e-8, atol=1e-8)

    def test_it_is_minimised(self):
        grid = self.grids()[0]
        others = [name for name in ("length", "turn") if name != self.objective.name][:1]
        problem = GridPathProblem(grid, (0, 0), (grid.width - 1, grid.height - 1), "cells", [self.objective, *others])
        result = minimize(problem, NSGA2(pop_size=12, **path_operators(problem)), ("n_gen", 4), seed=1)
        X = np.atleast_2d(np.asarray(result.X))
        np.testing.assert_array_equal(problem.evaluate(X), np.atleast_2d(np.asarray(result.F)))
        assert (problem.decode(X).interfering_cells == 0).all()


@functools.lru_cache(maxsize=16)
def _paths(grid: OccupancyGrid) -> list[tuple[Cell, ...]]:
    """Return all paths from the bottom left to the top right."""
    return [path.cells for path in enumerate_paths(grid, (0, 0), (grid.width - 1, grid.height - 1))]


@functools.lru_cache(maxsize=1 << 17)
def _headings_of(cells: tuple[Cell, ...]) -> tuple[list[int], int]:
    """Return the headings of a path's steps, and its turn in units of 45 degrees."""
    headings = [_HEADINGS[b[0] - a[0], b[1] - a[1]] for a, b in itertools.pairwise(cells)]
    return headings, sum(itertools.starmap(turn_between, itertools.pairwise(headings)))


def slow_scores(objective: Objective, grid: OccupancyGrid, paths: Sequence[tuple[Cell, ...]]) -> list[float]:
    """Return what legal paths cost by what an objective says, one cell and one step after another."""
    field, moves = objective.field(grid), objective.moves(grid)
    costs = None if field is None else np.asarray(field, dtype=float).tolist()
    steps: Any = (0.0, 0.0) if moves is None else np.asarray(moves, dtype=float).tolist()
    by_cell = np.ndim(steps[0]) > 0

    def score(cells) -> float:
        visited = [] if costs is None else [costs[y][x] for x, y in cells]
        if objective.combine != "sum":
            return min(visited) if objective.combine == "least" else max(visited)
        headings, turn = _headings_of(cells)
        for heading, (x, y) in zip(headings, cells[1:], strict=True):
            visited.append(steps[heading][y][x] if by_cell else steps[heading % 2])
        return sum(visited) + objective.turn_cost * turn

    return [-score(cells) if objective.maximise else score(cells) for cells in paths]


def _scores(problem: GridPathProblem, paths) -> np.ndarray:
    """Return the scores of paths by their cells in the one objective of a problem."""
    rows = np.full((len(paths), problem.n_var), problem.representation.xu[-1])
    for row, cells in zip(rows, paths, strict=True):
        row[: len(cells)] = [y * problem.grid.width + x for x, y in cells]
    return problem.score(problem.decode(rows))[:, 0]
