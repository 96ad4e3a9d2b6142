"""The risk of a path on maps in metres and in cells: fields, defaults, and what depends on them."""

from __future__ import annotations

import json
import math
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid, TradeOffSet
from pymoo_gridpath.algorithms import ahmed_deb_2013, make_algorithm
from pymoo_gridpath.decision import load_json
from pymoo_gridpath.decision.drawn import drawn_field
from pymoo_gridpath.errors import GridError
from pymoo_gridpath.exact import exact_front
from pymoo_gridpath.fields import QUANTUM, inflation_cost, obstacle_potential, settled_bell
from pymoo_gridpath.maps import load_map
from pymoo_gridpath.objectives import Inflation, Vulnerability
from pymoo_gridpath.operators import path_operators
from pymoo_gridpath.problems import MovingObstaclesProblem
from pymoo_gridpath.representations import CellSequence
from pymoo_gridpath.testing import reference
from pymoo_gridpath.testing.enumeration import enumerate_paths, non_dominated, random_query

PAPER = Vulnerability(variance=0.5)


def random_grid(seed, resolution=0.05):
    rng = np.random.default_rng(seed)
    return OccupancyGrid(rng.random(rng.integers(1, 14, size=2)) < rng.choice([0.0, 0.05, 0.3]), resolution)


def to_obstacles(grid):
    """Return the distance in cells of each cell from the nearest occupied one, in plain Python."""
    ys, xs = np.nonzero(grid.occupied)
    occupied = list(zip(xs.tolist(), ys.tolist(), strict=True))
    return np.array(
        [
            [min((math.dist((x, y), o) for o in occupied), default=math.inf) for x in range(grid.width)]
            for y in range(grid.height)
        ]
    )


# -- fields -----------------------------------------------------------------------------------------------------------


@given(st.integers(0, 10**6), st.floats(0.01, 1.0), st.sampled_from([0.0, 1e-3, 0.2]))
def test_the_nearest_obstacle_alone(seed, sigma_m, cutoff):
    grid = random_grid(seed)
    expected = np.exp(-((0.05 * to_obstacles(grid)) ** 2) / (2 * sigma_m**2))
    found = obstacle_potential(grid, sigma_m=sigma_m, cutoff=cutoff)
    kept = np.abs(expected - cutoff) > 1e-9
    assert np.abs(np.where(expected < cutoff, 0.0, expected) - found)[kept].max(initial=0.0) <= 0.51 * QUANTUM
    assert (found[found > 0] >= cutoff - QUANTUM).all()


@given(st.integers(0, 10**6), st.floats(0.01, 0.3))
def test_a_sum_of_bells_in_metres_is_one_in_cells(seed, sigma_m):
    grid = random_grid(seed)
    expected = reference.potential(grid, (sigma_m / 0.05) ** 2)
    assert np.abs(obstacle_potential(grid, sigma_m=sigma_m, nearest=False) - expected).max() <= 0.51 * QUANTUM
    cut = obstacle_potential(grid, sigma_m=sigma_m, nearest=False, cutoff=0.3)
    np.testing.assert_array_equal(cut, np.where(expected < 0.3, 0.0, np.round(expected / QUANTUM) * QUANTUM))


@given(st.integers(0, 10**6), st.floats(0.5, 20.0), st.floats(0.02, 1.0))
def test_inflation_is_the_formula_of_navigation2(seed, factor, radius):
    grid = random_grid(seed)
    metres = 0.05 * to_obstacles(grid)
    expected = np.where(metres <= radius, np.exp(-factor * metres), 0.0)
    at_the_edge = np.isclose(metres, radius, rtol=1e-6)
    assert np.abs(inflation_cost(grid, factor, radius) - expected)[~at_the_edge].max(initial=0.0) <= 0.51 * QUANTUM


