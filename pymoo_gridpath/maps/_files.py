"""What the readers share: opening files, limits, and turning what is found into a grid, with `MapError` as the only error."""

from __future__ import annotations

import os
import reprlib
import sys
import warnings
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from pymoo_gridpath import checks
from pymoo_gridpath.errors import MapError, MapWarning
from pymoo_gridpath.grid import OccupancyGrid

MAX_CELLS = 100_000_000
"""The largest number of cells that a map may have."""

UNKNOWN_CHOICES = ("occupied", "free")

_repr = reprlib.Repr()
_repr.maxlevel, _repr.maxstring = 2, 60


def require_file(path: str | os.PathLike[str]) -> Path:
    """Return the path if it names a file, else raise MapError."""
    checks.file_path("path", path)
    if os.path.isfile(path):
        return Path(path)
    found = "found a directory" if os.path.isdir(path) else "no such file"
    raise MapError(path, f"{found}, expected a map file")


def read_string(path: str | os.PathLike[str], limit: int | None = None) -> str:
    """Return the text of a UTF-8 file of at most ``limit`` bytes, line ends as newlines, or raise MapError."""
    file = require_file(path)
    # A text map needs a byte a cell, a line end a row and a short header.
    limit = 2 * MAX_CELLS if limit is None else limit
    try:
        if file.stat().st_size > limit:
            raise MapError(path, f"the file has {file.stat().st_size} bytes, expected at most {limit} for a text file")
        data = file.read_bytes()
    except OSError as error:
        raise MapError(path, f"the file cannot be read ({error.strerror}), expected a readable map file") from None
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise MapError(path, f"found the byte 0x{data[error.start]:02x}, expected UTF-8 text", line) from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


def warn(path: str | os.PathLike[str], message: str) -> None:
    """Warn that a map may have been meant otherwise, at the line that called this package."""
    level, frame = 2, sys._getframe(1)
    while (outer := frame.f_back) is not None and frame.f_globals.get("__name__", "").startswith("pymoo_gridpath."):
        level, frame = level + 1, outer
    warnings.warn(MapWarning(path, message), stacklevel=level)


def shorten(value: object) -> str:
    """Return a short representation for an error message, however large or nested the value is."""
    return _repr.repr(value)


def check_size(path: str | os.PathLike[str], width: int, height: int, line: int | None = None) -> None:
    """Raise MapError unless the map has at least one cell and at most `MAX_CELLS`."""
    if width < 1 or height < 1:
        raise MapError(path, f"the map is {width} x {height} cells, expected at least one column and one row", line)
    if width * height > MAX_CELLS:
        raise MapError(path, f"the map is {width} x {height} cells, expected at most {MAX_CELLS} cells", line)


def check_unknown(path: str | os.PathLike[str], unknown: str) -> None:
    """Raise MapError unless ``unknown`` is one of its two choices."""
    if not (isinstance(unknown, str) and unknown in UNKNOWN_CHOICES):
        raise MapError(path, f"the option unknown is {shorten(unknown)}, expected 'occupied' or 'free'")


def make_grid(path: str | os.PathLike[str], occupied: ArrayLike, name: str | None = None, **arguments) -> OccupancyGrid:
    """Return an OccupancyGrid named after the file; what it refuses becomes a MapError that names the file."""
    try:
        return OccupancyGrid(occupied, name=Path(path).stem if name is None else name, **arguments)
    except (TypeError, ValueError) as error:
        raise MapError(path, str(error)) from None


def parse_rows(
    path: str | os.PathLike[str], rows: list[str], first_line: int, width: int, free: str, occupied: str
) -> np.ndarray:
    """Return which cells are occupied, shape (height, width), from rows of letters, the top row first.

    Raises MapError with the line of the first row that has an unknown letter or another width.
    """
    known, codes = set(free + occupied), np.frombuffer(occupied.encode("ascii"), np.uint8)
    grid = np.empty((len(rows), width), dtype=bool)
    for number, row in enumerate(rows):
        row, line = row.rstrip(), first_line + number
        if not known.issuperset(row):
            column, letter = next((k, letter) for k, letter in enumerate(row, start=1) if letter not in known)
            expected = f"one of {' '.join(free)} (free) or {' '.join(occupied)} (occupied)"
            raise MapError(path, f"found the letter {letter!r} in column {column}, expected {expected}", line)
        if len(row) != width:
            raise MapError(path, f"the row has {len(row)} cells, expected {width}", line)
        grid[-1 - number] = np.isin(np.frombuffer(row.encode("ascii"), np.uint8), codes)
    return grid
