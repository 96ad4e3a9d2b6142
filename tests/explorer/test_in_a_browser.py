"""The page of a trade-off set as people use it, in a real Chromium, which is started once; without one all is skipped."""

import base64
import csv
import html
import importlib.util
import io
import itertools
import json
import zlib
from pathlib import Path

import numpy as np
import pytest
from page_sets import HOSTILE, exact_set, grown_set
from PIL import Image

from pymoo_gridpath import GridPathProblem, OccupancyGrid, TradeOffSet
from pymoo_gridpath.explorer import explore, save_page
from pymoo_gridpath.explorer.data import packed_paths

DRIVER = Path(__file__).resolve().parents[2] / "benchmarks" / "chromium.py"


def _driver():
    spec = importlib.util.spec_from_file_location("chromium_driver", DRIVER)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def browser():
    driver = _driver()
    if driver.find_chromium() is None:
        pytest.skip("there is no Chromium on this machine")
    with driver.Chromium() as started:
        yield started


@pytest.fixture
def open_page(browser, tmp_path):
    """Open the page of a set; after the test no page has asked for anything or complained."""
    opened = []

    def open_it(trade_off, link="", **options):
        page = browser.open(save_page(trade_off, tmp_path / "front.html").as_uri() + link, **options)
        opened.append(page)
        return page

    yield open_it
    for page in opened:
        assert page.requests == [(tmp_path / "front.html").as_uri()]
        assert page.complaints == []
        page.close()


def chosen(page):
    return page.run("chosen")


def heading(page):
    return page.run("document.getElementById('chosen').textContent")


def place_of(page, chart, path):
    """Return where a path is on a chart, in the window."""
    return page.run(
        f"(() => {{ const box = {chart}.canvas.getBoundingClientRect(); const [x, y] = {chart}.at({path});"
        " return [box.x + x, box.y + y]; })()"
    )


@pytest.mark.parametrize("n_obj", [1, 2, 3])
def test_every_path_and_measure_arrives(open_page, n_obj):
    found = exact_set(n_obj)
    page = open_page(found)
    assert page.run("Array.from({length: nPaths}, (_, k) => paths.cells(k))") == [record.cells.tolist() for record in found]
    occupied = page.run("Array.from(map.occupied)")
    assert occupied == np.packbits(found.problem.grid.occupied).tolist()
    assert chosen(page) == found.named["knee"] and heading(page).startswith(f"Path {found.named['knee']} \u00b7 ")
    rows = page.run("[...document.querySelectorAll('#measures tbody tr')].map((row) => row.innerText.split('\\t'))")
    assert rows[0][:2] == ["Length", f"{found.knee.length_m:.2f} m"]
    assert page.run("document.getElementById('parallel-section').hidden") == (n_obj < 3)


def test_bytes_are_unpacked_as_zlib_packed_them(open_page):
    page = open_page(exact_set())
    random = np.random.default_rng(1)
    texts = [
        b"",
        b"a",
        b"ab" * 5000,
        bytes(70_000),
        random.bytes(70_000),
        bytes(random.choice(9, 50_000, p=[0.6, *[0.05] * 8])),
    ]
    for data in texts:
        for options in (
            (0,),
            (1,),
            (9,),
            (6, zlib.DEFLATED, 15, 9, zlib.Z_FIXED),
            (9, zlib.DEFLATED, 15, 9, zlib.Z_HUFFMAN_ONLY),
        ):
            packer = zlib.compressobj(*options)
            stream = base64.b64encode(packer.compress(data) + packer.flush()).decode()
            array = json.dumps({"kind": "u1", "bytes": len(data), "data": stream})
            back = page.run(f"btoa(unpack({array}).reduce((text, byte) => text + String.fromCharCode(byte), ''))")
            assert base64.b64decode(back) == data


def test_paths_that_jump_arrive(open_page):
    page = open_page(exact_set())
    cells = [np.array([[300, 2], [3, 200], [3, 201]]), np.array([[5, 5]])]
    data = json.dumps(packed_paths(cells))
    assert page.run(f"(() => {{ const p = new Paths({data}); return [p.cells(0), p.cells(1)]; }})()") == [
        one.tolist() for one in cells
    ]


