"""Maps of the ROS map server: a YAML file that describes an image."""

from __future__ import annotations

import json
import os
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pymoo_gridpath.checks import shown
from pymoo_gridpath.errors import MapError, counted
from pymoo_gridpath.files import write_whole
from pymoo_gridpath.grid import CornerCutting, OccupancyGrid
from pymoo_gridpath.maps._files import blocks, check_unknown, make_grid, warn
from pymoo_gridpath.maps._ros_yaml import Keys
from pymoo_gridpath.maps.formats import MAP_FORMATS, MapFormat
from pymoo_gridpath.maps.image import Pixels, read_pixels

MODES = ("trinary", "scale", "raw")
UNKNOWN = -1
# What map savers write.
SAVED_OCCUPIED, SAVED_UNKNOWN, SAVED_FREE = 0, 205, 254
# The thresholds under which every reader, old or new, takes these for what they are.
SAVED_OCCUPIED_THRESH, SAVED_FREE_THRESH = 0.65, 0.19
# An occupancy in percent, which only the modes scale and raw have, is an obstacle from here on.
OCCUPIED_PERCENT = 50


def read_ros(path: str | os.PathLike[str], unknown: str = "occupied", corner_cutting: CornerCutting = False) -> OccupancyGrid:
    """Read a map of the ROS map server.

    Values are read as by the current ``nav2_map_server`` (Navigation2 for ROS 2). Colours become grey by their luminance,
    values of more than 8 bits are cut to 8. The occupancy p of a pixel is 1 minus its grey (0 for black to 1 for white), or
    the grey itself if ``negate`` is set, in single precision like the thresholds. Then, by ``mode``:

    trinary (the default)
        Free if p <= ``free_thresh``, else occupied if p >= ``occupied_thresh``, else unknown. A pixel that is not opaque is
        unknown.
    scale
        As trinary, but between the thresholds p is scaled to an occupancy of 0 to 100 percent.
    raw
        The grey, 0 to 255, is the occupancy in percent; above 100 it is unknown. Thresholds, ``negate`` and transparency play
        no part.

    An occupancy in percent is an obstacle from 50 on.

    Parameters
    ----------
    path : str or path-like
        The YAML file, with the keys image, resolution, origin, negate, occupied_thresh, free_thresh and, if wished, mode. The
        image is sought relative to this file.
    unknown : {"occupied", "free"}, default "occupied"
        What unknown cells are.
    corner_cutting : bool or "one side", default False
        Whether a diagonal step may touch an occupied cell.

    Returns
    -------
    OccupancyGrid
        With the file's resolution, origin and unknown cells; the top row of the image is the highest row of the grid.

    Raises
    ------
    MapError
        If a file cannot be read, a key is missing or its value is not what it must be.

    Warns
    -----
    MapWarning
        If the map is one as map savers write them, with 205 for unknown, and its ``free_thresh`` makes these cells free.

    Notes
    -----
    The YAML file is read by the rules of yaml-cpp 0.7: of several documents the first; quoted numbers like others; ``010`` is
    ten; ``negate`` is a whole number, true unless 0, or one of y, yes, true, on, n, no, false, off, in small letters,
    capitals or Capitalised. The case of ``mode`` does not matter. Stricter than there, a key that stands twice is refused, and
    so are thresholds outside 0 to 1, a resolution that is not positive, files of more than 64 KiB, and images that are turned
    by EXIF, which map servers overlook. Pixels that the tag of GDAL in a TIFF calls nodata are treated as transparent.

    Older map servers (ROS 1, Navigation2 up to Iron) differ: they compare strictly (p > ``occupied_thresh``,
    p < ``free_thresh``), occupied first, in double precision and without cutting to 8 bits, so that a value that equals a
    threshold is unknown there. They take the mean of the colours, and in trinary mode average the alpha channel with them.
    ROS 1 furthermore applies ``negate`` in raw mode and keeps raw values above 100.
    """
    check_unknown(path, unknown)
    settings = _read_settings(path)
    pixels = read_pixels(settings.image, turn=False)
    grey = pixels.grey()
    occupied, unseen = _cells(pixels, grey, settings, unknown == "occupied")
    _warn_if_unknown_is_free(path, grey, settings)
    return make_grid(
        path,
        occupied,
        resolution=settings.resolution,
        origin=settings.origin,
        corner_cutting=corner_cutting,
        unknown=unseen,
    )


