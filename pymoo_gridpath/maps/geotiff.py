"""GeoTIFF: rasters that know where they lie, of which cells they have no data, and what their numbers are.

They are read by rasterio, the extra ``geo``: it brings GDAL, which wrote nearly all such files and knows their masks, scales
and compressions. Lighter readers know some of these, and take what they do not know for numbers.
"""

from __future__ import annotations

import importlib
import math
import os
import warnings
from typing import Any, NamedTuple

import numpy as np

from pymoo_gridpath.errors import GridError, MapError
from pymoo_gridpath.grid import CornerCutting, OccupancyGrid
from pymoo_gridpath.grid.occupancy_values import UNKNOWN, cells_of_occupancy
from pymoo_gridpath.maps._declared import BITS, PLACE, SAMPLE_FORMAT, tags_of_tiff
from pymoo_gridpath.maps._files import check_size, check_unknown, make_grid, require_file, shorten
from pymoo_gridpath.maps.formats import MAP_FORMATS, MapFormat
from pymoo_gridpath.maps.image import read_image

# By which share of a pixel's side the two sides, and what they are to a right angle, may be off.
_SQUARE = 1e-6

_MOST_PERCENT = 100


class Raster(NamedTuple):
    """The numbers of a GeoTIFF and where they lie.

    Attributes
    ----------
    values : numpy.ndarray, shape (height, width)
        Row 0 at the bottom, of the type that the file has, or floats where it has a scale.
    missing : numpy.ndarray of bool, of the same shape
        Where there is no data.
    resolution : float or None
        Side of a pixel in metres; None if the file does not say where it lies.
    origin : (float, float, float)
        Pose of the bottom-left corner.
    """

    values: np.ndarray
    missing: np.ndarray
    resolution: float | None
    origin: tuple[float, float, float]


def is_placed(path: str | os.PathLike[str]) -> bool:
    """Return whether a file is a TIFF that says where it lies."""
    return not tags_of_tiff(path).keys().isdisjoint(PLACE)


def is_measured(path: str | os.PathLike[str]) -> bool:
    """Return whether a file is a TIFF that says where it lies, or holds other numbers than greys of 8 or 16 bits."""
    tags = tags_of_tiff(path)
    drawn = set(tags.get(SAMPLE_FORMAT, (1,))) == {1} and max(tags.get(BITS, (1,))) <= 16
    return bool(tags) and (not drawn or is_placed(path))


def read_geotiff(
    path: str | os.PathLike[str],
    unknown: str = "occupied",
    corner_cutting: CornerCutting = False,
    threshold: float = 0.5,
) -> OccupancyGrid:
    """Read a map from a GeoTIFF, with its resolution and origin, one cell per pixel.

    What its numbers are follows from their type and range. Signed and real numbers are occupancies as ROS has them, -1 unknown
    and 0 to 100 percent, of which 65 and more are occupied, 25 and less free, and the others unknown. So are unsigned ones up
    to 100; where there are but 0 and 1, 1 is occupied. Larger ones are a drawing, dark occupied and light free, see
    `read_image`.

    Parameters
    ----------
    path : str or path-like
        A GeoTIFF of one band in a projection in metres, or without one.
    unknown : {"occupied", "free"}, default "occupied"
        What cells are that are unknown, have no data by the file's mark or mask, or hold what is no number.
    corner_cutting : bool or "one side", default False
        Whether a diagonal step may touch an occupied cell.
    threshold : float, default 0.5
        Of a drawing, see `read_image`.

    Returns
    -------
    OccupancyGrid
        In the frame of the projection; its origin is the corner of the bottom-left cell, and may have a yaw.

    Raises
    ------
    MapError
        If the file cannot be read as such, its pixels are not square or in degrees, its numbers are none of these, or an option
        is out of its range; or if rasterio is not installed, the extra ``geo``.
    """
    check_unknown(path, unknown)
    raster = load_geotiff(path)
    place: dict[str, Any] = {} if raster.resolution is None else {"resolution": raster.resolution, "origin": raster.origin}
    values, known = raster.values, raster.values[~raster.missing]
    if values.dtype.kind == "u" and known.max(initial=0) > _MOST_PERCENT:
        return read_image(path, threshold, unknown, corner_cutting, **place)
    if (known != np.rint(known)).any():
        wrong = known[known != np.rint(known)][0]
        raise MapError(path, f"a cell holds {wrong:g}, expected occupancies: -1, and whole numbers from 0 to {_MOST_PERCENT}")
    percent = np.where(raster.missing, float(UNKNOWN), values).astype(np.int64)
    of_matrix = values.dtype.kind == "u" and known.max(initial=0) <= 1
    try:
        occupied, unseen = cells_of_occupancy(percent, None, *((1, 0) if of_matrix else (65, 25)), unknown)
    except GridError as error:
        raise MapError(path, str(error)) from None
    return make_grid(path, occupied, corner_cutting=corner_cutting, unknown=unseen, **place)


