from __future__ import annotations

import math
import struct

import numpy as np
import pytest

from pymoo_gridpath.errors import MapError
from pymoo_gridpath.maps import read_ros

KEYS = {
    "image": "m.pgm",
    "resolution": "0.5",
    "origin": "[1.0, 2.0, 0.0]",
    "negate": "0",
    "occupied_thresh": "0.8",
    "free_thresh": "0.2",
}


@pytest.fixture
def ros(write):
    """Write a YAML file, with some keys changed or left out (None), and an image of one row."""

    def ros(values=(0, 255), data: bytes | None = None, **changes):
        pgm = f"P5\n{len(values)} 1\n255\n".encode() + bytes(values)
        write(changes.get("image") or "m.pgm", pgm if data is None else data)
        keys = {key: value for key, value in {**KEYS, **changes}.items() if value is not None}
        return write("m.yaml", "".join(f"{key}: {value}\n" for key, value in keys.items()))

    return ros


def states(path) -> str:
    """The first row as letters: # occupied, . free, ? unknown, told by reading the map with both choices for unknown."""
    high, low = read_ros(path, unknown="occupied").occupied[0], read_ros(path, unknown="free").occupied[0]
    assert not (low & ~high).any()
    return "".join("#" if b else "?" if a else "." for a, b in zip(high, low, strict=True))


# With thresholds of 0.8 and 0.2, which are 204 / 255 and 51 / 255 exactly, p = (255 - x) / 255 meets them at x = 51 and 204.
EDGES = (0, 50, 51, 52, 128, 203, 204, 205, 255)


def test_trinary_includes_both_thresholds(ros):
    assert states(ros(EDGES)) == "###???..."
    assert states(ros(EDGES, mode="trinary")) == "###???..."


def test_negate_turns_the_shades_not_the_thresholds(ros):
    for yes in ("1", "true", "yes"):
        assert states(ros(EDGES, negate=yes)) == "...???###"
    assert states(ros(EDGES, negate="false")) == "###???..."


def test_unknown_cells_are_occupied_unless_told_otherwise(ros):
    path = ros((0, 128, 255))
    assert read_ros(path).occupied.tolist() == [[True, True, False]]
    assert read_ros(path, unknown="free").occupied.tolist() == [[True, False, False]]


def test_the_top_row_is_the_highest(ros):
    grid = read_ros(ros(data=b"P5\n3 2\n255\n" + bytes([0, 255, 255, 255, 255, 0])))
    assert grid.occupied.astype(int).tolist() == [[0, 0, 1], [1, 0, 0]]


def test_resolution_origin_and_yaw(ros):
    grid = read_ros(ros(origin=f"[1, 2, {math.pi / 2}]"), corner_cutting=True)
    assert (grid.resolution, grid.origin, grid.corner_cutting, grid.name) == (0.5, (1.0, 2.0, math.pi / 2), True, "m")
    # Turned by 90 degrees, x on the grid points along y of the world: cell (1, 0) lies 0.75 m up and 0.25 m to the left.
    np.testing.assert_allclose(grid.to_metres((1, 0)), (1 - 0.25, 2 + 0.75))


def test_colours_are_averaged(ros, png):
    pixels = bytes([0, 0, 153, 0, 0, 154, 255, 255, 102, 255, 255, 101])
    assert states(ros(data=png(4, 1, 8, 2, [pixels]))) == "#?.?"


def test_sixteen_bits(ros, png):
    # p = (65535 - x) / 65535 meets 0.8 at x = 13107 and 0.2 at x = 52428.
    rows = [struct.pack(">4H", 13107, 13108, 52427, 52428)]
    assert states(ros(data=png(4, 1, 16, 0, rows))) == "#??."


def test_what_is_not_opaque_is_unknown(ros, png):
    rows = [bytes([0, 255, 0, 254, 0, 0, 255, 255, 255, 254, 255, 0])]
    for mode in ("trinary", "scale"):
        assert states(ros(data=png(6, 1, 8, 4, rows), mode=mode)) == "#??.??"
    colours = [bytes([0, 0, 0, 255, 0, 0, 0, 254, 255, 255, 255, 255])]
    assert states(ros(data=png(3, 1, 8, 6, colours))) == "#?."


def test_scale_decides_at_half_of_the_way(ros):
    # Between the thresholds the occupancy is 100 (p - 0.2) / 0.6 percent: 74.5 at x = 90, 49.7 at 128, 49.02 at 129.
    assert states(ros((51, 52, 90, 128, 129, 160, 203, 204), mode="scale")) == "####...."
    # Far-off thresholds move the half: with 0.2 and 1 it lies at p = 0.6, x = 102.
    assert states(ros((0, 1, 101, 102, 104, 105), mode="scale", occupied_thresh="1")) == "####.."


def test_raw_values_are_percent(ros):
    values = (0, 1, 49, 50, 99, 100, 101, 255)
    assert states(ros(values, mode="raw")) == "...###??"
    # Nothing else matters.
    assert states(ros(values, mode="raw", negate="1", occupied_thresh="0.1", free_thresh="0.01")) == "...###??"


