"""What arguments must be: a check returns the value to work with, or says in a sentence what was given and what was expected.

Numbers may be Python's or numpy's, or arrays without dimensions. Truth values are no numbers here, and masked values are none
either: what they hide would be taken for real.
"""

from __future__ import annotations

import contextlib
import inspect
import math
import os
import reprlib
from collections.abc import Callable, Iterable, Sized
from decimal import Decimal
from numbers import Integral, Real
from typing import Any, TypeVar

import numpy as np

from pymoo_gridpath.errors import GridPathError, nearest, visible

T = TypeVar("T")

# Values are shown in messages up to so many letters.
_MOST_SHOWN = 80

# Longer paths are none on any system that the package runs on.
_LONGEST_PATH = 4096

# Python itself refuses to write out numbers of more than 4,300 digits.
_MOST_BITS = 200


class _Brief(reprlib.Repr):
    """Short texts of values, which never ask an object of an unknown class for its own: it may be endless, or fail."""

    def __init__(self):
        super().__init__()
        self.maxstring = self.maxother = _MOST_SHOWN
        self.maxlevel, self.maxtuple, self.maxlist = 3, 4, 4

    def repr_int(self, x, level):
        if x.bit_length() > _MOST_BITS:
            return f"a whole number of about {math.floor(x.bit_length() * math.log10(2)) + 1:,} digits"
        return repr(x)

    def repr_bytes(self, x, level):
        return self.repr_str(x, level)

    def repr_instance(self, x, level):
        if isinstance(x, np.ndarray) and x.ndim:
            return f"an array of {x.dtype} of shape {x.shape}"
        if isinstance(x, np.ndarray | np.generic) and x.dtype.kind in "biufcUS" and x is not np.ma.masked:
            return self.repr1(x.item(), level)
        if x is None or type(x) in (bool, float, complex, range, Decimal):
            return repr(x)
        if isinstance(x, type):
            return f"the class {x.__name__}"
        return f"an object of the class {type(x).__name__}"


_BRIEF = _Brief()


def shown(value: Any) -> str:
    """Return a value as messages show it: one short printable line, whatever it is."""
    if type(value) is str and len(value) < _MOST_SHOWN // 2 and value.isascii() and value.isprintable():
        return repr(value)
    try:
        text = _BRIEF.repr(value)
    except Exception:
        text = f"an object of the class {type(value).__name__}"
    return printable(text, 2 * _MOST_SHOWN)


def printable(text: object, most: int = 300) -> str:
    """Return a text, such as a path, on one line: what cannot be printed escaped, and the middle left out if it is too long."""
    line = visible(text)
    return line if len(line) <= most else f"{line[: most // 2]}...{line[-most // 2 :]}"


def _scalar(value: Any) -> Any:
    """Return what an array without dimensions holds, and other values as they are; None for a masked one."""
    if isinstance(value, np.ma.MaskedArray) and np.ma.getmaskarray(value).any():
        return None
    return value.item() if isinstance(value, np.ndarray) and value.ndim == 0 else value


def number(
    name: str,
    value: Any,
    low: float = -math.inf,
    high: float = math.inf,
    *,
    expected: str = "a finite number",
    above: bool = False,
    infinite: bool = False,
    error: type[GridPathError] = GridPathError,
) -> float:
    """Return a number from ``low`` to ``high``.

    Parameters
    ----------
    name : str
        What the message calls it.
    value : object
    low, high : float
        Both included, but for ``low`` with ``above``.
    expected : str
        What the message says was expected.
    above : bool
        Whether the number must be larger than ``low``.
    infinite : bool
        Whether infinity counts as a number.
    error : type
        The class of the error.
    """
    given = _scalar(value)
    found = math.nan
    if isinstance(given, Real | Decimal) and not isinstance(given, bool | np.bool_):
        try:
            found = float(given)
        except (ValueError, OverflowError):
            found = math.nan
    if not (low <= found <= high) or (above and found == low) or not (infinite or math.isfinite(found)):
        raise error(f"{name} is {shown(value)}, expected {expected}")
    return found


def whole(
    name: str,
    value: Any,
    least: int | None = None,
    most: int | None = None,
    *,
    expected: str | None = None,
    error: type[GridPathError] = GridPathError,
) -> int:
    """Return a whole number from ``least`` to ``most``; a float is none, whatever its value."""
    given = _scalar(value)
    if isinstance(given, Integral) and not isinstance(given, bool | np.bool_):
        found = int(given)
        if (least is None or least <= found) and (most is None or found <= most):
            return found
    if expected is None:
        ends = [f"{words} {end:,}" for words, end in (("at least", least), ("at most", most)) if end is not None]
        expected = f"a whole number{' of ' if ends else ''}{' and '.join(ends)}"
    raise error(f"{name} is {shown(value)}, expected {expected}")


def flag(name: str, value: Any, error: type[GridPathError] = GridPathError, *, expected: str = "True or False") -> bool:
    """Return a truth value."""
    given = _scalar(value)
    if not isinstance(given, bool | np.bool_):
        raise error(f"{name} is {shown(value)}, expected {expected}")
    return bool(given)


def text(name: str, value: Any, error: type[GridPathError] = GridPathError) -> str:
    """Return a text, of letters that a file can hold: half of a pair of surrogates is none."""
    try:
        if isinstance(value, str) and value.encode() is not None:
            return value
    except UnicodeEncodeError:
        pass
    raise error(f"{name} is {shown(value)}, expected a text")


