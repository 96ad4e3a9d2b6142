"""The commands `pymoo-gridpath maps` and `info`, and how commands read a map."""

from __future__ import annotations

import argparse
import os
import shutil
import sys
from typing import TYPE_CHECKING

import numpy as np

from pymoo_gridpath import pictures
from pymoo_gridpath.cli.arguments import EXIT_OK
from pymoo_gridpath.errors import visible
from pymoo_gridpath.neighbourhood import MOVES, ONE_SIDE, steps_in_words

if TYPE_CHECKING:
    from pymoo_gridpath.grid import OccupancyGrid


def add_map_commands(commands) -> None:
    """Add the commands `maps` and `info`; each sets ``run``, a function that returns the exit code."""
    maps = commands.add_parser("maps", help="list the shipped maps", description=_maps.__doc__)
    maps.set_defaults(run=_maps)

    info = commands.add_parser("info", help="describe a map file", description=_info.__doc__)
    info.set_defaults(run=_info)
    info.add_argument("map", metavar="MAP", help="map file or name of a shipped map")
    add_reading(info)


# The options, by the names that `load_map` has for them.
_READING = ("resolution", "topic", "unknown", "threshold", "corner_cutting", "moves")


def add_reading(parser: argparse.ArgumentParser) -> None:
    """Add the options by which maps are read."""
    group = parser.add_argument_group("reading the map")
    group.add_argument("--resolution", type=float, metavar="M", help="metres a cell, for maps that do not say")
    group.add_argument(
        "--topic", metavar="NAME", help="where the map of a ROS bag was published (default: /map, or the only one)"
    )
    group.add_argument("--unknown", choices=("free", "occupied"), help="what unknown cells of maps of ROS and images count as")
    group.add_argument(
        "--threshold", type=float, metavar="T", help="grey level below which an image's pixel is occupied, 0 to 1"
    )
    corners = group.add_mutually_exclusive_group()
    corners.add_argument("--corner-cutting", action="store_true", default=None, help="allow diagonal steps past occupied cells")
    corners.add_argument(
        "--one-side",
        dest="corner_cutting",
        action="store_const",
        const=ONE_SIDE,
        help="allow diagonal steps past one occupied cell, not between two",
    )
    group.add_argument("--moves", type=int, choices=MOVES, help="neighbours of a cell: 8, or 4 for no diagonal steps")


def load(name: str, arguments) -> OccupancyGrid:
    """Return the grid of a file or of a shipped map, read with the options that `add_reading` adds."""
    from pymoo_gridpath.maps import load_map

    return load_map(name, **{key: getattr(arguments, key) for key in _READING})


def _maps(arguments) -> int:
    """List the shipped maps with the query that `plan` solves on each by default."""
    from pymoo_gridpath.maps import load_map, shipped_maps

    for item in shipped_maps():
        grid = load_map(item.name)
        print(
            f"{item.name:<12} {grid.width:>3} x {grid.height:<3} {item.title}; from {_text(item.start)} to {_text(item.goal)}"
        )
    return EXIT_OK


def _info(arguments) -> int:
    """Describe a map file as it is read."""
    from pymoo_gridpath.grid.picture import scene_of, unknown_of
    from pymoo_gridpath.maps import query_of

    grid = load(arguments.map, arguments)
    known = query_of(arguments.map)
    occupied = grid.n_occupied
    sizes = np.bincount(grid.regions.ravel())[1:]
    rows = {
        "name": grid.name,
        **_metres_of(grid),
        "occupied": f"{occupied} cells, {occupied / grid.occupied.size:.1%}",
        **({} if (unknown := unknown_of(grid)) is None else {"unknown": unknown}),
        "free regions": f"{len(sizes)}" + (f", the largest of {sizes.max()} cells" if len(sizes) else ""),
        "steps": steps_in_words(grid.moves, grid.corner_cutting),
    }
    if known.start and known.goal:
        rows["query"] = f"from {_text(known.start)} to {_text(known.goal)}, robot radius {known.radius:g} m"
    for key, value in rows.items():
        print(f"{key:<13} {visible(value)}")
    show(scene_of(grid))
    return EXIT_OK


def _metres_of(grid: OccupancyGrid) -> dict[str, str]:
    """Return the size of a map in words, and where it lies if it has metres."""
    size = f"{grid.width} x {grid.height} cells"
    if grid.resolution is None:
        return {"size": size, "resolution": "not stated: a map in cells; --resolution M says the metres a cell"}
    x, y, yaw = grid.origin
    return {
        "size": f"{size}, {grid.width * grid.resolution:g} x {grid.height * grid.resolution:g} m",
        "resolution": f"{grid.resolution:g} m a cell",
        "origin": f"x {x:g} m, y {y:g} m, yaw {yaw:g} rad, the corner of cell 0,0",
    }


def show(scene: pictures.Scene) -> None:
    """Draw a map on standard output if that is a terminal which can; files and pipes get nothing."""
    if not pictures.can_draw(sys.stdout):
        return
    columns, lines = shutil.get_terminal_size()
    colors = not os.environ.get("NO_COLOR")
    print(pictures.half_blocks(scene, columns, max(lines - 4, 8), colors))
    if scene.lines and colors:
        print(pictures.legend(scene))


def _text(cell) -> str:
    return f"{cell[0]},{cell[1]}"
