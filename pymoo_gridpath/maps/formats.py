"""Map formats: what tells the files of each, what its reader takes, and which of them a file is of."""

from __future__ import annotations

import inspect
import os
from abc import ABC, abstractmethod
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pymoo_gridpath.errors import MapError
from pymoo_gridpath.grid import Cell, OccupancyGrid
from pymoo_gridpath.maps._files import require_file
from pymoo_gridpath.registry import Registry

# Bytes of a file's beginning by which formats tell it.
_HEAD = 4096


@dataclass(frozen=True)
class Query:
    """What a map names as worth planning on it; None where it says nothing.

    Parameters
    ----------
    start, goal : (int, int) or None
        Cells (x, y), y up.
    radius : float, default 0.0
        Radius in metres of a robot that can make that way; 0 is a point.
    """

    start: Cell | None = None
    goal: Cell | None = None
    radius: float = 0.0


class MapFormat(ABC):
    """A kind of map files, and how they are read.

    Inherit from it, set `name` and what tells the files, define `read`, and `register` the class: `load_map`, the command line
    and studies then read such files. `pymoo_gridpath.testing.MapFormatSuite` says whether it does what it must.

    Attributes
    ----------
    name : str
        What it is registered as, such as ``"ros"``.
    suffixes : tuple of str
        Endings of its files in small letters with the dot, such as ``(".yaml", ".yml")``.
    catch_all : bool
        Whether text that no other format claims is read as this one.

    Examples
    --------
    >>> from pymoo_gridpath.maps import check_size, make_grid, read_string
    >>> class Runs(MapFormat):
    ...     '''Each row as the lengths of its runs, free and occupied in turn: "3 1 2".'''
    ...
    ...     name, suffixes = "runs", (".runs",)
    ...
    ...     def read(self, path, corner_cutting=False, resolution=None):
    ...         text = read_string(path, 10**6)
    ...         try:
    ...             rows = [[int(word) for word in line.split()] for line in text.splitlines()]
    ...         except ValueError:
    ...             raise MapError(path, "found a word that is no whole number, expected the lengths of runs") from None
    ...         sizes = {sum(row) for row in rows}
    ...         if len(sizes) != 1 or sizes == {0} or min(map(min, rows)) < 0:
    ...             raise MapError(path, "the rows have not all one width, expected runs that add up to it")
    ...         check_size(path, sizes.pop(), len(rows))
    ...         occupied = [[k % 2 for k, run in enumerate(row) for _ in range(run)] for row in reversed(rows)]
    ...         return make_grid(path, occupied, corner_cutting=corner_cutting, resolution=resolution)
    """

    name: str
    suffixes: tuple[str, ...] = ()
    catch_all: bool = False

    def matches(self, head: bytes, path: Path) -> bool:
        """Return whether a file is of this format beyond doubt, whatever its name; by default that cannot be told.

        Parameters
        ----------
        head : bytes
            Its first 4096 bytes.
        path : pathlib.Path
        """
        return False

    @abstractmethod
    def read(self, path: str | os.PathLike[str], **options: Any) -> OccupancyGrid:
        """Read a file, whose name is the first argument; the others are its options, ``corner_cutting`` among them.

        Raises
        ------
        MapError
            If it cannot be read; the message names the file, and what was expected.
        """

    def query(self, path: str | os.PathLike[str]) -> Query | None:
        """Return what a file names as worth planning, or None; by default files name nothing."""
        return None

    def write(self, path: Path, grid: OccupancyGrid) -> None:
        """Write a grid so that `read` gives it back; by default that is refused.

        Raises
        ------
        MapError
            If the format cannot say what the grid is.
        """
        raise MapError(path, f"maps of the format {self.name!r} are read and not written")

    @property
    def options(self) -> tuple[str, ...]:
        """Names of the options that `read` takes."""
        return tuple(inspect.signature(self.read).parameters)[1:]


#: Map formats by name, those of this package first.
MAP_FORMATS: Registry[type[MapFormat]] = Registry("map format", "pymoo_gridpath.map_formats", MapFormat)


def format_for(path: str | os.PathLike[str]) -> MapFormat:
    """Return the format of a map file that is yet to be written, by its suffix.

    Raises
    ------
    MapError
        If no format has that suffix.
    """
    suffix = Path(path).suffix.lower()
    formats = {ending: cls for cls in reversed(list(MAP_FORMATS.values())) for ending in cls.suffixes}
    if suffix not in formats:
        written = sorted(cls.suffixes[0] for cls in MAP_FORMATS.values() if cls.write is not MapFormat.write)
        raise MapError(path, f"there is no map format of the suffix {suffix!r}, expected one of {', '.join(written)}")
    return formats[suffix]()


def format_of(path: str | os.PathLike[str]) -> MapFormat:
    """Return the format of a map file.

    The formats are asked in turn: the content of the file decides, and of several that it fits the one that has the file's
    suffix; then the suffix alone; text that neither tells is of the format that takes it all.

    Parameters
    ----------
    path : str or path-like

    Returns
    -------
    MapFormat

    Raises
    ------
    MapError
        If there is no such file, or it is of no known format.

    Examples
    --------
    >>> from pymoo_gridpath.maps import shipped_maps
    >>> format_of(shipped_maps()[0].path).name
    'text'
    """
    file = require_file(path)
    try:
        with open(file, "rb") as stream:
            head = stream.read(_HEAD)
    except OSError as error:
        raise MapError(path, f"the file cannot be read ({error.strerror}), expected a readable map file") from None
    formats = [cls() for cls in MAP_FORMATS.values()]
    by_content = [one for one in formats if one.matches(head, file)]
    by_suffix = [one for one in formats if file.suffix.lower() in one.suffixes]
    both = [one for one in by_content if one in by_suffix]
    rest = [one for one in formats if one.catch_all and b"\0" not in head]
    for found in (both, by_content, by_suffix, rest):
        if found:
            return found[0]
    raise MapError(path, "the file is binary and of no known format, expected an image, a NumPy array or text")
