"""Maps and scenarios of the MovingAI benchmarks: ``.map`` and ``.scen``.

Format: N. R. Sturtevant, "Benchmarks for Grid-Based Pathfinding", IEEE Transactions on Computational Intelligence and AI in
Games 4(2), 2012.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import MapError
from pymoo_gridpath.files import write_whole
from pymoo_gridpath.grid import Cell, CornerCutting, OccupancyGrid
from pymoo_gridpath.maps._files import check_size, make_grid, parse_rows, read_text_bytes, rows_of, short_line, shorten
from pymoo_gridpath.maps.formats import MAP_FORMATS, MapFormat

# The benchmarks' own loader (``Map.cpp`` of HOG2) takes lower-case letters as their capitals, and any other character as
# ground. The latter is refused here, because a wrong letter is more likely than such ground.
PASSABLE = ".GSgs"
# Water can be entered from water only, so to a robot that stands on the ground it is an obstacle.
OCCUPIED = "@OTWotw"

MAX_QUERIES = 250_000
"""The largest number of entries that a scenario may have."""

_INK = re.compile(rb"\S[^\n]*")

_SCEN_COLUMNS = "bucket, map, width, height, start column, start row, goal column, goal row, length"


@dataclass(frozen=True)
class ScenQuery:
    """One entry of a ``.scen`` file, in this package's coordinates.

    Parameters
    ----------
    bucket : int
        Group of entries of like length.
    map_name : str
        The map as the file names it.
    width, height : int
        Size of that map in cells.
    start, goal : (int, int)
        Cells (x, y), y up. The file's (column, row) pairs count rows from the top; they are already turned.
    optimal_length : float
        Length in cells of the shortest path that cuts no corner.
    """

    bucket: int
    map_name: str
    width: int
    height: int
    start: Cell
    goal: Cell
    optimal_length: float


def read_movingai(
    path: str | os.PathLike[str],
    corner_cutting: CornerCutting = False,
    resolution: float | None = None,
    origin: Sequence[float] = (0.0, 0.0, 0.0),
) -> OccupancyGrid:
    """Read a map of the MovingAI benchmarks.

    The ground ``.`` and ``G`` and the swamp ``S`` are free. Trees ``T``, out of bounds ``@`` and ``O``, and water ``W``, which
    cannot be entered from the ground, are occupied. Lower-case letters mean the same.

    Parameters
    ----------
    path : str or path-like
        The ``.map`` file; its first row is the top one.
    corner_cutting : bool or "one side", default False
        Whether a diagonal step may touch an occupied cell. The benchmark's lengths hold for False.
    resolution : float, optional
        Side of a cell in metres. The format has none; without it the map is one in cells.
    origin : (float, float) or (float, float, float), default (0, 0, 0)
        Pose of the grid in metres and radians, beside a resolution only; the format has none.

    Returns
    -------
    OccupancyGrid

    Raises
    ------
    MapError
        If the file cannot be read or is not such a map; the message names the line.
    """
    width, height, body, first = _read_body(path)
    occupied = parse_rows(path, body, first, (width, height), PASSABLE, OCCUPIED)
    return make_grid(path, occupied, corner_cutting=corner_cutting, resolution=resolution, origin=origin)


def read_terrain(path: str | os.PathLike[str], weights: Mapping[str, float]) -> np.ndarray:
    r"""Return what the terrain of a MovingAI map costs, by its letters.

    The benchmarks give terrain no costs; who wants the swamp to be dear says how dear.

    Parameters
    ----------
    path : str or path-like
        The ``.map`` file.
    weights : mapping of str to float
        Costs by letters, zero or more, such as ``{"S": 3}``; small letters mean the same as capitals. Ground and swamp that are
        not named cost 1.

    Returns
    -------
    numpy.ndarray of float, shape (height, width)
        Row 0 at the bottom; NaN where neither the map's rules nor a weight let anybody walk. Where water or trees are given a
        weight, a map to plan on has them free: ``grid.replace(occupied=np.isnan(costs))``.

    Raises
    ------
    MapError
        If the file cannot be read or is not such a map.
    GridPathError
        If a letter is none of the format's, or a weight no such number.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> file = pathlib.Path(tempfile.mkdtemp(), "pond.map")
    >>> _ = file.write_text("type octile\nheight 2\nwidth 3\nmap\n.SW\n..T\n")
    >>> read_terrain(file, {"S": 3, "W": 8}).tolist()
    [[1.0, 1.0, nan], [1.0, 3.0, 8.0]]
    """
    checks.instance("weights", weights, Mapping)
    costs = np.full(256, np.nan)
    costs[list(PASSABLE.encode())] = 1.0
    for letter, weight in weights.items():
        checks.one_of("a letter of terrain", letter, PASSABLE + OCCUPIED)
        cost = checks.number(f"the weight of {letter!r}", weight, 0.0, expected="a number, zero or more")
        costs[[ord(letter.lower()), ord(letter.upper())]] = cost
    width, height, body, first = _read_body(path)
    parse_rows(path, body, first, (width, height), PASSABLE, OCCUPIED)
    rows = [np.frombuffer(row.rstrip(), np.uint8) for row in body.split(b"\n")]
    return costs[np.array(rows[::-1])]


@MAP_FORMATS.register
class MovingAIFormat(MapFormat):
    """Maps of the MovingAI benchmarks, see `read_movingai`; its queries and voxel maps are told as well, and refused."""

    name, suffixes = "movingai", (".map", ".3dmap")
    read = staticmethod(read_movingai)  # pyright: ignore[reportAssignmentType]

    def matches(self, head, path):
        return head.removeprefix(b"\xef\xbb\xbf").split(maxsplit=1)[:1] in ([b"type"], [b"voxel"], [b"version"])

    def write(self, path, grid):
        if path.suffix.lower() != self.suffixes[0]:
            raise MapError(path, "maps in three dimensions are not written, expected a file .map")
        head = f"type octile\nheight {grid.height}\nwidth {grid.width}\nmap\n"
        write_whole(path, head.encode() + rows_of(grid.occupied, PASSABLE[0], OCCUPIED[0]))


def read_scen(path: str | os.PathLike[str], grid: OccupancyGrid | None = None) -> list[ScenQuery]:
    """Read the queries of a MovingAI scenario.

    Parameters
    ----------
    path : str or path-like
        The ``.scen`` file. Its header is ``version 1`` or ``version 1.0``; columns are separated by tabs or spaces.
    grid : OccupancyGrid, optional
        The map that the queries are meant for. If given, an entry for a map of another size is an error.

    Returns
    -------
    list of ScenQuery
        In the order of the file, with start and goal as cells (x, y), y up.

    Raises
    ------
    MapError
        If the file cannot be read or is not such a scenario, or if an entry's size is not that of ``grid``; the message
        names the line.
    """
    checks.instance("grid", grid, OccupancyGrid, optional=True)
    data = read_text_bytes(path).rstrip()
    title = short_line(path, data, 0, 1)
    if title.split() not in (["version", "1"], ["version", "1.0"]):
        raise MapError(path, f"found {shorten(title)}, expected 'version 1' or 'version 1.0'", 1)
    queries = []
    line, position = 1, 0
    for entry in _INK.finditer(data, len(data.partition(b"\n")[0])):
        line += data.count(b"\n", position, entry.start())
        position = entry.start()
        if len(queries) == MAX_QUERIES:
            raise MapError(path, f"the entry is one too many, expected at most {MAX_QUERIES} entries", line)
        query = _read_query(path, short_line(path, data, position, line), line)
        if grid is not None and (query.width, query.height) != (grid.width, grid.height):
            raise MapError(
                path,
                f"the entry is for a map of {query.width} x {query.height} cells, "
                f"expected {grid.width} x {grid.height} as the grid {checks.shown(grid.name)}",
                line,
            )
        queries.append(query)
    return queries


def _read_body(path) -> tuple[int, int, bytes, int]:
    """Return width, height, the rows, as many as the height says, and the line of the first."""
    data = read_text_bytes(path).rstrip()
    width, height, start, first = _read_header(path, data)
    rows = data.count(b"\n", start) + 1 if start <= len(data) else 0
    if rows != height:
        line = first + min(height, rows) - (rows < height)
        raise MapError(path, f"found {rows} rows below 'map', expected {height}", line)
    return width, height, data[start:], first


def _read_header(path, data: bytes) -> tuple[int, int, int, int]:
    """Return width, height, where the first row begins, and its line."""
    title = short_line(path, data, 0, 1)
    first = title.split()[:1]
    if first == ["voxel"] or (first != ["type"] and Path(path).suffix.lower() == ".3dmap"):
        raise MapError(path, "the file is a voxel map in three dimensions (.3dmap of MovingAI), expected a map in two")
    if first == ["version"]:
        raise MapError(path, "the file is a list of queries, expected a map; read_scen reads queries")
    if title.split() != ["type", "octile"]:
        raise MapError(path, f"found {shorten(title)}, expected 'type octile'", 1)
    sizes: dict[str, int] = {}
    position = 0
    for line in (2, 3, 4):
        position = data.find(b"\n", position) + 1
        if position == 0:
            raise MapError(path, "the file ends within its header, expected 'type octile', height, width and 'map'", line - 1)
        text = short_line(path, data, position, line)
        words = text.split()
        missing = [key for key in ("height", "width") if key not in sizes]
        if missing == [] and words == ["map"]:
            check_size(path, sizes["width"], sizes["height"])
            break
        if len(words) != 2 or words[0] not in missing:
            expected = " or ".join(f"'{key}' and a number" for key in missing) or "'map'"
            raise MapError(path, f"found {shorten(text)}, expected {expected}", line)
        sizes[words[0]] = _whole(path, words[1], words[0], line)
    start = data.find(b"\n", position) + 1
    return sizes["width"], sizes["height"], start or len(data) + 1, 5


def _read_query(path, text: str, line: int) -> ScenQuery:
    fields = text.split()
    if len(fields) != 9:
        # A map's name may hold spaces where the columns are separated by tabs.
        fields = text.split("\t")
    if len(fields) != 9:
        raise MapError(path, f"the entry has {len(text.split())} columns, expected 9 ({_SCEN_COLUMNS})", line)
    names = ("bucket", "", "width", "height", "start column", "start row", "goal column", "goal row")
    numbers = [_whole(path, fields[k], names[k], line) for k in (0, 2, 3, 4, 5, 6, 7)]
    bucket, width, height, *cells = numbers
    check_size(path, width, height, line)
    ends = []
    for role, column, row in (("start", *cells[:2]), ("goal", *cells[2:])):
        if column >= width or row >= height:
            where = f"{role} column {column} and row {row}"
            raise MapError(path, f"found the {where}, expected them within {width} columns and {height} rows", line)
        ends.append((column, height - 1 - row))
    try:
        length = float(fields[8])
    except ValueError:
        length = math.nan
    if not (math.isfinite(length) and length >= 0):
        raise MapError(path, f"the length is {shorten(fields[8].strip())}, expected a number of cells, zero or more", line)
    return ScenQuery(bucket, fields[1].strip(), width, height, ends[0], ends[1], length)


def _whole(path, word: str, name: str, line: int) -> int:
    word = word.strip()
    # A number of ten digits is far above any size; longer ones are not worth converting.
    if not (word.isascii() and word.isdigit() and len(word) <= 10):
        raise MapError(path, f"the {name} is {shorten(word)}, expected a whole number, zero or more", line)
    return int(word)
