"""Region of sight: distances to obstacles by brute force, and radii by a search in plain Python."""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import RegionOfSight, make_algorithm
from pymoo_gridpath.cli import main
from pymoo_gridpath.errors import CapabilityError, GridPathError
from pymoo_gridpath.maps import load_map
from pymoo_gridpath.planners import region_of_sight
from pymoo_gridpath.representations import CellSequence
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.sight import visible
from pymoo_gridpath.study import AlgorithmSpec, ProblemSpec, Study, run_study
from pymoo_gridpath.testing import PlannerSuite
from pymoo_gridpath.testing.enumeration import legal_steps, random_query
from pymoo_gridpath.testing.reference import is_legal, length

pytest.importorskip("skimage")


class TestRegionOfSight(PlannerSuite):
    def make(self):
        return RegionOfSight()


class TestWithoutARoad(PlannerSuite):
    def make(self):
        return RegionOfSight(road="shortest")


class TestSweep(PlannerSuite):
    def make(self):
        return RegionOfSight(sweep=True, search="shortest")


def plan(grid, start, goal, **arguments):
    if grid.resolution is None:
        # Radii are in metres, here those of cells of one.
        grid = grid.replace(resolution=1.0)
    problem = GridPathProblem(grid, start, goal, CellSequence(grid, start, goal, max_cells=grid.occupied.size))
    planner = RegionOfSight(**arguments)
    return problem, planner.plan(problem), planner.found


def tuples(cells):
    return [tuple(cell) for cell in cells.tolist()]


def too_near(grid, cell, radius):
    """Whether a disc of so many cells, centred in a cell, overlaps the square of an obstacle."""
    y, x = np.nonzero(grid.occupied)
    apart = (np.maximum(np.abs(part) - 0.5, 0) for part in (x - cell[0], y - cell[1]))
    return bool((np.hypot(*apart) < radius - 1e-9).any())


def joined(grid, start, goal, radius):
    """Whether legal steps lead from a cell to another between cells that are far enough from obstacles."""
    reached, queue = {start}, [start]
    while queue:
        cell = queue.pop()
        for _, after in legal_steps(grid, cell):
            if after not in reached and not too_near(grid, after, radius):
                reached.add(after)
                queue.append(after)
    return goal in reached


@pytest.mark.parametrize("road", ["skeleton", "shortest"])
def test_every_query_that_has_a_path_is_solved_legally_and_keeps_away(road):
    rng, lowered, kept = np.random.default_rng(5), 0, 0
    for number in range(150):
        grid, start, goal = random_query(rng, 3, 40, (0.05, 0.3)[number % 2])
        asked = int(rng.integers(0, 4))
        problem, planned, found = plan(grid, start, goal, radius=asked, road=road)
        assert planned.success and len(planned.paths) == 1
        cells = tuples(problem.decode(planned.paths).cells(0))
        assert is_legal(cells, grid, start, goal) and cells == tuples(found.cells[0])
        waypoints = found.waypoints[0]
        index = waypoints.cells[:, 1] * grid.width + waypoints.cells[:, 0]
        assert visible(Moves(grid), index[:-1], index[1:]).all()
        assert found.lengths[0][-1] == pytest.approx(waypoints.length) and waypoints.length <= length(cells) + 1e-9
        assert found.lengths[0][0] == pytest.approx(length(tuples(found.initial[0])))
        radius = found.radius[0]
        assert radius in range(asked + 1)
        if not too_near(grid, start, radius) and not too_near(grid, goal, radius):
            assert not any(too_near(grid, cell, radius) for cell in cells)
            kept += radius > 0
        if radius < asked and not too_near(grid, start, radius + 1) and not too_near(grid, goal, radius + 1):
            assert not joined(grid, start, goal, radius + 1)
            lowered += 1
    assert lowered > 5 and kept > 20


def test_ways_out_are_shortest_and_the_only_cells_too_near():
    occupied = np.zeros((20, 20))
    occupied[0:20, 0] = occupied[9:11, 6:14] = 1
    grid = OccupancyGrid(occupied)
    _, _, found = plan(grid, (10, 11), (10, 8), radius=3)
    near = [cell for cell in tuples(found.cells[0]) if too_near(grid, cell, 3)]
    # Two cells above the obstacle and two below it are nearer than three.
    assert found.radius[0] == 3 and 0 < len(near) <= 6
    assert {(10, 11), (10, 8)} <= set(near) and {x for x, _ in near} <= set(range(7, 14))


