"""The command line as a user meets it: its output, files and exit codes, in real processes where that matters."""

import csv
import io
import json
import os
import subprocess
import sys

import pytest
from command_lines import FAST, UNDRAWN, run, run_process

from pymoo_gridpath.cli import main
from pymoo_gridpath.maps import load_map, shipped_maps
from pymoo_gridpath.progress import COMPILING, Progress


def without_compiling(stderr):
    """Standard error without the line of the first search after an installation."""
    return stderr.removeprefix(f"{COMPILING}\n")


def test_plan_writes_figures_and_files_and_prints_the_table(tmp_path, free_map):
    out = tmp_path / "out"
    arguments = ["plan", free_map, "--start", "0,0", "--goal", "5,3", *FAST, "--seed", "4", "-o"]
    done = run_process(*arguments, out)
    assert done.returncode == 0, done.stderr
    assert without_compiling(done.stderr) == "", "progress must be silent in a pipe"
    assert "shortest" in done.stdout and "vulnerability" in done.stdout
    figures = {f"{name}.{kind}" for name in ("map", "front", "convergence") for kind in ("png", "pdf")}
    assert {file.name for file in out.iterdir()} == {"paths.csv", "paths.json", "population.npz", *figures}
    document = json.loads((out / "paths.json").read_text())
    with open(out / "paths.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    paths = document["paths"]
    assert len(rows) == len(paths) >= 1
    for path in paths:
        assert path["cells"][0] == [0, 0] and path["cells"][-1] == [5, 3] and path["interfering_cells"] == 0
        assert {"points", "length", "vulnerability", "turn", "names"} <= set(path)
    assert document["seed"] == 4
    shortest = load_map(free_map).shortest_lengths((0, 0))[3, 5]
    assert f"shortest of all paths on this grid has length {shortest:.3f}\n" in done.stdout
    assert min(path["length"] for path in paths) >= shortest - 1e-9
    # The same seed writes the same paths, in another process too.
    assert run(*arguments, tmp_path / "again").returncode == 0
    assert (tmp_path / "again" / "paths.csv").read_bytes() == (out / "paths.csv").read_bytes()


def test_plan_without_a_map_finds_legal_paths_on_a_shipped_one(tmp_path):
    """What `make demo` runs, with every default."""
    done = run_process("plan", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "warehouse" in done.stdout and (tmp_path / "gridpath-out" / "map.png").exists()


def test_plan_takes_the_query_of_a_text_map(tmp_path):
    path = tmp_path / "mine.txt"
    path.write_text("start: 1 0\ngoal: 4 2\n\n......\n..##..\n......\n")
    assert run("plan", path, *FAST, "-o", tmp_path / "out").returncode == 0
    query = json.loads((tmp_path / "out" / "paths.json").read_text())["query"]
    assert query == {"start": [1, 0], "goal": [4, 2]}


def test_files_say_which_map_was_read_and_which_was_planned_on(tmp_path, free_map):
    query = ["--start", "0,0", "--goal", "5,3"]
    assert run("plan", free_map, *query, "--resolution", "1", "--radius", "0.6", *FAST, "-o", tmp_path / "out").returncode == 0
    document = json.loads((tmp_path / "out" / "paths.json").read_text())
    assert document["settings"]["robot_radius"] == 0.6
    assert document["settings"]["source_map"]["occupied_cells"] == 2
    assert document["map"]["occupied_cells"] == load_map(free_map).grow(0.6).n_occupied > 2


def test_figures_of_an_earlier_set_do_not_stay(tmp_path, free_map):
    query = ["plan", free_map, "--start", "0,0", "--goal", "5,3", *FAST, "-o", tmp_path / "out"]
    assert run(*query, "--objectives", "length,vulnerability,turn").returncode == 0
    assert (tmp_path / "out" / "front_plane.png").exists()
    assert run(*query, "--objectives", "length").returncode == 0
    assert {file.stem for file in (tmp_path / "out").iterdir()} == {"paths", "population", "map", "convergence"}


def test_plan_finds_paths_that_turn_back(tmp_path):
    path = tmp_path / "spiral.txt"
    path.write_text("start: 0 0\ngoal: 2 2\n\n.....\n.###.\n...#.\n####.\n.....\n")
    done = run("plan", path, *FAST, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    document = json.loads((tmp_path / "out" / "paths.json").read_text())
    assert document["settings"]["representation"] == "cells"
    assert [len(found["cells"]) for found in document["paths"]] == [17]
    done = run("plan", path, "--representation", "integer", *FAST, "-o", tmp_path / "out")
    assert done.returncode == 2 and "representation='cells'" in done.stderr


@pytest.mark.parametrize(
    ("options", "representation"),
    [([], "cells"), (["--corner-cutting"], "integer"), (["--axis", "x"], "integer"), (["--representation", "mixed"], "mixed")],
)
@pytest.mark.usefixtures("undrawn")
def test_paths_may_turn_back_but_in_the_papers_world(tmp_path, free_map, options, representation):
    arguments = ["plan", free_map, "--start", "0,0", "--goal", "5,3", *FAST, "-o", tmp_path / "out", *options]
    assert main([*map(str, arguments)]) == 0
    assert json.loads((tmp_path / "out" / "paths.json").read_text())["settings"]["representation"] == representation


@pytest.mark.parametrize(
    ("options", "steps", "words"),
    [
        (["--moves", "4"], (False, 4), "no diagonal steps"),
        (["--one-side"], ("one side", 8), "corners may be cut on one side"),
    ],
)
@pytest.mark.usefixtures("undrawn")
def test_steps_are_an_option_of_maps(tmp_path, free_map, capsys, options, steps, words):
    arguments = ["plan", free_map, "--start", "0,0", "--goal", "5,3", "--algorithm", "exact", "-o", tmp_path / "out", *options]
    assert main([*map(str, arguments)]) == 0
    document = json.loads((tmp_path / "out" / "paths.json").read_text())
    assert (document["map"]["corner_cutting"], document["map"]["moves"]) == steps
    assert main(["info", str(free_map), *options]) == 0
    assert words in capsys.readouterr().out


@pytest.mark.usefixtures("undrawn")
def test_a_plan_may_be_content_with_a_front_that_is_near(tmp_path, capsys):
    assert main(["plan", "paper16", "--algorithm", "exact", "--epsilon", "5%", "-o", str(tmp_path)]) == 0
    assert "% of the front\n" in capsys.readouterr().out
    run = json.loads((tmp_path / "paths.json").read_text())["settings"]["runs"][0]
    assert run["complete"] is False and run["allowance"] == {"epsilon": 0.05}
    assert 0.0 < run["certified"]["epsilon"] <= 0.05 and run["message"].endswith("% of the front")


@pytest.mark.parametrize(
    ("options", "stated"),
    [
        ([], {"name": "vulnerability", "variance": 0.5, "nearest": False, "cutoff": 0.0}),
        (["--resolution", "0.05"], {"name": "vulnerability", "sigma_m": 0.3, "nearest": True, "cutoff": 1e-06}),
        (
            ["--resolution", "0.05", "--risk", "robot"],
            {"name": "vulnerability", "sigma_m": 0.3, "nearest": True, "cutoff": 1e-06},
        ),
        (
            ["--resolution", "0.05", "--sigma-m", "2"],
            {"name": "vulnerability", "sigma_m": 2.0, "nearest": True, "cutoff": 1e-06},
        ),
        (
            ["--resolution", "0.05", "--risk", "paper"],
            {"name": "vulnerability", "variance": 0.5, "nearest": False, "cutoff": 0.0},
        ),
        (
            ["--resolution", "0.05", "--risk", "inflation"],
            {"name": "inflation", "cost_scaling_factor": 10.0, "inflation_radius": 0.55},
        ),
    ],
)
def test_plan_takes_a_risk_and_files_say_which(tmp_path, free_map, options, stated):
    done = run("plan", free_map, "--start", "0,0", "--goal", "5,3", "--algorithm", "exact", "-o", tmp_path / "out", *options)
    assert done.returncode == 0, done.stderr
    document = json.loads((tmp_path / "out" / "paths.json").read_text())
    assert document["settings"]["objectives"] == [{"name": "length"}, stated]


def test_plan_says_that_a_front_is_one_point(tmp_path, free_map):
    query = ("plan", free_map, "--start", "0,0", "--goal", "5,0", "--algorithm", "exact", "-o", tmp_path / "out")
    done = run(*query, "--resolution", "0.05", "--risk", "paper")
    said = "the front found is one point, a path that is best by every objective; a wider risk, such as variance=2 or"
    assert done.stderr.count(said) == 1 and f"NOTE: {said}" in done.stdout


@pytest.mark.parametrize("algorithm", ["spea2", "moea/d", "NSGA-III"])
def test_plan_takes_other_algorithms_and_settings(tmp_path, free_map, algorithm):
    done = run(
        *("plan", free_map, "--start", "0,0", "--goal", "5,3", "--algorithm", algorithm, *FAST),
        *("--representation", "mixed", "--objectives", "length,vulnerability,turn", "--runs", "2", "-o", tmp_path / "out"),
        *("--units", "m", "--obstacles", "penalty", "--resolution", "0.5", "--corner-cutting", "--radius", "0.1"),
    )
    assert done.returncode == 0, done.stderr
    document = json.loads((tmp_path / "out" / "paths.json").read_text())
    assert document["map"]["resolution"] == 0.5 and document["map"]["corner_cutting"] is True
    assert document["seed"] == [1, 2]
    assert "of 2 runs found a legal path" in done.stdout


def test_plan_takes_operators_by_name(tmp_path, free_map):
    query = ["plan", free_map, "--start", "0,0", "--goal", "5,3", *FAST, "-o", tmp_path / "out"]
    done = run(*query, "--operators", "sampling=ReachableSampling,mutation=PathMutation")
    assert done.returncode == 0, done.stderr
    document = json.loads((tmp_path / "out" / "paths.json").read_text())
    assert document["settings"]["runs"][0]["operators"]["sampling"]["name"] == "ReachableSampling"
    for given, message in (
        ("mutation=PathMutatoin", "there is no mutation 'PathMutatoin'; did you mean 'PathMutation'?"),
        ("mutations=PathMutation", "did you mean 'mutation'?"),
    ):
        done = run(*query, "--operators", given)
        assert done.returncode == 2 and message in done.stderr, done.stderr
    done = run(*query[:6], "--algorithm", "exact", "--operators", "mutation=PathMutation")
    assert done.returncode == 2 and "--operators is not for --algorithm exact" in done.stderr


@pytest.mark.parametrize("given", ["", "mutation", "mutation=", "mutation=A,mutation=B", "a=b=c"])
def test_texts_that_name_no_operators_are_refused(free_map, given, capsys):
    with pytest.raises(SystemExit) as ended:
        main(["plan", str(free_map), "--operators", given])
    assert ended.value.code == 2 and f"{given!r} names no operators" in capsys.readouterr().err


def test_plan_with_one_objective(tmp_path, free_map):
    done = run("plan", free_map, "--start", "0,0", "--goal", "5,3", "--objectives", "length", *FAST, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert "shortest" in done.stdout


@pytest.mark.usefixtures("undrawn")
def test_paths_that_are_much_too_long_are_remarked_on_once(tmp_path, capsys):
    # The short way is past the top of the wall, one column back; the way that never turns back is past its foot.
    path = tmp_path / "wall.txt"
    path.write_text("\n".join(["........", ".....##.", *["......#."] * 10, "........"]))
    query = ["plan", str(path), "--start", "5,10", "--goal", "7,12", "-o", str(tmp_path / "out")]
    assert main([*query, "--axis", "x", "--algorithm", "exact"]) == 0
    captured = capsys.readouterr()
    assert captured.out.count("NOTE: ") == 1 and "; the shortest path found is" in captured.out
    assert len([line for line in captured.err.splitlines() if "longer than the shortest of all; try the" in line]) == 1
    assert main([*query, "--representation", "cells", "--algorithm", "exact"]) == 0
    captured = capsys.readouterr()
    assert "for comparison" in captured.out and "longer" not in captured.out + captured.err
    assert main([*query, "--objectives", "vulnerability,turn", "--algorithm", "exact"]) == 0
    assert "for comparison" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["plan", "nowhere.map"], "nowhere.map"),
        (["plan", "warehuose"], "warehouse"),
        (["plan", "MAP"], "needs --start and --goal"),
        (["plan", "MAP", "--start", "0,0"], "needs --goal"),
        (["plan", "MAP", "--start", "0;0", "--goal", "5,3"], "expected X,Y"),
        (["plan", "MAP", "--start", "2,2", "--goal", "5,3"], "start (2, 2) lies on an obstacle"),
        (["plan", "MAP", "--start", "0,0", "--goal", "6,3"], "goal (6, 3) lies outside"),
        (["plan", "MAP", "--start", "-1,0", "--goal", "5,3"], "start (-1, 0) lies outside"),
        (["plan", "MAP", "--start", "9" * 30 + ",0", "--goal", "5,3"], "lies outside"),
        (["plan", "paper16", "--resolution", "1e-300", "--radius", "1e10"], "robot's radius"),
        (["plan", "paper16", "--resolution", "1e308"], "beyond what numbers can hold"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "--penalty", "5", "--obstacles", "constraint"], "penalty is for"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "--pop-size", "3", "--algorithm", "gde3"], "at least 4"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "--algorithm", "nsga9"], "did you mean"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "--algorithm", "exakt"], "did you mean 'exact'"),
        (["plan", "paper16", "--algorithm", "exact", "--generations", "5"], "--generations is not for --algorithm exact"),
        (["plan", "paper16", "--algorithm", "exact", "--pop-size", "5"], "--pop-size is not for --algorithm exact"),
        (["plan", "paper16", "--algorithm", "nsga2", "--epsilon", "2%"], "--epsilon is not for --algorithm nsga2"),
        (
            ["plan", "paper16", "--algorithm", "exact", "--share", "2x"],
            "not a number above 0, at most 1, or per cent such as 2%",
        ),
        (["plan", "paper16", "--algorithm", "exact", "--epsilon", "2%", "--share", "0.1"], "not allowed with argument"),
        (["plan", "paper16", "--algorithm", "exact", "--runs", "2"], "--runs is not for --algorithm exact"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "--algorithm", "MOPSO_CD"], "MOPSO_CD"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "--representation", "real"], "there is no representation 'real'"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "--representation", "cells", "--axis", "y"], "advance along none"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "--objectives", "lenght"], "did you mean 'length'"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "--resolution", "1", "--radius", "5"], "robot's radius of 5 m"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "--radius", "5"], "is in cells, and a radius in metres needs"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "--risk", "robot"], "in cells, and --risk robot needs their size"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "--sigma-m", "1"], "in cells, and --sigma-m 1 needs their size"),
        (["plan", "office", "--sigma-m", "0"], "sigma_m of the potential is 0.0, expected a positive number of metres"),
        (["plan", "office", "--sigma-m", "1", "--risk", "paper"], "--sigma-m is for the robot's risk, not for --risk paper"),
        (["plan", "office", "--objectives", "length,turn", "--risk", "paper"], "--risk is for the objective vulnerability"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "--units", "m"], "is in cells, and --units m needs their size"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "--radius", "-1"], "robot radius is -1"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "--pop-size", "0"], "'0' is not a whole number, one or more"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "--pop-size", "ten"], "'ten' is not a whole number"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "--potential-limit", "3"], "potential_limit is for"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "--threshold", "0.5"], "threshold"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "-o", "MAP"], "is a file"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "-o", "MAP/deeper"], "output directory"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "-o", ""], "'' is not a folder"),
        (["plan", "MAP", "--start", "0,0", "--goal", "5,3", "--obstacles", "limit"], "needs --potential-limit P0"),
        (["info", "broken.yaml"], "broken.yaml"),
        (["info"], "required: MAP"),
        (["fly"], "invalid choice"),
        ([], "required"),
    ],
)
def test_bad_input_gives_one_line_and_exit_code_2(tmp_path, free_map, arguments, message, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "broken.yaml").write_text("- not\n- a mapping\n")
    arguments = [a.replace("MAP", str(free_map)) for a in arguments]
    try:
        code = main(arguments)
    except SystemExit as error:
        code = error.code
    captured = capsys.readouterr()
    assert code == 2
    assert captured.err.count("\n") == 1 and captured.err.startswith("pymoo-gridpath") and message in captured.err
    assert captured.out == ""


