"""Reading a map of whatever format, or one that ships with the package."""

from __future__ import annotations

import os

from pymoo_gridpath.checks import shown
from pymoo_gridpath.errors import MapError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.grid.arguments import as_moves
from pymoo_gridpath.maps._files import warn
from pymoo_gridpath.maps.formats import format_of
from pymoo_gridpath.maps.shipped import file_of


def load_map(path: str | os.PathLike[str], moves: int | None = None, **options) -> OccupancyGrid:
    """Read a map of any format, or one that ships with the package.

    The format is told by the file's content where that is distinctive (images, NumPy arrays, ``type octile``, a line
    ``image:``), else by its suffix; a file that neither tells is read as plain text. Formats of your own are asked as well,
    see `MapFormat`.

    Parameters
    ----------
    path : str or path-like
        A map file, or the name of a shipped map such as ``"warehouse"``. A file of that name goes first.
    moves : {8, 4}, optional
        How many neighbours a cell has. If not given, the file decides where it says so, else 8.
    **options
        Passed to the reader; None means not given. All readers take ``corner_cutting``; those of formats that say nothing about
        it (all but ROS) take ``resolution``, without which the map is one in cells, and ``origin``; `read_ros` and `read_image`
        take ``unknown``, `read_image` also ``threshold``.

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
    read_movingai, read_ros, read_image, read_npy, read_text, load_shipped, MapFormat

    Examples
    --------
    >>> load_map("warehouse")
    <OccupancyGrid 'warehouse': 60 x 40 cells of 0.5 m, 541 occupied, corners may not be cut>
    """
    file = file_of(path)
    kind = format_of(file)
    given = {key: value for key, value in options.items() if value is not None}
    for key in given:
        if key not in kind.options:
            raise MapError(
                path,
                f"the map format {kind.name!r} does not take the option {shown(key)}, "
                f"expected one of {', '.join(kind.options)}",
            )
    moves = None if moves is None else as_moves(moves)
    grid = kind.read(file, **given)
    if "unknown" in given and grid.unknown is not None and not grid.unknown.any():
        warn(path, "the map has no unknown cell, so that the option 'unknown' has no effect")
    return grid if moves is None else grid.replace(moves=moves)
