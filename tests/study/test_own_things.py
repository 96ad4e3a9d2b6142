"""Objectives, representations, operators and algorithms of one's own in studies."""

from __future__ import annotations

import dataclasses
import importlib
import json
import pickle
import subprocess
import sys
from importlib.metadata import EntryPoint

import numpy as np
import pytest
from pymoo.algorithms.moo.moead import MOEAD
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.optimize import minimize

from pymoo_gridpath.algorithms import make_algorithm, reference_directions
from pymoo_gridpath.convergence import ConvergenceRecorder
from pymoo_gridpath.errors import GridPathError, StudyError
from pymoo_gridpath.objectives import Vulnerability
from pymoo_gridpath.operators import OPERATORS, DiscreteSBX, RankAndSmoothness, paper_operators, path_operators
from pymoo_gridpath.operators.parameters import number
from pymoo_gridpath.planners import ExactFront
from pymoo_gridpath.problems import GridPathProblem, random_dense_grid
from pymoo_gridpath.representations import CellSequence, IntegerRepresentation
from pymoo_gridpath.study import LocalProcesses, Store, Study, load_study, plan_study, run_study, write_report
from pymoo_gridpath.study.planning import build
from pymoo_gridpath.study.planning.build import build_algorithm, build_problem
from pymoo_gridpath.study.running.record import from_bytes
from pymoo_gridpath.study.specification.own import code_of

MODULE = """
import os
import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo_gridpath.objectives import Objective
from pymoo_gridpath.operators import DiscreteSBX
from pymoo_gridpath.representations import IntegerRepresentation

class Hilly(Objective):
    name = "hilly"
    label = "Height passed [m]"
    def __init__(self, slope=1.0):
        self.slope = slope
    def field(self, grid):
        return self.slope * np.add.outer(np.zeros(grid.height), np.arange(grid.width) % 3.0)

class Mine(IntegerRepresentation):
    name = "mine"

class Sbx(DiscreteSBX):
    def __init__(self, eta=7.0, **kwargs):
        super().__init__(eta=eta, **kwargs)

class Greedy(NSGA2):
    def __init__(self, pop_size=100, strength=1.0, **kwargs):
        self.strength = strength
        super().__init__(pop_size=pop_size, **kwargs)

class Once(NSGA2):
    deterministic = True

class Hidden(Objective):
    name = "hidden"
    def __init__(self, secret=object()):
        self.secret = secret
    def moves(self, grid):
        return 1.0, 2.0
"""

STUDY = """
seeds = 2
budget = { generations = 3 }
reference = false

[[problems]]
name = "hills"
random = { size = 8, p0 = 0.2 }
objectives = ["length", { class = "hikers:Hilly", slope = 2.5 }]
representation = "integer"

[[algorithms]]
name = "mine"
algorithm = "NSGA2"
pop_size = 10
representation = "hikers:Mine"
operators = { crossover = { class = "hikers:Sbx", eta = 3 } }

[[algorithms]]
algorithm = "hikers:Greedy"
pop_size = 12
parameters = { strength = 2 }

[[algorithms]]
algorithm = "hikers:Once"
pop_size = 14
"""


@pytest.fixture
def hikers(tmp_path, monkeypatch):
    (tmp_path / "hikers.py").write_text(MODULE)
    (tmp_path / "study.toml").write_text(STUDY)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "hikers", raising=False)
    yield importlib.import_module("hikers")
    sys.modules.pop("hikers", None)


def planned(algorithm=None, problem=None, **others):
    """Return the plan of a study of one problem and one algorithm."""
    problem = {"random": {"size": 8, "p0": 0.2}, "representation": "integer"} | (problem or {})
    algorithm = {"algorithm": "NSGA2", "pop_size": 10} | (algorithm or {})
    data = {"problems": [problem], "algorithms": [algorithm], "seeds": 1, "budget": {"generations": 2}, "reference": False}
    return plan_study(Study.from_dict(data | others))


def built(plan, k=-1):
    task = plan.task(plan.runs[k])
    problem = build_problem(task.problem, task.grid)
    return problem, build_algorithm(task.algorithm, problem)


