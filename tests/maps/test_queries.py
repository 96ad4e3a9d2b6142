"""Queries in metres: which cells they mean, and what is said of those that mean none."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.errors import GridError, UnreachableError
from pymoo_gridpath.maps.queries import query_in_metres
from pymoo_gridpath.problems import MovingObstaclesProblem, TimedPathProblem

WALLED = np.zeros((8, 12), dtype=bool)
WALLED[:, 6] = True
HALL = OccupancyGrid(WALLED, 0.5, (-3.0, -2.0), name="hall")


def turned(point, yaw, origin=(0.0, 0.0)):
    x, y = point
    return origin[0] + math.cos(yaw) * x - math.sin(yaw) * y, origin[1] + math.sin(yaw) * x + math.cos(yaw) * y


@given(st.floats(-4, 4), st.tuples(st.floats(-9, 9), st.floats(-9, 9)), st.integers(0, 2**32 - 1))
@settings(max_examples=40)
def test_a_point_means_the_cell_that_holds_it_however_the_map_is_turned(yaw, origin, seed):
    grid = OccupancyGrid(np.zeros((5, 7)), 0.4, (*origin, yaw))
    rng = np.random.default_rng(seed)
    cells = rng.permutation(35)[:2]
    cells = [(int(k % 7), int(k // 7)) for k in cells]
    points = [turned(0.4 * (np.array(cell) + rng.uniform(0.01, 0.99, 2)), yaw, origin) for cell in cells]
    assert query_in_metres(grid, *points) == tuple(cells)
    problem = GridPathProblem.from_metres(grid, *points, objectives=["length"], obstacles="constraint")
    assert (problem.start, problem.goal, problem.obstacles) == (*cells, "constraint")


def test_kinds_of_problems_take_metres_too():
    grid = HALL.crop(HALL.whole._replace(x1=6))
    moving = MovingObstaclesProblem.from_metres(grid, (-2.8, -1.8), (-0.3, 1.8), movers=[[(3, 3)]])
    timed = TimedPathProblem.from_metres(grid, (-2.8, -1.8), (-0.3, 1.8), movers=[[(3, 3)]], horizon=12)
    for problem in (moving, timed):
        assert (problem.start, problem.goal) == ((0, 0), (5, 7)) and type(problem) is not GridPathProblem


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=40)
def test_a_tolerance_takes_the_nearest_cell_that_can_be_reached(seed):
    rng = np.random.default_rng(seed)
    grid = OccupancyGrid(rng.random((7, 9)) < 0.4, 0.5, (-1.0, 2.0, 0.4))
    free = np.argwhere(~grid.occupied)
    y, x = free[rng.integers(len(free))].tolist()
    start, goal = grid.to_metres((x, y)), np.array(turned(rng.uniform(-1, 6, 2), 0.4, (-1.0, 2.0)))
    lengths = grid.shortest_lengths((x, y))
    reached = [(cx, cy) for cy, cx in np.argwhere(np.isfinite(lengths)).tolist()]
    away = {cell: math.dist(grid.to_metres(cell), goal) for cell in reached}
    least = min(away.values())
    inside = tuple(grid.to_cells(goal).tolist())
    found = query_in_metres(grid, start, goal, goal_tolerance=least + 1e-6)
    assert found[0] == (x, y) and away[found[1]] == pytest.approx(least)
    if inside in away:
        assert query_in_metres(grid, start, goal) == ((x, y), inside)
    else:
        with pytest.raises(GridError, match=r"^(no place within the tolerance of|goal) .* m (of the goal|cannot|lies)"):
            query_in_metres(grid, start, goal, goal_tolerance=0.0 if seed % 2 else least * 0.99)


@pytest.mark.parametrize(
    ("start", "goal", "options", "message"),
    [
        (
            (4, 0),
            (0.2, 0),
            {},
            r"^start \(4, 0\) m lies outside the map 'hall', which covers x from -3 to 3 m and y from -2 to 2 m; the nearest "
            r"place to take is \(2\.75, -0\.25\) m, 1\.27 m away$",
        ),
        ((0.2, 0), (1, 1), {}, r"^start \(0\.2, 0\) m lies on an obstacle of the map 'hall'; the nearest place to take is \("),
        (
            (-2, 0),
            (0.2, 0),
            {},
            r"^goal \(0\.2, 0\) m lies on an obstacle of the map 'hall'; the nearest place to take is \(-0\.25, ",
        ),
        (
            (-2, 0),
            (2, 0),
            {},
            r"^goal \(2, 0\) m cannot be reached from start \(-2, 0\) m on the map 'hall': obstacles separate them; "
            r"of all places the nearest that can is \(-0\.25, -0\.25\) m, 2\.26 m away$",
        ),
        (
            (-2, 0),
            (2, 0),
            {"goal_tolerance": 1},
            r"^no place within the tolerance of 1 m of the goal \(2, 0\) m can be reached from start \(-2, 0\) m; the nearest",
        ),
        ((-2, 0), (2, 0), {"goal_tolerance": -1}, "^goal_tolerance is -1, expected a number of metres, zero or more$"),
        ((-2, math.nan), (2, 0), {}, r"^start holds values that are not finite, expected a point \(x, y\) in metres$"),
        ((-2, 0), (2, 0, 0), {}, r"^goal is .*, expected a point \(x, y\) in metres$"),
        ("here", (2, 0), {}, r"^start is 'here', expected a point \(x, y\) in metres$"),
        (
            (-2, 0),
            (-1.9, 0.1),
            {},
            r"^start \(-2, 0\) m and goal \(-1\.9, 0\.1\) m lie in the same cell, expected two different ones$",
        ),
        ((1e300, 0), (2, 0), {}, "^points lie further away than cells can be counted"),
    ],
)
def test_what_is_no_query_is_said_in_metres(start, goal, options, message):
    with pytest.raises(GridError, match=message) as said:
        GridPathProblem.from_metres(HALL, start, goal, **options)
    assert isinstance(said.value, UnreachableError) == ("can be reached from" in message or "cannot" in message)


def test_where_the_robot_does_not_fit_it_is_said_why():
    grid = OccupancyGrid(WALLED, 0.5, (-3.0, -2.0, 0.5), name="hall")
    near = tuple(grid.to_metres((5, 3)))
    for grown, why in (
        (grid.inflate(0.4), "the robot's radius of 0.4 m allows"),
        (grid.inflate(footprint=[(0.3, 0), (-0.2, 0.1), (-0.2, -0.1)]), "the robot's footprint, which reaches 0.3 m allows"),
    ):
        with pytest.raises(GridError, match=f"is nearer to an obstacle of the map 'hall' than {why}; the nearest place"):
            query_in_metres(grown, near, tuple(grid.to_metres((0, 0))))
        assert query_in_metres(grown, grid.to_metres((0, 0)), near, 0.6) == ((0, 0), (4, 3))
    with pytest.raises(GridError, match=r"lies outside the map 'hall', which has its corners at \(-3, -2\) m, \(2\.265"):
        query_in_metres(grid, (9, 9), near)
    with pytest.raises(GridError, match="there is no free place"):
        query_in_metres(grid.replace(occupied=np.ones((8, 12))), near, near)
