"""The sdist and the wheel: what they hold, and that a plan runs from each. Nothing is fetched."""

import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]

BUILD = """
import sys
from setuptools import build_meta
print(getattr(build_meta, "build_" + sys.argv[1])(sys.argv[2]))
"""

PLAN = """
import sys
import pymoo_gridpath
from pymoo_gridpath.cli import main
print(pymoo_gridpath.__file__)
sys.exit(main(sys.argv[1:]))
"""


def run(*command, cwd, **environment):
    done = subprocess.run(
        [sys.executable, *map(str, command)],
        cwd=cwd,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


def checkout() -> list[str]:
    """The files that are under version control, or, of an unpacked sdist, all that are not made by installing and testing."""
    if (ROOT / ".git").exists():
        command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
        listed = subprocess.run(command, cwd=ROOT, capture_output=True, check=True, text=True).stdout.split("\0")
        names = [name for name in listed if name and (ROOT / name).exists()]
    else:
        names = (ROOT / "pymoo_gridpath.egg-info" / "SOURCES.txt").read_text(encoding="utf-8").splitlines()
    # In place of a link stand the files of the folder that it leads to.
    return sorted(file.relative_to(ROOT).as_posix() for name in names for file in _files(ROOT / name))


def _files(path: Path) -> list[Path]:
    if not path.is_dir():
        return [path]
    return [file for file in path.rglob("*") if file.is_file() and "__pycache__" not in file.parts]


@pytest.fixture
def source(tmp_path):
    """A copy of the checkout, since building leaves folders behind."""
    folder = tmp_path / "source"
    for name in checkout():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / name, folder / name)
    return folder


def plan_runs_from(archive: Path, folder: Path) -> None:
    """Install an sdist or a wheel into a folder of its own and plan on a shipped map."""
    target = folder / "installed"
    options = ["--quiet", "--disable-pip-version-check", "--no-index", "--no-deps", "--no-build-isolation", "--no-compile"]
    run("-m", "pip", "install", *options, "--target", target, archive, cwd=folder)
    # Compiling takes longer than all the rest.
    plan = ["plan", "paper16", "--representation", "cells", "--pop-size", "20", "--generations", "5", "-o", "out"]
    plan += ["--html", "front.html"]
    shown = run("-c", PLAN, *plan, cwd=folder, PYTHONPATH=str(target), NUMBA_DISABLE_JIT="1")
    assert Path(shown[0]).is_relative_to(target)
    assert any("shortest" in line for line in shown)
    assert (folder / "out" / "paths.json").exists() and (folder / "out" / "map.png").exists()
    assert (folder / "front.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


def test_an_sdist_holds_what_a_checkout_holds_and_runs(source, tmp_path):
    sdist = tmp_path / run("-c", BUILD, "sdist", tmp_path, cwd=source)[-1]
    with tarfile.open(sdist) as archive:
        files = [(member.name.partition("/")[2], archive.extractfile(member)) for member in archive if not member.isdir()]
        held = {name: file.read() for name, file in files if file is not None}
    wanted = checkout()
    assert {"Makefile", ".ci/run", "docs/conf.py", "benchmarks/table1.py", "tests/exact_fronts.py"} <= set(wanted)
    assert {"problems/__init__.py", "operators/__init__.py"} <= set(wanted)
    assert [name for name in wanted if held.get(name) != (ROOT / name).read_bytes()] == []
    plan_runs_from(sdist, tmp_path)


def test_a_wheel_holds_the_package_alone_and_runs(source, tmp_path):
    wheel = tmp_path / run("-c", BUILD, "wheel", tmp_path, cwd=source)[-1]
    with zipfile.ZipFile(wheel) as archive:
        held = [name for name in archive.namelist() if ".dist-info/" not in name]
    assert sorted(held) == [name for name in checkout() if name.startswith("pymoo_gridpath/")]
    plan_runs_from(wheel, tmp_path)
