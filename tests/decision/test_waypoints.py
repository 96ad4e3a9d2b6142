"""Waypoints of the members of a set: which have some, and what the set and its files know of it."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from trade_offs import make_problem

from pymoo_gridpath import GridPathProblem, OccupancyGrid, load_json
from pymoo_gridpath.decision import PathRecord, TradeOffSet
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.problems import TimedPathProblem


def test_each_member_has_some_and_a_stored_set_has_the_same(tmp_path):
    occupied = np.zeros((14, 20), dtype=bool)
    occupied[4:11, 7:9] = occupied[0:6, 13] = True
    problem = GridPathProblem(OccupancyGrid(occupied, 0.2, (3.0, -1.0, 0.4)).inflate(0.15), (1, 1), (18, 12))
    found = TradeOffSet.from_genes(problem, problem.pareto_set(max_seconds=60))
    stored = load_json(found.to_json(tmp_path / "paths.json"))
    for one, same in zip(found, stored, strict=True):
        made, again = one.waypoints(spacing=0.3), same.waypoints(spacing=0.3)
        np.testing.assert_array_equal(made.points, again.points)
        assert made.clearance_m == again.clearance_m and str(made) == str(again)
        np.testing.assert_array_equal(made.before.points, one.points)
        assert made.before.clearance_m.least == pytest.approx(one.clearance_m, abs=1e-9)
        assert made.before.length == pytest.approx(one.length) and made.before.turn == pytest.approx(one.turn)
        assert made.length <= one.length + 1e-9
        assert "smoother" not in one.as_dict()
    again = pickle.loads(pickle.dumps(found))
    np.testing.assert_array_equal(again.knee.waypoints().cells, found.knee.waypoints().cells)


def test_who_has_none(trade_off):
    with pytest.raises(GridPathError, match="the path is of no set and knows no map, expected a member of a TradeOffSet"):
        PathRecord(**trade_off.knee.as_dict()).waypoints()
    problem = make_problem(6, 3)
    rows = np.random.default_rng(1).integers(problem.xl, problem.xu + 1, (60, problem.n_var))
    crossing = TradeOffSet.from_genes(problem, rows[problem.decode(rows).interfering_cells > 1])
    with pytest.raises(GridPathError, match=r"path 0 crosses \d+ occupied cells, expected a legal path to drive along"):
        crossing[0].waypoints()


def test_paths_in_time_are_driven_as_they_are():
    problem = TimedPathProblem(OccupancyGrid(np.zeros((4, 6))), (0, 0), (5, 3), movers=[[(2, 3), (2, 2), (2, 1)]], horizon=9)
    found = TradeOffSet.from_genes(problem, problem.pareto_set(max_seconds=60))
    for one in found:
        np.testing.assert_array_equal(one.waypoints().cells, one.cells)
    with pytest.raises(GridPathError, match="tolerance is not for a path in time"):
        found[0].waypoints(tolerance=1.0)
