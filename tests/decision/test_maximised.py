"""What is maximised is held as its negative, and shown as it is: in tables, files, figures, pages and reports."""

from __future__ import annotations

import csv
import json

import matplotlib.pyplot as plt
import numpy as np
import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid, TradeOffSet, load_json, path_operators
from pymoo_gridpath.cli import main
from pymoo_gridpath.explorer.data import page_data
from pymoo_gridpath.objectives import Objective
from pymoo_gridpath.plotting import plot_front, save_figures
from pymoo_gridpath.quality import hypervolume_ratio
from pymoo_gridpath.study import AlgorithmSpec, ProblemSpec, Study, plan_study, run_study, write_report
from pymoo_gridpath.study.planning.plan import Plan

WALL = np.zeros((12, 15), dtype=bool)
WALL[:4, 7] = True
WALL[8:, 3] = True


class Light(Objective):
    """How dark it gets on the way, at the darkest."""

    name, label, combine, maximise, best = "light", "Light [lx]", "least", True, "brightest"

    def field(self, grid):
        return 1.0 + np.indices(grid.shape)[0]


def problem_of(*objectives):
    return GridPathProblem(
        OccupancyGrid(WALL, 0.5, name="hall"), (0, 0), (14, 0), "cells", objectives or ("length", "clearance")
    )


@pytest.fixture(scope="module")
def wide():
    problem = problem_of()
    return TradeOffSet.from_genes(problem, problem.pareto_set(max_seconds=60))


def test_the_set_holds_the_negative_and_measures_the_distance(wide):
    assert (wide.F[:, 1] < 0).all() and len(wide) >= 3
    np.testing.assert_array_equal(wide.measures["clearance"], -wide.F[:, 1])
    assert list(wide.named) == ["shortest", "safest", "smoothest", "widest", "knee"]
    assert wide["widest"].clearance == wide.measures["clearance"].max()
    assert wide["widest"].objectives["clearance"] == -wide["widest"].clearance


def test_an_objective_of_ones_own_has_its_own_name_for_its_best_path():
    problem = problem_of("length", Light())
    paths = TradeOffSet.from_genes(problem, problem.pareto_set(max_seconds=60))
    assert paths.measures["light"].max() == paths["brightest"].clearance * 0 - paths.F[:, 1].min()
    assert "brightest" in paths.table() and "-" not in paths.table().splitlines()[2].replace("  ", "")
    both = problem_of("vulnerability", "turn")
    assert list(TradeOffSet.from_genes(both, both.pareto_set(max_seconds=60)).named) == [
        "shortest",
        "safest",
        "smoothest",
        "knee",
    ]


def test_files_show_the_distance(wide, tmp_path):
    rows = list(csv.DictReader(wide.to_csv(tmp_path / "a.csv").open()))
    assert [float(row["clearance"]) for row in rows] == wide.measures["clearance"].tolist()
    document = json.loads(wide.to_json(tmp_path / "a.json").read_text())
    assert document["maximised"] == ["clearance"] and document["best"]["clearance"] == "widest"
    again = load_json(tmp_path / "a.json")
    np.testing.assert_array_equal(again.F, wide.F)
    np.testing.assert_array_equal(again.problem.score(again.paths), wide.F)
    assert again.named == wide.named and again.table() == wide.table()


def test_a_stored_objective_of_ones_own_is_still_maximised(tmp_path):
    problem = problem_of("length", Light())
    paths = TradeOffSet.from_genes(problem, problem.pareto_set(max_seconds=60))
    again = load_json(paths.to_json(tmp_path / "a.json"))
    assert again.named == paths.named
    np.testing.assert_array_equal(again.measures["light"], paths.measures["light"])


def shown_numbers(axis):
    low, high = sorted(axis.get_view_interval())
    return [
        (place, float(text.get_text().replace("\u2212", "-")))
        for place, text in zip(axis.get_majorticklocs(), axis.get_ticklabels(), strict=True)
        if low <= place <= high
    ]


@pytest.mark.parametrize("objectives", [("length", "clearance"), ("length", "vulnerability", "clearance")])
def test_figures_show_the_distance(objectives, tmp_path):
    problem = problem_of(*objectives)
    paths = TradeOffSet.from_genes(problem, problem.pareto_set(max_seconds=60))
    ax = plot_front(paths)
    ax.figure.canvas.draw()
    axis = ax.yaxis if len(objectives) == 2 else ax.zaxis
    assert axis.get_label_text() == "Least clearance [m], more is better"
    ticks = shown_numbers(axis)
    assert len(ticks) >= 2 and all(number == pytest.approx(-place) for place, number in ticks)
    assert ax.get_xlabel() == "Path length [m]"
    if len(objectives) == 3:
        bar = plot_front(paths, objectives=objectives[:2]).figure.axes[-1]
        assert bar.get_ylabel() == "Least clearance [m]" and min(bar.get_ylim()) > 0
        assert save_figures(paths, tmp_path, formats=["png"])
    plt.close("all")


def test_pages_know_what_is_maximised(wide):
    columns = {column["key"]: column for column in page_data(wide, "hall")["columns"]}
    assert columns["clearance"]["maximise"] and not columns["length"]["maximise"]
    assert columns["clearance"]["values"] == pytest.approx((wide.measures["clearance"] * 0.5).tolist())
    assert wide._repr_html_().count("widest") == 1


def test_searches_find_what_is_wide():
    for objectives in (("length", "clearance"), ("length", "vulnerability", "clearance")):
        problem = problem_of(*objectives)
        result = minimize(problem, NSGA2(pop_size=40, **path_operators(problem)), ("n_gen", 25), seed=1)
        assert hypervolume_ratio(result.F, problem.pareto_front(max_seconds=60)) > 0.95


@pytest.mark.usefixtures("undrawn")
def test_the_command_line_plans_by_it(tmp_path, capsys):
    (tmp_path / "room.txt").write_text("\n".join("".join(".#"[int(cell)] for cell in row) for row in WALL[::-1]) + "\n")
    arguments = [
        "plan",
        tmp_path / "room.txt",
        "--start",
        "0,0",
        "--goal",
        "14,0",
        "--algorithm",
        "exact",
        "-o",
        tmp_path / "out",
    ]
    assert main([*map(str, arguments), "--objectives", "length,clearance"]) == 0
    assert "widest" in capsys.readouterr().out
    assert main([*map(str, arguments), "--objectives", "clearance"]) == 0


def test_studies_run_and_report_it(tmp_path):
    study = Study(
        problems=[
            ProblemSpec(name="hall", grid=OccupancyGrid(WALL), start=(0, 0), goal=(14, 0), objectives=["length", "clearance"])
        ],
        algorithms=[
            AlgorithmSpec(name="nsga2", algorithm="NSGA2", pop_size=12),
            AlgorithmSpec(name="spea2", algorithm="SPEA2", pop_size=12),
        ],
        seeds=2,
        budget={"generations": 3},
    )
    plan = plan_study(study)
    run_study(plan, tmp_path / "study")
    assert write_report(tmp_path / "study")
    assert isinstance(plan, Plan)