def test_no_legal_path_is_said_and_exits_with_1(tmp_path):
    # Walls with one gap each, far apart: two individuals and one generation will not find the way.
    gaps = {2: 0, 5: 11, 8: 0, 11: 11, 14: 0, 17: 11}
    rows = ["".join("#" if gaps.get(x, y) != y else "." for x in range(20)) for y in range(12)]
    grid = tmp_path / "walls.txt"
    grid.write_text("\n".join(rows))
    arguments = ["plan", grid, "--start", "0,5", "--goal", "19,5", "--pop-size", "2", "--generations", "1"]
    done = run(*arguments, "--representation", "integer", "-o", tmp_path / "out")
    assert done.returncode == 1, done.stdout + done.stderr
    assert "no legal path was found" in done.stderr
    assert (tmp_path / "out" / "paths.json").exists()


# Presses Ctrl-C after the third generation, so often as the first argument says.
INTERRUPTED = """
import os, signal, sys
from pymoo.core.algorithm import Algorithm

times = int(sys.argv.pop(1))

def go_on_and_interrupt(self, go_on=Algorithm.next):
    go_on(self)
    for _ in range(times if self.n_iter == 4 else 0):
        os.kill(os.getpid(), signal.SIGINT)

# Processes that are started in the background may have been told to ignore it.
signal.signal(signal.SIGINT, signal.default_int_handler)
Algorithm.next = go_on_and_interrupt
"""