def test_the_map_stands_upright(open_page):
    found = exact_set()
    page = open_page(found)
    page.run("for (const box of document.querySelectorAll('#layers input')) if (box.checked) box.click(); 0")
    page.run("document.querySelector('#layers input').click(); map.paintCells(); map.paintBackdrop(shown, []); 0")
    dots = page.run(
        "(() => { const {width, height} = map.canvas; const {scale, left, bottom} = map.frame; const found = [];"
        " const dots = map.backdrop.getContext('2d').getImageData(0, 0, width, height).data;"
        " for (let y = 0; y < map.height; y++) for (let x = 0; x < map.width; x++)"
        " found.push(dots[4 * (width * Math.round(bottom - (y + 0.6) * scale) + Math.round(left + (x + 0.4) * scale))]);"
        " return found; })()"
    )
    dark = int(page.run("color('occupied')")[1:3], 16)
    np.testing.assert_array_equal(np.array(dots).reshape(12, 16) == dark, found.problem.grid.occupied)


def test_obstacles_are_told_from_what_is_too_near_to_them(open_page):
    found = grown_set()
    page = open_page(found)
    grid = found.problem.grid
    labels = page.run("Array.from(document.querySelectorAll('#layers label'), (label) => label.textContent)")
    assert labels[:2] == ["Obstacles", "Too near for a radius of 0.3 m"]

    def cells_of(name):
        read = "Array.from(map.cells.getContext('2d').getImageData(0, 0, 16, 12).data.filter((_, k) => k % 4 < 3))"
        dots = np.array(page.run(f"map.paintCells(), {read}")).reshape(12, 16, 3)[::-1]
        return (dots == page.run(f"parts(color('{name}'))")).all(axis=2)

    np.testing.assert_array_equal(cells_of("occupied"), grid.original.occupied)
    np.testing.assert_array_equal(cells_of("grown"), grid.occupied & ~grid.original.occupied)
    page.run("document.querySelectorAll('#layers input')[1].click(); 0")
    assert not cells_of("grown").any()
    np.testing.assert_array_equal(cells_of("occupied"), grid.original.occupied)
    page.run("document.querySelectorAll('#layers input')[1].click(); document.querySelector('#layers input').click(); 0")
    assert not cells_of("occupied").any() and cells_of("grown").any()


def test_everything_is_done_by_keys_alone(open_page):
    found = exact_set()
    page = open_page(found)
    seen = []
    for _ in range(60):
        page.press("Tab")
        seen.append(page.run("document.activeElement.id || document.activeElement.textContent || document.activeElement.type"))
        if seen[-1] == "front":
            break
    assert {"theme", "zoom-in", "zoom-out", "zoom-fit", "next", "previous", "download", "front"} <= set(seen)
    assert page.run("getComputedStyle(document.activeElement).outlineStyle") == "solid"
    page.press("Home")
    assert chosen(page) == 0
    page.press("ArrowRight")
    page.press("ArrowRight")
    assert chosen(page) == 2
    said = page.run("document.getElementById('front').getAttribute('aria-valuetext')")
    assert said.startswith(("Path 2, Length ", "Path 2 \u00b7 "))
    assert page.run("document.getElementById('front').getAttribute('aria-valuenow')") == "2"
    page.press("ArrowLeft")
    assert chosen(page) == 1
    page.press("End")
    assert chosen(page) == len(found) - 1
    page.press("PageDown")
    assert chosen(page) == max(len(found) - 11, 0)
    page.press("PageUp")
    page.press("ArrowRight")
    assert chosen(page) == len(found) - 1


def test_arrows_are_left_to_fields_that_need_them(open_page):
    page = open_page(exact_set())
    page.run("document.querySelector('#filters input').focus(); 0")
    before = chosen(page)
    page.press("ArrowRight")
    assert chosen(page) == before and page.run("document.querySelector('#filters input').value") == "1"


@pytest.mark.parametrize("path", [0, 3])
def test_a_click_chooses_and_hovering_shows(open_page, path):
    page = open_page(exact_set())
    x, y = place_of(page, "front", path)
    page.move(x + 2, y - 1)
    assert page.run("hovered") == path and chosen(page) != path
    assert page.run("document.getElementById('hovered').textContent").startswith(f"{path}: Length")
    page.click(x + 2, y - 1)
    assert chosen(page) == path and page.run("location.hash") == f"#{path}"
    page.move(5, 5)
    assert page.run("hovered") is None


