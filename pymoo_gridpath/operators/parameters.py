"""Parameters of operators, which pymoo may hold as variables in order to tune them."""

from __future__ import annotations

from typing import Any

from pymoo.core.variable import Variable

from pymoo_gridpath.errors import GridPathError


def number(parameter: Any) -> float:
    """Return the number that a parameter stands for."""
    value: Any = parameter.get() if isinstance(parameter, Variable) else parameter
    return float(value)


def in_range(name: str, value: Any, low: float, high: float, optional: bool = False) -> Any:
    """Return a parameter whose number lies from ``low`` to ``high``; None passes if it is optional.

    Raises
    ------
    GridPathError
        If it does not.
    """
    if value is None and optional:
        return None
    try:
        if isinstance(value, str | bytes):
            raise TypeError
        found = number(value)
    except (TypeError, ValueError):
        raise GridPathError(f"{name} is {value!r}, expected a number from {low:g} to {high:g}") from None
    if not low <= found <= high:
        raise GridPathError(f"{name} is {found:g}, expected a number from {low:g} to {high:g}")
    return value


def whole(name: str, value: Any, low: int, high: int) -> int:
    """Return a parameter that is a whole number from ``low`` to ``high``.

    Raises
    ------
    GridPathError
        If it is not.
    """
    if in_range(name, value, low, high) != int(value):
        raise GridPathError(f"{name} is {value:g}, expected a whole number")
    return int(value)


def one_or_two(n_offsprings: int) -> int:
    """Return the number of children of a mating if it is 1 or 2.

    Raises
    ------
    GridPathError
        If it is not.
    """
    if isinstance(n_offsprings, float) or n_offsprings not in (1, 2):
        raise GridPathError(f"n_offsprings is {n_offsprings!r}, expected 1 or 2")
    return int(n_offsprings)
