"""Exact fronts of costs of moves and of turning: against the enumeration of all paths, and a plain label search."""

from __future__ import annotations

import heapq
import math

import numpy as np
import pytest
from exact_fronts import Along, Cost, front_of, queries_of

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.errors import CapabilityError, GridPathError
from pymoo_gridpath.exact import exact_front
from pymoo_gridpath.exact.costs import DIRECT, Costs
from pymoo_gridpath.objectives import Objective
from pymoo_gridpath.representations import CellSequence
from pymoo_gridpath.testing.enumeration import STEPS, enumerate_paths, steps_of, turn_between

N_GRIDS = 500


class Ways(Objective):
    """Given costs of cells, moves and turning."""

    def __init__(self, name, field=None, moves=None, turn_cost=0.0):
        self.name = self.label = name
        self.costs, self.steps, self.turn_cost = field, moves, turn_cost

    def field(self, grid):
        return self.costs

    def moves(self, grid):
        return self.steps

    def along(self, paths):
        """The cost of each of the enumerated paths."""
        total = self.turn_cost * paths.turn / 45
        if self.costs is not None:
            total = total + paths.cells(self.costs)
        return total if self.steps is None else total + paths.moves(self.steps)


def from_cells(values, dx, dy):
    """The value of the cell that each step (dx, dy) comes from, by the cell where it ends; NaN where it comes from outside."""
    moved = np.full(values.shape, np.nan)
    height, width = values.shape
    for y, x in np.ndindex(values.shape):
        if 0 <= y - dy < height and 0 <= x - dx < width:
            moved[y, x] = values[y - dy, x - dx]
    return moved


def climb(heights):
    return np.stack([np.maximum(heights - from_cells(heights, dx, dy), 0) for dx, dy in STEPS])


def exposure(seen):
    """An orthogonal step costs what its end does, a diagonal one the most of its end and both cells beside it."""
    costs = []
    for dx, dy in STEPS:
        if dx and dy:
            costs.append(np.fmax(seen, np.fmax(from_cells(seen, dx, 0), from_cells(seen, 0, dy))))
        else:
            costs.append(seen.astype(float))
    return np.stack(costs)


def by_distance(ground):
    return np.stack([ground * math.hypot(dx, dy) for dx, dy in STEPS])


def kinds_of(grid, seed):
    """Return lists of objectives, those of five seeds of every kind."""
    draw = np.random.default_rng(seed)
    shape = grid.shape
    random = Ways("random", moves=draw.integers(0, 9, size=(8, *shape)).astype(float))
    other = Ways("other", moves=draw.integers(0, 9, size=(8, *shape)).astype(float))
    third = Ways("third", moves=draw.random((8, *shape)))
    up = Ways("climb", moves=climb(draw.integers(0, 6, size=shape).astype(float)))
    ten = Ways("ten", moves=(10.0, 14.0))
    dear = Ways("dear", moves=(1.0, 3.0))
    guards = Ways("guards", moves=exposure(draw.integers(0, 4, size=shape) * draw.integers(0, 2, size=shape)))
    ground = Ways("ground", moves=by_distance(draw.integers(1, 9, size=shape).astype(float)))
    mixed = Ways("mixed", moves=(1.0, math.sqrt(2)), turn_cost=0.3)
    metres = Ways("metres", moves=(0.05, math.sqrt(2) * 0.05))
    bends = Ways("bends", turn_cost=1.0)
    all_kinds = Ways("all", draw.integers(0, 3, size=shape).astype(float), random.steps, 2.0)
    paved = Ways("paved", draw.integers(0, 3, size=shape).astype(float), (2.0, 3.0))
    wet = Cost("wet", draw.integers(0, 20, size=shape))
    wet.along = lambda paths: paths.cells(wet.values)
    return [
        (random,),
        (dear,),
        (mixed,),
        (bends,),
        (random, other),
        (ten, guards),
        ("length", up),
        (ground, "turn"),
        (mixed, bends),
        (all_kinds, mixed),
        (dear, wet),
        (metres, paved),
        (third, "length"),
        (random, other, third),
        ("length", ground, up),
        (ten, guards, "turn"),
        (bends, mixed, random),
        (all_kinds, bends, mixed),
        (dear, wet, third),
    ][seed % 5 :: 5]


