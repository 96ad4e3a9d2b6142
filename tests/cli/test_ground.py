"""Costs of the ground and heights on the command line."""

from __future__ import annotations

import argparse
import csv
import json
from unittest import mock

import numpy as np
import pytest
from matplotlib.figure import Figure

from pymoo_gridpath.cli import main
from pymoo_gridpath.cli.ground import weighted_file, weights

ROOM = "......\n..##..\n......\n......\n"
MAP = "type octile\nheight 4\nwidth 6\nmap\n......\n..TT..\n.SSSW.\n.SSSW.\n"


@pytest.fixture
def plan(tmp_path, capsys):
    (tmp_path / "room.txt").write_text(ROOM)
    (tmp_path / "pond.map").write_text(MAP)
    np.save(tmp_path / "mud.npy", np.where(np.indices((4, 6))[0] < 2, 5.0, 1.0))
    np.save(tmp_path / "ones.npy", np.ones((4, 6)))
    np.save(tmp_path / "hill.npy", np.tile([0.0, 0.0, 3.0, 3.0, 0.0, 0.0], (4, 1)))
    holes = np.ones((4, 6))
    holes[0, 2:4] = np.nan
    np.save(tmp_path / "holes.npy", holes)

    def run(map_name, *options):
        out = tmp_path / "out"
        arguments = [
            "plan",
            tmp_path / map_name,
            "--start",
            "0,0",
            "--goal",
            "5,0",
            "--algorithm",
            "exact",
            "-o",
            out,
            *options,
        ]
        with mock.patch.object(Figure, "savefig", lambda figure, *args, **kwargs: None):
            status = main([str(one) for one in arguments])
        said = capsys.readouterr()
        rows = list(csv.DictReader((out / "paths.csv").open())) if status == 0 else []
        return status, said.out, said.err, rows, out

    return run


def test_files_add_up_to_one_objective(plan, tmp_path):
    status, out, _, rows, folder = plan(
        "room.txt", "--objectives", "length", "--cost", f"{tmp_path}/mud.npy:2", "--cost", f"{tmp_path}/ones.npy"
    )
    assert status == 0 and "cheapest" in out and "ground" in out
    # Straight on through the mud: five steps of 2 * 5 + 1.
    assert float(rows[0]["ground"]) == 55.0
    given = json.loads((folder / "paths.json").read_text())["settings"]
    assert given["cost"] == [[f"{tmp_path}/mud.npy", 2.0], [f"{tmp_path}/ones.npy", 1.0]]


def test_heights_are_climbed(plan, tmp_path):
    status, out, _, rows, _ = plan("room.txt", "--objectives", "length", "--climb", tmp_path / "hill.npy")
    assert status == 0 and "flattest" in out
    assert [float(row["climb"]) for row in rows] == [3.0]


def test_the_letters_of_a_map_weigh(plan):
    _, _, _, plain, _ = plan("pond.map", "--objectives", "length")
    status, _, _, rows, _ = plan("pond.map", "--objectives", "length", "--terrain", "S=3,W=8")
    assert status == 0
    # Where water has a weight it can be crossed.
    assert float(rows[0]["length"]) == 5.0 < float(plain[0]["length"])
    assert len(rows) > 1 and float(rows[-1]["ground"]) < float(rows[0]["ground"])


def test_cells_without_data_are_refused_or_occupied(plan, tmp_path):
    holes = ["--objectives", "length", "--cost", tmp_path / "holes.npy"]
    status, _, err, _, _ = plan("room.txt", *holes)
    assert status == 2 and "holes.npy: there is no data in 2 free cells, the first (2, 0)" in err and err.count("\n") == 1
    assert plan("room.txt", *holes, "--nodata", "refuse")[0] == 2
    status, _, _, rows, _ = plan("room.txt", *holes, "--nodata", "occupied")
    assert status == 0 and float(rows[0]["length"]) > 5.0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--cost", "small.npy"], "small.npy: it has 3 x 2 cells, expected 6 x 4 as the map"),
        (["--cost", "nowhere.npy"], "nowhere.npy: no such file"),
        (["--cost", "mud.npy:-2"], "is not FILE or FILE:WEIGHT"),
        (["--cost", ""], "is not FILE or FILE:WEIGHT"),
        (["--terrain", "S"], "gives no weights"),
        (["--terrain", "S=3"], "expected"),
        (["--nodata", "occupied"], "--nodata is for --cost and --climb"),
    ],
)
def test_bad_input_is_one_line(plan, tmp_path, monkeypatch, options, message):
    monkeypatch.chdir(tmp_path)
    np.save("small.npy", np.ones((2, 3)))
    try:
        status, _, err, _, _ = plan("room.txt", *options)
    except SystemExit as end:
        # What argparse refuses.
        assert end.code == 2
        return
    assert status == 2 and message in err and err.count("\n") == 1


def test_texts_are_files_and_weights():
    assert weighted_file("mud.npy") == ("mud.npy", 1.0)
    assert weighted_file("mud.npy:2.5") == ("mud.npy", 2.5)
    assert weighted_file(r"C:\maps\mud.npy") == (r"C:\maps\mud.npy", 1.0)
    assert weighted_file(r"C:\maps\mud.npy:3") == (r"C:\maps\mud.npy", 3.0)
    assert weights("S=3,W=0.5") == {"S": 3.0, "W": 0.5}
    for text in ("S=3,S=4", "S=-1", "S=nan", "S=", "=3"):
        with pytest.raises(argparse.ArgumentTypeError, match="gives no weights"):
            weights(text)