def test_raw_of_sixteen_bits(ros, png):
    rows = [struct.pack(">4H", 49 * 257, 50 * 257, 100 * 257, 101 * 257)]
    assert states(ros(data=png(4, 1, 16, 0, rows), mode="raw")) == ".##?"


def test_the_image_is_sought_beside_the_yaml_file(ros, write, tmp_path, monkeypatch):
    (tmp_path / "images").mkdir()
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    path = ros((0, 255, 0), image="images/a.pgm")
    assert read_ros(path).width == 3
    path = ros((0, 255), image=str(tmp_path / "absolute.pgm"))
    assert read_ros(path).width == 2


@pytest.mark.parametrize("resolution", ["5e-2", "'0.05'", ".05", "5.0e-2"])
def test_numbers_as_the_map_server_reads_them(ros, resolution):
    assert read_ros(ros(resolution=resolution)).resolution == 0.05


@pytest.mark.parametrize("key", list(KEYS))
def test_every_key_is_needed(ros, refused, key):
    refused(read_ros, ros(**{key: None}), None, repr(key), "missing")


@pytest.mark.parametrize(
    ("key", "value", "line", "words"),
    [
        ("image", "5", 1, ["5"]),
        ("image", "''", 1, ["existing image"]),
        ("resolution", "fine", 2, ["'fine'", "positive"]),
        ("resolution", "0", 2, ["positive"]),
        ("resolution", "-1", 2, ["positive"]),
        ("resolution", ".inf", 2, ["inf"]),
        ("resolution", "true", 2, ["True"]),
        ("resolution", "[1]", 2, ["[1]"]),
        ("origin", "0", 3, ["[x, y, yaw]"]),
        ("origin", "[0, 0]", 3, ["[0, 0]", "[x, y, yaw]"]),
        ("origin", "[0, 0, north]", 3, ["north"]),
        ("negate", "2", 4, ["0 or 1"]),
        ("negate", "[]", 4, ["0 or 1"]),
        ("occupied_thresh", "65", 5, ["from 0 to 1"]),
        ("occupied_thresh", "", 5, ["None"]),
        ("free_thresh", "-0.1", 6, ["from 0 to 1"]),
        ("free_thresh", "0.8", 6, ["below occupied_thresh", "0.8"]),
        ("free_thresh", "0.9", 6, ["below occupied_thresh", "0.8"]),
        ("mode", "binary", 7, ["binary", "trinary, scale, raw"]),
        ("mode", "[1]", 7, ["trinary, scale, raw"]),
    ],
)
def test_bad_values_are_refused_with_their_line(ros, write, refused, key, value, line, words):
    path = ros()
    keys = {**KEYS, key: value}
    path = write("bad.yaml", "".join(f"{k}: {v}\n" for k, v in keys.items()))
    refused(read_ros, path, line, key, *words)


def test_a_missing_image_is_refused(ros, refused, tmp_path):
    path = ros()
    (tmp_path / "m.pgm").unlink()
    refused(read_ros, path, 1, "m.pgm", "existing image")
    (tmp_path / "m.pgm").mkdir()
    refused(read_ros, path, 1, "m.pgm", "existing image")


def test_a_damaged_image_is_named(ros, tmp_path):
    with pytest.raises(MapError) as caught:
        read_ros(ros(data=b"P5\n2 2\n255\n\0"))
    assert caught.value.path == str(tmp_path / "m.pgm")


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("", None),
        ("just words", None),
        ("- image: m.pgm", None),
        ("image: m.pgm\nresolution: [1, 2\norigin: 0\n", 3),
        ("image: m.pgm\n\tresolution: 1\n", 2),
        ("image: m.pgm\nresolution: &a [*b]\n", 2),
        ("image: !!python/object/apply:os.getcwd []\n", 1),
        ("image: 2001-99-99\n", None),
        ("image: " + "[" * 1000, None),
        ("image: \0\n", None),
    ],
)
def test_broken_yaml_is_refused(write, refused, text, line):
    refused(read_ros, write("bad.yaml", text), line, "YAML")


def test_an_unknown_choice_is_refused(ros, refused):
    refused(read_ros, ros(), None, "unknown", "'maybe'", "'occupied' or 'free'", unknown="maybe")


def test_messages_stay_short(write):
    doubled = "".join(f"a{k}: &a{k} [*a{k - 1}, *a{k - 1}]\n" for k in range(1, 40))
    for image in ("*a39", "[" + "1, " * 5000 + "1]", "{" + ", ".join(f"k{k}: {'v' * 99}" for k in range(50)) + "}"):
        path = write("bad.yaml", f"a0: &a0 [1]\n{doubled}image: {image}\n")
        with pytest.raises(MapError, match="the name of an image file") as caught:
            read_ros(path)
        assert len(caught.value.message) < 500