def one_of(name: str, value: Any, known: Iterable[str], error: type[GridPathError] = GridPathError) -> str:
    """Return a text that is among the known ones."""
    known = list(known)
    if not (isinstance(value, str) and value in known):
        raise error(f"{name} is {shown(value)}, expected one of {', '.join(known)}")
    return value


def known(kind: str, value: Any, names: Iterable[str], error: type[GridPathError] = GridPathError) -> str:
    """Return the name of one of the things of a kind, or name the nearest that there is."""
    names = list(names)
    if not isinstance(value, str):
        raise error(f"there is no {kind} {shown(value)}; expected one of {', '.join(names)}")
    if value not in names:
        raise error(f"there is no {kind} {shown(value)}; {nearest(value[:_MOST_SHOWN], names)}")
    return value


def names(name: str, value: Any, error: type[GridPathError] = GridPathError) -> list[str]:
    """Return a list of texts; a single text is a list of one."""
    found = [value] if isinstance(value, str) else items(name, value, "texts", error)
    for item in found:
        if not isinstance(item, str):
            raise error(f"{name} holds {shown(item)}, expected texts")
    return found


def items(name: str, value: Any, expected: str, error: type[GridPathError] = GridPathError, most: float = math.inf) -> list:
    """Return the items, at the most so many, of a list, tuple, array, set, dictionary view, or whatever knows its length."""
    if isinstance(value, Iterable) and isinstance(value, Sized) and not isinstance(value, str | bytes):
        # An array without dimensions, or an object's own failure, is refused below.
        with contextlib.suppress(Exception):
            if len(value) <= most:
                return list(value)
    raise error(f"{name} is {shown(value)}, expected {expected}")


def instance(
    name: str, value: Any, cls: type[T], hint: str = "", optional: bool = False, error: type[GridPathError] = GridPathError
) -> Any:
    """Return an object of a class, or of one that inherits it."""
    if not isinstance(value, cls) and not (optional and value is None):
        article = "an" if cls.__name__[0] in "AEIOU" else "a"
        raise error(f"{name} is {shown(value)}, expected {article} {cls.__name__}{hint}")
    return value


def function(name: str, value: Any, expected: str, n_arguments: int, optional: bool = False) -> Any:
    """Return what can be called with so many arguments, and is no class."""
    if optional and value is None:
        return value
    if not callable(value) or isinstance(value, type) or not _takes(value, n_arguments):
        raise GridPathError(f"{name} is {shown(value)}, expected {expected}")
    return value


def _takes(function: Callable, n_arguments: int) -> bool:
    """Whether a function can be called with so many arguments, as far as its signature says."""
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):  # some that are compiled have none
        return True
    try:
        signature.bind(*range(n_arguments))
    except TypeError:
        return False
    return True


def file_path(name: str, value: Any, error: type[GridPathError] = GridPathError) -> str:
    """Return the path of a file or folder as a text."""
    try:
        found = os.fspath(value)
        os.fsencode(found)
    except Exception:  # the object's own failure, or a letter that no name of a file can have
        found = None
    if not isinstance(found, str) or not 0 < len(found) <= _LONGEST_PATH or "\0" in found:
        raise error(f"{name} is {shown(value)}, expected the path of a file or folder")
    return found


def array(
    name: str,
    value: Any,
    shape: tuple[int | None, ...] | None = None,
    kinds: str = "biuf",
    *,
    expected: str,
    finite: bool = False,
    error: type[GridPathError] = GridPathError,
) -> np.ndarray:
    """Return an array, a view where one was given: nobody may write into it.

    Parameters
    ----------
    name : str
        What the message calls it.
    value : array_like
    shape : tuple of int or None, optional
        The shape that it must have; None stands for any length.
    kinds : str
        The kinds of numpy's data types that it may have; "b" booleans, "i" and "u" whole numbers, "f" floats.
    expected : str
        What the message says was expected.
    finite : bool
        Whether all values must be finite.
    error : type
        The class of the error.
    """
    if isinstance(value, np.ma.MaskedArray) and np.ma.getmaskarray(value).any():
        raise error(f"{name} holds masked values, expected {expected}")
    try:
        found = np.asarray(value)
    except Exception:  # rows of different lengths, or an object's own failure
        raise error(f"{name} is {shown(value)}, expected {expected}") from None
    fits = shape is None or (
        found.ndim == len(shape) and all(want is None or have == want for have, want in zip(found.shape, shape, strict=True))
    )
    if found.size == 0 and found.dtype.kind == "f" and "f" not in kinds:
        # An empty list has the type float, whatever it was to hold.
        found = found.astype(bool if kinds == "b" else np.int64)
    if not fits or found.dtype.kind not in kinds:
        given = shown(found) if found.dtype.kind != "O" and found.ndim else shown(value)
        raise error(f"{name} is {given}, expected {expected}")
    if finite and found.dtype.kind == "f" and not np.isfinite(found).all():
        raise error(f"{name} holds values that are not finite, expected {expected}")
    return found


def within(values: np.ndarray, low: int, high: int) -> bool:
    """Return whether all values lie from ``low`` to ``high``."""
    return values.size == 0 or bool(low <= values.min() and values.max() <= high)
