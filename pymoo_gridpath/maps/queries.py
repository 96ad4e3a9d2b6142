"""Queries on maps: what a map names as worth planning, which cells are planned between, and the robot's radius."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.checks import shown
from pymoo_gridpath.errors import GridError, UnreachableError
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
            f"the map {shown(grid.name)} needs {missing}, expected a cell x,y with x from 0 to {grid.width - 1} "
            f"and y from 0 (bottom) to {grid.height - 1}"
        )
    return ends["start"], ends["goal"]  # pyright: ignore[reportReturnType]


def check_grown(grown: OccupancyGrid, start: Sequence[int], goal: Sequence[int], standing: bool = False) -> tuple[Cell, Cell]:
    """Check a query on a map, and then on it with its obstacles grown, as `OccupancyGrid.check_query` does.

    Parameters
    ----------
    grown : OccupancyGrid
        The map is its `original`.
    start, goal : (int, int)
    standing : bool, default False
        Whether the goal may be the start.
    """

    def check(grid: OccupancyGrid) -> tuple[Cell, Cell]:
        if standing and tuple(start) == tuple(goal):
            cell = grid.check_cell(start, "start")
            return cell, cell
        return grid.check_query(start, goal)

    check(grown.original)
    try:
        return check(grown)
    except GridError as error:
        raise type(error)(f"with obstacles grown by {robot_of(grown)}, {error}") from None


def robot_of(grown: OccupancyGrid) -> str:
    """Return in words what obstacles were grown by."""
    size = f"{grown.robot_radius:g} {'cells' if grown.resolution is None else 'm'}"
    return f"the robot's radius of {size}" if grown.footprint is None else f"the robot's footprint, which reaches {size}"


# -- in metres ------------------------------------------------------------------------------------------------------------


def query_in_metres(
    grid: OccupancyGrid, start: Sequence[float], goal: Sequence[float], goal_tolerance: float = 0.0
) -> tuple[Cell, Cell]:
    """Return the cells of a query whose ends are points in metres, between which a path leads; both may be the same.

    Parameters
    ----------
    grid : OccupancyGrid
    start, goal : (float, float)
        In the frame of the map, with its origin and yaw.
    goal_tolerance : float, default 0.0
        Where no path leads to the goal, the cell nearest to it that can be reached is taken, if its centre is so near.

    Returns
    -------
    (int, int), (int, int)

    Raises
    ------
    GridError
        If a point is none, or lies outside the map or where the robot cannot be.
    UnreachableError
        If no path leads to the goal, or as near to it as the tolerance says.
    """
    place = place_in_metres(grid, "start", start)
    return place, goal_near(grid, place, start, goal, goal_tolerance)


def place_in_metres(grid: OccupancyGrid, role: str, point: Sequence[float], wanted: np.ndarray | None = None) -> Cell:
    """Return the cell of a point if the robot can be there, or say what is wrong and where it could be.

    Parameters
    ----------
    grid : OccupancyGrid
    role : str
        What the message calls it, "start" or "goal".
    point : (float, float)
    wanted : numpy.ndarray of bool, shape (height, width), optional
        The cells of which the message names the nearest; all that are free by default.
    """
    place = _point(role, point)
    x, y = grid.to_cells(place).tolist()
    if grid.is_free((x, y)):
        return x, y
    near, away = _nearest(grid, place, ~grid.occupied if wanted is None else wanted)
    if not grid.contains((x, y)):
        where = f"lies outside the map {shown(grid.name)}, which {_extent(grid)}"
    elif grid.original.is_free((x, y)):
        where = f"is nearer to an obstacle of the map {shown(grid.name)} than {robot_of(grid)} allows"
    else:
        where = f"lies on an obstacle of the map {shown(grid.name)}"
    hint = "there is no free place" if near is None else f"the nearest place to take is {_said(grid, near)}, {away:.3g} m away"
    raise GridError(f"{role} {_metres(place)} {where}; {hint}")


def goal_near(
    grid: OccupancyGrid, start: Cell, start_m: Sequence[float] | None, goal: Sequence[float], tolerance: float
) -> Cell:
    """Return the cell of a goal in metres, or the nearest to it that can be reached within a tolerance.

    Parameters
    ----------
    grid : OccupancyGrid
    start : (int, int)
    start_m : (float, float), optional
        The point that it was given by.
    goal : (float, float)
    tolerance : float
        Metres.
    """
    point, expected = _point("goal", goal), "a number of metres, zero or more"
    tolerance = checks.number("goal_tolerance", tolerance, 0.0, expected=expected, error=GridError)
    reached = grid.regions == grid.regions[start[1], start[0]]
    x, y = grid.to_cells(point).tolist()
    if grid.is_free((x, y)) and reached[y, x]:
        return x, y
    near, away = _nearest(grid, point, reached)
    assert near is not None  # the start is one
    if away <= tolerance:
        return near
    origin = _said(grid, start) if start_m is None else _metres(_point("start", start_m))
    best = f"the nearest that can is {_said(grid, near)}, {away:.3g} m away"
    if tolerance > 0:
        raise UnreachableError(
            f"no place within the tolerance of {tolerance:g} m of the goal {_metres(point)} can be reached from start "
            f"{origin}; {best}"
        )
    place_in_metres(grid, "goal", goal, reached)
    raise UnreachableError(
        f"goal {_metres(point)} cannot be reached from start {origin} on the map {shown(grid.name)}: obstacles separate them; "
        f"of all places {best}"
    )


def _point(role: str, point: Sequence[float]) -> np.ndarray:
    return checks.array(role, point, (2,), expected="a point (x, y) in metres", finite=True, error=GridError).astype(float)


def _metres(point: np.ndarray) -> str:
    x, y = (f"{value:.10g}" for value in np.round(point, 6) + 0.0)
    return f"({x}, {y}) m"


def _said(grid: OccupancyGrid, cell: Cell) -> str:
    return _metres(grid.to_metres(cell))


def _extent(grid: OccupancyGrid) -> str:
    """Return in words which part of its frame a map covers."""
    corners = grid.to_metres(np.array([(0, 0), (grid.width, 0), (grid.width, grid.height), (0, grid.height)]) - 0.5)
    if grid.origin[2] != 0.0:
        return f"has its corners at {', '.join(map(_metres, corners))}"
    (x0, y0), (x1, y1) = corners[0], corners[2]
    return f"covers x from {x0:.6g} to {x1:.6g} m and y from {y0:.6g} to {y1:.6g} m"


def _nearest(grid: OccupancyGrid, point: np.ndarray, wanted: np.ndarray) -> tuple[Cell | None, float]:
    """Return the cell, of some, whose centre is the nearest to a point, and how many metres it is away."""
    y, x = np.nonzero(wanted)
    if not len(x):
        return None, math.inf
    away = np.hypot(*(grid.to_metres(np.stack([x, y], axis=1)) - point).T)
    # Of those that are as near but for rounding, the first from below, and from the left.
    k = int(away.round(9).argmin())
    return (int(x[k]), int(y[k])), float(away[k])
