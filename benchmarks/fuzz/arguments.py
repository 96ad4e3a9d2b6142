"""Wrong values for every argument of every public name, and valid ones in another guise.

A wrong value must lead to a result, or to a GridPathError, TypeError or ValueError that says in one sentence what was wrong.
The sentence must be ours: an error that Python, numpy or another package raised while it worked on what nobody had checked is
a fault, but for arguments that a signature does not know. Refusals take at most 2 s of processor time. A valid array in
another guise, such as a transposed or a read-only view, must give what the plain one gives. No call may change its arguments.

    python benchmarks/fuzz/arguments.py --count 10000
"""

from __future__ import annotations

import contextlib
import io
import linecache
import os
import random
import re
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any
from unittest import mock

import matplotlib
import numpy as np
from calls import World, calls
from harness import main
from wrong_values import GUISES, PLAIN, SPOILT

PACKAGE = str(Path(__file__).resolve().parents[2] / "pymoo_gridpath")

SENTENCES = (TypeError, ValueError)

REFUSED_WITHIN = 2.0

# Methods of pymoo itself, called with good values alone: it says what it says about others.
THEIRS = ("GridPathProblem.evaluate",)

# Measured, and another at each call.
_UNLIKE = {"seconds", "n_bytes", "started", "machine"}

_FOLDER = tempfile.TemporaryDirectory(prefix="fuzz-arguments-", ignore_cleanup_errors=True)

_CALLS: dict[int, dict] = {}


def make(seed: int) -> tuple[str, Callable[[], object]]:
    """Call a public name with one argument replaced."""
    found = _calls()
    names = sorted(found)
    name = names[seed % len(names)]
    function, arguments = found[name]
    draw = random.Random(seed)
    if not arguments or draw.random() < 0.02:
        return name, lambda: _judge(name, function, {**arguments, "unknown": 1})
    argument = draw.choice(sorted(arguments))
    if draw.random() < 0.02:
        return name, lambda: _judge(name, function, {key: arguments[key] for key in arguments if key != argument})
    valid = arguments[argument]
    guises = _guises(valid)
    chance = draw.random()
    if guises and (chance < 0.25 or name in THEIRS):
        guise = draw.choice(sorted(guises))
        return name, lambda: _compare(f"{argument}: {guise}", function, arguments, argument, guises[guise])
    if isinstance(valid, np.ndarray) and chance < 0.6:
        spoil = SPOILT[draw.choice(sorted(SPOILT))]
        return name, lambda: _judge(name, function, {**arguments, argument: spoil(valid)})
    wrong = PLAIN[draw.choice(sorted(PLAIN))]
    return name, lambda: _judge(name, function, {**arguments, argument: wrong()})


def _calls() -> dict:
    """Return the calls with a world of this process alone, made when it first asks, so that planted faults are in it."""
    if os.getpid() not in _CALLS:
        matplotlib.use("Agg")
        folder = Path(_FOLDER.name) / str(os.getpid())
        folder.mkdir()
        os.chdir(folder)  # where relative paths lead
        _CALLS.clear()
        with _quiet():
            _CALLS[os.getpid()] = calls(World(folder))
    return _CALLS[os.getpid()]


def known_names() -> list[str]:
    """Return the public names that are called."""
    with tempfile.TemporaryDirectory(prefix="fuzz-arguments-") as folder, _quiet():
        return sorted(calls(World(Path(folder))))


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        yield


def _judge(name: str, function: Callable, arguments: dict[str, Any]) -> object:
    """Call a function; let pass what is allowed, and raise AssertionError for what is not."""
    arguments = _fresh(arguments)
    before = {key: _frozen(value) for key, value in arguments.items()}
    began = time.process_time()
    try:
        with _quiet():
            return function(**arguments)
    except SENTENCES as error:
        seconds = time.process_time() - began
        if not _is_ours(error):
            raise AssertionError(f"nobody's sentence: {type(error).__name__}: {str(error)[:200]}") from error
        if seconds > REFUSED_WITHIN:
            raise AssertionError(f"refused after {seconds:.1f} s: {error}") from error
        raise
    finally:
        if "matplotlib.pyplot" in sys.modules:
            sys.modules["matplotlib.pyplot"].close("all")
        changed = [key for key, value in arguments.items() if not same(_frozen(value), before[key])]
        if changed:
            raise AssertionError(f"{name} changed its argument {changed[0]}")


def _compare(what: str, function: Callable, arguments: dict[str, Any], argument: str, other: Any) -> object:
    """Call a function with a valid value and with the same in another guise; raise AssertionError if they do not agree."""
    try:
        plain = _judge("", function, arguments)
    except SENTENCES as error:
        plain = str(error)
    try:
        guised = _judge("", function, {**arguments, argument: other})
    except SENTENCES as error:
        guised = str(error)
    if not same(plain, guised):
        raise AssertionError(f"{what} gives {str(guised)[:200]} instead of {str(plain)[:200]}")
    return guised


