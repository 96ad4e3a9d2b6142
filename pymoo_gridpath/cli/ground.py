"""The options of `pymoo-gridpath plan` that say what the ground costs."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING

import numpy as np

from pymoo_gridpath.errors import GridPathError, MapError, counted

if TYPE_CHECKING:
    from pymoo_gridpath.grid import OccupancyGrid
    from pymoo_gridpath.objectives import Objective

NODATA = ("refuse", "occupied")


def add_ground(parser: argparse.ArgumentParser) -> None:
    """Add the options by which the ground costs something."""
    group = parser.add_argument_group("the ground, as further objectives")
    group.add_argument(
        "--cost",
        type=weighted_file,
        action="append",
        metavar="FILE[:WEIGHT]",
        help="cost of walking a cell's width in each cell: an array (.npy), a grey image or a GeoTIFF of the map's size; "
        "of several the sum, each times its weight (default: 1)",
    )
    group.add_argument(
        "--terrain",
        type=weights,
        metavar="LETTER=WEIGHT,...",
        help="the same by the letters of a MovingAI map, such as S=3 for the swamp; others cost 1, and water or trees that "
        "have a weight can be crossed",
    )
    group.add_argument("--climb", metavar="FILE", help="heights of the cells in metres; up is dear, down is not")
    group.add_argument(
        "--nodata", choices=NODATA, help="what cells are of which such a file has no data: refused (default), or occupied"
    )


def weighted_file(text: str) -> tuple[str, float]:
    """Return the file and the weight that a text such as "mud.npy:2.5" says."""
    file, colon, tail = text.rpartition(":")
    try:
        weight = float(tail)
    except ValueError:
        # A colon may be part of a name, as on Windows.
        file, weight = text, 1.0
    if not colon:
        file, weight = text, 1.0
    if not (file and math.isfinite(weight) and weight >= 0):
        raise argparse.ArgumentTypeError(f"{text!r} is not FILE or FILE:WEIGHT with a weight of zero or more")
    return file, weight


def weights(text: str) -> dict[str, float]:
    """Return the weights by letters that a text such as "S=3,W=8" says."""
    pairs = [part.split("=") for part in text.split(",")]
    try:
        found = {letter: float(weight) for letter, weight in pairs}
    except ValueError:
        found = {}
    sound = all(len(letter) == 1 and math.isfinite(weight) and weight >= 0 for letter, weight in found.items())
    if len(found) < len(pairs) or not sound:
        raise argparse.ArgumentTypeError(f"{text!r} gives no weights, expected some of zero or more such as S=3,W=8")
    return found


def ground_of(grid: OccupancyGrid, map_name: str, arguments) -> tuple[OccupancyGrid, list[Objective]]:
    """Return the grid on which cells without data may be occupied, and the objectives that the options of `add_ground` name."""
    from pymoo_gridpath.maps import read_raster, read_terrain
    from pymoo_gridpath.maps.shipped import file_of
    from pymoo_gridpath.objectives import Climb, GroundCost

    if arguments.nodata and not (arguments.cost or arguments.climb):
        raise GridPathError("--nodata is for --cost and --climb, expected one of them")
    costs = []
    if arguments.terrain:
        costs.append(read_terrain(file_of(map_name), arguments.terrain))
        grid = grid.replace(occupied=np.isnan(costs[0]))
    rasters = []
    for file, weight in arguments.cost or []:
        rasters.append((file, read_raster(file)))
        costs.append(weight * rasters[-1][1])
    if arguments.climb:
        rasters.append((arguments.climb, read_raster(arguments.climb)))
    for file, values in rasters:
        if values.shape != grid.shape:
            height, width = values.shape
            raise MapError(file, f"it has {width} x {height} cells, expected {grid.width} x {grid.height} as the map")
        missing = ~np.isfinite(values) & ~grid.occupied
        if missing.any() and arguments.nodata != "occupied":
            y, x = np.argwhere(missing)[0]
            raise MapError(
                file,
                f"there is no data in {counted(int(missing.sum()), 'free cell')}, the first ({x}, {y}), expected a "
                f"number in each; --nodata occupied takes such cells for obstacles",
            )
        grid = grid.replace(occupied=grid.occupied | missing)
    objectives: list[Objective] = [GroundCost(sum(costs))] if costs else []
    if arguments.climb:
        objectives.append(Climb(rasters[-1][1]))
    return grid, objectives


def given_ground(arguments) -> dict:
    """Return what was given of these options, for the record."""
    given = {key: getattr(arguments, key) for key in ("cost", "terrain", "climb", "nodata")}
    return {key: value for key, value in given.items() if value is not None}
