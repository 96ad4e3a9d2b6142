"""Operators by name."""

from __future__ import annotations

import inspect
import pkgutil
from typing import Any

from pymoo_gridpath import checks
from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.registry import OPERATORS, SLOTS

#: The base class of the operators for each of the arguments of pymoo's algorithms that are operators.
BASES: dict[str, type] = {slot: pkgutil.resolve_name(path) for slot, path in SLOTS.items()}


def find_operator(slot: str, name: str) -> type:
    """Return the class of an operator by its name.

    Parameters
    ----------
    slot : str
        What it is for, such as "crossover".
    name : str

    Raises
    ------
    CapabilityError
        If there is none for that, with the nearest, or it is of an installed package and cannot be imported.

    Examples
    --------
    >>> find_operator("repair", "EdgeFixing").__module__
    'pymoo_gridpath.operators.repair'
    >>> find_operator("mutation", "PathMutatoin")
    Traceback (most recent call last):
    ...
    pymoo_gridpath.errors.CapabilityError: there is no mutation 'PathMutatoin'; did you mean 'PathMutation'?
    """
    if name in OPERATORS and issubclass(OPERATORS[name], BASES[slot]):
        return OPERATORS[name]
    fitting = [known for known, cls in OPERATORS.items() if issubclass(cls, BASES[slot])]
    return OPERATORS[checks.known(slot, name, fitting, CapabilityError)]


def operator_of(slot: str, given: Any) -> Any:
    """Return an operator of a name, with the defaults of its arguments; all else as it is.

    Raises
    ------
    CapabilityError
        If there is no operator of that name, or it has arguments without a default.
    """
    if not isinstance(given, str):
        return given
    cls = find_operator(slot, given)
    needed = [key for key, item in inspect.signature(cls).parameters.items() if _is_needed(item)]
    if needed:
        raise CapabilityError(f"{slot} is {given!r}, which needs {', '.join(needed)}; expected an object in place of its name")
    return cls()


def _is_needed(item: inspect.Parameter) -> bool:
    return item.default is item.empty and item.kind not in (item.VAR_POSITIONAL, item.VAR_KEYWORD)
