"""Grids of occupancies in percent, and of larger cells."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pymoo_gridpath import OccupancyGrid
from pymoo_gridpath.errors import GridError

VALUES = np.array([[0, 25, 26, 64, 65, 100, -1]], dtype=np.int8)


@pytest.mark.parametrize(("unknown", "occupied"), [("occupied", [0, 0, 1, 1, 1, 1, 1]), ("free", [0, 0, 0, 0, 1, 1, 0])])
def test_percents_are_free_occupied_or_unknown(unknown, occupied):
    grid = OccupancyGrid.from_occupancy(VALUES, unknown=unknown)
    assert grid.unknown is not None
    assert grid.occupied.astype(int).tolist() == [occupied] and grid.unknown.astype(int).tolist() == [[0, 0, 1, 1, 0, 0, 1]]
    other = OccupancyGrid.from_occupancy(VALUES, occupied_from=50, free_up_to=49.5, unknown="free")
    assert other.occupied.astype(int).tolist() == [[0, 0, 0, 1, 1, 1, 0]]


def test_flat_data_are_rows_from_the_bottom_up():
    data = [0, 100, 0, 0, 0, 0]
    grid = OccupancyGrid.from_occupancy(data, width=3, resolution=np.float32(0.05), origin=(1, 2, 0.5), name="hall", moves=4)
    assert grid.shape == (2, 3) and not grid.is_free((1, 0)) and grid.is_free((1, 1))
    assert (grid.resolution, grid.origin, grid.name, grid.moves) == (0.05, (1.0, 2.0, 0.5), "hall", 4)


@pytest.mark.parametrize("resolution", [0.05, 0.025, 0.1, 1.0, 0.30000001192092896, 1 / 3])
def test_a_resolution_of_single_precision_is_the_decimal_that_it_was(resolution):
    short = float(str(np.float32(resolution)))
    assert OccupancyGrid.from_occupancy([[0]], resolution=float(np.float32(resolution))).resolution == short
    # In double precision it is what it is, unless single precision holds it.
    given = OccupancyGrid.from_occupancy([[0]], resolution=resolution).resolution
    assert given == (short if float(np.float32(resolution)) == resolution else resolution)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"occupancy": np.array([[0, 254]], dtype=np.uint8)}, r"of cell \(1, 0\) is 254, expected -1 \(unknown\) or 0 to 100"),
        ({"occupancy": [[0, -2]]}, r"of cell \(1, 0\) is -2"),
        ({"occupancy": [[True, False]]}, "occupancy is .*expected whole numbers from -1"),
        ({"occupancy": [[0.5]]}, "occupancy is .*expected whole numbers from -1"),
        ({"occupancy": [0, 1, 2]}, "the shape .*, or flat with a width"),
        ({"occupancy": [0, 1, 2], "width": 2}, "occupancy has 3 values, expected a flat array of rows of 2 values"),
        ({"occupancy": [[0, 1]], "width": 2}, r"occupancy has the shape \(1, 2\), expected a flat array of rows of 2"),
        ({"occupancy": [[0]], "free_up_to": 65}, "free_up_to is 65 and occupied_from 65, expected the first below"),
        ({"occupancy": [[0]], "occupied_from": 101}, "occupied_from is 101, expected a number of percent"),
        ({"occupancy": [[0]], "unknown": "maybe"}, "unknown is 'maybe', expected one of occupied, free"),
        ({"occupancy": [[0]], "resolution": 0}, "resolution is 0.*expected a positive number"),
    ],
)
def test_other_values_are_refused(arguments, said):
    with pytest.raises(GridError, match=said):
        OccupancyGrid.from_occupancy(**arguments)


@given(st.integers(1, 11), st.integers(1, 11), st.integers(1, 11), st.integers(0, 2**32 - 1))
def test_larger_cells_are_occupied_where_any_is(height, width, factor, seed):
    rng = np.random.default_rng(seed)
    occupied, unknown = rng.random((2, height, width)) < 0.2
    grid = OccupancyGrid(occupied, 0.05, (1.0, 2.0, 0.3), "one side", unknown=unknown, moves=4)
    if factor > max(height, width):
        with pytest.raises(GridError, match=f"factor is {factor}, expected a whole number of cells from 1 to"):
            grid.downsample(factor)
        return
    found = grid.downsample(factor)
    assert found.shape == (-(-height // factor), -(-width // factor)) and found.unknown is not None
    for (y, x), is_occupied in np.ndenumerate(found.occupied):
        part = slice(y * factor, (y + 1) * factor), slice(x * factor, (x + 1) * factor)
        whole = occupied[part].size == factor**2
        assert is_occupied == (not whole or occupied[part].any())
        assert found.unknown[y, x] == unknown[part].any()
    assert found.resolution == factor * 0.05 and (found.origin, found.corner_cutting, found.moves) == (
        grid.origin,
        "one side",
        4,
    )
    if factor == 1:
        assert found == grid
