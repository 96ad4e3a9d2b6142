"""Cutting loops, mending, splicing and changing stretches, on random grids."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from queries import SPIRAL, queries

from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.representations import make_representation
from pymoo_gridpath.search import terrain as terrains
from pymoo_gridpath.search.draw import cheapest_paths, paths_through
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.sequences import are_legal, cut_loops, mend
from pymoo_gridpath.search.splice import splice
from pymoo_gridpath.search.terrain import make_terrain, plain_terrain
from pymoo_gridpath.search.vary import REROUTE, SHIFT, STRAIGHTEN, Changes, vary

names = st.sampled_from(["cells", "integer"])


def joined(paths):
    offsets = np.cumsum([0, *map(len, paths)])
    return Sequences(np.array([cell for path in paths for cell in path], dtype=np.int64), offsets)


def split(sequences):
    return [cells.tolist() for cells in np.split(sequences.cells, sequences.offsets[1:-1])]


def moves_of(query, name):
    grid, start, goal, axis, _ = query
    return make_representation(name, grid, start, goal, "auto" if name == "cells" else axis).moves


def terrain_of(query, name):
    moves = moves_of(query, name)
    grid, start, goal, _, rng = query
    return make_terrain(moves, moves.index(start), moves.index(goal), [rng.random(grid.shape)])


def random_paths(terrain, moves, rng, n=12):
    """Random legal paths without loops."""
    points = rng.choice(np.flatnonzero(terrain.useful), n)
    noise = np.stack([np.full(n, 8000), rng.integers(0, 2, n), rng.integers(0, 2**31, n)], axis=1)
    trees = np.stack([np.arange(n), rng.permutation(n)], axis=1)
    return paths_through(terrain, moves, points, trees, rng.integers(1, 1025, (n, 2)), noise, len(terrain.legal))


def copies(*arrays):
    return [array.copy() for array in arrays]


def unchanged(arrays, before):
    return all(map(np.array_equal, arrays, before))


def check(paths, terrain):
    assert paths.cells.dtype == paths.offsets.dtype == np.int64
    assert are_legal(paths, terrain).all()
    assert all(len(set(path)) == len(path) for path in split(paths))


def test_legality_is_that_of_each_step():
    moves = Moves(SPIRAL)
    terrain = plain_terrain(moves, 0, 10)
    way = [0, 1, 2, 3, 4, 9, 14, 19, 24, 23, 22, 21, 20, 15, 10]
    bad = [[], [0], way[1:], way[:-1], [*way[:3], 0, *way[3:]], [0, 5, 10], [0, -1, 10], [0, 99, 10]]
    assert are_legal(joined([way, *bad]), terrain).tolist() == [True] + [False] * len(bad)


@given(st.lists(st.lists(st.integers(0, 6), max_size=15), max_size=4))
def test_loops_are_cut_from_the_first_visit_to_the_last(paths):
    def expected(path):
        if not path:
            return []
        last = len(path) - 1 - path[::-1].index(path[0])
        return [path[0], *expected(path[last + 1 :])]

    sequences = joined(paths)
    before = sequences.cells.copy()
    assert split(cut_loops(sequences, 7)) == [expected(path) for path in paths] or not paths
    assert np.array_equal(sequences.cells, before)


@settings(max_examples=60)
@given(queries(density=0.3), names)
def test_mending_makes_legal_paths_and_keeps_legal_ones(query, name):
    rng = query[-1]
    moves, terrain = moves_of(query, name), terrain_of(query, name)
    n_cells = moves.n_cells
    broken = joined([rng.integers(-5, n_cells + 5, rng.integers(0, 12)).tolist() for _ in range(15)])
    legal = random_paths(terrain, moves, rng)
    for given_, keep in ((broken, False), (legal, True)):
        before = copies(*given_)
        mended = mend(given_, moves, terrain.start, terrain.goal)
        check(mended, terrain)
        assert unchanged(given_, before)
        if keep:
            assert split(mended) == split(given_)
    least = int(mend(joined([[]]), moves, terrain.start, terrain.goal).lengths[0])
    assert (mend(broken, moves, terrain.start, terrain.goal, least).lengths <= least).all()


def test_mending_keeps_to_the_cells_that_can_be_reached():
    moves = Moves(SPIRAL.replace(occupied=np.array([[0, 0, 0, 0, 0], [0, 1, 1, 1, 0], [0, 0, 0, 0, 0]])))
    # Over the top, with an obstacle and a gap in the way.
    assert split(mend(joined([[0, 6, 11, 13]]), moves, 0, 4)) == [[0, 5, 10, 11, 12, 13, 14, 9, 4]]
    assert split(mend(joined([[7, 3, 0]]), moves, 0, 4)) == [[0, 1, 2, 3, 4]], "the way back to the start is a loop"


def test_mending_ends_in_the_cheapest_way_where_the_room_does():
    moves = Moves(SPIRAL.replace(occupied=np.zeros((20, 20))))
    up_and_along = [20 * y for y in range(20)] + [380 + x for x in range(20)] + [399 - 20 * y for y in range(20)]
    for most in (20, 22, 30, 45):
        (path,) = split(mend(joined([up_and_along]), moves, 0, 19, most))
        followed = int(np.argmin(np.array(path) == np.array(up_and_along[: len(path)])))
        assert len(path) <= most
        assert followed >= (most - 19) // 2 and path[followed - 1] == up_and_along[followed - 1]


def test_mending_random_rows_is_bounded_and_keeps_them_apart():
    rng = np.random.default_rng(0)
    moves = Moves(SPIRAL.replace(occupied=rng.random((96, 96)) < 0.15))
    cells = np.flatnonzero(plain_terrain(moves, *ends_of(moves)).useful)
    rows = [rng.choice(cells, 160).tolist() for _ in range(20)]
    mended = mend(joined(rows), moves, *ends_of(moves), 160)
    check(mended, plain_terrain(moves, *ends_of(moves)))
    assert mended.lengths.max() <= 160 and len(set(map(tuple, split(mended)))) == 20


def ends_of(moves):
    """Two free cells in opposite corners."""
    free = np.flatnonzero(moves.legal)
    return int(free[0]), int(free[-1])


@settings(max_examples=60)
@given(queries(density=0.25), names)
def test_children_of_a_splice_are_made_of_their_parents(query, name):
    terrain, rng = terrain_of(query, name), query[-1]
    parents = random_paths(terrain, moves_of(query, name), rng)
    n = 30
    first, second = rng.integers(0, 12, n), rng.integers(0, 12, n)
    draws, weights = rng.random((n, 2)), rng.integers(1, 1025, (n, 2))
    given_ = *parents, first, second, draws, weights
    before = copies(*given_)
    for reach in (0, 3):
        children = splice(terrain, parents, first, second, draws, weights, reach, len(terrain.legal))
        check(children, terrain)
        paths = split(parents)
        for child, i, j in zip(split(children), first, second, strict=True):
            a, b = (set(pairwise(path)) for path in (paths[i], paths[j]))
            if reach == 0:
                assert set(pairwise(child)) <= a | b
    short = splice(terrain, parents, first, second, draws, weights, 3, 1)
    assert split(short) == [paths[i] for i in first], "what does not fit stays as it was"
    assert unchanged(given_, before)


def test_a_splice_exchanges_stretches_and_joins_near_paths():
    moves = Moves(SPIRAL.replace(occupied=np.zeros((5, 9))))
    terrain = make_terrain(moves, 18, 26, [np.zeros((5, 9))])
    low = [18, 10, 11, 12, 22, 14, 15, 16, 26]  # below the middle row, through its centre
    high = [18, 28, 29, 30, 22, 32, 33, 34, 26]
    parents, weights = joined([low, high]), np.array([[1024, 1]])
    ends = np.array([0]), np.array([1])
    children = {
        tuple(splice(terrain, parents, *ends, np.array([[u, v]]), weights, 4, 99).cells.tolist())
        for u in (0.1, 0.6)
        for v in (0.1, 0.9)
    }
    assert children == {(*low[:4], *high[4:]), (*high[:4], *low[4:])}
    apart = [[18, 10, *range(2, 7), 16, 26], [18, 28, *range(38, 43), 34, 26]]
    crossed = splice(terrain, joined(apart), *ends, np.array([[0.5, 0.5]]), weights, 4, 99)
    check(crossed, terrain)
    assert set(crossed.cells.tolist()) & {2, 3, 4} and set(crossed.cells.tolist()) & {40, 41, 42}
    assert split(splice(terrain, joined(apart), *ends, np.array([[0.5, 0.5]]), weights, 1, 99)) == [apart[0]]


@settings(max_examples=60)
@given(queries(density=0.2), names)
def test_changed_paths_are_legal_and_changed_only_between_the_ends(query, name):
    terrain, rng = terrain_of(query, name), query[-1]
    paths = random_paths(terrain, moves_of(query, name), rng)
    n, lengths = 12, paths.lengths
    begin = (rng.random(n) * (lengths - 1)).astype(np.int64)
    end = begin + 1 + (rng.random(n) * (lengths - 1 - begin)).astype(np.int64)
    noise = np.stack([rng.integers(0, 8000, n), rng.integers(0, 3, n), rng.integers(0, 2**31, n)], axis=1)
    changes = Changes(rng.integers(0, 3, n), begin, end, rng.integers(0, 8, n), rng.integers(1, 1025, (n, 2)), noise)
    before = copies(*paths, *changes)
    changed = vary(terrain, paths, changes, 4, 1000, len(terrain.legal))
    check(changed, terrain)
    assert split(vary(terrain, paths, changes, 4, 0, 1)) == split(paths)
    assert unchanged((*paths, *changes), before)
    for old, new, i, j in zip(split(paths), split(changed), begin, end, strict=True):
        # A loop may have taken away more than the stretch.
        if len(set(new) & set(old[:i] + old[j + 1 :])) == len(old) - (j - i) - 1:
            assert new[:i] == old[:i] and new[len(new) - len(old) + j + 1 :] == old[j + 1 :]


def test_stretches_are_rerouted_straightened_and_shifted():
    moves = Moves(SPIRAL.replace(occupied=np.zeros((4, 8))))
    field = np.zeros((4, 8))
    field[0, 1:-1] = 1.0
    terrain = make_terrain(moves, 0, 7, [field])
    zigzag = [0, 9, 2, 11, 4, 13, 6, 7]

    def change(way, heading, begin, end, weight=(1024, 1), path=zigzag):
        one = [np.array([v]) for v in (way, begin, end, heading)]
        noise = np.zeros((1, 3), dtype=np.int64)
        return split(vary(terrain, joined([path]), Changes(*one, np.array([weight]), noise), 4, 999, 99))[0]

    assert change(REROUTE, 0, 0, 7) == list(range(8))
    assert change(REROUTE, 0, 0, 7, (1, 1024)) == [0, *range(9, 15), 7]
    assert change(STRAIGHTEN, 0, 0, 7) == list(range(8))
    assert change(STRAIGHTEN, 0, 1, 6) == [0, 9, 2, 3, 4, 5, 6, 7]
    assert change(STRAIGHTEN, 1, 1, 6) == [0, 9, 10, 11, 12, 13, 6, 7]
    assert change(SHIFT, 2, 0, 7, path=list(range(8))) == [0, *range(9, 15), 7]
    assert change(SHIFT, 6, 0, 7, path=list(range(8))) == list(range(8)), "off the grid"
    assert change(SHIFT, 2, 3, 4) == zigzag, "nothing between"


def test_stretches_are_straightened_without_diagonal_steps_too():
    terrain = make_terrain(Moves(SPIRAL.replace(occupied=np.zeros((3, 4)), moves=4)), 0, 11)
    stairs = [0, 1, 5, 6, 10, 11]
    noise = np.zeros((1, 3), dtype=np.int64)

    def straightened(heading):
        one = [np.array([v]) for v in (STRAIGHTEN, 0, 5, heading)]
        return split(vary(terrain, joined([stairs]), Changes(*one, np.array([[1024]]), noise), 4, 999, 99))[0]

    assert straightened(0) == [0, 1, 2, 3, 7, 11] and straightened(1) == [0, 4, 8, 9, 10, 11]


@settings(max_examples=30)
@given(queries(density=0.25), names)
def test_whole_paths_are_legal_and_lead_through_their_points(query, name):
    moves, terrain, rng = moves_of(query, name), terrain_of(query, name), query[-1]
    check(random_paths(terrain, moves, rng), terrain)
    weights = np.array([[1024, 1], [1, 1024]])
    ends = cheapest_paths(terrain, moves, weights, np.zeros((2, 3), dtype=np.int64), len(terrain.legal))
    check(ends, terrain)
    # A point on the cheapest path does not lead away from it.
    points = np.array([rng.choice(path) for path in split(ends)])
    through = paths_through(
        terrain, moves, points, np.array([[0, 0], [1, 1]]), weights, np.zeros((2, 3), dtype=np.int64), len(terrain.legal)
    )
    check(through, terrain)
    assert all(point in path for point, path in zip(points, split(through), strict=True))
    least = int(plain_terrain(moves, terrain.start, terrain.goal).bounds[terrain.start, 0])
    short = cheapest_paths(terrain, moves, weights, np.zeros((2, 3), dtype=np.int64), 1)
    check(short, terrain)
    assert least > 0 and len(set(map(tuple, split(short)))) == 1, "what does not fit becomes a shortest path"


@pytest.mark.parametrize("largest", [1, 2**4, 2**8, 2**14])
@settings(max_examples=15, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(queries(density=0.25), names)
def test_paths_fit_and_end_however_coarse_the_costs(monkeypatch, largest, query, name):
    """As they are where the best paths of some terms are many thousand times as long as those of others."""
    moves, rng = moves_of(query, name), query[-1]
    start, goal = (moves.index(cell) for cell in query[1:3])
    shortest = mend(joined([[]]), moves, start, goal)
    with monkeypatch.context() as patched:
        patched.setattr(terrains, "LARGEST_COST", largest)
        terrain = make_terrain(moves, start, goal, [rng.random(moves.n_cells) ** 9, rng.random(moves.n_cells) ** 9])
    assert terrain.straight >= 1 and terrain.diagonal >= 1
    most, weights, noise = int(shortest.lengths[0]), rng.integers(1, 1025, (5, 3)), np.zeros((5, 3), dtype=np.int64)
    points = rng.choice(np.flatnonzero(terrain.useful), 5)
    trees = np.stack([np.arange(5), np.arange(5)], axis=1)
    for paths in (
        cheapest_paths(terrain, moves, weights, noise, most),
        paths_through(terrain, moves, points, trees, weights, noise, most),
    ):
        check(paths, terrain)
        assert paths.lengths.max() <= most