def test_things_of_a_file_are_what_runs_are_made_of(hikers, tmp_path):
    plan = plan_study(load_study(tmp_path / "study.toml"))
    # One run of what draws nothing.
    assert [sum(run.algorithm == k for run in plan.runs) for k in range(3)] == [2, 2, 1]
    assert [algorithm.label for algorithm in plan.algorithms] == ["mine", "Greedy", "Once"]
    problem, algorithm = built(plan, 0)
    assert type(problem.representation) is hikers.Mine
    assert type(problem.objectives[1]) is hikers.Hilly and problem.objectives[1].slope == 2.5
    assert type(algorithm.mating.crossover) is hikers.Sbx and number(algorithm.mating.crossover.eta) == 3
    _, greedy = built(plan, 2)
    assert (type(greedy), greedy.pop_size, greedy.strength) == (hikers.Greedy, 12, 2)
    crossover = paper_operators(problem)["crossover"]
    assert type(greedy.mating.crossover) is type(crossover)


def test_processes_and_the_report_of_a_process_that_has_none_of_it(hikers, tmp_path):
    with LocalProcesses(1) as executor:
        outcome = run_study(load_study(tmp_path / "study.toml"), tmp_path / "out", executor)
    assert (outcome.n_run, outcome.n_failed) == (5, 0)
    plan = Store(tmp_path / "out").read_plan()
    record = Store(tmp_path / "out").read(plan.runs[0].key)
    assert record.objectives == ["length", "hilly"]
    # The report imports nothing that a plan names, even where it can: this one would end it.
    (tmp_path / "hikers.py").write_text("raise SystemExit('imported')")
    code = f"from pymoo_gridpath.study import write_report; write_report({str(tmp_path / 'out')!r}, formats=['svg'])"
    code += "; import sys; assert 'hikers' not in sys.modules"
    subprocess.run([sys.executable, "-c", f"import sys; sys.path.insert(0, {str(tmp_path)!r}); {code}"], check=True)
    text = (tmp_path / "out" / "report" / "report.md").read_text()
    for words in ("Hilly(slope=2.5)", "Greedy", "crossover Sbx(eta=3.0)", "representation Mine"):
        assert words in text.replace("\\", ""), words


def test_what_a_worker_cannot_import_is_said_in_its_record(hikers, tmp_path):
    plan = plan_study(load_study(tmp_path / "study.toml"))
    run = plan.runs[0]
    plan = dataclasses.replace(plan, runs=(run,))
    code = f"""
import pickle, sys
from pymoo_gridpath.study.running.execute import execute
sys.stdout.buffer.write(execute(pickle.loads({pickle.dumps(plan.task(run))!r})))
"""
    answer = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True).stdout
    record = from_bytes(answer)
    assert record.status == "failed"
    last = record.message.strip().splitlines()[-1]
    assert "the objective hikers:Hilly cannot be imported in this process (ModuleNotFoundError" in last
    assert "install its package" in last


def test_other_code_is_another_run_and_refused_by_workers_that_have_it(hikers, tmp_path, monkeypatch):
    plan = plan_study(load_study(tmp_path / "study.toml"))
    (tmp_path / "hikers.py").write_text(MODULE + "\n# changed\n")
    del sys.modules["hikers"]
    importlib.invalidate_caches()
    changed = plan_study(load_study(tmp_path / "study.toml"))
    assert not {run.key for run in plan.runs} & {run.key for run in changed.runs}
    code = f"""
import pickle, sys
sys.path.insert(0, {str(tmp_path)!r})
from pymoo_gridpath.study.running.execute import execute
from pymoo_gridpath.study.running.record import from_bytes
from pymoo_gridpath.study.specification.own import code_of
print(from_bytes(execute(pickle.loads({pickle.dumps(plan.task(plan.runs[0]))!r}))).message)
"""
    out = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
    assert "with which the study was planned" in out.strip().splitlines()[-1]


def test_code_that_is_installed_goes_by_its_version_and_other_code_by_what_it_says(hikers, tmp_path):
    said = code_of(hikers.Hilly)
    assert said.startswith("sha256 ")
    # A source folder with what its build has left, as one that is installed for development.
    left = tmp_path / "hikers.egg-info"
    left.mkdir()
    (left / "PKG-INFO").write_text("Metadata-Version: 2.1\nName: hikers\nVersion: 1.0\n")
    (left / "top_level.txt").write_text("hikers\n")
    (left / "SOURCES.txt").write_text("hikers.py\n")
    code_of.cache_clear()
    assert code_of(hikers.Hilly) == said
    installed = tmp_path / "hikers-2.0.dist-info"
    installed.mkdir()
    (installed / "METADATA").write_text("Metadata-Version: 2.1\nName: hikers\nVersion: 2.0\n")
    (installed / "RECORD").write_text("hikers.py,,\n")
    code_of.cache_clear()
    assert code_of(hikers.Hilly) == "hikers 2.0"
    code_of.cache_clear()


