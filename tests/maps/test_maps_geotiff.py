"""GeoTIFFs as maps, costs and heights: files that tifffile writes, which shares no code with what reads them."""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest
import tifffile
from PIL import Image

from pymoo_gridpath import OccupancyGrid, load_map
from pymoo_gridpath.errors import MapError
from pymoo_gridpath.maps import format_of, read_geotiff, read_image, read_raster

# The top row first, as in the file.
PERCENT = np.array([[0, 100, -1, 25], [65, 26, 64, 0], [0, 0, 0, 100]], dtype=np.int8)
OCCUPIED = np.array([[0, 1, 1, 0], [1, 1, 1, 0], [0, 0, 0, 1]], dtype=bool)
UNKNOWN = np.array([[0, 0, 1, 0], [0, 1, 1, 0], [0, 0, 0, 0]], dtype=bool)
UTM, DEGREES, FEET, GEOCENTRIC = 32632, 4326, 2277, 4978


def keys(code):
    """The geo keys of a system of coordinates."""
    kind, key = (2, 2048) if code == DEGREES else (1, 3072)
    return (34735, "H", 16, (1, 1, 0, 3, 1024, 0, 1, kind, 1025, 0, 1, 1, key, 0, 1, code))


def write(path, values, sides=(0.5, 0.5), corner=(1000.0, 2000.0), code=UTM, matrix=None, nodata=None, **options):
    """Write a raster whose top left corner lies there."""
    tags = [] if code is None else [keys(code)]
    if matrix is not None:
        tags.append((34264, "d", 16, tuple(np.ravel(matrix))))
    elif sides is not None:
        tags += [(33550, "d", 3, (*sides, 0.0)), (33922, "d", 6, (0.0, 0.0, 0.0, *corner, 0.0))]
    if nodata is not None:
        tags.append((42113, "s", 0, str(nodata)))
    tifffile.imwrite(path, values, extratags=[(*tag, False) for tag in tags], **options)
    return path


@pytest.fixture
def file(tmp_path):
    return tmp_path / "a.tif"


def test_occupancies_have_their_place_and_unknown_cells(file):
    grid = load_map(write(file, PERCENT))
    assert format_of(file).name == "geotiff"
    np.testing.assert_array_equal(grid.occupied, OCCUPIED[::-1])
    np.testing.assert_array_equal(grid.unknown, UNKNOWN[::-1])
    assert (grid.resolution, grid.origin, grid.name) == (0.5, (1000.0, 1998.5, 0.0), "a")
    free = load_map(file, unknown="free", corner_cutting=True)
    np.testing.assert_array_equal(free.occupied, (OCCUPIED & ~UNKNOWN)[::-1])
    assert free.corner_cutting is True


@pytest.mark.parametrize(
    "values",
    [
        PERCENT.astype(np.int16),
        PERCENT.astype(np.float32),
        np.where(PERCENT < 0, np.nan, PERCENT).astype(np.float64),
        np.where(PERCENT < 0, np.inf, PERCENT).astype(np.float32),
    ],
    ids=["int16", "float32", "nan", "inf"],
)
def test_the_type_of_the_numbers_does_not_matter(file, values):
    grid = load_map(write(file, values))
    np.testing.assert_array_equal(grid.occupied, OCCUPIED[::-1])
    np.testing.assert_array_equal(grid.unknown, UNKNOWN[::-1])


def test_the_mark_of_cells_without_data_is_read_from_the_file(file):
    for values, nodata in (
        (np.where(PERCENT < 0, -9999, PERCENT.astype(np.int16)), -9999),
        (np.where(PERCENT < 0, 255, PERCENT.astype(np.uint8)), 255),
        (np.where(PERCENT < 0, -3.4e38, PERCENT.astype(np.float32)), np.float32(-3.4e38)),
    ):
        np.testing.assert_array_equal(load_map(write(file, values, nodata=nodata)).unknown, UNKNOWN[::-1])


