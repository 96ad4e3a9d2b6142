"""Shortening by line of sight: against all choices of places, with lines by definition, and against region of sight."""

from __future__ import annotations

import itertools
import math
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lines import is_free, nearest_cells
from pymoo.optimize import minimize
from pymoo.util.display.single import SingleObjectiveOutput

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import AntColony, RegionOfSight
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.problems import ShorteningProblem, far_corners, maze_environment
from pymoo_gridpath.search.sight import farthest_seen, path_length, shorten, visible
from pymoo_gridpath.testing.enumeration import random_query
from pymoo_gridpath.testing.reference import broken_cells, is_legal, length, walk


def random_road(rng, least, most, density=0.4):
    """A grid, and a path on it that makes a detour."""
    while True:
        grid, start, goal = random_query(rng, least, most, density)
        free = np.argwhere(~grid.occupied)
        y, x = free[rng.integers(len(free))].tolist()
        parts = walk(grid, start, (x, y), rng), walk(grid, (x, y), goal, rng)
        if all(parts) and len(parts[0]) + len(parts[1]) > 3:
            return grid, parts[0] + parts[1][1:]


class Slow:
    """The same problem, one pair of cells at a time."""

    def __init__(self, grid, road, radius):
        self.grid, self.road = grid, road
        occupied = grid.grow(radius).occupied.copy()
        for x, y in road:
            occupied[y, x] = False
        # Corners of what has grown may be cut.
        self.grown = OccupancyGrid(occupied, corner_cutting=True)

    def sees(self, a, b):
        if a == b:
            return True
        line = nearest_cells(a, b)
        return all(is_free(grid, a, b) and broken_cells(line, grid) == 0 for grid in (self.grid, self.grown))

    def rate(self, places):
        road, total = self.road, 0.0
        for a, b in itertools.pairwise([0, *sorted(places), len(road) - 1]):
            total += math.dist(road[a], road[b]) if self.sees(road[a], road[b]) else length(road[a : b + 1])
        return total


def test_ratings_and_optimum_are_those_of_all_choices():
    rng, shorter = np.random.default_rng(1), 0
    for number in range(80):
        grid, road = random_road(rng, 3, 8)
        road = road[:10]
        radius, n_points = (0.0, 1.0)[number % 2], min(1 + number % 3, max(len(road) - 2, 1))
        problem, slow = ShorteningProblem(grid, road, radius, n_points), Slow(grid, road, radius)
        places = np.array(list(itertools.combinations_with_replacement(range(len(road)), n_points)))
        ends = np.zeros((len(places), 1), dtype=int)
        X = problem.encode(np.hstack([ends, places, ends + len(road) - 1]))
        expected = [slow.rate(row) for row in places.tolist()]
        np.testing.assert_allclose(problem.evaluate(X)[:, 0], expected, rtol=0, atol=1e-9)
        best, at = problem.pareto_front(), problem.pareto_set()
        assert best.shape == (1, 1) and at.shape == (1, n_points)
        assert best[0, 0] == pytest.approx(min(expected)) and np.array_equal(problem.evaluate(at), best)
        shorter += best[0, 0] < length(road) - 1e-9
        for a, b in itertools.combinations(range(len(road)), 2):
            assert problem.sight[a, b] == slow.sees(road[a], road[b]) and not problem.sight[b, a]
    assert shorter > 40