def test_arguments_are_part_of_the_key(hikers):
    keys = {
        planned(problem={"objectives": ["length", {"class": "hikers:Hilly", "slope": slope}]}).runs[0].key
        for slope in (1.0, 2.0, 2)
    }
    assert len(keys) == 2


def test_python_takes_classes_and_objects(hikers):
    by_path = planned(
        {"algorithm": "hikers:Greedy", "operators": {"crossover": {"class": "hikers:Sbx", "eta": 3.0}}},
        {"objectives": ["length", {"class": "hikers:Hilly", "slope": 2.0}], "representation": "hikers:Mine"},
    )
    by_object = planned(
        {"algorithm": hikers.Greedy, "operators": {"crossover": hikers.Sbx(eta=3.0)}},
        {"objectives": ["length", hikers.Hilly(2.0)], "representation": hikers.Mine},
    )
    assert [run.key for run in by_path.runs] == [run.key for run in by_object.runs]
    # What has a name in the package is known by it, as before.
    plain = planned({"operators": {"crossover": "DiscreteSBX"}}, {"objectives": ["length", "vulnerability"]})
    named = planned(
        {"operators": {"crossover": DiscreteSBX()}},
        {"objectives": ["length", Vulnerability()], "representation": IntegerRepresentation},
    )
    assert [run.key for run in plain.runs] == [run.key for run in named.runs]
    wide = planned(problem={"objectives": ["length", Vulnerability(variance=2.0)]})
    problem, _ = built(wide)
    assert problem.objectives[1].variance == 2.0
    assert wide.runs[0].key != plain.runs[0].key


@pytest.fixture
def shuffle(hikers, monkeypatch):
    """An entry point of an installed package."""
    point = EntryPoint("shuffle", "hikers:Sbx", OPERATORS.group)
    monkeypatch.setattr(OPERATORS, "_known", dict(OPERATORS._known))
    monkeypatch.setattr(OPERATORS, "_names", dict(OPERATORS._names))
    monkeypatch.setattr(OPERATORS, "_entry_points", {"shuffle": point})


def test_an_operator_by_its_name_is_the_same_as_by_its_path(hikers, shuffle, tmp_path):
    first, second, third, fourth = (
        planned({"operators": {"crossover": crossover}})
        for crossover in ("shuffle", "hikers:Sbx", {"class": "shuffle", "eta": 3}, {"class": "hikers:Sbx", "eta": 3})
    )
    assert [run.key for run in first.runs] == [run.key for run in second.runs] != [run.key for run in third.runs]
    assert [run.key for run in third.runs] == [run.key for run in fourth.runs]
    _, algorithm = built(third)
    assert type(algorithm.mating.crossover) is hikers.Sbx and number(algorithm.mating.crossover.eta) == 3
    # In processes that have the module, and nothing registered.
    with LocalProcesses(1) as executor:
        outcome = run_study(third, tmp_path / "out", executor)
    assert (outcome.n_run, outcome.n_failed) == (1, 0)


def test_a_selection_and_a_survival_leave_the_tie_break_out(hikers):
    given = {"selection": "SmoothnessTournament", "survival": {"class": "RankAndSmoothness", "distinct": True}}
    plan = planned({"operators": given})
    spec = plan.task(plan.runs[0]).algorithm
    assert spec["smoothness"] is False
    assert spec["operators"]["survival"] == {"class": "RankAndSmoothness", "distinct": True, "band": 0.0}
    _, algorithm = built(plan)
    assert type(algorithm.survival) is RankAndSmoothness and algorithm.survival.distinct
    _, other = built(planned({"operators": {"survival": RankAndSmoothness(distinct=True)}}))
    assert other.survival.distinct and type(other.mating.selection) is not type(algorithm.mating.selection)
    plain = planned()
    assert plain.task(plain.runs[0]).algorithm["operators"].keys() == paper_operators(built(plain)[0]).keys()


