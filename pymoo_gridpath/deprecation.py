"""How a public name goes: it warns for two minor releases and says what to use instead."""

from __future__ import annotations

import functools
import warnings
from collections.abc import Callable
from typing import TypeVar

from pymoo_gridpath.errors import GridPathError

T = TypeVar("T", bound=Callable)

# Minor releases in which a deprecated name still works.
MINOR_RELEASES = 2


def deprecated(since: str, remove_in: str, instead: str) -> Callable[[T], T]:
    """Mark a public function, method or class as one that will go; a decorator.

    Each use warns with a `DeprecationWarning` at the line of the caller. Of a class, a use is a call of its
    constructor, by a subclass too.

    Parameters
    ----------
    since : str
        The release that deprecates it, such as "0.2.0".
    remove_in : str
        The release that no longer has it: two minor releases later, or a new major one.
    instead : str
        What to use, as it stands in a program.

    Raises
    ------
    GridPathError
        If it would go too early.

    Examples
    --------
    >>> @deprecated("0.2.0", "0.4.0", instead="load_map")
    ... def read_map(path):
    ...     return path
    >>> with warnings.catch_warnings(record=True) as said:
    ...     warnings.simplefilter("always")
    ...     read_map("floor.png")
    'floor.png'
    >>> print(said[0].message)
    read_map is deprecated since 0.2.0 and will be removed in 0.4.0; use load_map instead
    """
    first, last = _release(since), _release(remove_in)
    # A new major release comes after any number of minor ones.
    if last[0] < first[0] or (last[0] == first[0] and last[1] < first[1] + MINOR_RELEASES):
        raise GridPathError(
            f"a name that is deprecated since {since} cannot be removed in {remove_in}, expected {MINOR_RELEASES} minor "
            "releases later"
        )

    def mark(thing: T) -> T:
        message = f"{thing.__name__} is deprecated since {since} and will be removed in {remove_in}; use {instead} instead"
        # Of a class, its constructor, so that it stays a class.
        called = thing.__init__ if isinstance(thing, type) else thing

        @functools.wraps(called)
        def warn_and_call(*arguments, **options):
            warnings.warn(message, DeprecationWarning, stacklevel=2)
            return called(*arguments, **options)

        marked = warn_and_call
        if isinstance(thing, type):
            thing.__init__ = warn_and_call  # pyright: ignore[reportAttributeAccessIssue]
            marked = thing
        marked.__doc__ = f"{(thing.__doc__ or '').rstrip()}\n\n.. deprecated:: {since}\n   Use {instead} instead.\n"
        return marked  # pyright: ignore[reportReturnType]

    return mark


def _release(text: str) -> tuple[int, int]:
    try:
        major, minor, _ = (int(part) for part in text.split("."))
    except ValueError:
        raise GridPathError(f"{text!r} is not a release, expected one such as '0.2.0'") from None
    return major, minor