@settings(max_examples=40)
@given(st.integers(0, 2**32 - 1), st.integers(1, 8), st.sampled_from([0.0, 1.0, 2.0]))
def test_every_row_is_a_legal_path_no_longer_than_its_road(seed, n_points, radius):
    rng = np.random.default_rng(seed)
    grid, road = random_road(rng, 4, 14)
    problem = ShorteningProblem(grid, road, radius, min(n_points, max(len(road) - 2, 1)))
    X = rng.random((20, problem.n_var))
    X[0], X[1], X[2] = 0, 1, X[2, 0]
    F = problem.evaluate(X)[:, 0]
    slow = Slow(grid, road, radius)
    assert (length(road) + 1e-9 >= F).all() and (problem.pareto_front()[0, 0] - 1e-9 <= F).all()
    for x, value in zip(X, F, strict=True):
        cells, waypoints = [tuple(cell) for cell in problem.cells(x).tolist()], problem.waypoints(x)
        assert is_legal(cells, grid, road[0], road[-1]) and broken_cells(cells, slow.grown) == 0
        assert waypoints.length == pytest.approx(value)
        index = waypoints.cells[:, 1] * grid.width + waypoints.cells[:, 0]
        assert visible(problem.moves, index[:-1], index[1:]).all()
        # Alone as among others, to the last bit.
        assert problem.evaluate(x)[0] == value
        places = problem.decode(x[None])
        assert np.array_equal(problem.decode(problem.encode(places)), places)


def test_genes_are_scaled_rounded_sorted_and_ended():
    problem = ShorteningProblem(OccupancyGrid(np.zeros((1, 11))), [(x, 0) for x in range(11)], n_points=4)
    assert (problem.n_var, problem.n_obj, problem.xl.tolist(), problem.xu.tolist()) == (4, 1, [0.0] * 4, [1.0] * 4)
    X = np.array([[0.94, 0.31, 0.06, 0.3], [1.0, 0.0, 0.96, 0.04]])
    assert problem.decode(X).tolist() == [[0, 1, 3, 3, 9, 10], [0, 0, 0, 10, 10, 10]]
    assert problem.evaluate(X)[:, 0].tolist() == [10.0, 10.0]
    assert problem.waypoints(X[0]).cells.tolist() == [[0, 0], [1, 0], [3, 0], [9, 0], [10, 0]]
    assert problem.cells(X[1]).tolist() == [[x, 0] for x in range(11)]


def test_a_piece_out_of_sight_follows_the_road():
    occupied = np.zeros((6, 7))
    occupied[:4, 3] = 1
    road = [(2, 0), (2, 1), (2, 2), (2, 3), (2, 4), (3, 4), (4, 4), (4, 3), (4, 2), (4, 1), (4, 0)]
    problem = ShorteningProblem(OccupancyGrid(occupied), road, n_points=2)
    assert problem.evaluate(np.zeros(2))[0] == 10.0 and problem.cells(np.zeros(2)).tolist() == [list(cell) for cell in road]
    # Two places on one side: the piece around the wall is out of sight, the others are straight.
    assert problem.waypoints(np.array([0.1, 0.2])).cells.tolist() == [list(cell) for cell in road]
    assert problem.waypoints(np.array([0.4, 0.6])).cells.tolist() == [[2, 0], [2, 4], [4, 4], [4, 0]]


def test_region_of_sight_shortens_the_same_road_between_the_same_obstacles():
    pytest.importorskip("skimage")
    for seed in range(4):
        grid = maze_environment(seed)
        planner = RegionOfSight()
        planner.plan(GridPathProblem(grid, *far_corners(grid), representation="cells"))
        found = planner.found
        problem = ShorteningProblem(grid, found.initial[0], found.radius[0], 30)
        moves = problem.moves
        waypoints, _, lengths = shorten(moves, problem.road, 100)
        assert np.array_equal(moves.cells(waypoints), found.waypoints[0].cells)
        assert lengths.tolist() == found.lengths[0].tolist()
        assert problem.travelled[-1] == pytest.approx(path_length(moves, problem.road))
        # Where lines do not cross, its first pass keeps to cells of the road, and so finds nothing better.
        first = farthest_seen(moves, problem.road)
        assert problem.pareto_front()[0, 0] <= path_length(moves, first) + 1e-9
        more = [ShorteningProblem(grid, found.initial[0], found.radius[0], n).pareto_front()[0, 0] for n in (1, 4, 12)]
        assert more == sorted(more, reverse=True) and more[-1] >= problem.pareto_front()[0, 0] - 1e-9


