"""What the command line says about maps: warnings in one line, names without control characters, what was read."""

import csv
import json
import pickle
import warnings

import numpy as np
import pytest

from pymoo_gridpath.cli import main, plan
from pymoo_gridpath.errors import MapError, MapWarning, StudyError, visible
from pymoo_gridpath.maps import load_map
from pymoo_gridpath.progress import COMPILING
from pymoo_gridpath.study import Study, run_study
from pymoo_gridpath.study.planning.expand import plan_study

# Clears the screen, rings, and turns the writing around.
TERMINAL = "a\x1b[2J\x07\u202eb"
SHOWN = "a\\x1b[2J\\x07\\u202eb"
ROOM = "resolution: 1\n......\n..##..\n......\n......\n"
FAST = ["--start", "0,0", "--goal", "5,3", "--pop-size", "10", "--generations", "2"]


def test_control_characters_are_shown_escaped():
    assert visible(TERMINAL + "\n") == SHOWN + "\\n"
    assert visible("Büro, 部屋 'a\\b'") == "Büro, 部屋 'a\\b'"
    assert visible("\udcff") == "\\udcff"


@pytest.mark.parametrize("command", [["info"], ["plan", *FAST]])
@pytest.mark.usefixtures("undrawn")
def test_names_of_maps_are_printed_escaped(tmp_path, capsys, command):
    path = tmp_path / "map.txt"
    path.write_text(f"name: {TERMINAL}\n{ROOM}", encoding="utf-8")
    output = [] if command[0] == "info" else ["-o", str(tmp_path / TERMINAL)]
    assert main([command[0], str(path), *command[1:], *output]) == 0
    text = "".join(capsys.readouterr())
    assert SHOWN in text
    assert all(letter.isprintable() or letter == "\n" for letter in text)


def test_names_of_files_are_printed_escaped(tmp_path, capsys):
    path = tmp_path / f"{TERMINAL}.txt"
    path.write_text("what is this?\n", encoding="utf-8")
    for arguments in (["info", str(path)], ["plan", str(path)], ["study", "check", str(path)], ["info", f"no{TERMINAL}"]):
        assert main(arguments) == 2
        error = capsys.readouterr().err
        assert SHOWN in error and error.count("\n") == 1 and error[:-1].isprintable()


def test_messages_in_python_are_escaped_and_attributes_are_not():
    for error in (MapError(TERMINAL, "m", 3), StudyError("m", path=TERMINAL, line=3)):
        assert str(error) == f"{SHOWN}, line 3: m" and error.path == TERMINAL
    for thing in (MapError(TERMINAL, "m"), MapWarning(TERMINAL, "m")):
        assert str(thing) == f"{SHOWN}: m" == str(pickle.loads(pickle.dumps(thing)))


def test_warnings_are_one_line_each(capsys, monkeypatch):
    def warn(arguments):
        for path in ("a", "a", "b\n"):
            warnings.warn(MapWarning(path, "may be meant otherwise"), stacklevel=1)
        return 0

    monkeypatch.setattr("pymoo_gridpath.cli.maps._maps", warn)
    assert main(["maps"]) == 0
    lines = capsys.readouterr().err.splitlines()
    assert set(lines) == {f"pymoo-gridpath: warning: {path}: may be meant otherwise" for path in ("a", "b\\n")}


KEYS = """image: room.pgm
mode: trinary
resolution: 0.05
origin: [0, 0, 0]
negate: 0
occupied_thresh: 0.65
free_thresh: {}
"""


@pytest.fixture
def room(tmp_path):
    """A room of 17 x 9 cells with an unseen block in its middle, as a map saver writes it, and two YAML files."""
    shades = np.full((9, 17), 254, np.uint8)
    shades[[0, -1]], shades[:, [0, -1]] = 0, 0
    shades[3:6, 6:11] = 205
    (tmp_path / "room.pgm").write_bytes(b"P5\n17 9\n255\n" + shades.tobytes())
    (tmp_path / "nav2.yaml").write_text(KEYS.format(0.25))
    (tmp_path / "ros1.yaml").write_text(KEYS.format(0.196))
    return tmp_path


@pytest.fixture
def without_figures(monkeypatch):
    """Plan without figures, which take longer than the rest."""
    monkeypatch.setattr("pymoo_gridpath.plotting.save_figures", lambda *arguments, **options: [])


QUERY = ["--start", "2,4", "--goal", "14,4", "--objectives", "length", "--algorithm", "exact"]


def lines_of(captured):
    return captured.out.splitlines(), captured.err.splitlines()


