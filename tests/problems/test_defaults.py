"""What a problem does unless told: the coding, and what it says of operators that cannot find a path."""

from __future__ import annotations

import json
import pickle
import re
import warnings

import numpy as np
import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM
from pymoo.operators.repair.rounding import RoundingRepair
from pymoo.operators.sampling.rnd import IntegerRandomSampling
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import CAPABILITIES, ahmed_deb_2013, make_algorithm
from pymoo_gridpath.cli import main
from pymoo_gridpath.decision import TradeOffSet
from pymoo_gridpath.maps import load_map, shipped_maps
from pymoo_gridpath.operators import default_operators, paper_operators, path_operators
from pymoo_gridpath.problems import random_dense_grid
from pymoo_gridpath.study.planning.expand import plan_study
from pymoo_gridpath.study.specification.problem import ProblemSpec
from pymoo_gridpath.study.specification.study import Study

OFFICE = next(item for item in shipped_maps() if item.name == "office")
# Whole numbers, but of operators that know no paths.
ROUNDED = {
    "sampling": IntegerRandomSampling(),
    "crossover": SBX(vtype=float, repair=RoundingRepair()),
    "mutation": PM(vtype=float, repair=RoundingRepair()),
}
HELP = re.escape("NSGA2(**path_operators(problem))")


def office(**options):
    return GridPathProblem(load_map("office"), OFFICE.start, OFFICE.goal, **options)


@pytest.mark.parametrize(
    ("corner_cutting", "axis", "expected"),
    [
        (False, "auto", "cells"),
        (True, "auto", "integer"),
        (False, "x", "integer"),
        (False, "y", "integer"),
        (True, "x", "integer"),
    ],
)
@pytest.mark.usefixtures("undrawn")
def test_python_command_line_and_study_have_one_default(corner_cutting, axis, expected, tmp_path, capsys):
    grid = OccupancyGrid(np.zeros((5, 6)), corner_cutting=corner_cutting)
    assert GridPathProblem(grid, (0, 0), (5, 4), axis=axis).representation.name == expected
    path = tmp_path / "room.txt"
    path.write_text(f"corner_cutting: {str(corner_cutting).lower()}\n\n" + "......\n" * 5)
    search = ["--pop-size", "8", "--generations", "1", "--axis", axis, "-o", str(tmp_path / "out")]
    assert main(["plan", str(path), "--start", "0,0", "--goal", "5,4", *search]) == 0
    assert json.loads((tmp_path / "out" / "paths.json").read_text())["settings"]["representation"] == expected
    keys = []
    for given in (None, expected):
        spec = ProblemSpec(map=str(path), start=(0, 0), goal=(5, 4), axis=axis, representation=given)
        plan = plan_study(Study(problems=[spec], algorithms=[{"algorithm": "NSGA2"}], seeds=1, budget={"generations": 1}))
        assert plan.problems[0].spec["representation"] == expected
        keys.append([run.key for run in plan.runs])
    assert keys[0] == keys[1], "a study that names the default means the same runs"


def test_the_papers_planner_keeps_the_papers_coding():
    for corner_cutting in (True, False):
        grid = random_dense_grid(8, 0.1, 1).replace(corner_cutting=corner_cutting, occupied=np.zeros((8, 8), dtype=bool))
        assert ahmed_deb_2013(grid, (0, 0), (7, 7)).problem.representation.name == "integer"


@pytest.mark.parametrize("item", shipped_maps(), ids=lambda item: item.name)
def test_the_default_finds_the_shortest_of_all_paths(item):
    grid = load_map(item.name).replace(corner_cutting=False).inflate(item.radius or 0.0)
    problem = GridPathProblem(grid, item.start, item.goal)
    result = minimize(problem, make_algorithm("NSGA-II", problem, pop_size=40), ("n_gen", 5), seed=1)
    found = TradeOffSet.from_results(result)
    assert found.feasible and found.shortest.length == pytest.approx(grid.shortest_lengths(item.start)[item.goal[::-1]])
    assert found.advice == ""


@pytest.mark.parametrize("representation", [None, "integer", "binary", "mixed"])
@pytest.mark.parametrize("operators", [{}, ROUNDED], ids=["stock", "rounded"])
def test_pymoos_operators_are_warned_of_once_with_what_helps(representation, operators):
    problem = office(representation=representation)
    with pytest.warns(UserWarning, match=HELP) as caught:
        minimize(problem, NSGA2(20, **operators), ("n_gen", 3), seed=1)
        minimize(problem, NSGA2(20, **operators), ("n_gen", 3), seed=2)
    assert len(caught) == 1
    said = str(caught[0].message)
    assert ("no whole numbers" in said) if not operators else ("no legal path among 20 of IntegerRandomSampling" in said)


def test_the_first_generation_of_foreign_crossover_is_the_one_that_is_warned_of():
    problem = office(representation="integer")
    operators = {**ROUNDED, "sampling": default_operators(problem)["sampling"]}
    with pytest.warns(UserWarning, match=f"of SBX, and the algorithm has no repair.*{HELP}"):
        minimize(problem, NSGA2(20, **operators), ("n_gen", 3), seed=1)


def test_the_line_that_helps_does():
    for representation in (None, "integer"):
        problem = office(representation=representation)
        result = minimize(problem, NSGA2(pop_size=20, **path_operators(problem)), ("n_gen", 2), seed=1)
        assert (result.pop.get("interfering_cells") == 0).all()


@pytest.mark.filterwarnings("error:.*path_operators")
def test_operators_of_this_package_may_take_their_time():
    problem = office(representation="integer")
    result = minimize(problem, NSGA2(20, **paper_operators(problem)), ("n_gen", 2), seed=1)
    assert (result.pop.get("interfering_cells") > 0).all(), "a case without a legal path"
    for name in ("SPEA2", "MOEAD", "NSDE", "GDE3", "CTAEA"):
        minimize(problem, make_algorithm(name, problem, pop_size=20), ("n_gen", 2), seed=1)
        assert CAPABILITIES[name].whole_numbers
    X = result.pop.get("X")
    assert np.array_equal(problem.evaluate(X.astype(float)), problem.evaluate(X))


def test_a_warned_problem_can_be_pickled_and_real_genes_are_rounded_as_before():
    problem = office(representation="integer")
    X = np.zeros((1, problem.n_var)) + 0.4
    with pytest.warns(UserWarning, match="no whole numbers"):
        F = problem.evaluate(X)
    again = pickle.loads(pickle.dumps(problem))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.array_equal(again.evaluate(X), F) and np.array_equal(again.evaluate(np.zeros_like(X)), F)
