"""Kernels: what is said of their compilation, and how long it takes."""

import importlib.util
import os
import subprocess
import sys
import time

import pytest

from pymoo_gridpath import compiled
from pymoo_gridpath.compiled import working_seconds
from pymoo_gridpath.exact.budget import Budget, Meter
from pymoo_gridpath.progress import COMPILING

SOURCE = """
from pymoo_gridpath.compiled import kernel

@kernel
def twice(number):
    return 2 * number

@kernel
def four_times(number):
    return twice(twice(number))
"""


def use(path, monkeypatch):
    """Call the kernels in what is a new process to numba and to this package."""
    spec = importlib.util.spec_from_file_location("kernels", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    if compiled._telling is not None:
        monkeypatch.setattr(compiled._telling, "told", False)
    assert module.four_times(3) == module.four_times(3) == 12
    assert module.four_times(0.5) == 2.0


@pytest.fixture
def kernels(tmp_path, monkeypatch):
    numba = pytest.importorskip("numba")
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "cache"))
    path = tmp_path / "kernels.py"
    path.write_text(SOURCE)
    return path


def test_compiling_is_said_once_and_not_when_compiled_code_is_at_hand(kernels, monkeypatch, capsys):
    use(kernels, monkeypatch)
    assert capsys.readouterr() == ("", f"{COMPILING}\n")
    use(kernels, monkeypatch)
    assert capsys.readouterr() == ("", "")
    kernels.write_text(SOURCE.replace("2 * number", "number + number"))
    use(kernels, monkeypatch)
    assert capsys.readouterr() == ("", f"{COMPILING}\n")


def test_compiling_that_cannot_be_kept_is_said_each_time(kernels, monkeypatch, capsys):
    import numba

    def nowhere(self):
        raise OSError

    monkeypatch.setattr(numba.core.caching._CacheLocator, "ensure_cache_path", nowhere)
    for _ in range(2):
        use(kernels, monkeypatch)
        assert capsys.readouterr().err == f"{COMPILING}\n"


def test_the_clock_stands_still_while_compiled_code_is_fetched(kernels, monkeypatch):
    use(kernels, monkeypatch)
    import numba

    fetch = numba.core.caching.Cache.load_overload

    def slow(self, *args):
        before.append(working_seconds())
        time.sleep(0.2)
        after.append(working_seconds())
        return fetch(self, *args)

    before, after = [], []
    monkeypatch.setattr(numba.core.caching.Cache, "load_overload", slow)
    use(kernels, monkeypatch)
    assert before and before == after


def test_functions_of_others_compile_without_a_word(kernels, monkeypatch, capsys):
    import numba

    monkeypatch.setattr(compiled._telling, "told", False)
    before = compiled.seconds_compiling()
    assert numba.njit(lambda number: number + 1)(1) == 2
    assert capsys.readouterr().err == ""
    assert compiled.seconds_compiling() > before


def test_nothing_is_said_without_numba(kernels, monkeypatch, capsys):
    monkeypatch.setattr(compiled, "numba", None)
    monkeypatch.setattr(compiled, "_compiling", None)
    monkeypatch.setattr(compiled, "_telling", None)
    use(kernels, monkeypatch)
    assert capsys.readouterr().err == "" and compiled.seconds_compiling() == 0.0


@pytest.mark.parametrize("stderr", ["None", "open(os.devnull)"])
def test_compiling_goes_on_where_nothing_can_be_said(kernels, tmp_path, stderr):
    script = f"import os, sys\nsys.stderr = {stderr}\nsys.path.insert(0, {str(tmp_path)!r})\nimport kernels\n"
    done = run(script + "print(kernels.four_times(2))", tmp_path)
    assert (done.returncode, done.stdout) == (0, "8\n")


POOL = """
import sys
sys.path.insert(0, {folder!r})
import kernels

if __name__ == "__main__":
    if "loky" in sys.argv:
        from loky import ProcessPoolExecutor
        pool = ProcessPoolExecutor(1)
    else:
        import multiprocessing
        from concurrent.futures import ProcessPoolExecutor
        pool = ProcessPoolExecutor(1, multiprocessing.get_context("spawn"))
    with pool:
        print(sum(pool.map(kernels.four_times, [1, 2, 3, 0.5])))
"""


@pytest.mark.parametrize("kind", ["spawn", "loky"])
def test_workers_leave_it_to_the_process_that_they_work_for(kernels, tmp_path, kind):
    pytest.importorskip("loky")
    (tmp_path / "pool.py").write_text(POOL.format(folder=str(tmp_path)))
    done = run(None, tmp_path, tmp_path / "pool.py", kind)
    assert (done.returncode, done.stdout, done.stderr) == (0, "26.0\n", "")


def run(script, folder, *arguments):
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(folder / "cache")}
    command = [sys.executable, *(["-c", script] if script else []), *map(str, arguments)]
    return subprocess.run(command, env=environment, capture_output=True, text=True)


def test_compiling_does_not_count_as_time_of_a_search(kernels, monkeypatch):
    meter = Meter(Budget(max_seconds=1.0))
    monkeypatch.setattr(compiled._compiling, "seconds", compiled.seconds_compiling() + 1000.0)
    assert meter.elapsed < 0 and not meter.stop()
    monkeypatch.setattr(compiled._compiling, "seconds", compiled.seconds_compiling() - 2000.0)
    assert meter.elapsed > 900 and meter.stop()


def test_the_working_clock_stands_still_while_numba_compiles(monkeypatch):
    event = pytest.importorskip("numba").core.event
    now = [0.0]
    monkeypatch.setattr(compiled.time, "perf_counter", lambda: now[0])
    begin = working_seconds()
    now[0] = 5.0
    assert working_seconds() - begin == 5.0
    event.start_event("numba:compiler_lock")
    now[0] = 15.0
    event.start_event("numba:compiler_lock")  # of a function that the first one calls
    now[0] = 300.0
    event.end_event("numba:compiler_lock")
    assert working_seconds() - begin == pytest.approx(5.0)
    event.end_event("numba:compiler_lock")
    now[0] = 302.0
    assert working_seconds() - begin == pytest.approx(7.0)
    event.start_event("numba:compiler_lock")
    now[0] = 400.0
    event.end_event("numba:compiler_lock")
    assert working_seconds() - begin == pytest.approx(7.0)


def test_the_working_clock_is_a_clock_without_numba(monkeypatch):
    monkeypatch.setattr(compiled, "_compiling", None)
    monkeypatch.setattr(compiled, "_telling", None)
    monkeypatch.setattr(compiled.time, "perf_counter", lambda: 3.5)
    assert working_seconds() == 3.5
