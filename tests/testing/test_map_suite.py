"""Our own map formats pass the suite for map formats, and the suite catches what is planted in one."""

from __future__ import annotations

import inspect
import json
import re
from pathlib import Path

import numpy as np
import pytest
import tifffile
from PIL import Image
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_typestore

from pymoo_gridpath.errors import MapError
from pymoo_gridpath.maps import (
    MAP_FORMATS,
    MapFormat,
    Query,
    check_size,
    load_map,
    make_grid,
    query_of,
    read_string,
)
from pymoo_gridpath.maps.array import NumpyFormat
from pymoo_gridpath.maps.geotiff import GeoTiffFormat
from pymoo_gridpath.maps.image import ImageFormat
from pymoo_gridpath.maps.movingai import MovingAIFormat
from pymoo_gridpath.maps.ros import RosFormat
from pymoo_gridpath.maps.ros_message import RosMessageFormat
from pymoo_gridpath.maps.rosbag import RosbagFormat
from pymoo_gridpath.maps.text import TextFormat
from pymoo_gridpath.registry import register
from pymoo_gridpath.testing import MapFormatSuite


def rows_of(grid, letters=".@") -> str:
    """The cells as text, the top row first."""
    return "".join("".join(letters[int(cell)] for cell in row) + "\n" for row in grid.occupied[::-1])


def shades_of(grid):
    return Image.fromarray(np.where(grid.occupied[::-1], 0, 254).astype(np.uint8))


class TestNumpy(MapFormatSuite):
    format = NumpyFormat

    def write(self, path, grid):
        np.save(path, grid.occupied)


class TestImage(MapFormatSuite):
    format = ImageFormat

    def write(self, path, grid):
        shades_of(grid).save(path)


class TestGeoTiff(MapFormatSuite):
    format = GeoTiffFormat

    def write(self, path, grid):
        tags = [(33550, "d", 3, (0.5, 0.5, 0.0)), (33922, "d", 6, (0.0, 0.0, 0.0, 10.0, 20.0, 0.0))]
        tifffile.imwrite(path, np.where(grid.occupied[::-1], 100, 0).astype(np.int8), extratags=[(*tag, False) for tag in tags])


class TestMovingAI(MapFormatSuite):
    format = MovingAIFormat

    def write(self, path, grid):
        path.write_text(f"type octile\nheight {grid.height}\nwidth {grid.width}\nmap\n{rows_of(grid)}")


class TestRos(MapFormatSuite):
    format = RosFormat

    def write(self, path, grid):
        shades_of(grid).save(path.with_suffix(".pgm"))
        path.write_text(
            f"image: {path.stem}.pgm\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\n"
            "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
        )


class TestRosMessage(MapFormatSuite):
    format = RosMessageFormat

    def write(self, path, grid):
        cells = "".join(f"- {100 * int(cell)}\n" for cell in grid.occupied.ravel())
        path.write_text(
            f"header:\n  frame_id: map\ninfo:\n  resolution: 0.5\n  width: {grid.width}\n  height: {grid.height}\n  origin:\n"
            "    position: {x: 0.0, y: 0.0, z: 0.0}\n    orientation: {x: 0.0, y: 0.0, z: 0.0, w: 1.0}\n"
            f"data:\n{cells}---\n"
        )


class TestRosbag(MapFormatSuite):
    format = RosbagFormat

    def write(self, path, grid):
        path.unlink(missing_ok=True)
        typestore = get_typestore(Stores.ROS1_NOETIC)
        types = typestore.types
        time = types["builtin_interfaces/msg/Time"](0, 0)
        pose = types["geometry_msgs/msg/Pose"](
            types["geometry_msgs/msg/Point"](0.0, 0.0, 0.0), types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0)
        )
        info = types["nav_msgs/msg/MapMetaData"](time, 0.5, grid.width, grid.height, pose)
        data = (100 * grid.occupied).astype(np.int8).ravel()
        message = types["nav_msgs/msg/OccupancyGrid"](types["std_msgs/msg/Header"](0, time, "map"), info, data)
        with Writer(path) as bag:
            connection = bag.add_connection("/map", message.__msgtype__, typestore=typestore)
            bag.write(connection, 0, typestore.serialize_ros1(message, message.__msgtype__))


class TestText(MapFormatSuite):
    format = TextFormat

    def write(self, path, grid):
        path.write_text(rows_of(grid))

    def write_query(self, path, grid, query):
        ends = f"start: {query.start[0]} {query.start[1]}\ngoal: {query.goal[0]} {query.goal[1]}\nradius: {query.radius}\n"
        path.write_text(f"{ends}\n{rows_of(grid)}")


