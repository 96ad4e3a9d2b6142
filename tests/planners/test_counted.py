"""Searches that count cells, against scipy's shortest paths, definitions, and the counts of PathFinding.js."""

from __future__ import annotations

import csv
import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from pymoo.optimize import minimize
from scipy import sparse
from scipy.sparse import csgraph

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import (
    AStar,
    BestFirst,
    BreadthFirst,
    Dijkstra,
    JumpPointSearch,
    OrthogonalJumpPointSearch,
    make_algorithm,
)
from pymoo_gridpath.cli import main
from pymoo_gridpath.errors import CapabilityError, GridPathError
from pymoo_gridpath.maps import load_map, shipped_maps
from pymoo_gridpath.search.counted import best_first, breadth_first
from pymoo_gridpath.search.jump import _KEEPING, _ROUNDING, jump_points, kept_headings, orthogonal_jump_points
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.study import AlgorithmSpec, ProblemSpec, Study, run_study
from pymoo_gridpath.testing import PlannerSuite
from pymoo_gridpath.testing.enumeration import STEPS, legal_steps, random_query
from pymoo_gridpath.testing.reference import is_legal, length

CONSISTENT = ("octile", "euclidean", "chebyshev")
NAMES = {
    "A-Star": AStar,
    "Dijkstra": Dijkstra,
    "breadth-first": BreadthFirst,
    "best-first": BestFirst,
    "JPS": JumpPointSearch,
    "orthogonal JPS": OrthogonalJumpPointSearch,
}


class TestAStar(PlannerSuite):
    def make(self):
        return AStar()


class TestDijkstra(PlannerSuite):
    def make(self):
        return Dijkstra()


class TestBreadthFirst(PlannerSuite):
    def make(self):
        return BreadthFirst()


class TestBestFirst(PlannerSuite):
    def make(self):
        return BestFirst("manhattan")


class TestJumpPointSearch(PlannerSuite):
    def make(self):
        return JumpPointSearch()


class TestOrthogonalJumpPointSearch(PlannerSuite):
    def make(self):
        return OrthogonalJumpPointSearch()


# -- what they promise --------------------------------------------------------------------------------------------------------


def cells_of(moves, path):
    return [tuple(cell) for cell in moves.cells(path).tolist()]


def steps_graph(grid, straight_only=False):
    rows, columns = [], []
    for y, x in np.argwhere(~grid.occupied):
        for m, (u, v) in legal_steps(grid, (int(x), int(y))):
            if not straight_only or m % 2 == 0:
                rows.append(y * grid.width + x)
                columns.append(v * grid.width + u)
    ends = np.array([rows, columns], dtype=np.int32)  # what csgraph takes before scipy 1.15
    return sparse.csr_array((np.ones(len(rows)), tuple(ends)), shape=(grid.occupied.size,) * 2)


def test_paths_are_as_short_as_promised():
    rng, n_without = np.random.default_rng(5), 0
    for _ in range(150):
        grid, start, goal = random_query(rng, 3, 25)
        moves = Moves(grid)
        ends = moves.index(start), moves.index(goal)
        shortest = grid.shortest_length(start, goal)
        exact = [best_first(moves, *ends, heuristic) for heuristic in ("none", *CONSISTENT)]
        exact += [jump_points(moves, *ends, grid.neighbourhood, heuristic) for heuristic in ("none", *CONSISTENT)]
        loose = [best_first(moves, *ends, "manhattan"), best_first(moves, *ends, "octile", greedy=True)]
        fewest, straight = breadth_first(moves, *ends), orthogonal_jump_points(moves, *ends)
        for found in (*exact, *loose, fewest):
            assert is_legal(cells_of(moves, found.path), grid, start, goal)
            assert found.closed <= found.opened <= found.n_cells and (found.tested > 0 or found.n_cells == found.opened)
        assert [length(cells_of(moves, found.path)) for found in exact] == pytest.approx([shortest] * len(exact))
        assert all(length(cells_of(moves, found.path)) >= shortest - 1e-9 for found in loose)
        assert len(fewest.path) - 1 == csgraph.dijkstra(steps_graph(grid), unweighted=True, indices=ends[0])[ends[1]]
        most = csgraph.dijkstra(steps_graph(grid, straight_only=True), unweighted=True, indices=ends[0])[ends[1]]
        assert math.isinf(most) if len(straight.path) == 0 else len(straight.path) - 1 == most
        if len(straight.path):
            assert is_legal(cells_of(moves, straight.path), grid, start, goal)
            assert length(cells_of(moves, straight.path)) == most
        n_without += len(straight.path) == 0
    assert n_without > 0


def octile_left(grid, goal):
    y, x = np.indices(grid.shape)
    dx, dy = abs(x - goal[0]), abs(y - goal[1])
    return np.maximum(dx, dy) + (math.sqrt(2) - 1) * np.minimum(dx, dy)


def between(closed, values, reached):
    """Whether a count lies between the cells whose value is less than that of the goal, and those whose value is no more."""
    return np.count_nonzero(values < reached - 1e-9) <= closed <= np.count_nonzero(values <= reached + 1e-9)


