"""What the exact front is to users: of problems, as an algorithm, with and without numba."""

from __future__ import annotations

import json
import os
import pickle
import subprocess
import sys

import numpy as np
import pytest
from exact_fronts import Cost, random_grid
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.optimize import minimize
from pymoo.problems import get_problem

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import ExactFront
from pymoo_gridpath.decision import TradeOffSet
from pymoo_gridpath.decision.export import json_text
from pymoo_gridpath.errors import CapabilityError, GridPathError
from pymoo_gridpath.exact import Budget, exact_front
from pymoo_gridpath.maps import load_map, shipped_maps
from pymoo_gridpath.objectives import Objective
from pymoo_gridpath.operators import default_operators
from pymoo_gridpath.problems import random_dense_grid
from pymoo_gridpath.representations import CellSequence


class NoField(Objective):
    name = label = "mystery"

    def __call__(self, paths, prepared):
        return paths.length**2


class Inconsistent(Objective):
    name = label = "inconsistent"

    def field(self, grid):
        return np.ones(grid.shape)

    def __call__(self, paths, prepared):
        return 2.0 * paths.total(prepared.field)


@pytest.mark.parametrize("item", shipped_maps(), ids=lambda item: item.name)
def test_ends_of_the_front_are_the_shortest_path_and_the_safest(item):
    grid = load_map(item.name)
    problem = GridPathProblem(grid, item.start, item.goal, representation="cells")
    F = problem.pareto_front(max_seconds=60)
    x, y = item.goal
    assert F[0, 0] == pytest.approx(grid.shortest_lengths(item.start)[y, x], abs=1e-9)
    safest = GridPathProblem(grid, item.start, item.goal, representation="cells", objectives=["vulnerability"])
    assert F[-1, 1] == safest.pareto_front(max_seconds=60)[0, 0] == F[:, 1].min()
    assert (np.diff(F[:, 0]) > 0).all() and (np.diff(F[:, 1]) < 0).all()


def test_front_and_set_of_a_problem_belong_together():
    problem = GridPathProblem(random_grid(24, 1), (0, 0), (23, 23), "integer")
    front, paths = problem.pareto_front(max_seconds=60), problem.pareto_set(max_seconds=60)
    np.testing.assert_array_equal(problem.evaluate(paths), front)
    assert (problem.decode(paths).interfering_cells == 0).all()
    assert len(front) > 5


def test_the_front_of_any_path_dominates_that_of_monotone_ones():
    grid = random_grid(24, 1)
    monotone = GridPathProblem(grid, (0, 0), (23, 23), "integer").pareto_front(max_seconds=60)
    any_path = GridPathProblem(grid, (0, 0), (23, 23), representation="cells").pareto_front(max_seconds=60)
    assert all((any_path <= f).all(axis=1).any() for f in monotone)


def test_more_objectives_keep_every_point():
    grid = random_grid(16, 2)
    two = GridPathProblem(grid, (0, 0), (15, 15), "integer").pareto_front(max_seconds=60)
    three = GridPathProblem(grid, (0, 0), (15, 15), "integer", objectives=["length", "vulnerability", "turn"]).pareto_front(
        max_seconds=60
    )
    assert {tuple(f) for f in two} <= {tuple(f[:2]) for f in three}
    assert len(three) > len(two)


def test_penalty_and_constraint_leave_the_front_as_it_is_and_a_limit_cuts_it():
    grid = random_grid(20, 3)
    F = GridPathProblem(grid, (0, 0), (19, 19), "integer").pareto_front(max_seconds=60)
    constrained = GridPathProblem(grid, (0, 0), (19, 19), "integer", obstacles="constraint").pareto_front(max_seconds=60)
    np.testing.assert_array_equal(constrained, F)
    limit = float(np.median(F[:, 1]))
    limited = GridPathProblem(grid, (0, 0), (19, 19), "integer", obstacles="limit", potential_limit=limit).pareto_front(
        max_seconds=60
    )
    np.testing.assert_array_equal(limited, F[F[:, 1] <= limit])


def test_objectives_that_do_not_add_up_have_no_exact_front():
    grid = random_grid(8, 0)
    problem = GridPathProblem(grid, (0, 0), (7, 7), "integer", objectives=["length", NoField()])
    assert problem.pareto_front(max_seconds=60) is None
    assert problem.pareto_set(max_seconds=60) is None
    with pytest.raises(CapabilityError, match="has no field"):
        minimize(problem, ExactFront())
    with pytest.raises(GridPathError, match="'inconsistent' scores a path otherwise"):
        exact_front(GridPathProblem(grid, (0, 0), (7, 7), "integer", objectives=["length", Inconsistent()]))