def test_all_formats_are_tested():
    tested = {suite.format for suite in MapFormatSuite.__subclasses__() if suite.__module__ == __name__}
    ours = {NumpyFormat, GeoTiffFormat, ImageFormat, MovingAIFormat, RosFormat, RosMessageFormat, RosbagFormat, TextFormat}
    assert tested == {*ours, Runs, MAP_FORMATS["rooms"]}


# -- a format of someone else's ---------------------------------------------------------------------------------------


@register
class Runs(MapFormat):
    """Each row, the top one first, as the lengths of its runs, free and occupied in turn, after a line with the query."""

    name, suffixes = "runs", (".runs",)
    title = "runs"

    def matches(self, head, path):
        return head.startswith(self.title.encode() + b"\n")

    def read(self, path, corner_cutting=False, resolution=None):
        _, rows = self._parsed(path)
        widths = {sum(row) for row in rows}
        if len(widths) != 1 or min(map(min, rows)) < 0:
            raise MapError(path, "found rows of several widths, expected runs that add up to one")
        check_size(path, max(widths), len(rows))
        occupied = [[k % 2 for k, run in enumerate(row) for _ in range(run)] for row in reversed(rows)]
        return make_grid(path, occupied, corner_cutting=corner_cutting, resolution=resolution)

    def query(self, path):
        numbers, _ = self._parsed(path)
        return Query(tuple(numbers[:2]), tuple(numbers[2:4]), numbers[4] / 100) if len(numbers) == 5 else None

    def _parsed(self, path):
        lines = read_string(path, 10**6).splitlines()
        try:
            if lines[0] != self.title:
                raise ValueError
            query, *rows = [[int(word) for word in line.split()] for line in lines[1:]]
            if not rows or not all(rows):
                raise ValueError
        except (ValueError, IndexError):
            raise MapError(path, "found no runs, expected 'runs', a query and rows of whole numbers") from None
        return query, rows


class TestRuns(MapFormatSuite):
    format = Runs

    def write(self, path, grid, query="-"):
        rows = []
        for row in grid.occupied[::-1]:
            runs, last = [0], False
            for cell in row:
                if cell != last:
                    runs.append(0)
                runs[-1] += 1
                last = cell
            rows.append(" ".join(map(str, runs)))
        path.write_text("\n".join([self.format.title, query.replace("-", ""), *rows]) + "\n")

    def write_query(self, path, grid, query):
        self.write(path, grid, " ".join(map(str, (*query.start, *query.goal, int(query.radius * 100)))))


def _flipped(self, path, corner_cutting=False, resolution=None):
    grid = Runs().read(path, corner_cutting, resolution)
    return grid.replace(occupied=grid.occupied[::-1])


def _mirrored(self, path, corner_cutting=False, resolution=None):
    grid = Runs().read(path, corner_cutting, resolution)
    return grid.replace(occupied=grid.occupied[:, ::-1])


def _without_options(self, path, corner_cutting=False, resolution=None):
    return Runs().read(path)


def _of_any_resolution(self, path, corner_cutting=False, resolution=None):
    return Runs().read(path, corner_cutting, float("nan") if resolution == "nonsense" else resolution).replace(resolution=None)


def _with_tracebacks(self, path, corner_cutting=False, resolution=None):
    try:
        return Runs().read(path, corner_cutting, resolution)
    except MapError as error:
        raise KeyError(error.message) from None


def _of_another_file(self, path, corner_cutting=False, resolution=None):
    try:
        return Runs().read(path, corner_cutting, resolution)
    except MapError as error:
        raise MapError("map", error.message) from None


def _of_anything(self, path, corner_cutting=False, resolution=None):
    try:
        return Runs().read(path, corner_cutting, resolution)
    except MapError:
        return make_grid(path, [[0]])


def _of_any_size(self, path, corner_cutting=False, resolution=None):
    _, rows = self._parsed(path)
    if len({sum(row) for row in rows}) != 1 or min(map(min, rows)) < 0:
        raise MapError(path, "found rows of several widths, expected one")
    occupied = [[k % 2 for k, run in enumerate(row) for _ in range(run)] for row in reversed(rows)]
    return make_grid(path, occupied, corner_cutting=corner_cutting, resolution=resolution)


def _with_a_cache(self, path, corner_cutting=False, resolution=None):
    grid = Runs().read(path, corner_cutting, resolution)
    np.save(f"{path}.npy", grid.occupied)
    return grid


