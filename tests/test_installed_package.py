"""A package that is installed beside this one, with one thing of each kind: all are known by their names."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

MODULE = '''
"""One of each kind, none of them registered by hand."""

import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.mutation import Mutation

from pymoo_gridpath.algorithms import ExactFront
from pymoo_gridpath.maps import MapFormat, make_grid
from pymoo_gridpath.objectives import Objective
from pymoo_gridpath.planners import Plan, Planner
from pymoo_gridpath.exact import exact_front
from pymoo_gridpath.representations import IntegerRepresentation


class Hilly(Objective):
    name, label = "hilly", "Height passed [m]"

    def field(self, grid):
        return np.add.outer(np.zeros(grid.height), np.arange(grid.width) % 3.0)


class Coding(IntegerRepresentation):
    name = "coding"


class Shake(Mutation):
    def _do(self, problem, X, random_state=None, **kwargs):
        other = random_state.integers(problem.xl, problem.xu, size=X.shape, endpoint=True)
        return np.where(random_state.random(X.shape) < 0.2, other, X).astype(X.dtype)


class Greedy(NSGA2):
    def __init__(self, pop_size=100, strength=1.0, **kwargs):
        self.strength = strength
        super().__init__(pop_size=pop_size, **kwargs)


class Copier(Planner):
    def __init__(self, most=100, **kwargs):
        super().__init__(**kwargs)
        self.most = most

    def plan(self, problem):
        return Plan(exact_front(problem).X[: self.most], message="copied the front")


class Dots(MapFormat):
    name, suffixes = "dots", (".dots",)

    def read(self, path, corner_cutting=False, resolution=None):
        width, height = map(int, open(path).read().split())
        return make_grid(path, np.zeros((height, width)), corner_cutting=corner_cutting, resolution=resolution)
'''

ENTRY_POINTS = """
[pymoo_gridpath.objectives]
hilly = strangers:Hilly
[pymoo_gridpath.representations]
coding = strangers:Coding
[pymoo_gridpath.operators]
shake = strangers:Shake
lost = strangers:NoSuchThing
[pymoo_gridpath.algorithms]
Greedy = strangers:Greedy
[pymoo_gridpath.planners]
copier = strangers:Copier
[pymoo_gridpath.map_formats]
dots = strangers:Dots
"""

STUDY = """
seeds = 2
budget = { generations = 2 }
reference = false
[[problems]]
map = "room.dots"
start = [0, 0]
goal = [8, 5]
objectives = ["length", "hilly"]
representation = "coding"
[[algorithms]]
name = "shaken"
algorithm = "NSGA2"
pop_size = 8
operators = { mutation = "shake" }
[[algorithms]]
algorithm = "greedy"
pop_size = 8
parameters = { strength = 2 }
[[algorithms]]
algorithm = "copier"
parameters = { most = 1 }
"""

BY_NAME = """
import sys
import pymoo_gridpath as gp
from pymoo.optimize import minimize

problem = gp.GridPathProblem(gp.load_map("room.dots"), (0, 0), (8, 5), "coding", ["length", "hilly"])
algorithm = gp.make_algorithm("Greedy", problem, 8, operators={"mutation": "shake"}, strength=3)
strangers = sys.modules["strangers"]
assert (type(algorithm), algorithm.strength, type(algorithm.mating.mutation)) == (strangers.Greedy, 3, strangers.Shake)
assert len(minimize(problem, algorithm, ("n_gen", 2), seed=1).pop) == 8
result = minimize(problem, gp.make_algorithm("copier", problem, most=1), seed=1)
assert (len(result.F), result.message) == (1, "copied the front")
for name, operators, hint in (
    ("gredy", {}, "there is no algorithm 'gredy'; did you mean 'Greedy'?"),
    ("copiers", {}, "there is no algorithm 'copiers'; did you mean 'copier'?"),
    ("NSGA2", {"mutation": "shke"}, "there is no mutation 'shke'; did you mean 'shake'?"),
    ("NSGA2", {"repair": "shake"}, "there is no repair 'shake'; expected one of PathRepair, TimedRepair, EdgeFixing"),
    ("NSGA2", {"repair": "lost"}, "the operator 'lost' of the installed package cannot be imported from strangers:NoSuchThing"),
):
    try:
        gp.make_algorithm(name, problem, operators=operators)
    except gp.GridPathError as error:
        assert hint in str(error), error
    else:
        raise AssertionError(name)
"""


# The command line, but for the seconds that it takes to draw.
WITHOUT_FIGURES = """
import sys
from matplotlib.figure import Figure
from pymoo_gridpath.cli import main

Figure.savefig = lambda *args, **kwargs: None
sys.exit(main(sys.argv[1:]))
"""


@pytest.fixture
def run(tmp_path):
    """Return what runs Python where the package is installed, in a folder with a map."""
    site = tmp_path / "site"
    folder = site / "strangers-1.0.dist-info"
    folder.mkdir(parents=True)
    (site / "strangers.py").write_text(MODULE)
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: strangers\nVersion: 1.0\n")
    (folder / "entry_points.txt").write_text(ENTRY_POINTS)
    (folder / "RECORD").write_text("strangers.py,,\n")
    (tmp_path / "room.dots").write_text("9 6")
    (tmp_path / "study.toml").write_text(STUDY)
    paths = os.pathsep.join([str(site), *filter(None, [os.environ.get("PYTHONPATH")])])

    def call(*arguments):
        command = [sys.executable, "-W", "ignore::UserWarning", *arguments]
        settings = {"cwd": tmp_path, "env": {**os.environ, "PYTHONPATH": paths}, "timeout": 300}
        done = subprocess.run(command, capture_output=True, text=True, check=False, **settings)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return call


def test_python_knows_them(run):
    run("-c", BY_NAME)


@pytest.mark.parametrize(
    "given",
    [("greedy", "--operators", "mutation=shake", "--pop-size", "8", "--generations", "2"), ("copier",)],
    ids=["algorithm and operator", "planner"],
)
def test_the_command_line_knows_them(run, tmp_path, given):
    problem = ("--start", "0,0", "--goal", "8,5", "--objectives", "length,hilly", "--representation", "coding")
    run("-c", WITHOUT_FIGURES, "plan", "room.dots", *problem, "--algorithm", *given, "-o", "out")
    assert len(json.loads((tmp_path / "out" / "paths.json").read_text())["paths"]) >= 1


def test_a_study_on_two_processes_knows_them(run, tmp_path):
    out = run("-m", "pymoo_gridpath.cli", "study", "run", "study.toml", "-o", "out", "--jobs", "2")
    plan = json.loads((tmp_path / "out" / "plan.json").read_text())
    # The planner draws nothing.
    assert len(plan["runs"]) == 5, out
    spec = plan["algorithms"][0]["spec"]["operators"]["mutation"]
    assert (spec["class"], spec["code"]) == ("strangers:Shake", "strangers 1.0")
    assert [item["spec"]["algorithm"]["class"] for item in plan["algorithms"][1:]] == ["strangers:Greedy", "strangers:Copier"]
    code = "from pymoo_gridpath.study import Store; s = Store('out'); print({s.read(r.key).status for r in s.read_plan().runs})"
    assert run("-c", code) == "{'finished'}\n"
