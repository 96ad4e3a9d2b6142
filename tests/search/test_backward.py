"""Searches from the goal: cells taken from lists are those of a heap, and a search goes on where it stopped."""

from __future__ import annotations

import numpy as np
import pytest

from pymoo_gridpath.exact.costs import OCTILE
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.search import UNREACHABLE, Moves, backward_costs, shortest
from pymoo_gridpath.search.shortest import Backward

STEP = np.stack([np.tile(OCTILE, (9, 1)), np.zeros((9, 8), dtype=np.int64)])


def cases(n):
    """Yield moves, costs of cells and the arguments of searches, each kind several times."""
    draw = np.random.default_rng(3)
    for number in range(n):
        occupied = draw.random(draw.integers(2, 20, 2)) < draw.random() * 0.4
        occupied.flat[0] = False
        moves = Moves(OccupancyGrid(occupied))
        field = draw.integers(0, 2**36, (2, moves.n_cells))
        if number % 2:
            field[0] = 0
        given: dict = {}
        if number % 3 == 1:
            given["weights"] = (1.0, float(draw.random())) if number % 4 else (0.05 + float(draw.random()), 1.0)
        if number % 3 == 2:
            spent = backward_costs(moves.backward(), STEP, field, int(draw.integers(moves.n_cells)))[0][0]
            given |= {"spent": spent, "limit": int(spent[spent < UNREACHABLE].max(initial=0) * 1.2) + 1}
        if number % 5 == 0:
            given["enter"] = draw.integers(0, 2**30, (2, moves.n_cells, 8))
        yield moves, field, given, draw


@pytest.mark.parametrize("step", [STEP, np.stack([0 * STEP[0], STEP[0]])], ids=["length", "nothing"])
def test_lists_find_what_a_heap_finds(step, monkeypatch):
    """Where a step and the cell that it leads to may cost nothing, the lists are taken from in order."""
    kinds = set()
    for moves, field, given, _ in cases(60):
        searches = []
        for most in (2**14, 0):
            monkeypatch.setattr(shortest, "_MOST_LISTS", most)
            searches.append(Backward(moves, step, field, 0, **given))
            searches[-1].run()
        by_list, by_heap = searches
        kinds.add(bool(by_list._in_order))
        assert by_heap._in_order
        assert len(by_list._first_of) >= len(by_heap._first_of)
        np.testing.assert_array_equal(by_list.cost, by_heap.cost)
    assert kinds == ({False} if step.any(axis=(1, 2))[0] else {False, True})


@pytest.mark.parametrize("most", [2**14, 0])
def test_a_search_that_stopped_goes_on(most, monkeypatch):
    monkeypatch.setattr(shortest, "_MOST_LISTS", most)
    for moves, field, given, draw in cases(60):
        whole, parts = (Backward(moves, STEP, field, 0, **given) for _ in range(2))
        whole.run()
        cell = int(draw.integers(moves.n_cells))
        parts.run(until=cell)
        if whole.cost[0, cell] < UNREACHABLE:
            near = whole.cost[0] <= whole.cost[0, cell]
            np.testing.assert_array_equal(parts.cost[:, near], whole.cost[:, near])
        beyond = int(np.median(whole.cost[0]))
        parts.run(beyond=beyond)
        near = whole.cost[0] < beyond
        np.testing.assert_array_equal(parts.cost[:, near], whole.cost[:, near])
        parts.run()
        np.testing.assert_array_equal(parts.cost, whole.cost)


def test_a_part_has_the_steps_of_the_whole_that_do_not_leave_it():
    grid = OccupancyGrid(np.random.default_rng(1).random((12, 15)) < 0.2)
    moves = Moves(grid)
    wanted = np.zeros(moves.n_cells, dtype=bool)
    wanted[[moves.index((4, 3)), moves.index((9, 8))]] = True
    part = moves.around(wanted)
    assert (part.width, part.height) == (6, 6) and part.box == (4, 3, 10, 9)
    for index in range(part.n_cells):
        x, y = part.cells(np.array(index))
        whole = moves.index((x, y))
        assert part.index((x, y)) == index and part.to_grid(np.array(index)) == moves.to_grid(np.array(whole))
        for m in range(8):
            dx, dy = moves.cells(np.array(whole + moves.offsets[m])) - (x, y) if moves.legal[whole] >> m & 1 else (99, 99)
            inside = 4 <= x + dx < 10 and 3 <= y + dy < 9
            assert bool(part.legal[index] >> m & 1) == inside
    values = np.arange(2 * 3 * moves.n_cells).reshape(2, -1)
    np.testing.assert_array_equal(moves.part_of(values, part), values.reshape(2, 12, 15, 3)[:, 3:9, 4:10].reshape(2, -1))
    assert moves.around(np.ones(moves.n_cells, dtype=bool)) is moves
