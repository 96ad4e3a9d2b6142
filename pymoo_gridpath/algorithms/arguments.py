"""The keyword arguments that pymoo's algorithms really take."""

from __future__ import annotations

import copy
import inspect
import re
from collections.abc import Callable, Collection, Mapping
from typing import Any

import numpy as np
from pymoo.core.duplicate import DuplicateElimination
from pymoo.operators.crossover.dex import DE_REPAIRS

from pymoo_gridpath import checks
from pymoo_gridpath.errors import CapabilityError, nearest
from pymoo_gridpath.planners.signature import parameters_of
from pymoo_gridpath.registry import SLOTS

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

# Of arguments that are rows.
_EXAMPLES = {"ref_points": "[[30, 5], [40, 2]]", "ref_dirs": "[[0, 1], [1, 0]]"}

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


def check_values(owner: str, given: Mapping[str, Any], accepted: Mapping[str, Any]) -> None:
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
            _check_name(key, value, NAMES[key])
        elif key in _OWN_CHECKS:
            _OWN_CHECKS[key](owner, key, value)
        elif key in LEAST:
            check_whole(owner, key, value, LEAST[key], MOST)
        elif key in SHARES or key == "adapt_freq":
            above = key == "adapt_freq"
            room = "above 0, at most 1" if above else "from 0 to 1"
            checks.number(key, value, 0, 1, above=above, expected=f"a number {room} for {owner}", error=CapabilityError)
        elif key in SLOTS and isinstance(value, str):
            raise CapabilityError(
                f"{key} is {checks.shown(value)}, expected an object; names stand in operators={{{key!r}: ...}}"
            )
        elif isinstance(default, bool):
            checks.flag(key, value, CapabilityError)
        elif isinstance(default, int):
            check_whole(owner, key, value)
        elif isinstance(default, float):
            checks.number(key, value, 0, expected=f"a finite number of 0 or more for {owner}", error=CapabilityError)


def check_together(owner: str, given: Mapping[str, Any], n_obj: int, ref_dirs: np.ndarray | None) -> None:
    """Refuse values that do not go with the problem or the reference directions, and that pymoo would make fit without a word.

    Raises
    ------
    CapabilityError
    """
    weights, n_neighbors = given.get("weights"), given.get("n_neighbors")
    if weights is not None and len(weights) != n_obj:
        raise CapabilityError(f"weights has {len(weights)} entries, expected one for each of the {n_obj} objectives")
    if ref_dirs is not None and n_neighbors is not None and n_neighbors > len(ref_dirs):
        raise CapabilityError(
            f"n_neighbors is {n_neighbors}, expected at most the {len(ref_dirs)} reference directions of {owner}"
        )


def check_whole(owner: str, name: str, value: Any, least: int = 1, most: int | None = None) -> int:
    """Return an argument of an algorithm if it is a whole number in its range."""
    room = f"at least {least}" if most is None else f"at least {least} and at most {most:,}"
    return checks.whole(name, value, least, most, expected=f"a whole number of {room} for {owner}", error=CapabilityError)


def check_pop_size(owner: str, value: Any, least: int = 1) -> int:
    """Return the size of a population if it is a whole number in its range."""
    return check_whole(owner, "pop_size", value, least, MOST)


def rows(name: str, value: Any, n_obj: int | None = None) -> np.ndarray:
    """Return points or directions, a row each, as an array of floats.

    Parameters
    ----------
    name : str
        The argument.
    value : array_like, shape (n_rows, n_obj)
    n_obj : int, optional
        Number of objectives; by default rows are as long as the first.

    Raises
    ------
    CapabilityError
    """
    each = "values" if n_obj is None else f"{n_obj} finite numbers"
    expected = f"rows of {each}, one an objective, such as {_EXAMPLES[name]}"
    found = checks.array(name, value, expected=expected, finite=True, kinds="iuf", error=CapabilityError).astype(float)
    if found.ndim != 2 or not found.size or n_obj not in (None, found.shape[1]):
        given = f"has shape {found.shape}" if found.ndim else f"is {checks.shown(value)}"
        raise CapabilityError(f"{name} {given}, expected {expected}")
    return found


def _check_name(name: str, value: Any, known: Collection[str]) -> None:
    if not isinstance(value, str) or value not in known:
        raise CapabilityError(f"{name} is {checks.shown(value)}; {nearest(checks.shown(value), known)}")


def _check_rows(owner: str, name: str, value: Any) -> None:
    found = rows(name, value)
    if name == "ref_dirs" and ((found < 0).any() or not found.any(axis=1).all()):
        raise CapabilityError(
            f"{name} holds a row that is no direction, expected shares of 0 or more, not all 0, for {owner}, such as "
            f"{_EXAMPLES[name]}"
        )


def _check_weights(owner: str, name: str, value: Any) -> None:
    expected = f"a weight of 0 or more for each objective, not all 0, for {owner}, such as [0.5, 0.5]"
    found = checks.array(name, value, (None,), "iuf", expected=expected, finite=True, error=CapabilityError)
    if (found < 0).any() or not found.any():
        raise CapabilityError(f"{name} is {checks.shown(value)}, expected {expected}")


def _check_variant(owner: str, name: str, value: Any) -> None:
    match = VARIANT.fullmatch(value) if isinstance(value, str) else None
    if match is None or match["base"] not in BASES_OF_VARIANTS or match["crossover"] not in CROSSOVERS_OF_VARIANTS:
        number = match["n_diffs"] if match else "1"
        _check_name(
            name, value, [f"DE/{base}/{number}/{kind}" for base in BASES_OF_VARIANTS for kind in CROSSOVERS_OF_VARIANTS]
        )


def _check_scale(owner: str, name: str, value: Any) -> None:
    """Refuse what is neither a scale factor of differences nor a range that it is drawn from."""
    expected = f"a number above 0, at most 2, or a range such as [0.2, 0.8], for {owner}"
    ends = list(value) if isinstance(value, list | tuple) or np.ndim(value) == 1 else [value, value]
    low, high = (checks.number(name, end, 0, 2, expected=expected, error=CapabilityError) for end in (ends * 2)[:2])
    if len(ends) != 2 or low > high or high == 0:
        raise CapabilityError(f"{name} is {checks.shown(value)}, expected {expected}")


def _check_duplicates(owner: str, name: str, value: Any) -> None:
    if not isinstance(value, bool | DuplicateElimination):
        raise CapabilityError(f"{name} is {checks.shown(value)}, expected True, False or a DuplicateElimination for {owner}")


_OWN_CHECKS: dict[str, Callable[[str, str, Any], None]] = {
    "variant": _check_variant,
    "F": _check_scale,
    "weights": _check_weights,
    "ref_points": _check_rows,
    "ref_dirs": _check_rows,
    "eliminate_duplicates": _check_duplicates,
}


def fresh_defaults(accepted: dict[str, Any]) -> dict[str, Any]:
    """Return copies of the default objects, which pymoo shares between all instances of a class."""
    plain = (str, int, float, tuple, type, type(None))
    return {
        key: copy.deepcopy(value)
        for key, value in accepted.items()
        if value is not inspect.Parameter.empty and not isinstance(value, plain)
    }
