"""Values of a study checked: each function returns what was written in one form, or raises a StudyError that says where."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import Any, TypeVar

import numpy as np

from pymoo_gridpath.checks import shown
from pymoo_gridpath.errors import GridError, GridPathError, StudyError, nearest
from pymoo_gridpath.grid import CornerCutting
from pymoo_gridpath.grid.arguments import as_corner_cutting, as_moves

T = TypeVar("T")

# Places in a study: keys and indices.
Where = tuple[str | int, ...]

# The largest seed that NumPy takes.
MAX_SEED = 2**32 - 1
MAX_SEEDS = 100_000
# Far more than a run can do with, so that a zero too many is noticed.
MAX_BUDGET = 1_000_000_000

# Keys of a study that none of its tables has too.
_KEYS_OF_STUDY = ("seeds", "budget", "reference", "target")


def key_of(where: Where) -> str:
    """Return the key at the end of a place, whatever the index in its list."""
    return next((part for part in reversed(where) if isinstance(part, str)), "the study")


def show(value: object) -> str:
    """Return a value as the message of an error shows it: as TOML writes it, and not too long."""
    return str(value).lower() if isinstance(value, bool) else shown(value)


def check_keys(table: Mapping[str, Any], known: Iterable[str], where: Where, owner: str) -> None:
    """Refuse keys that nobody reads, with the nearest one that is."""
    known = list(known)
    for key in table:
        if key not in known:
            if where:
                refuse_key_of_study(key, (*where, key), owner)
            raise StudyError(f"{owner} has no key {show(key)}; {nearest(shown(key), known)}", (*where, key))


def refuse_key_of_study(key: str, where: Where, owner: str) -> None:
    """Refuse a key of the study that stands below the head of a table, which makes it a key of that table."""
    if key in _KEYS_OF_STUDY:
        raise StudyError(f"{key} is a key of the study, not of {owner}; write it above the first [[...]] table", where)


def told(where: Where, function: Callable[..., T], *arguments: Any) -> T:
    """Return what a function of the package returns, and put the place in the study before what it says is wrong."""
    try:
        return function(*arguments)
    except GridPathError as error:
        raise StudyError(str(error), where) from None


def table(value: object, where: Where) -> dict[str, Any]:
    """Return a table as a dictionary with texts as keys."""
    if not isinstance(value, Mapping) or not all(isinstance(key, str) for key in value):
        raise StudyError(f"{key_of(where)} is {show(value)}, expected a table", where)
    return dict(value)


def text(value: object, where: Where) -> str:
    """Return a text that is not blank and stands on one line."""
    if not isinstance(value, str) or not value.strip() or not value.isprintable():
        raise StudyError(f"{key_of(where)} is {show(value)}, expected a text on one line", where)
    return value.strip()


def flag(value: object, where: Where) -> bool:
    """Return true or false."""
    found = _plain(value)
    if not isinstance(found, bool):
        raise StudyError(f"{key_of(where)} is {show(value)}, expected true or false", where)
    return found


def corner_cutting(value: object, where: Where) -> CornerCutting:
    """Return how corners may be cut."""
    return _of_grid(as_corner_cutting, value, where)


def moves(value: object, where: Where) -> int:
    """Return how many neighbours a cell has."""
    return _of_grid(as_moves, value, where)


def _of_grid(check, value: object, where: Where):
    try:
        return check(_plain(value))
    except GridError as error:
        raise StudyError(str(error), where) from None


def choice(value: object, known: Iterable[str], where: Where) -> str:
    """Return one of some names."""
    known = list(known)
    if not isinstance(value, str) or value not in known:
        hint = nearest(value, known) if isinstance(value, str) else f"expected one of {', '.join(known)}"
        raise StudyError(f"{key_of(where)} is {show(value)}; {hint}", where)
    return value


def whole(value: object, where: Where, least: int = 0, most: int | None = None) -> int:
    """Return a whole number within its range."""
    within = f"{least} or more" if most is None else f"{least} to {most}"
    number = _plain(value)
    if not isinstance(number, int) or isinstance(number, bool) or number < least or (most is not None and number > most):
        raise StudyError(f"{key_of(where)} is {show(value)}, expected a whole number, {within}", where)
    return number


def real(value: object, where: Where, least: float = 0.0, most: float | None = None, open_below: bool = False) -> float:
    """Return a finite number within its range, which may leave out its lower end."""
    number = _plain(value)
    within = f"above {least:g}" if open_below else f"{least:g} or more"
    if most is not None:
        within = f"above {least:g}, at most {most:g}" if open_below else f"{least:g} to {most:g}"
    fits = isinstance(number, int | float) and not isinstance(number, bool) and _is_finite(number)
    if not fits or number < least or (open_below and number == least) or (most is not None and number > most):
        raise StudyError(f"{key_of(where)} is {show(value)}, expected a number, {within}", where)
    return float(number)


def number(value: object, where: Where) -> int | float:
    """Return a finite number."""
    found = _plain(value)
    if not isinstance(found, int | float) or isinstance(found, bool) or not _is_finite(found):
        raise StudyError(f"{key_of(where)} is {show(value)}, expected a number", where)
    return found


def cell(value: object, where: Where) -> tuple[int, int]:
    """Return a cell (x, y)."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if not isinstance(value, Sequence) or isinstance(value, str) or len(value) != 2:
        raise StudyError(f"{key_of(where)} is {show(value)}, expected a cell of two whole numbers, such as [12, 40]", where)
    x, y = (_plain(part) for part in value)
    if not all(isinstance(part, int) and not isinstance(part, bool) for part in (x, y)):
        raise StudyError(f"{key_of(where)} is {show(value)}, expected a cell of two whole numbers, such as [12, 40]", where)
    return x, y


