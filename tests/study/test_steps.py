"""Studies on grids of four moves, and of corners that may be cut on one side."""

import csv

import numpy as np
import pytest

from pymoo_gridpath.errors import StudyError
from pymoo_gridpath.exact import exact_front
from pymoo_gridpath.study import Store, Study, plan_study, run_study, write_report
from pymoo_gridpath.study.planning.build import build_problem

STEPS = [{"moves": 4}, {"corner_cutting": "one side"}]


def study(steps, *algorithms):
    return Study(
        problems=[
            {"name": "map", "map": "paper16", "representation": "cells", **steps},
            {"name": "random", "random": {"size": 8, "p0": 0.1, "seeds": 1, **steps}},
        ],
        algorithms=[{"algorithm": name, "name": name} for name in algorithms],
        seeds=1,
        budget={"generations": 3},
    )


@pytest.mark.parametrize("steps", STEPS, ids=str)
def test_a_study_runs_and_reports_with_other_steps(tmp_path, steps):
    outcome = run_study(study(steps, "NSGA2", "exact"), tmp_path / "study")
    assert outcome.n_failed == 0
    plan = Store(tmp_path / "study").read_plan()
    problems = [build_problem(task.problem, task.grid) for task in map(plan.task, plan.runs)]
    assert all(problem.grid == problem.grid.replace(**steps) for problem in problems)
    written = write_report(tmp_path / "study", formats="png")
    (file,) = (path for path in written if path.name == "problems.csv")
    rows = list(csv.DictReader(file.read_text().splitlines()))
    corners = {"one side"} if "corner_cutting" in steps else {"true"}
    assert {row["moves"] for row in rows} == {str(steps.get("moves", 8))} and {row["corner_cutting"] for row in rows} == corners
    for row, problem in zip(rows, {problem.grid.digest: problem for problem in problems}.values(), strict=True):
        assert int(row["reference_points"]) == len(np.unique(exact_front(problem).F, axis=0))


def test_a_planner_of_diagonal_steps_is_refused_where_there_are_none():
    with pytest.raises(
        StudyError, match=r"QuadrantSelection plans by diagonal steps, and the grid .* has none; give it moves=8"
    ):
        plan_study(study({"moves": 4}, "qsa"))


@pytest.mark.parametrize(
    ("steps", "message"),
    [
        ({"moves": 6}, "moves is 6, expected 4 or 8"),
        ({"corner_cutting": "two"}, "corner_cutting is 'two', expected True, False or 'one side'"),
    ],
)
def test_other_steps_are_refused(steps, message):
    with pytest.raises(StudyError, match=message):
        study(steps, "NSGA2")