def test_ways_out_as_long_as_a_path_are_none():
    occupied = np.ones((9, 30))
    occupied[4, :24] = 0
    occupied[1:8, 23:30] = 0
    grid = OccupancyGrid(occupied)
    # Along the corridor, away from the only room where two cells can be kept: both would go there and one come back.
    _, planned, found = plan(grid, (2, 4), (9, 4), radius=2)
    assert (
        found.radius.tolist() == [0.0] and planned.message == "found a path at a radius of 0 cells in 2 passes; none at 2 cells"
    )
    assert tuples(found.cells[0]) == [(x, 4) for x in range(2, 10)]
    # Into the room there is but one way out.
    assert plan(grid, (2, 4), (26, 4), radius=2)[2].radius.tolist() == [2.0]


@pytest.mark.parametrize("search", ["best", "shortest"])
def test_passes_never_lengthen_and_end_where_neither_gains(search):
    rng = np.random.default_rng(2)
    for _ in range(60):
        grid, start, goal = random_query(rng, 10, 40, 0.3)
        _, _, found = plan(grid, start, goal, search=search)
        (lengths,) = found.lengths
        assert (np.diff(lengths) <= 1e-9).all() and len(lengths) == found.passes[0] + 1 >= 3
        assert lengths[-1] >= math.dist(start, goal) - 1e-9
        gains = np.diff(lengths) <= -0.1
        assert not gains[-2:].any()
        # No two in a row before the last two are idle.
        assert not (~gains[:-2] & ~gains[1:-1]).any()


def test_passes_can_be_limited():
    grid = load_map("warehouse")
    whole = plan(grid, (2, 3), (57, 36))[2].lengths[0]
    part = plan(grid, (2, 3), (57, 36), max_passes=2)[2]
    assert part.passes.tolist() == [2] and part.lengths[0].tolist() == whole[:3].tolist() and len(whole) > 3


def test_a_straight_way_has_two_waypoints():
    _, planned, found = plan(OccupancyGrid(np.zeros((9, 9))), (1, 4), (7, 4), road="shortest")
    assert tuples(found.waypoints[0].cells) == [(1, 4), (7, 4)] and found.lengths[0].tolist() == [6.0, 6.0, 6.0]
    assert planned.message == "found a path at a radius of 1 cell in 2 passes"
    assert found.clearance.tolist() == [math.inf] and found.curvature.tolist() == [[0.0, 0.0]]


def test_without_a_road_and_growth_the_path_begins_as_a_shortest_one():
    rng = np.random.default_rng(4)
    for _ in range(60):
        grid, start, goal = random_query(rng, 3, 30, 0.4)
        found = plan(grid, start, goal, radius=0, road="shortest")[2]
        assert found.lengths[0][0] == pytest.approx(grid.shortest_length(start, goal))
        assert found.lengths[0][0] <= plan(grid, start, goal, radius=0)[2].lengths[0][0] + 1e-9


def test_the_road_lies_midway_and_the_edge_of_the_map_counts():
    grid = OccupancyGrid(np.zeros((11, 41)))
    found = plan(grid, (0, 2), (40, 8), radius=0)[2]
    middle = [y for x, y in tuples(found.initial[0]) if 10 <= x <= 30]
    assert set(middle) == {5}
    best, shortest = (plan(load_map("warehouse"), (2, 3), (57, 36), search=s)[2].lengths[0][0] for s in ("best", "shortest"))
    assert shortest < best


def test_a_road_that_does_not_join_is_left_and_said(monkeypatch):
    monkeypatch.setattr(region_of_sight, "_skeletonize", lambda: np.zeros_like)
    _, planned, found = plan(load_map("office"), (3, 4), (56, 35))
    assert found.fallback.tolist() == [True] and planned.success
    assert planned.message.endswith("; 1 of 1 path not by the road")


def test_a_radius_without_a_path_is_lowered_and_said():
    occupied = np.zeros((15, 15))
    occupied[:, 7] = 1
    occupied[7, 7] = 0
    grid = OccupancyGrid(occupied, resolution=0.5)
    _, planned, found = plan(grid, (2, 7), (12, 7), radius=1.25)
    assert found.radius.tolist() == [0.0]
    assert planned.message == "found a path at a radius of 0 cells in 2 passes; none at 2.5 cells"
    occupied[5:10, 7] = 0
    # Half a cell from the middle of the gap lies its edge: two more are two and a half cells.
    assert plan(grid.replace(occupied=occupied), (2, 7), (12, 7), radius=1.25)[2].radius.tolist() == [2.5]


