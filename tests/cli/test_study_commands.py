"""The commands `study init`, `check`, `run` and `report`."""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import time

import pytest
from pymoo.core.algorithm import Algorithm

from pymoo_gridpath.cli.study import add_study_commands
from pymoo_gridpath.errors import GridPathError, StudyError
from pymoo_gridpath.progress import COMPILING
from pymoo_gridpath.study.planning.estimate import estimate
from pymoo_gridpath.study.planning.expand import plan_study
from pymoo_gridpath.study.running.execute import execute
from pymoo_gridpath.study.running.store import Store
from pymoo_gridpath.study.specification.study import Study
from pymoo_gridpath.study.specification.toml_file import load_study, write_starter

TINY = """
seeds = 2
budget = { generations = 2 }
[[problems]]
random = { size = 8, p0 = 0.1, seeds = 2 }
[[algorithms]]
algorithm = "NSGA2"
pop_size = 8
[[algorithms]]
algorithm = "exact"
"""


def without_compiling(stderr: str) -> str:
    return stderr.removeprefix(f"{COMPILING}\n")


def call(*arguments) -> int:
    """Call a command as `pymoo-gridpath` does."""
    parser = argparse.ArgumentParser(prog="pymoo-gridpath")
    add_study_commands(parser.add_subparsers(required=True))
    parsed = parser.parse_args(["study", *map(str, arguments)])
    return parsed.run(parsed)