def test_what_is_closed_lies_between_what_must_and_what_may_be():
    rng = np.random.default_rng(6)
    for _ in range(100):
        grid, start, goal = random_query(rng, 3, 30)
        moves = Moves(grid)
        ends = moves.index(start), moves.index(goal)
        lengths = grid.shortest_lengths(start)
        reached = lengths[goal[1], goal[0]]
        assert between(best_first(moves, *ends).closed, lengths, reached)
        # An octile estimate is consistent: no cell is closed whose sum is larger, and all whose sum is less.
        assert between(best_first(moves, *ends, "octile").closed, lengths + octile_left(grid, goal), reached)


@pytest.mark.parametrize("corner_cutting", [False, True, "one side"])
def test_jumps_keep_the_neighbours_that_no_path_around_the_cell_reaches(corner_cutting):
    """By the paper's definition, on all surroundings of a cell: a way around that is as long counts after a straight step."""
    rule = _ROUNDING if corner_cutting else _KEEPING
    for surroundings in itertools.product([0, 1], repeat=8):
        occupied = np.zeros((3, 3), dtype=int)
        for (dx, dy), value in zip(STEPS, surroundings, strict=True):
            occupied[1 + dy, 1 + dx] = value
        grid = OccupancyGrid(occupied, corner_cutting=corner_cutting)
        # The cell itself is free, and left out.
        graph = grid.move_graph().toarray()
        graph[4] = graph[:, 4] = 0
        lengths = csgraph.dijkstra(sparse.csr_array(graph))
        moves = Moves(grid)
        legal = dict(legal_steps(grid, (1, 1)))
        for m in legal:
            x, y = 1 - STEPS[m][0], 1 - STEPS[m][1]
            if not grid.is_free((x, y)) or m not in dict(legal_steps(grid, (x, y))):
                continue
            kept = kept_headings(moves.legal, moves.offsets, 4, m, rule)
            for k, (u, v) in legal.items():
                through = math.hypot(*STEPS[m]) + math.hypot(*STEPS[k])
                other = lengths[3 * y + x, 3 * v + u]
                pruned = (u, v) == (x, y) or (other < through - 1e-9 if m % 2 else other <= through + 1e-9)
                assert bool(kept >> k & 1) == (not pruned), (surroundings, m, k)


# -- counts of PathFinding.js -------------------------------------------------------------------------------------------------


def cells(text):
    """The grid of a drawing, its start and its goal; the top row is the last of the grid."""
    rows = text.split()[::-1]
    ends = [next((row.index(letter), y) for y, row in enumerate(rows) if letter in row) for letter in "SG"]
    return OccupancyGrid([[letter == "#" for letter in row] for row in rows]), *ends


SPIRAL = """
S.........
########..
.......#..
.#####.#..
.#...#.#..
.#.G.#.#..
.#.###.#..
.#.....#..
.#######..
..........
"""


@pytest.mark.parametrize(("corner_cutting", "counts"), [(True, (63, 61)), (False, (63, 61))])
def test_a_spiral_takes_as_many_cells_as_in_pathfinding_js(corner_cutting, counts):
    grid, start, goal = cells(SPIRAL)
    moves = Moves(grid.replace(corner_cutting=corner_cutting))
    found = breadth_first(moves, moves.index(start), moves.index(goal))
    assert (found.opened, found.closed) == counts


STEPS_OF = {
    "cut": {"corner_cutting": True},
    "kept": {"corner_cutting": False},
    "one side": {"corner_cutting": "one side"},
    "four moves": {"moves": 4},
}


def test_every_rule_for_steps_has_the_lengths_and_counts_of_pathfinding_js():
    """From the first cell of the first row to the last of the last, on grids on which the rules differ."""
    lines = (Path(__file__).parent / "steps_of_pathfinding_js.csv").read_text().splitlines()
    cases = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    assert len(cases) == 48
    for case in cases:
        grid = OccupancyGrid([[int(cell) for cell in row] for row in case["rows"].split("/")], **STEPS_OF[case["rule"]])
        moves = Moves(grid)
        ends = 0, moves.n_cells - 1
        for found in (best_first(moves, *ends), jump_points(moves, *ends, grid.neighbourhood)):
            total = length(cells_of(moves, found.path)) if len(found.path) else -1.0
            assert total == pytest.approx(float(case["length"]), abs=1e-3)
        found = breadth_first(moves, *ends)
        assert (found.opened, found.closed) == (int(case["opened"]), int(case["closed"]))


def golden(companions, name):
    with open(companions / name, newline="") as file:
        return list(csv.reader(line for line in file if line.strip() and not line.startswith("#")))


