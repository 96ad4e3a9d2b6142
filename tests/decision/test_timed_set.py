"""Trade-off sets of paths in time: named, measured, drawn, exported and merged."""

from __future__ import annotations

import json

import numpy as np
import pytest
from matplotlib import pyplot as plt
from pymoo.optimize import minimize

from pymoo_gridpath import OccupancyGrid, TradeOffSet, make_algorithm, plot_front, plot_paths
from pymoo_gridpath.decision import NAMES, load_json
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.problems import TimedPathProblem
from pymoo_gridpath.testing.timed import place

WAYS = [[(x, 2) for x in range(7, -1, -1)], [(3, y) for y in range(5)], [(-1, 0), (-2, 0)]]


@pytest.fixture(scope="module")
def problem():
    occupied = np.zeros((5, 8), dtype=bool)
    occupied[2, 4] = True
    occupied[1, 1] = True
    return TimedPathProblem(OccupancyGrid(occupied, resolution=0.5), (0, 2), (7, 4), [*WAYS[1:], [(7, 1), (7, 0)]], 14)


@pytest.fixture(scope="module")
def trade_off(problem):
    return TradeOffSet.from_results(minimize(problem, make_algorithm("exact", problem)))


def test_paths_go_by_their_names(problem, trade_off):
    np.testing.assert_array_equal(trade_off.F, problem.pareto_front())
    assert trade_off.objective_names == ["arrival", "length", "vulnerability"]
    assert list(trade_off.named) == ["earliest", *NAMES]
    assert trade_off.earliest.objectives["arrival"] == trade_off.F[:, 0].min()
    assert trade_off.shortest.length == trade_off.F[:, 1].min() and trade_off.safest.vulnerability == trade_off.F[:, 2].min()
    assert trade_off.advice == "" and "where nothing moves has length" in trade_off.table()
    for record in trade_off:
        # A cell for each tick.
        assert len(record.cells) == record.objectives["arrival"] + 1 and record.interfering_cells == 0


def test_the_clearance_knows_of_obstacles_that_move(problem, trade_off):
    for record in trade_off:
        walls = np.argwhere(problem.grid.occupied)[:, ::-1]
        near = []
        for tick, cell in enumerate(record.cells):
            movers = [place(way, tick) for way in (WAYS[1], [(7, 1), (7, 0)])]
            near.append(np.hypot(*(np.concatenate([walls, movers]) - cell).T).min())
        assert record.clearance == pytest.approx(min(near))


def test_other_sets_have_no_earliest():
    from pymoo_gridpath import GridPathProblem

    still = GridPathProblem(OccupancyGrid(np.zeros((4, 4))), (0, 0), (3, 3), "cells")
    made = TradeOffSet.from_genes(still, still.pareto_set())
    assert tuple(made.named) == NAMES
    with pytest.raises(GridPathError, match="there is no path 'earliest', expected one of shortest, safest"):
        _ = made.earliest


def test_they_are_drawn_with_who_moves(trade_off):
    ax = plot_paths(trade_off, units="cells")
    labels = [line.get_label() for line in ax.lines]
    assert "earliest" in labels[0] and "obstacles that move" in labels
    there = next(line for line in ax.lines if line.get_label() == "obstacles that move")
    ticks = int(trade_off.F[:, 0].max()) + 1
    np.testing.assert_array_equal(np.array(there.get_xydata()), [place(WAYS[1], tick) for tick in range(ticks)])
    beyond = ax.lines[ax.lines.index(there) + 1]
    assert np.isnan(np.array(beyond.get_xydata())).all()
    metres = next(line for line in plot_paths(trade_off).lines if line.get_label() == "obstacles that move")
    np.testing.assert_allclose(np.array(metres.get_xydata()), 0.5 * np.array(there.get_xydata()) + 0.25)
    assert plot_front(trade_off).name == "3d"
    plt.close("all")


def test_files_hold_the_cell_at_each_tick_and_who_moves(problem, trade_off, tmp_path):
    path = trade_off.to_json(tmp_path / "set.json")
    with pytest.raises(GridPathError, match=r"among obstacles that move, .* as load_json\(path, problem\)"):
        load_json(path)
    same = load_json(path, problem)
    assert same.table() == trade_off.table() and same.meta == trade_off.meta
    content = json.loads(path.read_text())
    assert content["paths"][0]["cells"] == trade_off[0].cells.tolist()
    assert content["settings"]["movers"][0][:3] == [[3, 0], [3, 1], [3, 2]]
    again = TradeOffSet.from_genes(problem, [record["genes"] for record in content["paths"]])
    np.testing.assert_array_equal(again.F, trade_off.F)
    assert trade_off.to_csv(tmp_path / "set.csv").read_text().splitlines()[0].endswith("arrival")


def test_runs_among_other_obstacles_are_not_merged(problem):
    other = TimedPathProblem(problem.grid, problem.start, problem.goal, WAYS[:1], problem.horizon)
    runs = [minimize(one, make_algorithm("NSGA2", one, 8), ("n_gen", 2), seed=1) for one in (problem, other)]
    with pytest.raises(GridPathError, match=r"Results 0 and 1 differ in the settings \(movers\)"):
        TradeOffSet.from_results(runs)
    assert len(TradeOffSet.from_results([runs[0], runs[0]]))


def test_illegal_paths_are_never_called_legal(problem):
    row = problem.pareto_set()[:1].copy()
    row[0, 1:-1] = row[0, 0]
    made = TradeOffSet.from_genes(problem, row)
    assert not made.feasible and made.infeasibility.startswith("no path is legal")
