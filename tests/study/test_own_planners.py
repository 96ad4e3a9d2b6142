"""Planners of one's own in studies, by their path or the name that they are registered by, and on the command line."""

from __future__ import annotations

import importlib
import json
import subprocess
import sys
from importlib.metadata import EntryPoint

import pytest

from pymoo_gridpath.algorithms import ALGORITHMS
from pymoo_gridpath.cli.main import main
from pymoo_gridpath.errors import GridPathError, StudyError
from pymoo_gridpath.planners import PLANNERS
from pymoo_gridpath.study import LocalProcesses, Store, Study, plan_study, run_study, write_report
from pymoo_gridpath.study.planning.build import build_algorithm, build_problem
from pymoo_gridpath.study.planning.estimate import estimate

MODULE = """
from pymoo.algorithms.moo.nsga2 import NSGA2
import pymoo_gridpath.algorithms
from pymoo_gridpath.exact import exact_front
from pymoo_gridpath.planners import Plan, Planner
from pymoo_gridpath.registry import register

@register
class Scout(Planner):
    name = "scout"
    deterministic = False
    made = []
    def __init__(self, reach=2, mood="calm", max_seconds=None, **kwargs):
        super().__init__(**kwargs)
        self.reach, self.mood, self.max_seconds = reach, mood, max_seconds
        Scout.made.append(self)
    def plan(self, problem):
        found = exact_front(problem)
        kept = found.X[self.random_state.permutation(len(found.X))[:self.reach]]
        return Plan(kept, message=f"reached {self.reach}, {self.mood}")

@register
class Crowd(Planner):
    name = "crowd"
    takes_pop_size = takes_operators = True
    def __init__(self, pop_size=7, operators=None, **kwargs):
        super().__init__(**kwargs)
        self.pop_size, self.operators = pop_size, operators
    def plan(self, problem):
        return Plan(self.operators["sampling"]._do(problem, self.pop_size, random_state=self.random_state)
                    if self.operators else exact_front(problem).X, message="drew")

@register
class Herd(NSGA2):
    pass
"""


@pytest.fixture
def scouts(tmp_path, monkeypatch):
    (tmp_path / "scouts.py").write_text(MODULE)
    monkeypatch.syspath_prepend(str(tmp_path))
    for registry in (PLANNERS, ALGORITHMS):
        monkeypatch.setattr(registry, "_known", dict(registry._known))
        monkeypatch.setattr(registry, "_names", dict(registry._names))
    sys.modules.pop("scouts", None)
    yield importlib.import_module("scouts")
    sys.modules.pop("scouts", None)


def planned(algorithms, **others):
    data = {
        "problems": [{"random": {"size": 8, "p0": 0.2}, "representation": "cells"}],
        "algorithms": algorithms,
        "seeds": 2,
        "budget": {"generations": 2},
        "reference": False,
    }
    return plan_study(Study.from_dict(data | others))


def built(plan, k=0):
    task = plan.task(plan.runs[k])
    return build_algorithm(task.algorithm, build_problem(task.problem, task.grid))


def test_a_planner_is_given_the_arguments_of_its_constructor(scouts):
    table = {"algorithm": "scouts:Scout", "parameters": {"reach": 1, "mood": "bold"}, "max_seconds": 3}
    plan = planned([table])
    made = built(plan)
    assert (type(made), made.reach, made.mood, made.max_seconds) == (scouts.Scout, 1, "bold", 3.0)
    # It draws, so that there is a run for each seed, and none of them depends on the budget of the study.
    assert len(plan.runs) == 2 and plan.task(plan.runs[0]).budget is None
    keys = [run.key for run in plan.runs]
    assert [run.key for run in planned([table], budget={"evaluations": 99}).runs] == keys
    # However it is named, it is the same.
    for name in ("scout", "Scout", scouts.Scout):
        assert [run.key for run in planned([{**table, "algorithm": name}]).runs] == keys
    inside = {"algorithm": "scout", "parameters": {"reach": 1, "mood": "bold", "max_seconds": 3.0}}
    assert [run.key for run in planned([inside]).runs] == keys
    assert not set(keys) & {run.key for run in planned([{**table, "parameters": {"reach": 1}}]).runs}


def test_tables_call_it_by_its_registered_name_and_keys_do_not_depend_on_that(scouts, monkeypatch):
    tables = [{"algorithm": "scouts:Scout"}, {"algorithm": scouts.Herd, "pop_size": 6}, {"algorithm": scouts.Crowd(pop_size=3)}]
    plan = planned(tables)
    assert [one.label for one in plan.algorithms] == ["scout", "Herd", "crowd"]
    for registry in (PLANNERS, ALGORITHMS):
        monkeypatch.setattr(registry, "_known", {})
        monkeypatch.setattr(registry, "_names", {})
    unknown = planned(tables)
    assert [one.label for one in unknown.algorithms] == ["Scout", "Herd", "Crowd"]
    assert [run.key for run in unknown.runs] == [run.key for run in plan.runs]
    points = {"pathfinder": EntryPoint("pathfinder", "scouts:Scout", "x")}
    monkeypatch.setattr(PLANNERS, "_entry_points", points)
    assert planned(tables).algorithms[0].label == "pathfinder"
    assert planned([{**tables[0], "name": "mine"}]).algorithms[0].label == "mine"


