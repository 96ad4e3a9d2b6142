"""Fronts that are near enough: what is certified of them is true, and nothing is where nothing is proven."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from exact_fronts import Cost, front_of, holds, queries_of, random_grid, whole_costs
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import ExactFront
from pymoo_gridpath.errors import CapabilityError, GridPathError
from pymoo_gridpath.exact import Budget, Certificate, exact_front
from pymoo_gridpath.exact.nearness import WHOLE, Allowance, Lines, certificate, lowered
from pymoo_gridpath.representations import CellSequence

ASKED = [{name: value} for name in ("epsilon", "share") for value in (0.001, 0.05, 0.4, 1.0)]


def test_certificates_are_true_of_all_paths():
    """Beside the enumeration of all paths, with many a zero among the costs."""
    n_near = 0
    for seed, grid, start, goal, _, along in queries_of(0, 2, 25):
        costs = whole_costs(grid.shape, seed)
        front = front_of({name: along.cells(field) for name, field in costs.items()}, "ab")
        problem = GridPathProblem(grid, start, goal, "cells", [Cost(*one) for one in costs.items()])
        for asked in ASKED:
            found = exact_front(problem, **asked)
            assert found.success and found.certified is not None and holds(found.certified, found.F, front), (seed, asked)
            assert all(getattr(found.certified, name) <= value for name, value in asked.items())
            n_near += not found.complete and len(found.F) < len(front)
    assert n_near >= 2


@pytest.mark.parametrize("seed", range(4))
def test_certificates_of_searches_cut_short_are_true(seed):
    grid = random_grid(16, seed)
    costs = [Cost(*one) for one in whole_costs(grid.shape, seed + 100).items()]
    problem = GridPathProblem(grid, (0, 0), (15, 15), "cells", costs)
    whole = exact_front(problem)
    assert whole.complete and whole.success and whole.certified == WHOLE
    seen = set()
    for max_labels in np.unique(np.linspace(0, whole.n_labels + 20, 25).astype(int)).tolist():
        for asked in ({}, {"epsilon": 0.03}, {"share": 0.03}):
            found = exact_front(problem, Budget(max_labels=max_labels), **asked)
            assert found.certified is not None and holds(found.certified, found.F, whole.F), (max_labels, asked)
            text = found.certified.said("share") if "share" in asked else str(found.certified)
            if not asked:
                assert found.complete is found.success and (not found.complete or found.certified == WHOLE)
                seen.add(found.certified.epsilon)
            if "ended early" in found.message:
                assert found.message.endswith(f"found, {text}")
    assert len(whole.F) < 5 or len(seen) > 2


def test_the_worst_cell_of_a_path_is_no_worse():
    for seed in range(4):
        grid = random_grid(12, seed, 0.1)
        costs = [Cost(*one) for one in whole_costs(grid.shape, seed + 7).items()]
        problem = GridPathProblem(grid, (0, 0), (11, 11), "cells", [*costs, "clearance"])
        front = exact_front(problem).F
        for asked in ASKED[1:3] + ASKED[5:7]:
            found = exact_front(problem, **asked)
            assert found.certified is not None
            for level in np.unique(front[:, 2]):
                within = [rows[rows[:, 2] <= level][:, :2] for rows in (found.F, front)]
                ranges = np.ptp(front[:, :2], axis=0)
                factor = [(p <= (1 + found.certified.epsilon) * q).all() for p in within[0] for q in within[1]]
                near = [(p <= q + found.certified.share * ranges).all() for p in within[0] for q in within[1]]
                for each in (factor, near):
                    assert np.reshape(each, (len(within[0]), -1)).any(axis=0).all()
        # Levels that were not searched may hold anything.
        assert exact_front(problem, Budget(max_labels=5)).certified is None


def test_zeros_and_single_points():
    empty = GridPathProblem(OccupancyGrid(np.zeros((9, 9))), (0, 0), (8, 8), "cells")
    for asked in ({"epsilon": 0.02}, {"share": 0.02}):
        found = exact_front(empty, **asked)
        assert found.complete and found.certified == WHOLE and found.message == "all 1 point found"
    # The one way costs nothing in the first objective, the other nothing in the second.
    grid = OccupancyGrid([[0, 0, 0], [0, 1, 0], [0, 0, 0]], corner_cutting=False)
    a, b = np.array([[0, 0, 0], [9, 0, 0], [9, 9, 0]]), np.array([[0, 8, 8], [0, 0, 8], [0, 0, 0]])
    problem = GridPathProblem(grid, (0, 0), (2, 2), "cells", [Cost("a", a), Cost("b", b)])
    early = exact_front(problem, Budget(max_labels=0))
    assert early.F.tolist() == [[0, 24], [27, 0]] == exact_front(problem, epsilon=1.0).F.tolist()
    assert early.certified is not None and early.certified.epsilon == np.inf and early.certified.share <= 1.0
    assert early.message.endswith("% of the front's range")


def test_costs_are_lowered_without_rounding():
    begin, cost = 12_345, 2**57 + 1
    for epsilon in (0.02, 1e-9, 1.0, 0.7):
        b, parts, less = Allowance(epsilon=epsilon).counted(np.array([begin, 0]), np.array([5, 5]))[0].tolist()
        least = lowered(cost, b, parts, less)
        factor = 1 + Fraction(parts, 2**30)
        assert factor <= 1 + Fraction(epsilon) < factor + Fraction(1, 2**30)
        assert factor * (least + begin) >= cost + begin > factor * (least - 1 + begin)
    assert lowered(cost, *Allowance(share=0.25).counted(np.zeros(2, int), np.array([4, 7]))[1].tolist()) == cost - 1
    assert lowered(cost, *Allowance().counted(np.array([begin, 0]), np.array([4, 7]))[0].tolist()) == cost


def test_what_lines_prove_is_the_farthest_that_they_leave_room_for():
    """By the largest factor for which a corner divided by it still lies above all lines, from a fine grid of factors."""
    draw = np.random.default_rng(3)
    for _ in range(20):
        known = np.column_stack([np.cumsum(draw.integers(1, 50, 6)), np.cumsum(draw.integers(1, 50, 6))[::-1]]) + 20
        weights = draw.uniform(0.1, 1.0, (3, 2))
        lines = Lines(weights, (known @ weights.T).min(axis=0) * draw.uniform(0.8, 1.0, 3))
        begin = draw.integers(0, 30, 2)
        found = certificate(known, lines, begin)
        corners = np.column_stack([known[1:, 0], known[:-1, 1]])
        factors, ends = np.linspace(1.0, 4.0, 30_001), known.min(axis=0)
        lower = (corners[:, None] + begin) / factors[:, None] - begin
        room = (lower @ weights.T >= lines.least).all(axis=2) & (lower >= ends).all(axis=2)
        assert abs(1 + found.epsilon - np.where(room, factors, 1.0).max()) < 2e-4
        shares = np.linspace(0.0, 1.0, 10_001)
        lower = corners[:, None] - shares[:, None] * np.ptp(known, axis=0)
        room = (lower @ weights.T >= lines.least).all(axis=2) & (lower >= ends).all(axis=2)
        assert abs(found.share - np.where(room, shares, 0.0).max()) < 2e-4


@pytest.mark.parametrize(
    ("problem", "what"),
    [
        (lambda: GridPathProblem(random_grid(8, 1), (0, 0), (7, 7), "cells", ["length", "vulnerability", "turn"]), "three obj"),
        (
            lambda: GridPathProblem(random_grid(8, 1), (0, 0), (7, 7), "cells", obstacles="limit", potential_limit=9.0),
            "a potential limit",
        ),
        (
            lambda: GridPathProblem(
                random_grid(8, 1), (0, 0), (7, 7), "cells", ["length", Cost("odd", np.full((8, 8), np.pi / 3) ** np.arange(8))]
            ),
            "the objective 'odd', whose costs have to be rounded",
        ),
    ],
    ids=["three", "limit", "rounded"],
)
def test_what_cannot_be_certified_is_refused_and_has_no_certificate(problem, what):
    problem = problem()
    for name in ("epsilon", "share"):
        with pytest.raises(CapabilityError, match=f"{name} is not for {what}"):
            exact_front(problem, **{name: 0.1})
    cut = exact_front(problem, Budget(max_labels=3))
    assert cut.certified is None and "within" not in cut.message


def test_grids_are_refused_by_the_cells_that_paths_may_visit(monkeypatch):
    grid = random_grid(8, 1)
    problem = GridPathProblem(grid, (0, 0), (7, 7), "cells")
    front = exact_front(problem).F
    n_cells = np.count_nonzero(problem.representation.moves.legal)
    assert n_cells < 64
    for most in (n_cells, n_cells - 1):
        monkeypatch.setattr("pymoo_gridpath.exact.front._MOST_CELLS", most)
        if most == n_cells:
            np.testing.assert_array_equal(exact_front(problem).F, front)
    with pytest.raises(CapabilityError, match=f"paths may visit {n_cells} cells, expected at most {n_cells - 1} for an exact"):
        exact_front(problem)


@pytest.mark.parametrize("value", [0, -0.1, 1.5, np.nan, "2%", True])
def test_numbers_out_of_range_are_refused(value):
    problem = GridPathProblem(random_grid(8, 1), (0, 0), (7, 7), "cells")
    for name in ("epsilon", "share"):
        with pytest.raises(GridPathError, match=f"{name} is .*expected a number above 0, at most 1"):
            exact_front(problem, **{name: value})
    with pytest.raises(GridPathError, match="epsilon and share are given, expected one of them"):
        ExactFront(epsilon=0.1, share=0.1)


def test_rows_that_are_too_short_have_the_whole_front_of_what_fits():
    grid = OccupancyGrid(np.zeros((24, 24)))
    costs = [Cost(*one) for one in whole_costs((24, 24), 2).items()]
    coding = CellSequence(grid, (0, 0), (23, 23), max_cells=27)
    problem = GridPathProblem(grid, (0, 0), (23, 23), coding, costs)
    whole, near = exact_front(problem), exact_front(problem, epsilon=0.05)
    assert "27 cells, the max_cells" in near.message and near.complete and near.certified == WHOLE
    np.testing.assert_array_equal(near.F, whole.F)
    cut = exact_front(problem, Budget(max_labels=50), epsilon=0.05)
    assert cut.certified is None or holds(cut.certified, cut.F, whole.F)


def test_a_result_says_what_was_reached():
    problem = GridPathProblem(random_grid(40, 3), (0, 0), (39, 39), "cells")
    near = minimize(problem, ExactFront(epsilon=0.02))
    assert near.success is True and 0 < near.certified.epsilon <= 0.02 and near.message.endswith("% of the front")
    assert not near.algorithm.found.complete
    cut = minimize(problem, ExactFront(max_labels=100))
    assert cut.success is False and cut.certified.epsilon > 0 and "ended early" in cut.message
    assert minimize(problem, ExactFront()).certified == WHOLE


def test_a_problem_returns_a_front_that_is_near_only_when_asked():
    problem = GridPathProblem(random_grid(40, 3), (0, 0), (39, 39), "cells")
    with pytest.warns(UserWarning, match="no Pareto front"):
        assert problem.pareto_front(max_seconds=0, epsilon=0.02) is None
    near = problem.pareto_front(epsilon=0.05)
    assert problem.pareto_front(epsilon=0.05) is near and len(problem.pareto_set(epsilon=0.05)) == len(near)
    np.testing.assert_array_equal(problem.evaluate(problem.pareto_set(epsilon=0.05)), near)
    front = problem.pareto_front(max_seconds=60)
    assert len(near) < len(front)
    np.testing.assert_array_equal(problem.pareto_front(share=0.1), front)
    with pytest.raises(CapabilityError, match="epsilon is not for three objectives"):
        three = GridPathProblem(random_grid(8, 1), (0, 0), (7, 7), "cells", ["length", "vulnerability", "turn"])
        three.pareto_front(epsilon=0.1)


@pytest.mark.parametrize(
    ("certified", "text"),
    [
        (WHOLE, "within 0 % of the front"),
        (Certificate(0.01301, 0.5), "within 1.31 % of the front"),
        (Certificate(0.02, 0.001), "within 2 % of the front"),
        (Certificate(np.inf, 0.034), "within 3.4 % of the front's range"),
    ],
)
def test_percentages_are_rounded_up(certified, text):
    assert str(certified) == text