def seeds(value: object, where: Where) -> tuple[int, ...]:
    """Return seeds written as a count (from 1 on), as a list, or as ``{ first = 100, count = 11 }``."""
    if isinstance(value, Mapping):
        given = table(value, where)
        check_keys(given, ("first", "count"), where, key_of(where))
        if "count" not in given:
            raise StudyError(f"{key_of(where)} has no count, expected such as {{ first = 100, count = 11 }}", where)
        first = whole(given.get("first", 1), (*where, "first"), 0, MAX_SEED - MAX_SEEDS)
        return tuple(range(first, first + whole(given["count"], (*where, "count"), 1, MAX_SEEDS)))
    # An array without dimensions holds a number, and is no list of any.
    value = value.tolist() if isinstance(value, np.ndarray) else value
    if isinstance(value, Collection) and not isinstance(value, str | bytes):
        return each_once(value, where, MAX_SEED)
    number = _plain(value)
    if isinstance(number, int) and not isinstance(number, bool) and 1 <= number <= MAX_SEEDS:
        return tuple(range(1, number + 1))
    raise StudyError(
        f"{key_of(where)} is {show(value)}, expected how many, a list such as [3, 5, 8], or {{ first = 100, count = 11 }}",
        where,
    )


def each_once(numbers: Iterable[Any], where: Where, most: int | None = None) -> tuple[int, ...]:
    """Return a list of one or more whole numbers of which none comes twice."""
    found: dict[int, None] = {}
    for value in numbers:
        number = whole(value, where, 0, most)
        if number in found:
            raise StudyError(f"{key_of(where)} lists {number} twice, expected each once", where)
        found[number] = None
        if len(found) > MAX_SEEDS:
            break
    if not 1 <= len(found) <= MAX_SEEDS:
        raise StudyError(f"{key_of(where)} has {len(found)} entries, expected 1 to {MAX_SEEDS}", where)
    return tuple(found)


def plain_json(value: object, where: Where) -> Any:
    """Return a value that JSON can hold, with whole floats as whole numbers, so that 20 and 20.0 are the same."""
    value = _plain(value)
    if isinstance(value, Mapping):
        return {str(key): plain_json(item, where) for key, item in value.items()}
    if isinstance(value, Collection) and not isinstance(value, str | bytes):
        return [plain_json(item, where) for item in value]
    if isinstance(value, float) and math.isfinite(value):
        return int(value) if value.is_integer() else value
    if value is None or isinstance(value, bool | int | str):
        return value
    raise StudyError(f"{key_of(where)} is {show(value)}, expected a finite number, a text, true, false, or a list", where)


def like(default: object, value: Any) -> Any:
    """Return a number as the kind of number that the default is, so that 4 and 4.0 are the same."""
    return float(value) if isinstance(default, float) and isinstance(value, int) and not isinstance(value, bool) else value


def _is_finite(number: float) -> bool:
    """Whether a number is neither infinite nor NaN, nor a whole number beyond what floats hold."""
    try:
        return math.isfinite(number)
    except OverflowError:
        return False


def _plain(value: object) -> Any:
    """Return a scalar of NumPy as Python's own."""
    item = getattr(value, "item", None)
    return item() if callable(item) and getattr(value, "ndim", None) == 0 else value
