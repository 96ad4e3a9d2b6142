from __future__ import annotations

import math
import struct

import numpy as np
import pytest

from pymoo_gridpath.errors import MapError, MapWarning
from pymoo_gridpath.maps import read_ros
from pymoo_gridpath.maps.image import Pixels

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
    for yes in ("1", "true", "2", "-1", "0x1", "010", "'1'", "+1", "y", "Yes", "ON", "TRUE"):
        assert states(ros(EDGES, negate=yes)) == "...???###", yes
    for no in ("0", "false", "00", "0x0", '"0"', "n", "N", "No", "OFF", "False", "-0"):
        assert states(ros(EDGES, negate=no)) == "###???...", no


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


def test_colours_become_grey_by_luminance(ros, png):
    # Values by the map server's loader. Yellow, green, red, blue, cyan, grey, with its usual thresholds:
    colours = bytes([255, 255, 0, 0, 255, 0, 255, 0, 0, 0, 0, 255, 0, 255, 255, 205, 205, 205])
    usual = {"occupied_thresh": "0.65", "free_thresh": "0.196"}
    assert states(ros(data=png(6, 1, 8, 2, [colours]), **usual)) == ".?##??"
    # Luminances just below a whole number are rounded up where 16 bits a value round them up: 8.999 and 65.999.
    colours = bytes([0, 13, 12, 42, 79, 62, 0, 0, 255, 0, 168, 0, 255, 0, 0, 100, 100, 100, 0, 170, 0])
    grey = Pixels(np.frombuffer(colours, np.uint8).reshape(1, 7, 3), 255).grey()
    assert grey.tolist() == [[9, 66, 29, 98, 76, 100, 99]]


def test_sixteen_bits_are_cut_to_eight(ros, png):
    # Grey x is x // 257; of 8 bits, 51 is the last that is occupied and 204 the first that is free.
    values = (51 * 257 - 1, 51 * 257, 51 * 257 + 256, 52 * 257, 204 * 257 - 1, 204 * 257)
    assert states(ros(data=png(6, 1, 16, 0, [struct.pack(">6H", *values)]))) == "###??."


def test_thresholds_are_compared_in_single_precision(ros):
    # 1 - 205 / 255 is 0.19607843... In double precision it lies above a threshold of 0.196078431, in single it equals it.
    row = (200, 204, 205, 206)
    assert states(ros(row, free_thresh="0.196078431")) == "??.."
    assert states(ros(row, free_thresh="0.19607")) == "???."


def test_equal_and_crossed_thresholds_are_free_first(ros):
    # p = 0.5 lies between x = 127 and 128; p is 0.6 at x = 102.
    assert states(ros((126, 127, 128, 129), occupied_thresh="0.5", free_thresh="0.5")) == "##.."
    for mode in ("trinary", "scale"):
        assert states(ros((101, 102, 103), occupied_thresh="0.6", free_thresh="0.6", mode=mode)) == "#.."
        assert states(ros((0, 76, 77, 254), occupied_thresh="0.3", free_thresh="0.7", mode=mode)) == "##.."