def test_the_default_radius_is_a_hundredth_of_the_shorter_side():
    for shape, cells in (((40, 60), 1.0), ((230, 200), 2.0), ((201, 300), 3.0)):
        assert plan(OccupancyGrid(np.zeros(shape), resolution=0.1), (0, 0), (5, 5), road="shortest")[2].radius[0] == cells


def test_a_sweep_returns_a_path_for_each_radius():
    grid = load_map("warehouse")
    problem = GridPathProblem(grid, (2, 3), (57, 36))
    result = minimize(problem, RegionOfSight(sweep=True))
    found = result.algorithm.found
    assert found.radius.tolist() == [0.0, 1.0, 2.0] and result.message == "found 3 paths at radii up to 2 cells"
    assert (np.diff(found.clearance) > 0).all() and (np.diff(result.pop.get("F")[:, 1]) < 0).all()
    for k, radius in enumerate(found.radius):
        alone = plan(grid, (2, 3), (57, 36), radius=radius * grid.resolution)[2]
        assert tuples(alone.cells[0]) == tuples(found.cells[k]) and alone.clearance == found.clearance[k]
    assert minimize(GridPathProblem(OccupancyGrid(np.zeros((9, 9))), (0, 0), (8, 3)), RegionOfSight(sweep=True)).success


def test_scikit_image_is_asked_for_where_it_is_needed_alone(monkeypatch):
    monkeypatch.setitem(sys.modules, "skimage.morphology", None)
    with pytest.raises(CapabilityError, match=r"scikit-image.* pip install 'pymoo_gridpath\[planners\]', or give road='short"):
        RegionOfSight()
    assert plan(load_map("office"), (3, 4), (56, 35), road="shortest")[1].success


def test_codings_that_cannot_turn_back_are_refused():
    problem = GridPathProblem(OccupancyGrid(np.zeros((5, 5))), (0, 0), (4, 4), "integer")
    with pytest.raises(CapabilityError, match="RegionOfSight plans paths that may turn back"):
        make_algorithm("ros", problem)


def test_paths_without_room_give_way_to_shorter_ones():
    grid, ends = load_map("warehouse"), ((2, 3), (57, 36))
    long, short = plan(grid, *ends, radius=0)[2], plan(grid, *ends, radius=0, road="shortest")[2]
    n = len(short.cells[0])
    assert len(plan(grid, *ends)[2].cells[0]) > n
    problem = GridPathProblem(grid, *ends, CellSequence(grid, *ends, max_cells=n))
    result = minimize(problem, RegionOfSight())
    assert result.success and result.algorithm.found.radius.tolist() == [0.0] and len(result.algorithm.found.cells[0]) <= n
    assert "; none at 1 cell" in result.message
    assert result.algorithm.found.fallback.tolist() == [len(long.cells[0]) > n]


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"radius": -1}, "radius is -1, expected a number of metres, zero or more"),
        ({"radius": math.inf}, "radius is inf, expected a number of metres"),
        ({"radius": 0.0, "sweep": True}, "radius is 0.0, expected None: sweep=True takes one radius after another"),
        ({"road": "voronoi"}, "road is 'voronoi', expected one of skeleton, shortest"),
        ({"search": "greedy"}, "search is 'greedy', expected one of best, shortest"),
        ({"sweep": 1}, "sweep is 1, expected True or False"),
        ({"max_passes": 0}, "max_passes is 0, expected a whole number of at least 1"),
        ({"raduis": 1}, "RegionOfSight takes no argument 'raduis'; did you mean 'radius'"),
    ],
)
def test_wrong_arguments_are_refused(given, said):
    with pytest.raises(GridPathError, match=said):
        RegionOfSight(**given)


def test_it_works_by_name(tmp_path, capsys):
    problem = GridPathProblem(load_map("office"), (3, 4), (56, 35))
    assert minimize(problem, make_algorithm("RoS", problem, search="shortest")).success
    assert main(["plan", "office", "--algorithm", "ros", "-o", str(tmp_path / "plan")]) == 0
    assert "shortest" in capsys.readouterr().out
    study = Study(
        problems=[ProblemSpec(name="one", map="paper16", representation="cells")],
        algorithms=[AlgorithmSpec(algorithm="ros", parameters={"sweep": True}), AlgorithmSpec(algorithm="NSGA2", pop_size=10)],
        seeds=2,
        budget={"generations": 2},
    )
    outcome = run_study(study, tmp_path / "study")
    assert (outcome.n_failed, outcome.n_run) == (0, 4)