def interrupted(times, out):
    arguments = ["plan", "paper16", "--generations", "100000", "--pop-size", "40", "-o", str(out)]
    done = subprocess.run(
        [sys.executable, "-c", INTERRUPTED + UNDRAWN, str(times), *arguments], capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 130
    assert "stopping, and keeping what was found" in done.stderr and "Traceback" not in done.stderr
    return done


def test_ctrl_c_keeps_the_front_found_so_far(tmp_path):
    done = interrupted(1, tmp_path)
    assert "interrupted" in done.stderr
    document = json.loads((tmp_path / "paths.json").read_text())
    assert document["paths"] and "shortest" in done.stdout


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_closed_pipe_is_no_error_and_loses_no_file(tmp_path, free_map, unbuffered):
    environment = {**os.environ, "PYTHONUNBUFFERED": unbuffered}
    program = f"{sys.executable} -m pymoo_gridpath.cli"
    plan = f"plan {free_map} --start 0,0 --goal 5,3 {' '.join(FAST)} -o {tmp_path / 'out'}"
    for command in (f"{program} maps | true", f"{program} {plan} | head -1"):
        done = subprocess.run(command, shell=True, capture_output=True, text=True, check=False, env=environment)
        assert without_compiling(done.stderr) == ""
    assert (tmp_path / "out" / "paths.json").exists()


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs the device /dev/full")
def test_full_disk_is_said_in_one_line():
    command = f"{sys.executable} -m pymoo_gridpath.cli maps > /dev/full"
    done = subprocess.run(command, shell=True, capture_output=True, text=True, check=False)
    assert done.returncode == 2 and done.stderr.count("\n") == 1 and "cannot be written" in done.stderr


def test_letters_that_the_terminal_lacks_are_no_error(tmp_path):
    path = tmp_path / "map.txt"
    path.write_text("name: K\u00fcche\n\n...\n...\n", encoding="utf-8")
    done = run_process("info", path, env={**os.environ, "PYTHONIOENCODING": "ascii"})
    assert done.returncode == 0 and "K\\xfcche" in done.stdout


def test_second_ctrl_c_ends_at_once(tmp_path):
    done = interrupted(2, tmp_path)
    assert "shortest" not in done.stdout and not (tmp_path / "paths.json").exists()


def test_ctrl_c_in_compiled_code_ends_at_once(monkeypatch, capsys):
    """A signal there comes as a SystemError, caused by KeyboardInterrupt."""

    def interrupted(*args):
        raise SystemError("a kernel returned a result with an exception set") from KeyboardInterrupt()

    monkeypatch.setattr("pymoo_gridpath.maps.shipped_maps", interrupted)
    assert main(["maps"]) == 130
    assert capsys.readouterr().err == "pymoo-gridpath: interrupted\n"


def test_maps_lists_every_shipped_map(capsys):
    assert main(["maps"]) == 0
    out = capsys.readouterr().out
    for item in shipped_maps():
        grid = load_map(item.name)
        line = next(line for line in out.splitlines() if line.startswith(item.name))
        assert f"{grid.width} x {grid.height}" in " ".join(line.split())
        assert f"from {item.start[0]},{item.start[1]} to {item.goal[0]},{item.goal[1]}" in line


def test_info_describes_a_file(free_map, capsys):
    assert main(["info", str(free_map), "--resolution", "0.5"]) == 0
    out = capsys.readouterr().out
    assert "6 x 4 cells, 3 x 2 m" in out and "2 cells, 8.3%" in out and "0.5 m a cell" in out
    assert main(["info", str(free_map)]) == 0
    out = capsys.readouterr().out
    assert "6 x 4 cells\n" in out and "not stated: a map in cells; --resolution M" in out and "origin" not in out
    assert main(["info", "office"]) == 0
    assert "query" in capsys.readouterr().out


def test_version_and_help(capsys):
    for arguments in (["--version"], ["--help"], ["plan", "--help"]):
        with pytest.raises(SystemExit) as stop:
            main(arguments)
        assert stop.value.code == 0
    assert "pymoo-gridpath 0." in capsys.readouterr().out


class FakeAlgorithm:
    def __init__(self, perc):
        self.termination = type("T", (), {"perc": perc})()


def test_progress_shows_on_a_terminal_and_clears_its_line():
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    stream = Terminal()
    with Progress(3, 200, stream, interval=0) as progress:
        progress.update(1, FakeAlgorithm(0.25), lambda algorithm: 2)
    text = stream.getvalue()
    assert "run 2/3, generation 50/200, 2 legal paths" in text and "s left" in text
    assert text.endswith("\r\x1b[K")
    silent = io.StringIO()
    with Progress(3, 200, silent, interval=0) as progress:
        progress.update(1, FakeAlgorithm(0.25), lambda algorithm: 2)
    assert silent.getvalue() == ""


def test_progress_appears_on_a_real_terminal(tmp_path, free_map):
    pty = pytest.importorskip("pty", reason="there are no pseudo-terminals on Windows")
    master, slave = pty.openpty()
    command = [sys.executable, "-c", UNDRAWN, "plan", str(free_map), "--start", "0,0", "--goal", "5,3"]
    command += ["--pop-size", "50", "--generations", "60", "-o", str(tmp_path / "out")]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=slave)
    assert process.wait(timeout=120) == 0
    os.close(slave)
    shown = os.read(master, 100_000).decode()
    os.close(master)
    assert "generation" in shown and "legal paths" in shown
