"""Suites by name: against their definitions once more in plain Python, and what is said of wrong arguments."""

from __future__ import annotations

import functools
import itertools
import pickle

import numpy as np
import plain_asletismac as plain
import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.optimize import minimize

from pymoo_gridpath.decision import TradeOffSet, load_json
from pymoo_gridpath.errors import CapabilityError, GridError, GridPathError, UnreachableError
from pymoo_gridpath.exact import exact_front
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.maps import load_map, query_of
from pymoo_gridpath.objectives import Exposure, Length, RandomCost
from pymoo_gridpath.operators import path_operators
from pymoo_gridpath.problems import (
    SMALL_ENVIRONMENTS,
    SUITES,
    Asletismac,
    GuardsGrid,
    RandomCostGrid,
    Suite,
    far_corners,
    make_suite,
    maze_environment,
    small_environment,
)
from pymoo_gridpath.registry import register

NAMES = ("length", "delay", "ascent", "travel_time", "turn")
CHOICES = [chosen for n in (2, 3) for chosen in itertools.combinations(NAMES, n)]
ARGUMENTS = {
    "asletismac": {"instance": "ASLETISMAC_LA_X9_Y9_P3_K3_BF"},
    "random-cost": {"width": 5, "height": 4},
    "guards": {"map": "warehouse", "guards": [[20, 20], [44, 12]]},
    "small-environments": {"environment": "zigzag"},
    "region-of-sight": {"kind": "maze", "seed": 2},
}


def front_of_edges(edges, start, goal):
    """Return the front of a graph, {node: {next node: costs}}, label by label."""
    kept, left = {start: [tuple([0] * len(next(iter(next(iter(edges.values())).values()))))]}, [start]
    while left:
        node = left.pop()
        for other, costs in edges.get(node, {}).items():
            known = kept.setdefault(other, [])
            for label in list(kept[node]):
                new = tuple(map(sum, zip(label, costs, strict=True)))
                if not any(all(a <= b for a, b in zip(old, new, strict=True)) for old in known):
                    known[:] = [old for old in known if not all(a <= b for a, b in zip(new, old, strict=True))] + [new]
                    left.append(other)
    return sorted(kept[goal])


# -- ASLETISMAC -----------------------------------------------------------------------------------------------------------


def test_instances_are_those_of_which_fronts_were_published():
    names = Asletismac.instances()
    assert len(names) == len(set(names)) == 288 and all(name.endswith("_BF") for name in names)
    # Of the larger ones all have a path, as the benchmark finds.
    empty = [name for name in names if plain.instance(name)[1] <= 5 and not plain.front(name, ("length",))]
    assert len(empty) == 16
    for name in empty:
        with pytest.raises(GridError):
            Asletismac(name).problem()


@pytest.mark.parametrize("seed", range(3))
def test_exact_fronts_are_those_of_a_plain_programme(seed):
    """Some drawn at random; a benchmark compares all."""
    rng = np.random.default_rng(seed)
    small = [
        name for back in (False, True) for name in Asletismac.instances(back) if back is False or plain.instance(name)[1] < 9
    ]
    n = 0
    for name in rng.permutation(small):
        chosen = CHOICES[rng.integers(len(CHOICES))]
        expected = plain.front(name, chosen)
        if expected:
            found = exact_front(make_suite("asletismac", instance=str(name)).problem(chosen))
            assert found.complete and plain.same(found.F.tolist(), expected), (name, chosen)
            n += 1
        if n == 25:
            break


