"""Ways to roads against scipy's shortest paths, and torn diagonal steps by hand."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csgraph

from pymoo_gridpath import OccupancyGrid
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.road import way_to, with_legal_steps
from pymoo_gridpath.testing.enumeration import RULES
from pymoo_gridpath.testing.reference import broken_cells, length


def tuples(moves, index):
    return [tuple(cell) for cell in moves.cells(index).tolist()]


@pytest.mark.parametrize("steps", RULES, ids=str)
def test_ways_are_shortest_to_the_nearest_wanted_cell(steps):
    rng, none = np.random.default_rng(8), 0
    for _ in range(80):
        grid = OccupancyGrid(rng.random((12, 15)) < 0.4, **steps)
        wanted = (rng.random(180) < 0.02) & ~grid.occupied.ravel()
        start = int(rng.choice(np.flatnonzero(~grid.occupied.ravel())))
        far = csgraph.dijkstra(grid.move_graph(), indices=start)
        least = far[wanted].min(initial=np.inf)
        moves = Moves(grid)
        way = way_to(moves, start, wanted)
        if np.isinf(least):
            assert len(way) == 0
            none += 1
            continue
        assert way[0] == start and wanted[way[-1]] and not wanted[way[:-1]].any()
        assert broken_cells(tuples(moves, way), grid) == 0
        assert length(tuples(moves, way)) == pytest.approx(least)
        # Of cells that are equally near the one with the least index.
        assert way[-1] == np.flatnonzero(wanted & (far <= least + 1e-9))[0]
    assert 0 < none < 80


def test_a_road_is_led_around_corners_that_may_not_be_cut():
    occupied = np.zeros((4, 4), dtype=bool)
    occupied[0, 1] = occupied[3, 2] = True
    road = np.zeros((4, 4), dtype=bool)
    # Up to the right past the first, then up to the left past the second.
    road[[0, 1, 2, 3], [0, 1, 2, 1]] = True
    road[2, 3] = road[3, 3] = True
    wider = with_legal_steps(Moves(OccupancyGrid(occupied)), road.ravel()).reshape(4, 4)
    assert np.argwhere(wider & ~road).tolist() == [[1, 0], [2, 1]]
    assert np.array_equal(with_legal_steps(Moves(OccupancyGrid(occupied, corner_cutting=True)), road.ravel()), road.ravel())


def test_a_step_between_two_obstacles_stays_torn():
    moves = Moves(OccupancyGrid([[0, 1, 0], [1, 0, 0]]))
    road = np.array([1, 0, 0, 0, 1, 0], dtype=bool)
    assert np.array_equal(with_legal_steps(moves, road), road)