@MAP_FORMATS.register
class GeoTiffFormat(MapFormat):
    """Rasters that know where they lie, see `read_geotiff`."""

    name, suffixes = "geotiff", (".tif", ".tiff")
    read = staticmethod(read_geotiff)  # pyright: ignore[reportAssignmentType]

    def matches(self, head, path):
        return is_placed(path)


def load_geotiff(path: str | os.PathLike[str]) -> Raster:
    """Return the numbers of a GeoTIFF of one band, or raise as `read_geotiff` does."""
    file = require_file(path).resolve()
    rasterio = _rasterio(path)
    try:
        with warnings.catch_warnings():
            # Not every TIFF says where it lies.
            warnings.simplefilter("ignore")
            with rasterio.open(file, driver="GTiff") as source:
                check_size(path, source.width, source.height)
                if source.count != 1:
                    raise MapError(path, f"the file has {source.count} bands, expected one number a cell")
                band = source.read(1, masked=True)
                scale, offset = source.scales[0], source.offsets[0]
                transform, crs = source.transform, source.crs
    except (MapError, MemoryError):
        raise
    except Exception as error:
        raise MapError(path, f"the file cannot be read as a GeoTIFF ({shorten(str(error))}), expected a whole one") from None
    values, missing = np.ma.getdata(band), np.ma.getmaskarray(band)
    if values.dtype.kind not in "iuf":
        raise MapError(path, f"the pixels are of the type {values.dtype}, expected whole or real numbers")
    # What is no number is not masked where no mark is declared.
    missing = missing | ~np.isfinite(values)
    if (scale, offset) != (1.0, 0.0):
        values = values * scale + offset
    if transform.is_identity:
        return Raster(values[::-1], missing[::-1], None, (0.0, 0.0, 0.0))
    _check_metres(path, crs)
    return _placed(path, values, missing, transform)


def _placed(path, values: np.ndarray, missing: np.ndarray, transform) -> Raster:
    """Return a raster that lies where a transform from (column, row) to metres says."""
    right, down = np.array([transform.a, transform.d]), np.array([transform.b, transform.e])
    resolution = float(np.hypot(*right))
    off = max(abs(np.hypot(*down) - resolution), abs(right @ down) / max(resolution, 1e-300))
    if not off <= _SQUARE * resolution:
        raise MapError(path, f"the pixels are {resolution:g} by {np.hypot(*down):g}, or slanted, expected squares")
    turned = right[0] * down[1] - right[1] * down[0] < 0
    # Rows mostly run down from the top; then the corner of the bottom row is that of the grid.
    corner = np.array([transform.c, transform.f])
    if turned:
        corner += values.shape[0] * down
        values, missing = values[::-1], missing[::-1]
    yaw = math.atan2(right[1], right[0])
    return Raster(values, missing, resolution, (float(corner[0]), float(corner[1]), yaw))


def _check_metres(path, crs) -> None:
    """Refuse a system of coordinates that is not in metres; none at all is taken for one that is."""
    if not crs:
        return
    if crs.is_geographic:
        raise MapError(path, "the pixels are in degrees of longitude and latitude, expected a projection in metres")
    if not crs.is_projected:
        raise MapError(path, "the coordinates are those of no projection, expected a projection in metres")
    unit, factor = crs.linear_units_factor
    if factor != 1.0:
        raise MapError(path, f"the pixels are in {shorten(unit)} of {factor:g} m, expected a projection in metres")


def _rasterio(path) -> Any:
    try:
        return importlib.import_module("rasterio")
    except ImportError:
        raise MapError(
            path, "GeoTIFFs are read by rasterio, which is not installed, expected it; pip install 'pymoo_gridpath[geo]'"
        ) from None
