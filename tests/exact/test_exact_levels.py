"""Exact fronts with objectives of which the worst cell of a path decides: against all paths, and thresholds one by one."""

from __future__ import annotations

import math

import numpy as np
import pytest
from exact_fronts import Cost, front_of, queries_of, random_grid
from scipy import sparse
from scipy.sparse import csgraph

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import ExactFront
from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.exact import Budget, exact_front
from pymoo_gridpath.exact import levels as sweep
from pymoo_gridpath.objectives import LeastClearance, Objective
from pymoo_gridpath.representations import CellSequence


class Peak(Objective):
    """The highest cell on the way."""

    name = label = "peak"
    combine = "greatest"

    def __init__(self, heights):
        self.heights = heights

    def field(self, grid):
        return self.heights


def distances(grid):
    """The distance of each cell from the nearest occupied one, one pair after another."""
    blocked = [(x, y) for y, x in np.argwhere(grid.occupied).tolist()]
    height, width = grid.shape
    far = math.hypot(height, width)
    return np.array(
        [[min((math.hypot(x - a, y - b) for a, b in blocked), default=far) for x in range(width)] for y in range(height)]
    )


KINDS = [
    ("clearance",),
    ("length", "clearance"),
    ("clearance", "length"),
    ("clearance", "vulnerability"),
    ("clearance", "turn"),
    ("peak", "clearance"),
    ("length", "vulnerability", "clearance"),
    ("clearance", "turn", "peak"),
    ("wet", "clearance", "length"),
    ("length", "clearance", "peak"),
    ("length", "vulnerability", "turn", "clearance"),
]


@pytest.mark.parametrize("part", range(3))
def test_fronts_equal_enumeration(part):
    sizes = []
    for seed, grid, start, goal, _, paths in queries_of(part, 3, 14):
        draw = np.random.default_rng(seed)
        own = {
            "wet": Cost("wet", draw.integers(0, 20, grid.shape)),
            "peak": Peak(draw.integers(0, 5, grid.shape).astype(float)),
        }
        potential = GridPathProblem(grid, start, goal, "cells").objectives[1].field(grid)
        measures = {
            "length": paths.length,
            "turn": paths.turn,
            "vulnerability": paths.cells(potential),
            "wet": paths.cells(own["wet"].values),
            "peak": -paths.least(-own["peak"].heights),
            "clearance": -paths.least(distances(grid)),
        }
        measures = {name: np.round(values, 9) for name, values in measures.items()}
        coding = CellSequence(grid, start, goal, max_cells=int((~grid.occupied).sum()))
        for names in KINDS[seed % 2 :: 2]:
            problem = GridPathProblem(grid, start, goal, coding, [own.get(name, name) for name in names])
            found, expected = exact_front(problem), front_of(measures, names)
            assert found.complete and found.F.shape == expected.shape, (seed, names)
            np.testing.assert_allclose(found.F, expected, rtol=1e-9, atol=1e-8, err_msg=f"grid {seed}, {names}")
            out = problem.evaluate(found.X, return_as_dictionary=True)
            np.testing.assert_array_equal(out["F"], found.F)
            assert (out["interfering_cells"] == 0).all()
            sizes.append(len(found.F))
    assert max(sizes) >= 3


def test_monotone_codings_have_the_front_of_their_paths():
    for seed in range(4):
        grid = random_grid(9, seed)
        problem = GridPathProblem(grid, (0, 0), (8, 8), "integer", ["length", "clearance"])
        everything = GridPathProblem(grid, (0, 0), (8, 8), "cells", ["length", "clearance"]).pareto_front(max_seconds=60)
        found = problem.pareto_front(max_seconds=60)
        np.testing.assert_array_equal(problem.evaluate(problem.pareto_set()), found)
        assert all((everything <= row + 1e-9).all(axis=1).any() for row in found)


def thresholds(grid, start, goal):
    """The front of length against least clearance by a Dijkstra search for each distance that there is."""
    field, rows = distances(grid), []
    width = grid.width
    for level in np.unique(field):
        graph = grid.move_graph().tocoo()
        free = field.ravel() >= level
        keep = free[graph.row] & free[graph.col]
        kept = sparse.csr_array((graph.data[keep], (graph.row[keep], graph.col[keep])), shape=graph.shape)
        length = csgraph.dijkstra(kept, indices=start[1] * width + start[0])[goal[1] * width + goal[0]]
        ends = min(field[start[1], start[0]], field[goal[1], goal[0]])
        if np.isfinite(length) and level <= ends:
            rows.append((round(float(length), 9), -float(level)))
    return front_of({"length": [a for a, _ in rows], "clearance": [b for _, b in rows]}, ("length", "clearance"))