def test_more_than_three_objectives_are_refused():
    a, b = (Cost(name, np.ones((8, 8))) for name in "ab")
    problem = GridPathProblem(random_grid(8, 0), (0, 0), (7, 7), "integer", objectives=["length", "turn", a, b])
    assert problem.pareto_front(max_seconds=60) is None
    with pytest.raises(CapabilityError, match="4 objectives, expected at most 3"):
        exact_front(problem)


@pytest.mark.parametrize("objectives", [("length", "vulnerability"), ("length", "vulnerability", "turn")])
def test_the_front_of_rows_that_are_too_short_is_that_of_the_paths_that_fit(objectives):
    grid = OccupancyGrid(np.pad(np.ones((3, 3)), ((3, 3), (3, 3))))
    coding = CellSequence(grid, (0, 4), (8, 4), max_cells=9)
    roomy, problem = (GridPathProblem(grid, (0, 4), (8, 4), rows, objectives) for rows in ("cells", coding))
    whole, found = exact_front(roomy), exact_front(problem)
    cells = roomy.representation.to_sequences(whole.X).lengths
    fits = cells <= 9
    assert whole.complete and 0 < fits.sum() < len(fits)
    assert found.complete and found.message == (
        f"all {len(found.F)} points found of paths with at most 9 cells, the max_cells of the representation; "
        f"without that limit the front has paths of up to {cells.max()}"
    )
    # Points that only longer paths dominate may come in besides.
    assert {*map(tuple, whole.F[fits])} <= {*map(tuple, found.F)}
    np.testing.assert_array_equal(problem.pareto_front(max_seconds=60), found.F)
    np.testing.assert_array_equal(problem.evaluate(found.X), found.F)
    # Where only longer paths keep the potential limit, that is said; where none do, rows are long enough.
    safe = {"obstacles": "limit", "potential_limit": whole.F[:, 1].min()}
    found = exact_front(GridPathProblem(grid, (0, 4), (8, 4), coding, objectives, **safe))
    assert (
        found.complete
        and len(found.F) == 0
        and found.message
        == (
            f"no legal path with at most 9 cells, the max_cells of the representation, keeps the potential limit of "
            f"{safe['potential_limit']:g}; paths of up to {cells.max()} cells do"
        )
    )
    safe["potential_limit"] *= 0.9
    found = exact_front(GridPathProblem(grid, (0, 4), (8, 4), coding, objectives, **safe))
    assert found.complete and found.message == f"no legal path keeps the potential limit of {safe['potential_limit']:g}"


def test_rows_are_long_enough_for_points_that_only_rounding_or_the_limit_takes_from_a_front():
    """What a search passes over in the end does not count, however long its path."""
    occupied = np.array([[1, 0, 0, 0, 0, 1], [1, 0, 0, 1, 0, 0], [0, 1, 1, 0, 0, 0], [0, 1, 1, 0, 0, 0], [0, 0, 1, 0, 0, 0]])
    costs = [
        [0, 1e6, 1e9, 1e-8, 1e-9, 0],
        [0, 1e-8, 100, 0, 1e-6, 1],
        [1e8, 0, 0, 1e-5, 1e-5, 1e-6],
        [1e-3, 0, 0, 1e-7, 1e7, 100],
        [1e8, 1e-9, 0, 1e-9, 10, 0.01],
    ]
    grid = OccupancyGrid(occupied, corner_cutting=True)
    coding = CellSequence(grid, (4, 2), (0, 2), max_cells=5)
    problems = [(1, GridPathProblem(grid, (4, 2), (0, 2), coding, ["length", Cost("a", costs)]))]

    occupied, costs = np.zeros((9, 10)), np.zeros((9, 10))
    occupied[8, 3] = 1
    for value, cells in {
        1: [(0, 7), (3, 9), (5, 0), (5, 7), (6, 9), (7, 4), (7, 5), (7, 6), (8, 0)],
        3: [(1, 8), (2, 0), (2, 3), (2, 4), (3, 4), (4, 2), (4, 7), (6, 4), (8, 5)],
    }.items():
        costs[tuple(np.transpose(cells))] = value
    grid = OccupancyGrid(occupied)
    coding = CellSequence(grid, (5, 8), (4, 5), max_cells=9)
    limit = {"obstacles": "limit", "potential_limit": 0.018408716656267643}
    objectives = ["vulnerability", "turn", Cost("a", costs)]
    problems.append((2, GridPathProblem(grid, (5, 8), (4, 5), coding, objectives, **limit)))
    for n, problem in problems:
        found = exact_front(problem)
        assert found.message == f"all {n} point{'s' if n > 1 else ''} found"
        np.testing.assert_array_equal(problem.evaluate(found.X, return_values_of=["F"]), found.F)


