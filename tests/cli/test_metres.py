"""Plans in metres on the command line: queries, footprints, and a robot that is where it is to go."""

import csv
import json

import numpy as np
import pytest
import yaml

from pymoo_gridpath.cli import main
from pymoo_gridpath.decision import load_json
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.maps import load_map, save_map

FAST = ["--algorithm", "exact", "--objectives", "length"]


@pytest.fixture
def hall(tmp_path):
    """A map turned by 30 degrees about a corner at negative metres, a wall across it with a gap at the top."""
    occupied = np.zeros((8, 12), dtype=bool)
    occupied[:6, 6] = True
    occupied[0, 0] = True
    grid = OccupancyGrid(occupied, 0.25, (-4.0, -2.0, np.pi / 6), name="hall")
    save_map(grid, tmp_path / "hall.yaml")
    return tmp_path / "hall.yaml"


@pytest.fixture
def without_figures(monkeypatch):
    monkeypatch.setattr("pymoo_gridpath.plotting.save_figures", lambda *arguments, **options: [])


def plan(hall, *options, status=0):
    arguments = [str(hall), *options, *FAST, "-o", str(hall.parent / "out")]
    assert main(["plan", *arguments]) == status
    return json.loads((hall.parent / "out" / "paths.json").read_text()) if status == 0 else None


def metres(hall, cell):
    return ",".join(f"{value:.6f}" for value in load_map(hall).to_metres(cell))


@pytest.mark.usefixtures("without_figures")
def test_points_with_minus_signs_are_no_options(hall, capsys):
    points = metres(hall, (1, 0)), metres(hall, (10, 0))
    assert all(point.startswith("-") for point in points)
    for options in (["--start-m", points[0], "--goal-m", points[1]], [f"--start-m={points[0]}", "--goal", "10,0"]):
        document = plan(hall, *options)
        assert document["query"] == {"start": [1, 0], "goal": [10, 0]}
        assert document["paths"][0]["points"][0] == pytest.approx([float(part) for part in points[0].split(",")], abs=1e-6)
    assert plan(hall, "--start", "1,0", "--goal-m", points[1], "--goal-tolerance", "0")["query"]["goal"] == [10, 0]
    capsys.readouterr()


@pytest.mark.usefixtures("without_figures")
@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            ["--start-m", "-9.5,2", "--goal", "1,1"],
            "start (-9.5, 2) m lies outside the map 'hall', which has its corners at (-4, -2) m",
        ),
        (
            ["--start-m", "-4,-1.8", "--goal", "1,1"],
            "start (-4, -1.8) m lies on an obstacle of the map 'hall'; the nearest place",
        ),
        (
            ["--start", "1,0", "--goal-m", "-9,-9", "--goal-tolerance", "0.5"],
            "no place within the tolerance of 0.5 m of the goal",
        ),
        (
            ["--start", "1,0", "--goal-m", "-9,-9", "--goal-tolerance", "-1"],
            "goal_tolerance is -1.0, expected a number of metres",
        ),
        (["--start-m", "1", "--goal", "1,1"], "'1' is not a point in metres, expected X,Y such as -1.5,2"),
        (["--start-m", "-nan,1", "--goal", "1,1"], ""),
        (["--start-m", "-1e3,nan", "--goal", "1,1"], "'-1e3,nan' is not a point in metres"),
        (["--start", "1,0", "--start-m", "-1,2", "--goal", "1,1"], "argument --start-m: not allowed with argument --start"),
        (["--footprint", "0.1,0 0,0.1", "--start", "1,0", "--goal", "9,1"], "footprint is"),
        (
            ["--footprint", "wide", "--start", "1,0", "--goal", "9,1"],
            "'wide' is no outline of a robot, expected corners in metres",
        ),
        (["--radius", "0.2", "--footprint", "0.1,0 0,0.1 0,0"], "argument --footprint: not allowed with argument --radius"),
    ],
)
def test_what_cannot_be_is_one_line(hall, capsys, options, message):
    try:
        assert main(["plan", str(hall), *options, *FAST, "-o", str(hall.parent / "out")]) == 2
    except SystemExit as ended:
        assert ended.code == 2
    error = capsys.readouterr().err
    assert message in error and error.count("\n") == 1