def test_a_plan_that_names_what_is_installed_makes_nobody_import(hikers, shuffle, tmp_path):
    store = Store(tmp_path / "out")
    store.write_plan(planned({"operators": {"mutation": "PathMutation", "crossover": "DiscreteSBX"}}))
    file = tmp_path / "out" / "plan.json"
    file.write_text(file.read_text().replace('"DiscreteSBX"', '"shuffle"'))
    (tmp_path / "hikers.py").write_text("raise SystemExit('imported')")
    del sys.modules["hikers"]
    with pytest.raises(GridPathError, match="class is 'shuffle'; expected one of"):
        store.read_plan()
    assert "hikers" not in sys.modules


def test_a_study_with_things_of_ones_own_goes_into_a_file_and_back(hikers):
    study = Study.from_dict(
        {
            "problems": [{"random": {"size": 8, "p0": 0.2}, "objectives": ["length", hikers.Hilly(2.0)]}],
            "algorithms": [
                {"algorithm": hikers.Greedy, "representation": hikers.Mine, "operators": {"mutation": "PathMutation"}}
            ],
            "seeds": 1,
            "budget": {"generations": 2},
        }
    )
    tables = study.to_dict()
    assert tables["problems"][0]["objectives"] == ["length", {"class": "hikers:Hilly", "slope": 2.0}]
    assert Study.from_dict(json.loads(json.dumps(tables))) == study


def local_class():
    class Local(Vulnerability):
        name = "local"

    return Local


@pytest.mark.parametrize(
    ("algorithm", "problem", "message"),
    [
        ({}, {"objectives": ["length", "nowhere:Thing"]}, "the objective nowhere:Thing cannot be imported in this process"),
        ({}, {"objectives": ["length", "hikers:Nothing"]}, "AttributeError"),
        ({}, {"objectives": ["length", "hikers:Sbx"]}, "expected a class derived from Objective"),
        ({}, {"objectives": ["length", "os:getcwd"]}, "expected a class derived from Objective"),
        ({}, {"objectives": ["length", "a b:c"]}, "expected such as 'package.module:Class'"),
        ({}, {"objectives": ["length", "__main__:X"]}, "of a script, which no other process can import"),
        ({}, {"objectives": ["length", local_class()]}, "which no other process can import"),
        ({}, {"objectives": ["length", {"class": "hikers:Hilly", "slop": 1}]}, "did you mean 'slope'"),
        ({}, {"objectives": ["length", {"slope": 1}]}, "objective has no class"),
        ({}, {"representation": "hikers:Hilly"}, "expected a class derived from Representation"),
        (
            {"operators": {"crossover": "suffle"}},
            {},
            "there is no crossover 'suffle'; expected one of SharedCellCrossover, DiscreteSBX, ",
        ),
        ({"operators": {"crossover": "DiscretSBX"}}, {}, "there is no crossover 'DiscretSBX'; did you mean 'DiscreteSBX'?"),
        ({"operators": {"crossover": "hikers:Mine"}}, {}, "expected a class derived from Crossover"),
        ({"operators": {"crossover": {"class": "hikers:Sbx", "eta": -3}}}, {}, "cannot be made so"),
        ({"algorithm": "hikers:Hilly"}, {}, "expected a class derived from Algorithm"),
        ({"algorithm": "hikers:Greedy", "parameters": {"strengh": 1}}, {}, "did you mean 'strength'"),
        ({"algorithm": "hikers:Greedy", "smoothness": True}, {}, "takes no smoothness"),
    ],
)
def test_what_cannot_be_had_is_refused_in_a_sentence(hikers, algorithm, problem, message):
    with pytest.raises(StudyError) as error:
        planned(algorithm, problem)
    assert message in str(error.value) and "\n" not in str(error.value)


def test_objects_that_cannot_be_written_down_are_refused(hikers):
    changed = hikers.Hilly()
    changed.more = 3
    for thing in (hikers.Hidden(secret=object()), changed):
        with pytest.raises(StudyError, match="cannot be written down as a class and its arguments"):
            planned(problem={"objectives": ["length", thing]})
    with pytest.raises(StudyError, match="expected its class, and the arguments"):
        planned({"algorithm": hikers.Greedy(survival=lambda: None)})


def made_algorithms(hikers):
    """Return functions that make algorithms, each with something else."""
    coded = GridPathProblem(random_dense_grid(8, 0.2, 1), (0, 0), (7, 7), "integer")
    operators, directions = path_operators(coded), reference_directions(2, 8)
    return {
        "by hand": lambda: NSGA2(pop_size=8, **operators),
        "with arguments": lambda: NSGA2(pop_size=8, **{**operators, "crossover": hikers.Sbx(eta=3.0)}),
        "of one's own": lambda: hikers.Greedy(8, strength=2.0, **operators),
        "by name": lambda: make_algorithm("NSGA-II", coded, pop_size=8),
        "by directions": lambda: make_algorithm("MOEA/D", coded, pop_size=8),
        "pymoo's by directions": lambda: MOEAD(directions, **{key: operators[key] for key in ("sampling", "mutation")}),
    }


