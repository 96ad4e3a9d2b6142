"""Small pictures of grids and paths, for notebooks and terminals."""

import functools
import html.parser
import io
import re
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from page_sets import HOSTILE, exact_set
from PIL import Image

from pymoo_gridpath import GridPathProblem, OccupancyGrid, TradeOffSet, pictures
from pymoo_gridpath.cli.maps import show
from pymoo_gridpath.decision import PathRecord
from pymoo_gridpath.decision.drawn import scene_of
from pymoo_gridpath.grid import Box
from pymoo_gridpath.pictures import Line, Scene
from pymoo_gridpath.plotting import plot_map


def dots_of(picture):
    return np.asarray(Image.open(io.BytesIO(picture)).convert("RGB"))


def gray(color):
    return np.array([*bytes.fromhex(color[1:])])


def random_cells(height, width, seed=0):
    return np.random.default_rng(seed).random((height, width)) < 0.3


@pytest.mark.parametrize("shape", [(1, 1), (3, 7), (32, 32), (300, 20), (320, 320)])
def test_each_cell_is_a_square_of_dots_with_row_0_at_the_bottom(shape):
    occupied = random_cells(*shape)
    dots = dots_of(pictures.png(Scene(occupied)))
    size = len(dots) // shape[0]
    assert dots.shape == (size * shape[0], size * shape[1], 3) and max(dots.shape) <= 320
    middle = dots[size // 2 :: size, size // 2 :: size][::-1]
    inside = np.zeros(shape, dtype=bool)
    inside[1:-1, 1:-1] = True  # the edge has a line
    inside |= size > 2
    dark = (middle == gray(pictures.OCCUPIED)).all(axis=-1)
    np.testing.assert_array_equal(dark[inside], occupied[inside])


def test_thin_walls_and_unknown_cells_stay_in_sight_on_large_maps():
    occupied = np.zeros((1000, 2001), dtype=bool)
    occupied[:, 777] = True
    unknown = np.zeros_like(occupied)
    unknown[500:600, 100:300] = True
    dots = dots_of(pictures.png(Scene(occupied, unknown)))
    assert max(dots.shape) <= 320
    dark = (dots == gray(pictures.OCCUPIED)).all(axis=-1)
    assert dark[1:-1, 777 // 7].all() and dark.sum() == dark.shape[0] - 2
    assert (dots[-550 // 7, 200 // 7] == gray(pictures.UNKNOWN)).all()


def test_paths_and_ends_are_drawn_where_they_are():
    cells = np.array([[0, 2], [1, 2], [2, 2], [3, 2], [4, 2], [5, 3], [6, 4]])
    dots = dots_of(pictures.png(Scene(np.zeros((8, 8), dtype=bool), None, (), [Line(cells, "#0072B2")], (0, 2), (6, 4))))
    blue = np.argwhere((dots == gray("#0072B2")).all(axis=-1))
    rows, columns = 7 - blue[:, 0] // 10, blue[:, 1] // 10
    assert {(2, 2), (3, 2), (5, 3)} <= set(zip(columns.tolist(), rows.tolist(), strict=True))
    assert rows.min() == 2 and columns.max() <= 6
    ink = np.argwhere((dots == gray(pictures.INK)).all(axis=-1)) // 10
    assert {(7 - row, column) for row, column in ink.tolist()} == {(2, 0), (4, 6)}


class Tags(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.found, self.text = [], ""
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.found.append((tag, dict(attributes)))

    def handle_data(self, data):
        self.text += data


@functools.cache
def things():
    found = exact_set(2, HOSTILE)
    crossing = GridPathProblem(OccupancyGrid([[0, 1, 0]] * 3), (0, 0), (0, 2))
    return {
        "grid": found.problem.grid,
        "problem": found.problem,
        "own objective": exact_set(3, HOSTILE, hostile=True).problem,
        "set": found,
        "record": found.knee,
        "record alone": PathRecord(**found.knee.as_dict()),
        "short": TradeOffSet.from_genes(crossing, [[0, 3, 6, 6, 6, 6][: crossing.n_var] + [6] * max(0, crossing.n_var - 6)]),
    }


@pytest.mark.parametrize("kind", ["grid", "problem", "own objective", "set", "record", "record alone", "short"])
def test_everything_shows_itself_in_a_notebook(kind):
    thing = things()[kind]
    text = thing._repr_html_()
    tags = Tags(text)
    (image,) = [attributes for tag, attributes in tags.found if tag == "img"]
    assert image["src"].startswith("data:image/png;base64,") and image["alt"]
    assert {tag for tag, _ in tags.found} <= {"div", "strong", "table", "tr", "th", "td", "img"}
    assert len(text) < 4000 and "b'" not in tags.text
    assert max(dots_of(thing._repr_png_()).shape) <= 320
    assert thing._repr_png_() == thing._repr_png_()


def test_obstacles_are_told_from_what_is_too_near_to_them():
    grid = OccupancyGrid([[0, 0, 0, 0, 0], [0, 0, 1, 0, 0], [0, 0, 0, 0, 0]], 0.5).grow(0.6)
    for thing in (grid, GridPathProblem(grid, (0, 0), (0, 2))):
        picture = Image.open(io.BytesIO(thing._repr_png_())).convert("RGB")
        size = picture.width // 5
        shade = {
            cell: picture.getpixel((int((cell[0] + 0.5) * size), int((2.5 - cell[1]) * size))) for cell in ((2, 1), (1, 1))
        }
        assert shade == {(2, 1): rgb(pictures.OCCUPIED), (1, 1): rgb(pictures.GROWN)}
    scene = pictures.Scene(grid.occupied, grown=grid.grown_cells)
    assert len(set(re.findall(r"48;5;(\d+)", pictures.half_blocks(scene, 10, 10)))) == 3
    assert pictures.half_blocks(scene, 10, 10, colors=False) == pictures.half_blocks(
        pictures.Scene(grid.occupied), 10, 10, colors=False
    )


def rgb(color):
    return tuple(bytes.fromhex(color[1:]))


def test_what_is_said_beside_the_pictures():
    found = exact_set()
    said = Tags(found._repr_html_()).text
    assert f"{len(found)} trade-off paths on room" in said and "knee" in said and f"{found.knee.length_m:.5g}" in said
    assert "16 x 12" in Tags(found.problem.grid._repr_html_()).text
    assert "(0, 5), (15, 6)" in Tags(found.problem._repr_html_()).text
    assert "Path 0 (shortest" in Tags(found.shortest._repr_html_()).text


def test_a_set_of_illegal_paths_says_so():
    walled = np.zeros((6, 12), dtype=bool)
    walled[:5, 5] = True
    problem = GridPathProblem(OccupancyGrid(walled), (0, 0), (11, 0), "integer")
    found = TradeOffSet.from_genes(problem, [[0, 1, -1, *[0] * 8]])
    assert "NOT FEASIBLE: no path is legal" in found._repr_html_() and "knee" not in found._repr_html_()


# -- terminals ----------------------------------------------------------------------------------------------------------------


def read_back(text):
    """Return which cells a text without colours says are occupied."""
    rows = []
    for line in text.split("\n"):
        rows.append([mark in "\u2580\u2588" for mark in line])
        rows.append([mark in "\u2584\u2588" for mark in line])
    width = max(map(len, rows))
    return np.array([row + [False] * (width - len(row)) for row in rows])[::-1]


@pytest.mark.parametrize("shape", [(2, 3), (7, 5), (20, 40)])
def test_two_rows_of_cells_are_a_line_of_blocks(shape):
    occupied = random_cells(*shape)
    occupied[:, -1] = True  # ends of lines are cut where they are free
    found = read_back(pictures.half_blocks(Scene(occupied), 80, 40, colors=False))
    np.testing.assert_array_equal(found[-shape[0] :], occupied)


def test_a_large_map_fits_and_keeps_its_walls():
    occupied = np.zeros((300, 500), dtype=bool)
    occupied[:, 250] = occupied[0] = True
    lines = pictures.half_blocks(Scene(occupied), 60, 20, colors=False).split("\n")
    assert len(lines) <= 20 and max(map(len, lines)) <= 60
    assert all(line[250 // 9] in "\u2588\u2584" for line in lines)


def test_colours_say_the_same_as_blocks():
    found = exact_set()
    scene = scene_of(found)
    text = pictures.half_blocks(scene, 80, 40)
    lines = text.split("\n")
    assert len(lines) == 6 and all(line.endswith("\x1b[0m") for line in lines)
    colors = []
    for line in lines:
        pair, row = None, []
        for part in line.split("\x1b[")[1:]:
            code, _, marks = part.partition("m")
            if code != "0":
                _, _, upper, _, _, lower = code.replace("38;5;", "38;5;").split(";")
                pair = int(upper), int(lower)
                row += [pair] * len(marks)
        colors += [[upper for upper, _ in row], [lower for _, lower in row]]
    colors = np.array(colors)[::-1]
    np.testing.assert_array_equal(colors == 238, scene.occupied)
    knee = next(line for line in scene.lines if "knee" in line.name)
    tint = pictures.nearest_color(knee.color)
    shown = {(x, y) for y, x in np.argwhere(colors == tint).tolist()}
    assert shown and shown <= {tuple(cell) for cell in knee.cells.tolist()}
    assert "knee" in pictures.legend(scene)


def stream(terminal=True, encoding="utf-8"):
    return SimpleNamespace(isatty=lambda: terminal, encoding=encoding)


def test_a_terminal_that_can_is_one_that_knows_blocks(monkeypatch):
    monkeypatch.setenv("TERM", "xterm-256color")
    assert pictures.can_draw(stream())
    assert not pictures.can_draw(stream(terminal=False))
    for encoding in ("ascii", "latin-1", None, "no such"):
        assert not pictures.can_draw(stream(encoding=encoding))
    assert not pictures.can_draw(object()) and not pictures.can_draw(None)
    closed = io.TextIOWrapper(io.BytesIO(), encoding="utf-8")
    closed.close()
    assert not pictures.can_draw(closed)
    monkeypatch.setenv("TERM", "dumb")
    assert not pictures.can_draw(stream())


def test_nothing_is_drawn_in_a_pipe(capsys):
    show(Scene(np.ones((4, 4), dtype=bool)))
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize("plain", [True, False])
def test_a_terminal_gets_the_map_in_its_size(monkeypatch, plain):
    class Terminal(io.StringIO):
        encoding = "utf-8"

        def isatty(self):
            return True

    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "10")
    monkeypatch.setenv("LINES", "30")
    monkeypatch.setenv("NO_COLOR", "1" if plain else "")
    monkeypatch.setattr(sys, "stdout", Terminal())
    show(scene_of(exact_set()))
    text = sys.stdout.getvalue()
    assert ("\x1b[" in text) != plain and ("shortest" in text) != plain
    if plain:
        assert all(len(line) <= 10 for line in text.splitlines()) and "\u2022" in text


def test_unknown_cells_are_told_from_obstacles_and_from_free_cells():
    unknown = np.zeros((3, 5), dtype=bool)
    unknown[0, 4] = unknown[2, 0] = True
    grid = OccupancyGrid([[0, 0, 0, 0, 1], [0, 0, 1, 0, 0], [0, 0, 0, 0, 0]], 0.5, unknown=unknown)
    expected = {(4, 0): pictures.UNSEEN, (2, 1): pictures.OCCUPIED, (0, 2): pictures.UNKNOWN, (3, 2): "#ffffff"}
    for thing in (grid, GridPathProblem(grid, (0, 0), (1, 2))):
        picture = Image.open(io.BytesIO(thing._repr_png_())).convert("RGB")
        size = picture.width // 5
        for (x, y), color in expected.items():
            assert picture.getpixel((int((x + 0.5) * size), int((2.5 - y) * size))) == rgb(color)
    assert "2 cells, 13.3%, taken as free" in Tags(grid._repr_html_()).text
    assert "unknown" not in Tags(OccupancyGrid(grid.occupied)._repr_html_()).text
    scene = pictures.Scene(grid.occupied, grid.unknown)
    assert len(set(re.findall(r"[34]8;5;(\d+)", pictures.half_blocks(scene, 10, 10)))) == 4
    # Without colours, what counts as occupied is.
    assert pictures.half_blocks(scene, 10, 10, colors=False).splitlines()[1][4] == "\u2580"


def test_figures_tell_unknown_cells_that_count_as_occupied():
    unknown = np.zeros((2, 3), dtype=bool)
    unknown[0, 1:] = True
    grid = OccupancyGrid([[1, 1, 0], [0, 0, 0]], unknown=unknown)
    ax = plot_map(grid, potential=False)
    colors = (255 * np.asarray(ax.images[0].get_array())[0]).round().astype(int).tolist()
    assert colors[:2] == [list(rgb(pictures.OCCUPIED)), list(rgb(pictures.UNSEEN))] and colors[2] not in colors[:2]
    assert "unknown, taken as occupied" in ax.get_legend_handles_labels()[1]
    assert "unknown, taken as occupied" not in plot_map(OccupancyGrid(grid.occupied)).get_legend_handles_labels()[1]


def test_a_part_of_a_grid_knows_which_of_its_cells_are_unknown():
    unknown = random_cells(5, 6, seed=3)
    for resolution in (None, 0.5):
        part = OccupancyGrid(random_cells(5, 6), resolution, unknown=unknown).crop(Box(1, 2, 5, 4))
        np.testing.assert_array_equal(part.unknown, unknown[2:4, 1:5])