def test_the_inflation_radius_belongs_to_what_costs():
    grid = OccupancyGrid([[1, 0, 0, 0]], 0.1)
    assert (inflation_cost(grid, 3.0, 0.2)[0] > 0).tolist() == [True, True, True, False]


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"cutoff": 0.0},
        {"variance": 9.0, "nearest": True},
        {"sigma_m": 0.1, "nearest": False},
        {"sigma_m": 1e-150},
        {"sigma_m": 1e9},
    ],
    ids=str,
)
def test_a_part_of_a_field_is_that_of_the_whole(options):
    rng = np.random.default_rng(3)
    grid = OccupancyGrid(rng.random((40, 60)) < 0.01, 0.05)
    boxes = [grid.whole._replace(x0=20, y0=9, x1=31, y1=22), grid.whole._replace(x1=5), grid.whole]
    for box in boxes:
        np.testing.assert_array_equal(
            obstacle_potential(grid, box=box, **options), obstacle_potential(grid, **options)[box.slices]
        )
        np.testing.assert_array_equal(inflation_cost(grid, 3.0, 0.4, box), inflation_cost(grid, 3.0, 0.4)[box.slices])


# -- what it is by default --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("resolution", "given", "expected"),
    [
        (None, {}, (0.5, None, False, 0.0)),
        (0.05, {}, (None, 0.3, True, 1e-6)),
        (0.5, {}, (None, 1.0, True, 1e-6)),
        (0.5, {"sigma_m": 0.2}, (None, 0.2, True, 1e-6)),
        (0.05, {"variance": 2.0}, (2.0, None, False, 0.0)),
        (0.05, {"nearest": False}, (None, 0.3, False, 0.0)),
        (0.05, {"cutoff": 0.0}, (None, 0.3, True, 0.0)),
        (None, {"nearest": True}, (0.5, None, True, 1e-6)),
        (None, {"cutoff": 0.1}, (0.5, None, False, 0.1)),
    ],
)
def test_the_map_decides_what_is_not_given(resolution, given, expected):
    grid = OccupancyGrid([[0, 1, 0, 0]], resolution)
    assert tuple(settled_bell(grid, **given)) == expected
    objective = Vulnerability(**given)
    on_it = objective.on(grid)
    assert (on_it.variance, on_it.sigma_m, on_it.nearest, on_it.cutoff) == expected and on_it.on(grid) is on_it
    assert vars(objective).keys() == given.keys(), "it stays what it was"
    np.testing.assert_array_equal(objective.field(grid), on_it.field(grid))
    np.testing.assert_array_equal(obstacle_potential(grid, **given), on_it.field(grid))
    problem = GridPathProblem(grid, (2, 0), (3, 0), "cells", ["length", objective])
    assert repr(problem.objectives[1]) == repr(on_it)


@pytest.mark.parametrize(
    ("given", "word"),
    [
        ({"variance": 1.0, "sigma_m": 1.0}, "variance is 1.0 and sigma_m is 1.0, expected one of them"),
        ({"sigma_m": 0.0}, "sigma_m of the potential is 0.0, expected a positive number of metres"),
        ({"sigma_m": "wide"}, "sigma_m of the potential is 'wide'"),
        ({"nearest": 1}, "nearest is 1"),
        ({"cutoff": 1.0}, "cutoff of the potential is 1.0, expected a share of the peak of a bell, from 0 to below 1"),
        ({"cutoff": -0.1}, "cutoff of the potential is -0.1"),
    ],
)
def test_other_bells_are_refused(given, word):
    for take in (Vulnerability, lambda **options: obstacle_potential(OccupancyGrid([[0]], 0.05), **options)):
        with pytest.raises(GridError, match=word):
            take(**given)


def test_what_is_in_metres_needs_a_map_that_has_them():
    grid = OccupancyGrid([[0, 1, 0, 0]])
    for objective in (Vulnerability(sigma_m=0.3), Inflation()):
        with pytest.raises(GridError, match=r"the grid 'grid' is in cells, and .* needs their size"):
            GridPathProblem(grid, (2, 0), (3, 0), "cells", ["length", objective])


