"""Messages nav_msgs/OccupancyGrid of ROS as maps: as objects in Python, and as the text that ``ros2 topic echo`` prints."""

from __future__ import annotations

import math
import os
import re
import warnings
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import yaml

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridError, MapError
from pymoo_gridpath.grid import CornerCutting, OccupancyGrid
from pymoo_gridpath.maps._files import check_size, check_unknown, decode, read_text_bytes
from pymoo_gridpath.maps.formats import MAP_FORMATS, MapFormat

# Of what stands beside the data.
_MAX_BYTES = 64 * 1024
_MOST_BYTES = 200_000_000

_NUMBERS = b"0123456789- \t\n"
_TO_BLANKS = bytes.maketrans(b"[],", b"   ")

# How far a map may lean out of the plane, as parts of a unit quaternion: what rounding leaves.
_LEANS = 1e-3


def grid_of_message(
    message: Any, unknown: str = "occupied", corner_cutting: CornerCutting = False, name: str = "map"
) -> OccupancyGrid:
    """Return the map of a message nav_msgs/OccupancyGrid, of ROS 1 or 2, by whatever library it was made.

    Parameters
    ----------
    message : object
        With ``info`` (``resolution``, ``width``, ``height``, ``origin``) and ``data`` as messages of rclpy, rospy and rosbags
        have them: -1 where nothing is known, else 0 to 100 percent, row by row from the bottom. From 65 on a cell is occupied,
        up to 25 free, between them unknown; `OccupancyGrid.from_occupancy` takes other limits.
    unknown : {"occupied", "free"}, default "occupied"
        What unknown cells are.
    corner_cutting : bool or "one side", default False
        Whether a diagonal step may touch an occupied cell.
    name : str, default "map"

    Returns
    -------
    OccupancyGrid
        In the frame of the message; an orientation of four zeros, which is none, turns nothing.

    Raises
    ------
    GridError
        If it is no such message, has another number of values than ``width * height``, or its map leans out of the plane.

    Examples
    --------
    >>> from types import SimpleNamespace as Message
    >>> pose = Message(position=Message(x=1.0, y=2.0, z=0.0), orientation=Message(x=0.0, y=0.0, z=0.0, w=1.0))
    >>> info = Message(resolution=0.05, width=3, height=1, origin=pose)
    >>> grid_of_message(Message(info=info, data=[0, 100, -1])).occupied.tolist()
    [[False, True, True]]
    """
    try:
        info, data = message.info, message.data
        position, turned = info.origin.position, info.origin.orientation
        width, height, resolution = info.width, info.height, info.resolution
        place = [checks.number("info.origin", value, error=GridError) for value in (position.x, position.y)]
        quaternion = [checks.number("info.origin", getattr(turned, key), error=GridError) for key in "xyzw"]
    except AttributeError as error:
        expected = "a nav_msgs/OccupancyGrid with info and data"
        if not hasattr(message, "info"):
            raise GridError(f"message is {checks.shown(message)}, expected {expected}") from None
        raise GridError(f"the message has no {checks.shown(error.name)}, expected {expected}") from None
    width = checks.whole("info.width", width, 1, error=GridError)
    height = checks.whole("info.height", height, 1, error=GridError)
    data = checks.array("data", data, (None,), "iu", expected="whole numbers from -1 to 100, one a cell", error=GridError)
    if len(data) != width * height:
        raise GridError(f"data has {len(data):,} values, expected {width} x {height} = {width * height:,}")
    pose = (*place, _yaw_of(*quaternion))
    return OccupancyGrid.from_occupancy(
        data, width, resolution, pose, unknown=unknown, corner_cutting=corner_cutting, name=name
    )


def _yaw_of(x: float, y: float, z: float, w: float) -> float:
    size = math.hypot(x, y, z, w)
    if size == 0.0:
        return 0.0
    if max(abs(x), abs(y)) > _LEANS * size:
        raise GridError(f"info.origin is turned by the quaternion ({x:g}, {y:g}, {z:g}, {w:g}), expected one about the z axis")
    return 2.0 * math.atan2(z, w) if w >= 0 else 2.0 * math.atan2(-z, -w)


