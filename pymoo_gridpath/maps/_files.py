"""What the readers share: opening files, limits, and turning what is found into a grid, with `MapError` as the only error."""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from pymoo_gridpath import checks
from pymoo_gridpath.errors import MapError, MapWarning
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.grid.occupancy_values import UNKNOWN_CHOICES

MAX_CELLS = 100_000_000
"""The largest number of cells that a map may have."""

MAX_LINE = 10_000
"""The largest number of bytes of a line of text that is not a row of cells."""

_BLANKS = b" \t\v\f"
_IS_BLANK = np.isin(np.arange(256), list(_BLANKS))

BLOCK = 1 << 22
"""How many letters or values are looked at together, which bounds the memory that this takes."""


def require_file(path: str | os.PathLike[str], expected: str = "a map file") -> Path:
    """Return the path if it names a file, else raise MapError that says what was expected."""
    checks.file_path("path", path)
    if os.path.isfile(path):
        return Path(path)
    found = "found a directory" if os.path.isdir(path) else "no such file"
    raise MapError(path, f"{found}, expected {expected}")


def read_text_bytes(path: str | os.PathLike[str], limit: int | None = None) -> bytes:
    """Return a text file without a byte order mark and with line ends as newlines, or raise MapError.

    It stays bytes, because a text of the largest size would not fit into memory as letters; `decode` turns lines into text.
    """
    file = require_file(path)
    # A text map needs a byte a cell, a line end a row and a short header.
    limit = 2 * MAX_CELLS if limit is None else limit
    try:
        if file.stat().st_size > limit:
            raise MapError(path, f"the file has {file.stat().st_size} bytes, expected at most {limit} for a file of this kind")
        data = file.read_bytes()
    except OSError as error:
        raise MapError(path, f"the file cannot be read ({error.strerror}), expected a readable map file") from None
    data = data.removeprefix(b"\xef\xbb\xbf")
    return data.replace(b"\r\n", b"\n").replace(b"\r", b"\n") if b"\r" in data else data


def read_string(path: str | os.PathLike[str], limit: int) -> str:
    """Return the text of a UTF-8 file of at most ``limit`` bytes, line ends as newlines, or raise MapError."""
    return decode(path, read_text_bytes(path, checks.whole("limit", limit, 0)))


def decode(path: str | os.PathLike[str], data: bytes, line: int = 1) -> str:
    """Return bytes that begin in a given line as text, or raise MapError."""
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        line += data.count(b"\n", 0, error.start)
        raise MapError(path, f"found the byte 0x{data[error.start]:02x}, expected UTF-8 text", line) from None


def short_line(path: str | os.PathLike[str], data: bytes, start: int, line: int) -> str:
    """Return the line that begins at ``start``, which is not one of cells and therefore not long, or raise MapError."""
    end = data.find(b"\n", start)
    end = len(data) if end < 0 else end
    if end - start > MAX_LINE:
        raise MapError(path, f"the line has {end - start} bytes, expected at most {MAX_LINE} where it is not a row", line)
    return decode(path, data[start:end], line)


def warn(path: str | os.PathLike[str], message: str) -> None:
    """Warn that a map may have been meant otherwise, at the line that called this package."""
    level, frame = 2, sys._getframe(1)
    while (outer := frame.f_back) is not None and frame.f_globals.get("__name__", "").startswith("pymoo_gridpath."):
        level, frame = level + 1, outer
    warnings.warn(MapWarning(path, message), stacklevel=level)