@pytest.mark.parametrize("seed", range(3))
def test_a_larger_front_is_that_of_all_thresholds(seed):
    grid = random_grid(24, seed, density=0.04)
    found = GridPathProblem(grid, (0, 0), (23, 23), "cells", ["length", "clearance"]).pareto_front(max_seconds=60)
    np.testing.assert_allclose(found, thresholds(grid, (0, 0), (23, 23)), rtol=1e-9)
    assert len(found) >= 2


def test_levels_that_bring_nothing_are_not_searched(monkeypatch):
    grid = random_grid(24, 0, density=0.04)
    problem = GridPathProblem(grid, (0, 0), (23, 23), "cells", ["length", "clearance"])
    searches = []
    best = sweep.best_level
    monkeypatch.setattr(sweep, "best_level", lambda *given: searches.append(1) or best(*given))
    found = exact_front(problem)
    assert len(found.F) <= len(searches) < len(np.unique(LeastClearance().field(grid))) / 2


def test_the_widest_path_alone_is_the_shortest_of_the_widest():
    grid = OccupancyGrid([[0] * 9] * 2 + [[0, 0, 0, 0, 1, 0, 0, 0, 0]] + [[0] * 9] * 8)
    problem = GridPathProblem(grid, (0, 0), (8, 0), "cells", ["clearance"])
    found = exact_front(problem)
    both = GridPathProblem(grid, (0, 0), (8, 0), "cells", ["length", "clearance"]).pareto_front(max_seconds=60)
    assert found.F.tolist() == [[both[-1, 1]]]
    assert problem.decode(found.X).length[0] == pytest.approx(both[-1, 0])


def test_rows_that_are_too_short_have_the_front_of_what_fits():
    wall = np.zeros((9, 9), dtype=bool)
    wall[0:2, 4] = True
    grid = OccupancyGrid(wall)
    whole = GridPathProblem(grid, (0, 0), (8, 0), "cells", ["length", "clearance"]).pareto_front(max_seconds=60)
    short = exact_front(GridPathProblem(grid, (0, 0), (8, 0), CellSequence(grid, (0, 0), (8, 0), 10), ["length", "clearance"]))
    assert short.complete and "with at most 10 cells" in short.message
    assert 0 < len(short.F) < len(whole)
    assert short.F.tolist() == whole[: len(short.F)].tolist()
    alone = GridPathProblem(grid, (0, 0), (8, 0), CellSequence(grid, (0, 0), (8, 0), 10), ["clearance"])
    assert exact_front(alone).F.tolist() == [[short.F[-1, 1]]]


def test_default_rows_have_room_for_the_widest_path():
    wall = np.zeros((30, 31), dtype=bool)
    wall[:25, 15] = True
    wall[1, 15] = wall[0, 15] = False
    problem = GridPathProblem(OccupancyGrid(wall), (2, 0), (28, 0), "cells", ["length", "clearance"])
    found = exact_front(problem)
    assert found.message == f"all {len(found.F)} points found"
    assert found.F[-1, 1] <= -2.0


def test_a_map_without_obstacles_has_one_point():
    problem = GridPathProblem(OccupancyGrid(np.zeros((4, 3))), (0, 0), (2, 3), "cells", ["length", "clearance"])
    assert problem.pareto_front().round(3).tolist() == [[3.828, -5.0]]


def test_a_budget_ends_it_with_what_was_found():
    problem = GridPathProblem(random_grid(24, 1, density=0.04), (0, 0), (23, 23), "cells", ["length", "clearance"])
    found = exact_front(problem, Budget(max_labels=1))
    assert not found.complete and "ended early" in found.message
    assert ExactFront.reference


def test_more_than_three_sums_are_refused():
    grid = OccupancyGrid(np.zeros((3, 3)))
    four = ["length", "vulnerability", "turn", Cost("wet", np.ones((3, 3))), "clearance"]
    with pytest.raises(
        CapabilityError, match="the problem has 4 objectives besides those of which the worst cell decides, expected"
    ):
        exact_front(GridPathProblem(grid, (0, 0), (2, 2), "cells", four))
