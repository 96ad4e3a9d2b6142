"""Writing a map in one of the formats that are read."""

from __future__ import annotations

import os
from pathlib import Path

from pymoo_gridpath import checks
from pymoo_gridpath.grid import OccupancyGrid, check_grid
from pymoo_gridpath.maps.formats import format_for


def save_map(grid: OccupancyGrid, path: str | os.PathLike[str]) -> Path:
    """Write a map, in the format of the file's suffix, so that `load_map` gives back its cells.

    ==========  ==================================================================================================
    Suffix      What is kept besides the cells
    ==========  ==================================================================================================
    ``.yaml``   ROS: resolution, origin and unknown cells; the image stands beside it, by the same name and ``.pgm``;
                no map in cells
    ``.txt``    plain text: name, resolution, origin, moves, and how corners may be cut
    ``.map``    MovingAI: nothing
    ``.npy``    NumPy: nothing
    ==========  ==================================================================================================

    What a format does not hold is an option of its reader, such as ``resolution``.

    Parameters
    ----------
    grid : OccupancyGrid
    path : str or path-like
        Where there is such a file it is replaced, whole or not at all.

    Returns
    -------
    pathlib.Path
        The file.

    Raises
    ------
    MapError
        If no format that is written has the suffix, or it cannot say what the grid is.
    GridPathError
        If the file cannot be written.

    See Also
    --------
    load_map, MapFormat.write

    Examples
    --------
    >>> import tempfile
    >>> from pymoo_gridpath.maps import load_map
    >>> grid = load_map("paper16")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     same = load_map(save_map(grid, folder + "/mine.txt"))
    >>> bool((same.occupied == grid.occupied).all()), same.corner_cutting
    (True, True)
    """
    check_grid(grid)
    file = Path(checks.file_path("path", path))
    format_for(file).write(file, grid)
    return file