def _with_random_numbers(self, path, corner_cutting=False, resolution=None):
    np.random.random()  # noqa: NPY002
    return Runs().read(path, corner_cutting, resolution)


FAULTS = {
    "rows upside down": {"read": _flipped},
    "rows mirrored": {"read": _mirrored},
    "options without effect": {"read": _without_options},
    "one option without effect": {"read": _of_any_resolution},
    "a traceback for a bad file": {"read": _with_tracebacks},
    "an error of another file": {"read": _of_another_file},
    "a map of whatever is in the file": {"read": _of_anything},
    "no largest size": {"read": _of_any_size},
    "a file beside the map": {"read": _with_a_cache},
    "numbers drawn from numpy's global state": {"read": _with_random_numbers},
    "all files are its own": {"matches": lambda self, head, path: True},
    "told by another name than its own": {"matches": lambda self, head, path: head[:4] == b"runs" and path.suffix == ".runs"},
    "none of its own files": {"suffixes": (".txt",), "matches": lambda self, head, path: False},
    "start and goal swapped": {"query": lambda self, path: (q := Runs.query(self, path)) and Query(q.goal, q.start, q.radius)},
    "radius in other units": {
        "query": lambda self, path: (q := Runs.query(self, path)) and Query(q.start, q.goal, 100 * q.radius)
    },
}


def _of_the_page():
    page = Path(__file__).parents[2] / "docs" / "maps.md"
    cells = re.findall(r"```{code-cell} ipython3\n(.*?)```", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    (program,) = [cell for cell in cells if "MapFormat" in cell]
    exec(compile(program.partition("\nwith open(")[0], str(page), "exec"), {"__name__": "docs.maps"})
    return MAP_FORMATS["rooms"]


class TestRooms(MapFormatSuite):
    """The format that the page on maps shows."""

    format = _of_the_page()

    def write(self, path, grid):
        self.write_query(path, grid, Query((0, 0), (1, 0)))

    def write_query(self, path, grid, query):
        walls = [(int(x), int(y), int(x) + 1, int(y) + 1) for y, x in np.argwhere(grid.occupied)]
        document = {"size": [grid.width, grid.height], "walls": walls, "start": query.start, "goal": query.goal}
        path.write_text(json.dumps(document))


def failures(suite, tmp_path) -> list[str]:
    """Run all tests of a suite as pytest does, and return the names of those that fail."""
    failed = []
    for name, test in inspect.getmembers(suite, inspect.ismethod):
        if name.startswith("test_"):
            folder = tmp_path / name
            folder.mkdir()
            with pytest.MonkeyPatch.context() as patch:
                fixtures = {"tmp_path": folder, "monkeypatch": patch}
                try:
                    test(**{key: fixtures[key] for key in inspect.signature(test).parameters})
                except Exception:
                    failed.append(name)
    return failed


def test_the_format_without_a_fault_passes(tmp_path):
    assert failures(TestRuns(), tmp_path) == []


@pytest.mark.parametrize("fault", FAULTS)
def test_planted_faults_are_caught(tmp_path, monkeypatch, fault):
    for name, value in FAULTS[fault].items():
        monkeypatch.setattr(Runs, name, value, raising=False)
    assert failures(TestRuns(), tmp_path) != []


def test_a_format_of_ones_own_is_known_everywhere(tmp_path, capsys, monkeypatch):
    from pymoo_gridpath.cli import main
    from pymoo_gridpath.study import Study, plan_study

    monkeypatch.chdir(tmp_path)
    path = tmp_path / "room.runs"
    path.write_text("runs\n0 0 3 1 40\n4\n1 2 1\n")
    assert load_map("room.runs").occupied.astype(int).tolist() == [[0, 1, 1, 0], [0, 0, 0, 0]]
    assert query_of("room.runs") == Query((0, 0), (3, 1), 0.4)
    assert "runs" in MAP_FORMATS
    assert main(["info", "room.runs"]) == 0
    assert "from 0,0 to 3,1, robot radius 0.4 m" in capsys.readouterr().out
    assert main(["info", "room.runs", "--threshold", "0.5"]) == 2
    assert "'runs' does not take the option 'threshold', expected one of corner_cutting, resolution" in capsys.readouterr().err
    algorithms = [{"algorithm": "nsga2", "pop_size": 10}]
    study = Study(name="s", problems=[{"map": "room.runs"}], algorithms=algorithms, seeds=1, budget={"generations": 2})
    (problem,) = plan_study(study).problems
    assert (problem.spec["start"], problem.spec["goal"]) == ([0, 0], [3, 1])