def blocks(height: int, width: int) -> Iterator[slice]:
    """Yield the rows of an array of this size as slices of about `BLOCK` cells each."""
    step = max(BLOCK // width, 1)
    return (slice(start, min(start + step, height)) for start in range(0, height, step))


def shorten(value: object) -> str:
    """Return a short representation for an error message, however large or nested the value is."""
    return checks.shown(value)


def plain(number: int) -> str:
    """Return a whole number as text, however large it is."""
    return str(number) if abs(number) < 10**15 else "over 10^15" if number > 0 else "below -10^15"


def check_size(path: str | os.PathLike[str], width: int, height: int, line: int | None = None) -> None:
    """Raise MapError unless the map has at least one cell and at most `MAX_CELLS`."""
    size = f"{plain(width)} x {plain(height)}"
    if width < 1 or height < 1:
        raise MapError(path, f"the map is {size} cells, expected at least one column and one row", line)
    if width * height > MAX_CELLS:
        raise MapError(path, f"the map is {size} cells, expected at most {MAX_CELLS} cells", line)


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
    path: str | os.PathLike[str], body: bytes, first_line: int, size: tuple[int, int], free: str, occupied: str
) -> np.ndarray:
    """Return which cells are occupied, shape (height, width), from rows of letters, the top row first.

    ``body`` begins with the first row and ends with the last one, ``size`` is (width, height). Blanks at the end of a row are
    ignored. Raises MapError with the line of the first row that has an unknown letter or another width.
    """
    width, height = size
    # A letter is 0 where free, 1 where occupied, 2 where unknown.
    codes = np.full(256, 2, np.uint8)
    codes[list(free.encode())], codes[list(occupied.encode())] = 0, 1
    blanks = any(body.find(blank) >= 0 for blank in _BLANKS)
    rows = body.translate(None, _BLANKS) if blanks else body
    within = _blank_within(body) if blanks else None
    bad = height if within is None else body.count(b"\n", 0, within)
    whole = min((len(rows) + 1) // (width + 1), height)
    letters = np.frombuffer(rows, np.uint8, min(len(rows), whole * (width + 1)))
    grid = np.empty((height, width), dtype=bool)
    step = max(BLOCK // (width + 1), 1)
    for start in range(0, whole, step):
        block = letters[start * (width + 1) : (start + step) * (width + 1)]
        if len(block) % (width + 1):
            # The last row of the file has no line end.
            block = np.append(block, np.uint8(ord("\n")))
        block = block.reshape(-1, width + 1)
        found = codes[block[:, :-1]]
        right = (block[:, -1] == ord("\n")) & (found < 2).all(axis=1)
        grid[height - start - len(block) : height - start] = found[::-1]
        if not right.all():
            bad = min(bad, start + int(right.argmin()))
            break
    else:
        bad = min(bad, whole)
    if bad < height:
        raise _bad_row(path, body, bad, first_line, width, codes, free, occupied)
    return grid


def rows_of(occupied: np.ndarray, free_letter: str, occupied_letter: str) -> bytes:
    """Return what `parse_rows` reads: a letter a cell, the top row first, each row with a line end."""
    letters = np.where(occupied[::-1], np.uint8(ord(occupied_letter)), np.uint8(ord(free_letter)))
    return np.pad(letters, ((0, 0), (0, 1)), constant_values=ord("\n")).tobytes()


def _blank_within(body: bytes) -> int | None:
    """Return where a blank stands before a letter, or None."""
    letters = np.frombuffer(body, np.uint8)
    for start in range(0, len(letters), BLOCK):
        block = letters[start : start + BLOCK + 1]
        blank = _IS_BLANK[block]
        wrong = blank[:-1] & ~blank[1:] & (block[1:] != ord("\n"))
        if wrong.any():
            return start + int(wrong.argmax())
    return None


def _bad_row(
    path, body: bytes, index: int, first_line: int, width: int, codes: np.ndarray, free: str, occupied: str
) -> MapError:
    """Return the error of a row that cannot be read."""
    start = 0
    # In blocks, because there may be as many rows as cells.
    while (ends := body.count(b"\n", start, start + BLOCK)) < index:
        start, index = start + BLOCK, index - ends
    for _ in range(index):
        start = body.find(b"\n", start) + 1
    end = body.find(b"\n", start)
    line = first_line + body.count(b"\n", 0, start)
    row = body[start : end if end >= 0 else len(body)].rstrip()
    wrong = codes[np.frombuffer(row, np.uint8)] == 2
    if not wrong.any():
        return MapError(path, f"the row has {len(row)} cells, expected {width}", line)
    column = int(wrong.argmax())
    letter = decode(path, row[column:], line)[0]
    expected = f"one of {' '.join(free)} (free) or {' '.join(occupied)} (occupied)"
    return MapError(path, f"found the letter {letter!r} in column {column + 1}, expected {expected}", line)
