"""What is joined to the cheapest ways on, and the staircase that it lowers, beside plain loops."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pymoo_gridpath.exact.costs import Costs, integer_costs
from pymoo_gridpath.exact.staircase import Staircase, lower, lower_marks
from pymoo_gridpath.exact.ways import FIRST, SECOND, SUM, Ways, undominated, without_loops
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.objectives import Length, Turn, Vulnerability
from pymoo_gridpath.search import Moves
from pymoo_gridpath.search.shortest import Backward

points = st.lists(st.tuples(st.integers(0, 1000), st.integers(0, 1000)), max_size=30)
NOTHING = np.zeros((2, 3), dtype=np.int64)


@given(points, st.integers(1, 200))
def test_a_staircase_is_the_least_second_cost_up_to_where_a_bin_begins(known, n_states):
    stairs = Staircase((10, 900), (800, 5), n_states)
    known = [(first + 10, second) for first, second in known]
    for first, second in known:
        lower(stairs.least, stairs.low, stairs.shift, first, second)
    for k, least in enumerate(stairs.least.tolist()):
        begin = stairs.low + (k << stairs.shift)
        assert least == min([900, *(second for first, second in known if first <= begin)])


@given(points, st.integers(20, 400), st.sampled_from([0, 30]))
def test_marks_stay_above_all_that_ends_below_a_staircase(known, n_states, share):
    corners = np.array([(0, 1000), (300, 400), (1000, 0)])
    stairs = Staircase((0, 1000), (1000, 0), n_states)
    for first, second in known:
        lower(stairs.least, stairs.low, stairs.shift, first, second)
    weights, gaps = np.array([[1.0, 0.5], [0.5, 1.0]]), stairs.gaps(corners)
    ceilings, marks = np.empty(2), np.empty((2, 2), dtype=np.int64)
    allowed = NOTHING + np.array([0, 0, share])
    lower_marks(stairs.least, stairs.low, stairs.shift, gaps, weights, allowed, 0, True, ceilings, marks)
    known = [*known, (0, 1000), (1000, 0)]
    draw = np.random.default_rng(n_states)
    for first, second in draw.integers(0, 1001, (50, 2)).tolist():
        if any(one - share <= first and two - share <= second and (one, two) != (first, second) for one, two in known):
            continue
        begin = gaps[(first - stairs.low) >> stairs.shift]
        sums = weights @ (first, second)
        assert any(first < marks[j, 0] and second < marks[j, 1] and sums[j] < ceilings[j] for j in range(begin, 2))


@pytest.mark.parametrize("second", [Vulnerability(variance=0.5), Turn()], ids=["vulnerability", "turn"])
@pytest.mark.parametrize("at_once", [True, False])
def test_paths_are_joined_to_the_cheapest_ways_on(second, at_once):
    occupied = np.random.default_rng(3).random((9, 9)) < 0.2
    occupied[0] = occupied[:, -1] = False
    grid = OccupancyGrid(occupied)
    moves = Moves(grid)
    costs = integer_costs([Length(), second], grid, moves)
    start, goal = moves.index((0, 0)), moves.index((8, 8))
    stairs = Staircase((0, 2**60), (2**40, 0), moves.n_cells)
    ways = Ways(moves, costs, goal, 2, stairs, at_once)
    direct = np.array([moves.index((x, 0)) for x in range(9)] + [moves.index((8, y)) for y in range(1, 9)])
    ways.begin(direct)
    least = []
    for number, weights in enumerate([(1.0, 0.25), (0.125, 1.0)]):
        found = Backward(
            moves, costs.step, costs.field, goal, costs.with_heading, np.zeros((2, moves.n_cells)), weights=weights
        )
        found.run()
        least.append(found.cost[0].copy())
        ways.add(*ways.of(found, number))
    ways.complete()
    for number, sums in enumerate(least):
        for state in range(ways.rows.shape[1]):
            row = ways.rows[number, state].tolist()
            if ways.ahead[number][state] < 0:
                at_goal = (state // 8 if costs.with_heading else state) == goal
                assert row[FIRST:] == ([0.0, 0.0] if at_goal else [np.inf, np.inf])
                continue
            exact = walked(moves, costs, ways.ahead[number], state, goal)
            assert sums[state] * (1 - 2**-21) <= row[SUM] <= sums[state]
            for name, cost in zip((FIRST, SECOND), exact, strict=True):
                assert cost <= row[name] <= cost * (1 + 2**-21)
    joined = ways.joined()
    assert len(joined.paths) >= 1 and len(ways.points) > 1 and len(undominated(joined.points)) == len(joined.points)
    for path, point in zip(joined.paths, joined.points.tolist(), strict=True):
        steps = {(int(a), int(b)) for a, b in pairwise(path)}
        assert path[0] == start and path[-1] == goal and len(set(path.tolist())) == len(path)
        assert all(moves.legal[a] >> moves.offsets.tolist().index(b - a) & 1 for a, b in steps)
        assert costs.of_path(path, moves).tolist() == point
    # None costs more than what was joined is said to.
    assert all((joined.points <= row).all(axis=1).any() for row in ways.points)


def walked(moves: Moves, costs: Costs, ahead: np.ndarray, state: int, goal: int) -> list[int]:
    """Return both costs of the way ahead from a state, step by step."""
    cell, heading = (state // 8, state % 8) if costs.with_heading else (state, 8)
    total = [0, 0]
    while cell != goal:
        m = int(ahead[8 * cell + heading if costs.with_heading else cell])
        cell += int(moves.offsets[m])
        total = [total[k] + int(costs.step[k, heading, m]) + int(costs.field[k, cell]) for k in range(2)]
        heading = m if costs.with_heading else 8
    return total


@given(st.lists(st.integers(0, 6), min_size=1, max_size=12))
def test_a_path_without_loops_visits_each_cell_once(cells):
    found = without_loops(np.array(cells)).tolist()
    assert len(set(found)) == len(found) and found[0] == cells[0] and found[-1] == cells[-1]
    for a, b in pairwise(found):
        assert (a, b) in pairwise(cells)
