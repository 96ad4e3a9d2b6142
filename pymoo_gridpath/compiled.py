"""Kernels: loops that numpy cannot say, compiled by numba where it is installed and plain Python where it is not."""

from __future__ import annotations

import multiprocessing
import threading
import time
import warnings
from collections.abc import Callable
from typing import TypeVar

from pymoo_gridpath.progress import say_that_it_compiles

try:
    import numba
except ModuleNotFoundError:
    numba = None
except ImportError as error:
    # An installed numba that does not fit numpy must not take the package with it.
    numba = None
    warnings.warn(f"numba cannot be imported, so kernels run as plain Python: {error}", stacklevel=2)

F = TypeVar("F", bound=Callable)

#: Whether kernels are compiled: numba, the ``fast`` extra, is installed.
COMPILED = numba is not None

_kernels: set[Callable] = set()


def kernel(function: F) -> F:
    """Return a function compiled by numba, or the function itself where numba is not installed.

    Kernels take numbers and arrays and give the same bits either way. They draw no random numbers of their own and keep to
    whole numbers below 2**63 and to sums and products of floats, which Python and the compiler carry out alike.
    """
    return _compiled(function)


def inlined(function: F) -> F:
    """Return a kernel that becomes part of those that call it, where the compiler would take it for too large."""
    return _compiled(function, forceinline=True)


def _compiled(function: F, **options) -> F:
    if numba is None:
        return function
    _kernels.add(function)
    try:
        return numba.njit(cache=True, nogil=True, **options)(function)  # pyright: ignore[reportReturnType]
    except RuntimeError:  # no folder to keep compiled code in
        return numba.njit(nogil=True, **options)(function)  # pyright: ignore[reportReturnType]


def is_ctrl_c(error: BaseException | None) -> bool:
    """Return whether Ctrl-C is behind an error: compiled code makes a SystemError of a KeyboardInterrupt."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__
    return error is not None


def seconds_compiling() -> float:
    """Return for how many seconds numba has compiled in this process so far, or fetched what it kept from an earlier."""
    return 0.0 if _compiling is None else _compiling.seconds


def working_seconds() -> float:
    """Return the time of a clock that stands still while numba compiles, for what is to be timed without that."""
    if _compiling is not None and _compiling.depth > 0:
        return _compiling.begin - _compiling.seconds
    return time.perf_counter() - seconds_compiling()


def _listen():
    """Return what numba tells when it begins and ends to compile, and have it say so the first time that it is a kernel."""
    # numba has imported it already.
    from numba.core import event

    class Compiling(event.Listener):
        """Numba's lock is held, or waited for, while it compiles, and while it fetches what it has kept or keeps it."""

        seconds = 0.0
        depth = 0
        begin = 0.0
        counting = threading.Lock()

        def on_start(self, event):
            # A kernel that calls others has them compiled while it is; other threads wait for it.
            with self.counting:
                if self.depth == 0:
                    self.begin = time.perf_counter()
                self.depth += 1

        def on_end(self, event):
            with self.counting:
                self.depth -= 1
                if self.depth == 0:
                    self.seconds += time.perf_counter() - self.begin

    class Telling(event.Listener):
        told = False

        def on_start(self, event):
            if not self.told and event.data["dispatcher"].py_func in _kernels:
                self.told = True
                # Workers, whoever started them, leave it to the process that they work for.
                if multiprocessing.current_process().name == "MainProcess":
                    say_that_it_compiles()

        def on_end(self, event):
            pass

    compiling, telling = Compiling(), Telling()
    event.register("numba:compiler_lock", compiling)
    event.register("numba:compile", telling)
    return compiling, telling


_compiling, _telling = (None, None) if numba is None else _listen()
