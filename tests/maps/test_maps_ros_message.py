"""Maps in messages of ROS: as text, as objects of several libraries, and in bags of ROS 1 and 2, written by another library."""

from __future__ import annotations

import array
import math
import sys
from types import SimpleNamespace

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags import rosbag1, rosbag2
from rosbags.typesys import Stores, get_typestore

from pymoo_gridpath import load_map
from pymoo_gridpath.cli import main
from pymoo_gridpath.errors import GridError, MapError
from pymoo_gridpath.maps import format_of, grid_of_message, read_ros_message, read_rosbag, rosbag

TYPE = "nav_msgs/msg/OccupancyGrid"
DATA = [0, 100, -1, 25, 26, 64, 65, 0, 0, 0, 0, 80]


def message_of(store=Stores.ROS2_HUMBLE, data=DATA, width=4, height=3, resolution=0.05, yaw=0.5, place=(1.0, -2.0)):
    """A message of rosbags."""
    types = get_typestore(store).types
    time = types["builtin_interfaces/msg/Time"](sec=3, nanosec=5)
    header = {"stamp": time, "frame_id": "map"} | ({"seq": 7} if store is Stores.ROS1_NOETIC else {})
    turned = types["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=math.sin(yaw / 2), w=math.cos(yaw / 2))
    pose = types["geometry_msgs/msg/Pose"](types["geometry_msgs/msg/Point"](*place, 0.0), turned)
    info = types["nav_msgs/msg/MapMetaData"](time, resolution, width, height, pose)
    return types[TYPE](types["std_msgs/msg/Header"](**header), info, np.array(data, dtype=np.int8))


def text_of(message, **changes):
    """The message as YAML, written by PyYAML."""
    info, pose = message.info, message.info.origin
    parts = {
        "header": {"stamp": {"sec": 3, "nanosec": 5}, "frame_id": "map"},
        "info": {
            "map_load_time": {"sec": 3, "nanosec": 5},
            # Of a message that was sent, as single precision has it.
            "resolution": float(np.float32(info.resolution)),
            "width": info.width,
            "height": info.height,
            "origin": {
                "position": {key: float(getattr(pose.position, key)) for key in "xyz"},
                "orientation": {key: float(getattr(pose.orientation, key)) for key in "xyzw"},
            },
        },
        "data": message.data.tolist(),
    }
    return yaml.safe_dump({**parts, **changes}, sort_keys=False, default_flow_style=False)


def check(grid, unknown="occupied"):
    assert grid.shape == (3, 4) and grid.resolution == 0.05
    assert grid.origin == pytest.approx((1.0, -2.0, 0.5))
    seen = [[0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    not_seen = [[0, 0, 1, 0], [1, 1, 0, 0], [0, 0, 0, 0]]
    assert grid.unknown.astype(int).tolist() == not_seen
    assert grid.occupied.astype(int).tolist() == (np.array(seen) + (unknown == "occupied") * np.array(not_seen)).tolist()


@pytest.mark.parametrize("data", [np.array(DATA, np.int8), DATA, tuple(DATA), array.array("b", DATA)])
def test_objects_of_any_library(data):
    message = message_of()
    message = SimpleNamespace(info=message.info, data=data)
    check(grid_of_message(message))
    check(grid_of_message(message, unknown="free"), "free")


@pytest.mark.parametrize("end", ["", "---\n", "---\nheader: 1\ndata: []\n"])
def test_text(tmp_path, end):
    file = tmp_path / "hall.yaml"
    text = text_of(message_of())
    inline = text_of(message_of(), header={}, data=0).replace("data: 0", f"data: {DATA}")
    wrapped = text_of(message_of(), data=DATA).replace("- ", "  - ")
    first = yaml.safe_dump(yaml.safe_load(text))
    assert first.startswith("data:")
    for one in (text, inline, wrapped, first, "---\n" + text, text.replace("\n", "\r\n"), text.replace("3\n", "3 \n")):
        file.write_bytes((one + end).encode())
        assert format_of(file).name == "ros_message"
        check(load_map(file))
    grid = load_map(file, unknown="free", corner_cutting=True, moves=4)
    check(grid, "free")
    assert (grid.name, grid.corner_cutting, grid.moves) == ("hall", True, 4)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("data:", "date:"), "the key 'data' is missing"),
        (("- 64\n", ""), "the data have 11 values, expected 12"),
        (("- 64\n", "- 64\n- '...'\n"), r"line \d+: the data are cut short by '...', expected all of them: .*--full-length"),
        (("- 64\n", "- 1e3\n"), "the data hold 'e', expected whole numbers"),
        (("- 64\n", "- 6-4\n"), "what is no number"),
        (("- 64\n", "- 101\n"), r"occupancy of cell \(1, 1\) is 101"),
        (("- 64\n", "- 99999999999999999999999\n"), r"occupancy of cell \(1, 1\) is"),
        (("width: 4", "width: 4.0"), "info.width is 4.0, expected a whole number of cells"),
        (("width: 4", "width: 100000"), "the data have 12 values"),
        (("height: 3", "height: 0"), "the map is 4 x 0 cells"),
        (("height: 3", "height: 3000000000"), "the map is 4 x 3000000000 cells, expected at most"),
        (("  width: 4\n", ""), "info.width is None"),
        (("position:", "place:"), "the message has no 'position', expected a nav_msgs/OccupancyGrid"),
        (("x: 0.0", "x: 0.1"), "info.origin is turned by the quaternion"),
        (("x: 0.0", "x: here"), "info.origin is 'here'"),
        (("info:", "info: ["), "the YAML cannot be read"),
    ],
)
def test_texts_that_are_none(tmp_path, change, message):
    file = tmp_path / "hall.yaml"
    text = text_of(message_of())
    assert change[0] in text
    before, _, after = text.rpartition(change[0])
    file.write_text(before + change[1] + after)
    with pytest.raises(MapError, match=message) as caught:
        read_ros_message(file)
    assert "\n" not in str(caught.value) and str(caught.value).startswith(str(file))


