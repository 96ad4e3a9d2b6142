"""The two paths of the paper's Fig. 2 in every coding, cell by cell."""

import numpy as np
import pytest

from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.representations import make_representation

# Rows, from the bottom, that each column is entered and left at; read off Fig. 2 by hand from the paper's words.
PATHS = {
    1: [(0, 0), (1, 3), (4, 4), (4, 4), (3, 2), (1, 1), (1, 1), (2, 7)],
    2: [(0, 5), (6, 6), (6, 6), (7, 7), (6, 5), (4, 4), (5, 6), (7, 7)],
}
INTEGER = {1: [0, 3, 1, 0, -2, -1, 0], 2: [5, 1, 0, 1, -2, -1, 2]}
BINARY = {
    1: "000 11-010 11-000 10-000 00-001 00-000 10-000 11",
    2: "101 11-000 01-000 11-000 00-001 00-000 11-001 11",
}
MIXED = {
    1: ([1, 1, 0, 0, 0, 1, 1], [0, 3, 1, 0, 2, 1, 0]),
    2: ([1, 1, 1, 0, 0, 1, 1], [5, 1, 0, 1, 2, 1, 2]),
}


def genes(name, path):
    if name == "integer":
        return np.array([INTEGER[path]])
    if name == "binary":
        return np.array([[c == "1" for c in BINARY[path] if c in "01"]])
    if name == "mixed":
        return np.array([MIXED[path][0] + MIXED[path][1]])
    return np.array([[leave for _, leave in PATHS[path][:-1]]])


def expected_cells(path):
    cells = []
    for x, (enter, leave) in enumerate(PATHS[path]):
        step = 1 if leave >= enter else -1
        cells += [[x, y] for y in range(enter, leave + step, step)]
    return cells


@pytest.fixture
def grid():
    return OccupancyGrid(np.zeros((8, 8)), corner_cutting=True)


@pytest.mark.parametrize("path", [1, 2])
@pytest.mark.parametrize("name", ["integer", "binary", "mixed", "absolute"])
def test_decodes_to_the_cells_of_the_figure(grid, name, path):
    coding = make_representation(name, grid, (0, 0), (7, 7))
    X = genes(name, path)
    assert X.shape == (1, coding.n_var)
    assert coding.decode(X).cells(0).tolist() == expected_cells(path)


@pytest.mark.parametrize("path", [1, 2])
@pytest.mark.parametrize("name", ["integer", "absolute"])
def test_encodes_back_to_the_same_genes(grid, name, path):
    coding = make_representation(name, grid, (0, 0), (7, 7))
    X = genes(name, path)
    assert np.array_equal(coding.encode(coding.decode(X)), X)


@pytest.mark.parametrize("path", [1, 2])
def test_binary_and_mixed_encode_up_to_their_redundant_bits(grid, path):
    binary = make_representation("binary", grid, (0, 0), (7, 7))
    paper = BINARY[path].replace("01-000", "10-000")  # a horizontal step without a climb has two codes
    assert "".join(map(str, binary.encode(binary.decode(genes("binary", path)))[0].astype(int))) == "".join(
        c for c in paper if c in "01"
    )
    mixed = make_representation("mixed", grid, (0, 0), (7, 7))
    bits, integers = MIXED[path]
    canonical = [1 if integers[k + 1 : k + 2] == [0] else bit for k, bit in enumerate(bits)]
    assert mixed.encode(mixed.decode(genes("mixed", path)))[0].tolist() == canonical + integers
