"""Paths given by their cells: measures by definition, and equal to those of paths given by columns."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from queries import queries, random_genes

from pymoo_gridpath.fields import obstacle_potential
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.paths import CellPaths, cell, counts
from pymoo_gridpath.representations import make_representation
from pymoo_gridpath.testing import reference


@st.composite
def rows_of_cells(draw):
    """A random grid and rows of random cells: walks with pauses, some with jumps, some all jumps."""
    height, width = draw(st.integers(1, 7)), draw(st.integers(1, 7))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    grid = OccupancyGrid(rng.random((height, width)) < 0.3, corner_cutting=draw(st.booleans()))
    n_paths, n = draw(st.integers(0, 6)), draw(st.integers(1, 12))
    steps = rng.integers(-1, 2, size=(n_paths, n, 2)) * rng.choice([0, 1, 4], size=(n_paths, n, 1), p=[0.2, 0.6, 0.2])
    cells = np.clip(np.cumsum(steps, axis=1), 0, [width - 1, height - 1])
    return grid, cells[..., 1] * width + cells[..., 0]


@given(rows_of_cells())
def test_measures_are_those_of_the_reference(case):
    grid, rows = case
    before = rows.copy()
    paths = CellPaths(grid, rows)
    field = obstacle_potential(grid)
    total = paths.total(field.ravel())
    assert len(paths) == len(rows) == len(paths.turn) == len(paths.length) == len(total) == len(paths.interfering_cells)
    for i, row in enumerate(rows):
        cells = reference.visited(row, grid.width)
        assert [tuple(cell) for cell in paths.cells(i).tolist()] == cells
        assert paths.length[i] == pytest.approx(reference.octile_length(cells), abs=1e-9)
        assert paths.turn[i] == reference.sign_turn(cells)
        assert paths.interfering_cells[i] == reference.broken_cells(cells, grid)
        assert total[i] == sum(field[y, x] for x, y in cells)
        if reference.is_connected(cells):
            assert paths.length[i] == pytest.approx(reference.length(cells), abs=1e-9)
            assert paths.turn[i] == reference.turn(cells)
            assert paths.interfering_cells[i] == reference.interfering_cells(cells, grid)
            assert paths.n_straight[i] + paths.n_diagonal[i] == len(cells) - 1
    assert paths.turn.dtype == paths.interfering_cells.dtype == np.int64
    assert np.array_equal(rows, before)


@given(rows_of_cells())
def test_only_legal_paths_have_no_interfering_cell(case):
    grid, rows = case
    for row, interfering in zip(rows, CellPaths(grid, rows).interfering_cells, strict=True):
        cells = reference.visited(row, grid.width)
        legal = all(grid.is_free(cell) for cell in cells) and reference.is_connected(cells)
        if legal and not grid.corner_cutting:
            legal = all(grid.is_free((b[0], a[1])) and grid.is_free((a[0], b[1])) for a, b in itertools.pairwise(cells))
        assert (interfering == 0) == legal


@given(queries(density=0.4), st.sampled_from(["integer", "binary", "mixed", "absolute"]))
def test_measures_equal_those_of_columns_to_the_bit(query, name):
    grid, start, goal, axis, rng = query
    coding = make_representation(name, grid, start, goal, axis)
    columns = coding.decode(random_genes(coding, rng))
    lists = np.split(columns.sequences.cells, columns.sequences.offsets[1:-1])
    longest = max(map(len, lists))
    cells = CellPaths(grid, np.stack([np.pad(cells, (0, longest - len(cells)), mode="edge") for cells in lists]))
    for measure in ("n_straight", "n_diagonal", "length", "turn", "interfering_cells"):
        assert np.array_equal(getattr(cells, measure), getattr(columns, measure)), measure
    field = obstacle_potential(grid)
    assert np.array_equal(cells.total(field.ravel()), columns.total(coding.prepare(field)))
    # Sums of these are never exact, but small ones must not be lost.
    field = 10.0 ** rng.integers(-20, 21, size=grid.shape)
    np.testing.assert_allclose(columns.total(coding.prepare(field)), cells.total(field.ravel()), rtol=1e-13)
    assert np.array_equal(cells.sequences.cells, columns.sequences.cells)
    assert np.array_equal(cells.sequences.offsets, columns.sequences.offsets)
    assert all(np.array_equal(cells.cells(i), columns.cells(i)) for i in range(len(columns)))


@given(rows_of_cells(), st.integers(0, 2**32 - 1))
def test_padding_pauses_and_company_change_nothing(case, seed):
    grid, rows = case
    rng = np.random.default_rng(seed)
    field = rng.random(grid.occupied.size)
    paths = CellPaths(grid, rows)
    paused = CellPaths(grid, np.repeat(rows, rng.integers(1, 4, size=rows.shape[1]), axis=1))
    mask = rng.random(len(rows)) < 0.5
    for measure in ("n_straight", "n_diagonal", "length", "turn", "interfering_cells"):
        assert np.array_equal(getattr(paths, measure), getattr(paused, measure))
        assert np.array_equal(getattr(paths, measure)[mask], getattr(paths[mask], measure))
    assert np.array_equal(paths.total(field), paused.total(field))
    assert np.array_equal(paths.total(field)[mask], paths[mask].total(field))


@given(rows_of_cells(), st.sampled_from([(8, True), (8, False), (8, "one side"), (4, False)]))
def test_path_by_path_and_all_at_once_are_the_same(case, steps):
    grid, rows = case
    moves, corner_cutting = steps
    grid = grid.replace(moves=moves, corner_cutting=corner_cutting)
    n, most = rows.shape[1], grid.occupied.size - 1
    # Some lie outside their bounds.
    low, high = np.full(n, most // 8), np.full(n, most - most // 8)
    with pytest.MonkeyPatch.context() as patched:
        found = []
        for compiled in (True, False):
            patched.setattr(cell, "COMPILED", compiled)
            patched.setattr(counts, "COMPILED", compiled)
            sequences = cell.visited(rows, low, high)
            found.append([*sequences, *counts.counts_of(sequences, grid)])
    for one, other in zip(*found, strict=True):
        assert np.array_equal(one, other) and one.dtype == other.dtype == np.int64


def test_a_jump_is_an_octile_way_that_leaves_its_cells_out():
    grid = OccupancyGrid(np.zeros((5, 7)))
    path = CellPaths(grid, np.array([[0, 5 + 2 * 7, 6 + 2 * 7]]))
    assert (path.n_straight.item(), path.n_diagonal.item()) == (4, 2)
    assert path.interfering_cells.tolist() == [4]
    assert path.turn.tolist() == [45]
    assert path.total(np.ones(35)).tolist() == [3]
    # The end of one row of the grid and the beginning of the next are no neighbours.
    assert CellPaths(grid, np.array([[6, 7]])).interfering_cells.tolist() == [5]
