"""Distances from obstacles as they are drawn, against plain geometry of rectangles."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pymoo_gridpath.grid import Box, OccupancyGrid
from pymoo_gridpath.neighbourhood import HEADINGS
from pymoo_gridpath.search.nearest import Nearest
from pymoo_gridpath.search.path_clearance import least_distances


def rectangles(occupied):
    """The squares of occupied cells as (x0, y0, x1, y1)."""
    return [(x - 0.5, y - 0.5, x + 0.5, y + 0.5) for y, x in np.argwhere(occupied).tolist()]


def to_rectangle(px, py, rectangle):
    x0, y0, x1, y1 = rectangle
    return math.hypot(px - min(max(px, x0), x1), py - min(max(py, y0), y1))


def between_segments(a, b, c, d):
    """The distance of two segments that do not cross, from the ends of each to the other."""

    def to_segment(p, q, r):
        along, off = np.subtract(r, q), np.subtract(p, q)
        share = min(max(float(along @ off) / max(float(along @ along), 1e-300), 0.0), 1.0)
        return math.hypot(*(off - share * along))

    return min(to_segment(a, c, d), to_segment(b, c, d), to_segment(c, a, b), to_segment(d, a, b))


def segment_to_rectangle(a, b, rectangle):
    """Exact for a segment of which no point but ends may lie within the rectangle."""
    x0, y0, x1, y1 = rectangle
    corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    sides = min(between_segments(a, b, corners[k], corners[(k + 1) % 4]) for k in range(4))
    return min(sides, to_rectangle(*a, rectangle), to_rectangle(*b, rectangle))


def random_grid(seed, density):
    return OccupancyGrid(np.random.default_rng(seed).random((9, 12)) < density)


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.02, 0.1, 0.4]))
@settings(max_examples=40)
def test_points_against_every_rectangle(seed, density):
    grid, rng = random_grid(seed, density), np.random.default_rng(seed)
    points = np.concatenate([rng.uniform(-0.5, 8.5, (20, 2)), rng.integers(-1, 18, (20, 2)) / 2])
    found = Nearest(grid.occupied).distances(points)
    squares = rectangles(grid.occupied)
    expected = [min((to_rectangle(px, py, one) for one in squares), default=math.inf) for px, py in points.tolist()]
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)


def walk(grid, rng, n):
    """A walk of legal steps from a free cell."""
    free = np.argwhere(~grid.occupied)[:, ::-1]
    cells = [free[rng.integers(len(free))].tolist()]
    while len(cells) < n:
        x, y = cells[-1]
        dx, dy = HEADINGS[rng.integers(8)].tolist()
        if grid.is_free((x + dx, y + dy)) and grid.is_free((x + dx, y)) and grid.is_free((x, y + dy)):
            cells.append([x + dx, y + dy])
        elif rng.random() < 0.1:
            break
    return np.array(cells)


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.05, 0.15, 0.3]))
@settings(max_examples=40)
def test_paths_against_every_rectangle_at_every_point_of_every_step(seed, density):
    grid, rng = random_grid(seed, density), np.random.default_rng(seed)
    paths = [walk(grid, rng, n) for n in (1, 4, 9)]
    squares = rectangles(grid.occupied)
    for found, cells in zip(least_distances(grid.occupied, paths, grid.whole), paths, strict=True):
        steps = list(zip(cells.tolist(), [*cells.tolist()[1:], cells.tolist()[-1]], strict=True))
        expected = min((segment_to_rectangle(a, b, one) for a, b in steps for one in squares), default=math.inf)
        assert found == pytest.approx(expected, rel=1e-12, abs=1e-12)


def test_halfway_along_a_diagonal_may_be_nearer_than_both_ends():
    occupied = np.zeros((6, 6), dtype=bool)
    occupied[0, 3] = True
    path = [np.array([[1, 1], [2, 2]])]
    ends = Nearest(occupied).distances(path[0])
    assert ends == pytest.approx([math.hypot(1.5, 0.5)] * 2)
    assert least_distances(occupied, path, Box(0, 0, 6, 6)) == pytest.approx([math.sqrt(2.0)])


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.01, 0.05, 0.3]))
@settings(max_examples=40)
def test_a_part_of_the_grid_says_the_same(seed, density):
    grid, rng = random_grid(seed, density), np.random.default_rng(seed)
    x0, y0 = rng.integers(0, 6), rng.integers(0, 5)
    paths = [walk(grid, rng, 6) for _ in range(3)]
    part = Box(int(x0), int(y0), int(x0) + 5, int(y0) + 4)
    found = least_distances(grid.occupied, paths, part)
    np.testing.assert_array_equal(found, least_distances(grid.occupied, paths, grid.whole))


def test_nothing_to_come_near_to():
    free, box = np.zeros((3, 4), dtype=bool), Box(0, 0, 4, 3)
    assert least_distances(free, [np.array([[0, 0], [1, 1]])], box).tolist() == [math.inf]
    assert least_distances(free, [], box).tolist() == []