def measures_of(paths, objectives):
    measures = {"cells": paths.n_cells, "length": paths.length, "turn": paths.turn}
    return measures | {one.name: one.along(paths) for one in objectives if not isinstance(one, str)}


def rounded_front(measures, names):
    """The front where sums of the same costs in another order count as the same."""
    return front_of({name: np.round(measures[name], 9) for name in names}, names)


@pytest.mark.parametrize("part", range(10))
def test_fronts_of_costs_of_moves_equal_enumeration_on_500_grids(part):
    sizes = []
    for number, (seed, grid, start, goal, _, paths) in enumerate(queries_of(part, 10, N_GRIDS // 10)):
        coding = CellSequence(grid, start, goal, max_cells=int((~grid.occupied).sum()))
        # Half of them, the others on the next grid.
        for objectives in kinds_of(grid, seed)[number % 2 :: 2]:
            problem = GridPathProblem(grid, start, goal, coding, objectives)
            measures = measures_of(paths, objectives)
            found, expected = exact_front(problem), rounded_front(measures, problem.objective_names)
            assert found.complete
            label = f"grid {seed}, {problem.objective_names}"
            assert found.F.shape == expected.shape, label
            np.testing.assert_allclose(found.F, expected, rtol=1e-9, atol=1e-8, err_msg=label)
            out = problem.evaluate(found.X, return_as_dictionary=True)
            np.testing.assert_array_equal(out["F"], found.F)
            assert (out["interfering_cells"] == 0).all()
            sizes.append(len(expected))
            if not any(getattr(one, "turn_cost", 0.0) or one == "turn" for one in objectives):
                scores = np.column_stack([np.round(measures[name], 9) for name in problem.objective_names])
                others = np.column_stack([measures["cells"], measures["turn"]])
                cells = coding.to_sequences(found.X).lengths
                for point, *given in zip(found.F, cells, out["turn"], strict=True):
                    equal = np.isclose(scores, point, rtol=1e-9, atol=1e-8).all(axis=1)
                    assert given == min(others[equal].tolist()), label
    assert max(sizes) >= 3 and np.mean(np.array(sizes) > 1) > 0.15


def test_fronts_of_short_rows_equal_enumeration():
    n_cut = 0
    for seed, grid, start, goal, paths, _ in queries_of(0, 10, 50):
        least = min(len(cells) for cells, *_ in paths)
        few = [path for path in paths if len(path[0]) <= least + 1]
        coding = CellSequence(grid, start, goal, max_cells=least + 1)
        for objectives in kinds_of(grid, seed):
            problem = GridPathProblem(grid, start, goal, coding, objectives)
            found, expected = exact_front(problem), rounded_front(measures_of(Along(few), objectives), problem.objective_names)
            np.testing.assert_allclose(
                found.F, expected, rtol=1e-9, atol=1e-8, err_msg=f"grid {seed}, {problem.objective_names}"
            )
            n_cut += "with at most" in found.message
    assert n_cut > 20


def test_dear_moves_beside_cheap_ones_keep_every_point():
    """Costs so far apart that doubles cannot add them up: moves that nobody takes do not hide the others."""
    n_points = 0
    for seed, grid, start, goal, _, paths in [*queries_of(1, 10, 50), *queries_of(2, 10, 50)]:
        draw = np.random.default_rng(seed)
        values = draw.random((8, *grid.shape))
        wide = Ways("wide", moves=np.where(draw.random(values.shape) < 0.4, 1e20, values))
        coding = CellSequence(grid, start, goal, max_cells=int((~grid.occupied).sum()))
        problem = GridPathProblem(grid, start, goal, coding, ["length", wide])
        measures = measures_of(paths, ["length", wide])
        expected = front_of({name: measures[name] for name in ("length", "wide")}, ("length", "wide"))
        F = exact_front(problem).F
        cheap = expected[expected[:, 1] < 1e19]
        np.testing.assert_allclose(F[F[:, 1] < 1e19], cheap, rtol=1e-9)
        n_points += len(cheap)
    assert n_points > 60


def label_search(grid, start, goal, objectives):
    """Return the front by a label-setting search that keeps every non-dominated label of each cell and heading."""

    def step_costs(before, m, x, y):
        for one in objectives:
            cost = 0.0 if one.costs is None else one.costs[y, x]
            if isinstance(one.steps, tuple):
                cost += one.steps[m % 2]
            elif one.steps is not None:
                cost += one.steps[m, y, x]
            yield cost + one.turn_cost * turn_between(before, m)

    steps = steps_of(grid)
    by_heading = any(one.turn_cost for one in objectives)
    first = tuple(0.0 if one.costs is None else float(one.costs[start[1], start[0]]) for one in objectives)
    closed = {}
    heap = [(first, start, None)]
    while heap:
        costs, cell, heading = heapq.heappop(heap)
        known = closed.setdefault((cell, heading if by_heading and cell != goal else None), np.empty((0, len(costs))))
        if (known <= costs).all(axis=1).any():
            continue
        closed[cell, heading if by_heading and cell != goal else None] = np.vstack([known, costs])
        if cell == goal:
            continue
        for m, after in steps[cell]:
            new = tuple(a + b for a, b in zip(costs, step_costs(heading, m, *after), strict=True))
            mine = closed.get((after, m if by_heading and after != goal else None))
            if mine is None or not (mine <= new).all(axis=1).any():
                heapq.heappush(heap, (new, after, m))
    return closed[goal, None]


def guarded(size, seed):
    """Return a grid and GUARDS-like costs: 10 and 14 a step, and what sees the cells that it passes."""
    draw = np.random.default_rng(seed)
    occupied = draw.random((size, size)) < 0.15
    occupied[0] = occupied[:, -1] = False
    seen = draw.integers(0, 5, size=(size, size)) * (draw.random((size, size)) < 0.5)
    return (
        OccupancyGrid(occupied, corner_cutting=seed % 2 == 1),
        Ways("ten", moves=(10.0, 14.0)),
        Ways("guards", moves=exposure(seen)),
    )


@pytest.mark.parametrize("seed", range(3))
def test_fronts_equal_those_of_a_plain_label_search_on_larger_grids(seed):
    size = 12 + 3 * seed
    grid, ten, guards = guarded(size, seed)
    draw = np.random.default_rng(100 + seed)
    up = Ways("climb", moves=climb(draw.integers(0, 4, size=grid.shape).astype(float)))
    turning = Ways("turning", moves=(2.0, 3.0), turn_cost=1.0)
    bends = Ways("bends", turn_cost=1.0)
    for objectives in ((ten, guards), (ten, up), (turning, guards), (turning, bends), (ten, guards, bends))[seed::2]:
        problem = GridPathProblem(
            grid, (0, 0), (size - 1, size - 1), CellSequence(grid, (0, 0), (size - 1, size - 1), 400), objectives
        )
        front = exact_front(problem)
        assert front.complete and "with at most" not in front.message
        expected = label_search(grid, (0, 0), (size - 1, size - 1), objectives)
        np.testing.assert_allclose(front.F, expected[np.lexsort(expected.T[::-1])], rtol=1e-12)


def test_skipping_detours_as_for_costs_of_cells_would_lose_points(monkeypatch):
    """What the search did for costs of cells: if it did so here, too, the tests above would tell."""
    right, wrong = [], []
    for unfiltered in (False, True):
        if unfiltered:
            monkeypatch.setattr(Costs, "direct", property(lambda _: DIRECT))
        for seed in range(4):
            grid, ten, guards = guarded(24, seed)
            problem = GridPathProblem(grid, (0, 0), (23, 23), CellSequence(grid, (0, 0), (23, 23), 400), (ten, guards))
            (wrong if unfiltered else right).append(exact_front(problem).F.tolist())
    assert sum(a != b for a, b in zip(right, wrong, strict=True)) >= 2


def test_what_does_not_add_up_has_no_exact_front_and_is_scored():
    class Worst(Objective):
        name = label = "worst"
        combine, maximise = "greatest", True

        def field(self, grid):
            return np.arange(25.0).reshape(5, 5)

    class Best(Worst):
        combine, maximise = "least", False

    for representation in ("cells", "integer"):
        problem = GridPathProblem(OccupancyGrid(np.zeros((5, 5))), (1, 0), (4, 4), representation, ["length", Worst()])
        with pytest.raises(
            CapabilityError, match="'worst' is the greatest of costs along a path, to be maximised, and no exact"
        ):
            exact_front(problem)
        assert problem.pareto_front() is None
        X = GridPathProblem(problem.grid, (1, 0), (4, 4), representation).pareto_set()
        assert problem.evaluate(X)[:, 1].tolist() == [-24.0] * len(X)
        least = GridPathProblem(problem.grid, (1, 0), (4, 4), representation, ["length", Best()])
        assert least.evaluate(X)[:, 1].tolist() == [1.0] * len(X)


@pytest.mark.parametrize(
    ("moves", "turn_cost", "message"),
    [
        (
            (1.0, -2.0),
            0.0,
            r"the cost of moves of the objective 'own' is \(1.0, -2.0\), expected finite numbers of zero or more",
        ),
        ((1.0, math.nan), 0.0, "expected finite numbers of zero or more"),
        (np.zeros((8, 3, 4)), 0.0, r"is of shape \(8, 3, 4\), expected two numbers, .* or an array of shape \(8, 4, 3\)"),
        ("up", 0.0, "the cost of moves of the objective 'own' is 'up', expected two numbers"),
        (None, -1.0, "turn_cost of the objective 'own' is -1.0, expected the cost of 45 degrees of turning, zero or more"),
        (None, math.inf, "turn_cost of the objective 'own' is inf"),
        (None, 0.0, "the objective 'own' names no cost, expected one of cells"),
    ],
)
def test_wrong_costs_of_moves_are_refused(moves, turn_cost, message):
    with pytest.raises(GridPathError, match=message):
        GridPathProblem(OccupancyGrid(np.zeros((4, 3))), (0, 0), (2, 3), "cells", [Ways("own", None, moves, turn_cost)])


@pytest.mark.parametrize(("value", "reason"), [(-1.0, "zero or more"), (math.nan, "a finite number where a step is legal")])
def test_wrong_costs_of_a_single_move_are_named(value, reason):
    moves = np.zeros((8, 4, 3))
    moves[3, 2, 1] = value
    message = rf"'own' is {value:g} for the step \(-1, 1\), heading 3, to the cell \(1, 2\), expected {reason}"
    with pytest.raises(GridPathError, match=message):
        GridPathProblem(OccupancyGrid(np.zeros((4, 3))), (0, 0), (2, 3), "cells", [Ways("own", None, moves)])


def test_moves_that_nobody_can_make_may_be_of_no_finite_cost():
    heights = np.arange(12.0).reshape(4, 3)
    assert np.isnan(climb(heights)).any()
    problem = GridPathProblem(OccupancyGrid(np.zeros((4, 3))), (0, 0), (2, 3), "cells", [Ways("up", None, climb(heights))])
    assert problem.pareto_front().tolist() == [[11.0]]
    assert np.isfinite(problem.evaluate(np.random.default_rng(1).integers(0, 12, size=(50, problem.n_var)))).all()


def test_equal_costs_of_unequal_moves_give_the_path_of_fewest_cells():
    """Five diagonal steps of 14 cost as much as seven straight ones of 10."""
    occupied = np.ones((8, 15))
    for k in range(6):
        occupied[k, k] = occupied[k, 10 - k] = 0
    occupied[0] = 0
    grid = OccupancyGrid(occupied, corner_cutting=True)
    paths = enumerate_paths(grid, (0, 0), (10, 0), range(8))
    toll = Ways("toll", moves=np.where(np.indices((8, 8, 15))[1] == 0, 14.0, 10.0))
    problem = GridPathProblem(
        grid, (0, 0), (10, 0), CellSequence(grid, (0, 0), (10, 0), 60), [Ways("ten", moves=(10.0, 14.0)), toll]
    )
    found = exact_front(problem)
    measures = measures_of(Along(paths), problem.objectives)
    np.testing.assert_allclose(found.F, front_of(measures, ("ten", "toll")))


def test_codings_without_detours_have_no_exact_front_where_a_detour_may_be_better():
    grid, _, guards = guarded(12, 1)
    for own in (guards, Ways("dear", moves=(1.0, 3.0))):
        problem = GridPathProblem(grid, (0, 0), (11, 11), "integer", ["length", own])
        with pytest.raises(CapabilityError, match=f"by the objective '{own.name}' two steps may cost less .* 'cells'"):
            exact_front(problem)
        assert problem.pareto_front() is None
    metres, toll = Ways("metres", moves=(0.05, 0.07)), Cost("toll", np.random.default_rng(1).integers(0, 9, size=(12, 12)))
    assert len(GridPathProblem(grid, (0, 0), (11, 11), "integer", [metres, toll]).pareto_front(max_seconds=60)) > 1
