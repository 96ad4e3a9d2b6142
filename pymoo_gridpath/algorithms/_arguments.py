"""The keyword arguments that pymoo's algorithms really take."""

from __future__ import annotations

import copy
import inspect
from typing import Any

import numpy as np

from pymoo_gridpath.errors import CapabilityError, nearest

# Arguments that a constructor lists, or hands on, and then sets itself or ignores.
_EVERYWHERE = {"advance_after_initial_infill", "mating"}
_DE = {"eliminate_duplicates", "n_offsprings", "selection", "crossover", "mutation"}
_INEFFECTIVE: dict[str, set[str]] = {
    "MOEAD": {"pop_size", "eliminate_duplicates", "survival", "selection", "n_offsprings"},
    "ParallelMOEAD": {"pop_size", "eliminate_duplicates", "survival", "selection"},
    "CTAEA": {"pop_size", "n_offsprings"},
    "RNSGA2": {"survival"},
    "RNSGA3": {"pop_size", "ref_dirs", "survival"},
    "PINSGA2": {"survival"},
    "AGEMOEA": {"survival"},
    "AGEMOEA2": {"survival"},
    "NSDE": _DE,
    "NSDER": _DE,
    "GDE3": _DE,
    "GDE3MNN": _DE | {"survival"},
    "GDE32NN": _DE | {"survival"},
    "GDE3PCD": _DE | {"survival"},
    "MOPSO_CD": {"archive"},
}


def parameters(cls: type, name: str) -> dict[str, Any]:
    """Return what the constructor of an algorithm takes, through all ``**kwargs`` up to its bases, with the defaults.

    Parameters
    ----------
    cls : type
    name : str
        Its name in the capability table.

    Returns
    -------
    dict
        Default by parameter; ``inspect.Parameter.empty`` where there is none.
    """
    found: dict[str, Any] = {}
    for base in cls.__mro__:
        if "__init__" not in vars(base):
            continue
        listed = list(inspect.signature(vars(base)["__init__"]).parameters.values())[1:]
        for item in listed:
            if item.kind in (item.POSITIONAL_OR_KEYWORD, item.KEYWORD_ONLY):
                found.setdefault(item.name, item.default)
        if not any(item.kind is item.VAR_KEYWORD for item in listed):
            break
    return {key: value for key, value in found.items() if key not in _EVERYWHERE | _INEFFECTIVE.get(name, set())}


def check(name: str, given, accepted) -> None:
    """Refuse keyword arguments that an algorithm does not take.

    Raises
    ------
    CapabilityError
        With the nearest that it takes; pymoo itself would say nothing and go without.
    """
    for key in given:
        if key not in accepted:
            raise CapabilityError(f"{name} takes no argument {key!r}; {nearest(key, sorted(set(accepted)), 'it takes')}")


def check_whole(owner: str, name: str, value: Any, least: int = 1) -> None:
    """Refuse an argument of an algorithm that is no whole number, or less than the least."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least:
        raise CapabilityError(f"{name} is {value!r}, expected a whole number of at least {least} for {owner}")


def fresh_defaults(accepted: dict[str, Any]) -> dict[str, Any]:
    """Return copies of the default objects, which pymoo shares between all instances of a class."""
    plain = (str, int, float, tuple, type, type(None))
    return {
        key: copy.deepcopy(value)
        for key, value in accepted.items()
        if value is not inspect.Parameter.empty and not isinstance(value, plain)
    }
