"""Parameters of operators, which pymoo may hold as variables in order to tune them."""

from __future__ import annotations

from typing import Any

from pymoo.core.variable import Variable


def number(parameter: Any) -> float:
    """Return the number that a parameter stands for."""
    value: Any = parameter.get() if isinstance(parameter, Variable) else parameter
    return float(value)