def test_messages_that_are_none():
    message = message_of()
    for wrong, words in (
        (None, "message is None, expected a nav_msgs/OccupancyGrid"),
        (SimpleNamespace(info=message.info, data=message.data[:-1]), "data has 11 values, expected 4 x 3 = 12"),
        (SimpleNamespace(info=message.info, data=message.data.astype(float)), "data is an array of float64"),
        (message_of(resolution=math.nan), "resolution is nan"),
        (message_of(place=(math.inf, 0.0)), "info.origin is inf"),
    ):
        with pytest.raises(GridError, match=words):
            grid_of_message(wrong)
    nothing = message_of()
    nothing.info.origin.orientation.w = nothing.info.origin.orientation.z = 0.0
    assert grid_of_message(nothing).origin[2] == 0.0


@settings(max_examples=40)
@given(st.floats(-3.1, 3.1), st.booleans())
def test_the_map_is_turned_as_the_quaternion_says(yaw, other_sign):
    message = message_of(yaw=yaw)
    turned = message.info.origin.orientation
    if other_sign:
        # The same turn.
        turned.z, turned.w = -turned.z, -turned.w
    assert grid_of_message(message).origin[2] == pytest.approx(yaw, abs=1e-12)


# -- bags ---------------------------------------------------------------------------------------------------------------------


def bag_of(path, messages, store=None):
    """A bag of messages by topic, in their order, and its file."""
    first = path.suffix == ".bag"
    store = store or (Stores.ROS1_NOETIC if first else Stores.ROS2_HUMBLE)
    typestore = get_typestore(store)
    plugin = {} if first else {"version": 9, "storage_plugin": getattr(rosbag2.StoragePlugin, path.suffix[1:].upper(), None)}
    if path.suffix == ".db3":
        plugin["storage_plugin"] = rosbag2.StoragePlugin.SQLITE3
    folder = path if first else path.with_suffix("")
    with (rosbag1 if first else rosbag2).Writer(folder, **plugin) as bag:
        connections = {}
        for k, (topic, message) in enumerate(messages):
            msgtype = message.__msgtype__
            if topic not in connections:
                connections[topic] = bag.add_connection(topic, msgtype, typestore=typestore)
            write = typestore.serialize_ros1 if first else typestore.serialize_cdr
            bag.write(connections[topic], k, write(message, msgtype))
    return path if first else next(folder.glob(f"*{path.suffix}"))


