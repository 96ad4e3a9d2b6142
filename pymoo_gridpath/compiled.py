"""Kernels: loops that numpy cannot say, compiled by numba where it is installed and plain Python where it is not."""

from __future__ import annotations

import contextlib
import time
import warnings
from collections.abc import Callable, Iterator
from typing import TypeVar

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


def kernel(function: F) -> F:
    """Return a function compiled by numba, or the function itself where numba is not installed.

    Kernels take numbers and arrays and give the same bits either way. They draw no random numbers of their own and keep to
    whole numbers below 2**63 and to sums and products of floats, which Python and the compiler carry out alike.
    """
    if numba is None:
        return function
    try:
        return numba.njit(cache=True, nogil=True)(function)  # pyright: ignore[reportReturnType]
    except RuntimeError:  # no folder to keep compiled code in
        return numba.njit(nogil=True)(function)  # pyright: ignore[reportReturnType]


def is_ctrl_c(error: BaseException | None) -> bool:
    """Return whether Ctrl-C is behind an error: compiled code makes a SystemError of a KeyboardInterrupt."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__
    return error is not None


@contextlib.contextmanager
def on_compiling(tell: Callable[[], None]) -> Iterator[None]:
    """While open, call a function when numba begins to compile, the first time only.

    Code that numba has kept from an earlier process is not compiled again, and without numba nothing is.
    """
    if numba is None:
        yield
        return
    from numba.core import event

    class First(event.Listener):
        told = False

        def on_start(self, event):
            if not self.told:
                self.told = True
                tell()

        def on_end(self, event):
            pass

    with event.install_listener("numba:compile", First()):
        yield


class WorkingClock:
    """A clock that stands still while numba compiles, for what is to be timed without that.

    Open it with ``with``, and call it for the seconds since an arbitrary moment.

    Examples
    --------
    >>> with WorkingClock() as clock:
    ...     begin = clock()
    ...     clock() >= begin
    True
    """

    def __init__(self):
        # Compiling one function may compile others that it calls.
        self._depth, self._since, self._compiling = 0, 0.0, 0.0
        self._open = contextlib.ExitStack()

    def __call__(self) -> float:
        now = self._since if self._depth else time.perf_counter()
        return now - self._compiling

    def __enter__(self) -> WorkingClock:
        if numba is not None:
            from numba.core import event

            clock = self

            class Compiling(event.Listener):
                def on_start(self, event):
                    if clock._depth == 0:
                        clock._since = time.perf_counter()
                    clock._depth += 1

                def on_end(self, event):
                    clock._depth -= 1
                    if clock._depth == 0:
                        clock._compiling += time.perf_counter() - clock._since

            self._open.enter_context(event.install_listener("numba:compile", Compiling()))
        return self

    def __exit__(self, *error) -> None:
        self._open.close()
