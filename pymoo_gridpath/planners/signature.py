"""Which keyword arguments the constructor of an algorithm takes."""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Mapping
from typing import Any

from pymoo_gridpath import checks
from pymoo_gridpath.errors import CapabilityError, counted, nearest


def parameters_of(cls: type, below: type = object) -> dict[str, Any]:
    """Return what the constructor of a class takes, through all ``**kwargs`` up to its bases, with the defaults.

    Parameters
    ----------
    cls : type
    below : type, optional
        A base whose own arguments, and those beyond it, are left out.

    Returns
    -------
    dict
        Default by parameter; ``inspect.Parameter.empty`` where there is none.
    """
    found: dict[str, Any] = {}
    for base in cls.__mro__[: cls.__mro__.index(below)]:
        if "__init__" not in vars(base):
            continue
        listed = list(inspect.signature(vars(base)["__init__"]).parameters.values())[1:]
        for item in listed:
            if item.kind in (item.POSITIONAL_OR_KEYWORD, item.KEYWORD_ONLY):
                found.setdefault(item.name, item.default)
        if not any(item.kind is item.VAR_KEYWORD for item in listed):
            break
    return found


def refuse_unknown(owner: str, given: Iterable[str], accepted: Iterable[str]) -> None:
    """Refuse keyword arguments that an algorithm does not take.

    Raises
    ------
    CapabilityError
        With the nearest that it takes; pymoo itself would say nothing and go without.
    """
    accepted = sorted(set(accepted))
    for key in given:
        if key not in accepted:
            hint = nearest(key, accepted, "it takes") if accepted else "it takes none"
            raise CapabilityError(f"{owner} takes no argument {checks.shown(key)}; {hint}")


def refuse_missing(owner: str, given: Iterable[str], accepted: Mapping[str, Any]) -> None:
    """Refuse to do without keyword arguments that have no default.

    Raises
    ------
    CapabilityError
        With those that are missing.
    """
    given = set(given)
    missing = [key for key, default in accepted.items() if default is inspect.Parameter.empty and key not in given]
    if missing:
        raise CapabilityError(f"{owner} needs {counted(len(missing), 'more argument')}: {', '.join(missing)}")
