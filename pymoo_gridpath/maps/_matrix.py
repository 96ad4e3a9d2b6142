"""Matrices of the numbers 0 and 1 in text, as `numpy.savetxt` writes them."""

from __future__ import annotations

import io
import re

import numpy as np

from pymoo_gridpath.errors import MapError
from pymoo_gridpath.maps._files import check_size, decode, shorten

# A number and what parts it from the next one.
_BEGINS = re.compile(rb"[ \t]*[+-]?[0-9][0-9.]*(e[+-]?[0-9]+)?[ \t]*[ \t,;][ \t]*[+-]?[0-9]", re.IGNORECASE)
_TO_BLANKS = bytes.maketrans(b",;\t", b"   ")


def is_matrix(body: bytes) -> bool:
    """Return whether rows begin with numbers that are parted by blanks, commas or semicolons."""
    return _BEGINS.match(body) is not None


def parse_matrix(path, body: bytes, first_line: int) -> np.ndarray:
    """Return which cells are occupied, bool, shape (height, width), from rows of numbers, the top row first.

    Raises MapError with the line of the first row that has another width, or anything else than 0 and 1.
    """
    body = body.translate(_TO_BLANKS)
    width = len(body.partition(b"\n")[0].split())
    check_size(path, width, body.count(b"\n") + 1, first_line)
    try:
        values = np.loadtxt(io.BytesIO(body), comments=None, ndmin=2)
    except ValueError:
        raise _bad_line(path, body, width, first_line) from None
    wrong = (values != 0) & (values != 1)
    # Blank lines among the rows would be passed over.
    if wrong.any() or len(values) != body.count(b"\n") + 1:
        raise _bad_line(path, body, width, first_line)
    return values[::-1] != 0


def _bad_line(path, body: bytes, width: int, first_line: int) -> MapError:
    for line, row in enumerate(body.split(b"\n"), first_line):
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
