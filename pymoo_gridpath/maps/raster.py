"""Rasters: a number for each cell, such as a cost or a height."""

from __future__ import annotations

import os

import numpy as np

from pymoo_gridpath.errors import MapError
from pymoo_gridpath.maps._files import require_file
from pymoo_gridpath.maps.array import MAGIC, read_numbers
from pymoo_gridpath.maps.geotiff import is_measured, load_geotiff
from pymoo_gridpath.maps.image import read_pixels


def read_raster(path: str | os.PathLike[str]) -> np.ndarray:
    """Read a number for each cell of a map.

    Parameters
    ----------
    path : str or path-like
        An array that `numpy.save` wrote, of any type of number, row 0 at the bottom; or a grey image, whose top row is the
        highest one, with its values as they are: 0 for black, 255, or 65535 of 16 bits, for white; or a TIFF of one band that
        says where it lies or holds other numbers, real ones among them, see `read_geotiff`. Where it lies is not looked at.

    Returns
    -------
    numpy.ndarray of float, shape (height, width)
        Row 0 at the bottom; NaN where there is no data: where an image is transparent, or has the value that its file calls
        nodata.

    Raises
    ------
    MapError
        If the file cannot be read, is none of these, or the image is coloured; of a GeoTIFF also if rasterio is not installed,
        the extra ``geo``.
    """
    try:
        with open(require_file(path, "a file of one number a cell"), "rb") as file:
            head = file.read(len(MAGIC))
    except OSError as error:
        raise MapError(path, f"the file cannot be read ({error.strerror}), expected an array or an image") from None
    if head == MAGIC:
        return read_numbers(path)
    if is_measured(path):
        found = load_geotiff(path)
        return np.where(found.missing, np.nan, found.values.astype(float))
    pixels = read_pixels(path)
    values = pixels.channels
    if values.ndim == 3:
        if (values != values[..., :1]).any():
            raise MapError(path, "the image is coloured, expected one grey value a cell")
        values = values[..., 0]
    values = values.astype(float)
    if pixels.alpha is not None:
        values[pixels.alpha == 0] = np.nan
    return values[::-1]
