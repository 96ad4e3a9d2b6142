"""The maps that ship with the package."""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from pathlib import Path

from pymoo_gridpath import checks
from pymoo_gridpath.errors import MapError
from pymoo_gridpath.grid import Cell, OccupancyGrid
from pymoo_gridpath.maps.text import read_text, read_text_header

_FOLDER = Path(__file__).parent / "data"


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
    names = shipped_names()
    checks.text("name", name)
    if name not in names:
        near = difflib.get_close_matches(name, names, n=1, cutoff=0.5)
        hint = f" (did you mean {near[0]!r}?)" if near else ""
        raise MapError(name, f"no such file and no such shipped map{hint}, expected a map file or one of {', '.join(names)}")
    return read_text(_FOLDER / f"{name}.txt", **options)


def shipped_names() -> list[str]:
    """Return the names of the shipped maps, sorted."""
    return sorted(path.stem for path in _FOLDER.glob("*.txt"))


def _describe(path: Path) -> ShippedMap:
    header = read_text_header(path)
    if header.start is None or header.goal is None:
        raise MapError(path, "the header has no start or no goal, expected both in a map that ships")
    return ShippedMap(path.stem, header.title or path.stem, path, header.start, header.goal, header.radius or 0.0)
