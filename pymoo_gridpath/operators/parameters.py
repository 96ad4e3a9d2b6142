"""Parameters of operators, which pymoo may hold as variables in order to tune them."""

from __future__ import annotations

from typing import Any

from pymoo.core.variable import Variable

from pymoo_gridpath.errors import GridPathError


def number(parameter: Any) -> float:
    """Return the number that a parameter stands for."""
    value: Any = parameter.get() if isinstance(parameter, Variable) else parameter
    return float(value)


def in_range(name: str, value: Any, low: float, high: float) -> Any:
    """Return a parameter whose number lies from ``low`` to ``high``; None, for a default, passes.

    Raises
    ------
    GridPathError
        If it does not.
    """
    if value is not None and not low <= number(value) <= high:
        raise GridPathError(f"{name} is {number(value):g}, expected a number from {low:g} to {high:g}")
    return value


def one_or_two(n_offsprings: int) -> int:
    """Return the number of children of a mating if it is 1 or 2.

    Raises
    ------
    GridPathError
        If it is not.
    """
    if n_offsprings not in (1, 2):
        raise GridPathError(f"n_offsprings is {n_offsprings}, expected 1 or 2")
    return n_offsprings
