"""Plans that begin with the last population of an earlier one."""

from __future__ import annotations

import contextlib
import io
import json
import shutil
from unittest import mock

import numpy as np
import pytest
from matplotlib.figure import Figure

from pymoo_gridpath.cli import main
from pymoo_gridpath.decision import load_json


def run(*arguments):
    with (
        contextlib.redirect_stdout(io.StringIO()) as out,
        contextlib.redirect_stderr(io.StringIO()) as err,
        mock.patch.object(Figure, "savefig", lambda figure, *args, **kwargs: None),
    ):
        try:
            status = main([str(one) for one in arguments])
        except SystemExit as error:
            status = error.code
    return status, out.getvalue(), err.getvalue()


@pytest.fixture(scope="module")
def first(tmp_path_factory):
    """Two short runs on a turned map, for a robot with a body."""
    folder = tmp_path_factory.mktemp("first")
    (folder / "room.txt").write_text(
        "resolution: 0.5\norigin: 1 2 0.3\n\n" + "............\n" * 3 + "...##..#....\n" * 3 + "............\n" * 4
    )
    what = ["--start", "0,0", "--goal", "11,9", "--radius", "0.3", "--objectives", "length,vulnerability,turn"]
    what += ["--pop-size", "12", "--generations", "3", "--runs", "2", "--seed", "5"]
    status, _, err = run("plan", folder / "room.txt", *what, "-o", folder / "out")
    assert status == 0, err
    (folder / "room.txt").unlink()
    return folder / "out"


def populations(folder):
    with np.load(folder / "population.npz", allow_pickle=False) as found:
        return [found[f"run_{k}"] for k in range(len(found.files))]


def test_it_begins_with_what_was_left(first, tmp_path):
    """With no generation of its own but the first, the population is the one before."""
    before = populations(first)
    assert [len(X) for X in before] == [12, 12]
    status, out, err = run("plan", "--resume", first, "--generations", "1", "-o", tmp_path / "on")
    assert status == 0, err
    assert f"resumed: a new start from the last population of 2 runs in {first} (12, 12 members), not what" in out
    for X, Y in zip(before, populations(tmp_path / "on"), strict=True):
        np.testing.assert_array_equal(np.unique(X, axis=0), np.unique(Y, axis=0))
    stored, found = (load_json(folder / "paths.json") for folder in (first, tmp_path / "on"))
    np.testing.assert_array_equal(stored.F, found.F)
    assert found.problem.grid == stored.problem.grid and found.problem.objective_names == stored.problem.objective_names
    assert found.problem.grid.robot_radius == 0.3
    settings = found.meta["settings"]
    assert settings["source_map"] == stored.meta["settings"]["source_map"] and settings["resumed_from_seed"] == [5, 6]
    assert settings["algorithm"] == {"name": "nsga2"} and settings["runs"][1]["operators"]["sampling"]["name"] == "GivenRows"


def test_it_goes_on_and_can_go_on_again(first, tmp_path):
    for k, where in enumerate([first, tmp_path / "0"]):
        status, _, err = run("plan", "--resume", where, "--generations", "4", "--seed", 9, "-o", tmp_path / str(k))
        assert status == 0, err
    stored, found = (load_json(folder / "paths.json") for folder in (first, tmp_path / "1"))
    for objective, name in (("length", "shortest"), ("turn", "smoothest")):
        assert found[name].objectives[objective] <= stored[name].objectives[objective]
    # The same seed and folder give the same again.
    run("plan", "--resume", first, "--generations", "4", "--seed", 9, "-o", tmp_path / "again")
    assert (tmp_path / "again" / "paths.csv").read_bytes() == (tmp_path / "0" / "paths.csv").read_bytes()


@pytest.mark.parametrize(("algorithm", "pop_size"), [("nsga2", 5), ("nsga2", 30), ("moead", 20), ("nsga3", 14)])
def test_other_algorithms_and_sizes(first, tmp_path, algorithm, pop_size):
    """The first members, or all and some that are sampled."""
    what = ["--algorithm", algorithm, "--pop-size", pop_size, "--generations", "2", "-o", tmp_path / "on"]
    status, _, err = run("plan", "--resume", first, *what)
    assert status in (0, 1) and "Traceback" not in err, err
    assert len(populations(tmp_path / "on")) == 2


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--start", "1,1"], "--start is not for --resume"),
        (["office"], "MAP is not for --resume"),
        (["--objectives", "length"], "--objectives is not for --resume"),
        (["--runs", "3"], "--runs is not for --resume"),
        (["--radius", "0.5"], "--radius is not for --resume"),
        (["--corner-cutting"], "--corner-cutting is not for --resume"),
        (["--operators", "sampling=RandomSampling"], "--operators sampling is not for --resume"),
        (["--algorithm", "exact"], "--resume is not for --algorithm exact, a planner"),
        (["--algorithm", "nsga"], "there is no"),
        (["--speed", "3"], "--speed is for --waypoints f1tenth"),
    ],
)
def test_what_the_folder_decides_is_refused(first, tmp_path, arguments, words):
    status, _, err = run("plan", *arguments, "--resume", first, "-o", tmp_path / "on")
    assert status == 2 and words in err and err.count("\n") == 1
    assert not (tmp_path / "on").exists()


