"""Exact fronts against the enumeration of all paths, and against a search that keeps every non-dominated label."""

from __future__ import annotations

import math
from collections import deque
from fractions import Fraction

import numpy as np
import pytest
from exact_fronts import Along, Cost, front_of, random_case

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.exact import exact_front
from pymoo_gridpath.fields import obstacle_potential
from pymoo_gridpath.representations import CellSequence
from pymoo_gridpath.testing.enumeration import STEPS, enumerate_paths, steps_of, turn_between

N_GRIDS = 500


def objectives_of(grid, seed):
    """Return lists of objectives, and the fields of those that have one."""
    random_state = np.random.default_rng(seed)
    wet, steep = (Cost(name, random_state.integers(0, 20, size=grid.shape)) for name in ("wet", "steep"))
    # What costs something in few cells leaves many ways for nothing.
    rare = Cost("rare", random_state.integers(0, 5, size=grid.shape) * (random_state.random(grid.shape) < 0.3))
    fields = {"vulnerability": obstacle_potential(grid), "wet": wet.values, "steep": steep.values, "rare": rare.values}
    sets = [
        ("length", "vulnerability"),
        ("turn", "length"),
        ("length", wet),
        (wet, steep),
        ("vulnerability", "turn"),
        (wet, "length", "turn"),
        ("vulnerability", "length", "turn"),
        ("length", wet, steep),
        (rare,),
        ("vulnerability", rare),
        (rare, wet, "vulnerability"),
    ]
    return sets, fields


def scores(paths, fields):
    """Return every measure of paths by name."""
    along = Along(paths)
    measures = {"cells": along.n_cells, "length": along.length, "turn": along.turn}
    return measures | {name: along.cells(field) for name, field in fields.items()}


def make_problem(case, objectives):
    grid, start, goal, representation = case
    if representation == "cells":
        representation = CellSequence(grid, start, goal, max_cells=int((~grid.occupied).sum()))
    return GridPathProblem(grid, start, goal, representation=representation, objectives=objectives)


def headings_of(problem):
    if problem.representation.name == "cells":
        return range(8)
    axis = "xy".index(problem.representation.frame.axis)
    forward = np.sign(problem.goal[axis] - problem.start[axis])
    return [m for m in range(8) if STEPS[m][axis] * forward >= 0]


@pytest.fixture(scope="module")
def solvable_seeds():
    """Seeds of as many solvable queries as are promised, whatever share of the draws has no answer."""
    seeds, seed = [], 0
    while len(seeds) < N_GRIDS:
        case = random_case(seed)
        if case is not None:
            try:
                make_problem(case, ("length",))
                seeds.append(seed)
            except GridPathError:
                pass
        seed += 1
    return seeds


def assert_best(F, cells, turn, measures, names):
    """Of all paths with the measures of a point, one of the fewest cells is given, and of these one that turns least."""
    scores = np.column_stack([measures[name] for name in names])
    others = np.column_stack([measures["cells"], measures["turn"]])
    for point, *given in zip(F, cells, turn, strict=True):
        equal = np.isclose(scores, point, rtol=1e-12, atol=1e-12).all(axis=1)
        assert given == min(others[equal].tolist())


@pytest.mark.parametrize("part", range(10))
def test_the_front_equals_enumeration_on_500_grids(solvable_seeds, part):
    sizes = []
    for seed in solvable_seeds[part::10]:
        case = random_case(seed)
        problem = make_problem(case, ("length",))
        sets, fields = objectives_of(problem.grid, seed)
        measures = scores(enumerate_paths(problem.grid, problem.start, problem.goal, headings_of(problem)), fields)
        # A third of them, the others on the next two grids.
        for objectives in sets[seed % 3 :: 3]:
            problem = make_problem(case, objectives)
            found, expected = exact_front(problem), front_of(measures, problem.objective_names)
            assert found.complete
            assert found.F.shape == expected.shape, (seed, problem.objective_names)
            np.testing.assert_allclose(found.F, expected, rtol=1e-12, atol=1e-12, err_msg=f"grid {seed}, {objectives}")
            out = problem.evaluate(found.X, return_as_dictionary=True)
            np.testing.assert_array_equal(out["F"], found.F)
            assert (out["interfering_cells"] == 0).all()
            sizes.append(len(expected))
            if "turn" not in problem.objective_names:
                cells = problem.representation.to_sequences(found.X).lengths
                assert_best(found.F, cells, out["turn"], measures, problem.objective_names)
    # The test would say little if all fronts were single points.
    assert max(sizes) >= 4
    assert np.mean(np.array(sizes) > 1) > 0.2


