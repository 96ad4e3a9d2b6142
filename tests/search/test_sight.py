"""Line of sight against geometry with fractions, cell by cell."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lines import is_free, nearest_cells

from pymoo_gridpath import OccupancyGrid
from pymoo_gridpath.representations import make_representation
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.sight import (
    along,
    chain_is_legal,
    digital_line,
    farthest_seen,
    line_is_free,
    shorten,
    smoothed,
    visible,
)
from pymoo_gridpath.search.waypoints import Waypoints
from pymoo_gridpath.testing.enumeration import RULES
from pymoo_gridpath.testing.reference import broken_cells, is_legal, walk


@st.composite
def grids(draw):
    shape = draw(st.integers(1, 9)), draw(st.integers(1, 9))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    return OccupancyGrid(rng.random(shape) < draw(st.sampled_from([0.1, 0.3])), **draw(st.sampled_from(RULES))), rng


@settings(max_examples=30)
@given(grids())
def test_both_tests_are_what_they_say(grid_and_rng):
    grid, _ = grid_and_rng
    moves = Moves(grid)
    free = [(int(x), int(y)) for y, x in np.argwhere(~grid.occupied)]
    for a in free:
        for b in free[:: max(1, len(free) // 12)]:
            ends = moves.index(a), moves.index(b)
            line = moves.cells(digital_line(moves, *ends)).tolist()
            assert line == ([list(cell) for cell in nearest_cells(a, b)] if a != b else [list(a)])
            expected = is_free(grid, a, b), broken_cells([tuple(cell) for cell in line], grid) == 0
            found = (
                line_is_free(moves.legal, moves.offsets, moves.width, *ends),
                chain_is_legal(moves.legal, moves.width, *ends),
            )
            assert (bool(found[0]), bool(found[1])) == expected
            assert visible(moves, np.array(ends[:1]), np.array(ends[1:])).tolist() == [all(expected)]
            # The line has no direction, its digital line has.
            assert line_is_free(moves.legal, moves.offsets, moves.width, *ends[::-1]) == expected[0]


def test_a_free_line_may_have_a_digital_line_that_cuts_a_corner():
    large = OccupancyGrid(np.random.default_rng(1).random((20, 20)) < 0.2, corner_cutting=False)
    moves = Moves(large)
    cells = np.flatnonzero(~large.occupied.ravel())
    ends = np.array(np.meshgrid(cells, cells)).reshape(2, -1).T
    lines = [line_is_free(moves.legal, moves.offsets, 20, *pair) for pair in ends]
    assert sum(lines) > visible(moves, *ends.T).sum() > 0.5 * sum(lines)
    cutting = large.replace(corner_cutting=True)
    moves = Moves(cutting)
    assert visible(moves, *ends.T).sum() == sum(line_is_free(moves.legal, moves.offsets, 20, *pair) for pair in ends)


@settings(max_examples=100)
@given(grids())
def test_shortened_paths_are_legal_see_on_and_are_no_longer(grid_and_rng):
    grid, rng = grid_and_rng
    free = np.argwhere(~grid.occupied)[:, ::-1]
    if len(free) < 2:
        return
    start, goal = (tuple(int(v) for v in cell) for cell in free[rng.choice(len(free), 2, replace=False)])
    cells = walk(grid, start, goal, rng)
    if cells is None:
        return
    moves = Moves(grid)
    path = np.array([moves.index(cell) for cell in cells])
    kept = farthest_seen(moves, path)
    assert visible(moves, kept[:-1], kept[1:]).all()
    again = [tuple(cell) for cell in moves.cells(along(moves.width, kept)).tolist()]
    assert is_legal(again, grid, start, goal) or len(set(again)) < len(again)
    assert broken_cells(again, grid) == 0 and again[0] == start and again[-1] == goal
    # Each jump is to the last cell that is seen.
    place = [list(path).index(cell) for cell in kept]
    for i, j in pairwise(place):
        assert not visible(moves, np.full(len(path) - 1 - j, path[i]), path[j + 1 :]).any()

    def octile(line):
        return sum(math.dist(a, b) for a, b in pairwise(line))

    waypoints = Waypoints(grid, moves.cells(kept))
    assert waypoints.length <= octile(again) + 1e-9 <= octile(cells) + 2e-9


@settings(max_examples=100)
@given(grids())
def test_backward_passes_lead_from_the_start_to_the_goal_all_the_same(grid_and_rng):
    grid, rng = grid_and_rng
    free = np.argwhere(~grid.occupied)[:, ::-1]
    if len(free) < 2:
        return
    start, goal = (tuple(int(v) for v in cell) for cell in free[rng.choice(len(free), 2, replace=False)])
    cells = walk(grid, start, goal, rng)
    if cells is None:
        return
    moves = Moves(grid)
    path = np.array([moves.index(cell) for cell in cells])
    for waypoints, again in (smoothed(moves, path, backward=True), shorten(moves, path, 9)[:2]):
        assert visible(moves, waypoints[:-1], waypoints[1:]).all()
        assert is_legal([tuple(cell) for cell in moves.cells(again).tolist()], grid, start, goal)
        assert set(waypoints) <= set(again)
    waypoints, again = smoothed(moves, path, backward=True)
    if set(waypoints) <= set(path) and len(along(moves.width, waypoints)) == len(again):
        place = [list(path).index(cell) for cell in waypoints]
        for i, j in pairwise(place):
            # Each is the first that sees the next.
            assert not visible(moves, path[:i], np.full(i, path[j])).any()


def test_curvature_is_that_of_a_circle_and_none_of_a_straight_line():
    angles = np.linspace(0, 2, 4000)
    grid = OccupancyGrid(np.zeros((5, 5)), resolution=0.1)
    circle = 40.0 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    assert Waypoints(grid, circle).curvature == pytest.approx((0.25, 0.25), rel=1e-3)
    assert Waypoints(grid, np.array([[0, 0], [4, 2]])).curvature == pytest.approx((0.0, 0.0), abs=1e-9)
    # A right angle between two pieces of a cell: the circle through its ends has the diagonal for its diameter.
    assert Waypoints(grid, np.array([[0, 0], [1, 0], [1, 1]])).curvature == pytest.approx((10 * math.sqrt(2),) * 2)


def test_waypoints_are_in_cells_and_in_metres():
    grid = OccupancyGrid(np.zeros((5, 5)), resolution=0.5, origin=(10.0, -2.0, 0.0))
    waypoints = Waypoints(grid, np.array([[0, 0], [3, 4], [4, 4]]))
    assert waypoints.length == 6.0 and waypoints.length_m == 3.0
    assert waypoints.points.tolist() == [[10.25, -1.75], [11.75, 0.25], [12.25, 0.25]]
    in_cells = Waypoints(OccupancyGrid(np.zeros((5, 5))), waypoints.cells)
    assert in_cells.length == 6.0 and in_cells.points.tolist() == waypoints.cells.tolist()


def test_lines_keep_to_the_headings_of_the_steps():
    grid = OccupancyGrid(np.zeros((6, 6)))
    moves = make_representation("integer", grid, (0, 0), (5, 5), "x").moves
    cells = np.array([0, 35, 3])
    assert visible(moves, cells, np.array([35, 0, 33])).tolist() == [True, False, True]


@pytest.mark.parametrize("pair", [(0, 11), (3, 8), (5, 5)])
def test_kernels_give_the_same_uncompiled(pair):
    moves = Moves(OccupancyGrid([[0, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 0]]))
    for kernel, arguments in (
        (line_is_free, (moves.legal, moves.offsets, moves.width, *pair)),
        (chain_is_legal, (moves.legal, moves.width, *pair)),
    ):
        assert getattr(kernel, "py_func", kernel)(*arguments) == kernel(*arguments)