def damaged(first, tmp_path, name):
    """A copy of the folder in which something is wrong, and what is said of it."""
    folder = tmp_path / "damaged"
    shutil.copytree(first, folder)
    file = folder / "population.npz"
    if name == "missing":
        file.unlink()
        return folder, "no such file, expected the plan of an algorithm with a population"
    if name == "no archive":
        file.write_bytes(b"PK\x03\x04 no archive")
        return folder, "the populations cannot be read"
    if name == "objects":
        np.savez(file, run_0=np.array([[{}]], dtype=object))
        return folder, "the populations cannot be read"
    if name == "no runs":
        np.savez(file)
        return folder, "a population is not of the problem in paths.json"
    if name == "another problem":
        np.savez(file, run_0=np.zeros((4, 3), dtype=int))
        return folder, "a population is not of the problem in paths.json"
    if name == "beyond bounds":
        np.savez(file, run_0=populations(first)[0] + 10**6)
        return folder, "a population is not of the problem in paths.json"
    if name == "own objective":
        stored = json.loads((folder / "paths.json").read_text())
        stored["settings"]["objectives"][2]["name"] = stored["objectives"][2] = "mine"
        stored["labels"]["mine"] = "Mine"
        for record in stored["paths"]:
            record["objectives"]["mine"] = record["objectives"].pop("turn")
        (folder / "paths.json").write_text(json.dumps(stored))
        return folder, "what the objective 'mine' costs is not stored"
    (folder / "paths.json").unlink()
    return folder, "the file cannot be read"


NAMES = ["missing", "no runs", "no archive", "objects", "another problem", "beyond bounds", "own objective", "no paths"]


@pytest.mark.parametrize("name", NAMES)
def test_folders_that_are_none(first, tmp_path, name):
    folder, words = damaged(first, tmp_path, name)
    status, _, err = run("plan", "--resume", folder, "-o", tmp_path / "on")
    assert status == 2 and words in err and err.count("\n") == 1


def test_a_planner_leaves_no_population(first, tmp_path):
    shutil.copytree(first, tmp_path / "out")
    (tmp_path / "room.txt").write_text(".....\n" * 4)
    what = ["plan", tmp_path / "room.txt", "--start", "0,0", "--goal", "4,3", "--algorithm", "exact", "-o", tmp_path / "out"]
    assert run(*what)[0] == 0
    assert not (tmp_path / "out" / "population.npz").exists()


@pytest.fixture(scope="module")
def muddy(tmp_path_factory):
    """A short run on ground that costs something."""
    folder = tmp_path_factory.mktemp("muddy")
    (folder / "room.txt").write_text("......\n..##..\n......\n......\n")
    np.save(folder / "mud.npy", np.arange(24.0).reshape(4, 6))
    np.save(folder / "hills.npy", np.arange(24.0).reshape(4, 6) % 5)
    ground = ["--cost", f"{folder / 'mud.npy'}:2", "--climb", folder / "hills.npy"]
    what = ["--start", "0,0", "--goal", "5,3", "--pop-size", "12", "--generations", "2", *ground]
    status, _, err = run("plan", folder / "room.txt", *what, "-o", folder / "out")
    assert status == 0, err
    for name in ("mud.npy", "hills.npy"):
        (folder / name).unlink()
    return folder / "out"


def test_it_knows_what_the_ground_costs(muddy, tmp_path):
    """Its files may be gone."""
    for k, where in enumerate([muddy, tmp_path / "0"]):
        status, _, err = run("plan", "--resume", where, "--generations", "1", "--seed", 3, "-o", tmp_path / str(k))
        assert status == 0, err
    stored, found = (load_json(folder / "paths.json") for folder in (muddy, tmp_path / "1"))
    np.testing.assert_array_equal(stored.F, found.F)
    assert found.problem.objective_names == ["length", "vulnerability", "ground", "climb"] == stored.problem.objective_names


def test_costs_that_do_not_fit_are_refused(muddy, tmp_path):
    shutil.copytree(muddy, tmp_path / "out")
    with np.load(muddy / "population.npz") as found:
        arrays = dict(found)
    arrays["ground.cost"] = arrays["ground.cost"] + 1.0
    np.savez(tmp_path / "out" / "population.npz", **arrays)
    status, _, err = run("plan", "--resume", tmp_path / "out", "-o", tmp_path / "on")
    assert status == 2 and "what the ground costs does not fit paths.json" in err and err.count("\n") == 1