@pytest.mark.parametrize("name", ["ASLETISMAC_CH_X9_Y9_PM_K3_BF", "ASLETISMAC_LA_X8_Y8_P1_K2_BT"])
def test_a_search_for_five_objectives_keeps_to_the_suite(name):
    problem = make_suite("asletismac", instance=name).problem()
    assert problem.objective_names == list(NAMES)
    result = minimize(problem, NSGA2(pop_size=20, **path_operators(problem)), ("n_gen", 4), seed=1)
    assert (result.pop.get("interfering_cells") == 0).all()
    paths, allowed = problem.decode(result.X), plain.steps(name)
    for k, scores in enumerate(result.F):
        cells = [(x + 1, y + 1) for x, y in paths.cells(k).tolist()]
        assert not any(plain.is_blocked(name, *cell) for cell in cells)
        headings = [(b[0] - a[0], b[1] - a[1]) for a, b in itertools.pairwise(cells)]
        assert set(headings) <= set(allowed)
        before = [None, *headings[:-1]]
        sums = [
            sum(plain.step_cost(name, one, h, u, v) for h, (u, v) in zip(before, itertools.pairwise(cells), strict=True))
            for one in NAMES
        ]
        assert scores == pytest.approx(sums)
    assert problem.pareto_front() is None
    with pytest.raises(CapabilityError, match="5 objectives, expected at most 3"):
        exact_front(problem)


def test_a_step_back_is_no_legal_path_where_there_is_no_backtracking(tmp_path):
    suite = Asletismac("ASLETISMAC_NO_X4_Y4_P1_K2_BF")
    problem = suite.problem(["length", "ascent"])
    assert problem.n_var == 7
    forth = [0, 1, 2, 3, 7, 11, 15]
    back = [0, 1, 5, 4, 8, 12, 15]
    F = problem.evaluate(np.array([forth, back]), return_values_of=["F", "interfering_cells"])
    assert F[1].tolist() == [0, 3]
    mended = problem.decode(problem.representation.repair(np.array([back]), np.random.default_rng(1)))
    assert mended.interfering_cells.tolist() == [0] and mended[::-1].interfering_cells.tolist() == [0]
    # A file says so, too.
    found = TradeOffSet(problem, problem.pareto_set())
    found.to_json(tmp_path / "paths.json")
    read = load_json(tmp_path / "paths.json")
    assert read.problem.representation.backtracking is False
    assert read.problem.decode(np.array([back])).interfering_cells.tolist() == [3]
    with pytest.raises(GridPathError, match="expected none: paths of ASLETISMAC_NO_X4_Y4_P1_K2_BF do not backtrack"):
        suite.problem(representation="integer")


@pytest.mark.parametrize(
    "name",
    ["ASLETISMAC_NO_X4_Y5_P1_K2_BF", "asletismac_no_x4_y4_p1_k2_bf", "ASLETISMAC_NO_X1_Y1_P1_K2_BF", "NO_X4_Y4_P1_K2_BF", 3],
)
def test_a_wrong_instance_is_refused_with_what_there_is(name):
    with pytest.raises(GridPathError, match="instance is") as info:
        Asletismac(name)
    if isinstance(name, str):
        assert "NO, CH or LA" in str(info.value) and "P1, P2, P3 or PM" in str(info.value)


def test_hills_and_speeds_are_of_squares():
    for objective in Asletismac("ASLETISMAC_NO_X4_Y4_PM_K2_BT").objectives[1:4]:
        with pytest.raises(GridPathError, match=f"{objective.name} is of square grids, and the map has 3 x 2 cells"):
            objective.moves(OccupancyGrid(np.zeros((2, 3))))


# -- the benchmark of multi-objective search ------------------------------------------------------------------------------


@pytest.mark.parametrize(("width", "height", "n_obj", "seed"), [(6, 5, 2, 1), (4, 6, 3, 2), (2, 2, 1, 3)])
def test_random_costs_are_of_directed_edges(width, height, n_obj, seed):
    drawn = [np.random.default_rng([seed, k + 1]).integers(1, 11, (4, height, width + 2)) for k in range(n_obj)]
    edges = {"source": {}}
    for x, y in itertools.product(range(width), range(height)):
        for heading, (dx, dy) in enumerate([(1, 0), (0, 1), (-1, 0), (0, -1)]):
            from_x, from_y = x - dx, y - dy
            costs = tuple(int(one[heading, y, x + 1]) for one in drawn)
            if heading == 0 and x == 0:
                edges["source"][x, y] = costs
            elif 0 <= from_x < width and 0 <= from_y < height:
                edges.setdefault((from_x, from_y), {})[x, y] = costs
    # One target a row, all of them the same.
    ends = {(width - 1, y): tuple(int(one[0, y, width + 1]) for one in drawn) for y in range(height)}
    for cell, costs in ends.items():
        edges.setdefault(cell, {})["target"] = costs
    problem = make_suite("random-cost", width=width, height=height, n_obj=n_obj, seed=seed).problem()
    found = exact_front(problem)
    assert found.complete
    assert sorted(map(tuple, found.F.tolist())) == front_of_edges(edges, "source", "target")


