from __future__ import annotations

import numpy as np
import pytest

from pymoo_gridpath.maps import TextHeader, _files, load_map, read_text, read_text_header

HEADER = """name: yard
title: A yard: with a colon
resolution: 0.25
origin: 1, -2.5 0.5
corner_cutting: true
start: 0 0
goal: 2, 1
radius: 0.1

"""
ROWS = "#..\n.@.\n"


def test_the_first_row_is_the_top_one(write):
    grid = read_text(write("m.txt", "#X@1.\n.0000\n"))
    assert grid.occupied.astype(int).tolist() == [[0, 0, 0, 0, 0], [1, 1, 1, 1, 0]]
    assert (grid.name, grid.resolution, grid.origin, grid.corner_cutting) == ("m", None, (0.0, 0.0, 0.0), False)


def test_the_header_describes_the_grid_and_a_query(write):
    path = write("m.txt", HEADER + ROWS)
    grid = read_text(path)
    assert (grid.name, grid.resolution, grid.origin, grid.corner_cutting) == ("yard", 0.25, (1.0, -2.5, 0.5), True)
    assert grid.occupied.astype(int).tolist() == [[0, 1, 0], [1, 0, 0]]
    expected = TextHeader("yard", "A yard: with a colon", 0.25, (1.0, -2.5, 0.5), True, (0, 0), (2, 1), 0.1)
    assert read_text_header(path) == expected


def test_options_go_before_the_header(write):
    grid = read_text(write("m.txt", HEADER + ROWS), corner_cutting=False, resolution=3, origin=(7, 8, 9))
    assert (grid.corner_cutting, grid.resolution, grid.origin) == (False, 3.0, (7.0, 8.0, 9.0))


def test_the_header_says_what_steps_there_are(write):
    path = write("m.txt", "corner_cutting: one side\nmoves: 4\n" + ROWS)
    assert (read_text(path).corner_cutting, read_text(path).moves) == ("one side", 4)
    assert (load_map(path).moves, load_map(path, moves=8).moves) == (4, 8)


def test_without_a_header_all_of_it_is_none(write):
    assert read_text_header(write("m.txt", ROWS)) == TextHeader()


@pytest.mark.parametrize("text", [ROWS.replace("\n", "\r\n"), ROWS.rstrip(), ROWS + "\n\n  \n", "\n\n" + ROWS, "\ufeff" + ROWS])
def test_harmless_variations_read_alike(write, text):
    assert read_text(write("m.txt", text)).occupied.astype(int).tolist() == [[0, 1, 0], [1, 0, 0]]


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("", None, ["no row"]),
        ("name: x\n\n", None, ["no row"]),
        ("...\n....\n", 2, ["4 cells", "3"]),
        ("...\n..\n...\n", 2, ["2 cells", "3"]),
        ("...\n\n...\n", 2, ["0 cells", "3"]),
        ("...\n.?.\n", 2, ["'?'", "column 2", "#"]),
        (". .\n...\n", 1, ["' '", "column 2"]),
        ("name: x\n...\n..é\n", 3, ["'é'", "column 3"]),
        ("..\n..\nname: late\n", 3, ["'n'", "column 1"]),
        ("colour: red\n" + ROWS, 1, ["colour", "resolution"]),
        ("name: a\nname: b\n" + ROWS, 2, ["name", "once"]),
        ("name:\n" + ROWS, 1, ["name"]),
        ("resolution: 0\n" + ROWS, 1, ["resolution", "'0'", "positive"]),
        ("resolution: nan\n" + ROWS, 1, ["resolution", "nan"]),
        ("resolution: 1 2\n" + ROWS, 1, ["resolution", "1 2"]),
        ("origin: 1\n" + ROWS, 1, ["origin", "two or three"]),
        ("moves: 6\n" + ROWS, 1, ["moves", "6", "4 or 8"]),
        ("corner_cutting: yes\n" + ROWS, 1, ["corner_cutting", "yes", "true, false or one side"]),
        ("start: 1\n" + ROWS, 1, ["start", "two whole numbers"]),
        ("start: 0.5 1\n" + ROWS, 1, ["start", "two whole numbers"]),
        ("\nstart: 0 1\n" + ROWS, 2, ["start", "0, 1", "free cell"]),
        ("name: x\ngoal: 3 0\n" + ROWS, 2, ["goal", "3, 0", "3 x 2"]),
        ("radius: -1\n" + ROWS, 1, ["radius", "zero or more"]),
    ],
)
def test_bad_maps_are_refused_with_their_line(write, refused, text, line, words):
    refused(read_text, write("bad.txt", text), line, *words)


def test_too_large_maps_are_refused(write, refused, monkeypatch):
    path = write("m.txt", "...\n...\n...\n")
    monkeypatch.setattr(_files, "MAX_CELLS", 8)
    refused(read_text, path, 1, "3 x 3", "at most 8 cells")
    monkeypatch.setattr(_files, "MAX_CELLS", 5)
    refused(read_text, path, None, "12 bytes", "at most 10")


def test_a_bad_option_is_refused(write, refused):
    refused(read_text, write("m.txt", ROWS), None, "resolution", resolution=-1)


@pytest.mark.parametrize("text", ["#.. \n.@.\t\f\n", "#..\n.@. ", "\n \n#..  \n.@.\n"])
def test_blanks_at_the_ends_of_rows_are_ignored(write, text):
    assert read_text(write("m.txt", text)).occupied.astype(int).tolist() == [[0, 1, 0], [1, 0, 0]]


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        (" ..\n...\n", 1, ["' '", "column 1"]),
        ("...  \n. .  \n...\n", 2, ["' '", "column 2"]),
        ("...  \n...\n..  \n", 3, ["2 cells", "3"]),
        ("...\n" * 5 + "....\n..?\n", 6, ["4 cells", "3"]),
        ("...\n" * 5 + "..?\n....\n", 6, ["'?'", "column 3"]),
        ("name: " + "x" * 20_000 + "\n...\n", 1, ["20006 bytes", "at most 10000"]),
        ("start: " + "1" * 4000 + " 0\n...\n", 1, ["start is over 10^15, 0"]),
    ],
)
def test_the_first_bad_line_is_named_whatever_stands_around_it(write, refused, monkeypatch, text, line, words):
    path = write("bad.txt", text)
    for block in (4, 9, 1 << 22):
        monkeypatch.setattr(_files, "BLOCK", block)
        refused(read_text, path, line, *words)


@pytest.mark.parametrize("block", [1, 7, 64])
def test_rows_are_read_alike_in_blocks_of_any_size(write, monkeypatch, block):
    rng = np.random.default_rng(block)
    occupied = rng.random((23, 5)) < 0.4
    rows = ["".join(".#"[int(cell)] for cell in row) + " " * rng.integers(3) for row in occupied[::-1]]
    monkeypatch.setattr(_files, "BLOCK", block)
    assert np.array_equal(read_text(write("m.txt", "\n".join(rows))).occupied, occupied)


def test_empty_lines_by_the_million_are_skipped(write, refused):
    assert read_text(write("m.txt", b"\n" * 5_000_000 + ROWS.encode())).n_occupied == 2
    refused(read_text, write("bad.txt", b"\n" * 5_000_000), None, "no row")
    refused(read_text, write("late.txt", b"\n" * 5_000_000 + b"..\n.\n"), 5_000_002, "1 cells")
