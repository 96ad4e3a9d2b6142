"""Maps in bags of ROS 1 and 2: the messages nav_msgs/OccupancyGrid that were recorded."""

from __future__ import annotations

import importlib
import os
from pathlib import Path
from typing import Any

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridError, MapError
from pymoo_gridpath.grid import CornerCutting, OccupancyGrid
from pymoo_gridpath.maps._files import check_size, check_unknown, require_file
from pymoo_gridpath.maps.formats import MAP_FORMATS, MapFormat
from pymoo_gridpath.maps.ros_message import grid_of_message

_TYPE = "nav_msgs/msg/OccupancyGrid"

# Where a map is published unless somebody decides otherwise.
_USUAL = "/map"

_METADATA = "metadata.yaml"
_MAGIC = (b"#ROSBAG V", b"\x89MCAP0\r\n", b"SQLite format 3\0")


def read_rosbag(
    path: str | os.PathLike[str],
    topic: str | None = None,
    unknown: str = "occupied",
    corner_cutting: CornerCutting = False,
) -> OccupancyGrid:
    """Read the last map that was recorded in a bag of ROS 1 or 2; it needs rosbags, the extra ``ros``.

    Parameters
    ----------
    path : str or path-like
        A ``.bag`` of ROS 1, or the ``.mcap``, ``.db3`` or ``metadata.yaml`` of one of ROS 2, of whose other files some may be
        needed.
    topic : str, optional
        Where it was published; by default ``/map`` if it was there, or else the only topic with maps.
    unknown, corner_cutting
        As of `grid_of_message`.

    Returns
    -------
    OccupancyGrid
        Of the last message of the topic: what is published once is published anew when it changes.

    Raises
    ------
    MapError
        If the bag cannot be read, holds no map, holds several and none on ``/map``, or rosbags is not installed.
    """
    file = require_file(path)
    check_unknown(path, unknown)
    if topic is not None:
        checks.text("topic", topic)
    library = _library(path)
    try:
        message = _last_map(path, file, topic, *library)
    except MapError:
        raise
    except MemoryError:
        # The library makes room for whatever size a damaged bag declares.
        if not _is_room_for(2 * file.stat().st_size):
            raise
        raise MapError(path, "the bag declares more than it holds, expected a whole bag of ROS 1 or 2") from None
    except Exception as error:
        # What is damaged fails in almost any way.
        why = checks.printable(error, 120)
        raise MapError(path, f"the bag cannot be read ({why}), expected a whole bag of ROS 1 or 2") from None
    try:
        return grid_of_message(message, unknown, corner_cutting, file.parent.name if file.name == _METADATA else file.stem)
    except GridError as error:
        raise MapError(path, str(error)) from None


@MAP_FORMATS.register
class RosbagFormat(MapFormat):
    """Maps recorded in bags, see `read_rosbag`."""

    name, suffixes = "rosbag", (".bag", ".mcap", ".db3")
    read = staticmethod(read_rosbag)  # pyright: ignore[reportAssignmentType]

    def matches(self, head, path):
        return head.startswith(_MAGIC) or head.startswith(b"rosbag2_bagfile_information:")


def _is_room_for(n_bytes: int) -> bool:
    try:
        return len(bytearray(n_bytes)) == n_bytes
    except MemoryError:
        return False


def _library(path) -> tuple[Any, Any]:
    """Return the reader of rosbags, and what messages are whose bag does not say it."""
    try:
        reader = importlib.import_module("rosbags.highlevel").AnyReader
        typesys = importlib.import_module("rosbags.typesys")
    except ImportError:
        raise MapError(path, "rosbags is not installed, expected it for bags; pip install 'pymoo_gridpath[ros]'") from None
    return reader, typesys.get_typestore(typesys.Stores.LATEST)


def _last_map(path, file: Path, topic: str | None, reader: Any, typestore: Any) -> Any:
    """Return the last message with a map on a topic."""
    # Of ROS 2, a folder is read by what its description says, and one of its files by itself.
    with reader([file.parent if file.name == _METADATA else file], default_typestore=typestore) as bag:
        with_maps = [one for one in bag.connections if one.msgtype == _TYPE]
        topics = sorted({one.topic for one in with_maps})
        if not topics:
            raise MapError(path, f"the bag holds no {_TYPE}, expected a topic with maps")
        if topic is None:
            topic = _USUAL if _USUAL in topics else topics[0] if len(topics) == 1 else None
        if topic not in topics:
            asked = "there is no topic to prefer" if topic is None else f"there is no map on the topic {checks.shown(topic)}"
            raise MapError(path, f"{asked}, expected topic=, one of {checks.printable(', '.join(topics), 200)}")
        last = None
        for connection, _, data in bag.messages([one for one in with_maps if one.topic == topic]):
            last = connection, data
        if last is None:
            raise MapError(path, f"no message was recorded on the topic {checks.shown(topic)}, expected one with a map")
        message: Any = bag.deserialize(last[1], last[0].msgtype)
        check_size(path, int(message.info.width), int(message.info.height))
        return message