def test_an_algorithm_that_is_made_already_is_taken_as_it_is(hikers):
    keys = set()
    for make in made_algorithms(hikers).values():
        plan = planned({"algorithm": make(), "pop_size": None})
        problem, algorithm = built(plan)
        found, expected = (minimize(problem, one, ("n_gen", 3), seed=4).pop for one in (algorithm, make()))
        assert np.array_equal(found.get("X"), expected.get("X")) and np.array_equal(found.get("F"), expected.get("F"))
        (key,) = {planned({"algorithm": make(), "pop_size": None}).runs[0].key, plan.runs[0].key}
        keys.add(key)
        # From a file, too.
        tables = json.loads(json.dumps(Study.from_dict(study_of({"algorithm": make()})).to_dict()))
        assert plan_study(Study.from_dict(tables)).runs[0].key == key
    assert len(keys) == len(made_algorithms(hikers))


def study_of(algorithm):
    problem = {"random": {"size": 8, "p0": 0.2}, "representation": "integer"}
    budget = {"generations": 2}
    return {"problems": [problem], "algorithms": [algorithm], "seeds": 1, "budget": budget, "reference": False}


def test_an_algorithm_that_is_made_already_runs_in_other_processes(hikers, tmp_path):
    make = made_algorithms(hikers)["with arguments"]
    plan = planned({"algorithm": make(), "pop_size": None})
    with LocalProcesses(1) as executor:
        outcome = run_study(plan, tmp_path / "out", executor)
    assert (outcome.n_run, outcome.n_failed) == (1, 0)
    stored = Store(tmp_path / "out").read_plan()
    assert stored.algorithms[0].label == "NSGA2"
    crossover = stored.algorithms[0].spec["algorithm"]["arguments"]["crossover"]
    assert (crossover["class"], crossover["arguments"]) == ("hikers:Sbx", {"eta": 3.0}) and crossover["code"].startswith(
        "sha256"
    )
    write_report(tmp_path / "out", formats=["svg"])
    assert "crossover=Sbx(eta=3.0)" in (tmp_path / "out" / "report" / "report.md").read_text().replace("\\", "")
    # Other code of a part is another run.
    (tmp_path / "hikers.py").write_text(MODULE + "\n# changed\n")
    code_of.cache_clear()
    assert planned({"algorithm": make(), "pop_size": None}).runs[0].key != plan.runs[0].key
    code_of.cache_clear()


def test_a_planner_and_a_representation_that_are_made_already_are_their_classes_with_arguments(hikers):
    one = planned({"algorithm": ExactFront(max_seconds=5), "pop_size": None})
    other = planned({"algorithm": "exact", "max_seconds": 5, "pop_size": None})
    assert one.runs[0].key == other.runs[0].key
    grid = random_dense_grid(8, 0.2, 1)
    for coding, form in (
        (CellSequence(grid, (0, 0), (7, 7), max_cells=30), {"class": "cells", "max_cells": 30}),
        (IntegerRepresentation(grid, (0, 0), (7, 7)), "integer"),
        (hikers.Mine(grid, (0, 0), (7, 7)), hikers.Mine),
    ):
        given, named = (planned(problem={"representation": one}) for one in (coding, form))
        assert given.runs[0].key == named.runs[0].key
    assert built(planned(problem={"representation": CellSequence(grid, (0, 0), (7, 7), 30)}))[0].n_var == 30


@pytest.mark.parametrize(
    ("make", "more", "message"),
    [
        (lambda: NSGA2(seed=3), {}, "seed is set in"),
        (lambda: NSGA2(callback=ConvergenceRecorder()), {}, "callback is set in"),
        (lambda: NSGA2(), {"pop_size": 8}, "takes no pop_size"),
        (lambda: ExactFront(), {"parameters": {"max_memory": 9}}, "takes no parameters"),
        (lambda: {"class": "NSGA2"}, {}, "expected 'package.module:Class'"),
        (lambda: {"class": "hikers:Greedy", "strenth": 1}, {}, "did you mean 'strength'"),
        (lambda: {"class": "hikers:Greedy", "mutation": {"class": "hikers:Nothing"}}, {}, "cannot be imported"),
    ],
)
def test_what_no_algorithm_can_be_made_of_again_is_refused(hikers, make, more, message):
    with pytest.raises(StudyError) as error:
        planned({"algorithm": make(), "pop_size": None, **more})
    assert message in str(error.value) and "\n" not in str(error.value)