def test_a_planner_is_given_a_population_and_operators_if_it_says_so(scouts):
    plan = planned([{"algorithm": "crowd", "pop_size": 5, "operators": "random"}])
    made = built(plan)
    assert made.pop_size == 5 and type(made.operators["sampling"]).__name__ == "ReachableSampling"
    assert len(plan.runs) == 1
    with pytest.raises(StudyError, match="takes no pop_size, only max_seconds and parameters"):
        planned([{"algorithm": "scout", "pop_size": 5}])


def test_a_planner_of_this_package_takes_more_than_its_budget():
    plan = planned([{"algorithm": "exact", "parameters": {"max_memory": 50_000_000}}])
    assert built(plan).budget.max_memory == 50_000_000
    # What is at its default is left out.
    plain, same = (planned([{"algorithm": "exact"} | more]) for more in ({}, {"parameters": {}}))
    assert [run.key for run in plain.runs] == [run.key for run in same.runs] != [run.key for run in plan.runs]


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"algorithm": "scout", "parameters": {"reech": 1}}, "did you mean 'reach'"),
        ({"algorithm": "scout", "parameters": {"seed": 1}}, "seed is set by the seeds of the study"),
        ({"algorithm": "scout", "parameters": {"callback": 1}}, "callback is an object of Python"),
        ({"algorithm": "scout", "max_seconds": 2, "parameters": {"max_seconds": 1}}, "expected it once"),
        ({"algorithm": "scout", "max_labels": 2}, "takes no max_labels, only max_seconds and parameters"),
        ({"algorithm": "exact", "parameters": {"max_memry": 1}}, "did you mean 'max_memory'"),
        ({"algorithm": "exact", "parameters": {"max_seconds": 1}}, "set by the key max_seconds of the algorithm"),
        ({"algorithm": "exact", "parameters": {"watch": 1}}, "watch is an object of Python"),
        ({"algorithm": "exact", "parameters": {"max_memory": "much"}}, "max_memory is 'much'"),
        ({"algorithm": "scot"}, "did you mean 'scout'"),
    ],
)
def test_wrong_arguments_are_refused_in_a_sentence(scouts, table, message):
    with pytest.raises(StudyError) as error:
        planned([table])
    assert message in str(error.value) and "\n" not in str(error.value)


def test_a_study_with_planners_runs_in_processes_that_have_registered_nothing(scouts, tmp_path):
    algorithms = [{"algorithm": "scout", "parameters": {"reach": 1}}, {"algorithm": "herd", "pop_size": 10}]
    plan = planned(algorithms, reference=True)
    assert estimate(plan).n_measured > 0
    with LocalProcesses(1) as executor:
        outcome = run_study(plan, tmp_path / "out", executor)
    assert (outcome.n_run, outcome.n_failed) == (5, 0)
    store = Store(tmp_path / "out")
    records = [store.read(run.key) for run in store.read_plan().runs]
    assert sorted(record.message for record in records if record.message.startswith("reached")) == ["reached 1, calm"] * 2
    write_report(tmp_path / "out", formats=["svg"])
    assert "reach 1" in (tmp_path / "out" / "report" / "report.md").read_text()


def test_a_stored_plan_makes_nobody_import_by_a_registered_name(scouts, tmp_path):
    store = Store(tmp_path / "out")
    store.write_plan(planned([{"algorithm": "scout"}]))
    file = tmp_path / "out" / "plan.json"
    data = json.loads(file.read_text())
    assert data["algorithms"][0]["spec"]["algorithm"]["planner"] is True
    data["algorithms"][0]["spec"]["algorithm"] = "scout"
    file.write_text(json.dumps(data))
    with pytest.raises(GridPathError, match="there is no algorithm 'scout'"):
        store.read_plan()


def test_no_second_process_finds_a_planner_of_a_script(scouts, tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "from scouts import Scout\nfrom pymoo_gridpath.registry import register\n"
        "from pymoo_gridpath.study.specification.algorithm import AlgorithmSpec\n"
        "@register\nclass Local(Scout):\n    name = 'local'\n"
        "try:\n    AlgorithmSpec(algorithm='local')\nexcept Exception as error:\n    print(error)\n"
    )
    out = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=True, cwd=tmp_path).stdout
    assert "which no other process can import" in out


def test_the_command_line_gives_a_planner_what_it_has_options_for(scouts, tmp_path, capsys):
    command = ["plan", "warehouse", "--algorithm", "scout", "-o", str(tmp_path / "out")]
    assert main([*command, "--max-seconds", "20", "--runs", "2"]) == 0
    assert [scout.max_seconds for scout in scouts.Scout.made] and all(one.max_seconds == 20.0 for one in scouts.Scout.made)
    assert main([*command, "--pop-size", "20"]) == 2
    assert "--pop-size is not for --algorithm scout" in capsys.readouterr().err