def test_the_first_costs_of_a_seed_are_the_same_whatever_their_number():
    grid = RandomCostGrid(4, 3).query[0]
    two, three = (RandomCostGrid(4, 3, n, seed=7).objectives for n in (2, 3))
    assert [one.name for one in three] == ["cost 1", "cost 2", "cost 3"]
    assert np.array_equal(two[1].moves(grid), three[1].moves(grid))
    there, back = three[0].moves(grid)[[0, 4]]
    assert not np.array_equal(there[:, 1:], back[:, :-1])
    with pytest.raises(GridPathError, match="number is 0"):
        RandomCost(0, 1)


def lines_to(guard, occupied):
    """Return which cells a guard sees, by the line whose error is counted from its end, in plain Python."""
    height, width = occupied.shape
    seen = set()
    for cell in itertools.product(range(width), range(height)):
        (x, y), (gx, gy) = guard, cell
        dx, dy = abs(gx - x), -abs(gy - y)
        error, passes = dx + dy, not occupied[y, x]
        while passes and (x, y) != cell:
            twice = 2 * error
            if twice >= dy and twice > dy:
                error, x = error + dy, x + (1 if x < gx else -1)
            if twice < dx:
                error, y = error + dx, y + (1 if y < gy else -1)
            passes = not occupied[y, x]
        if passes:
            seen.add(cell)
    return seen


def test_guards_see_along_free_lines_and_diagonal_steps_are_seen_from_the_side():
    rng = np.random.default_rng(4)
    occupied = rng.random((9, 12)) < 0.2
    occupied[0, 0] = occupied[8, 11] = False
    free = [(int(x), int(y)) for y, x in np.argwhere(~occupied)]
    guards = [free[k] for k in rng.choice(len(free), 6, replace=False)]
    grid = OccupancyGrid(occupied)
    seen = {cell: sum(cell in lines_to(guard, occupied) for guard in guards) for cell in free}
    assert {cell: Exposure(guards).seen(grid)[cell[1], cell[0]] for cell in free} == seen
    edges = {}
    for (x, y), (dx, dy) in itertools.product(free, itertools.product((-1, 0, 1), repeat=2)):
        sides = [(x + dx, y), (x, y + dy)]
        if (dx or dy) and (x + dx, y + dy) in seen and all(cell in seen for cell in sides):
            exposed = max(seen[cell] for cell in [(x + dx, y + dy), *(sides if dx and dy else [])])
            edges.setdefault((x, y), {})[x + dx, y + dy] = (14 if dx and dy else 10, exposed)
    problem = GuardsGrid(grid, guards, (0, 0), (11, 8)).problem()
    assert sorted(map(tuple, problem.pareto_front().tolist())) == front_of_edges(edges, (0, 0), (11, 8))


def test_guards_stand_on_free_cells_of_maps_of_their_rules():
    grid = OccupancyGrid(np.eye(4))
    with pytest.raises(GridError, match=r"guard 1 stands on \(2, 2\), expected a free cell"):
        GuardsGrid(grid, [(1, 0), (2, 2)], (0, 1), (0, 3)).problem()
    with pytest.raises(GridError, match=r"guard 0 stands on \(9, 2\)"):
        Exposure([(9, 2)]).moves(grid)
    for wrong in ([], [(1, 2, 3)], "cells", [(0.5, 1)]):
        with pytest.raises(GridPathError, match="guards is"):
            Exposure(wrong)
    with pytest.raises(GridPathError, match="eight moves that cut no corner"):
        GuardsGrid(grid.replace(corner_cutting=True), [(1, 0)], (0, 1), (0, 3)).problem()
    with pytest.raises(GridError, match="needs start and goal"):
        GuardsGrid(grid, [(1, 0)]).problem()
    warehouse = GuardsGrid("warehouse", [(20, 20)])
    assert warehouse.query == (load_map("warehouse"), query_of("warehouse").start, query_of("warehouse").goal)
    assert warehouse.label == "guards-1-warehouse"


