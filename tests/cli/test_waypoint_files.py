"""Waypoints from the command line: which files there are, what they hold, and what is refused before the search."""

from __future__ import annotations

import csv
import json
import math
from unittest import mock

import numpy as np
import pytest
import yaml
from matplotlib.figure import Figure

from pymoo_gridpath.cli import main
from pymoo_gridpath.decision import load_json


@pytest.fixture
def plan(tmp_path, capsys):
    """Plan on a small room, and return the status and what was said."""
    room = tmp_path / "room.txt"
    room.write_text("resolution: 0.5\norigin: 1 2 0.3\n\n........\n...#....\n..##....\n........\n")

    def run(*arguments, output="out"):
        what = ["plan", room, "--start", "0,0", "--goal", "7,3", "--algorithm", "exact", "-o", tmp_path / output, *arguments]
        with mock.patch.object(Figure, "savefig", lambda figure, *args, **kwargs: None):
            status = main([str(one) for one in what])
        said = capsys.readouterr()
        return status, said.out, said.err

    return run


def test_each_named_path_has_its_files(plan, tmp_path):
    status, out, err = plan("--waypoints", "csv,yaml,f1tenth", "--spacing", "0.25", "--speed", "2")
    assert status == 0, err
    found = load_json(tmp_path / "out" / "paths.json")
    for name in found.named:
        made = found[name].waypoints(spacing=0.25)
        with open(tmp_path / "out" / f"waypoints-{name}.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        np.testing.assert_array_equal([[float(row["x"]), float(row["y"])] for row in rows], made.points)
        np.testing.assert_array_equal([float(row["yaw"]) for row in rows], made.yaw)
        poses = yaml.safe_load((tmp_path / "out" / f"waypoints-{name}.yaml").read_text())["poses"]
        assert [one["pose"]["position"]["x"] for one in poses] == made.points[:, 0].tolist()
        racing = np.loadtxt(tmp_path / "out" / f"raceline-{name}.csv", delimiter=";")
        np.testing.assert_array_equal(racing[:, 1:3], made.points)
        assert (racing[:, 5] == 2).all()
        assert max(math.dist(a, b) for a, b in zip(made.points[:-1], made.points[1:], strict=True)) <= 0.25 + 1e-9
        assert str(made) in out
    n = len(found.named)
    assert len(list((tmp_path / "out").glob("waypoints-*"))) == 2 * n and out.count("waypoints-") == 2 * n


def test_only_what_was_asked_for_is_written(plan, tmp_path):
    assert plan("--waypoints", "yaml,f1tenth")[0] == 0 and list((tmp_path / "out").glob("[wr]a*"))
    # Nor do those of an earlier plan stay.
    assert plan()[0] == 0 and plan("--waypoints", "csv", output="b")[0] == 0
    assert not list((tmp_path / "out").glob("[wr]a*"))
    assert {file.name.partition("-")[0] for file in (tmp_path / "b").glob("[wr]a*")} == {"waypoints"}


def test_a_robot_that_is_there_has_one_pose(plan, tmp_path):
    status, _, err = plan("--goal", "0,0", "--waypoints", "csv,yaml,f1tenth")
    assert status == 0, err
    rows = (tmp_path / "out" / "waypoints-shortest.csv").read_text().splitlines()
    assert len(rows) == 2 and rows[1].endswith(",0.0")
    assert len(json.loads((tmp_path / "out" / "paths.json").read_text())["paths"]) == 1


def test_what_is_not_legal_has_none(plan, tmp_path, capsys):
    (tmp_path / "narrow.txt").write_text(".......\n.######\n.......\n.######\n.......\n")
    what = ["plan", tmp_path / "narrow.txt", "--start", "6,4", "--goal", "6,0", "--representation", "integer", "--axis", "y"]
    what += ["--pop-size", "4", "--generations", "1", "--waypoints", "csv", "-o", tmp_path / "no"]
    with mock.patch.object(Figure, "savefig", lambda figure, *args, **kwargs: None):
        status = main([str(one) for one in what])
    assert status == 1 and "no waypoints were written, since no path is legal" in capsys.readouterr().err
    assert not list((tmp_path / "no").glob("way*"))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--waypoints", "csv,geojson"], "'geojson' is no format of waypoints, expected some of csv, yaml, f1tenth"),
        (["--waypoints", ""], "'' is no format of waypoints"),
        (["--spacing", "0.3"], "--spacing is for --waypoints"),
        (["--waypoints", "csv", "--speed", "2"], "--speed is for --waypoints f1tenth"),
        (["--waypoints", "csv", "--spacing", "0"], "'0' is not a number above 0"),
        (["--waypoints", "f1tenth", "--speed", "nan"], "'nan' is not a number above 0"),
    ],
)
def test_what_is_refused(plan, tmp_path, capsys, arguments, words):
    try:
        status, _, err = plan(*arguments)
    except SystemExit as error:
        status, err = error.code, capsys.readouterr().err
    assert status == 2 and words in err and err.count("\n") == 1
    assert not (tmp_path / "out").exists()
