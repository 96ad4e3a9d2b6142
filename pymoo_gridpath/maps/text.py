"""Maps as plain text, the format of the maps that ship with the package.

A file is, in UTF-8,

1. header lines ``key: value``, all optional, each key at most once:

   ==================  ==================================================================================
   ``name``            what figures call the map; the file's name if absent
   ``title``           one line about it
   ``resolution``      side of a cell in metres; if absent, the map is one in cells
   ``origin``          x y yaw (or x y) of the bottom-left corner in metres and radians, 0 0 0 if absent; only beside a
                       resolution
   ``corner_cutting``  true, false or one side, false if absent
   ``moves``           8, or 4 for no diagonal steps, 8 if absent
   ``start``           x y of a good start, a free cell counted from the bottom left
   ``goal``            x y of a good goal, likewise
   ``radius``          radius in metres of a robot that can make that way, 0 (a point) if absent
   ==================  ==================================================================================

2. the rows, the *top* row first, all of one width: ``.`` and ``0`` are free, ``#``, ``@``, ``X`` and ``1`` are occupied.

Rows may also be those of a matrix of the numbers 0 and 1, separated by blanks, commas or semicolons, as `numpy.savetxt` writes
it; here, too, the top row comes first: ``numpy.savetxt(path, grid.occupied[::-1])``.

The numbers of a header value are separated by spaces or commas. Blank lines before the rows and after them are ignored. There
are no comments, because ``#`` is an obstacle.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pymoo_gridpath.errors import MapError, visible
from pymoo_gridpath.files import write_whole
from pymoo_gridpath.grid import Cell, CornerCutting, OccupancyGrid
from pymoo_gridpath.maps._files import (
    MAX_LINE,
    check_size,
    make_grid,
    parse_rows,
    plain,
    read_text_bytes,
    rows_of,
    short_line,
    shorten,
)
from pymoo_gridpath.maps._matrix import is_matrix, parse_matrix
from pymoo_gridpath.maps.formats import MAP_FORMATS, MapFormat, Query
from pymoo_gridpath.neighbourhood import MOVES, ONE_SIDE

FREE = ".0"
OCCUPIED = "#@X1"

_INK = re.compile(rb"\S")


@dataclass(frozen=True)
class TextHeader:
    """The header of a plain text map; None where it says nothing.

    Parameters
    ----------
    name, title : str or None
    resolution : float or None
        Metres per cell.
    origin : tuple of float or None
        x, y (and yaw) in metres and radians.
    corner_cutting : bool, "one side" or None
    start, goal : (int, int) or None
        Cells (x, y), y up.
    radius : float or None
        Metres.
    moves : int or None
        How many neighbours a cell has.
    """

    name: str | None = None
    title: str | None = None
    resolution: float | None = None
    origin: tuple[float, ...] | None = None
    corner_cutting: CornerCutting | None = None
    start: Cell | None = None
    goal: Cell | None = None
    radius: float | None = None
    moves: int | None = None


def read_text(
    path: str | os.PathLike[str],
    corner_cutting: CornerCutting | None = None,
    resolution: float | None = None,
    origin: Sequence[float] | None = None,
) -> OccupancyGrid:
    """Read a map from plain text; the format is described at the top of this module.

    Parameters
    ----------
    path : str or path-like
        The file.
    corner_cutting : bool or "one side", optional
        Whether a diagonal step may touch an occupied cell. If not given, the header decides, else False.
    resolution : float, optional
        Side of a cell in metres. If not given, the header decides; if that says nothing, the map is one in cells.
    origin : (float, float) or (float, float, float), optional
        Pose of the grid in metres and radians. If not given, the header decides, else (0, 0, 0).

    Returns
    -------
    OccupancyGrid

    Raises
    ------
    MapError
        If the file cannot be read or is not such a map; the message names the line.
    """
    header, data, start, lines = _split(path)
    first = data.count(b"\n", 0, start) + 1
    occupied = _cells(path, data, start, first)
    options = {
        "corner_cutting": header.corner_cutting if corner_cutting is None else corner_cutting,
        "resolution": header.resolution if resolution is None else resolution,
        "origin": header.origin if origin is None else origin,
        "moves": header.moves,
    }
    grid = make_grid(path, occupied, header.name, **{key: value for key, value in options.items() if value is not None})
    for role, cell in (("start", header.start), ("goal", header.goal)):
        if cell is not None and not grid.is_free(cell):
            found = ", ".join(map(plain, cell))
            size = f"{grid.width} x {grid.height}"
            raise MapError(path, f"{role} is {found}, expected a free cell of the {size} cells", lines[role])
    return grid


def read_text_header(path: str | os.PathLike[str]) -> TextHeader:
    """Read only the header of a plain text map.

    Parameters
    ----------
    path : str or path-like
        The file.

    Returns
    -------
    TextHeader

    Raises
    ------
    MapError
        If the file cannot be read or a header line is wrong; the message names the line.
    """
    return _split(path)[0]


@MAP_FORMATS.register
class TextFormat(MapFormat):
    """Plain text, see `read_text`."""

    name, suffixes, catch_all = "text", (".txt",), True
    read = staticmethod(read_text)  # pyright: ignore[reportAssignmentType]

    def query(self, path):
        header = read_text_header(path)
        return Query(header.start, header.goal, header.radius or 0.0)

    def write(self, path, grid):
        lines = {
            "name": " ".join(visible(grid.name).split()),
            "resolution": "" if grid.resolution is None else repr(grid.resolution),
            "origin": "" if grid.resolution is None else " ".join(map(repr, grid.origin)),
            "corner_cutting": str(grid.corner_cutting).lower(),
            "moves": "" if grid.moves == 8 else str(grid.moves),
        }
        head = "".join(f"{key}: {value}\n" for key, value in lines.items() if value)
        write_whole(path, head.encode() + b"\n" + rows_of(grid.occupied, FREE[0], OCCUPIED[0]))


def _cells(path, data: bytes, start: int, first: int) -> np.ndarray:
    if is_matrix(data[start : start + MAX_LINE]):
        return parse_matrix(path, data[start:], first)
    end = data.find(b"\n", start)
    size = len(data[start : end if end >= 0 else len(data)].rstrip()), data.count(b"\n", start) + 1
    check_size(path, *size, first)
    return parse_rows(path, data[start:], first, size, FREE, OCCUPIED)


def _split(path) -> tuple[TextHeader, bytes, int, dict[str, int]]:
    """Return the header, all of the text, where its first row begins, and the line of each key."""
    data = read_text_bytes(path).rstrip()
    found: dict[str, object] = {}
    lines: dict[str, int] = {}
    position, line = 0, 1
    while (first := _INK.search(data, position)) is not None:
        start = data.rfind(b"\n", position, first.start()) + 1 or position
        line += data.count(b"\n", position, start)
        end = data.find(b"\n", start)
        end = len(data) if end < 0 else end
        if data.find(b":", start, end) < 0:
            return TextHeader(**found), data, start, lines  # pyright: ignore[reportArgumentType]
        key, _, value = (part.strip() for part in short_line(path, data, start, line).partition(":"))
        if key not in _HEADER:
            raise MapError(path, f"found the key {shorten(key)}, expected one of {', '.join(_HEADER)} or a row", line)
        if key in found:
            raise MapError(path, f"the key {key!r} is given again, expected it once", line)
        convert, expected = _HEADER[key]
        try:
            found[key], lines[key] = convert(value), line
        except ValueError:
            raise MapError(path, f"{key} is {shorten(value)}, expected {expected}", line) from None
        position = end
    raise MapError(path, "found no row, expected at least one row of '.' and '#'")


def _numbers(value: str) -> list[float]:
    numbers = [float(word) for word in value.replace(",", " ").split()]
    if not all(map(math.isfinite, numbers)):
        raise ValueError
    return numbers


def _text(value: str) -> str:
    if not value:
        raise ValueError
    return value


def _pose(value: str) -> tuple[float, ...]:
    numbers = _numbers(value)
    if len(numbers) not in (2, 3):
        raise ValueError
    return tuple(numbers)


def _metres(value: str) -> float:
    (number,) = _numbers(value)
    if number < 0:
        raise ValueError
    return number


def _resolution(value: str) -> float:
    if _metres(value) == 0:
        raise ValueError
    return _metres(value)


def _cell(value: str) -> Cell:
    x, y = (int(word) for word in value.replace(",", " ").split())
    return x, y


def _corner_cutting(value: str) -> CornerCutting:
    known: dict[str, CornerCutting] = {"true": True, "false": False, ONE_SIDE: "one side"}
    if value not in known:
        raise ValueError
    return known[value]


def _moves(value: str) -> int:
    if int(value) not in MOVES:
        raise ValueError
    return int(value)


_HEADER = {
    "name": (_text, "a name"),
    "title": (_text, "a line of text"),
    "resolution": (_resolution, "a positive number of metres per cell"),
    "origin": (_pose, "two or three numbers x y yaw in metres and radians"),
    "corner_cutting": (_corner_cutting, f"true, false or {ONE_SIDE}"),
    "moves": (_moves, " or ".join(map(str, MOVES))),
    "start": (_cell, "two whole numbers x y"),
    "goal": (_cell, "two whole numbers x y"),
    "radius": (_metres, "a number of metres, zero or more"),
}
