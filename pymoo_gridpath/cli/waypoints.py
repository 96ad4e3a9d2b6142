"""Files of waypoints that the command `plan` writes."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from pymoo_gridpath.cli.arguments import above_zero
from pymoo_gridpath.errors import GridPathError, visible
from pymoo_gridpath.progress import say

if TYPE_CHECKING:
    from pymoo_gridpath.grid import OccupancyGrid

# What a file of each format is called, and how it is written.
_FORMATS = {
    "csv": ("waypoints-{}.csv", lambda made, file, speed: made.to_csv(file)),
    "yaml": ("waypoints-{}.yaml", lambda made, file, speed: made.to_nav_path(file)),
    "f1tenth": ("raceline-{}.csv", lambda made, file, speed: made.to_f1tenth(file, speed)),
}
_IN_METRES = ("yaml", "f1tenth")

DEFAULT_SPEED = 1.0


def add_waypoint_options(plan: argparse.ArgumentParser) -> None:
    """Add the options of files of waypoints."""
    group = plan.add_argument_group("waypoints")
    group.add_argument(
        "--waypoints",
        type=_formats,
        default=(),
        metavar="A,B",
        help="write the waypoints of each named path as x,y,yaw (csv), as nav_msgs/Path of ROS 2 (yaml), or as a racing line "
        "(f1tenth)",
    )
    group.add_argument(
        "--spacing",
        type=above_zero,
        metavar="M",
        help="put waypoints so near to each other, in metres; in cells if the map has none",
    )
    group.add_argument(
        "--speed", type=above_zero, metavar="V", help=f"metres per second of racing lines (default: {DEFAULT_SPEED:g})"
    )


def _formats(text: str) -> tuple[str, ...]:
    """Return the formats that a text such as "csv,yaml" names."""
    found = tuple(dict.fromkeys(text.split(",")))
    unknown = [one for one in found if one not in _FORMATS]
    if unknown:
        raise argparse.ArgumentTypeError(f"{unknown[0]!r} is no format of waypoints, expected some of {', '.join(_FORMATS)}")
    return found


def check_waypoint_options(arguments, grid: OccupancyGrid) -> None:
    """Refuse, before the search, what would have no effect or could not be written."""
    if arguments.spacing is not None and not arguments.waypoints:
        raise GridPathError("--spacing is for --waypoints, expected some of " + ", ".join(_FORMATS))
    if arguments.speed is not None and "f1tenth" not in arguments.waypoints:
        raise GridPathError("--speed is for --waypoints f1tenth, expected it among the formats")
    for one in arguments.waypoints:
        if one in _IN_METRES:
            grid.check_resolution(f"--waypoints {one}")


def write_waypoints(trade_off, arguments) -> None:
    """Write the waypoints of the named paths, and say of each how they compare with the path."""
    from pymoo_gridpath.decision import NAMES

    for pattern, _ in _FORMATS.values():
        # Those of an earlier plan would be taken for this one's.
        for name in {*NAMES, *trade_off.named}:
            (arguments.output / pattern.format(name)).unlink(missing_ok=True)
    if not arguments.waypoints:
        return
    if not trade_off.feasible:
        say("no waypoints were written, since no path is legal")
        return
    files: list[Path] = []
    paths: dict[int, list[str]] = {}
    for name, index in trade_off.named.items():
        paths.setdefault(index, []).append(name)
    for index, names in paths.items():
        made = trade_off[index].waypoints(spacing=arguments.spacing)
        print(f"waypoints of the {', '.join(names)} path: {made}")
        for name in names:
            for one in arguments.waypoints:
                file_name, write = _FORMATS[one]
                files.append(write(made, arguments.output / file_name.format(name), arguments.speed or DEFAULT_SPEED))
    print("waypoints: " + ", ".join(visible(file) for file in files))