# -- by name --------------------------------------------------------------------------------------------------------------


def test_the_companions_maps_are_what_their_functions_return():
    for name in SMALL_ENVIRONMENTS:
        assert make_suite("small-environments", environment=name).query == small_environment(name)
    maze = maze_environment(2)
    suite = make_suite("region-of-sight", kind="maze", seed=2)
    assert suite.query == (maze, *far_corners(maze))
    assert suite.problem().objective_names == ["length", "vulnerability"]
    with pytest.raises(GridPathError, match="there is no kind of environment 'mazes'; did you mean 'maze'"):
        make_suite("region-of-sight", kind="mazes")
    with pytest.raises(GridError, match="there is no environment 'zig-zag'"):
        make_suite("small-environments", environment="zig-zag")


@pytest.mark.parametrize("name", SUITES)
def test_each_says_whose_definitions_it_follows_and_is_a_value(name):
    suite = make_suite(name, **ARGUMENTS[name])
    assert suite.follows.startswith("follows the ") and isinstance(suite.label, str)
    assert repr(pickle.loads(pickle.dumps(suite))) == repr(suite)
    problem = suite.problem([suite.objectives[0].name, Length() if suite.objectives[0].name != "length" else "turn"])
    assert problem.n_obj == 2 and problem.representation.name == "cells"
    with pytest.raises(GridPathError, match="objectives"):
        suite.problem(3)


def test_wrong_names_and_arguments_are_refused_in_a_sentence():
    with pytest.raises(GridPathError, match="there is no suite 'asletismak'; did you mean 'asletismac'"):
        make_suite("asletismak")
    with pytest.raises(GridPathError, match=r"there is no suite 'zdt'; expected one of asletismac, "):
        make_suite("zdt")
    with pytest.raises(GridPathError, match=r"the suite 'random-cost' cannot be made: missing .*'width'; expected \(width"):
        make_suite("random-cost", height=3)
    with pytest.raises(GridPathError, match="unexpected keyword argument 'sight'"):
        make_suite("region-of-sight", kind="maze", sight=2)
    with pytest.raises(GridPathError, match="width is 1"):
        make_suite("random-cost", width=1, height=3)


def test_a_suite_of_ones_own_is_known_by_its_name():
    class Corridor(Suite):
        name, follows = "corridor", "follows nobody"
        label = "corridor"

        def __init__(self, cells: int):
            self.cells = cells

        @functools.cached_property
        def query(self):
            return OccupancyGrid(np.zeros((1, self.cells))), (0, 0), (self.cells - 1, 0)

        @functools.cached_property
        def objectives(self):
            return (Length(),)

    try:
        register(Corridor)
        assert make_suite("corridor", cells=4).problem().pareto_front().tolist() == [[3.0]]
    finally:
        SUITES._known.pop("corridor"), SUITES._names.pop("corridor")


def test_paths_without_backtracking_need_a_way():
    wall = np.zeros((3, 5))
    wall[:2, 2] = 1
    with pytest.raises(UnreachableError, match=r"every path from \(0, 0\) to \(4, 0\) .* goes back along x or y"):
        Walled(OccupancyGrid(wall)).problem()
    with pytest.raises(TypeError, match="abstract"):
        Suite()


class Walled(Suite):
    name, follows, label, backtracking, query = "walled", "follows nobody", "walled", False, None
    objectives = (Length(),)

    def __init__(self, grid):
        self.grid, self.query = grid, (grid, (0, 0), (4, 0))
