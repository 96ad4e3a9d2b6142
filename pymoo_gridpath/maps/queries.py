"""Queries on maps: what a map names as worth planning, which cells are planned between, and the robot's radius."""

from __future__ import annotations

import os
from collections.abc import Sequence

from pymoo_gridpath.errors import GridError
from pymoo_gridpath.grid import Cell, OccupancyGrid
from pymoo_gridpath.maps.formats import Query, format_of
from pymoo_gridpath.maps.shipped import file_of


def query_of(path: str | os.PathLike[str]) -> Query:
    """Return what a map names as worth planning: start, goal and radius, as far as it names them.

    Parameters
    ----------
    path : str or path-like
        A map file or the name of a shipped map, as in `load_map`.

    Returns
    -------
    Query

    Raises
    ------
    MapError
        If there is no such file or map, or it cannot be read.

    Examples
    --------
    >>> query_of("paper16")
    Query(start=(0, 0), goal=(15, 15), radius=0.0)
    """
    file = file_of(path)
    return format_of(file).query(file) or Query()


def ends_of(
    grid: OccupancyGrid,
    known: Query,
    start: Sequence[int] | None = None,
    goal: Sequence[int] | None = None,
    option: str = "",
) -> tuple[Cell, Cell]:
    """Return start and goal: those given, else those that the map names.

    Parameters
    ----------
    grid : OccupancyGrid
    known : Query
        What the map names, see `query_of`.
    start, goal : (int, int), optional
    option : str, default ""
        What stands before the words start and goal where the user gives them, such as ``"--"``.

    Raises
    ------
    GridError
        If neither says one of them.
    """
    ends = {"start": start or known.start, "goal": goal or known.goal}
    missing = " and ".join(f"{option}{role}" for role, cell in ends.items() if not cell)
    if missing:
        raise GridError(
            f"the map {grid.name!r} needs {missing}, expected a cell x,y with x from 0 to {grid.width - 1} "
            f"and y from 0 (bottom) to {grid.height - 1}"
        )
    return ends["start"], ends["goal"]  # pyright: ignore[reportReturnType]


def check_grown(grown: OccupancyGrid, radius: float, start: Sequence[int], goal: Sequence[int]) -> tuple[Cell, Cell]:
    """Check a query on a grid whose obstacles were grown by a robot's radius in metres, as `OccupancyGrid.check_query`."""
    try:
        return grown.check_query(start, goal)
    except GridError as error:
        raise type(error)(f"with obstacles grown by the robot's radius of {radius:g} m, {error}") from None
