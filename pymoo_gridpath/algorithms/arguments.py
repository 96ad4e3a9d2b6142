"""The keyword arguments that pymoo's algorithms really take."""

from __future__ import annotations

import copy
import inspect
import re
from typing import Any

import numpy as np
from pymoo.core.duplicate import DuplicateElimination
from pymoo.operators.crossover.dex import DE_REPAIRS

from pymoo_gridpath import checks
from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.planners.signature import parameters_of

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

# Whose arguments are known here.
_PACKAGES = ("builtins", "pymoo", "pymoo_gridpath")

# Values that mean something to pymoo; it takes others as well, and heeds them not at all or in the midst of a run.
NAMES = {"normalization": ("front", "ever", "no"), "version": ("A", "B"), "de_repair": tuple(DE_REPAIRS)}
SHARES = ("prob_neighbor_mating", "CR", "perc_detect_change", "perc_diversity", "mu")
LEAST = {"n_neighbors": 2, "batch_size": 1, "pop_per_ref_point": 1, "n_offsprings": 1}
VARIANT = re.compile(r"DE/(?P<base>.+)/(?P<n_diffs>[1-9]\d?)/(?P<crossover>.+)")
BASES_OF_VARIANTS = ("rand", "best", "current-to-best", "current-to-rand", "ranked")
CROSSOVERS_OF_VARIANTS = ("bin", "exp")

#: More members, children or directions than this no run has time for; a number beyond is a slip.
MOST = 100_000


def parameters(cls: type, name: str) -> dict[str, Any]:
    """Return what the constructor of an algorithm takes and heeds, see `parameters_of`, with the defaults.

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
    ineffective = _INEFFECTIVE.get(name, set())
    if cls.__module__.partition(".")[0] not in _PACKAGES:
        # What the nearest class of pymoo sets itself, unless that is listed anew.
        nearest = next((base for base in cls.__mro__ if base.__module__.startswith("pymoo.")), cls)
        ineffective = _INEFFECTIVE.get(nearest.__name__, set()) - own_parameters(cls)
    left_out = _EVERYWHERE | ineffective
    return {key: value for key, value in parameters_of(cls).items() if key not in left_out}


def own_parameters(cls: type) -> set[str]:
    """Return the arguments of a constructor that classes of others list, who check them themselves."""
    theirs = [base for base in cls.__mro__ if base.__module__.partition(".")[0] not in _PACKAGES]
    return {key for base in theirs if "__init__" in vars(base) for key in inspect.signature(vars(base)["__init__"]).parameters}


def check_values(owner: str, given: dict[str, Any], accepted: dict[str, Any]) -> None:
    """Refuse values that mean nothing to an algorithm, by what is known of each argument or else by the type of its default.

    Raises
    ------
    CapabilityError
        Arguments that are objects, such as operators and terminations, are left to pymoo.
    """
    for key, value in given.items():
        default = accepted.get(key, inspect.Parameter.empty)
        # RVEA without an adaptation is one of pymoo's, though not the default.
        if value is None and (default in (None, inspect.Parameter.empty) or key == "adapt_freq"):
            continue
        if key in NAMES:
            checks.one_of(key, value, NAMES[key], CapabilityError)
        elif key == "variant":
            _check_variant(owner, value)
        elif key == "F":
            _check_scale(owner, value)
        elif key in LEAST:
            check_whole(owner, key, value, LEAST[key], MOST)
        elif key in SHARES or key == "adapt_freq":
            above = key == "adapt_freq"
            room = "above 0, at most 1" if above else "from 0 to 1"
            checks.number(key, value, 0, 1, above=above, expected=f"a number {room} for {owner}", error=CapabilityError)
        elif key == "eliminate_duplicates":
            if not isinstance(value, bool | DuplicateElimination):
                raise CapabilityError(f"{key} is {checks.shown(value)}, expected True, False or a DuplicateElimination")
        elif isinstance(default, bool):
            checks.flag(key, value, CapabilityError)
        elif isinstance(default, int):
            check_whole(owner, key, value)
        elif isinstance(default, float):
            checks.number(key, value, expected=f"a finite number for {owner}", error=CapabilityError)


def check_whole(owner: str, name: str, value: Any, least: int = 1, most: int | None = None) -> int:
    """Return an argument of an algorithm if it is a whole number in its range."""
    room = f"at least {least}" if most is None else f"at least {least} and at most {most:,}"
    return checks.whole(name, value, least, most, expected=f"a whole number of {room} for {owner}", error=CapabilityError)


def _check_variant(owner: str, value: Any) -> None:
    match = VARIANT.fullmatch(value) if isinstance(value, str) else None
    if match is None or match["base"] not in BASES_OF_VARIANTS or match["crossover"] not in CROSSOVERS_OF_VARIANTS:
        raise CapabilityError(
            f"variant is {checks.shown(value)}, expected such as 'DE/rand/1/bin' for {owner}: one of "
            f"{', '.join(BASES_OF_VARIANTS)}, "
            f"how many differences, and one of {', '.join(CROSSOVERS_OF_VARIANTS)}"
        )


def _check_scale(owner: str, value: Any) -> None:
    """Refuse what is neither a scale factor of differences nor a range that it is drawn from."""
    expected = f"a number above 0, at most 2, or a range such as (0.2, 0.8), for {owner}"
    ends = list(value) if isinstance(value, list | tuple) or np.ndim(value) == 1 else [value, value]
    low, high = (checks.number("F", end, 0, 2, expected=expected, error=CapabilityError) for end in (ends * 2)[:2])
    if len(ends) != 2 or low > high or high == 0:
        raise CapabilityError(f"F is {checks.shown(value)}, expected {expected}")


def fresh_defaults(accepted: dict[str, Any]) -> dict[str, Any]:
    """Return copies of the default objects, which pymoo shares between all instances of a class."""
    plain = (str, int, float, tuple, type, type(None))
    return {
        key: copy.deepcopy(value)
        for key, value in accepted.items()
        if value is not inspect.Parameter.empty and not isinstance(value, plain)
    }