def test_a_matrix_of_0_and_1_says_which_are_occupied(file):
    np.testing.assert_array_equal(load_map(write(file, OCCUPIED.astype(np.uint8))).occupied, OCCUPIED[::-1])


def test_a_drawing_is_dark_where_occupied_and_has_its_place(file):
    grey = np.where(OCCUPIED, 0, 254).astype(np.uint8)
    grey[0, 0] = 120
    grid = load_map(write(file, grey))
    expected = OCCUPIED.copy()
    expected[0, 0] = True
    np.testing.assert_array_equal(grid.occupied, expected[::-1])
    assert grid.origin == (1000.0, 1998.5, 0.0)
    np.testing.assert_array_equal(load_map(file, threshold=0.4).occupied, OCCUPIED[::-1])
    np.testing.assert_array_equal(read_image(file).occupied, grid.occupied)


def test_a_tiff_without_a_place_is_a_drawing_as_ever(file):
    Image.fromarray(np.where(OCCUPIED, 0, 254).astype(np.uint8)).save(file)
    assert format_of(file).name == "image"
    np.testing.assert_array_equal(load_map(file).occupied, OCCUPIED[::-1])


def test_a_turned_raster_has_a_yaw(file):
    angle, side = 0.3, 0.25
    cos, sin = side * math.cos(angle), side * math.sin(angle)
    # Columns along the angle, rows down at a right angle to it.
    matrix = [[cos, sin, 0, 50.0], [sin, -cos, 0, 80.0], [0, 0, 0, 0], [0, 0, 0, 1]]
    grid = load_map(write(file, PERCENT, matrix=matrix))
    assert grid.resolution == pytest.approx(side) and grid.origin[2] == pytest.approx(angle)
    # The centre of the top left pixel, by the file's own words.
    top_left = np.array([50.0, 80.0]) + 0.5 * np.array([cos, sin]) + 0.5 * np.array([sin, -cos])
    np.testing.assert_allclose(grid.to_metres((0, 2)), top_left, atol=1e-9)
    np.testing.assert_array_equal(grid.occupied, OCCUPIED[::-1])


def test_rows_that_run_up_are_not_turned_over(file):
    matrix = [[0.5, 0, 0, 7.0], [0, 0.5, 0, 9.0], [0, 0, 0, 0], [0, 0, 0, 1]]
    grid = load_map(write(file, PERCENT, matrix=matrix))
    np.testing.assert_array_equal(grid.occupied, OCCUPIED)
    assert grid.origin == (7.0, 9.0, 0.0)


@pytest.mark.parametrize(
    ("values", "options", "message"),
    [
        (PERCENT, {"code": DEGREES}, "the pixels are in degrees of longitude and latitude, expected a projection in metres"),
        (PERCENT, {"code": GEOCENTRIC}, "the coordinates are those of no projection, expected a projection in metres"),
        (PERCENT, {"code": FEET}, r"the pixels are in .* of 0.3048.* m, expected a projection in metres"),
        (PERCENT, {"sides": (0.5, 0.6)}, "the pixels are 0.5 by 0.6, or slanted, expected squares"),
        (PERCENT.astype(np.int16) * 3, {}, r"occupancy of cell \(3, 0\) is 300, expected -1 \(unknown\) or 0 to 100 percent"),
        (PERCENT + 0.5, {}, r"a cell holds 0.5, expected occupancies"),
        (np.zeros((3, 4), dtype=np.complex64), {}, "of the type complex64, expected whole or real numbers"),
        (np.zeros((3, 4, 3), dtype=np.uint8), {"photometric": "rgb"}, "the file has 3 bands, expected one number a cell"),
    ],
    ids=["degrees", "geocentric", "feet", "oblong", "heights", "halves", "complex", "colours"],
)
def test_what_is_no_map_is_refused(file, values, options, message):
    with pytest.raises(MapError, match=message) as error:
        load_map(write(file, values, **options))
    assert "\n" not in str(error.value) and "a.tif" in str(error.value)


