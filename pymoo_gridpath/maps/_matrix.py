"""Matrices of the numbers 0 and 1 in text, as `numpy.savetxt` writes them."""

from __future__ import annotations

import re
import warnings

import numpy as np

from pymoo_gridpath.errors import MapError
from pymoo_gridpath.maps._files import check_size, decode, shorten

# A number and what parts it from the next one.
_BEGINS = re.compile(rb"[ \t]*[+-]?[0-9][0-9.]*(e[+-]?[0-9]+)?[ \t]*[ \t,;][ \t]*[+-]?[0-9]", re.IGNORECASE)
_TO_BLANKS = bytes.maketrans(b",;\t\r", b"    ")

# Bytes that are read at a time, and what a row may have: a matrix of 200 MB is never held as numbers or words.
_BLOCK = 4_000_000
_LONGEST_ROW = 4_000_000


def is_matrix(body: bytes) -> bool:
    """Return whether rows begin with numbers that are parted by blanks, commas or semicolons."""
    return _BEGINS.match(body) is not None


def parse_matrix(path, body: bytes, first_line: int) -> np.ndarray:
    """Return which cells are occupied, bool, shape (height, width), from rows of numbers, the top row first.

    Raises MapError with the line of the first row that has another width, or anything else than 0 and 1.
    """
    body = body.translate(_TO_BLANKS)
    row = _up_to_line_end(body, 0)
    if len(row) > _LONGEST_ROW:
        raise _too_long(path, row, first_line)
    width, height = len(row.split()), body.count(b"\n") + 1
    check_size(path, width, height, first_line)
    occupied = np.empty((height, width), dtype=bool)
    y, begin = 0, 0
    while y < height:
        block = _up_to_line_end(body, begin, _BLOCK)
        values = _values(block, width)
        if values is None:
            raise _bad_line(path, block, width, first_line + y)
        occupied[y : y + len(values)] = values
        y, begin = y + len(values), begin + len(block) + 1
    return occupied[::-1]


def _up_to_line_end(body: bytes, begin: int, least: int = 0) -> bytes:
    """Return the rest of a line, and as many lines behind it as there are in so many bytes at least."""
    end = body.find(b"\n", begin + least)
    return body[begin : end if end >= 0 else len(body)]


def _values(block: bytes, width: int) -> np.ndarray | None:
    """Return which of the numbers of whole rows are not 0, or None where a row has another width or anything but 0 and 1."""
    if len(block) > _BLOCK + _LONGEST_ROW:
        return None
    letters = np.frombuffer(block, np.uint8)
    ink = letters > ord(" ")
    begins = ink.copy()
    begins[1:] &= ~ink[:-1]
    rows = np.concatenate(([0], np.flatnonzero(letters == ord("\n")) + 1))
    # No row is empty: the line end before it would be counted in its place.
    if rows[-1] >= len(letters) or (np.add.reduceat(begins, rows, dtype=np.int64) != width).any():
        return None
    if np.array_equal(ink, begins) and not block.translate(None, b"01 \n"):
        return (letters[ink] == ord("1")).reshape(-1, width)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            numbers = np.fromstring(block, dtype=float, sep=" ")
        except (DeprecationWarning, ValueError):
            return None
    if len(numbers) != len(rows) * width or not np.isin(numbers, (0.0, 1.0)).all():
        return None
    return numbers.reshape(-1, width) != 0


def _too_long(path, row: bytes, line: int) -> MapError:
    return MapError(path, f"the row has {len(row):,} bytes, expected at most {_LONGEST_ROW:,}", line)


def _bad_line(path, body: bytes, width: int, first_line: int) -> MapError:
    for line, row in enumerate(body.split(b"\n"), first_line):
        if len(row) > _LONGEST_ROW:
            return _too_long(path, row, line)
        words = row.split()
        if len(words) != width:
            return MapError(path, f"the row has {len(words)} numbers, expected {width}", line)
        for column, word in enumerate(words, 1):
            if not _is_truth(word):
                found = shorten(decode(path, word, line))
                return MapError(path, f"found {found} in column {column}, expected 0 (free) or 1 (occupied)", line)
    return MapError(path, "the rows cannot be read, expected the numbers 0 (free) and 1 (occupied)")


def _is_truth(word: bytes) -> bool:
    try:
        return float(word) in (0.0, 1.0)
    except ValueError:
        return False
