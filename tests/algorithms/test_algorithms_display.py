"""What algorithms print with verbose=True."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest
from pymoo.optimize import minimize
from pymoo.util.display.output import Output

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import CAPABILITIES, ExactFront, PathOutput, ahmed_deb_2013, make_algorithm
from pymoo_gridpath.objectives import Objective
from pymoo_gridpath.planners.display import FrontOutput
from pymoo_gridpath.problems import random_dense_grid


def rows(text):
    """Return the printed table as a list of dicts."""
    lines = [[cell.strip() for cell in line.split("|")] for line in text.splitlines() if "|" in line]
    return [dict(zip(lines[0], cells, strict=True)) for cells in lines[1:]]


def missed(front, F):
    """IGD+ by its definition, in objectives scaled by the range of the front."""
    span = np.ptp(front, axis=0)
    span[span == 0] = 1.0
    return np.mean([min(np.linalg.norm(np.maximum(f - point, 0) / span) for f in F) for point in front])


USABLE = [name for name, row in CAPABILITIES.items() if not row.unfit]


@pytest.mark.filterwarnings("ignore:invalid value encountered")
@pytest.mark.parametrize("name", USABLE)
def test_every_algorithm_shows_legal_paths_and_how_far_they_are_from_the_front(name, make_problem, arguments, capsys):
    row = CAPABILITIES[name]
    n_obj = 1 if row.max_objectives == 1 else 2
    problem = make_problem(n_obj)
    algorithm = make_algorithm(name, problem, pop_size=20, **arguments(row, n_obj))
    seen = []

    def look(algorithm):
        legal = algorithm.pop.get("F")[algorithm.pop.get("interfering_cells") == 0]
        distance = missed(problem.pareto_front(max_seconds=60), legal) if len(legal) else None
        seen.append((len(legal), legal[:, 0].min(initial=np.inf), distance))

    result = minimize(problem, algorithm, ("n_gen", 5), seed=1, verbose=True, callback=look)
    printed = rows(capsys.readouterr().out)
    assert len(printed) == len(seen) >= 5
    assert list(printed[0]) == ["n_gen", "n_eval", "legal", "length", "igd+"]
    for line, (n_legal, length, distance) in zip(printed, seen, strict=True):
        assert int(line["legal"]) == n_legal
        assert (line["length"], line["igd+"]) == (f"{length:.3f}", f"{distance:.6f}") if n_legal else ("-", "-")
    assert int(printed[-1]["n_eval"]) == result.algorithm.evaluator.n_eval
    if row.pickles:
        result.algorithm.callback = None  # a local function
        assert isinstance(pickle.loads(pickle.dumps(result.algorithm)).output, PathOutput)


def test_a_run_that_has_the_whole_front_is_at_distance_zero(capsys):
    problem = GridPathProblem(OccupancyGrid([[0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0]]), (0, 0), (3, 2))
    minimize(problem, make_algorithm("NSGA-II", problem, pop_size=20), ("n_gen", 3), seed=1, verbose=True)
    last = rows(capsys.readouterr().out)[-1]
    assert (last["igd+"], last["length"]) == ("0.000000", f"{problem.pareto_front(max_seconds=60)[0, 0]:.3f}")


def test_limits_count_and_columns_follow_the_problem(capsys):
    grid = random_dense_grid(8, 0.1, 11)
    limited = GridPathProblem(
        grid, (0, 0), (7, 7), objectives=("vulnerability", "turn"), obstacles="limit", potential_limit=1e-9
    )
    minimize(limited, make_algorithm("NSGA-II", limited, pop_size=20), ("n_gen", 2), seed=1, verbose=True)
    printed = rows(capsys.readouterr().out)
    assert [set(line) for line in printed] == [{"n_gen", "n_eval", "legal"}] * 2, (
        "no path keeps the limit, so there is no front"
    )
    assert [line["legal"] for line in printed] == ["0", "0"]


class Bends(Objective):
    """Does not say how it adds up."""

    name = "bends"

    def __call__(self, paths, prepared):
        return np.asarray(paths.turn) / 45.0


def test_no_distance_where_the_front_cannot_be_known(capsys):
    problem = GridPathProblem(random_dense_grid(8, 0.1, 11), (0, 0), (7, 7), objectives=("length", Bends()))
    minimize(problem, make_algorithm("NSGA-II", problem, pop_size=20), ("n_gen", 2), seed=1, verbose=True)
    assert list(rows(capsys.readouterr().out)[0]) == ["n_gen", "n_eval", "legal", "length"]


def test_the_front_is_looked_for_once_and_briefly(monkeypatch, capsys):
    problem = GridPathProblem(random_dense_grid(8, 0.1, 11), (0, 0), (7, 7))
    budgets = []

    def exact_front(problem, budget):
        budgets.append(budget.max_seconds)
        return found

    found = copy.copy(ExactFront(max_labels=0).setup(problem, seed=1))
    found.next()
    found = found.found
    assert not found.complete
    monkeypatch.setattr("pymoo_gridpath.problems.grid_path.exact_front", exact_front)
    algorithm = make_algorithm("NSGA-II", problem, pop_size=20)
    for _ in range(3):
        with pytest.warns(UserWarning, match=r"no Pareto front: the search ended early"):
            minimize(problem, algorithm, ("n_gen", 2), seed=1, verbose=True)
        assert "igd+" not in capsys.readouterr().out
    assert budgets == [2.0]


def test_the_exact_front_prints_no_distance_and_is_not_computed_again(monkeypatch, capsys):
    problem = GridPathProblem(random_dense_grid(8, 0.1, 11), (0, 0), (7, 7))
    monkeypatch.setattr(problem, "pareto_front", None)
    result = minimize(problem, ExactFront(), verbose=True)
    (line,) = rows(capsys.readouterr().out)
    found = result.algorithm.found
    expected = {"n_gen": "1", "n_eval": str(len(result.F)), "points": str(len(result.F)), "certified": "0 %"}
    assert line == expected | {"labels": f"{found.n_labels:,}", "seconds": f"{found.seconds:.2f}"}
    early = minimize(problem, ExactFront(max_seconds=0.0), verbose=True)
    (line,) = rows(capsys.readouterr().out)
    assert (line["points"], line["certified"]) == ("0", "-") or len(early.pop)


def test_the_papers_planner_shows_it_too():
    setup = ahmed_deb_2013(random_dense_grid(8, 0.1, 11), (0, 0), (7, 7), pop_size=20, n_gen=2)
    assert isinstance(setup.algorithm.output, PathOutput)


@pytest.mark.parametrize("name", ["NSGA-II", "MOEA/D", "exact"])
def test_a_display_of_ones_own_is_kept_and_none_is_shared(name, make_problem):
    problem, own = make_problem(), Output()
    assert make_algorithm(name, problem, output=own).output is own
    first, second = (make_algorithm(name, problem).output for _ in range(2))
    assert isinstance(first, FrontOutput if name == "exact" else PathOutput)
    assert first is not second and first.columns is not second.columns
