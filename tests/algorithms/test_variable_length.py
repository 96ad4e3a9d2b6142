"""The preset of the variable-length genetic algorithm, repaired and with its rules as they are printed."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import PRINTED_RULES, find_algorithm, make_algorithm, variable_length_ga
from pymoo_gridpath.cli import main
from pymoo_gridpath.errors import CapabilityError, GridPathError, UnreachableError
from pymoo_gridpath.maps import load_map
from pymoo_gridpath.operators import SinglePointCrossover
from pymoo_gridpath.problems import random_dense_grid
from pymoo_gridpath.study import AlgorithmSpec, ProblemSpec, Study, run_study

GRID = random_dense_grid(10, 0.2, 3)
QUERY = (0, 0), (9, 9)
# From the bottom to the top there is a way round on the right.
WALL = OccupancyGrid(np.pad(np.ones((1, 4)), ((2, 2), (0, 2))), corner_cutting=True)


def test_preset_carries_the_papers_parameters():
    """Sections 5.6 and 5.7, and 50 generations of the conclusion."""
    problem, algorithm, termination = variable_length_ga(GRID, *QUERY)
    mating = algorithm.mating
    assert algorithm.pop_size == algorithm.n_offsprings == termination.n_max_gen == 50
    assert mating.crossover.prob.get() == 0.9 and mating.mutation.prob_var.get() == 0.02
    assert mating.selection.damping == algorithm.survival.damping == 300
    assert problem.objective_names == ["length"] and problem.obstacles == "constraint"
    # As members and strings may be the same in the paper.
    pop = minimize(*variable_length_ga(GRID, *QUERY, printed=["start"], n_gen=1), seed=1).pop
    assert len(pop) == 50 and len(np.unique(pop.get("X"), axis=0)) == 1


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("corner_cutting", [False, True])
def test_most_runs_find_a_shortest_path(seed, corner_cutting):
    grid = random_dense_grid(10, 0.2, seed).replace(corner_cutting=True)
    if not corner_cutting:
        free = grid.occupied.copy()
        free[0, :], free[:, 9] = False, False
        grid = OccupancyGrid(free)
    results = [minimize(*variable_length_ga(grid, *QUERY), seed=k) for k in range(4)]
    shortest = grid.shortest_length(*QUERY)
    assert all(result.success and result.message == "found a legal path" for result in results)
    assert all(result.F[0] >= shortest - 1e-9 for result in results)
    assert sum(result.F[0] <= shortest + 1e-9 for result in results) >= 3


def test_the_best_string_is_never_lost():
    setup = variable_length_ga(WALL, (0, 0), (0, 4), pop_size=10, printed=["start", "roulette"])
    history = minimize(*setup, seed=2, save_history=True).history
    best = [(run.pop.get("F") + 300 * run.pop.get("CV")).min() for run in history]
    assert best == sorted(best, reverse=True) and best[0] > best[-1]


def test_no_illegal_path_is_returned():
    result = minimize(*variable_length_ga(WALL, (0, 0), (0, 4), printed=["start"], n_gen=1), seed=1)
    assert result.X is None and result.F is None and result.success is False
    assert result.message == "found no legal path, only such across obstacles"
    assert (result.pop.get("interfering_cells") > 0).all()
    result = minimize(*variable_length_ga(WALL, (0, 0), (0, 4)), seed=1)
    assert result.success and result.F[0] == pytest.approx(WALL.shortest_length((0, 0), (0, 4)))


def test_printed_distances_make_zigzags_of_straight_lines():
    grid = OccupancyGrid(np.zeros((10, 10)), corner_cutting=True)
    result = minimize(*variable_length_ga(grid, (0, 4), (9, 4), printed=["distances"]), seed=1)
    (path,) = [result.problem.decode(result.X[None])]
    # Nine columns on: eight diagonal steps and a straight one are the least, 4.312 by the printed distances.
    assert path.length[0] > 9 and result.F[0] < 9 and result.F[0] >= 1 + 8 * 0.414 - 1e-9
    assert result.F[0] == pytest.approx(path.n_straight[0] + 0.414 * path.n_diagonal[0])


def test_printed_rules_are_taken_one_by_one_or_together():
    for rules in ((), *([rule] for rule in PRINTED_RULES), PRINTED_RULES):
        problem, algorithm, _ = variable_length_ga(GRID, *QUERY, printed=rules)
        mating = algorithm.mating
        assert algorithm.initialization.sampling.greedy == ("start" in rules)
        assert mating.selection.literal == ("roulette" in rules)
        assert mating.mutation.anywhere == isinstance(mating.crossover, SinglePointCrossover) == ("variation" in rules)
        assert (problem.objective_names == ["length"]) == ("distances" not in rules)


def test_the_same_seed_gives_the_same_and_what_has_run_pickles():
    first, second = (minimize(*variable_length_ga(GRID, *QUERY, n_gen=8), seed=5) for _ in range(2))
    assert np.array_equal(first.pop.get("X"), second.pop.get("X"))
    again = pickle.loads(pickle.dumps(first.algorithm))
    assert np.array_equal(again.pop.get("X"), first.pop.get("X"))


def test_larger_maps_are_no_trouble():
    grid = load_map("warehouse")
    result = minimize(*variable_length_ga(grid, (2, 3), (57, 36), n_gen=10), seed=1)
    shortest = grid.shortest_length((2, 3), (57, 36))
    assert result.success and shortest - 1e-9 <= result.F[0] < 2 * shortest


@pytest.mark.parametrize(
    ("bad", "said"),
    [
        ({"pop_size": 0}, "pop_size is 0"),
        ({"n_gen": 1.5}, "n_gen is 1.5"),
        ({"printed": "start"}, "printed is 'start', expected some of distances, start, roulette, variation"),
        ({"printed": ["goal"]}, "a rule of printed is 'goal'"),
        ({"printed": [np.zeros(2)]}, "a rule of printed is an array"),
        ({"termination": ("n_gen", 3)}, "expected a Termination of pymoo"),
        ({"max_cells": 3}, "max_cells is 3"),
    ],
)
def test_preset_refuses_in_words(bad, said):
    with pytest.raises(GridPathError, match=said):
        variable_length_ga(GRID, *QUERY, **bad)


def test_a_query_without_a_path_is_refused():
    with pytest.raises(UnreachableError):
        variable_length_ga(OccupancyGrid([[0, 1, 0]]), (0, 0), (2, 0))


def test_by_name_it_is_the_algorithm_of_the_preset():
    problem = GridPathProblem(GRID, *QUERY, "cells", ["length"], "constraint")
    for name in ("variable_length_ga", "VariableLengthGA", "variable-length GA"):
        made = minimize(problem, make_algorithm(name, problem, 50, printed=["start"]), ("n_gen", 6), seed=3)
        preset = minimize(*variable_length_ga(GRID, *QUERY, printed=["start"], n_gen=6), seed=3)
        assert np.array_equal(made.pop.get("X"), preset.pop.get("X")) and made.message == preset.message
    row = find_algorithm("variable_length_ga")
    assert (row.takes_operators, row.takes_pop_size, row.deterministic, row.takes_generations) == (False, True, False, True)


def test_no_illegal_path_is_returned_under_a_penalty_either():
    problem = GridPathProblem(WALL, (0, 0), (0, 4), "cells", ["length"])
    result = minimize(problem, make_algorithm("variable_length_ga", problem, printed=["start"]), ("n_gen", 1), seed=1)
    assert (result.pop.get("interfering_cells") > 0).all() and not result.pop.get("CV").any()
    assert result.X is None and result.F is None and result.opt is None and result.success is False


@pytest.mark.parametrize(
    ("options", "given", "said"),
    [
        ({"representation": "integer"}, {}, "for lists of cells, and the problem has the integer representation"),
        ({"objectives": ("length", "turn")}, {}, "variable_length_ga takes one objective, the problem has 2"),
        ({}, {"operators": {"crossover": "SpliceCrossover"}}, "variable_length_ga takes no argument 'crossover'"),
        ({}, {"printed": ["distances"]}, "a rule of printed is 'distances'"),
        ({}, {"pop_sise": 3}, "did you mean 'pop_size'"),
    ],
)
def test_by_name_it_refuses_in_words(options, given, said):
    problem = GridPathProblem(GRID, *QUERY, **{"representation": "cells", "objectives": ("length",), **options})
    with pytest.raises((CapabilityError, GridPathError), match=said):
        minimize(problem, make_algorithm("variable_length_ga", problem, **given), ("n_gen", 2))


@pytest.mark.usefixtures("undrawn")
def test_it_works_on_the_command_line_and_in_studies(tmp_path, capsys):
    plan = ["plan", "office", "--algorithm", "variable_length_ga", "--objectives", "length", "--generations", "2"]
    assert main([*plan, "-o", str(tmp_path / "plan")]) == 0
    assert "shortest" in capsys.readouterr().out
    study = Study(
        problems=[ProblemSpec(name="one", map="paper16", representation="cells", objectives=["length"])],
        algorithms=[AlgorithmSpec(algorithm="variable_length_ga", pop_size=10, parameters={"printed": ["roulette"]})],
        seeds=2,
        budget={"generations": 2},
    )
    assert study.algorithms[0].label == "variable_length_ga"
    outcome = run_study(study, tmp_path / "study")
    assert (outcome.n_failed, outcome.n_run) == (0, 3)
