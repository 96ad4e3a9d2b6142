"""The package that the page "Extend it" makes: its suites run, and find what is wrong with it."""

from __future__ import annotations

import ast
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "docs" / "extend"
PAGE = (FOLDER.parent / "extend.md").read_text(encoding="utf-8")

# What each suite has to find, by what is written in place of what.
FAULTS = {
    "TestWalkingTime": ("minutes[heading] = metres / 100", "minutes[heading] = -metres / 100"),
    "TestStops": ("np.minimum(np.abs(way), k[:, None])", "np.minimum(np.abs(way), k[:, None] - 1)"),
    "TestNudge": ("dx, dy = random_state.integers(", "dx, dy = np.random.default_rng().integers("),
    "TestWeightedPaths": ("found[tuple(path)] = path[::-1]", "found[tuple(path)] = path[::-2]"),
    "TestBoxes": ("x, y, w, h = self._numbers", "y, x, h, w = self._numbers"),
    "TestPonds": ("ponds[0] = ponds[:, -1] = False", "ponds[:, -1] = True"),
}


# A suite that has found a fault has done what is asked of it here.
FIRST_FAULT_ALONE = """
import pytest

found = set()

def pytest_runtest_setup(item):
    if item.cls in found:
        pytest.skip("a fault was found")

def pytest_runtest_makereport(item, call):
    if call.excinfo is not None and not call.excinfo.errisinstance(pytest.skip.Exception):
        found.add(item.cls)
"""


def run_suites(folder: Path) -> tuple[int, dict[str, set[str]]]:
    """Run pytest in a copy of the package, as whoever wrote it would; return its status, and the outcomes of each suite."""
    command = [sys.executable, "-m", "pytest", "-q", "-rA", "-p", "no:cacheprovider", "--tb=no", "test_trails.py"]
    paths = os.pathsep.join([str(folder), str(ROOT)])
    done = subprocess.run(
        command, cwd=folder, env=os.environ | {"PYTHONPATH": paths}, capture_output=True, text=True, timeout=500
    )
    outcomes: dict[str, set[str]] = {suite: set() for suite in FAULTS}
    for outcome, suite, test in re.findall(r"^(PASSED|FAILED|ERROR) test_trails\.py::(\w+)::(\w+)", done.stdout, re.MULTILINE):
        outcomes[suite].add(f"{outcome} {test}")
    return done.returncode, outcomes


def copied(folder: Path) -> Path:
    return Path(shutil.copytree(FOLDER, folder / "trails", ignore=shutil.ignore_patterns("__pycache__")))


def test_its_suites_run_and_pass(tmp_path):
    status, outcomes = run_suites(copied(tmp_path))
    assert status == 0
    for suite, found in outcomes.items():
        assert len(found) >= 7 and all(one.startswith("PASSED") for one in found), suite


def test_its_suites_find_faults(tmp_path):
    folder = copied(tmp_path)
    text = (folder / "trails.py").read_text(encoding="utf-8")
    for right, wrong in FAULTS.values():
        assert text.count(right) == 1, right
        text = text.replace(right, wrong)
    (folder / "trails.py").write_text(text, encoding="utf-8")
    (folder / "conftest.py").write_text(FIRST_FAULT_ALONE, encoding="utf-8")
    status, outcomes = run_suites(folder)
    assert status == 1
    assert all(any(one.startswith(("FAILED", "ERROR")) for one in found) for found in outcomes.values()), outcomes


def test_each_class_is_short_registered_and_shown():
    module = ast.parse((FOLDER / "trails.py").read_text(encoding="utf-8"))
    classes = {node.name: node for node in module.body if isinstance(node, ast.ClassDef)}
    groups = tomllib.loads((FOLDER / "pyproject.toml").read_text(encoding="utf-8"))["project"]["entry-points"]
    assert sorted(path for group in groups.values() for path in group.values()) == sorted(f"trails:{name}" for name in classes)
    for name, node in classes.items():
        assert node.end_lineno is not None and node.end_lineno - node.decorator_list[0].lineno + 1 < 40, name
        assert f":pyobject: {name}\n" in PAGE


@pytest.mark.parametrize("name", re.findall(r"\{literalinclude\} extend/([\w.]+)", PAGE))
def test_files_that_the_page_shows_are_there(name):
    assert (FOLDER / name).is_file()
