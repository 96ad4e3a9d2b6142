"""How many moves a grid has, and how corners are cut, against definitions cell by cell."""

import itertools
import pickle

import numpy as np
import pytest
from scipy.sparse import csgraph

from pymoo_gridpath.errors import GridError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.neighbourhood import CORNERS, HEADINGS, LENGTHS, MOVES, neighbourhood_of
from pymoo_gridpath.paths import CellPaths
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.testing import reference
from pymoo_gridpath.testing.enumeration import RULES, legal_steps


def random_grids(steps, n=40):
    rng = np.random.default_rng(len(str(steps)))
    for _ in range(n):
        yield OccupancyGrid(rng.random(rng.integers(1, 9, 2)) < rng.uniform(0.1, 0.6), **steps), rng


@pytest.mark.parametrize("steps", RULES, ids=str)
def test_moves_graph_and_regions_are_of_the_same_steps(steps):
    for grid, _ in random_grids(steps):
        moves, graph = Moves(grid), grid.move_graph()
        lengths = graph.toarray()
        for y, x in np.ndindex(grid.shape):
            cell = y * grid.width + x
            ends = {m: v * grid.width + u for m, (u, v) in legal_steps(grid, (x, y))} if grid.is_free((x, y)) else {}
            assert [m for m in range(8) if moves.legal[cell] >> m & 1] == sorted(ends)
            assert {int(other): lengths[cell, other] for other in np.flatnonzero(lengths[cell])} == {
                other: LENGTHS[m] for m, other in ends.items()
            }
        _, joined = csgraph.connected_components(graph)
        regions, free = grid.regions.ravel(), np.flatnonzero(~grid.occupied)
        assert all((joined[a] == joined[b]) == (regions[a] == regions[b]) for a, b in itertools.combinations(free, 2))


@pytest.mark.parametrize("steps", RULES, ids=str)
def test_a_path_crosses_no_cell_if_and_only_if_its_steps_are_legal(steps):
    n_legal = 0
    for grid, rng in random_grids(steps):
        paths = CellPaths(grid, rng.integers(0, grid.occupied.size, (20, 3)))
        for row, crossed in zip(paths.rows, paths.interfering_cells, strict=True):
            cells = reference.visited(row, grid.width)
            assert crossed == reference.broken_cells(cells, grid)
            legal = grid.is_free(cells[0]) and all(
                grid.is_free(a) and b in [end for _, end in legal_steps(grid, a)] for a, b in itertools.pairwise(cells)
            )
            assert (crossed == 0) == legal
            n_legal += legal and len(cells) > 1
    assert n_legal > 10


@pytest.mark.parametrize(("moves", "corner_cutting"), list(itertools.product(MOVES, CORNERS)))
def test_both_forms_of_the_rule_agree(moves, corner_cutting):
    rule = neighbourhood_of(moves, corner_cutting)
    first, second = (np.array(values) for values in zip(*itertools.product([False, True], repeat=2), strict=True))
    crossed = rule.crossings(first, second)
    assert crossed.tolist() == [rule.crossed[k] for k in (0, 1, 1, 2)]
    assert rule.may_pass(~first, ~second).tolist() == (crossed == 0).tolist()
    # Regions, and what planners ask for, rely on it.
    assert rule.crossed == tuple(sorted(rule.crossed))
    assert rule.restricts == (crossed != 0).any() and rule.rounds == (crossed[1] == 0) and rule.squeezes == (crossed[3] == 0)


def test_four_moves_are_the_straight_ones():
    moves = Moves(OccupancyGrid(np.zeros((3, 3)), moves=4))
    assert [HEADINGS[m].tolist() for m in range(8) if moves.legal[4] >> m & 1] == [[1, 0], [0, 1], [-1, 0], [0, -1]]
    assert OccupancyGrid(np.zeros((3, 5)), moves=4).shortest_length((0, 0), (4, 2)) == 6.0


def test_one_side_may_be_occupied_and_not_both():
    for occupied, length in (([[0, 0], [0, 0]], 2**0.5), ([[0, 0], [1, 0]], 2**0.5), ([[0, 1], [1, 0]], np.inf)):
        assert OccupancyGrid(occupied, corner_cutting="one side").shortest_length((0, 0), (1, 1)) == length


def test_a_grid_keeps_and_says_its_steps():
    grid = OccupancyGrid(np.zeros((2, 3)), moves=4)
    assert (grid.moves, grid.replace(name="b").moves, grid.grow(1.0).moves) == (4, 4, 4)
    assert grid != grid.replace(moves=8) and grid == pickle.loads(pickle.dumps(grid)) and "no diagonal steps" in repr(grid)
    grid = OccupancyGrid(np.zeros((2, 3)), corner_cutting="one side")
    assert grid.corner_cutting == "one side" and repr(grid).endswith("corners may be cut on one side>")
    assert grid == pickle.loads(pickle.dumps(grid)) and grid != grid.replace(corner_cutting=True)
    assert grid.digest == grid.replace(moves=4).digest == grid.replace(corner_cutting=False).digest


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"moves": 6}, "moves is 6, expected 4 or 8"),
        ({"moves": True}, "moves is True, expected 4 or 8"),
        ({"moves": "8"}, "moves is '8', expected 4 or 8"),
        ({"corner_cutting": "both"}, "corner_cutting is 'both', expected True, False or 'one side'"),
        ({"corner_cutting": 1}, "corner_cutting is 1, expected True, False or 'one side'"),
    ],
)
def test_other_steps_are_refused(arguments, message):
    with pytest.raises(GridError, match=message):
        OccupancyGrid(np.zeros((2, 2)), **arguments)
