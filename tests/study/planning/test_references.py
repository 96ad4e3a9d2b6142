"""Exact fronts that a study measures against: none is looked for that cannot be had, and that is said."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from pymoo_gridpath.algorithms import make_algorithm
from pymoo_gridpath.cli import main
from pymoo_gridpath.errors import CapabilityError, StudyError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.objectives import Objective
from pymoo_gridpath.problems import GridPathProblem
from pymoo_gridpath.study import ProblemSpec, Study, plan_study
from pymoo_gridpath.study.planning.plan import Plan

FOUR = ["length", "vulnerability", "turn", "integer_length"]


class Rough(Objective):
    """A rule of its own, of which no exact front is known."""

    name, label = "rough", "Rough"

    def __call__(self, paths, prepared):
        return paths.length**2


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"objectives": FOUR}, "the problem has 4 objectives, expected at most 3"),
        ({"objectives": ["length", Rough]}, "the objective 'rough' has no field, costs of moves or turn_cost"),
        ({"representation": "sugihara-smith"}, "the sugihara-smith representation does not code every path"),
    ],
)
def test_no_run_looks_for_an_exact_front_that_cannot_be_had(changes, why):
    room, other = (OccupancyGrid(np.zeros((5, 5)), corner_cutting=True, name=name) for name in ("room", "hall"))
    ends = {"start": (0, 0), "goal": (4, 4)}
    study = Study(
        problems=[ProblemSpec(grid=room, **ends, **changes), ProblemSpec(grid=other, **ends, objectives=["length", "turn"])],
        algorithms=[{"algorithm": "NSGA2", "pop_size": 6}],
        seeds=2,
        budget={"generations": 1},
    )
    plan = plan_study(study)
    first, second = plan.problems
    assert first.reference is None and why in first.no_reference and "\n" not in first.no_reference
    assert second.no_reference == ""
    assert [(run.problem, run.key) for run in plan.runs if run.algorithm is None] == [(1, second.reference)]
    assert len(plan.runs) == 5
    again = Plan.from_json(json.loads(json.dumps(plan.to_json())))
    assert (again.runs, again.problems[0].no_reference) == (plan.runs, first.no_reference)
    # Asked for as an algorithm, it is refused with the same words.
    study = dataclasses.replace(study, algorithms=[*study.algorithms, {"algorithm": "exact"}])
    with pytest.raises(StudyError, match=f"'exact' does not suit the problem 'room': {why}"):
        plan_study(study)


def test_a_plan_of_before_says_nothing_of_fronts_that_cannot_be_had():
    plan = plan_study(
        Study(
            problems=[{"random": {"size": 6, "p0": 0.1}}],
            algorithms=[{"algorithm": "NSGA2", "pop_size": 6}],
            seeds=1,
            budget={"generations": 1},
        )
    )
    data = json.loads(json.dumps(plan.to_json()))
    assert data["problems"][0].pop("no_reference") == ""
    assert Plan.from_json(data).runs == plan.runs
    data["problems"][0]["no_reference"] = 3
    with pytest.raises(StudyError, match="no_reference is 3, expected a text"):
        Plan.from_json(data)


def test_check_and_report_say_why(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    query = f"random = {{ size = 6, p0 = 0.1, seeds = 2 }}\nobjectives = {FOUR}"
    (tmp_path / "many.toml").write_text(
        f'seeds = 1\nbudget = {{ generations = 1 }}\n[[problems]]\n{query}\n[[algorithms]]\nalgorithm = "NSGA2"\npop_size = 6\n'
    )
    assert main(["study", "check", "many.toml"]) == 0
    said = capsys.readouterr().out.splitlines()
    why = "the problem has 4 objectives, expected at most 3 for an exact front"
    assert "runs: 2" in said
    assert f"no exact front of random-6-0.1/1 and 1 other problem: {why}; the merged front of all runs stands in" in said
    assert main(["study", "run", "many.toml"]) == 0
    assert "2 run now, 0 before, 0 failed" in capsys.readouterr().out
    assert main(["study", "report", "many-results"]) == 0
    page = (tmp_path / "many-results" / "report" / "report.md").read_text(encoding="utf-8")
    assert page.count("No exact front is at hand for 2 of 2 problems") == 1 and "failed" not in page.split("## ")[0]
    assert page.count(f"| {why} |") == 2


def test_the_exact_planner_refuses_before_it_runs():
    grid = OccupancyGrid(np.zeros((4, 4)))
    problem = GridPathProblem(grid, (0, 0), (3, 3), objectives=FOUR)
    with pytest.raises(CapabilityError, match="4 objectives, expected at most 3"):
        make_algorithm("exact", problem)
