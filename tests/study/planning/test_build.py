"""Problems, algorithms and terminations made from their canonical form are those that the factories make."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import ExactFront, ahmed_deb_2013, make_algorithm
from pymoo_gridpath.errors import GridPathError, StudyError
from pymoo_gridpath.operators import DiscreteSBX, PathMutation, SpliceCrossover, paper_operators, path_operators
from pymoo_gridpath.problems import random_dense_grid
from pymoo_gridpath.study.planning import build, trial
from pymoo_gridpath.study.planning.build import build_algorithm, build_grid, build_problem, build_termination, pack_grid
from pymoo_gridpath.study.planning.expand import plan_study
from pymoo_gridpath.study.planning.plan import is_truth
from pymoo_gridpath.study.specification.kinds import flags_of
from pymoo_gridpath.study.specification.problem import ProblemSpec
from pymoo_gridpath.study.specification.study import Study
from pymoo_gridpath.testing.enumeration import RULES

GRID = random_dense_grid(8, 0.2, 1)
RANDOM: dict[str, Any] = {"random": {"size": 8, "p0": 0.2}}


def task_of(problem, algorithm, budget=None):
    """Return the last task of a study of one problem and one algorithm, as a worker gets it."""
    study = {"problems": [problem], "algorithms": [algorithm], "seeds": 1, "budget": budget or {"generations": 4}}
    plan = plan_study(Study.from_dict(study))
    task = plan.task(plan.runs[-1])
    return task._replace(problem=json.loads(json.dumps(task.problem)), algorithm=json.loads(json.dumps(task.algorithm)))


def solve(task) -> tuple[np.ndarray, np.ndarray]:
    problem = build_problem(task.problem, task.grid)
    algorithm = build_algorithm(task.algorithm, problem)
    return front(minimize(problem, algorithm, build_termination(task.budget), seed=3))


def front(result) -> tuple[np.ndarray, np.ndarray]:
    return result.pop.get("X"), result.pop.get("F")


def same(one, other) -> bool:
    return all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))


# -- grids --------------------------------------------------------------------------------------------------------------


@settings(max_examples=50, deadline=None)
@given(
    occupied=arrays(bool, st.tuples(st.integers(1, 12), st.integers(1, 12))),
    resolution=st.none() | st.floats(0.01, 10),
    steps=st.sampled_from(RULES),
)
def test_grids_pack_and_build(occupied, resolution, steps):
    grid = OccupancyGrid(occupied, resolution, (0, 0) if resolution is None else (1, 2, 3), name="a name", **steps)
    spec, cells = pack_grid(grid)
    assert build_grid(json.loads(json.dumps(spec)), cells) == grid.replace(origin=(0, 0, 0), name="grid")
    assert pack_grid(grid.replace(name="another", origin=(0, 0)))[0] == spec
    assert ("resolution" in spec) == (resolution is not None)
    assert pack_grid(grid.replace(resolution=20.0))[0] == {**spec, "resolution": 20.0}


@pytest.mark.parametrize(
    ("problem", "risk"),
    [
        ({"map": "warehouse"}, "Vulnerability(sigma_m=1.0, nearest=True, cutoff=1e-06)"),
        ({"map": "warehouse", "resolution": 0.05}, "Vulnerability(sigma_m=0.3, nearest=True, cutoff=1e-06)"),
        ({"map": "paper16", "axis": "x"}, "Vulnerability(variance=0.5, nearest=False, cutoff=0.0)"),
        (
            {"map": "warehouse", "objectives": ["length", {"class": "vulnerability", "variance": 0.5}]},
            "Vulnerability(variance=0.5, nearest=False, cutoff=0.0)",
        ),
        (
            {"map": "warehouse", "objectives": ["length", {"class": "vulnerability", "sigma_m": 0.7}]},
            "Vulnerability(sigma_m=0.7, nearest=True, cutoff=1e-06)",
        ),
        (
            {"map": "warehouse", "objectives": ["length", "inflation"]},
            "Inflation(cost_scaling_factor=10.0, inflation_radius=0.55)",
        ),
    ],
)
def test_workers_have_the_risk_of_the_map(problem, risk):
    task = task_of(problem, {"algorithm": "NSGA2", "pop_size": 8})
    assert repr(build_problem(task.problem, task.grid).objectives[1]) == risk


def test_trials_on_another_grid_have_metres_too():
    """On a map that is too large for a trial a small one stands in, which must have a size as well."""
    grid = OccupancyGrid(np.zeros((120, 120)), 0.05)
    problem = ProblemSpec(grid=grid, start=(0, 0), goal=(3, 3), objectives=["length", "inflation"])
    study = Study(problems=[problem], algorithms=[{"algorithm": "NSGA2"}], seeds=1, budget={"generations": 2}, reference=False)
    plan = plan_study(study)
    task = plan.task(plan.runs[-1])
    small = trial._small(trial.Pair(task.problem, task.algorithm, task.grid, "large", 0))
    assert small.grid is None and build_problem(small.problem).grid.resolution == 0.05


@settings(max_examples=50, deadline=None)
@given(occupied=arrays(bool, (5, 6)), x=st.integers(0, 5), y=st.integers(0, 4))
def test_digest_tells_grids_apart(occupied, x, y):
    digest = pack_grid(OccupancyGrid(occupied))[0]["digest"]
    assert pack_grid(OccupancyGrid(occupied.reshape(6, 5)))[0]["digest"] != digest
    occupied[y, x] ^= True
    assert pack_grid(OccupancyGrid(occupied))[0]["digest"] != digest


def test_wrong_cells_are_noticed():
    spec, _ = pack_grid(GRID)
    with pytest.raises(GridPathError, match="not those that were planned with"):
        build_grid(spec, pack_grid(random_dense_grid(8, 0.2, 2))[1])
    with pytest.raises(GridPathError, match="are missing"):
        build_grid(spec)


def test_random_grids():
    spec = {"size": 8, "p0": 0.2, "seed": 1, "corner_cutting": True}
    assert build_grid({"random": spec}) == GRID
    assert build_grid({"random": {**spec, "corner_cutting": False}}) == GRID.replace(corner_cutting=False)


# -- problems -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"representation": "cells", "objectives": ["turn", "length", "vulnerability"]},
        {"obstacles": "constraint", "representation": "binary"},
        {"obstacles": "limit", "potential_limit": 4.0, "representation": "absolute"},
        {"penalty": 3.5, "axis": "y"},
    ],
)
def test_problems_evaluate_alike(options):
    expected = GridPathProblem(GRID, (0, 0), (7, 7), **options)
    task = task_of(RANDOM | options, {"algorithm": "exact"})
    made = build_problem(task.problem, task.grid)
    rng = np.random.default_rng(0)
    X = rng.integers(expected.xl, expected.xu + 1, size=(20, expected.n_var)).astype(expected.vtype)
    one, other = (problem.evaluate(X, return_as_dictionary=True) for problem in (expected, made))
    assert (one["F"] == other["F"]).all()
    assert one.keys() == other.keys()
    assert options.get("obstacles", "penalty") == "penalty" or (one["G"] == other["G"]).all()
    assert made.objective_names == expected.objective_names


def test_last_problems_are_kept():
    specs = [task_of({"random": {"size": 8, "p0": 0.2, "seeds": [seed]}}, {"algorithm": "exact"}).problem for seed in range(8)]
    made = [build_problem(spec) for spec in specs]
    assert build_problem(dict(reversed(specs[-1].items()))) is made[-1]
    assert build_problem(specs[0]) is not made[0]
    assert len(build._problems) <= build.KEPT_PROBLEMS


# -- algorithms ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "representation", "more"),
    [
        ("NSGA2", "integer", {}),
        ("NSGA2", "cells", {"smoothness": False}),
        ("SPEA2", "mixed", {}),
        ("MOEA/D", "cells", {"parameters": {"n_neighbors": 5, "prob_neighbor_mating": 1}}),
        ("NSGA3", "binary", {}),
        ("CTAEA", "integer", {}),
        ("NSDE", "integer", {"parameters": {"CR": 0.9}}),
        ("GDE3", "cells", {}),
        ("RVEA", "absolute", {"parameters": {"alpha": 1}}),
        ("RNSGA2", "integer", {"parameters": {"ref_points": [[10, 1], [12, 0.5]]}}),
    ],
)
def test_same_search_as_make_algorithm(name, representation, more):
    """Operators, smoothness and other defaults that are written out are those that `make_algorithm` chooses."""
    task = task_of(RANDOM | {"representation": representation}, {"algorithm": name, "pop_size": 12, **more})
    problem = GridPathProblem(GRID, (0, 0), (7, 7), representation)
    expected = make_algorithm(name, problem, 12, smoothness=more.get("smoothness"), **more.get("parameters", {}))
    assert same(solve(task), front(minimize(problem, expected, ("n_gen", 4), seed=3)))


@pytest.mark.parametrize(
    ("operators", "representation", "expected"),
    [
        ("scalarized", "integer", lambda problem: path_operators(problem)),
        ("random", "cells", lambda problem: path_operators(problem, "random")),
        ("paper", "binary", lambda problem: paper_operators(problem)),
        (
            {"base": "paper", "crossover": {"class": "DiscreteSBX", "eta": 3}},
            "absolute",
            lambda problem: paper_operators(problem) | {"crossover": DiscreteSBX(3.0)},
        ),
        (
            {"crossover": {"class": "SpliceCrossover", "reach": 1}, "mutation": {"class": "PathMutation", "margin": 2}},
            "cells",
            lambda problem: path_operators(problem) | {"crossover": SpliceCrossover(1), "mutation": PathMutation(margin=2)},
        ),
        (
            {"mutation": {"class": "PathMutation", "ways": {"weighted": 1}}},
            "integer",
            lambda problem: paper_operators(problem) | {"mutation": PathMutation({"weighted": 1})},
        ),
    ],
)
def test_same_search_with_these_operators(operators, representation, expected):
    task = task_of(RANDOM | {"representation": representation}, {"algorithm": "NSGA2", "pop_size": 12, "operators": operators})
    problem = GridPathProblem(GRID, (0, 0), (7, 7), representation)
    algorithm = make_algorithm("NSGA2", problem, 12, operators=expected(problem))
    assert same(solve(task), front(minimize(problem, algorithm, ("n_gen", 4), seed=3)))


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"representation": "binary"},
        {"objectives": ["length", "vulnerability", "turn"]},
        {"objectives": ["length"]},
        {"obstacles": "limit", "potential_limit": 5.0},
        {"penalty": 4.0},
    ],
)
def test_preset_is_the_planner_of_the_paper(options):
    entry = {"preset": "ahmed-deb-2013", "pop_size": 12}
    own = {key: options[key] for key in ("penalty", "representation") if key in options}
    task = task_of(RANDOM | {key: options[key] for key in options if key not in own}, entry | own)
    setup = ahmed_deb_2013(GRID, (0, 0), (7, 7), pop_size=12, n_gen=4, **options)
    assert same(solve(task), front(minimize(*setup, seed=3)))


def test_exact():
    task = task_of(RANDOM, {"algorithm": "exact", "max_seconds": 9, "max_labels": 10_000})
    problem = build_problem(task.problem)
    algorithm = build_algorithm(task.algorithm, problem)
    assert isinstance(algorithm, ExactFront)
    assert (algorithm.budget.max_seconds, algorithm.budget.max_labels) == (9, 10_000)
    assert (problem.pareto_front(max_seconds=60) == minimize(problem, algorithm).F).all()


def test_an_exact_front_that_may_be_near_enough_is_a_run_like_others():
    entry = {"algorithm": "exact", "max_seconds": 60, "parameters": {"epsilon": 0.05}}
    task = task_of(RANDOM, entry)
    assert not is_truth(task.algorithm) and is_truth(task_of(RANDOM, {"algorithm": "exact"}).algorithm)
    problem = build_problem(task.problem)
    result = minimize(problem, build_algorithm(task.algorithm, problem))
    assert result.success and result.certified.epsilon <= 0.05
    made = task_of(RANDOM, {"algorithm": ExactFront(max_seconds=60, epsilon=0.05)})
    assert made.algorithm == task.algorithm and made.key == task.key
    with pytest.raises(StudyError, match="epsilon is 2, expected a number above 0, at most 1"):
        task_of(RANDOM, {"algorithm": "exact", "parameters": {"epsilon": 2.0}})


def test_a_planner_of_ones_own_that_was_content_with_less_is_no_truth():
    class Mine(ExactFront):
        pass

    assert flags_of(Mine, {}) == {"deterministic": True, "reference": True}
    assert not flags_of(Mine, {"share": 0.1})["reference"] and flags_of(Mine, {"share": None})["reference"]


def test_each_algorithm_is_new():
    task = task_of(RANDOM, {"algorithm": "NSGA2", "pop_size": 12})
    problem = build_problem(task.problem)
    one, other = (build_algorithm(task.algorithm, problem) for _ in range(2))
    for name in ("survival", "mating", "output"):
        assert getattr(one, name) is not getattr(other, name)


# -- terminations -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("budget", "n_gen", "n_eval"), [({"generations": 3}, 3, 36), ({"evaluations": 40}, 4, 48)])
def test_terminations(budget, n_gen, n_eval):
    task = task_of(RANDOM, {"algorithm": "NSGA2", "pop_size": 12}, budget)
    problem = build_problem(task.problem)
    result: Any = minimize(problem, build_algorithm(task.algorithm, problem), build_termination(task.budget), seed=1)
    assert (result.algorithm.n_iter - 1, result.algorithm.evaluator.n_eval) == (n_gen, n_eval)


@pytest.mark.parametrize("evaluations", [24, 40, 600])
@pytest.mark.parametrize("more", [{}, {"n_offsprings": 5}])
def test_rvea_spends_the_budget_as_others_do(evaluations, more):
    """By pymoo's own count RVEA ends a generation before it has made its evaluations."""
    spent = []
    for name in ("NSGA2", "RVEA"):
        task = task_of(RANDOM, {"algorithm": name, "pop_size": 12, "parameters": more}, {"evaluations": evaluations})
        problem = build_problem(task.problem)
        algorithm: Any = build_algorithm(task.algorithm, problem)
        termination: Any = build_termination(task.budget or {}, algorithm)
        algorithm.setup(problem, termination=termination, seed=1)
        while algorithm.has_next():
            algorithm.next()
        spent.append((algorithm.n_iter - 1, algorithm.evaluator.n_eval))
    assert spent[0] == spent[1]
    # Its penalty grows to the last generation.
    assert termination.n_max_gen == spent[1][0]
