"""Maps saved by `numpy.save`."""

from __future__ import annotations

import io
import os
from collections.abc import Sequence
from typing import BinaryIO, Literal

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import MapError
from pymoo_gridpath.files import write_whole
from pymoo_gridpath.grid import CornerCutting, OccupancyGrid
from pymoo_gridpath.maps._files import BLOCK, check_size, make_grid, require_file
from pymoo_gridpath.maps.formats import MAP_FORMATS, MapFormat

MAGIC = b"\x93NUMPY"
_DAMAGED = "the array cannot be read, expected a whole .npy file written by numpy.save"


def read_npy(
    path: str | os.PathLike[str],
    corner_cutting: CornerCutting = False,
    resolution: float | None = None,
    origin: Sequence[float] = (0.0, 0.0, 0.0),
) -> OccupancyGrid:
    """Read a map from a ``.npy`` file.

    Parameters
    ----------
    path : str or path-like
        The file: an array of shape (height, width) of booleans, or of 0 (free) and 1 (occupied). Row 0 is the *bottom* row, as
        in `OccupancyGrid`, not the top one as in an image. Pickled objects are never loaded.
    corner_cutting : bool or "one side", default False
        Whether a diagonal step may touch an occupied cell.
    resolution : float, optional
        Side of a cell in metres; without it the map is one in cells.
    origin : (float, float) or (float, float, float), default (0, 0, 0)
        Pose of the grid in metres and radians, beside a resolution only.

    Returns
    -------
    OccupancyGrid

    Raises
    ------
    MapError
        If the file cannot be read or holds anything else than such an array.
    """
    require_file(path)
    try:
        occupied = _load(path)
    except (MapError, MemoryError):
        raise
    except Exception:
        # A damaged header is parsed as Python text and can fail in almost any way.
        raise MapError(path, _DAMAGED) from None
    return make_grid(path, occupied, corner_cutting=corner_cutting, resolution=resolution, origin=origin)


@MAP_FORMATS.register
class NumpyFormat(MapFormat):
    """Arrays saved by `numpy.save`, see `read_npy`."""

    name, suffixes = "numpy", (".npy",)
    read = staticmethod(read_npy)  # pyright: ignore[reportAssignmentType]

    def matches(self, head, path):
        return head.startswith(MAGIC)

    def write(self, path, grid):
        data = io.BytesIO()
        np.save(data, grid.occupied)
        write_whole(path, data.getvalue())


def read_numbers(path: str | os.PathLike[str]) -> np.ndarray:
    """Return the numbers of a ``.npy`` file as floats, shape (height, width), or raise MapError."""
    require_file(path)
    try:
        with open(path, "rb") as file:
            shape, order, dtype = _header(path, file, "numbers")
            return np.fromfile(file, dtype, shape[0] * shape[1]).astype(float).reshape(shape, order=order)
    except (MapError, MemoryError):
        raise
    except Exception:
        raise MapError(path, _DAMAGED) from None


def _header(path, file: BinaryIO, expected: str) -> tuple[tuple[int, int], Literal["C", "F"], np.dtype]:
    """Return the shape, the order and the type of an array, once the file is known to be as long as these say."""
    if file.read(len(MAGIC)) != MAGIC:
        raise MapError(path, "the file does not begin as a NumPy array, expected a .npy file written by numpy.save")
    file.seek(0)
    version = np.lib.format.read_magic(file)
    read_header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, column_order, dtype = read_header(file)
    if dtype.kind not in "biuf":
        raise MapError(path, f"the array holds {checks.printable(dtype, 80)}, expected {expected}")
    if len(shape) != 2:
        raise MapError(path, f"the array has {len(shape)} dimensions, expected 2 (height, width)")
    check_size(path, shape[1], shape[0])
    found, needed = os.fstat(file.fileno()).st_size - file.tell(), shape[0] * shape[1] * dtype.itemsize
    if found < needed:
        raise MapError(path, f"the file has {found} bytes of cells, expected {needed}, those of a whole .npy file")
    return shape, "F" if column_order else "C", dtype


def _load(path) -> np.ndarray:
    """Load the array in blocks."""
    with open(path, "rb") as file:
        shape, order, dtype = _header(path, file, "booleans or the numbers 0 and 1")
        size = shape[0] * shape[1]
        occupied = np.empty(size, dtype=bool)
        for start in range(0, size, BLOCK):
            values = np.fromfile(file, dtype, min(BLOCK, size - start))
            wrong = (values != 0) & (values != 1)
            if wrong.any():
                at = int(wrong.argmax())
                y, x = np.unravel_index(start + at, shape, order=order)
                raise MapError(path, f"cell ({x}, {y}) holds {values[at]}, expected 0 (free) or 1 (occupied)")
            occupied[start : start + len(values)] = values != 0
        return occupied.reshape(shape, order=order)
