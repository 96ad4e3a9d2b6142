from __future__ import annotations

import heapq
import itertools
import math

import numpy as np
import pytest

from pymoo_gridpath.errors import MapError
from pymoo_gridpath.fields import clearance, obstacle_potential
from pymoo_gridpath.maps import load_map, load_shipped, shipped_maps

SHIPPED = shipped_maps()


def monotone_path(grid, start, goal, toll):
    """Return the cells of the path that never goes left with the least length + toll[y, x] per cell entered, or None."""
    cost, before, queue = {start: 0.0}, {}, [(0.0, start)]
    while queue:
        so_far, cell = heapq.heappop(queue)
        if cell == goal:
            path = [goal]
            while path[-1] != start:
                path.append(before[path[-1]])
            return path[::-1]
        if so_far > cost[cell]:
            continue
        x, y = cell
        for dx, dy in ((0, 1), (0, -1), (1, 0), (1, 1), (1, -1)):
            sides = grid.corner_cutting or (grid.is_free((x + dx, y)) and grid.is_free((x, y + dy)))
            step = (x + dx, y + dy)
            if grid.is_free(step) and sides:
                total = so_far + math.hypot(dx, dy) + toll[step[1], step[0]]
                if total < cost.get(step, math.inf):
                    cost[step], before[step] = total, cell
                    heapq.heappush(queue, (total, step))
    return None


def length(path) -> float:
    return sum(math.dist(a, b) for a, b in itertools.pairwise(path))


def test_the_list():
    assert [item.name for item in SHIPPED] == ["office", "paper16", "warehouse"]
    assert all(item.title and item.path.is_file() for item in SHIPPED)


@pytest.mark.parametrize(
    ("name", "width", "height", "resolution", "corner_cutting"),
    [("warehouse", 60, 40, 0.5, False), ("office", 60, 40, 0.25, False), ("paper16", 16, 16, None, True)],
)
def test_what_they_are(name, width, height, resolution, corner_cutting):
    grid = load_shipped(name)
    assert (grid.name, grid.width, grid.height, grid.resolution) == (name, width, height, resolution)
    assert grid.corner_cutting is corner_cutting
    assert load_map(name) == grid
    assert load_shipped(name, corner_cutting=not corner_cutting).corner_cutting is not corner_cutting


def test_the_scenario_like_the_papers():
    item = next(item for item in SHIPPED if item.name == "paper16")
    assert (item.start, item.goal) == ((0, 0), (15, 15))
    assert 0.1 < load_shipped("paper16").occupied.mean() < 0.3


@pytest.mark.parametrize("item", SHIPPED, ids=lambda item: item.name)
def test_every_free_cell_can_be_reached(item):
    grid = load_shipped(item.name)
    assert np.isfinite(grid.shortest_lengths(item.start)[~grid.occupied]).all()


@pytest.mark.parametrize("item", SHIPPED, ids=lambda item: item.name)
def test_the_query_has_a_monotone_path_for_the_point_and_for_the_robot(item):
    assert item.start[0] < item.goal[0]
    for grid in (load_shipped(item.name), load_shipped(item.name).inflate(item.radius)):
        path = monotone_path(grid, item.start, item.goal, np.zeros(grid.shape))
        assert path is not None
        columns = [x for x, _ in path]
        assert columns == sorted(columns) and set(columns) == set(range(item.start[0], item.goal[0] + 1))


@pytest.mark.parametrize("item", SHIPPED, ids=lambda item: item.name)
def test_short_routes_pass_close_and_safe_routes_are_longer(item):
    grid = load_shipped(item.name)
    potential, room = obstacle_potential(grid, variance=0.5), clearance(grid)
    routes = [monotone_path(grid, item.start, item.goal, weight * potential) for weight in (1e-6, 1, 10, 1e3)]
    routes = [path for path in routes if path is not None]
    assert len(routes) == 4
    lengths = [length(path) for path in routes]
    dangers = [float(sum(potential[y, x] for x, y in path)) for path in routes]
    assert lengths[-1] > 1.1 * lengths[0] and dangers[-1] < 0.6 * dangers[0]
    # Several routes of which none is better in both.
    trade_offs = {(round(a, 6), round(b, 6)) for a, b in zip(lengths, dangers, strict=True)}
    assert len(trade_offs) >= 3
    assert not any(p != q and p[0] <= q[0] and p[1] <= q[1] for p in trade_offs for q in trade_offs)
    # And they are different ways: most cells of the safest are not near the shortest one's.
    shortest = np.array(routes[0])
    apart = [np.abs(shortest - cell).max(axis=1).min() for cell in routes[-1]]
    assert max(apart) >= 3
    assert np.mean([room[y, x] for x, y in routes[-1]]) > np.mean([room[y, x] for x, y in routes[0]])


def test_no_such_map():
    with pytest.raises(MapError, match=r"did you mean 'office'.* office, paper16, warehouse"):
        load_shipped("offices")
