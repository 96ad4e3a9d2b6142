"""The room between a robot on its way and the obstacles that there really are."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pymoo_gridpath import GridPathProblem, OccupancyGrid, TradeOffSet
from pymoo_gridpath.decision import load_json
from pymoo_gridpath.errors import GridError

RESOLUTION = 0.05


def room_of(cells, occupied, radius):
    """The least distance of a robot's disc from a square, sampled densely on its way, in metres."""
    a, b = cells[:-1, None], cells[1:, None]
    share = np.linspace(0.0, 1.0, 21)[None, :, None]
    points = (a + (b - a) * share).reshape(-1, 1, 2)
    low = np.argwhere(occupied)[None, :, ::-1] - 0.5
    nearest = np.clip(points, low, low + 1.0)
    return np.hypot(*np.moveaxis(points - nearest, 2, 0)).min() * RESOLUTION - radius


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.04, 0.06, 0.11]), st.booleans())
@settings(max_examples=25)
def test_it_is_that_of_the_original_and_no_path_touches_it(seed, radius, corner_cutting):
    occupied = np.random.default_rng(seed).random((12, 14)) < 0.06
    grid = OccupancyGrid(occupied, RESOLUTION, (3.0, -1.0, 0.7), corner_cutting).inflate(radius)
    try:
        problem = GridPathProblem(grid, (0, 0), (13, 11), "cells")
    except GridError:
        return
    rows = problem.representation.repair(np.random.default_rng(seed).integers(0, grid.occupied.size, (6, problem.n_var)), None)
    found = TradeOffSet.from_genes(problem, rows)
    for record in found:
        expected = room_of(record.cells, occupied, radius) if occupied.any() else math.inf
        assert record.clearance_m == pytest.approx(expected, abs=1e-9)
        assert record.clearance_m == found.measures["clearance_m"][record.index]
        assert corner_cutting or record.clearance_m >= 0.0


def test_cells_count_by_their_edges_and_metres_by_the_robot():
    """A corridor: cells of 5 cm, walls two cells from the middle, where centres are 0.15 m apart and edges 0.125 m."""
    occupied = np.zeros((7, 20), dtype=bool)
    occupied[0] = occupied[6] = True
    grid = OccupancyGrid(occupied, RESOLUTION).inflate(0.1)
    record = TradeOffSet.from_genes(*straight(grid)).shortest
    assert record.clearance == 1.0 and record.clearance_m == 0.025
    assert TradeOffSet.from_genes(*straight(OccupancyGrid(occupied, RESOLUTION))).shortest.clearance_m == 0.125


def straight(grid):
    problem = GridPathProblem(grid, (0, 3), (19, 3))
    return problem, problem.pareto_set(max_seconds=60)


def test_a_large_map_of_which_little_is_reached_knows_all_obstacles():
    """The wall that keeps the robot in stands further off than the part that is searched."""
    occupied = np.zeros((300, 300), dtype=bool)
    occupied[[100, 130], 100:131] = occupied[100:131, [100, 130]] = True
    grid = OccupancyGrid(occupied, RESOLUTION).inflate(0.3)
    problem = GridPathProblem(grid, (108, 108), (121, 122))
    assert problem.representation.box != grid.whole
    found = TradeOffSet.from_genes(problem, problem.pareto_set(max_seconds=60))
    for record in found:
        assert record.clearance_m == pytest.approx(room_of(record.cells, occupied, 0.3), abs=1e-9)


def test_files_and_tables_have_it(tmp_path):
    occupied = np.zeros((7, 20), dtype=bool)
    occupied[0, 4] = True
    found = TradeOffSet.from_genes(*straight(OccupancyGrid(occupied, RESOLUTION).inflate(0.1)))
    again = load_json(found.to_json(tmp_path / "paths.json"))
    assert again[0].clearance_m == found[0].clearance_m == 0.025
    assert "clearance_m" in found.to_csv(tmp_path / "paths.csv").read_text().splitlines()[0]
    assert "clearance [m]" in found.table()
    empty = TradeOffSet.from_genes(*straight(OccupancyGrid(np.zeros((7, 20)), RESOLUTION).inflate(0.1)))
    assert empty[0].clearance_m == math.inf