def store_of(suffix):
    return Stores.ROS1_NOETIC if suffix == ".bag" else Stores.ROS2_HUMBLE


def other_of(store):
    types = get_typestore(store).types
    return types["std_msgs/msg/String"](data="no map")


@pytest.mark.parametrize("suffix", [".bag", ".mcap", ".db3"])
def test_bags(tmp_path, suffix):
    store = store_of(suffix)
    early, late = message_of(store, data=[0] * 12), message_of(store)
    file = bag_of(tmp_path / f"run{suffix}", [("/talk", other_of(store)), ("/map", early), ("/costs", early), ("/map", late)])
    files = [file] if suffix == ".bag" else [file, file.with_name("metadata.yaml")]
    for one in files:
        assert format_of(one).name == "rosbag"
        check(load_map(one))
        assert load_map(one).name == ("run" if one.name == "metadata.yaml" else one.stem)
        check(load_map(one, unknown="free"), "free")
        assert not read_rosbag(one, topic="/costs").occupied.any()
        for topic in ("/talk", "/nothing"):
            with pytest.raises(MapError, match=f"no map on the topic '{topic}', expected topic=, one of /costs, /map"):
                read_rosbag(one, topic=topic)
        with pytest.raises(MapError, match=r"no map on the topic '\w+\.\.\.\w+', expected topic="):
            read_rosbag(one, topic="long" * 1000)


def test_which_topic_of_several(tmp_path):
    message = message_of(Stores.ROS1_NOETIC)
    check(load_map(bag_of(tmp_path / "one.bag", [("/grid", message)])))
    two = bag_of(tmp_path / "two.bag", [("/b", message), ("/a", message)])
    with pytest.raises(MapError, match="no topic to prefer, expected topic=, one of /a, /b"):
        load_map(two)
    none = bag_of(tmp_path / "none.bag", [("/talk", other_of(Stores.ROS1_NOETIC))])
    with pytest.raises(MapError, match="the bag holds no nav_msgs/msg/OccupancyGrid"):
        load_map(none)


def test_the_command_line_takes_a_topic(tmp_path, capsys):
    message = message_of(Stores.ROS1_NOETIC)
    file = bag_of(tmp_path / "two.bag", [("/b", message), ("/a", message)])
    assert main(["info", str(file)]) == 2 and "expected topic=" in capsys.readouterr().err
    assert main(["info", str(file), "--topic", "/a"]) == 0
    assert "unknown       3 cells" in capsys.readouterr().out


def test_a_damaged_bag_is_not_called_large(tmp_path, monkeypatch):
    file = bag_of(tmp_path / "one.mcap", [("/map", message_of())])
    content = bytearray(file.read_bytes())
    # The length of the first record.
    content[9:17] = bytes(7) + b"\x10"
    file.write_bytes(content)
    with pytest.raises(MapError, match="the bag declares more than it holds, expected a whole bag"):
        load_map(file)
    monkeypatch.setattr(rosbag, "_is_room_for", lambda n_bytes: n_bytes < 2 * len(content))
    with pytest.raises(MemoryError):
        load_map(file)


def test_without_the_library(tmp_path, monkeypatch):
    file = bag_of(tmp_path / "one.bag", [("/map", message_of(Stores.ROS1_NOETIC))])
    monkeypatch.setitem(sys.modules, "rosbags.highlevel", None)
    with pytest.raises(MapError, match=r"rosbags is not installed.*pymoo_gridpath\[ros\]"):
        load_map(file)
