"""Kernels: loops that numpy cannot say, compiled by numba where it is installed and plain Python where it is not."""

from __future__ import annotations

import contextlib
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