def test_the_front_of_rows_that_are_too_short_equals_enumeration(solvable_seeds):
    n_cut = dict.fromkeys((1, 2, 3), 0)
    for seed in solvable_seeds[::3]:
        grid, start, goal, representation = random_case(seed)
        if representation != "cells":
            continue
        sets, fields = objectives_of(grid, seed)
        paths = enumerate_paths(grid, tuple(start), tuple(goal), range(8))
        measures = scores(paths, {})
        least = measures["cells"][int(np.argmin(measures["length"]))]
        for number, max_cells in enumerate((least, least + 1, least + 3)):
            few = [path for path in paths if len(path[0]) <= max_cells]
            short = scores(few, fields)
            coding = CellSequence(grid, start, goal, max_cells=max_cells)
            more = [*sets, ("turn",), ("vulnerability",), (sets[2][1], sets[3][1], "turn")]
            # A third of them for each length, another third on the next grid.
            for objectives in more[(seed + number) % 3 :: 3]:
                problem = GridPathProblem(grid, start, goal, coding, objectives)
                found, expected = exact_front(problem), front_of(short, problem.objective_names)
                assert found.complete
                np.testing.assert_allclose(found.F, expected, rtol=1e-12, atol=1e-12, err_msg=f"grid {seed}, {objectives}")
                out = problem.evaluate(found.X, return_as_dictionary=True)
                np.testing.assert_array_equal(out["F"], found.F)
                if "turn" not in problem.objective_names:
                    assert_best(found.F, coding.to_sequences(found.X).lengths, out["turn"], short, problem.objective_names)
                n_cut[problem.n_obj] += "with at most" in found.message
    assert n_cut[2] > 30 and n_cut[3] > 30


def magnitudes(random_state, shape):
    """Return costs of many sizes: a few dear cells, or all between tiny and huge, or two kinds, or with cells for nothing."""
    values = random_state.random(shape)
    kind = random_state.integers(4)
    if kind == 0:
        return values + np.where(random_state.random(shape) < 0.3, 1e20, 0.0)
    if kind == 1:
        return values * 10.0 ** random_state.integers(-40, 41, size=shape)
    if kind == 2:
        return np.where(random_state.random(shape) < 0.5, 1e-9, 1e9) * (1 + values)
    return np.where(random_state.random(shape) < 0.4, 0.0, 10.0 ** random_state.integers(0, 300, size=shape))


