"""The page of a trade-off set as a file: what it holds, read by another parser, and that names in it do nothing."""

import base64
import html.parser
import json
import re
import subprocess
import sys
import zlib
from hashlib import sha256

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from page_sets import HOSTILE, exact_set, grown_set

from pymoo_gridpath import GridPathProblem, OccupancyGrid, TradeOffSet
from pymoo_gridpath.decision.drawn import drawn_field
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.explorer import explore, save_page
from pymoo_gridpath.explorer.data import packed_paths, unpacked_paths


class Elements(html.parser.HTMLParser):
    """The elements of a page, and the texts of its scripts, styles and title."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.texts, self._inside = [], {}, ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        self._inside = dict(attributes).get("id", tag)

    def handle_endtag(self, tag):
        self._inside = ""

    def handle_data(self, text):
        self.texts[self._inside] = self.texts.get(self._inside, "") + text

    @property
    def data(self):
        def refuse(word):
            raise AssertionError(f"{word} is not JSON")

        return json.loads(self.texts["data"], parse_constant=refuse)


def page_of(trade_off, tmp_path, **options):
    file = save_page(trade_off, tmp_path / "front.html", **options)
    assert file == tmp_path / "front.html"
    return Elements(file.read_text(encoding="utf-8"))


def array_of(packed):
    """Unpack an array without the code under test."""
    data = zlib.decompress(base64.b64decode(packed["data"], validate=True))
    assert len(data) == packed["bytes"]
    return np.frombuffer(data, dtype={"u1": "u1", "u4": "<u4", "i2": "<i2"}[packed["kind"]])


@pytest.mark.parametrize("n_obj", [1, 2, 3])
def test_the_page_holds_every_path_and_its_measures(n_obj, tmp_path):
    found = exact_set(n_obj)
    data = page_of(found, tmp_path).data
    counts, starts, steps = (array_of(data[name]) for name in ("counts", "starts", "steps"))
    assert starts.tolist() == [0, 5] * len(found)
    steps = iter(steps.tolist())
    for record, count in zip(found, counts.tolist(), strict=True):
        x, y = 0, 5
        cells = [[x, y]]
        for step in (next(steps) for _ in range(count - 1)):
            # Four bits each, from -8 to 7.
            x += (step % 16 + 8) % 16 - 8
            y += (step // 16 + 8) % 16 - 8
            cells.append([x, y])
        assert cells == record.cells.tolist()
    assert next(steps, None) is None
    columns = {column["key"]: column for column in data["columns"]}
    assert [key for key, column in columns.items() if column["objective"]] == found.objective_names
    for key, scale in (("length", 0.25), ("vulnerability", 1.0), ("turn", 1.0), ("clearance_m", 1.0)):
        np.testing.assert_allclose(columns[key]["values"], found.measures[key] * scale, rtol=1e-6)
    assert "clearance" not in columns and "length_m" not in columns
    assert (columns["length"]["unit"], columns["clearance_m"]["unit"], columns["turn"]["unit"]) == ("m", "m", "\u00b0")
    assert {one["name"]: one["path"] for one in data["names"]} == found.named


def test_the_page_holds_what_grew_apart(tmp_path):
    found = grown_set()
    data, grid = page_of(found, tmp_path).data, found.problem.grid
    grown = np.unpackbits(array_of(data["grown"]), count=grid.occupied.size).reshape(grid.shape).astype(bool)
    np.testing.assert_array_equal(grown, grid.occupied & ~grid.original.occupied)
    clearance = next(column for column in data["columns"] if column["key"] == "clearance_m")
    assert clearance["unit"] == "m" and clearance["values"] == pytest.approx([one.clearance_m for one in found])
    assert page_of(exact_set(), tmp_path).data["grown"] is None


def test_the_page_holds_the_map(tmp_path):
    found = exact_set()
    grid = found.problem.grid
    data = page_of(found, tmp_path).data
    assert data["map"]["size"] == [16, 12] and data["map"]["resolution"] == 0.25
    assert data["map"]["origin"] == [1.5, -2.0, 0.5]
    assert (data["start"], data["goal"]) == ([0, 5], [15, 6])
    np.testing.assert_array_equal(np.unpackbits(array_of(data["occupied"]))[: 16 * 12].reshape(12, 16), grid.occupied)
    field = drawn_field(found, grid.whole)
    free = np.where(grid.occupied, 0, field)
    shown = array_of(data["field"]).reshape(12, 16) / 255 * free.max()
    np.testing.assert_allclose(shown, free, atol=free.max() / 500)


def test_a_map_in_cells_has_no_metres(tmp_path):
    data = page_of(exact_set(resolution=None), tmp_path).data
    assert data["map"]["resolution"] is None
    assert data["columns"][0]["unit"] == "cells" and " m" not in data["summary"]


def test_of_a_large_map_the_part_that_can_be_reached_is_shown(tmp_path):
    occupied = np.ones((400, 300), dtype=bool)
    occupied[100:110, 200:230] = False
    problem = GridPathProblem(OccupancyGrid(occupied, 0.05), (201, 101), (228, 108))
    found = TradeOffSet.from_genes(problem, problem.pareto_set(max_seconds=60))
    data = page_of(found, tmp_path).data
    assert data["map"]["size"] == [32, 12] and data["map"]["corner"] == [199, 99]
    assert data["start"] == [2, 2] and "of which 32 x 12 are shown" in data["summary"]
    for cells, record in zip(unpacked_paths(data), found, strict=True):
        np.testing.assert_array_equal(np.add(cells, [199, 99]), record.cells)


@given(
    st.lists(
        st.tuples(st.integers(0, 500), st.integers(0, 500), st.lists(st.tuples(*[st.integers(-9, 8)] * 2), max_size=9)),
        min_size=1,
        max_size=5,
    )
)
def test_paths_are_unpacked_as_they_were_packed(walks):
    """Whatever their steps; those of more than seven cells are of paths that cross obstacles."""
    paths = [np.cumsum([(x, y), *steps], axis=0) for x, y, steps in walks]
    for given_, found in zip(paths, unpacked_paths(packed_paths(paths)), strict=True):
        np.testing.assert_array_equal(given_, found)


def test_names_are_texts_and_nothing_else(tmp_path):
    found = exact_set(3, HOSTILE, hostile=True)
    page = page_of(found, tmp_path)
    plain = page_of(exact_set(3), tmp_path)
    assert [tag for tag, _ in page.tags] == [tag for tag, _ in plain.tags]
    assert [tag for tag, _ in page.tags].count("script") == 2
    # What breaks lines is shown escaped, as everywhere.
    assert page.texts["title"].startswith("</script><script>") and "\\u2028 @data@" in page.texts["title"]
    assert page.data["columns"][2]["key"] == found.objective_names[2]
    assert page.data["columns"][2]["label"] == "<img src=x onerror='hacked=1'>"
    assert re.fullmatch(r"[A-Za-z0-9._-]+", page.data["file_name"])
    assert page_of(found, tmp_path, title="<i>mine</i>").texts["title"] == "<i>mine</i>"


def test_the_policy_admits_this_script_and_style_and_no_request(tmp_path):
    page = page_of(exact_set(), tmp_path)
    (policy,) = [a["content"] for tag, a in page.tags if a.get("http-equiv") == "Content-Security-Policy"]
    rules = dict(rule.split(" ", 1) for rule in policy.split("; "))
    digest = {kind: base64.b64encode(sha256(page.texts[kind].encode()).digest()).decode() for kind in ("script", "style")}
    assert rules.pop("default-src") == "'none'"
    assert rules.pop("script-src") == f"'sha256-{digest['script']}'"
    assert rules.pop("style-src") == f"'sha256-{digest['style']}'"
    assert set(rules.values()) == {"'none'"}
    assert not [a for _, a in page.tags if {"src", "href"} & set(a)]


def test_paths_across_obstacles_say_so_and_have_no_names(tmp_path):
    walled = np.zeros((6, 12), dtype=bool)
    walled[:5, 5] = True
    problem = GridPathProblem(OccupancyGrid(walled), (0, 0), (11, 0), "integer")
    found = TradeOffSet.from_genes(problem, [[0, 1, -1, *[0] * 8]])
    data = page_of(found, tmp_path).data
    assert data["caution"].startswith("Not feasible: no path is legal") and data["names"] == []
    assert "interfering_cells" in [column["key"] for column in data["columns"]]


def test_numbers_that_are_not_finite_are_null(tmp_path):
    problem = GridPathProblem(OccupancyGrid(np.zeros((5, 5))), (0, 0), (4, 4), "integer")
    data = page_of(TradeOffSet.from_genes(problem, [[0, 1, 1, 1]]), tmp_path).data
    assert {column["key"]: column["values"] for column in data["columns"]}["clearance"] == [None]
    assert data["field"] is None


def test_the_same_set_gives_the_same_bytes(tmp_path):
    one, other = (save_page(exact_set(3), tmp_path / name).read_bytes() for name in ("a.html", "b.html"))
    assert one == other


def test_a_notebook_shows_the_page_in_a_sandbox_and_a_picture_beside_it():
    shown = explore(exact_set(2, HOSTILE), height=500)
    page = Elements(shown._repr_html_())
    (frame,) = [attributes for tag, attributes in page.tags if tag == "iframe"]
    assert frame["sandbox"] == "allow-scripts allow-downloads" and frame["height"] == "500"
    assert frame["srcdoc"] == shown.page and Elements(frame["srcdoc"]).data["map"]["size"] == [16, 12]
    (picture,) = [attributes for tag, attributes in page.tags if tag == "img"]
    assert picture["src"].startswith("data:image/png;base64,")
    assert "script" not in [tag for tag, _ in page.tags]
    assert shown._repr_png_() == exact_set(2, HOSTILE)._repr_png_()
    assert "Explorer of <TradeOffSet" in repr(shown)


@pytest.mark.parametrize("wrong", [None, 3, "paths.json", [1]])
def test_what_is_no_set_is_refused(wrong, tmp_path):
    for make in (explore, lambda paths: save_page(paths, tmp_path / "a.html")):
        with pytest.raises(GridPathError, match=r"trade_off is .*, expected a TradeOffSet"):
            make(wrong)
    assert not (tmp_path / "a.html").exists()


def test_other_arguments_are_refused_in_words(tmp_path):
    with pytest.raises(GridPathError, match="title is 3, expected a text"):
        save_page(exact_set(), tmp_path / "a.html", title=3)
    with pytest.raises(GridPathError, match="height is 20, expected a whole number"):
        explore(exact_set(), height=20)
    with pytest.raises(GridPathError, match="cannot be written"):
        save_page(exact_set(), tmp_path / "none" / "a.html")


def test_a_page_needs_no_matplotlib():
    code = "import sys, pymoo_gridpath.explorer; sys.exit('matplotlib' in sys.modules and 'matplotlib.pyplot' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
