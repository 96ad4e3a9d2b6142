"""The coding by cells: what fits into it, what its repair makes of any row, and what it needs of its arguments."""

import copy
import itertools
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from queries import SPIRAL, queries, random_genes

from pymoo_gridpath.errors import GridError, GridPathError, UnreachableError
from pymoo_gridpath.fields import obstacle_potential
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.operators.duplicates import row_keys
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.representations import CellSequence, make_representation
from pymoo_gridpath.testing import reference
from pymoo_gridpath.testing.enumeration import RULES


def joined(paths):
    return Sequences(np.concatenate(paths).astype(np.int64), np.cumsum([0, *map(len, paths)]))


def simple_paths(grid, start, goal):
    """All legal paths without loops, as lists of cells."""
    moves = CellSequence(grid, start, goal, grid.occupied.size).moves
    stack = [[moves.index(start)]]
    while stack:
        path = stack.pop()
        if path[-1] == moves.index(goal):
            yield [tuple(cell) for cell in moves.cells(np.array(path)).tolist()]
            continue
        for m in range(8):
            cell = path[-1] + int(moves.offsets[m])
            if moves.legal[path[-1]] >> m & 1 and cell not in path:
                stack.append([*path, cell])


def test_a_query_without_a_monotone_path_can_be_coded():
    with pytest.raises(UnreachableError, match="representation='cells'"):
        make_representation("integer", SPIRAL, (0, 0), (2, 2))
    coding = make_representation("cells", SPIRAL, (0, 0), (2, 2))
    assert coding.n_var == SPIRAL.occupied.size - SPIRAL.n_occupied
    repaired = coding.repair(np.full((1, coding.n_var), 3), np.random.default_rng(0))
    paths = coding.decode(repaired)
    assert paths.interfering_cells.tolist() == [0]
    assert paths.length[0] == 16.0


@settings(max_examples=40)
@given(st.integers(0, 2**32 - 1), st.sampled_from(RULES), st.sampled_from([(3, 4), (4, 3), (2, 7), (1, 9)]))
def test_every_efficient_path_fits_by_default(seed, steps, shape):
    rng = np.random.default_rng(seed)
    occupied = rng.random(shape) < rng.choice([0.0, 0.2, 0.4])
    start, goal = (0, 0), (shape[1] - 1, shape[0] - 1)
    occupied[0, 0] = occupied[-1, -1] = False
    grid = OccupancyGrid(occupied, **steps)
    try:
        coding = CellSequence(grid, start, goal)
    except UnreachableError:
        return
    field = obstacle_potential(grid)
    paths = [(sum(field[y, x] for x, y in path), reference.length(path), len(path)) for path in simple_paths(grid, start, goal)]
    safest = min(paths)
    shortest = min(length for _, length, _ in paths)
    least = min(cells for _, length, cells in paths if length <= shortest + 1e-9)
    reachable = int((grid.regions == grid.regions[0, 0]).sum())
    room = max(1 + int(safest[1] + 1e-9), int(np.ceil(1.5 * least)) + 8)
    assert coding.max_cells == coding.n_var == min(room, reachable)
    for vulnerability, length, cells in paths:
        dominated = any(v <= vulnerability and s < length - 1e-9 for v, s, _ in paths)
        assert dominated or cells <= coding.max_cells
    with pytest.raises(GridPathError, match=f"expected a whole number of at least {least}"):
        CellSequence(grid, start, goal, least - 1)
    assert CellSequence(grid, start, goal, np.int64(least)).n_var == least


@given(queries())
def test_repair_makes_legal_paths_and_leaves_them_alone(query):
    grid, start, goal, _, rng = query
    coding = CellSequence(grid, start, goal)
    X = random_genes(coding, rng)
    before = X.copy()
    repaired = coding.repair(X, rng)
    assert np.array_equal(X, before), "the argument was changed"
    assert repaired.dtype == np.int64 and repaired.shape == X.shape
    assert not ((repaired < coding.xl) | (repaired > coding.xu)).any()
    assert (coding.decode(repaired).interfering_cells == 0).all()
    assert np.array_equal(coding.repair(repaired, rng), repaired)
    assert coding.repair(X[:0], rng).shape == (0, coding.n_var)