def test_it_pickles_and_leaves_its_road_alone():
    grid, road = random_road(np.random.default_rng(3), 8, 12)
    given_road = np.array(road, dtype=np.int16)
    given_road.flags.writeable = False
    problem = ShorteningProblem(grid, given_road, 1.0, 2)
    X = np.random.default_rng(1).random((5, 2))
    X.flags.writeable = False
    twin = pickle.loads(pickle.dumps(problem))
    assert np.array_equal(twin.evaluate(X), problem.evaluate(X)) and given_road.tolist() == [list(cell) for cell in road]


def test_a_run_shows_how_far_it_is_from_the_optimum(capsys):
    grid, road = random_road(np.random.default_rng(3), 8, 12)
    minimize(ShorteningProblem(grid, road, 0, 2), AntColony(), ("n_gen", 3), seed=1, verbose=True)
    assert "f_gap" in capsys.readouterr().out and SingleObjectiveOutput().columns[0].name == "n_gen"


ROAD = [(0, 0), (1, 0), (2, 1)]


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"grid": None}, "grid is None, expected an OccupancyGrid"),
        ({"road": [(0, 0)]}, "road has 1 cells, expected a path of at least 2 cells"),
        ({"road": "road"}, "road is 'road', expected a path of at least 2 cells"),
        ({"road": [(0.0, 0.0), (1.0, 0.0)]}, "road is .*, expected a path of at least 2 cells"),
        ({"road": [(0, 0), (0, -1)]}, r"road has the cell \(0, -1\), which lies outside the grid"),
        ({"road": [(0, 0), (2, 0)]}, r"road steps from \(0, 0\) to \(2, 0\), which is no legal step"),
        ({"road": [(0, 0), (0, 0)]}, r"road steps from \(0, 0\) to \(0, 0\), which is no legal step"),
        ({"road": [(0, 0), (1, 0), (1, 1)]}, r"road steps from \(1, 0\) to \(1, 1\), which is no legal step"),
        # Past an obstacle, whose corner may not be cut.
        ({"road": [(1, 0), (2, 1)]}, r"road steps from \(1, 0\) to \(2, 1\), which is no legal step"),
        ({"radius": -1}, "radius is -1, expected a number of cells, zero or more"),
        ({"n_points": 0}, "n_points is 0, expected a whole number of at least 1"),
        ({"n_points": 2}, "n_points is 2, expected a whole number of at least 1 and at most 1"),
    ],
)
def test_wrong_arguments_are_refused(given, said):
    grid = OccupancyGrid([[0, 0, 0], [0, 1, 0]])
    with pytest.raises(GridPathError, match=said):
        ShorteningProblem(**{"grid": grid, "road": [(0, 0), (1, 0), (2, 0)], "n_points": 1, **given})


def test_wrong_genes_and_places_are_refused():
    problem = ShorteningProblem(OccupancyGrid(np.zeros((1, 5))), [(x, 0) for x in range(5)], n_points=2)
    for X, said in (
        (np.zeros((1, 3)), r"X is an array of float64 of shape \(1, 3\), expected rows of 2 numbers from 0 to 1"),
        (np.array([[0.5, 1.5]]), "X holds values below 0 or above 1"),
        (np.array([[0.5, np.nan]]), "X holds values that are not finite"),
    ):
        with pytest.raises(GridPathError, match=said):
            problem.decode(X)
    for places in ([[0, 3, 1, 4]], [[1, 1, 1, 4]], [[0, 1, 1, 3]]):
        with pytest.raises(
            GridPathError, match="places hold other numbers, expected rows of 4 whole numbers from 0 to 4, rising"
        ):
            problem.encode(np.array(places))
    with pytest.raises(GridPathError, match="x is an array of float64"):
        problem.waypoints(np.zeros((1, 2)))
