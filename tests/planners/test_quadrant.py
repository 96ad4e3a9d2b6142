"""Quadrant selection against all of its branches, walked one by one in plain Python."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import QuadrantSelection, make_algorithm
from pymoo_gridpath.cli import main
from pymoo_gridpath.errors import CapabilityError, GridPathError
from pymoo_gridpath.maps import load_map
from pymoo_gridpath.representations import CellSequence
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.sight import visible
from pymoo_gridpath.study import AlgorithmSpec, ProblemSpec, Study, run_study
from pymoo_gridpath.testing import PlannerSuite
from pymoo_gridpath.testing.branches import enumerate_branches
from pymoo_gridpath.testing.enumeration import CORNER_RULES, random_query
from pymoo_gridpath.testing.reference import is_legal, length, turn


class TestQuadrantSelection(PlannerSuite):
    def make(self):
        return QuadrantSelection()


class TestRawAlternatives(PlannerSuite):
    def make(self):
        return QuadrantSelection(alternatives=3, smooth=False)


def seconds(cells, resolution=1.0):
    return length(cells) * resolution / 0.24 + 0.02 * turn(cells)


def plan(grid, start, goal, **arguments):
    problem = GridPathProblem(grid, start, goal, CellSequence(grid, start, goal, max_cells=grid.occupied.size))
    planner = QuadrantSelection(**arguments)
    return problem, planner.plan(problem), planner.found


def cells_of(raw):
    return [tuple(cell) for cell in raw.tolist()]


@pytest.mark.parametrize("strict", [False, True])
def test_alternatives_are_those_of_a_full_enumeration(strict):
    rng, n_paths, n_none = np.random.default_rng(3), 0, 0
    for _ in range(250):
        grid, start, goal = random_query(rng, 3, 12, rules=CORNER_RULES)
        paths = enumerate_branches(grid, start, goal, strict)
        _, planned, found = plan(grid, start, goal, max_paths=1000, strict=strict)
        assert found.n_alternatives == len(paths) == len(found.raw)
        assert sorted(map(cells_of, found.raw)) == sorted(paths)
        assert found.seconds == pytest.approx(sorted(map(seconds, paths)))
        assert [seconds(cells_of(raw)) for raw in found.raw] == pytest.approx(found.seconds)
        assert planned.success == bool(paths) and (strict or paths)
        n_paths, n_none = n_paths + len(paths), n_none + (not paths)
    assert n_paths > 200 and (n_none > 20) == strict


def test_every_query_that_has_a_path_is_solved_legally():
    rng = np.random.default_rng(11)
    for _ in range(300):
        grid, start, goal = random_query(rng, 3, 40, rules=CORNER_RULES)
        problem, planned, found = plan(grid, start, goal, alternatives=3)
        assert planned.success and found.n_alternatives >= 1
        moves = Moves(grid)
        assert len(planned.paths) == len(found.waypoints) <= 3
        paths = problem.decode(planned.paths)
        for k, waypoints in enumerate(found.waypoints):
            cells = cells_of(paths.cells(k))
            assert is_legal(cells, grid, start, goal)
            index = waypoints.cells[:, 1] * grid.width + waypoints.cells[:, 0]
            assert visible(moves, index[:-1], index[1:]).all()
            assert waypoints.length <= length(cells) + 1e-9
        assert length(cells_of(paths.cells(0))) <= length(cells_of(found.raw[0])) + 1e-9
        assert (np.diff(found.seconds) >= -1e-9).all() and len(found.raw) == min(found.n_alternatives, 64)


def test_the_list_is_the_begin_of_the_whole_one_by_the_time_of_the_walk():
    """Where no walk crosses itself; where one does, what is left of a later one may be quicker."""
    rng, compared = np.random.default_rng(7), 0
    while compared < 40:
        grid, start, goal = random_query(rng, 8, 20, rules=CORNER_RULES)
        whole, part = (plan(grid, start, goal, max_paths=most)[2] for most in (1000, 4))
        if 4 < whole.n_alternatives < 1000:
            assert len(part.raw) == 4 and part.n_alternatives == whole.n_alternatives
            assert (part.seconds >= whole.seconds[:4] - 1e-9).all()
            compared += 1


def test_time_is_of_metres_and_degrees_and_the_first_turn_is_none():
    grid = OccupancyGrid([[0, 0, 0, 0, 0], [0, 0, 1, 1, 0], [0, 0, 0, 0, 0]], resolution=0.5)
    _, _, found = plan(grid, (0, 0), (4, 2), smooth=False)
    assert found.seconds[0] == pytest.approx((4 + math.sqrt(2)) * 0.5 / 0.24 + 0.02 * 135)
    assert plan(grid, (0, 0), (4, 2), speed=1.0, turn_seconds=0.0)[2].seconds[0] == pytest.approx((4 + math.sqrt(2)) * 0.5)


def test_what_is_quicker_depends_on_the_size_of_a_cell():
    """Where cells are small, turns count; where they are large, lengths do."""
    rng, n_other = np.random.default_rng(2), 0
    for _ in range(200):
        grid, start, goal = random_query(rng, 6, 16, rules=CORNER_RULES)
        paths = {tuple(path) for path in enumerate_branches(grid, start, goal)}
        small, large = (plan(grid.replace(resolution=size), start, goal, max_paths=1000)[2] for size in (1e-6, 1e6))
        small, large = cells_of(small.raw[0]), cells_of(large.raw[0])
        assert (turn(small), length(small)) == pytest.approx(min((turn(path), length(path)) for path in paths))
        assert (length(large), turn(large)) == pytest.approx(min((length(path), turn(path)) for path in paths))
        n_other += turn(small) < turn(large)
    assert n_other >= 3


def test_an_open_field_is_crossed_by_as_many_tests_as_steps():
    _, planned, found = plan(OccupancyGrid(np.zeros((9, 12))), (1, 1), (10, 5))
    assert (found.probes, found.cells, found.free_cells, found.n_alternatives) == (9, 10, 10, 1)
    assert planned.message == "met no obstacle"


def test_cells_that_are_looked_at_are_counted_once_and_occupied_ones_apart():
    _, _, found = plan(OccupancyGrid([[0, 0, 0], [0, 1, 0], [0, 0, 0]]), (0, 1), (2, 1))
    # Around both sides of the middle: all cells, more tests than that.
    assert (found.cells, found.free_cells) == (9, 8) and found.probes > 9


def test_alternatives_differ_and_come_in_order():
    grid = load_map("warehouse")
    problem = GridPathProblem(grid, (2, 3), (57, 36))
    result = minimize(problem, QuadrantSelection(alternatives=4))
    assert len(result.pop) == 4 and len(np.unique(result.pop.get("X"), axis=0)) == 4
    assert result.success and "which branch in" in result.message
    again = minimize(problem, QuadrantSelection(alternatives=4), seed=7)
    assert np.array_equal(again.pop.get("X"), result.pop.get("X"))


def test_the_letter_of_the_paper_says_when_it_finds_nothing():
    grid = OccupancyGrid([[0, 0, 0, 0], [1, 1, 1, 0], [0, 0, 0, 0]])
    result = minimize(GridPathProblem(grid, (0, 2), (0, 0)), QuadrantSelection(strict=True))
    assert result.X is None and result.success is False
    assert result.message == (
        "found no path: in 1 of 1 place where it met an obstacle, both steps beside the blocked one are illegal"
    )
    assert minimize(GridPathProblem(grid, (0, 2), (0, 0)), QuadrantSelection()).success


def test_the_number_of_alternatives_has_no_bound():
    """Each wall across the way is passed on either side, and doubles them."""
    occupied = np.zeros((7, 603), dtype=bool)
    occupied[2:5, 1::2] = True
    _, planned, found = plan(OccupancyGrid(occupied), (0, 3), (602, 3), max_paths=4)
    assert found.n_alternatives == 2**301 and len(found.raw) == 4
    assert planned.message == "found about 10^90 paths, which branch in 301 places"


def test_codings_that_cannot_turn_back_are_refused():
    problem = GridPathProblem(OccupancyGrid(np.zeros((5, 5))), (0, 0), (4, 4), "integer")
    said = "QuadrantSelection plans paths that may turn back, which the integer representation cannot code"
    for call in (lambda: make_algorithm("qsa", problem), lambda: minimize(problem, QuadrantSelection())):
        with pytest.raises(CapabilityError, match=said):
            call()


def test_paths_without_room_or_over_the_limit_are_left_out_and_said():
    occupied = np.zeros((12, 12))
    occupied[2:10, 5] = occupied[9, 2:5] = occupied[2, 3:5] = 1
    grid = OccupancyGrid(occupied)
    raw = minimize(GridPathProblem(grid, (3, 5), (8, 5)), QuadrantSelection(smooth=False)).algorithm.found.raw
    lengths = [len(path) for path in raw]
    assert lengths[0] < lengths[1]
    tight = GridPathProblem(grid, (3, 5), (8, 5), CellSequence(grid, (3, 5), (8, 5), max_cells=lengths[0]))
    result = minimize(tight, QuadrantSelection(smooth=False, alternatives=2))
    assert len(result.pop) == 1 and result.success
    assert f"; 1 of 2 paths left out, the longest visits {lengths[1]} cells, a row has room for" in result.message
    limited = GridPathProblem(grid, (3, 5), (8, 5), obstacles="limit", potential_limit=1e-9)
    result = minimize(limited, QuadrantSelection())
    assert not result.success and result.message.endswith("; 1 of 1 path left out, over the potential limit")


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"speed": 0.0}, "speed is 0.0, expected a positive number of metres per second"),
        ({"turn_seconds": -1}, "turn_seconds is -1, expected a number of seconds, zero or more"),
        ({"alternatives": 65}, "alternatives is 65, expected a whole number from 1 to max_paths, 64"),
        ({"max_paths": 10**9}, "max_paths is 1000000000, expected a whole number of at least 1 and at most 1,000"),
        ({"smooth": 1}, "smooth is 1, expected True or False"),
        ({"strict": "no"}, "strict is 'no', expected True or False"),
        ({"sped": 1}, "QuadrantSelection takes no argument 'sped'; did you mean 'speed'"),
    ],
)
def test_wrong_arguments_are_refused(given, said):
    with pytest.raises(GridPathError, match=said):
        QuadrantSelection(**given)


@pytest.mark.usefixtures("undrawn")
def test_it_works_by_name(tmp_path, capsys):
    problem = GridPathProblem(load_map("office"), (3, 4), (56, 35))
    assert minimize(problem, make_algorithm("QSA", problem, alternatives=2)).success
    assert main(["plan", "office", "--algorithm", "qsa", "-o", str(tmp_path / "plan")]) == 0
    assert "shortest" in capsys.readouterr().out
    study = Study(
        problems=[ProblemSpec(name="one", map="paper16", representation="cells")],
        algorithms=[AlgorithmSpec(algorithm="qsa"), AlgorithmSpec(algorithm="NSGA2", pop_size=10)],
        seeds=2,
        budget={"generations": 2},
    )
    outcome = run_study(study, tmp_path / "study")
    # Both runs of the search, one of each planner.
    assert (outcome.n_failed, outcome.n_run) == (0, 4)
