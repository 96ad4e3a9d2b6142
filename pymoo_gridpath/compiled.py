"""Kernels: loops that numpy cannot say, compiled by numba where it is installed and plain Python where it is not."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from typing import TypeVar

F = TypeVar("F", bound=Callable)

#: Whether kernels are compiled: numba, the ``fast`` extra, is installed.
COMPILED = importlib.util.find_spec("numba") is not None


def kernel(function: F) -> F:
    """Return a function compiled by numba, or the function itself where numba is not installed.

    Kernels take numbers and arrays and give the same bits either way. They draw no random numbers of their own and keep to
    whole numbers below 2**63 and to sums and products of floats, which Python and the compiler carry out alike.
    """
    if not COMPILED:
        return function
    import numba

    return numba.njit(cache=True, nogil=True)(function)  # pyright: ignore[reportReturnType]
