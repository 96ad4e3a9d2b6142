"""Maps of the ROS map server: a YAML file that describes an image."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from pymoo_gridpath.errors import MapError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.maps._files import check_unknown, make_grid, read_string, shorten
from pymoo_gridpath.maps.image import Pixels, read_pixels

MODES = ("trinary", "scale", "raw")
UNKNOWN = -1
# An occupancy in percent, which only the modes scale and raw have, is an obstacle from here on.
OCCUPIED_PERCENT = 50


def read_ros(path: str | os.PathLike[str], unknown: str = "occupied", corner_cutting: bool = False) -> OccupancyGrid:
    """Read a map of the ROS map server.

    Values are read as by Navigation2's ``nav2_map_server`` (ROS 2). The occupancy p of a pixel is 1 minus the mean of its
    colour channels (0 for black to 1 for white), or that mean itself if ``negate`` is set. Then, by ``mode``:

    trinary (the default)
        Occupied if p >= ``occupied_thresh``, free if p <= ``free_thresh``, unknown between. A pixel that is not opaque is
        unknown.
    scale
        As trinary, but between the thresholds p is scaled to an occupancy of 0 to 100 percent.
    raw
        The pixel value, 0 to 100, is the occupancy in percent; larger ones are unknown. Thresholds, ``negate`` and
        transparency play no part.

    An occupancy in percent is an obstacle from 50 on.

    Parameters
    ----------
    path : str or path-like
        The YAML file, with the keys image, resolution, origin, negate, occupied_thresh, free_thresh and, if wished, mode. The
        image is sought relative to this file.
    unknown : {"occupied", "free"}, default "occupied"
        What unknown cells are.
    corner_cutting : bool, default False
        Whether a diagonal step may touch an occupied cell.

    Returns
    -------
    OccupancyGrid
        With the file's resolution and origin; the top row of the image is the highest row of the grid.

    Raises
    ------
    MapError
        If a file cannot be read, a key is missing or its value is not what it must be.

    Notes
    -----
    ROS 1 and earlier releases of Navigation2 differ: they compare strictly (p > ``occupied_thresh``, p < ``free_thresh``), so
    a value that equals a threshold is unknown there, and in trinary mode they average the alpha channel with the colours.
    ROS 1 furthermore applies ``negate`` in raw mode and keeps raw values above 100. Recent Navigation2 weighs the colours of a
    coloured image by their brightness instead of taking their mean.
    """
    check_unknown(path, unknown)
    settings = _read_settings(path)
    percent = _occupancy(read_pixels(settings.image), settings)
    occupied = percent >= OCCUPIED_PERCENT
    if unknown == "occupied":
        occupied |= percent == UNKNOWN
    return make_grid(
        path, occupied[::-1], resolution=settings.resolution, origin=settings.origin, corner_cutting=corner_cutting
    )


@dataclass(frozen=True)
class _Settings:
    image: Path
    resolution: float
    origin: tuple[float, ...]
    negate: bool
    occupied_thresh: float
    free_thresh: float
    mode: str


def _occupancy(pixels: Pixels, settings: _Settings) -> np.ndarray:
    """Return the occupancy of every pixel as the map server publishes it: 0 to 100, or -1 where unknown."""
    shade = np.arange(pixels.white + 1)
    if settings.mode == "raw":
        value = np.floor(255 * shade / pixels.white + 0.5)
        return np.where(value <= 100, value, UNKNOWN).astype(np.int8)[pixels.shade]
    p = (shade if settings.negate else pixels.white - shade) / pixels.white
    if settings.mode == "scale":
        ratio = (p - settings.free_thresh) / (settings.occupied_thresh - settings.free_thresh)
        between = np.floor(100 * ratio + 0.5)
    else:
        between = np.full(p.shape, UNKNOWN)
    levels = np.select([p >= settings.occupied_thresh, p <= settings.free_thresh], [100, 0], between).astype(np.int8)
    percent = levels[pixels.shade]
    if pixels.alpha is not None:
        percent[pixels.alpha < pixels.opaque] = UNKNOWN
    return percent


def _read_settings(path) -> _Settings:
    keys = _Keys(path)
    name = keys.get("image", str, "the name of an image file")
    image = Path(path).parent / name
    if not os.path.isfile(image):
        raise keys.error("image", "an existing image file, absolute or relative to this file")
    resolution = keys.number("resolution", "a positive number of metres per cell")
    if resolution <= 0:
        raise keys.error("resolution", "a positive number of metres per cell")
    origin = keys.get("origin", list, "a list [x, y, yaw] of metres and radians")
    pose = tuple(_as_number(value) for value in origin)
    if len(pose) != 3 or not all(map(math.isfinite, pose)):
        raise keys.error("origin", "a list [x, y, yaw] of metres and radians")
    if keys.value("negate") not in (0, 1):
        raise keys.error("negate", "0 or 1")
    free, occupied = (keys.number(key, "a number from 0 to 1") for key in ("free_thresh", "occupied_thresh"))
    for key, value in (("free_thresh", free), ("occupied_thresh", occupied)):
        if not 0 <= value <= 1:
            raise keys.error(key, "a number from 0 to 1")
    if free >= occupied:
        raise keys.error("free_thresh", f"a number below occupied_thresh, which is {occupied:g}")
    mode = keys.values.get("mode", "trinary")
    if mode not in MODES:
        raise keys.error("mode", f"one of {', '.join(MODES)}")
    return _Settings(image, resolution, pose, bool(keys.value("negate")), occupied, free, mode)


class _Keys:
    """The keys of the YAML file with their values and lines."""

    def __init__(self, path):
        self.path = path
        text = read_string(path)
        try:
            node = yaml.compose(text, Loader=yaml.SafeLoader)
            self.values: dict[str, Any] = yaml.safe_load(text)
        except yaml.MarkedYAMLError as error:
            line = None if error.problem_mark is None else error.problem_mark.line + 1
            raise MapError(path, f"the YAML is broken ({error.problem}), expected lines of 'key: value'", line) from None
        except Exception:
            # PyYAML lets errors of other kinds escape, for instance from a date that does not exist or from deep nesting.
            raise MapError(path, "the YAML cannot be read, expected lines of 'key: value'") from None
        if not isinstance(node, yaml.MappingNode) or not isinstance(self.values, dict):
            raise MapError(path, f"the YAML holds {shorten(self.values)}, expected a mapping with the key 'image' and others")
        self.lines = {key.value: key.start_mark.line + 1 for key, _ in node.value if isinstance(key, yaml.ScalarNode)}

    def value(self, key: str) -> Any:
        if key not in self.values:
            raise MapError(self.path, f"the key {key!r} is missing, expected it in the YAML file of a ROS map")
        return self.values[key]

    def get(self, key: str, kind: type, expected: str) -> Any:
        if not isinstance(self.value(key), kind):
            raise self.error(key, expected)
        return self.values[key]

    def number(self, key: str, expected: str) -> float:
        number = _as_number(self.value(key))
        if not math.isfinite(number):
            raise self.error(key, expected)
        return number

    def error(self, key: str, expected: str) -> MapError:
        return MapError(self.path, f"{key} is {shorten(self.values[key])}, expected {expected}", self.lines.get(key))


def _as_number(value: Any) -> float:
    """Return a number, or nan for anything else."""
    # PyYAML reads 5e-2 as text, the map server as a number.
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        return math.nan
    try:
        return float(value)
    except (ValueError, OverflowError):
        return math.nan
