"""The maps that ship with the package."""

from __future__ import annotations

import difflib
import os
from dataclasses import dataclass
from pathlib import Path

from pymoo_gridpath import checks
from pymoo_gridpath.errors import MapError
from pymoo_gridpath.grid import Cell, OccupancyGrid
from pymoo_gridpath.maps.text import read_text, read_text_header

_FOLDER = Path(__file__).parent / "data"

# So much of a name that no map has stands in the message.
_LONGEST_NAME = 80


@dataclass(frozen=True)
class ShippedMap:
    """A map that ships with the package, and a query worth planning on it.

    Parameters
    ----------
    name : str
        What `load_shipped` and `load_map` call it.
    title : str
        One line about it.
    path : pathlib.Path
        Its file, in the format of `read_text`.
    start, goal : (int, int)
        Cells (x, y), y up, joined by a path that never goes left.
    radius : float
        Radius in metres of a robot for which the query stays so on the inflated grid; 0 is a point.
    """

    name: str
    title: str
    path: Path
    start: Cell
    goal: Cell
    radius: float


def shipped_maps() -> list[ShippedMap]:
    """Return the maps that ship with the package, by name.

    Returns
    -------
    list of ShippedMap

    Examples
    --------
    >>> [item.name for item in shipped_maps()]
    ['office', 'paper16', 'warehouse']
    """
    return [_describe(path) for path in sorted(_FOLDER.glob("*.txt"))]


def load_shipped(name: str, **options) -> OccupancyGrid:
    """Load a map that ships with the package.

    Parameters
    ----------
    name : str
        One of the names of `shipped_maps`.
    **options
        Those of `read_text`.

    Returns
    -------
    OccupancyGrid

    Raises
    ------
    MapError
        If no such map ships; the message lists those that do.

    Examples
    --------
    >>> load_shipped("paper16").shape
    (16, 16)
    """
    checks.text("name", name)
    return read_text(_shipped(name), **options)


def file_of(path: str | os.PathLike[str]) -> Path:
    """Return the file of a map: the one of that path if there is one, else that of the shipped map of that name.

    Raises
    ------
    MapError
        If the path is a bare name, and there is neither.
    """
    name, file = checks.file_path("path", path), Path(path)
    if os.path.isfile(file):
        return file
    # A folder does not keep a shipped map from being found; other paths are for the reader to refuse.
    is_bare = bool(name) and not os.path.exists(name) and file.name == name and not file.suffix
    return _shipped(name) if is_bare or name in _names() else file


def _names() -> list[str]:
    return sorted(path.stem for path in _FOLDER.glob("*.txt"))


def _shipped(name: str) -> Path:
    """Return the file of a shipped map."""
    if name not in (names := _names()):
        near = difflib.get_close_matches(name, names, n=1, cutoff=0.5)
        hint = f" (did you mean {near[0]!r}?)" if near else ""
        raise MapError(
            name[:_LONGEST_NAME],
            f"no such file and no such shipped map{hint}, expected a map file or one of {', '.join(names)}",
        )
    return _FOLDER / f"{name}.txt"


def _describe(path: Path) -> ShippedMap:
    header = read_text_header(path)
    if header.start is None or header.goal is None:
        raise MapError(path, "the header has no start or no goal, expected both in a map that ships")
    return ShippedMap(path.stem, header.title or path.stem, path, header.start, header.goal, header.radius or 0.0)
