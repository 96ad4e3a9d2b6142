"""Kernels: what is said of their compilation."""

import importlib.util

import pytest

from pymoo_gridpath import compiled
from pymoo_gridpath.compiled import WorkingClock, on_compiling

SOURCE = """
from pymoo_gridpath.compiled import kernel

@kernel
def twice(number):
    return 2 * number

@kernel
def four_times(number):
    return twice(twice(number))
"""


def times_told(path):
    """How often compiling is told of in what is a new process to numba: a fresh import of the kernels, called."""
    spec = importlib.util.spec_from_file_location("kernels", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    told = []
    with on_compiling(lambda: told.append(None)):
        assert module.four_times(3) == module.four_times(3) == 12
        assert module.four_times(0.5) == 2.0
    return len(told)


@pytest.fixture
def kernels(tmp_path, monkeypatch):
    numba = pytest.importorskip("numba")
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "cache"))
    path = tmp_path / "kernels.py"
    path.write_text(SOURCE)
    return path


def test_compiling_is_told_of_once_and_not_when_compiled_code_is_at_hand(kernels):
    assert times_told(kernels) == 1
    assert times_told(kernels) == 0
    kernels.write_text(SOURCE.replace("2 * number", "number + number"))
    assert times_told(kernels) == 1


def test_compiling_that_cannot_be_kept_is_told_of_each_time(kernels, monkeypatch):
    import numba

    def nowhere(self):
        raise OSError

    monkeypatch.setattr(numba.core.caching._CacheLocator, "ensure_cache_path", nowhere)
    assert times_told(kernels) == times_told(kernels) == 1


def test_nothing_is_told_of_without_numba(kernels, monkeypatch):
    monkeypatch.setattr(compiled, "numba", None)
    assert times_told(kernels) == 0


def test_the_working_clock_stands_still_while_numba_compiles(monkeypatch):
    event = pytest.importorskip("numba").core.event
    now = [0.0]
    monkeypatch.setattr(compiled.time, "perf_counter", lambda: now[0])
    with WorkingClock() as clock:
        now[0] = 5.0
        assert clock() == 5.0
        event.start_event("numba:compile")
        now[0] = 15.0
        event.start_event("numba:compile")  # of a function that the first one calls
        now[0] = 300.0
        event.end_event("numba:compile")
        assert clock() == 5.0
        event.end_event("numba:compile")
        now[0] = 302.0
        assert clock() == 7.0
        event.start_event("numba:compile")
        now[0] = 400.0
        event.end_event("numba:compile")
        assert clock() == 7.0
    now[0] = 401.0
    assert clock() == 8.0


def test_the_working_clock_is_a_clock_without_numba(monkeypatch):
    now = [1.0]
    monkeypatch.setattr(compiled, "numba", None)
    monkeypatch.setattr(compiled.time, "perf_counter", lambda: now[0])
    with WorkingClock() as clock:
        now[0] = 3.5
        assert clock() == 3.5