def golden_cases(companions):
    """Yield a grid, a query, and the counts of each search in PathFinding.js: opened, closed, length."""
    queries = {row[0]: row[1:] for row in golden(companions, "counts_maps_queries.csv")[1:]}
    grids = {item.name: load_map(item.path).inflate(item.radius) for item in shipped_maps()}
    rows: dict[str, dict] = {}
    for name in ("counts_six_environments.csv", "counts_maps.csv"):
        for case, search, _, opened, closed, _, _, total in golden(companions, name):
            rows.setdefault(case, {})[search] = int(opened), int(closed), float(total)
    for case, counts in rows.items():
        if "/" in case:
            name, rule = case.split("/")
            grid, start, goal = cells((companions / "environments" / f"{name}.txt").read_text())
            yield grid.replace(corner_cutting=rule == "cut"), start, goal, counts
            continue
        name, query = case.split("#")[0], queries[case]
        if name not in grids:
            grids[name] = load_map(companions.parent / "data" / "movingai" / f"{name}.map")
        x0, y0, x1, y1 = map(int, query[:4])
        yield grids[name].replace(corner_cutting=query[4] == "True"), (x0, y0), (x1, y1), counts


def test_counts_are_those_of_pathfinding_js_where_ties_leave_no_choice(companions):
    n = n_unique = 0
    for grid, start, goal, counts in golden_cases(companions):
        moves = Moves(grid)
        ends = moves.index(start), moves.index(goal)
        lengths = grid.shortest_lengths(start)
        reached = lengths[goal[1], goal[0]]
        # The order of neighbours is the same: so are all counts.
        found = breadth_first(moves, *ends)
        assert (found.opened, found.closed) == counts["BreadthFirst"][:2]
        found = best_first(moves, *ends)
        for closed in (found.closed, counts["Dijkstra"][1]):
            assert between(closed, lengths, reached)
        if np.count_nonzero(np.abs(lengths - reached) < 1e-9) == 1:
            assert found.closed == counts["Dijkstra"][1]
            n_unique += 1
        found = best_first(moves, *ends, "octile")
        for closed in (found.closed, counts["A*(octile)"][1]):
            assert between(closed, lengths + octile_left(grid, goal), reached)
        for exact in ("Dijkstra", "A*(octile)"):
            assert counts[exact][2] == pytest.approx(reached, abs=1e-3)
        straight = orthogonal_jump_points(moves, *ends)
        assert len(straight.path) - 1 == counts["OJPS"][2]
        n += 1
    assert (n, n_unique) == (162, 33)


# -- as planners --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES)
def test_they_work_by_name_and_say_what_they_looked_at(name):
    problem = GridPathProblem(load_map("warehouse"), (2, 3), (57, 36))
    algorithm = make_algorithm(name, problem)
    assert type(algorithm) is NAMES[name]
    result = minimize(problem, algorithm)
    found = result.algorithm.found
    assert result.success and f"{found.opened:,} cells opened, {found.closed:,} closed" in result.message
    assert is_legal([tuple(cell) for cell in found.cells.tolist()], problem.grid, problem.start, problem.goal)
    assert found.operations == found.opened + found.closed + found.tested and ("tested" in result.message) == ("JPS" in name)


def test_a_monotone_coding_is_searched_among_its_own_steps():
    problem = GridPathProblem(load_map("warehouse"), (2, 3), (57, 36), "integer", objectives=["length"])
    for planner in (Dijkstra(), AStar()):
        assert float(minimize(problem, planner).F[0]) == pytest.approx(problem.pareto_front().min())
    for planner in (JumpPointSearch(), OrthogonalJumpPointSearch()):
        with pytest.raises(CapabilityError, match="give the problem representation='cells'"):
            minimize(problem, planner)


def test_no_path_of_straight_steps_is_said():
    grid = OccupancyGrid([[0, 1], [1, 0]], corner_cutting=True)
    result = minimize(GridPathProblem(grid, (0, 0), (1, 1), "cells"), OrthogonalJumpPointSearch())
    assert result.X is None and result.success is False
    assert result.message == "found no path, 1 cell opened, 1 closed"


def test_wrong_arguments_are_refused():
    for cls in (AStar, BestFirst, JumpPointSearch):
        with pytest.raises(
            GridPathError, match="heuristic is 'octil', expected one of octile, euclidean, chebyshev, manhattan"
        ):
            cls(heuristic="octil")
    with pytest.raises(CapabilityError, match="Dijkstra takes no argument 'heuristic'"):
        Dijkstra(heuristic="octile")


@pytest.mark.usefixtures("undrawn")
def test_the_command_line_and_studies_know_them(tmp_path, capsys):
    assert main(["plan", "office", "--algorithm", "jps", "-o", str(tmp_path / "plan")]) == 0
    assert "shortest" in capsys.readouterr().out
    names = ["astar", "dijkstra", "breadth-first", "best-first", "jps", "orthogonal-jps"]
    study = Study(
        problems=[ProblemSpec(name="one", map="paper16", representation="cells")],
        algorithms=[AlgorithmSpec(algorithm=name) for name in names],
        seeds=3,
        budget={"generations": 2},
    )
    outcome = run_study(study, tmp_path / "study")
    # One run of each, and one of the reference.
    assert (outcome.n_failed, outcome.n_run) == (0, len(names) + 1)