@MAP_FORMATS.register
class RosFormat(MapFormat):
    """Maps of the ROS map server, see `read_ros`."""

    name, suffixes = "ros", (".yaml", ".yml")
    read = staticmethod(read_ros)  # pyright: ignore[reportAssignmentType]

    def matches(self, head, path):
        # An image may hold such a line as a comment.
        return b"\0" not in head and re.search(rb"^image[ \t]*:", head, re.MULTILINE) is not None

    def write(self, path, grid):
        if grid.resolution is None:
            raise MapError(
                path, f"the grid {shown(grid.name)} is in cells, expected one with a resolution, which a ROS map states"
            )
        image = path.with_suffix(".pgm")
        grey = np.where(grid.occupied[::-1], np.uint8(SAVED_OCCUPIED), np.uint8(SAVED_FREE))
        if grid.unknown is not None:
            grey[grid.unknown[::-1]] = SAVED_UNKNOWN
        # JSON's numbers and texts are those of YAML, but for exponents: those want a point there.
        number = ", ".join(re.sub(r"^(-?\d+)(?=e)", r"\1.0", repr(float(value))) for value in (grid.resolution, *grid.origin))
        resolution, _, origin = number.partition(", ")
        write_whole(image, f"P5\n{grid.width} {grid.height}\n255\n".encode() + grey.tobytes())
        lines = (
            f"image: {json.dumps(image.name)}",
            "mode: trinary",
            f"resolution: {resolution}",
            f"origin: [{origin}]",
            "negate: 0",
            f"occupied_thresh: {SAVED_OCCUPIED_THRESH}",
            f"free_thresh: {SAVED_FREE_THRESH}",
        )
        write_whole(path, "".join(f"{line}\n" for line in lines).encode())


@dataclass(frozen=True)
class _Settings:
    image: Path
    resolution: float
    origin: tuple[float, ...]
    negate: bool
    occupied_thresh: float
    free_thresh: float
    mode: str


def _cells(pixels: Pixels, grey: np.ndarray, settings: _Settings, fill: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return which cells are occupied and which unknown, the bottom row first, read-only; ``fill`` occupies the unknown."""
    levels = _levels(settings)
    occupied, unseen = np.empty(grey.shape, dtype=bool), np.empty(grey.shape, dtype=bool)
    for rows in blocks(*grey.shape):
        percent = levels[grey[rows]]
        if pixels.alpha is not None and settings.mode != "raw":
            percent[pixels.alpha[rows] < pixels.opaque] = UNKNOWN
        unknown = percent == UNKNOWN
        unseen[::-1][rows] = unknown
        occupied[::-1][rows] = (percent >= OCCUPIED_PERCENT) | (unknown & fill)
    occupied.flags.writeable = unseen.flags.writeable = False
    return occupied, unseen


def _levels(settings: _Settings) -> np.ndarray:
    """Return the occupancy of each grey level from 0 to 255, computed in single precision as the map server does."""
    grey = np.arange(256)
    if settings.mode == "raw":
        return np.where(grey <= 100, grey, UNKNOWN).astype(np.int8)
    shade = grey.astype(np.float32) / np.float32(255)
    p = shade if settings.negate else np.float32(1) - shade
    free, occupied = np.float32(settings.free_thresh), np.float32(settings.occupied_thresh)
    if settings.mode == "scale" and settings.free_thresh < settings.occupied_thresh:
        scaled = (p - free) / np.float32(settings.occupied_thresh - settings.free_thresh) * np.float32(100)
        between = np.trunc(scaled) + (scaled - np.trunc(scaled) >= 0.5)
    else:
        between = np.full(p.shape, UNKNOWN)
    # Free goes before occupied, which matters where the thresholds are equal or crossed.
    return np.select([p <= free, p >= occupied], [0, 100], between).astype(np.int8)


def _warn_if_unknown_is_free(path, grey: np.ndarray, settings: _Settings) -> None:
    """Warn of a map as savers write it, whose threshold makes free what was never seen."""
    if settings.mode != "trinary" or _levels(settings)[SAVED_UNKNOWN] != 0:
        return
    n, *known = (int(np.count_nonzero(grey == value)) for value in (SAVED_UNKNOWN, SAVED_OCCUPIED, SAVED_FREE))
    if n and n + sum(known) == grey.size:
        warn(
            path,
            f"{counted(n, 'cell')} of grey {SAVED_UNKNOWN}, which map savers write for unknown, "
            f"{'counts' if n == 1 else 'count'} as free, because free_thresh is {settings.free_thresh:g}; "
            "with 0.196 they would be unknown",
        )


def _read_settings(path) -> _Settings:
    keys = Keys(path)
    image = Path(path).parent / keys.text("image", "the name of an image file")
    if not os.path.isfile(image):
        raise keys.error("image", "an existing image file, absolute or relative to this file")
    metres = "a positive number of metres per cell"
    resolution = keys.number("resolution", metres)
    if resolution <= 0:
        raise keys.error("resolution", metres)
    origin = keys.numbers("origin", 3, "a list [x, y, yaw] of metres and radians")
    negate = keys.flag("negate", "0 or 1, or a word such as false or true")
    free, occupied = (keys.number(key, "a number from 0 to 1") for key in ("free_thresh", "occupied_thresh"))
    for key, value in (("free_thresh", free), ("occupied_thresh", occupied)):
        if not 0 <= value <= 1:
            raise keys.error(key, "a number from 0 to 1")
    one_of = f"one of {', '.join(MODES)}"
    mode = keys.text("mode", one_of).lower() if "mode" in keys else "trinary"
    if mode not in MODES:
        raise keys.error("mode", one_of)
    return _Settings(image, resolution, origin, negate, occupied, free, mode)