@pytest.mark.parametrize("wrong", [{"cost_scaling_factor": 0}, {"inflation_radius": -1.0}, {"inflation_radius": "near"}])
def test_other_inflations_are_refused(wrong):
    with pytest.raises(GridError, match=f"{next(iter(wrong))} is .*, expected a positive number"):
        Inflation(**wrong)


def test_the_preset_of_the_paper_has_the_papers_risk():
    grid = load_map("office")
    assert repr(GridPathProblem(grid, (3, 4), (56, 35)).objectives[1]).startswith("Vulnerability(sigma_m=0.5, nearest=True")
    for objectives in (("length", "vulnerability"), ["length", Vulnerability()], "vulnerability"):
        problem, *_ = ahmed_deb_2013(grid, (3, 4), (7, 7), objectives=objectives, axis="x")
        assert problem.objectives[-1].variance == 0.5 and problem.objectives[-1].sigma_m is None
    problem, *_ = ahmed_deb_2013(grid, (3, 4), (7, 7), objectives=["length", Vulnerability(sigma_m=0.5)], axis="x")
    assert problem.objectives[-1].sigma_m == 0.5


# -- what works with it -----------------------------------------------------------------------------------------------


@settings(max_examples=25)
@given(st.integers(0, 10**6), st.sampled_from([Vulnerability(), Vulnerability(sigma_m=0.05, cutoff=0.3), Inflation(3.0, 0.2)]))
def test_exact_fronts_are_those_of_all_paths(seed, risk):
    grid, start, goal = random_query(np.random.default_rng(seed), 2, 4)
    grid = grid.replace(resolution=0.05)
    field = risk.field(grid)
    paths = enumerate_paths(grid, start, goal)
    rows = [(round(p.straight + math.sqrt(2) * p.diagonal, 9), round(sum(field[y, x] for x, y in p.cells), 9)) for p in paths]
    problem = GridPathProblem(grid, start, goal, CellSequence(grid, start, goal, 16), ["length", risk])
    np.testing.assert_allclose(exact_front(problem).F, non_dominated(rows), rtol=0, atol=1e-8)