ROW = (0, 52, 204, 205, 230, 254, 255)
PLAIN = """image: row.pgm
mode: trinary
resolution: 0.05
origin: [0.0, 0.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""


# The values are those of the map server's own loader with yaml-cpp 0.7.
@pytest.mark.parametrize(
    ("text", "resolution", "x", "cells"),
    [
        (PLAIN, 0.05, 0, "##??..."),
        (PLAIN.replace("resolution: 0.05", "resolution:\t0.05"), 0.05, 0, "##??..."),
        (PLAIN.replace(": ", ": \t"), 0.05, 0, "##??..."),
        (PLAIN.replace("\n", "\t\n").replace("0.65\t", "0.65\t# half"), 0.05, 0, "##??..."),
        (PLAIN.replace("[0.0, 0.0, 0.0]", "\n  -\t1\n  - 2\n  - 3"), 0.05, 1, "##??..."),
        (PLAIN.replace("0.65", "0.5").replace("0.196", "0.5"), 0.05, 0, "##....."),
        (PLAIN.replace("negate: 0", 'negate: "0"'), 0.05, 0, "##??..."),
        (PLAIN.replace("negate: 0", "negate: n"), 0.05, 0, "##??..."),
        (PLAIN + "---\n" + PLAIN.replace("0.05", "0.1"), 0.05, 0, "##??..."),
        (PLAIN + "---\nbroken: [\n", 0.05, 0, "##??..."),
        (PLAIN.replace("[0.0,", "[010,"), 0.05, 10, "##??..."),
        (PLAIN.replace("[0.0,", "[09,"), 0.05, 9, "##??..."),
        (PLAIN.replace("trinary", "Trinary"), 0.05, 0, "##??..."),
        (PLAIN.replace("trinary", "RAW"), 0.05, 0, ".#?????"),
        (PLAIN.replace("0.05", "!!str 0.05"), 0.05, 0, "##??..."),
        (PLAIN.replace("0.05", "'5.e-2 '"), 0.05, 0, "##??..."),
        ("\ufeff--- # comment\n" + PLAIN.replace("\n", "\r\n"), 0.05, 0, "##??..."),
        ("{" + PLAIN.strip().replace("\n", ",\n\t") + "}", 0.05, 0, "##??..."),
        (PLAIN + "about: {when: 2001-99-99, who: [a, b]}\nwhat: !thing x\n1: 2\n", 0.05, 0, "##??..."),
    ],
)
def test_the_yaml_is_read_as_yaml_cpp_reads_it(write, text, resolution, x, cells):
    write("row.pgm", b"P5\n7 1\n255\n" + bytes(ROW))
    path = write("m.yaml", text)
    grid = read_ros(path)
    assert (grid.resolution, grid.origin[0], states(path)) == (resolution, x, cells)


@pytest.mark.parametrize(
    ("text", "lines", "values"),
    [
        ("negate: 1\n" + PLAIN, (1, 6), ("'1'", "'0'")),
        ("resolution: 0.1\n" + PLAIN, (1, 4), ("'0.1'", "'0.05'")),
        (PLAIN + '\n"mode": raw\n', (2, 9), ("'trinary'", "'raw'")),
        (PLAIN + "origin: [1, 2,\n  3]\n", (4, 8), ("'[0.0, 0.0, 0.0]'", "3]")),
    ],
)
def test_a_key_that_stands_twice_is_refused_with_both_lines(write, refused, text, lines, values):
    write("row.pgm", b"P5\n7 1\n255\n" + bytes(ROW))
    words = [f"stands in line {lines[0]} as {values[0]} and again in line {lines[1]} as", values[1]]
    refused(read_ros, write("m.yaml", text), lines[1], *words)


def test_a_yaml_file_that_cannot_be_one_of_a_map_is_refused_unread(write, refused):
    for text in ("image: m.pgm\n" + "[" * 70_000, "image: m.pgm\nx: " + "{a: [" * 500_000):
        refused(read_ros, write("bad.yaml", text), None, f"{len(text)} bytes", "at most 65536")


def test_unknown_cells_are_kept(ros, png):
    path = ros(EDGES)
    for choice in ("free", "occupied"):
        grid = read_ros(path, unknown=choice)
        assert grid.unknown.tolist() == [[letter == "?" for letter in "###???..."]]
        assert (grid.occupied[grid.unknown] == (choice == "occupied")).all()
    rows = [bytes([0, 0]), bytes([128, 255])]
    assert read_ros(ros(data=png(2, 2, 8, 0, rows))).unknown.tolist() == [[True, False], [False, False]]


@pytest.mark.parametrize(
    ("values", "changes", "said"),
    [
        ((0, 205, 205, 254), {"free_thresh": "0.25"}, ["2 cells", "205", "count as free", "free_thresh is 0.25", "0.196 "]),
        ((205,), {"free_thresh": "0.1961"}, ["1 cell ", "counts as free"]),
        ((0, 205, 254), {"free_thresh": "0.196"}, None),
        ((0, 205, 254, 255), {"free_thresh": "0.25"}, None),
        ((0, 254), {"free_thresh": "0.25"}, None),
        ((0, 205, 254), {"free_thresh": "0.25", "mode": "scale"}, None),
        ((0, 205, 254), {"free_thresh": "0.25", "negate": "1"}, None),
    ],
)
def test_a_threshold_that_makes_saved_unknown_cells_free_is_said(ros, recwarn, values, changes, said):
    path = ros(values, **changes)
    read_ros(path)
    found = [item for item in recwarn if item.category is MapWarning]
    assert all(item.filename == __file__ for item in found)
    messages = [str(item.message) for item in found]
    assert len(messages) == (said is not None)
    for message in messages:
        assert message.startswith(f"{path}: ") and all(word in message for word in said)


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
        ("resolution", "true", 2, ["'true'"]),
        ("resolution", "0x10", 2, ["'0x10'"]),
        ("resolution", "1_0", 2, ["'1_0'"]),
        ("resolution", "1:30", 2, ["'1:30'"]),
        ("resolution", "' 1'", 2, ["positive"]),
        ("resolution", "\u0663", 2, ["positive"]),
        ("resolution", "1e400", 2, ["positive"]),
        ("resolution", "~", 2, ["'~'"]),
        ("resolution", "[1]", 2, ["[1]"]),
        ("origin", "0", 3, ["[x, y, yaw]"]),
        ("origin", "[0, 0]", 3, ["[0, 0]", "[x, y, yaw]"]),
        ("origin", "[0, 0, north]", 3, ["north"]),
        ("negate", "1.0", 4, ["'1.0'", "0 or 1"]),
        ("negate", "08", 4, ["0 or 1"]),
        ("negate", "2147483648", 4, ["0 or 1"]),
        ("negate", "t", 4, ["0 or 1"]),
        ("negate", "yES", 4, ["0 or 1"]),
        ("negate", "", 4, ["''", "0 or 1"]),
        ("negate", "[]", 4, ["0 or 1"]),
        ("occupied_thresh", "65", 5, ["from 0 to 1"]),
        ("occupied_thresh", "", 5, ["''"]),
        ("free_thresh", "-0.1", 6, ["from 0 to 1"]),
        ("mode", "binary", 7, ["binary", "trinary, scale, raw"]),
        ("mode", "[1]", 7, ["trinary, scale, raw"]),
        ("mode", "'raw '", 7, ["trinary, scale, raw"]),
        ("mode", "", 7, ["trinary, scale, raw"]),
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
        ("image: " + "[" * 1000, None),
        ("image: \0\n", None),
    ],
)
def test_broken_yaml_is_refused(write, refused, text, line):
    refused(read_ros, write("bad.yaml", text), line, "YAML")


@pytest.mark.parametrize("image", ["!!python/object/apply:os.getcwd []", "2001-99-99", "{a: b}", "null"])
def test_tags_and_types_of_plain_words_mean_nothing(write, refused, image):
    refused(read_ros, write("bad.yaml", f"image: {image}\n"), 1, "image")


def test_an_unknown_choice_is_refused(ros, refused):
    refused(read_ros, ros(), None, "unknown", "'maybe'", "'occupied' or 'free'", unknown="maybe")


def test_messages_stay_short(write):
    doubled = "".join(f"a{k}: &a{k} [*a{k - 1}, *a{k - 1}]\n" for k in range(1, 40))
    for image in ("*a39", "[" + "1, " * 5000 + "1]", "{" + ", ".join(f"k{k}: {'v' * 99}" for k in range(50)) + "}"):
        path = write("bad.yaml", f"a0: &a0 [1]\n{doubled}image: {image}\n")
        with pytest.raises(MapError, match="the name of an image file") as caught:
            read_ros(path)
        assert len(caught.value.message) < 500