def test_damaged_files_and_wrong_options_are_refused(file):
    write(file, PERCENT)
    with pytest.raises(MapError, match="the option unknown is 'maybe'"):
        read_geotiff(file, unknown="maybe")
    with pytest.raises(MapError, match="does not take the option 'resolution'"):
        load_map(file, resolution=0.1)
    whole = file.read_bytes()
    for length in (8, 60, len(whole) - 5):
        file.write_bytes(whole[:length])
        with pytest.raises(MapError, match="cannot be read as a GeoTIFF"):
            read_geotiff(file)
    with pytest.raises(MapError, match="no such file"):
        read_geotiff(file.with_name("nowhere.tif"))


def test_without_rasterio_the_extra_is_named(file, monkeypatch):
    write(file, PERCENT)
    monkeypatch.setitem(sys.modules, "rasterio", None)
    for read in (load_map, read_raster):
        with pytest.raises(
            MapError, match=r"rasterio, which is not installed, expected it; pip install 'pymoo_gridpath\[geo\]'"
        ):
            read(file)


# -- costs and heights ----------------------------------------------------------------------------------------------------


HEIGHTS = np.array([[312.25, 313.5, -9999.0], [310.0, 311.0, 400.0]])


def test_heights_have_no_number_where_there_is_no_data(file):
    expected = np.where(HEIGHTS < 0, np.nan, HEIGHTS)[::-1]
    np.testing.assert_array_equal(read_raster(write(file, HEIGHTS.astype(np.float32), nodata=-9999)), expected)
    np.testing.assert_array_equal(read_raster(write(file, np.where(HEIGHTS < 0, np.nan, HEIGHTS))), expected)
    # Costs may be in degrees, or nowhere: they lie where the map does.
    np.testing.assert_array_equal(read_raster(write(file, HEIGHTS, code=None, sides=None, nodata=-9999)), expected)


def test_greys_with_a_place_keep_their_values(file):
    grey = np.array([[0, 255, 7], [1, 2, 3]], dtype=np.uint8)
    expected = grey.astype(float)
    expected[0, 1] = np.nan
    np.testing.assert_array_equal(read_raster(write(file, grey, nodata=255, compression="zlib")), expected[::-1])
    np.testing.assert_array_equal(read_raster(write(file, grey.astype(np.int16) - 5)), grey[::-1] - 5.0)


def test_scales_and_masks_of_gdal_are_heeded(file):
    rasterio = pytest.importorskip("rasterio")
    stored = np.arange(6, dtype=np.uint8).reshape(2, 3)
    with (
        rasterio.Env(GDAL_TIFF_INTERNAL_MASK=True),
        rasterio.open(
            file,
            "w",
            driver="GTiff",
            width=3,
            height=2,
            count=1,
            dtype="uint8",
            compress="lzw",
            crs=f"EPSG:{UTM}",
            transform=rasterio.Affine(2.0, 0.0, 0.0, 0.0, -2.0, 10.0),
        ) as made,
    ):
        made.write(stored, 1)
        made.write_mask(np.where(stored == 4, 0, 255).astype(np.uint8))
        made.scales, made.offsets = (0.5,), (100.0,)
    expected = 100.0 + 0.5 * stored
    expected[1, 1] = np.nan
    np.testing.assert_array_equal(read_raster(file), expected[::-1])


def test_a_map_and_its_heights_go_together(file, tmp_path):
    grid = load_map(write(file, np.zeros((2, 3), dtype=np.int8)))
    heights = read_raster(write(tmp_path / "b.tif", HEIGHTS, nodata=-9999))
    walkable = grid.replace(occupied=grid.occupied | np.isnan(heights))
    assert isinstance(walkable, OccupancyGrid) and walkable.occupied.tolist() == [[False] * 3, [False, False, True]]