@pytest.mark.parametrize("objectives", [("length", "turn"), ("turn", "vulnerability"), ("length", "vulnerability", "turn")])
def test_cells_have_room_for_paths_that_turn_little(objectives):
    """A straight way around a slalom turns little, and is far longer than the shortest and the safest path."""
    width, height = 21, 31
    occupied = np.ones((height, width), dtype=bool)
    occupied[:3] = False
    for x in range(1, width - 1, 2):
        occupied[slice(1, 3) if x // 2 % 2 else slice(0, 2), x] = True
    occupied[:, [0, -1]] = occupied[-1] = False
    problem = GridPathProblem(OccupancyGrid(occupied), (0, 0), (width - 1, 0), "cells", objectives)
    front = problem.pareto_front(max_seconds=60)
    assert front[:, objectives.index("turn")].min() == 180.0


def test_what_is_no_path_problem_or_no_budget_is_refused():
    other = get_problem("zdt1")
    run = minimize(other, NSGA2(pop_size=4), ("n_gen", 1))
    for use in (
        lambda: minimize(other, ExactFront()),
        lambda: default_operators(other),
        lambda: TradeOffSet.from_results(run),
    ):
        with pytest.raises(GridPathError, match="the problem is of the class ZDT1, expected a path problem"):
            use()
    problem = GridPathProblem(OccupancyGrid(np.zeros((4, 4))), (0, 0), (3, 3), "integer")
    with pytest.raises(GridPathError, match="budget is 3, expected a Budget"):
        exact_front(problem, 3)  # pyright: ignore[reportArgumentType]
    with pytest.raises(GridPathError, match="max_labels is 1j, expected a number, zero or more"):
        Budget(max_labels=1j)  # pyright: ignore[reportArgumentType]
    assert exact_front(problem, Budget(max_memory=np.inf)).complete  # pyright: ignore[reportArgumentType]
    with pytest.raises(GridPathError, match="watch is 3, expected a function"):
        ExactFront(watch=3)


def test_files_say_whether_a_front_is_complete():
    problem = GridPathProblem(random_grid(20, 4), (0, 0), (19, 19), "cells")
    for max_labels, complete in ((None, True), (10, False)):
        result = minimize(problem, ExactFront(max_labels=max_labels))
        run = json.loads(json_text(TradeOffSet.from_results(result)))["settings"]["runs"][0]
        assert run["complete"] is complete and run["message"] == result.message
        assert run["budget"] == ({} if max_labels is None else {"max_labels": 10})
    three = GridPathProblem(problem.grid, (0, 0), (19, 19), "cells", ("length", "vulnerability", "turn"))
    with pytest.raises(GridPathError, match="Result 0 holds no paths: ended early, the budget of 10 labels is used up"):
        TradeOffSet.from_results(minimize(three, ExactFront(max_labels=10)))


def test_a_front_of_one_point_is_told_in_the_singular():
    assert (
        exact_front(GridPathProblem(OccupancyGrid(np.zeros((4, 4))), (0, 0), (3, 3), "integer")).message == "all 1 point found"
    )


def test_as_an_algorithm():
    problem = GridPathProblem(random_grid(20, 4), (0, 0), (19, 19), "integer", obstacles="constraint")
    result = minimize(problem, ExactFront(), seed=3)
    np.testing.assert_array_equal(result.F, problem.pareto_front(max_seconds=60))
    assert result.success is True
    assert result.message == f"all {len(result.F)} points found"
    assert result.algorithm.evaluator.n_eval == len(result.F)
    assert result.algorithm.n_gen == 2  # as for any algorithm after its first generation
    trade_off = TradeOffSet.from_results(result)
    np.testing.assert_array_equal(trade_off.F, result.F)
    again = pickle.loads(pickle.dumps(result.algorithm))
    np.testing.assert_array_equal(again.found.F, result.F)


def test_a_limit_that_no_path_keeps():
    problem = GridPathProblem(random_grid(10, 1), (0, 0), (9, 9), "integer", obstacles="limit", potential_limit=1e-12)
    result = minimize(problem, ExactFront())
    assert result.F is None
    assert result.message == "no legal path keeps the potential limit of 1e-12"


def test_arguments_are_checked():
    with pytest.raises(CapabilityError, match="takes no argument 'seconds'"):
        ExactFront(seconds=3)
    for value in (-1, float("nan"), "1G"):
        with pytest.raises(GridPathError, match="expected a number, zero or more"):
            ExactFront(max_memory=value)


def test_both_ends_of_a_front_of_two_are_found_where_their_searches_are_short():
    problem = GridPathProblem(random_grid(60, 2), (0, 0), (59, 59), "cells")
    found = exact_front(problem, Budget(max_seconds=0.0))
    front = problem.pareto_front(max_seconds=60)
    np.testing.assert_array_equal(found.F[[0, -1]], front[[0, -1]])
    assert not found.complete


SCRIPT = """
import hashlib, sys
{block}
import numpy as np
from pymoo_gridpath import GridPathProblem
from pymoo_gridpath.compiled import COMPILED
from pymoo_gridpath.exact import exact_front
from pymoo_gridpath.problems import random_dense_grid
from pymoo_gridpath.representations import CellSequence
print(COMPILED)
for seed, objectives, coding in ((1, ["length", "vulnerability"], "cells"), (2, ["length", "vulnerability", "turn"], "integer"),
                                 (3, ["turn", "vulnerability"], "cells"), (4, ["length", "vulnerability", "turn"], 16)):
    grid = random_dense_grid(14, 0.3, seed)
    if isinstance(coding, int):
        coding = CellSequence(grid, (0, 0), (13, 13), max_cells=coding)
    found = exact_front(GridPathProblem(grid, (0, 0), (13, 13), objectives=objectives, representation=coding))
    assert ("with at most" in found.message) == (seed == 4)
    print(len(found.F), hashlib.sha256(found.X.tobytes() + found.F.tobytes()).hexdigest(), found.n_labels)
"""


@pytest.mark.parametrize("without", ["numba", "its compiler"])
def test_kernels_give_the_same_bits_compiled_and_plain(without):
    def run(block, **environment):
        done = subprocess.run(
            [sys.executable, "-c", SCRIPT.format(block=block)],
            env={**os.environ, **environment},
            capture_output=True,
            text=True,
            check=True,
        )
        return done.stdout.splitlines()

    compiled = run("")
    if without == "numba":
        # A finder that knows no numba stands for a machine without it.
        block = (
            "import importlib.util as u; find = u.find_spec\n"
            "u.find_spec = lambda name, *rest: None if name == 'numba' else find(name, *rest)\n"
            "sys.modules['numba'] = None"
        )
        plain = run(block)
        assert plain[0] == "False"
    else:
        plain = run("", NUMBA_DISABLE_JIT="1")
    assert len(compiled) == 5
    assert plain[1:] == compiled[1:]


def test_threads_change_nothing(monkeypatch):
    for objectives in (("length", "vulnerability"), ("length", "turn")):
        problem = GridPathProblem(random_grid(48, 3), (0, 0), (47, 47), objectives=objectives, representation="cells")
        plain = exact_front(problem)
        with monkeypatch.context() as changed:
            changed.setattr("pymoo_gridpath.exact.supported._CELLS_WORTH_THREADS", 0)
            threaded = exact_front(problem)
        np.testing.assert_array_equal(threaded.X, plain.X)
        np.testing.assert_array_equal(threaded.F, plain.F)
        assert threaded.n_labels == plain.n_labels and len(plain.F) > 3


def test_dense_scenarios_have_a_front_of_few_paths():
    # With p0 = 1 only the cells of one path are free.
    for seed in range(5):
        grid = random_dense_grid(16, 1.0, seed)
        assert len(GridPathProblem(grid, (0, 0), (15, 15), "integer").pareto_front(max_seconds=60)) >= 1


@pytest.mark.parametrize("objectives", [("length", "vulnerability"), ("vulnerability", "length"), ("length", "turn")])
def test_fronts_and_paths_are_the_same_in_the_part_around_them_and_on_the_whole(objectives, monkeypatch):
    for seed in range(6):
        grid = random_grid(40, seed, 0.25)
        free = np.argwhere(grid.regions == grid.regions[0, 0])
        start, goal = (tuple(cell[::-1].tolist()) for cell in np.random.default_rng(seed).choice(free, 2, replace=False))
        problem = GridPathProblem(grid, start, goal, "cells", list(objectives))
        part = exact_front(problem)
        with monkeypatch.context() as whole:
            whole.setattr("pymoo_gridpath.search.moves._WORTH_A_PART", 0.0)
            found = exact_front(problem)
        assert np.array_equal(part.F, found.F) and np.array_equal(part.X, found.X)
