"""Map readers, one for each format, and the maps that ship with the package.

`load_map` reads any of them. Readers return an `OccupancyGrid` and raise nothing but `MapError` for a bad file.
"""

from __future__ import annotations

import inspect
import os
import re
from collections.abc import Callable
from pathlib import Path

from pymoo_gridpath import checks
from pymoo_gridpath.errors import MapError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.maps._files import MAX_CELLS, require_file, warn
from pymoo_gridpath.maps.array import MAGIC, read_npy
from pymoo_gridpath.maps.image import read_image
from pymoo_gridpath.maps.movingai import Query, read_movingai, read_scen
from pymoo_gridpath.maps.ros import read_ros
from pymoo_gridpath.maps.shipped import ShippedMap, load_shipped, shipped_maps, shipped_names
from pymoo_gridpath.maps.text import TextHeader, read_text, read_text_header

__all__ = [
    "MAX_CELLS",
    "Query",
    "ShippedMap",
    "TextHeader",
    "load_map",
    "load_shipped",
    "map_format",
    "read_image",
    "read_movingai",
    "read_npy",
    "read_ros",
    "read_scen",
    "read_text",
    "read_text_header",
    "shipped_maps",
]

_IMAGE_MAGIC = re.compile(rb"\x89PNG|GIF8|\xff\xd8\xff|BM|II\*\0|MM\0\*|RIFF....WEBP|P[1-6]\s", re.DOTALL)

_FORMATS: dict[str, Callable[..., OccupancyGrid]] = {
    "a MovingAI map": read_movingai,
    "a ROS map": read_ros,
    "an image": read_image,
    "a NumPy array": read_npy,
    "a plain text map": read_text,
}

_SUFFIXES = {
    ".map": "a MovingAI map",
    ".yaml": "a ROS map",
    ".yml": "a ROS map",
    ".npy": "a NumPy array",
    **dict.fromkeys(
        (".png", ".pgm", ".pbm", ".ppm", ".pnm", ".bmp", ".gif", ".jpg", ".jpeg", ".tif", ".tiff", ".webp"), "an image"
    ),
}


def load_map(path: str | os.PathLike[str], **options) -> OccupancyGrid:
    """Read a map of any format, or one that ships with the package.

    The format is told by the file's content where that is distinctive (images, NumPy arrays, ``type octile``, a line
    ``image:``), else by its suffix; a file that neither tells is read as plain text.

    Parameters
    ----------
    path : str or path-like
        A map file, or the name of a shipped map such as ``"warehouse"``. A file of that name goes first.
    **options
        Passed to the reader; None means not given. All readers take ``corner_cutting``; those of formats that say nothing about
        it (all but ROS) take ``resolution`` and ``origin``; `read_ros` and `read_image` take ``unknown``, `read_image` also
        ``threshold``.

    Returns
    -------
    OccupancyGrid

    Raises
    ------
    MapError
        If there is no such file or map, it cannot be read, or its format does not know an option.

    Warns
    -----
    MapWarning
        If ``unknown`` is given and the map has no unknown cell, and as the readers.

    See Also
    --------
    read_movingai, read_ros, read_image, read_npy, read_text, load_shipped

    Examples
    --------
    >>> load_map("warehouse")
    <OccupancyGrid 'warehouse': 60 x 40 cells of 0.5 m, 541 occupied, corners may not be cut>
    """
    name = checks.file_path("path", path)
    shipped = not os.path.isfile(path) and (name in shipped_names() or _is_bare(name))
    kind = "a plain text map" if shipped else map_format(path)
    reader = _FORMATS[kind]
    options = {key: value for key, value in options.items() if value is not None}
    known = list(inspect.signature(reader).parameters)[1:]
    for key in options:
        if key not in known:
            raise MapError(path, f"{kind} does not take the option {key!r}, expected one of {', '.join(known)}")
    grid = load_shipped(name, **options) if shipped else reader(path, **options)
    if "unknown" in options and grid.unknown is not None and not grid.unknown.any():
        warn(path, "the map has no unknown cell, so that the option 'unknown' has no effect")
    return grid


def _is_bare(name: str) -> bool:
    """Whether a name without such a file is meant as the name of a shipped map."""
    return bool(name) and not os.path.exists(name) and Path(name).name == name and not Path(name).suffix


def map_format(path: str | os.PathLike[str]) -> str:
    """Return the format of a map file in words, such as "a ROS map" or "a plain text map".

    Parameters
    ----------
    path : str or path-like

    Returns
    -------
    str

    Raises
    ------
    MapError
        If there is no such file, or it is of no known format.
    """
    file = require_file(path)
    try:
        with open(file, "rb") as stream:
            head = stream.read(4096)
    except OSError as error:
        raise MapError(path, f"the file cannot be read ({error.strerror}), expected a readable map file") from None
    if head.startswith(MAGIC):
        return "a NumPy array"
    if _IMAGE_MAGIC.match(head):
        return "an image"
    words = head.removeprefix(b"\xef\xbb\xbf").split(maxsplit=2)[:2]
    if words[:1] == [b"type"]:
        return "a MovingAI map"
    if words[:1] == [b"voxel"] or file.suffix.lower() == ".3dmap":
        raise MapError(path, "the file is a voxel map in three dimensions (.3dmap of MovingAI), expected a map in two")
    if words[:1] == [b"version"]:
        raise MapError(path, "the file is a list of queries, expected a map; read_scen reads queries")
    if re.search(rb"^image[ \t]*:", head, re.MULTILINE):
        return "a ROS map"
    if (kind := _SUFFIXES.get(file.suffix.lower())) is not None:
        return kind
    if b"\0" in head:
        raise MapError(path, "the file is binary and of no known format, expected an image, a NumPy array or text")
    return "a plain text map"