def read_ros_message(
    path: str | os.PathLike[str], unknown: str = "occupied", corner_cutting: CornerCutting = False
) -> OccupancyGrid:
    """Read a message nav_msgs/OccupancyGrid from text, as ``ros2 topic echo`` or ``rostopic echo`` prints it.

    Parameters
    ----------
    path : str or path-like
        YAML with the keys ``info`` and ``data``; of several messages the first is read.
    unknown, corner_cutting
        As of `grid_of_message`.

    Returns
    -------
    OccupancyGrid

    Raises
    ------
    MapError
        If the file cannot be read, is no such message, or its data were cut short, as ``ros2 topic echo`` does unless told
        ``--full-length``: ``ros2 topic echo --once --full-length /map > map.yaml``.
    """
    check_unknown(path, unknown)
    text = read_text_bytes(path, _MOST_BYTES)
    begin = re.search(rb"^data:", text, re.MULTILINE)
    if begin is None:
        raise MapError(path, "the key 'data' is missing, expected a message nav_msgs/OccupancyGrid")
    after = re.search(rb"^[^\s\-\[\]]|^---|^\.\.\.", text[begin.end() :], re.MULTILINE)
    end = len(text) if after is None else begin.end() + after.start()
    # Others of its keys may stand before the data, or after them.
    rest = re.split(rb"^---", text[end:], maxsplit=1, flags=re.MULTILINE)[0]
    info = _info(path, re.sub(rb"\A(---.*\n)?", b"", text[: begin.start()]) + rest)
    _check_info(path, info)
    line = text.count(b"\n", 0, begin.start()) + 1
    info.data = _values(path, text[begin.end() : end], line, info.info.width * info.info.height)
    try:
        return grid_of_message(info, unknown, corner_cutting, Path(path).stem)
    except GridError as error:
        raise MapError(path, str(error)) from None


@MAP_FORMATS.register
class RosMessageFormat(MapFormat):
    """The text of a message nav_msgs/OccupancyGrid, see `read_ros_message`."""

    name, suffixes = "ros_message", (".yaml", ".yml")
    read = staticmethod(read_ros_message)  # pyright: ignore[reportAssignmentType]

    def matches(self, head, path):
        keys = (rb"^info:", rb"^[ \t]+resolution:", rb"^[ \t]+width:")
        return b"\0" not in head and all(re.search(key, head, re.MULTILINE) for key in keys)


def _info(path, text: bytes) -> SimpleNamespace:
    """Return what stands in a message beside the data, as objects."""
    if len(text) > _MAX_BYTES:
        raise MapError(path, f"there are {len(text)} bytes beside the data, expected at most {_MAX_BYTES}")
    try:
        found = yaml.safe_load(decode(path, text))
    except MapError:
        raise
    except Exception:  # PyYAML lets errors of other kinds escape
        raise MapError(path, "the YAML cannot be read, expected a message nav_msgs/OccupancyGrid") from None
    if not isinstance(found, dict):
        raise MapError(path, f"the YAML holds {checks.shown(found)}, expected a message nav_msgs/OccupancyGrid")
    return _as_objects(found)


def _as_objects(value: Any) -> Any:
    if not isinstance(value, dict):
        return value
    return SimpleNamespace(**{str(key): _as_objects(item) for key, item in value.items()})


def _check_info(path, message: SimpleNamespace) -> None:
    """Check the size before the data are looked at."""
    info = getattr(message, "info", None)
    for key in ("width", "height"):
        size = getattr(info, key, None)
        if not isinstance(size, int) or isinstance(size, bool):
            raise MapError(path, f"info.{key} is {checks.shown(size)}, expected a whole number of cells")
    check_size(path, info.width, info.height)  # pyright: ignore[reportOptionalMemberAccess]


def _values(path, text: bytes, line: int, most: int) -> np.ndarray:
    """Return the numbers of a list in YAML, in a line or one a line."""
    # What follows a dash and a blank is an item, where a sign stands before its number.
    text = text.translate(_TO_BLANKS).replace(b"- ", b"  ")
    odd = text.translate(None, _NUMBERS)
    if odd:
        line += text.count(b"\n", 0, text.find(odd[:1]))
        cut = "..." in decode(path, odd[:20], line)
        why = "the data are cut short by '...', expected all of them: ros2 topic echo --full-length" if cut else None
        raise MapError(path, why or f"the data hold {checks.shown(chr(odd[0]))}, expected whole numbers from -1 to 100", line)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            found = np.fromstring(text, dtype=np.int64, sep=" ") if text.strip() else np.empty(0, np.int64)
        except (DeprecationWarning, ValueError):
            raise MapError(path, "the data hold what is no number, expected whole numbers from -1 to 100", line) from None
    if len(found) != most:
        raise MapError(path, f"the data have {len(found):,} values, expected {most:,}, the width times the height", line)
    return found
