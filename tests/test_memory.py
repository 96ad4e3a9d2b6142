"""Want of memory becomes a sentence that says what the size costs."""

from __future__ import annotations

import errno
import re
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image, UnidentifiedImageError
from small_studies import make_plan

from pymoo_gridpath import cli
from pymoo_gridpath.errors import GridPathError, MapError
from pymoo_gridpath.maps import load_map
from pymoo_gridpath.memory import is_want_of_memory
from pymoo_gridpath.study.planning.estimate import estimate
from pymoo_gridpath.study.running import execute as execute_module
from pymoo_gridpath.study.running.execute import execute
from pymoo_gridpath.study.running.record import from_bytes

LIMITED = """
import resource, sys
from pymoo_gridpath.cli import main
resource.setrlimit(resource.RLIMIT_AS, (1_300_000_000, -1))
sys.exit(main(sys.argv[1:]))
"""


def test_a_plan_without_the_memory_for_it_ends_with_what_it_needs(tmp_path):
    resource = pytest.importorskip("resource")
    assert resource is not None
    Image.fromarray(np.full((3500, 3500), 254, np.uint8)).save(tmp_path / "open.png")
    arguments = ["plan", str(tmp_path / "open.png"), "--start", "1,1", "--goal", "3490,3490", "-o", str(tmp_path / "out")]
    done = subprocess.run([sys.executable, "-c", LIMITED, *arguments], capture_output=True, text=True, timeout=300)
    assert done.returncode == 2, done.stderr
    assert done.stderr.splitlines()[-1] == (
        "pymoo-gridpath: memory ran out: a problem in 'cells' on 3500 x 3500 cells needs about 1.6 GB; expected a smaller map, "
        "coarser cells or more free memory"
    )
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    "error",
    [
        MemoryError(),
        MemoryError("Unable to allocate 3.2 GiB for an array"),
        SystemError("std::bad_alloc"),
        RuntimeError("std::bad_alloc"),
        RuntimeError("can't start new thread"),
        OSError(errno.ENOMEM, "Cannot allocate memory"),
        ImportError("libx.so: failed to map segment from shared object"),
    ],
)
@pytest.mark.parametrize("command", [["info", "paper16"], ["plan", "paper16"], ["maps"]])
def test_whatever_shows_it_is_a_sentence_and_status_2(error, command, monkeypatch, capsys, tmp_path):
    def fail(*arguments, **options):
        raise error

    monkeypatch.setattr("pymoo_gridpath.maps.load_map", fail)
    monkeypatch.chdir(tmp_path)
    assert cli.main(command) == 2
    said = capsys.readouterr().err
    assert re.fullmatch(r"pymoo-gridpath: memory ran out; expected .* free memory\n", said), said


def raised_while(first: Exception, second: Exception) -> Exception:
    """Return an error that was raised while another was handled, with that as its context and no cause."""

    def fail(error: Exception) -> None:
        raise error

    try:
        try:
            fail(first)
        except Exception:
            fail(second)
    except Exception as error:
        return error
    raise AssertionError


def test_it_is_found_behind_other_errors_and_not_everywhere():
    wrapped = SystemError("a kernel returned a result with an exception set")
    wrapped.__cause__ = MemoryError()
    assert is_want_of_memory(wrapped)
    assert is_want_of_memory(
        raised_while(OSError("libllvmlite.so: failed to map segment from shared object"), OSError("not found"))
    )
    assert not is_want_of_memory(raised_while(OSError("libx.so: no such file"), OSError("not found")))
    assert not is_want_of_memory(UnidentifiedImageError("cannot identify image file 'out of memory.png'"))
    assert not is_want_of_memory(OSError(errno.ENOENT, "No such file or directory", "out of memory.png"))
    assert not any(map(is_want_of_memory, (ValueError("out of memory"), SystemError("x"), OSError(errno.ENOENT, "x"), None)))


def test_a_whole_image_is_not_called_damaged_for_want_of_memory(monkeypatch, tmp_path):
    Image.fromarray(np.full((9, 9), 254, np.uint8)).save(tmp_path / "a.png")
    monkeypatch.setattr(Image.Image, "load", lambda self: (_ for _ in ()).throw(MemoryError()))
    with pytest.raises(MemoryError):
        load_map(tmp_path / "a.png")
    monkeypatch.setattr(Image.Image, "load", lambda self: (_ for _ in ()).throw(SyntaxError()))
    with pytest.raises(MapError, match="damaged"):
        load_map(tmp_path / "a.png")


def test_a_run_of_a_study_that_lacks_memory_is_a_failed_run_with_a_sentence(monkeypatch):
    plan = make_plan(n_seeds=1, n_problems=1)
    run = next(run for run in plan.runs if run.algorithm is not None)

    def fail(*arguments):
        raise MemoryError("Unable to allocate 3.2 GiB for an array with shape (1, 2)")

    monkeypatch.setattr(execute_module, "build_problem", fail)
    record = from_bytes(execute(plan.task(run)))
    assert record.status == "failed"
    assert record.message == (
        "memory ran out: a problem in 'integer' on 144 cells needs about 0.1 GB; expected a smaller map, coarser cells or more "
        "free memory"
    )
    monkeypatch.setattr("pymoo_gridpath.study.planning.estimate.build_problem", fail)
    with pytest.raises(GridPathError, match=r"fails on the problem .*: memory ran out: .* needs about"):
        estimate(plan)