def test_nothing_moves_as_paths_are_hovered_over(open_page):
    page = open_page(exact_set(3, HOSTILE, hostile=True))
    place = "JSON.stringify([...document.querySelectorAll('#side canvas, #map')].map((one) => one.getBoundingClientRect()))"
    before = page.run(place)
    for path in range(page.run("nPaths")):
        page.run(f"hover({path}); drawNow(); 0")
        assert page.run(place) == before


def test_a_line_of_the_parallel_coordinates_is_chosen_by_a_click(open_page):
    page = open_page(exact_set(3), height=1400)
    last = page.run("nPaths") - 1
    x, y = page.run(
        "(() => { parallel.canvas.scrollIntoView(); const {left} = parallel.box;"
        " const box = parallel.canvas.getBoundingClientRect();"
        f" return [box.x + left, box.y + parallel.height(0, {last})]; }})()"
    )
    page.click(x, y)
    assert page.run(f"parallel.columns[0].values[chosen] === parallel.columns[0].values[{last}]")


def test_a_click_on_the_map_chooses_among_the_paths_that_pass(open_page):
    found = exact_set()
    page = open_page(found)
    alone = {tuple(cell) for cell in found.safest.cells.tolist()}
    others = {tuple(cell) for record in found if "safest" not in record.names for cell in record.cells.tolist()}
    cell = sorted(alone - others)[0]
    x, y = page.run(
        "(() => { const box = map.canvas.getBoundingClientRect(); const {scale, left, bottom} = map.frame;"
        f" return [box.x + left + {cell[0] + 0.5} * scale, box.y + bottom - {cell[1] + 0.5} * scale]; }})()"
    )
    page.move(x, y)
    told = page.run("document.getElementById('place').textContent")
    centre = found.problem.grid.to_metres(cell)
    assert told == f"cell {cell[0]}, {cell[1]}; {centre[0]:.2f} m, {centre[1]:.2f} m; one path passes"
    page.click(x, y)
    assert chosen(page) == found.named["safest"]


def test_ranges_leave_paths_out_and_keys_pass_over_them(open_page):
    found = exact_set()
    page = open_page(found)
    values = found.measures["vulnerability"]
    page.run(
        "for (const [k, input] of [[1, 3]]) { const end = document.querySelectorAll('#filters input')[input];"
        " end.value = k; end.dispatchEvent(new Event('input')); } 0"
    )
    limit = np.unique(values)[1]
    assert page.run("Array.from(shown)") == [int(value <= limit) for value in values]
    left = int((values <= limit).sum())
    assert page.run("document.getElementById('shown').textContent") == f"{left} of {len(found)} paths are shown."
    page.run("choose(0); 0")
    assert heading(page).endswith("(filtered out)")
    page.press("ArrowRight")
    assert chosen(page) == np.flatnonzero(values <= limit)[0]
    page.run("document.getElementById('reset').click(); 0")
    assert page.run("document.getElementById('shown').textContent") == f"All {len(found)} paths are shown."


def test_the_waypoints_of_a_path_are_saved(open_page):
    found = exact_set()
    page = open_page(found, "#1")
    page.run("document.getElementById('download').click(); 0")
    rows = list(csv.DictReader(io.StringIO(page.downloaded("room-path-1.csv").decode())))
    assert list(rows[0]) == ["x", "y", "yaw"]
    for k in range(len(found)):
        rows = list(csv.DictReader(io.StringIO(page.run(f"waypoints({k})"))))
        made = found[k].waypoints()
        poses = [[float(row[key]) for key in ("x", "y", "yaw")] for row in rows]
        np.testing.assert_allclose(poses, np.column_stack([made.points, made.yaw]), rtol=1e-14, atol=1e-14)


def test_a_map_in_cells_gives_cells(open_page):
    found = exact_set(resolution=None)
    page = open_page(found)
    lines = page.run("waypoints(0)").splitlines()
    corners = found[0].waypoints().cells.tolist()
    assert lines[0] == "x,y,yaw" and [[*map(int, line.split(",")[:2])] for line in lines[1:]] == corners