def corridor(n=70, slope=3, half=13, resolution=0.05):
    """Return an empty corridor that rises by one cell in so many, with its ends."""
    x, y = np.meshgrid(np.arange(n), np.arange(n // slope + 2 * half + 3))
    grid = OccupancyGrid(np.abs(y - x / slope - half - 1) > half, resolution)
    return grid, (2, half + 1), (n - 3, (n - 3) // slope + half + 1)


def turns_of_the_safest(cutoff):
    grid, start, goal = corridor()
    risk = Vulnerability(sigma_m=0.1, cutoff=cutoff)
    problem = GridPathProblem(grid, start, goal, "cells", ["length", risk])
    return TradeOffSet.from_genes(problem, problem.pareto_set(max_seconds=60)).safest.turn


def test_where_the_tail_is_cut_off_turn_decides():
    """The tail alone tells apart paths that all keep far from the walls, and follows the stairs of their cells."""
    tail, cut = turns_of_the_safest(0.0), turns_of_the_safest(None)
    assert cut <= 360 and 2 * cut < tail


def test_search_breaks_ties_by_turn_where_the_tail_is_cut_off():
    grid, start, goal = corridor(40)
    problem = GridPathProblem(grid, start, goal, "cells", ["length", Vulnerability(sigma_m=0.1)])
    algorithm = make_algorithm("NSGA2", problem, pop_size=40, operators=path_operators(problem))
    found = TradeOffSet.from_results(minimize(problem, algorithm, ("n_gen", 60), seed=1))
    exact = TradeOffSet.from_genes(problem, problem.pareto_set(max_seconds=60))
    assert found.shortest.length == exact.shortest.length and found.shortest.turn <= exact.shortest.turn + 90


def two_ways(resolution=0.5, **options):
    """Return a problem with a short way through a gap and a long one around, in metres unless told otherwise."""
    occupied = np.zeros((30, 31), dtype=bool)
    occupied[4:, 15] = True
    occupied[22:25, 15] = False
    return GridPathProblem(OccupancyGrid(occupied, resolution), (4, 23), (26, 23), "cells", **options)


def set_of(problem):
    return TradeOffSet.from_genes(problem, problem.pareto_set(max_seconds=60))


@pytest.mark.parametrize(
    "risk", [Vulnerability(), Vulnerability(sigma_m=0.2, nearest=False), Inflation(3.0, 0.5), PAPER], ids=repr
)
def test_sets_are_stored_with_their_risk(risk, tmp_path):
    found = set_of(two_ways(objectives=["length", risk]))
    file = found.to_json(tmp_path / "paths.json")
    stated = json.loads(file.read_text())["settings"]["objectives"][1]
    settled = risk.on(found.problem.grid)
    assert stated == {"name": settled.name, **vars(settled)}
    again = load_json(file)
    assert repr(again.problem.objectives[1]) == repr(settled)
    np.testing.assert_array_equal(again.problem.score(again.paths), found.F)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(found.problem)).score(found.paths), found.F)


def test_the_safest_path_is_that_of_the_risk_of_the_problem():
    problem = two_ways(objectives=["length", Inflation(3.0, 0.3)])
    found = set_of(problem)
    assert found.safest.index == int(np.argmin(found.measures["inflation"])) == len(found) - 1
    default = Vulnerability().on(problem.grid).field(problem.grid)
    for record in found:
        x, y = record.cells.T
        assert record.vulnerability == pytest.approx(default[y, x].sum())
    np.testing.assert_array_equal(drawn_field(found, problem.grid.whole), problem.objectives[1].field(problem.grid))


def test_metres_give_a_choice_where_the_paper_sees_one_path():
    occupied = np.zeros((40, 60), dtype=bool)
    occupied[:13, 20:40] = True
    grid = OccupancyGrid(occupied, 0.05)
    sizes = [
        len(set_of(GridPathProblem(grid, (4, 20), (56, 20), "cells", ["length", one]))) for one in (PAPER, "vulnerability")
    ]
    assert sizes[0] == 1 and sizes[1] > 5


@pytest.mark.parametrize(
    ("resolution", "objectives", "words"),
    [
        (0.05, ["length", "vulnerability"], r"a wider risk, such as sigma_m=0\.6 \(--sigma-m 0\.6\) or a further objective"),
        (None, ["length", "vulnerability"], "a wider risk, such as variance=2 or a further objective"),
        (0.05, ["length", Inflation()], "a smaller cost_scaling_factor and a larger inflation_radius or a further objective"),
        (None, ["length", "turn"], "everywhere; a further objective, such as turn"),
    ],
)
def test_a_front_of_one_point_says_so_and_what_to_change(resolution, objectives, words):
    problem = GridPathProblem(OccupancyGrid(np.zeros((3, 9)), resolution), (0, 1), (8, 1), "cells", objectives)
    found = set_of(problem)
    assert len(found) == 1 and found.advice.startswith("the front found is one point, a path that is best by every objective; ")
    assert found.table().splitlines()[-1] == f"NOTE: {found.advice}"


def test_there_is_nothing_to_say_of_one_objective_or_of_several_paths():
    assert set_of(two_ways()).advice == ""
    assert set_of(two_ways(objectives=["length"])).advice == ""


def test_obstacles_that_move_have_the_risk_of_their_map():
    grid = OccupancyGrid(np.zeros((8, 9)), 0.05)
    problem = MovingObstaclesProblem(grid, [[(4, 4), (5, 4)]], (0, 4), (8, 4))
    for still in problem.stills:
        assert repr(still.objectives[1]) == "Vulnerability(sigma_m=0.3, nearest=True, cutoff=1e-06)"
        np.testing.assert_array_equal(still.score(still.decode(still.pareto_set(max_seconds=60))), still.pareto_front())
