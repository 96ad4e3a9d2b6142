"""Rows of genes and the cells that their paths visit, there and back."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from queries import queries, random_genes

from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.neighbourhood import HEADINGS
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.representations import REPRESENTATIONS, CellSequence, make_representation
from pymoo_gridpath.testing.enumeration import legal_steps

NAMES = sorted(REPRESENTATIONS)


def coding_of(name, query):
    grid, start, goal, axis, _ = query
    return make_representation(name, grid, start, goal, "auto" if name == "cells" else axis)


def as_sequences(paths, width):
    """Join lists of cells (x, y)."""
    offsets = np.cumsum([0, *map(len, paths)])
    return Sequences(np.array([y * width + x for path in paths for x, y in path], dtype=np.int64), offsets)


@given(queries(), st.sampled_from(NAMES))
def test_sequences_are_the_cells_of_the_paths(query, name):
    grid, rng = query[0], query[-1]
    coding = coding_of(name, query)
    X = random_genes(coding, rng)
    paths = coding.decode(X)
    found = coding.to_sequences(X)
    expected = as_sequences([paths.cells(i).tolist() for i in range(len(X))], grid.width)
    assert found.cells.dtype == found.offsets.dtype == np.int64
    assert np.array_equal(found.cells, expected.cells) and np.array_equal(found.offsets, expected.offsets)
    none = coding.to_sequences(X[:0])
    assert none.cells.tolist() == [] and none.offsets.tolist() == [0]


@given(queries(), st.sampled_from(NAMES))
def test_genes_of_sequences_code_the_same_paths(query, name):
    rng = query[-1]
    coding = coding_of(name, query)
    sequences = coding.to_sequences(coding.repair(random_genes(coding, rng), rng))
    X = coding.from_sequences(sequences)
    assert X.dtype == np.dtype(coding.vtype) and not ((coding.xl > X) | (coding.xu < X)).any()
    again = coding.to_sequences(X)
    assert np.array_equal(again.cells, sequences.cells) and np.array_equal(again.offsets, sequences.offsets)
    assert coding.from_sequences(Sequences(sequences.cells[:0], sequences.offsets[:1])).shape == (0, coding.n_var)


def random_walk(coding, rng, n_steps=60):
    """A random legal walk along the moves of a coding, to the goal, or None if it ends elsewhere."""
    moves = coding.moves
    cell, goal = moves.index(coding.start), moves.index(coding.goal)
    walk = [cell]
    for _ in range(n_steps):
        headings = [m for m in range(8) if moves.legal[cell] >> m & 1]
        if cell == goal or not headings:
            break
        cell += moves.offsets[rng.choice(headings)]
        walk.append(cell)
    return walk if cell == goal else None


@given(queries(density=0.1), st.sampled_from([name for name in NAMES if REPRESENTATIONS[name].codes_all]))
def test_any_legal_walk_has_genes_of_a_legal_path_that_is_no_longer(query, name):
    grid, start, goal, _, rng = query
    # Room for every walk.
    coding = CellSequence(grid, start, goal, grid.occupied.size) if name == "cells" else coding_of(name, query)
    walks = [walk for walk in (random_walk(coding, rng) for _ in range(20)) if walk]
    sequences = Sequences(np.concatenate([np.zeros(0, dtype=np.int64), *walks]), np.cumsum([0, *map(len, walks)]))
    X = coding.from_sequences(sequences)
    paths = coding.decode(X)
    assert (paths.interfering_cells == 0).all()
    # One path has one row, whatever walk it came from, so that duplicates are found by their genes.
    assert np.array_equal(coding.from_sequences(coding.to_sequences(X)), X)
    for walk, length in zip(walks, paths.length, strict=True):
        steps = np.diff(coding.moves.cells(np.array(walk)), axis=0)
        assert length <= np.hypot(*steps.T).sum() + 1e-9


@given(queries(), st.sampled_from(NAMES))
def test_moves_are_the_legal_steps_that_can_be_coded(query, name):
    grid, start, goal, _, _ = query
    coding = coding_of(name, query)
    along = 0 if name == "cells" or coding.frame.axis == "x" else 1
    forward = 0 if name == "cells" else np.sign(goal[along] - start[along])
    for cell in range(coding.moves.n_cells):
        x, y = cell % grid.width, cell // grid.width
        for m, (dx, dy) in enumerate(HEADINGS.tolist()):
            legal = grid.is_free((x, y)) and m in dict(legal_steps(grid, (x, y))) and (dx, dy)[along] * forward >= 0
            assert bool(coding.moves.legal[cell] >> m & 1) == legal


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ([(0, 0), (1, 0), (2, 0)], "leads between other cells than start"),
        ([(1, 0), (2, 1)], "leads between other cells than start"),
        ([], "leads between other cells than start"),
        ([(0, 0), (2, 1)], "jumps or goes back along the axis 'x'"),
        ([(0, 0), (0, 2), (1, 2), (2, 1)], "jumps or goes back along the axis 'x'"),
        ([(0, 0), (1, 0), (0, 1), (1, 1), (2, 1)], "jumps or goes back along the axis 'x'"),
    ],
)
def test_sequences_without_a_monotone_code_are_refused(path, message):
    coding = make_representation("integer", OccupancyGrid(np.zeros((3, 3))), (0, 0), (2, 1))
    with pytest.raises(GridPathError, match=message):
        coding.from_sequences(as_sequences([[(0, 0), (1, 1), (2, 1)], path], 3))