def _guises(value: Any) -> Mapping[str, Any]:
    """Return a valid value in other guises."""
    if isinstance(value, bool):
        return {"numpy bool": np.bool_(value), "0-d array": np.array(value)}
    if isinstance(value, int):
        return {"int64": np.int64(value), "int32": np.int32(value) if abs(value) < 2**31 else np.int64(value)}
    if isinstance(value, float):
        return {"float64": np.float64(value), "0-d array": np.array(value)}
    if isinstance(value, tuple) and value and all(isinstance(item, int | float) for item in value):
        return {"array": np.array(value), "list": list(value)}
    if isinstance(value, np.ndarray) and value.ndim and value.dtype.kind in "biuf":
        return {name: guise(value) for name, guise in GUISES.items()}
    return {}


def _fresh(arguments: dict[str, Any]) -> dict[str, Any]:
    """Return arguments with a random generator that draws the same numbers at each call."""
    return {
        key: np.random.default_rng(5) if isinstance(value, np.random.Generator) else value for key, value in arguments.items()
    }


def _frozen(value: Any) -> Any:
    """Return a copy of an array, or of arrays in a list or tuple, and nothing of other values."""
    if isinstance(value, np.ndarray):
        return value.copy()
    if type(value) in (list, tuple) and all(isinstance(item, np.ndarray) for item in value):
        return [item.copy() for item in value]
    return None


def _is_ours(error: BaseException) -> bool:
    """Return whether this package raised an error in words, or Python for arguments that a signature does not know."""
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    if trace is None:
        return False
    file = trace.tb_frame.f_code.co_filename
    if isinstance(error, TypeError) and re.search(
        r"(unexpected keyword|required (positional|keyword-only)|takes no) argument", str(error)
    ):
        return True
    return file.startswith(PACKAGE) and linecache.getline(file, trace.tb_lineno).strip().startswith("raise ")


def same(one: Any, other: Any, depth: int = 4) -> bool:
    """Return whether two results agree, as far as they are numbers, texts, arrays, collections, or objects of the package."""
    if depth == 0 or one is other:
        return True
    if isinstance(one, np.ndarray | np.generic) or isinstance(other, np.ndarray | np.generic):
        one, other = np.asarray(one), np.asarray(other)
        if one.dtype.kind == "O" or other.dtype.kind == "O":
            return one.shape == other.shape
        return one.shape == other.shape and np.array_equal(one, other, equal_nan=one.dtype.kind in "fc")
    if isinstance(one, str | bytes | bool | int | float | None):
        return one == other or (one != one and other != other)
    if isinstance(one, list | tuple):
        return len(one) == len(other) and all(same(a, b, depth - 1) for a, b in zip(one, other, strict=True))
    if isinstance(one, dict):
        shared = set(one) & set(other) - _UNLIKE
        return all(same(one[key], other[key], depth - 1) for key in shared)
    if type(one) is not type(other) or not type(one).__module__.startswith("pymoo_gridpath"):
        return type(one) is type(other)
    if hasattr(one, "__dict__"):
        first, second = ({key: value for key, value in vars(a).items() if key[0] != "_"} for a in (one, other))
        return same(first, second, depth - 1)
    return True


# -- planted faults -----------------------------------------------------------------------------------------------------------


def _planted() -> dict[str, Callable[[], contextlib.AbstractContextManager]]:
    from pymoo_gridpath import checks, decision, problems
    from pymoo_gridpath.grid import OccupancyGrid
    from pymoo_gridpath.representations import base

    genes, check_field, shown = base.Representation.genes, base.check_field, checks.shown

    def loses_order(self, X):
        X = np.asarray(X)
        return genes(self, X.ravel(order="K").reshape(X.shape)) if X.ndim == 2 else genes(self, X)

    def writes_back(name, field, grid):
        found = check_field(name, field, grid)
        if found.flags.writeable and found.dtype.kind == "f":
            found *= 0.5
        return found

    def shows_raw(value):
        return value[:100] if isinstance(value, str) else shown(value)

    def endless(F):
        while time.process_time() < began + 60:
            pass

    def wasteful(**arguments):
        return np.ones(3 * 10**8).sum()

    began = time.process_time()
    return {
        "numbers are not looked at": lambda: mock.patch.object(checks, "number", lambda name, value, *_, **__: float(value)),
        "whole numbers are not looked at": lambda: mock.patch.object(checks, "whole", lambda name, value, *_, **__: int(value)),
        "arrays are not looked at": lambda: mock.patch.object(checks, "array", lambda name, value, *_, **__: np.asarray(value)),
        "values are shown whole": lambda: mock.patch.object(checks._Brief, "repr_instance", lambda self, x, level: repr(x)),
        "control characters are shown raw": lambda: mock.patch.object(checks, "shown", shows_raw),
        "genes are read in the order of memory": lambda: mock.patch.object(base.Representation, "genes", loses_order),
        "a field is changed in place": lambda: mock.patch.object(base, "check_field", writes_back),
        "the knee takes for ever": lambda: mock.patch.object(decision, "knee_point", endless),
        "a random grid takes gigabytes": lambda: mock.patch.object(problems, "random_dense_grid", wasteful),
        "cells are taken as they come": lambda: mock.patch.object(OccupancyGrid, "contains", lambda self, cell: cell[0] >= 0),
    }


if __name__ == "__main__":
    sys.exit(main(make, _planted(), 10000, SENTENCES))