@pytest.mark.usefixtures("without_figures")
@pytest.mark.parametrize(
    ("name", "options", "unknown", "length", "warned"),
    [
        ("nav2.yaml", [], "0 cells", "12.000", ["count as free, because free_thresh is 0.25"]),
        ("ros1.yaml", [], "15 cells, 9.8%, taken as occupied", "13.657", []),
        ("ros1.yaml", ["--unknown", "free"], "15 cells, 9.8%, taken as free", "12.000", []),
        ("nav2.yaml", ["--unknown", "free"], "0 cells", "12.000", ["15 cells of grey 205", "'unknown' has no effect"]),
        ("room.pgm", [], "0 cells", "12.000", ["nav2.yaml beside it"]),
        ("room.pgm", ["--unknown", "occupied"], "0 cells", "12.000", ["nav2.yaml beside it", "'unknown' has no effect"]),
    ],
)
def test_what_was_done_with_unknown_cells_is_said(room, capsys, name, options, unknown, length, warned):
    path = str(room / name)
    assert main(["info", path, *options]) == 0
    out, err = lines_of(capsys.readouterr())
    assert [line.split(maxsplit=1)[1] for line in out if line.startswith("unknown ")] == [unknown]
    assert main(["plan", path, *options, *QUERY, "-o", str(room / "out")]) == 0
    out_of_plan, err_of_plan = lines_of(capsys.readouterr())
    assert f"unknown: {unknown}" in out_of_plan
    with open(room / "out" / "paths.csv", newline="") as file:
        assert [f"{float(row['length']):.3f}" for row in csv.DictReader(file)] == [length]
    for lines in (err, [line for line in err_of_plan if line != COMPILING]):
        assert len(lines) == len(warned)
        for line, words in zip(lines, warned, strict=True):
            assert line.startswith(f"pymoo-gridpath: warning: {path}: ") and words in line
    record = json.loads((room / "out" / "paths.json").read_text())["settings"]["source_map"]
    assert record["unknown_cells"] == int(unknown.split()[0])


@pytest.mark.usefixtures("without_figures")
def test_maps_that_know_no_unknown_cells_do_not_speak_of_them(tmp_path, capsys):
    path = tmp_path / "map.txt"
    path.write_text(ROOM)
    assert main(["info", str(path)]) == 0
    assert main(["plan", str(path), *FAST, "-o", str(tmp_path)]) == 0
    out, err = lines_of(capsys.readouterr())
    assert not any(line.startswith("unknown") for line in out) and not any("warning" in line for line in err)


@pytest.mark.usefixtures("without_figures")
def test_a_radius_without_effect_is_said_by_plan_and_study(tmp_path, capsys):
    (tmp_path / "room.txt").write_text(ROOM)
    said = "pymoo-gridpath: warning: the robot radius of 0.1 m is at most half a cell of 'room', 1 m wide"
    assert main(["plan", str(tmp_path / "room.txt"), *FAST, "--radius", "0.1", "-o", str(tmp_path)]) == 0
    assert capsys.readouterr().err.count(said) == 1
    study = tmp_path / "study.toml"
    study.write_text(
        'name = "s"\nseeds = 1\nbudget = { generations = 2 }\n[[problems]]\nmap = "room.txt"\nstart = [0, 0]\ngoal = [5, 3]\n'
        'radius = 0.1\n[[algorithms]]\nalgorithm = "nsga2"\npop_size = 10\n'
    )
    assert main(["study", "check", str(study), "-o", str(tmp_path / "results")]) == 0
    captured = capsys.readouterr()
    assert captured.err.count(said) == 1 and "Warning" not in captured.err


@pytest.mark.parametrize("fate", ["removed", "changed"])
@pytest.mark.usefixtures("undrawn")
def test_a_map_that_goes_while_the_search_runs_loses_nothing(tmp_path, capsys, monkeypatch, fate):
    path = tmp_path / "map.txt"
    path.write_text(ROOM)
    read = load_map(path)
    search = plan._search

    def search_and_move(*arguments):
        path.unlink()
        if fate == "changed":
            path.write_text(ROOM.replace("#", "."))
        return search(*arguments)

    monkeypatch.setattr(plan, "_search", search_and_move)
    output = tmp_path / "out"
    assert main(["plan", str(path), *FAST, "--radius", "0.6", "-o", str(output)]) == 0
    names = {file.name for file in output.iterdir()}
    assert {"paths.csv", "paths.json", "map.png", "front.png", "convergence.png"} <= names
    record = json.loads((output / "paths.json").read_text())
    assert record["settings"]["source_map"] == {"occupied_cells": 2, "unknown_cells": None, "sha256": read.digest}
    assert record["map"]["sha256"] == read.inflate(0.6).digest


def test_a_study_goes_on_with_the_map_that_it_read(tmp_path):
    path = tmp_path / "room.txt"
    path.write_text(ROOM)
    problem = {"map": str(path), "start": (0, 0), "goal": (5, 3)}
    algorithms = [{"algorithm": "nsga2", "pop_size": 10}]
    plan = plan_study(Study(name="s", problems=[problem], algorithms=algorithms, seeds=1, budget={"generations": 2}))
    path.unlink()
    outcome = run_study(plan, tmp_path / "results")
    assert (outcome.n_run, outcome.n_failed) == (len(plan.runs), 0)
