"""Numbers for cells, out of arrays, grey images and the terrain of MovingAI's maps."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from pymoo_gridpath.errors import GridPathError, MapError
from pymoo_gridpath.maps import read_movingai, read_raster, read_terrain

VALUES = np.arange(12, dtype=np.uint8).reshape(3, 4) * 20


def test_arrays_have_row_0_at_the_bottom(tmp_path):
    for given in (VALUES, VALUES * 1.5, VALUES > 40, np.asfortranarray(VALUES), VALUES.astype("int8"), VALUES.astype(">f4")):
        np.save(tmp_path / "a.npy", given)
        found = read_raster(tmp_path / "a.npy")
        assert found.dtype == float
        np.testing.assert_array_equal(found, given)


def test_what_is_no_number_in_an_array_stays_so(tmp_path):
    np.save(tmp_path / "a.npy", [[1.0, np.nan], [np.inf, 2.0]])
    np.testing.assert_array_equal(read_raster(tmp_path / "a.npy"), [[1.0, np.nan], [np.inf, 2.0]])


def test_grey_images_have_their_values_with_the_top_row_last(tmp_path):
    Image.fromarray(VALUES).save(tmp_path / "grey.png")
    np.testing.assert_array_equal(read_raster(tmp_path / "grey.png"), VALUES[::-1])
    wide = VALUES.astype(np.uint16) * 250
    Image.fromarray(wide).save(tmp_path / "wide.png")
    np.testing.assert_array_equal(read_raster(tmp_path / "wide.png"), wide[::-1])
    Image.fromarray(np.stack([VALUES] * 3, axis=2)).save(tmp_path / "three.png")
    np.testing.assert_array_equal(read_raster(tmp_path / "three.png"), VALUES[::-1])


def test_transparent_pixels_have_no_data(tmp_path):
    alpha = np.full(VALUES.shape, 255, dtype=np.uint8)
    alpha[0, 1] = 0
    Image.merge("LA", [Image.fromarray(VALUES), Image.fromarray(alpha)]).save(tmp_path / "a.png")
    expected = VALUES.astype(float)
    expected[0, 1] = np.nan
    np.testing.assert_array_equal(read_raster(tmp_path / "a.png"), expected[::-1])


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda file: Image.fromarray(np.eye(3, dtype=np.uint8)[..., None] * np.array([9, 0, 0], np.uint8)).save(
                file, "PNG"
            ),
            "coloured",
        ),
        (lambda file: file.write_text("1 2 3\n"), "no image can be recognised"),
        (lambda file: np.save(file.open("wb"), np.zeros((2, 2, 2))), "the array has 3 dimensions, expected 2"),
        (lambda file: np.save(file.open("wb"), np.array([["a"]])), "expected numbers"),
        (lambda file: None, "no such file, expected a file of one number a cell"),
        (lambda file: file.mkdir(), "found a directory"),
    ],
)
def test_what_is_no_raster_is_refused(tmp_path, make, message):
    file = tmp_path / "file"
    make(file)
    with pytest.raises(MapError, match=message):
        read_raster(file)


MAP = "type octile\nheight 3\nwidth 4\nmap\n.GsT\n@SWO\n..w.\n"


def test_terrain_weighs_what_its_letters_do(tmp_path):
    file = tmp_path / "a.map"
    file.write_text(MAP)
    plain = read_terrain(file, {})
    np.testing.assert_array_equal(np.isnan(plain), read_movingai(file).occupied)
    assert np.nanmax(plain) == np.nanmin(plain) == 1.0
    found = read_terrain(file, {"S": 3, "w": 8.5, "G": 0})
    expected = [[1.0, 1.0, 8.5, 1.0], [np.nan, 3.0, 8.5, np.nan], [1.0, 0.0, 3.0, np.nan]]
    np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize(
    ("weights", "message"),
    [
        ({"X": 1}, "a letter of terrain is 'X', expected one of"),
        ({"S": -1}, "the weight of 'S' is -1, expected a number, zero or more"),
        ({"S": "dear"}, "the weight of 'S' is 'dear'"),
        ({3: 1}, "a letter of terrain is 3"),
        ([("S", 1)], "weights is"),
    ],
)
def test_weights_that_are_none_are_refused(tmp_path, weights, message):
    (tmp_path / "a.map").write_text(MAP)
    with pytest.raises(GridPathError, match=message):
        read_terrain(tmp_path / "a.map", weights)


def test_a_bad_map_is_refused_as_by_its_reader(tmp_path):
    (tmp_path / "a.map").write_text(MAP.replace("T", "X"))
    for read in (lambda file: read_terrain(file, {"S": 2}), read_movingai):
        with pytest.raises(MapError, match=r"a.map, line 5: found the letter 'X'"):
            read(tmp_path / "a.map")
