"""Maps of the kinds of Hliwa and Atieh: sizes, numbers of obstacles, their shapes, and a path between the far corners."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import ndimage
from scipy.spatial import ConvexHull

from pymoo_gridpath.errors import GridError
from pymoo_gridpath.problems import concave_environment, convex_environment, far_corners, maze_environment

ALL = (convex_environment, concave_environment, maze_environment)


def obstacles(grid):
    """Share of the area of its convex hull, corners of cells included, that each obstacle fills."""
    labels, n = ndimage.label(grid.occupied, np.ones((3, 3)))
    shares = []
    for k in range(1, n + 1):
        y, x = np.nonzero(labels == k)
        corners = np.concatenate([np.stack([x + dx, y + dy], axis=1) for dx in (0, 1) for dy in (0, 1)])
        shares.append(len(x) / ConvexHull(corners).volume)
    return shares


@pytest.mark.parametrize("make", ALL)
def test_the_same_seed_gives_the_same_map_and_a_path_leads_across(make):
    for seed in range(8):
        grid = make(seed)
        assert np.array_equal(grid.occupied, make(np.random.default_rng(seed)).occupied)
        assert not np.array_equal(grid.occupied, make(seed + 1).occupied)
        start, goal = far_corners(grid)
        # Also for who keeps the paper's distance, 1 % of the shorter side.
        wide = grid.grow(np.ceil(0.01 * min(grid.shape)))
        assert wide.check_query(start, goal) == (start, goal)
        assert not grid.corner_cutting


def test_sizes_and_corners():
    assert [make(0).shape for make in ALL] == [(500, 500), (400, 400), (200, 230)]
    assert far_corners(convex_environment(0)) == ((10, 10), (489, 489))
    assert far_corners(maze_environment(0)) == ((5, 4), (224, 195))


def test_obstacles_are_as_many_and_as_convex_as_they_should_be():
    for seed in range(5):
        convex, concave = obstacles(convex_environment(seed)), obstacles(concave_environment(seed))
        assert len(convex) == 9 and min(convex) > 0.95
        assert len(concave) == 16 and max(concave) < 0.9


def test_rooms_of_a_maze_are_all_joined():
    for seed in range(5):
        grid = maze_environment(seed)
        assert len(np.unique(grid.regions[~grid.occupied])) == 1
        start, goal = far_corners(grid)
        assert grid.shortest_length(start, goal) > 250


def test_what_is_no_seed_is_refused():
    for make in ALL:
        with pytest.raises(GridError, match=r"random_state is 'one', expected a seed or a numpy.random.Generator"):
            make("one")
