"""The coding of Sugihara and Smith, letter by letter, and against all paths of a small grid."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.paths import Sequences
from pymoo_gridpath.representations import make_representation
from pymoo_gridpath.testing.enumeration import enumerate_paths

LETTERS = {"11": "A", "00": "B", "10": "CD", "01": "CE"}


def coding_of(width, height):
    grid = OccupancyGrid(np.zeros((height, width)), corner_cutting=True)
    return make_representation("sugihara-smith", grid, (0, 0), (width - 1, height - 1))


def walked(bits, size):
    """Return the cells that bits say by the letters of section 2.1, or None if they leave the grid."""
    n_bits = (size - 1).bit_length()
    moves = [("CD", int(bits[:n_bits], 2))]
    genes = bits[n_bits:]
    while genes:
        moves.append((LETTERS[genes[:2]], int(genes[2 : 2 + n_bits] or "0", 2)))
        genes = genes[2 + n_bits :]
    cells, y = [(0, 0)], 0
    for x, (letters, climb) in enumerate(moves):
        if x:
            y += {"A": 1, "B": -1}.get(letters, 0)
            cells.append((x, y))
        end = y if letters in "AB" else y + climb * (1 if letters == "CD" else -1)
        if x == size - 1:
            end = size - 1
        step = 1 if end > y else -1
        cells += [(x, row) for row in range(y + step, end + step, step) if end != y]
        y = end
    return cells if all(0 <= row < size for _, row in cells) else None


@given(st.integers(3, 9), st.integers(0, 2**32 - 1))
def test_rows_decode_by_their_letters(size, seed):
    coding = coding_of(size, size)
    X = np.random.default_rng(seed).integers(0, 2, (30, coding.n_var)).astype(bool)
    # Long climbs leave the grid.
    X[::2, :] &= np.random.default_rng(seed + 1).random((15, coding.n_var)) < 0.5
    said = [walked("".join(map(str, row.astype(int))), size) for row in X]
    paths = coding.decode(X)
    for i, cells in enumerate(said):
        if cells is not None:
            assert [tuple(cell) for cell in paths.cells(i).tolist()] == cells


def test_codes_are_all_paths_that_nowhere_climb_after_a_diagonal_step():
    coding = coding_of(3, 3)
    rows = np.array(list(itertools.product([False, True], repeat=coding.n_var)))
    paths = coding.decode(rows)
    decoded = {tuple(map(tuple, paths.cells(i).tolist())) for i in range(len(rows))}
    expected, others = set(), []
    for path in enumerate_paths(coding.grid, (0, 0), (2, 2), headings=[0, 1, 2, 6, 7]):
        steps = [(b[0] - a[0], b[1] - a[1], b[0]) for a, b in itertools.pairwise(path.cells)]
        climbs_on = any(abs(a[0] * a[1]) and not b[0] and b[2] < 2 for a, b in itertools.pairwise(steps))
        if climbs_on:
            others.append(path.cells)
        else:
            expected.add(path.cells)
    assert decoded == expected and others
    for cells in others:
        sequences = Sequences(np.array([coding.moves.index(cell) for cell in cells]), np.array([0, len(cells)]))
        if coding.fits(sequences)[0]:
            # There and back: the horizontal step leads to the same row.
            assert coding.decode(coding.from_sequences(sequences)).length[0] < len(cells) - 1
        else:
            with pytest.raises(GridPathError, match="path 0 climbs on after a diagonal step, which the sugihara-smith"):
                coding.from_sequences(sequences)


def test_a_problem_has_no_front_of_what_is_not_all_paths():
    problem = GridPathProblem(coding_of(4, 4).grid, (0, 0), (3, 3), "sugihara-smith")
    assert problem.pareto_front() is None and problem.pareto_set() is None