@pytest.mark.parametrize("part", range(4))
def test_costs_of_any_size_have_every_point_of_the_enumeration(solvable_seeds, part):
    """In exact arithmetic, since doubles cannot tell most of these sums apart."""
    n_points = n_spread = 0
    for seed in solvable_seeds[part:120:4]:
        case = random_case(seed)
        random_state = np.random.default_rng(seed)
        wide, other = (Cost(name, magnitudes(random_state, case[0].shape)) for name in ("wide", "other"))
        problem = make_problem(case, ("length",))
        paths = enumerate_paths(problem.grid, problem.start, problem.goal, headings_of(problem))
        # Whole multiples of the smallest of all doubles: sums of these lose nothing.
        exact = {
            cost.name: [[int(Fraction(value) * 2**1074) for value in row] for row in cost.values] for cost in (wide, other)
        }
        measures = scores(paths, {}) | {
            name: [float(Fraction(sum(field[y][x] for x, y in cells), 2**1074)) for cells, *_ in paths]
            for name, field in exact.items()
        }
        for objectives in (("length", wide), (wide, "turn"), (wide, other), ("length", other, "turn"), (wide, "length", other)):
            problem = make_problem(case, objectives)
            found = exact_front(problem)
            assert found.complete
            table = np.array(list(zip(*(measures[name] for name in problem.objective_names), strict=True)), dtype=float)
            # What is found is what some path scores, and no other path is better, ...
            same = np.isclose(found.F[:, None], table[None], rtol=1e-12, atol=0).all(axis=2)
            assert same.any(axis=1).all()
            points = table[same.argmax(axis=1)]
            better = (table[:, None] <= points).all(axis=2) & (table[:, None] < points * (1 - 1e-11)).any(axis=2)
            assert not better.any(), (seed, problem.objective_names)
            assert len(np.unique(found.F, axis=0)) == len(found.F)
            # ... and nothing that none beats by more than rounding is left out.
            assert (table[:, None] * (1 + 1e-9) >= found.F).all(axis=2).any(axis=1).all(), (seed, problem.objective_names)
            n_points += len(found.F)
            n_spread += (found.F.max(axis=0) / 1e12 > found.F.min(axis=0)).any()
    assert n_points > 150 and n_spread > 10


def label_correction(grid, start, goal, headings, fields, names):
    """Return the front of some measures, by name, by keeping every non-dominated label, in plain Python."""

    def measures_of(straight, diagonal, turn, costs):
        values = {"cells": 1 + straight + diagonal, "length": straight + math.sqrt(2) * diagonal, "turn": 45.0 * turn}
        return tuple((values | dict(zip(fields, costs, strict=True)))[name] for name in names)

    def no_worse(a, b):
        return all(x <= y + 1e-9 for x, y in zip(a[0], b[0], strict=True))

    rounded = [np.rint(field).astype(int).tolist() for field in fields.values()]
    steps = steps_of(grid, headings)
    start, goal = tuple(start), tuple(goal)
    counts = (0, 0, 0, tuple(field[start[1]][start[0]] for field in rounded))
    # Each label: what it scores, and the counts that this follows from.
    first = (measures_of(*counts), counts)
    labels = {(start, None): {first}}
    queue = deque([(start, None, first)])
    while queue:
        cell, heading, label = queue.popleft()
        if label not in labels[cell, heading] or cell == goal:
            continue
        straight, diagonal, turn, costs = label[1]
        for m, (x, y) in steps[cell]:
            sums = tuple(cost + field[y][x] for cost, field in zip(costs, rounded, strict=True))
            counts = (straight + 1 - m % 2, diagonal + m % 2, turn + turn_between(heading, m), sums)
            new = (measures_of(*counts), counts)
            mine = labels.setdefault(((x, y), m), set())
            if not any(no_worse(old, new) for old in mine):
                mine -= {old for old in mine if no_worse(new, old)}
                mine.add(new)
                queue.append(((x, y), m, new))
    ends = set().union(*(mine for (cell, _), mine in labels.items() if cell == goal))
    return dict(zip(names, zip(*(scored for scored, _ in ends), strict=True), strict=True))


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("representation", ["cells", "integer"])
def test_the_front_equals_that_of_label_correction_on_larger_grids(seed, representation):
    random_state = np.random.default_rng(seed)
    occupied = random_state.random((8, 9)) < 0.2
    occupied[:2, :2] = occupied[-2:, -2:] = False
    # One way is always free.
    occupied[0] = occupied[:, -1] = False
    grid = OccupancyGrid(occupied, corner_cutting=seed % 2 == 0)
    case = (grid, (0, 0), (8, 7), representation)
    wet = Cost("wet", random_state.integers(0, 7, size=grid.shape))
    headings = headings_of(make_problem(case, ("length",)))
    measures = label_correction(grid, (0, 0), (8, 7), headings, {"wet": wet.values}, ("length", "wet", "turn"))
    for objectives in (("length", wet), (wet, "length"), ("length", "turn"), (wet, "turn"), ("turn", wet, "length")):
        problem = make_problem(case, objectives)
        expected = front_of(measures, problem.objective_names)
        np.testing.assert_allclose(exact_front(problem).F, expected, rtol=1e-12, atol=1e-12)