@pytest.mark.usefixtures("without_figures")
def test_a_tolerance_takes_what_can_be_reached(hall, capsys):
    inside = metres(hall, (6, 2))
    assert plan(hall, "--start", "1,0", "--goal-m", inside, "--goal-tolerance", "0.3")["query"]["goal"] == [5, 2]
    assert plan(hall, "--start", "1,0", "--goal", "6,2", "--goal-tolerance", "0.3")["query"]["goal"] == [5, 2]
    assert main(["plan", str(hall), "--start", "1,0", "--goal", "6,2", "-o", str(hall.parent / "out")]) == 2
    assert "goal (6, 2) lies on an obstacle" in capsys.readouterr().err


@pytest.mark.usefixtures("without_figures")
@pytest.mark.parametrize(
    "text", ["-0.2,0.1 -0.2,-0.1 0.3,0", "[[-0.2, 0.1], [-0.2, -0.1], [0.3, 0]]", "[-0.2,0.1],[-0.2,-0.1],[0.3,0]"]
)
def test_a_footprint_is_planned_for_and_remembered(hall, text):
    stated = plan(hall, "--start", "2,3", "--goal", "3,6", "--footprint", text)["map"]
    assert stated["footprint"] == [[-0.2, 0.1], [-0.2, -0.1], [0.3, 0.0]] and stated["robot_radius"] == 0.3
    assert stated["original"]["occupied_cells"] == load_map(hall).n_occupied
    grid = load_json(hall.parent / "out" / "paths.json").problem.grid
    assert grid == load_map(hall).inflate(0.3) and grid.original == load_map(hall)


@pytest.mark.parametrize("options", [["--start", "3,3", "--goal", "3,3"], ["--start", "3,3", "--goal-m", "same"]])
@pytest.mark.usefixtures("undrawn")
def test_a_robot_that_is_there_gets_files_of_one_pose(hall, options, capsys):
    options = [metres(hall, (3, 3)) if option == "same" else option for option in options]
    out, page = hall.parent / "out", hall.parent / "page.html"
    options += ["--waypoints", "csv,yaml,f1tenth", "--spacing", "0.1"]
    assert main(["plan", str(hall), *options, "-o", str(out), "--html", str(page)]) == 0
    printed = capsys.readouterr()
    place = "({:.6g}, {:.6g}) m".format(*load_map(hall).to_metres((3, 3)))
    assert "from (3, 3) to (3, 3)\n" in printed.out and f"1 trade-off path from {place} to {place} on 'hall'" in printed.out
    (path,) = json.loads((out / "paths.json").read_text())["paths"]
    assert path["cells"] == [[3, 3]] and path["length"] == path["turn"] == 0 and path["clearance_m"] > 0
    with open(out / "paths.csv", newline="") as file:
        assert [row["length_m"] for row in csv.DictReader(file)] == ["0.0"]
    x, y = path["points"][0]
    assert (out / "waypoints-knee.csv").read_text().splitlines() == ["x,y,yaw", f"{x!r},{y!r},0.0"]
    (pose,) = yaml.safe_load((out / "waypoints-knee.yaml").read_text())["poses"]
    assert (pose["pose"]["position"]["x"], pose["pose"]["orientation"]["w"]) == (x, 1.0)
    assert np.loadtxt(out / "raceline-knee.csv", delimiter=";").tolist() == [0.0, x, y, 0.0, 0.0, 1.0, 0.0]
    again = load_json(out / "paths.json")
    assert len(again) == 1 and again.knee.cells.tolist() == [[3, 3]] and again.to_json(out / "b.json").read_bytes()
    assert (out / "map.png").exists() and page.exists()
    assert main(["explore", str(out / "paths.json")]) == 0


def test_a_robot_that_stands_on_an_obstacle_is_told_so(hall, capsys):
    assert main(["plan", str(hall), "--start", "0,0", "--goal", "0,0", "-o", str(hall.parent / "out")]) == 2
    assert "start (0, 0) lies on an obstacle" in capsys.readouterr().err
