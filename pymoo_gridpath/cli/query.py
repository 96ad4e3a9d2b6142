"""What is planned between, and for which robot: options of `pymoo-gridpath plan`, in cells or in metres."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from pymoo_gridpath.cli.arguments import cell, outline, point

if TYPE_CHECKING:
    from pymoo_gridpath.grid import Cell, OccupancyGrid
    from pymoo_gridpath.maps import Query


def add_query(parser: argparse.ArgumentParser) -> None:
    """Add the options by which a query and a robot are given."""
    for role in ("start", "goal"):
        where = "; x to the right, y up, from 0,0 at the bottom left" if role == "start" else ""
        group = parser.add_mutually_exclusive_group()
        group.add_argument(f"--{role}", type=cell, metavar="X,Y", help=f"{role} cell{where}")
        where = ", with its origin and yaw" if role == "start" else ""
        group.add_argument(f"--{role}-m", type=point, metavar="X,Y", help=f"{role} in metres in the frame of the map{where}")
    parser.add_argument(
        "--goal-tolerance",
        type=float,
        default=0.0,
        metavar="M",
        help="where no path leads to the goal, take the nearest cell that can be reached, up to so many metres from it",
    )
    robot = parser.add_mutually_exclusive_group()
    robot.add_argument("--radius", type=float, default=0.0, metavar="M", help="robot radius in metres (default: a point)")
    robot.add_argument(
        "--footprint",
        type=outline,
        metavar="X,Y ...",
        help="corners of the robot in metres, its own origin at 0,0, in quotes: obstacles grow as for a disc out to the "
        "farthest corner, which is safe whichever way it turns",
    )


def grown(grid: OccupancyGrid, arguments) -> OccupancyGrid:
    """Return a map with obstacles grown by the robot."""
    return grid.inflate(arguments.radius, arguments.footprint)


def ends(grid: OccupancyGrid, known: Query, arguments) -> tuple[Cell, Cell]:
    """Return start and goal on a grown map; the same cell if the robot is where it is to go.

    Parameters
    ----------
    grid : OccupancyGrid
    known : Query
        What the map names, where nothing else is said.
    arguments : argparse.Namespace
    """
    from pymoo_gridpath.maps.queries import check_grown, ends_of, goal_near, place_in_metres

    start, goal = arguments.start, arguments.goal
    if arguments.start_m is not None:
        start = place_in_metres(grid, "start", arguments.start_m)
    if arguments.goal_m is None:
        start, goal = ends_of(grid, known, start, goal, option="--")
        if arguments.goal_tolerance == 0:
            return check_grown(grid, start, goal, standing=True)
        target = grid.to_metres(goal).tolist()
    else:
        # Whichever goal the map names, this one is meant.
        start, target = ends_of(grid, known, start, (0, 0), option="--")[0], arguments.goal_m
    start, _ = check_grown(grid, start, start, standing=True)
    return start, goal_near(grid, start, arguments.start_m, target, arguments.goal_tolerance)