def test_nobody_is_to_drive_along_what_is_not_legal(open_page):
    problem = GridPathProblem(OccupancyGrid([[0, 0, 0], [0, 1, 0], [0, 1, 0]]), (0, 2), (2, 2), "integer", axis="x")
    rows = np.array(list(itertools.product(*map(range, problem.xl.astype(int), problem.xu.astype(int) + 1))))
    found = TradeOffSet.from_genes(problem, rows[problem.decode(rows).interfering_cells > 0])
    assert not found.feasible and not open_page(exact_set()).run("document.getElementById('download').hidden")
    assert open_page(found).run("document.getElementById('download').hidden")


@pytest.mark.parametrize(
    ("link", "path"),
    [("#3", 3), ("#safest", "safest"), ("#0", 0), ("#99999", "knee"), ("#%", "knee"), ("#-1", "knee"), ("#<b>", "knee")],
)
def test_links_lead_to_paths(open_page, link, path):
    found = exact_set()
    page = open_page(found, link)
    assert chosen(page) == (found.named[path] if isinstance(path, str) else path)


def test_a_link_is_followed_on_an_open_page(open_page):
    page = open_page(exact_set())
    page.run("location.hash = '#2'; new Promise((done) => setTimeout(done, 50))")
    assert chosen(page) == 2 and heading(page).startswith("Path 2")


def test_names_do_nothing(open_page):
    found = exact_set(3, HOSTILE, hostile=True)
    page = open_page(found)
    assert page.run("typeof hacked") == "undefined"
    assert page.run("document.querySelector('h1').textContent") == found.problem.grid.name.replace("\u2028", "\\u2028")
    assert "<img src=x onerror='hacked=1'>" in page.run("document.getElementById('filters').textContent")
    assert page.run("document.images.length") == 0


def test_light_and_dark(open_page):
    light, dark = (open_page(exact_set(), dark=value) for value in (False, True))
    ground = "getComputedStyle(document.body).backgroundColor"
    assert light.run(ground) == "rgb(255, 255, 255)" and dark.run(ground) == "rgb(20, 23, 27)"
    dark.run("document.getElementById('theme').click(); 0")
    assert dark.run(ground) == "rgb(255, 255, 255)"


@pytest.mark.parametrize("width", [360, 1280])
def test_nothing_reaches_beyond_the_window(open_page, width):
    page = open_page(exact_set(3, HOSTILE, hostile=True), width=width, height=900)
    assert page.run("document.documentElement.scrollWidth") <= width
    assert page.run("document.getElementById('map').getBoundingClientRect().height") > 150


def test_the_map_is_zoomed_and_moved(open_page):
    page = open_page(exact_set())
    before = page.run("map.frame.scale")
    page.run("document.getElementById('zoom-in').click(); 0")
    assert page.run("map.frame.scale") == pytest.approx(1.5 * before)
    here = page.run("map.cellAt(100, 100)")
    page.run("map.zoom(1.2, 100, 100); 0")
    assert page.run("map.cellAt(100, 100)") == pytest.approx(here)
    page.run("document.getElementById('zoom-fit').click(); 0")
    assert page.run("map.frame.scale") == before


def test_a_notebook_shows_it(browser, tmp_path):
    file = tmp_path / "notebook.html"
    file.write_text(f"<!DOCTYPE html><meta charset=utf-8>{explore(exact_set(2, HOSTILE))._repr_html_()}", encoding="utf-8")
    page = browser.open(file.as_uri(), height=760)

    def accent():
        """Dots in the colour of the chosen path: there are some when the frame, in a process of its own, has drawn."""
        page.screenshot(tmp_path / "notebook.png")
        dots = np.asarray(Image.open(tmp_path / "notebook.png").convert("RGB")).reshape(-1, 3)
        return (dots == [0x0B, 0x57, 0xD0]).all(axis=1).sum()

    assert any(accent() > 300 for _ in range(200))
    assert page.complaints == [] and page.run("document.querySelector('iframe').title") == "Explorer of trade-off paths"
    assert html.escape("<script>") in explore(exact_set())._repr_html_()
    page.close()


def test_a_window_of_another_size_is_drawn_anew(open_page):
    page = open_page(exact_set(3))
    page.resize(1000, 700)
    page.run("(async () => { for (let k = 0; k < 5; k++) await new Promise(requestAnimationFrame); })()")
    assert page.run("[map, ...charts].every((view) => fits(view.canvas))") and page.run("map.canvas.width") < 700
    assert page.run("map.backdrop.width === map.canvas.width")