def test_an_algorithm_that_has_begun_is_refused(hikers):
    algorithm = NSGA2(pop_size=8)
    algorithm.setup(GridPathProblem(random_dense_grid(8, 0.2, 1), (0, 0), (7, 7), "integer"), ("n_gen", 2))
    with pytest.raises(StudyError, match="has begun a run"):
        planned({"algorithm": algorithm, "pop_size": None})


@pytest.mark.parametrize(
    ("place", "value", "message"),
    [
        (("problems", 0, "spec", "objectives", 0), "hikers:Hilly", "there is no objective 'hikers:Hilly'"),
        (("problems", 0, "spec", "representation"), "hikers:Mine", "representation is 'hikers:Mine'"),
        (("algorithms", 0, "spec", "algorithm"), "hikers:Once", "expected what a plan says of it"),
        (("algorithms", 0, "spec", "operators", "crossover"), {"class": "hikers:Sbx"}, "arguments is None, expected a table"),
        (("algorithms", 0, "overrides", "representation", "monotone"), 1, "monotone is 1, expected true or false"),
        (("problems", 0, "spec", "objectives", 1, "name"), None, "name is None, expected a text"),
        (("problems", 0, "spec", "objectives", 1, "name"), "length", "expected each once"),
        (("problems", 0, "spec", "objectives", 1, "class"), "hikers:", "expected 'package.module:Class'"),
    ],
)
def test_a_plan_that_was_changed_makes_nobody_import(hikers, tmp_path, place, value, message):
    store = Store(tmp_path / "out")
    store.write_plan(plan_study(load_study(tmp_path / "study.toml")))
    file = tmp_path / "out" / "plan.json"
    data = json.loads(file.read_text())
    inner = data
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = value
    file.write_text(json.dumps(data))
    (tmp_path / "hikers.py").write_text("raise SystemExit('imported')")
    del sys.modules["hikers"]
    with pytest.raises(GridPathError) as error:
        store.read_plan()
    assert message in str(error.value)
    assert "hikers" not in sys.modules


def test_runs_are_known_by_what_a_file_of_costs_holds(tmp_path):
    np.save(tmp_path / "mud.npy", np.ones((8, 8)))
    # As maps are, it is looked for beside the file of the study.
    mud = {"class": "ground", "cost": "mud.npy", "weight": 2.0}
    setup = {
        "problems": [{"random": {"size": 8, "p0": 0.1}, "representation": "cells", "objectives": ["length", mud]}],
        "algorithms": [{"algorithm": "NSGA2", "pop_size": 10}],
        "seeds": 1,
        "budget": {"generations": 2},
        "reference": False,
    }
    plan = plan_study(Study.from_dict(setup, folder=tmp_path))
    store = Store(tmp_path / "store")
    assert run_study(plan, store.folder).n_failed == 0
    again = plan_study(Study.from_dict(setup, folder=tmp_path))
    assert [run.key for run in again.runs] == [run.key for run in plan.runs]
    (tmp_path / "moved").mkdir()
    np.save(tmp_path / "moved" / "mud.npy", np.ones((8, 8)))
    moved = plan_study(Study.from_dict(setup, folder=tmp_path / "moved"))
    assert [run.key for run in moved.runs] == [run.key for run in plan.runs]
    np.save(tmp_path / "mud.npy", np.eye(8))
    other = plan_study(Study.from_dict(setup, folder=tmp_path))
    assert {run.key for run in other.runs}.isdisjoint(run.key for run in plan.runs)
    # A plan that was made before does not run on other costs under its own keys, in a process that has not read those.
    build._problems.clear()
    outcome = run_study(plan, tmp_path / "late")
    assert outcome.n_failed == 1 and "mud.npy is not what the study was planned with" in outcome.messages[0]
    (tmp_path / "mud.npy").unlink()
    with pytest.raises(GridPathError, match=r"mud\.npy"):
        plan_study(Study.from_dict(setup, folder=tmp_path))