@pytest.fixture
def tiny(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tiny.toml").write_text(TINY)
    return tmp_path


# -- init ---------------------------------------------------------------------------------------------------------------


def test_init_writes_a_study_and_never_over_a_file(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert call("init") == 0
    assert "study.toml" in capsys.readouterr().out
    before = (tmp_path / "study.toml").read_bytes()
    with pytest.raises(StudyError, match="exists already"):
        call("init")
    assert (tmp_path / "study.toml").read_bytes() == before
    with pytest.raises(StudyError, match="cannot be written"):
        call("init", tmp_path / "nowhere" / "x.toml")


def test_starter_is_sound_and_all_of_its_comments_are(tmp_path):
    path = write_starter(tmp_path / "study.toml")
    plan = plan_study(load_study(path))
    assert 100 < len(plan.runs) < 200
    assert len({problem.group for problem in plan.problems}) == 2
    # What it offers in comments holds too, but for the files that it does not bring.
    text = path.read_text()
    keys = re.findall(r"^# (\w+ = .*)$", text, re.MULTILINE)
    assert len(keys) >= 8
    for line in keys:
        if not line.startswith(("scen", "queries", "algorithm = ", "suite", 'objectives = ["length", "ascent"]')):
            with_it = text.replace(f"# {line}", _without_alternative(text, line), 1)
            if line.startswith("moving"):
                paper = with_it.index('[[algorithms]]\nname = "paper"')
                with_it = with_it[:paper] + with_it[with_it.index("[[algorithms]]", paper + 1) :]
            (tmp_path / "one.toml").write_text(with_it)
            plan_study(load_study(tmp_path / "one.toml"))
    suite = re.sub(r"# (\[\[problems\]\]\n)# (suite = .*\n)# (objectives)", r"\1\2\3", text)
    (tmp_path / "one.toml").write_text(suite)
    assert plan_study(load_study(tmp_path / "one.toml")).problems[-1].label.startswith("ASLETISMAC")
    exact = text.replace("# [[algorithms]]\n# algorithm", "[[algorithms]]\nalgorithm")
    assert exact != text
    (tmp_path / "one.toml").write_text(exact)
    assert plan_study(load_study(tmp_path / "one.toml")).algorithms[-1].label == "exact"


def _without_alternative(text: str, line: str) -> str:
    """Return a line of the starter, unless its key is set already, where a comment shows another form of it."""
    return f"# {line}" if line.startswith("operators") else line


def test_starter_runs(tmp_path, monkeypatch, capsys):
    """With fewer evaluations and seeds; as it is, it takes about a minute."""
    monkeypatch.chdir(tmp_path)
    path = write_starter()
    path.write_text(path.read_text().replace("evaluations = 2000", "evaluations = 200").replace("seeds = 11 ", "seeds = 2 "))
    assert call("run", path) == 0
    assert call("run", path) == 0
    assert "done: 0 run now, 28 before, 0 failed" in capsys.readouterr().out


# -- check --------------------------------------------------------------------------------------------------------------


def test_check(tiny, capsys):
    assert call("check", "tiny.toml") == 0
    out = capsys.readouterr().out
    assert "tiny: 2 problems, 2 algorithms, 2 seeds\nruns: 6\ntime: about " in out
    assert not (tiny / "tiny-results").exists()
    assert call("run", "tiny.toml") == 0
    key = plan_study(load_study("tiny.toml")).runs[3].key
    Store("tiny-results").path(key).unlink()
    capsys.readouterr()
    assert call("check", "tiny.toml", "--jobs", 2) == 0
    out = capsys.readouterr().out
    assert "stored in tiny-results: 5; to run: 1" in out
    assert "time: about 1 s with 2 processes" in out
    assert not Store("tiny-results").path(key).exists()


def test_check_refuses_with_the_line(tiny):
    (tiny / "tiny.toml").write_text(TINY.replace("NSGA2", "NSGA1"))
    with pytest.raises(StudyError, match=r"tiny\.toml, line 7: there is no algorithm 'NSGA1'"):
        call("check", "tiny.toml")


@pytest.fixture
def processor_time(monkeypatch):
    """Have the clock count what this process works, so that nothing depends on what else the computer does."""
    monkeypatch.setattr("time.perf_counter", time.process_time)


def test_estimate_is_near_the_truth(processor_time):
    plan = plan_study(
        Study.from_dict(
            {
                "problems": [{"random": {"size": 16, "p0": 0.2, "seeds": 2}}],
                "algorithms": [{"algorithm": "NSGA2", "pop_size": 40}, {"algorithm": "SPEA2", "pop_size": 40}],
                "seeds": 2,
                "budget": {"generations": 60},
            }
        )
    )
    found = estimate(plan, max_seconds=1.0)
    begin = time.perf_counter()
    for run in plan.runs:
        execute(plan.task(run))
    took = time.perf_counter() - begin
    assert (found.n_measured, found.n_kinds, found.open_ended) == (3, 3, False)
    # Loosely, since generations differ, and processors change their speed.
    assert took / 5 < found.seconds < took * 5


def test_estimate_does_not_count_compiling(monkeypatch):
    """Every generation takes a second, and ten minutes of compiling besides the first time that it is the second of a run."""
    event = pytest.importorskip("numba").core.event
    now, compiled_yet = [0.0], []
    monkeypatch.setattr("time.perf_counter", lambda: now[0])
    next_generation = Algorithm.next

    def slow(algorithm):
        second = algorithm.n_iter == 2
        next_generation(algorithm)
        now[0] += 1.0
        if second and not compiled_yet:
            compiled_yet.append(True)
            event.start_event("numba:compiler_lock")
            now[0] += 600.0
            event.end_event("numba:compiler_lock")

    monkeypatch.setattr(Algorithm, "next", slow)
    plan = plan_study(
        Study.from_dict(
            {
                "problems": [{"random": {"size": 8, "p0": 0.1}}],
                "algorithms": [{"algorithm": "NSGA2", "pop_size": 10}],
                "seeds": 3,
                "budget": {"generations": 40},
                "reference": {"max_labels": 1},
            }
        )
    )
    runs = [run for run in plan.runs if run.algorithm is not None]
    assert estimate(plan, runs, max_seconds=5.0).seconds == 3 * 40
    assert compiled_yet


def test_estimate_keeps_to_its_time_and_says_what_is_open(processor_time):
    plan = plan_study(
        Study.from_dict(
            {
                "problems": [{"random": {"size": 200, "p0": 0.2}, "objectives": ["length", "vulnerability", "turn"]}],
                "algorithms": [{"algorithm": "NSGA2", "pop_size": 20}],
                "seeds": 1000,
                "budget": {"evaluations": 10**7},
                "reference": {"max_seconds": 5000},
            }
        )
    )
    begin = time.perf_counter()
    found = estimate(plan, max_seconds=1.0)
    assert time.perf_counter() - begin < 20
    assert found.open_ended
    assert found.seconds > 5000


# -- run ----------------------------------------------------------------------------------------------------------------


def test_run_and_go_on(tiny, capsys):
    assert call("run", "tiny.toml", "-o", "here", "--jobs", 2) == 0
    assert "done: 6 run now, 0 before, 0 failed\nnext: pymoo-gridpath study report here" in capsys.readouterr().out
    assert (tiny / "here" / "study.toml").read_text() == TINY
    (tiny / "tiny.toml").write_text(TINY.replace("seeds = 2\nbudget", "seeds = 3\nbudget"))
    assert call("run", "tiny.toml", "--output", "here") == 0
    assert "done: 2 run now, 6 before, 0 failed" in capsys.readouterr().out


def test_failed_runs_give_exit_code_one(tiny, capsys, monkeypatch):
    def broken(*arguments):
        raise ValueError("broken")

    # What passes every check, and no run.
    for module in ("running.execute", "planning.estimate"):
        monkeypatch.setattr(f"pymoo_gridpath.study.{module}.build_algorithm", broken)
    assert call("run", "tiny.toml") == 1
    captured = capsys.readouterr()
    assert "6 run now, 0 before, 6 failed" in captured.out
    assert without_compiling(captured.err).startswith("pymoo-gridpath: 6 runs were stored as failed, such as ")
    with pytest.raises(GridPathError, match=r"fails on the problem 'random-8-0.1/1': ValueError: broken"):
        call("check", "tiny.toml", "--output", "elsewhere")


@pytest.mark.parametrize(
    "arguments",
    [
        ("run", "tiny.toml", "--jobs", "0"),
        ("run", "tiny.toml", "--jobs", "2", "--dask", "tcp://127.0.0.1:1"),
        ("check",),
        ("report", "x", "--target", "1.5"),
        (),
    ],
)
def test_bad_arguments(tiny, arguments, capsys):
    with pytest.raises(SystemExit) as info:
        call(*arguments)
    assert info.value.code == 2


def test_run_refuses_a_bad_study_before_anything(tiny):
    (tiny / "tiny.toml").write_text(TINY.replace("size = 8", "size = 0"))
    with pytest.raises(StudyError, match="line 5: size is 0"):
        call("run", "tiny.toml")
    assert os.listdir(tiny) == ["tiny.toml"]


# -- report -------------------------------------------------------------------------------------------------------------


def test_report(tiny, capsys):
    assert call("run", "tiny.toml") == 0
    capsys.readouterr()
    assert call("report", "tiny-results", "--target", "0.8") == 0
    out = capsys.readouterr().out
    page = re.search(r"page: (.*)", out)
    assert page is not None
    assert os.path.isfile(page[1])
    with pytest.raises(GridPathError, match=r"plan\.json"):
        call("report", tiny)


# -- imports ------------------------------------------------------------------------------------------------------------


def test_help_loads_no_search():
    code = (
        "import contextlib, sys; from pymoo_gridpath.cli import main\n"
        "with contextlib.suppress(SystemExit): main(['study', 'run', '--help'])\n"
        "names = ('pymoo', 'scipy', 'numba', 'matplotlib', 'pymoo_gridpath.grid', 'pymoo_gridpath.study.running.runner')\n"
        "heavy = [name for name in names if name in sys.modules]\n"
        "sys.exit(str(heavy) if heavy else 0)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
