from __future__ import annotations

import pytest

from pymoo_gridpath.errors import MapError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.maps import ScenQuery, movingai, read_movingai, read_scen

SMALL = "type octile\nheight 2\nwidth 4\nmap\n.GS@\nOTW.\n"


def test_rows_are_turned_so_that_y_points_up(write):
    grid = read_movingai(write("small.map", SMALL))
    assert grid.occupied.astype(int).tolist() == [[1, 1, 1, 0], [0, 0, 0, 1]]
    assert grid.is_free((3, 0)) and not grid.is_free((3, 1))
    assert (grid.width, grid.height, grid.name, grid.corner_cutting) == (4, 2, "small", False)


@pytest.mark.parametrize(("letter", "free"), [(".", 1), ("G", 1), ("S", 1), ("W", 0), ("T", 0), ("@", 0), ("O", 0)])
@pytest.mark.parametrize("case", [str.upper, str.lower])
def test_every_terrain(write, letter, free, case):
    letter = case(letter)
    path = write("t.map", f"type octile\nheight 1\nwidth 1\nmap\n{letter}\n")
    assert read_movingai(path).n_occupied == 1 - free


@pytest.mark.parametrize(
    "text",
    [
        SMALL.replace("\n", "\r\n"),
        SMALL + "\n \n",
        SMALL.rstrip("\n"),
        SMALL.replace("height 2\nwidth 4", "width\t4\nheight 2"),
    ],
)
def test_harmless_variations_read_alike(write, text):
    assert read_movingai(write("a.map", text)).occupied.tolist() == read_movingai(write("b.map", SMALL)).occupied.tolist()


def test_options_reach_the_grid(write):
    grid = read_movingai(write("a.map", SMALL), corner_cutting=True, resolution=0.5, origin=(1, 2))
    assert (grid.corner_cutting, grid.resolution, grid.origin) == (True, 0.5, (1.0, 2.0, 0.0))


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("", 1, ["type octile"]),
        (SMALL.replace("octile", "tile"), 1, ["type tile", "type octile"]),
        ("type octile\nheight 2\n", 2, ["width", "map"]),
        (SMALL.replace("height 2", "height two"), 2, ["height", "two", "whole number"]),
        (SMALL.replace("height 2", "height -2"), 2, ["height", "-2"]),
        (SMALL.replace("height 2", "height 0"), None, ["4 x 0"]),
        (SMALL.replace("width 4", "height 2"), 3, ["height 2", "width"]),
        (SMALL.replace("map\n", ""), 4, [".GS@", "map"]),
        (SMALL.replace("height 2", "height 3"), 6, ["2 rows", "3"]),
        (SMALL + "....\n", 7, ["3 rows", "2"]),
        (SMALL.replace(".GS@", ".GS"), 5, ["3 cells", "4"]),
        (SMALL.replace("OTW.", "OTW.."), 6, ["5 cells", "4"]),
        (SMALL.replace("OTW.", "OTq."), 6, ["'q'", "column 3"]),
        (SMALL.replace("height 2", "height 99999999"), None, ["99999999"]),
        (SMALL.replace("height 2", "height " + "9" * 6000), 2, ["whole number"]),
    ],
)
def test_bad_maps_are_refused_with_their_line(write, refused, text, line, words):
    refused(read_movingai, write("bad.map", text), line, *words)


HEADER = "version 1\n"
ENTRY = "3\tmaps/a b.map\t5\t4\t0\t0\t4\t2\t5.82842712\n"


@pytest.mark.parametrize("header", ["version 1\n", "version 1.0\n", "version\t1\r\n", "version 1.0 \n\n"])
def test_queries_are_turned_so_that_y_points_up(write, header):
    (query,) = read_scen(write("a.scen", header + ENTRY))
    # (column, row) from the top left: row 0 of 4 rows is y = 3, row 2 is y = 1.
    assert query == ScenQuery(3, "maps/a b.map", 5, 4, (0, 3), (4, 1), 5.82842712)


def test_spaces_separate_columns_as_well(write):
    entry = "0 m.map 5 4 1 3 2 3 1\n"
    (query,) = read_scen(write("a.scen", HEADER + entry))
    assert query == ScenQuery(0, "m.map", 5, 4, (1, 0), (2, 0), 1.0)


def test_a_scenario_agrees_with_its_map(write):
    grid = read_movingai(write("m.map", "type octile\nheight 3\nwidth 3\nmap\n...\n@@.\n...\n"))
    (query,) = read_scen(write("m.scen", HEADER + "0 m.map 3 3 0 0 0 2 6\n"), grid)
    assert grid.shortest_lengths(query.start)[query.goal[1], query.goal[0]] == query.optimal_length


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("", 1, ["version 1"]),
        ("version 2\n", 1, ["version 2", "version 1"]),
        (ENTRY, 1, ["version 1"]),
        (HEADER + ENTRY + "0 m.map 5 4 1 3 2 3\n", 3, ["8 columns", "9"]),
        (HEADER + "x m.map 5 4 1 3 2 3 1\n", 2, ["bucket", "'x'"]),
        (HEADER + "0 m.map 5 4.5 1 3 2 3 1\n", 2, ["height", "4.5"]),
        (HEADER + "0 m.map 5 0 1 3 2 3 1\n", 2, ["5 x 0"]),
        (HEADER + "0 m.map 5 4 5 3 2 3 1\n", 2, ["start column 5", "5 columns"]),
        (HEADER + "0 m.map 5 4 1 3 2 4 1\n", 2, ["goal column 2", "row 4", "4 rows"]),
        (HEADER + "0 m.map 5 4 1 3 2 -1 1\n", 2, ["goal row", "-1"]),
        (HEADER + "0 m.map 5 4 1 3 2 3 nan\n", 2, ["length", "nan"]),
        (HEADER + "0 m.map 5 4 1 3 2 3 far\n", 2, ["length", "far"]),
    ],
)
def test_bad_scenarios_are_refused_with_their_line(write, refused, text, line, words):
    refused(read_scen, write("bad.scen", text), line, *words)


def test_an_entry_for_another_map_is_refused(write, refused):
    path = write("a.scen", HEADER + "0 m.map 3 2 0 0 1 0 1\n" + ENTRY)
    assert len(read_scen(path)) == 2
    refused(read_scen, path, 3, "5 x 4", "3 x 2", grid=OccupancyGrid([[0, 0, 0], [0, 0, 0]]))


@pytest.mark.parametrize(("reader", "title"), [(read_movingai, b"type octile"), (read_scen, b"version 1")])
def test_text_in_another_encoding_is_refused(write, refused, reader, title):
    refused(reader, write("bad.map", title + b"\nheight \xff\n"), 2, "0xff", "UTF-8")


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(MapError, match=r"no\.map: no such file, expected a map file"):
        read_movingai(tmp_path / "no.map")


def test_a_scenario_may_have_so_many_entries(write, refused, monkeypatch):
    monkeypatch.setattr(movingai, "MAX_QUERIES", 2)
    assert len(read_scen(write("a.scen", HEADER + "\n \n" + ENTRY * 2))) == 2
    refused(read_scen, write("b.scen", HEADER + "\n \n" + ENTRY * 3), 6, "one too many", "at most 2")
    refused(read_scen, write("c.scen", HEADER + "0 " * 6000), 2, "11999 bytes", "at most 10000")
    refused(read_movingai, write("d.map", "type octile\n" + "a " * 6000 + "\n"), 2, "11999 bytes", "at most 10000")