def test_coarse_costs_whose_weighted_sums_mislead_have_every_point():
    """Rounded sums of tenths and turns lead to paths off the front, which must not hide the points around them."""
    wet = Cost(
        "wet",
        [
            [0.0, 0.0, 0.8, 0.9, 0.9, 0.3, 0.2],
            [0.8, 0.0, 0.5, 0.4, 0.3, 0.9, 0.5],
            [0.3, 0.7, 0.2, 0.7, 0.6, 0.3, 0.8],
            [0.8, 0.0, 0.7, 0.7, 0.2, 0.1, 0.0],
            [0.7, 0.6, 0.1, 0.2, 0.8, 0.0, 0.5],
            [0.2, 0.9, 0.2, 0.3, 0.6, 0.8, 0.3],
        ],
    )
    grid = OccupancyGrid(np.zeros((6, 7)))
    measures = label_correction(grid, (2, 0), (0, 5), range(8), {"wet": 10 * wet.values}, ("turn", "wet"))
    found = exact_front(GridPathProblem(grid, (2, 0), (0, 5), "cells", ("turn", wet)))
    np.testing.assert_allclose(found.F * (1, 10), front_of(measures, ("turn", "wet")), rtol=1e-12)


@pytest.mark.parametrize("part", range(2))
def test_two_objectives_and_a_third_that_is_nothing_have_the_same_front(part):
    """Which another search finds."""
    for seed in range(280 + part, 400, 2):
        random_state = np.random.default_rng(seed)
        grid = OccupancyGrid(np.zeros((24, 24)), corner_cutting=True)
        wet = Cost("wet", random_state.integers(0, 4, (24, 24)) * (random_state.random((24, 24)) < 0.5))
        nothing = Cost("nothing", np.zeros((24, 24)))
        two, three = (
            exact_front(GridPathProblem(grid, (0, 0), (23, 23), "cells", objectives)).F
            for objectives in ((wet, "turn"), (wet, nothing, "turn"))
        )
        np.testing.assert_array_equal(two, three[:, [0, 2]])


@pytest.mark.parametrize("seed", range(6))
def test_the_front_of_short_rows_equals_that_of_label_correction_with_steps(seed):
    """Where much is free of cost, cheap ways that are long lead to cells that others come to by few steps."""
    random_state = np.random.default_rng(seed)
    grid, ends = OccupancyGrid(np.zeros((8, 8)), corner_cutting=seed % 2 == 0), ((0, 0), (7, 7))
    a, b = (Cost(name, random_state.integers(1, 5, (8, 8)) * (random_state.random((8, 8)) < 0.5)) for name in "ab")
    for objectives in ((a, b), (a, b, "turn")):
        names = ("cells", "a", "b", "turn")[: 1 + len(objectives)]
        measures = label_correction(grid, *ends, range(8), {"a": a.values, "b": b.values}, names)
        for max_cells in range(min(measures["cells"]), max(measures["cells"]) + 1):
            fits = [k for k, cells in enumerate(measures["cells"]) if cells <= max_cells]
            short = {name: [values[k] for k in fits] for name, values in measures.items()}
            problem = GridPathProblem(grid, *ends, CellSequence(grid, *ends, max_cells=max_cells), objectives)
            found = exact_front(problem)
            np.testing.assert_allclose(found.F, front_of(short, problem.objective_names), rtol=1e-12, atol=1e-12)
            assert found.complete