@given(queries(), st.sampled_from(["integer", "binary", "mixed", "absolute"]))
def test_paths_of_other_codings_can_be_encoded(query, name):
    grid, start, goal, axis, rng = query
    other = make_representation(name, grid, start, goal, axis)
    paths = other.decode(random_genes(other, rng))
    coding = CellSequence(grid, start, goal, max(grid.occupied.size, 2 * grid.width * grid.height))
    again = coding.decode(coding.encode(paths))
    assert np.array_equal(again.length, paths.length) and np.array_equal(again.turn, paths.turn)
    assert np.array_equal(other.from_sequences(again.sequences), other.from_sequences(paths.sequences))


def test_pauses_move_to_the_end_so_that_equal_paths_have_equal_rows():
    coding = CellSequence(OccupancyGrid(np.zeros((1, 4))), (0, 0), (3, 0), max_cells=6)
    X = coding.repair(np.array([[0, 0, 1, 2, 2, 3], [0, 1, 2, 3, 3, 3]]), np.random.default_rng(0))
    assert X.tolist() == [[0, 1, 2, 3, 3, 3]] * 2
    assert len(set(row_keys(X))) == 1


def test_loops_are_left_out_only_of_what_does_not_fit():
    coding = CellSequence(OccupancyGrid(np.zeros((2, 3))), (0, 0), (2, 0), max_cells=5)
    loop = [0, 1, 4, 3, 0, 1, 2]
    kept = [0, 3, 0, 1, 2]
    X = coding.from_sequences(joined([loop, kept]))
    assert X.tolist() == [[0, 1, 2, 2, 2], kept]
    assert coding.fits(joined([loop, kept])).tolist() == [False, True]
    small = CellSequence(OccupancyGrid(np.zeros((2, 3))), (0, 0), (2, 0), max_cells=3)
    with pytest.raises(GridPathError, match="a path visits 5 cells, expected at most 3, the max_cells of the cells rep"):
        small.from_sequences(joined([[0, 1, 2], [0, 3, 4, 5, 2]]))


@pytest.mark.parametrize("path", [[0, 1], [1, 2], []])
def test_paths_of_other_queries_are_refused(path):
    coding = CellSequence(OccupancyGrid(np.zeros((2, 3))), (0, 0), (2, 0))
    with pytest.raises(GridPathError, match=r"leads between other cells than start \(0, 0\) and goal \(2, 0\)"):
        coding.from_sequences(joined([[0, 1, 2], path]))


@pytest.mark.parametrize("max_cells", [2, -1, 2.5, "many"])
def test_too_few_cells_are_refused(max_cells):
    with pytest.raises(GridPathError, match=r"max_cells is .*, expected a whole number of at least 3"):
        CellSequence(OccupancyGrid(np.zeros((3, 3))), (0, 0), (2, 2), max_cells)


def test_refusals_say_why():
    grid = OccupancyGrid([[0, 0, 1, 0]])
    with pytest.raises(UnreachableError, match="cannot be reached"):
        CellSequence(grid, (0, 0), (3, 0))
    with pytest.raises(GridError, match="obstacle"):
        CellSequence(grid, (0, 0), (2, 0))
    with pytest.raises(GridPathError, match="advance along none; expected 'auto'"):
        make_representation("cells", grid, (0, 0), (1, 0), "x")
    coding = make_representation("cells", grid, (0, 0), (1, 0))
    with pytest.raises(
        GridPathError, match=r"field is an array of float64 of shape \(4, 1\), expected numbers of shape \(1, 4\)"
    ):
        coding.prepare(np.zeros((4, 1)))
    with pytest.raises(GridPathError, match="expected 2 genes of the cells representation"):
        coding.decode(np.zeros((1, 5)))


def test_genes_that_are_no_cells_count_as_their_bounds_and_real_ones_are_rounded():
    coding = CellSequence(OccupancyGrid(np.zeros((2, 2))), (0, 0), (1, 1), max_cells=4)
    assert coding.genes(np.array([[9, -3, 7, 0]])).tolist() == [[0, 0, 3, 3]]
    assert coding.genes(np.array([[0.2, 1.4, 0.6, 3.0]])).tolist() == [[0, 1, 1, 3]]


@pytest.mark.parametrize("clone", [copy.deepcopy, lambda coding: pickle.loads(pickle.dumps(coding))])
def test_copies_decode_the_same(clone):
    coding = CellSequence(SPIRAL, (0, 0), (2, 2))
    rng = np.random.default_rng(0)
    X = random_genes(coding, rng)
    for first, second in itertools.pairwise([coding, clone(coding)]):
        assert np.array_equal(first.repair(X, rng), second.repair(X, rng))
        assert np.array_equal(first.decode(X).turn, second.decode(X).turn)
        assert np.array_equal(first.moves.legal, second.moves.legal)
