"""Costs of the ground and climb: what paths cost by them, against scikit-image and all paths; and what is refused."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.optimize import minimize
from skimage.graph import MCP_Geometric

from pymoo_gridpath import GridPathProblem, OccupancyGrid, TradeOffSet, path_operators
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.exact import exact_front
from pymoo_gridpath.objectives import Climb, GroundCost, make_objectives
from pymoo_gridpath.quality import hypervolume_ratio
from pymoo_gridpath.representations import CellSequence
from pymoo_gridpath.study import ProblemSpec
from pymoo_gridpath.testing.enumeration import enumerate_paths, non_dominated, random_query
from pymoo_gridpath.testing.objectives import ObjectiveSuite

RNG = np.random.default_rng(7)
ROUGH = RNG.integers(0, 9, (3, 4)).astype(float)


class _OfOneShape(ObjectiveSuite):
    def grids(self):
        return [grid for grid in super().grids() if grid.shape == ROUGH.shape]


class TestGroundByDistance(_OfOneShape):
    objective = GroundCost(ROUGH, weight=0.5)


class TestGroundByEntry(_OfOneShape):
    objective = GroundCost(ROUGH, per="entry", name="tolls", label="Tolls [EUR]")


class TestClimb(_OfOneShape):
    objective = Climb(ROUGH - 3.0)


def slow(path, ground, tolls, heights, blocked):
    """What a path costs, step after step."""
    steps = list(itertools.pairwise(path))
    return {
        "length": sum(math.dist(a, b) for a, b in steps),
        "ground": sum(math.dist(a, b) * (ground[a[1], a[0]] + ground[b[1], b[0]]) / 2 for a, b in steps),
        "tolls": sum(tolls[y, x] for x, y in path),
        "climb": sum(max(heights[b[1], b[0]] - heights[a[1], a[0]], 0.0) for a, b in steps),
        "clearance": -min((math.dist(a, b) for a in path for b in blocked), default=math.inf),
    }


@pytest.mark.parametrize(
    "names", [("length", "ground", "climb"), ("length", "tolls", "climb"), ("ground", "climb", "clearance")]
)
def test_fronts_equal_enumeration(names):
    sizes = []
    for number in range(14):
        rng = np.random.default_rng([number, len(names)])
        grid, start, goal = random_query(rng, 3, 4, 0.6)
        paths = [path.cells for path in enumerate_paths(grid, start, goal)]
        blocked = [(x, y) for y, x in np.argwhere(grid.occupied).tolist()]
        if not blocked or (~grid.occupied).sum() > 12:
            continue
        ground, tolls, heights = (rng.integers(0, 9, grid.shape).astype(float) for _ in range(3))
        # What occupied cells cost is nobody's business.
        ground[grid.occupied] = heights[grid.occupied] = np.nan
        own = {"ground": GroundCost(ground), "tolls": GroundCost(tolls, per="entry", name="tolls"), "climb": Climb(heights)}
        rows = [slow(path, ground, tolls, heights, blocked) for path in paths]
        expected = non_dominated(tuple(round(row[name], 9) for name in names) for row in rows)
        coding = CellSequence(grid, start, goal, max_cells=int((~grid.occupied).sum()))
        found = exact_front(GridPathProblem(grid, start, goal, coding, [own.get(name, name) for name in names]))
        assert found.complete and found.F.shape == expected.shape
        np.testing.assert_allclose(found.F, expected, rtol=1e-9, atol=1e-8)
        sizes.append(len(expected))
    assert len(sizes) >= 6 and max(sizes) >= 2


@pytest.mark.parametrize("seed", range(4))
def test_the_cheapest_path_is_that_of_scikit_image(seed):
    rng = np.random.default_rng(seed)
    cost, occupied = rng.uniform(0.1, 5.0, (20, 30)), rng.random((20, 30)) < 0.2
    occupied[0] = occupied[:, -1] = False
    # Its paths pass corners.
    grid = OccupancyGrid(occupied, corner_cutting=True)
    expected = MCP_Geometric(np.where(occupied, -1.0, cost)).find_costs([(0, 0)])[0][19, 29]
    problem = GridPathProblem(grid, (0, 0), (29, 19), "cells", [GroundCost(cost)])
    assert problem.pareto_front(max_seconds=60)[0, 0] == pytest.approx(expected, rel=1e-9)


def test_a_cost_of_one_by_distance_is_the_length():
    grid = OccupancyGrid(np.zeros((6, 7)))
    both = GridPathProblem(grid, (0, 0), (6, 3), "cells", ["length", GroundCost(np.ones((6, 7)))])
    X = GridPathProblem(grid, (0, 0), (6, 3), "cells").pareto_set()
    F = both.score(both.decode(both.representation.encode(GridPathProblem(grid, (0, 0), (6, 3), "cells").decode(X))))
    np.testing.assert_allclose(F[:, 0], F[:, 1], rtol=1e-12)


def test_up_is_dear_and_down_is_not():
    slope = np.tile(np.arange(6.0), (3, 1))
    grid = OccupancyGrid(np.zeros((3, 6)))
    up = GridPathProblem(grid, (0, 1), (5, 1), "cells", [Climb(slope)]).pareto_front(max_seconds=60)
    down = GridPathProblem(grid, (5, 1), (0, 1), "cells", [Climb(slope)]).pareto_front(max_seconds=60)
    assert (up.tolist(), down.tolist()) == ([[5.0]], [[0.0]])


def test_sets_name_the_cheapest_and_the_flattest_and_searches_find_them():
    rng = np.random.default_rng(3)
    mud = np.where(rng.random((16, 16)) < 0.4, 6.0, 1.0)
    hill = 8.0 * np.exp(-(np.hypot(*(np.indices((16, 16)) - 7.5)) ** 2) / 20)
    problem = GridPathProblem(
        OccupancyGrid(np.zeros((16, 16))), (0, 8), (15, 8), "cells", ["length", GroundCost(mud), Climb(hill)]
    )
    exact = TradeOffSet.from_genes(problem, problem.pareto_set(max_seconds=60))
    assert {"cheapest", "flattest"} < set(exact.named)
    assert exact.measures["ground"][exact.named["cheapest"]] == exact.measures["ground"].min()
    assert exact.measures["climb"][exact.named["flattest"]] == exact.measures["climb"].min()
    assert "ground" in exact.table() and "climb" in exact.table()
    result = minimize(problem, NSGA2(pop_size=60, **path_operators(problem)), ("n_gen", 30), seed=1)
    assert hypervolume_ratio(result.F, problem.pareto_front(max_seconds=60)) > 0.9


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (
            np.full((4, 5), np.nan),
            r"the cost of the objective 'ground' is nan in the free cell \(0, 0\), expected a finite number",
        ),
        (np.full((4, 5), -9999.0), r"is -9999 in the free cell \(0, 0\), expected zero or more, also in cells without data"),
        (np.ones((5, 4)), r"of shape \(5, 4\), expected numbers of shape \(4, 5\)"),
    ],
)
def test_costs_without_data_or_of_another_shape_are_refused(given, message):
    with pytest.raises(GridPathError, match=message):
        GridPathProblem(OccupancyGrid(np.zeros((4, 5))), (0, 0), (4, 3), "cells", ["length", GroundCost(given)])


def test_heights_without_data_are_refused_where_paths_may_go():
    heights = np.zeros((4, 5))
    heights[2, 1] = np.nan
    occupied = np.zeros((4, 5), dtype=bool)
    with pytest.raises(GridPathError, match=r"the elevation of the objective 'climb' is nan in the free cell \(1, 2\)"):
        GridPathProblem(OccupancyGrid(occupied), (0, 0), (4, 3), "cells", [Climb(heights)])
    occupied[2, 1] = True
    assert GridPathProblem(OccupancyGrid(occupied), (0, 0), (4, 3), "cells", [Climb(heights)]).pareto_front().tolist() == [
        [0.0]
    ]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"cost": [1.0, 2.0]}, "cost .* expected numbers of shape"),
        ({"cost": [[]]}, "expected numbers of shape"),
        ({"cost": [[1.0]], "weight": -1}, "weight is -1, expected a number, zero or more"),
        ({"cost": [[1.0]], "per": "metre"}, "per is 'metre', expected one of distance, entry"),
        ({"cost": [[1.0]], "name": 3}, "name is 3, expected a text"),
        ({"cost": "nowhere.npy"}, "nowhere.npy: no such file"),
    ],
)
def test_arguments_that_are_none_are_refused(arguments, message):
    with pytest.raises(GridPathError, match=message):
        GroundCost(**arguments)


def test_by_name_alone_it_says_what_is_missing():
    with pytest.raises(GridPathError, match="the objective 'ground' cannot be made without arguments"):
        make_objectives(["ground"])


def test_studies_take_it_with_its_costs():
    spec = ProblemSpec(
        grid=OccupancyGrid(np.zeros((2, 2))),
        start=(0, 0),
        goal=(1, 1),
        objectives=["length", GroundCost([[1.0, 2.0], [3.0, 4.5]])],
    )
    assert spec.objectives[1] == {"class": "ground", "cost": [[1, 2], [3, 4.5]]}
