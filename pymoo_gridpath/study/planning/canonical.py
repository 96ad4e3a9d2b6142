"""The one form in which a study writes each problem and algorithm, so that what is the same has the same key.

Defaults are written out, or left out wherever they are given, so that a study that spells a default out means the same runs.
"""

from __future__ import annotations

import functools
import inspect
import re
from collections.abc import Mapping
from typing import Any

from pymoo.core.crossover import Crossover
from pymoo.core.duplicate import DuplicateElimination
from pymoo.core.mutation import Mutation
from pymoo.core.repair import Repair
from pymoo.core.sampling import Sampling

from pymoo_gridpath import operators as _operators
from pymoo_gridpath.algorithms import CAPABILITIES
from pymoo_gridpath.algorithms.factory import _class_of, find_capability
from pymoo_gridpath.errors import CapabilityError, StudyError, nearest
from pymoo_gridpath.problems.grid_path import DEFAULT_PENALTY
from pymoo_gridpath.representations import REPRESENTATIONS, MonotoneRepresentation
from pymoo_gridpath.study.specification import values
from pymoo_gridpath.study.specification.values import Where

BASES = ("default", "paper", "scalarized", "random")

DEFAULT_POP_SIZE = 100
PRESET_POP_SIZE = 500
PRESET_PENALTY = 1.0

#: What `make_algorithm` takes as operators, and what each must be.
SLOTS: dict[str, type] = {
    "sampling": Sampling,
    "crossover": Crossover,
    "mutation": Mutation,
    "repair": Repair,
    "eliminate_duplicates": DuplicateElimination,
}

# What `path_operators` and `paper_operators` return, all with their default arguments; the mutation of the latter depends on
# the problem, so that "paper" stands for it.
_PATH: dict[str, str] = {
    "sampling": "ScalarizedSampling",
    "crossover": "SpliceCrossover",
    "mutation": "PathMutation",
    "repair": "PathRepair",
    "eliminate_duplicates": "RowDuplicates",
}
_PAPER = {"sampling": "RandomSampling", "repair": "EdgeFixing", "eliminate_duplicates": "RowDuplicates"}
_PAPER_CROSSOVERS = {"binary": "TwoPointCrossover", "mixed": "MixedCrossover"}


# -- algorithms ---------------------------------------------------------------------------------------------------------


def algorithm_name(name: str, where: Where) -> str:
    """Return an algorithm's name as the capability table writes it, or "exact".

    Raises
    ------
    StudyError
        If there is no such algorithm, or no grid problem suits it, or a package that it needs is missing.
    """
    if re.sub(r"[^a-z]", "", name.lower()) in ("exact", "exactfront"):
        return "exact"
    try:
        row = find_capability(name)
    except CapabilityError:
        raise StudyError(
            f"there is no algorithm {values.show(name)}; {nearest(name, [*CAPABILITIES, 'exact'])}", where
        ) from None
    if row.unfit:
        raise StudyError(f"{row.name} {row.unfit}", where)
    if row.needs == "automated_dm":
        raise StudyError(f"{row.name} asks a decision maker during the run, whom a study cannot describe", where)
    try:
        _class_of(row)
    except CapabilityError as error:
        raise StudyError(str(error), where) from None
    return row.name


# -- operators ----------------------------------------------------------------------------------------------------------


def operators(given: Any, where: Where) -> dict[str, Any]:
    """Return the operators of an algorithm: ``base``, and each single one that is given with all of its arguments.

    Raises
    ------
    StudyError
        If there is no such set, operator or argument, or an operator is of another kind, or it refuses an argument.
    """
    if isinstance(given, str):
        return {"base": values.choice(given, BASES, where)}
    table = values.table(given, where)
    values.check_keys(table, ("base", *SLOTS), where, "operators")
    found: dict[str, Any] = {"base": values.choice(table.pop("base", "default"), BASES, (*where, "base"))}
    return found | {slot: _operator(slot, value, (*where, slot)) for slot, value in table.items()}


@functools.cache
def operator_classes(slot: str) -> dict[str, type]:
    """Return the operators of this package that fit a slot, by name."""
    classes = {name: getattr(_operators, name) for name in _operators.__all__}
    return {name: cls for name, cls in classes.items() if isinstance(cls, type) and issubclass(cls, SLOTS[slot])}


def make_operator(slot: str, spec: Mapping[str, Any]):
    """Return the operator that a canonical entry describes."""
    return operator_classes(slot)[spec["class"]](**{key: value for key, value in spec.items() if key != "class"})


def _operator(slot: str, given: Any, where: Where) -> dict[str, Any]:
    table = {"class": given} if isinstance(given, str) else values.table(given, where)
    if "class" not in table:
        raise StudyError(f"{slot} has no class, expected such as {{ class = {_PATH[slot]!r} }}", where)
    classes = operator_classes(slot)
    name = values.choice(table.pop("class"), classes, where)
    arguments = _own_arguments(classes[name])
    for key in table:
        if key not in arguments:
            hint = nearest(key, arguments, "it takes") if arguments else "it takes none"
            raise StudyError(f"{name} takes no argument {values.show(key)}; {hint}", (*where, key))
        if isinstance(arguments[key], int | float) or key == "prob_var":
            values.number(table[key], (*where, key))
    for key, item in inspect.signature(classes[name]).parameters.items():
        if key in arguments and item.default is item.empty and key not in table:
            raise StudyError(f"{name} has no {key}, expected such as {{ class = {name!r}, {key} = 2 }}", where)
    given = {key: values.like(arguments[key], values.plain_json(value, (*where, key))) for key, value in table.items()}
    spec = {"class": name, **arguments, **given}
    try:
        make_operator(slot, spec)
    except (ValueError, TypeError, ArithmeticError) as error:
        raise StudyError(f"{name} cannot be made so: {error}", where) from None
    return spec


def _own_arguments(cls: type) -> dict[str, Any]:
    """Return the arguments that a class lists, with their defaults."""
    if cls.__init__ is object.__init__:
        return {}
    kinds = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    listed = [item for item in inspect.signature(cls).parameters.values() if item.kind in kinds]
    defaults = {item.name: None if item.default is item.empty else item.default for item in listed}
    return {
        key: values.like(default, values.plain_json(default, (key,)))
        for key, default in defaults.items()
        if key not in ("name", "vtype", "repair", "func", "cmp_func")
    }


@functools.cache
def _default_of(name: str, slot: str) -> dict[str, Any]:
    return {"class": name, **_own_arguments(operator_classes(slot)[name])}


def _resolved_operators(given: Mapping[str, Any], algorithm: str, representation: str) -> dict[str, Any]:
    """Return every operator of an algorithm on problems of a representation; "paper" where `paper_operators` decides."""
    base = given["base"]
    if base == "default":
        base = "paper" if issubclass(REPRESENTATIONS[representation], MonotoneRepresentation) else "scalarized"
    # Differential evolution makes its children itself.
    slots = list(SLOTS) if CAPABILITIES[algorithm].operators or given["base"] != "default" else ["sampling", "repair"]
    names: dict[str, str] = dict(_PATH)
    if base == "random":
        names["sampling"] = "ReachableSampling"
    elif base == "paper":
        names = {**_PAPER, "crossover": _PAPER_CROSSOVERS.get(representation, "DiscreteSBX")}
    found: dict[str, Any] = {slot: dict(_default_of(names[slot], slot)) if slot in names else "paper" for slot in slots}
    return found | {slot: dict(value) for slot, value in given.items() if slot != "base"}


# -- problems and runs --------------------------------------------------------------------------------------------------


def settle(problem: Mapping[str, Any]) -> dict[str, Any]:
    """Return a problem with the default penalty of its obstacle handling written out."""
    settled = dict(problem)
    if settled["penalty"] is None and settled["obstacles"] == "penalty":
        settled["penalty"] = DEFAULT_PENALTY
    elif settled["penalty"] is None and settled["obstacles"] == "limit":
        settled["penalty"] = float(n_cells(settled["grid"]))
    return settled


def n_cells(grid: Mapping[str, Any]) -> int:
    """Return how many cells a grid in canonical form has."""
    return grid["random"]["size"] ** 2 if "random" in grid else grid["width"] * grid["height"]


def resolve(
    problem: Mapping[str, Any], algorithm: Mapping[str, Any], overrides: Mapping[str, Any]
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the problem and the algorithm of a run in canonical form.

    Parameters
    ----------
    problem : mapping
        `PlannedProblem.spec`.
    algorithm, overrides : mapping
        `PlannedAlgorithm.spec` and ``overrides``.

    Returns
    -------
    tuple of two dicts
        The problem with the overrides applied, and the algorithm with the defaults written out that depend on the problem.
    """
    if "preset" in algorithm:
        return _overridden(problem, _preset_overrides(problem, overrides)), dict(algorithm)
    changed = _overridden(problem, overrides)
    if algorithm["algorithm"] == "exact":
        return changed, dict(algorithm)
    settled = dict(algorithm)
    if settled["smoothness"] is None:
        settled["smoothness"] = CAPABILITIES[settled["algorithm"]].smoothness and "turn" not in changed["objectives"]
    settled["operators"] = _resolved_operators(settled["operators"], settled["algorithm"], changed["representation"])
    return changed, settled


def _overridden(problem: Mapping[str, Any], overrides: Mapping[str, Any]) -> dict[str, Any]:
    changed = dict(problem)
    if overrides.get("obstacles", problem["obstacles"]) != problem["obstacles"]:
        # They belong to the handling that is given up.
        changed |= {"penalty": None, "potential_limit": None}
    if overrides.get("representation") == "cells":
        changed["axis"] = "auto"
    return settle(changed | dict(overrides))


def _preset_overrides(problem: Mapping[str, Any], overrides: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the paper's planner changes in a problem, see `ahmed_deb_2013`."""
    brought: dict[str, Any] = {}
    if not issubclass(REPRESENTATIONS[problem["representation"]], MonotoneRepresentation):
        brought["representation"] = "integer"
    if len(problem["objectives"]) == 1 and problem["obstacles"] == "penalty":
        brought["obstacles"] = "constraint"
    if {**problem, **brought, **overrides}["obstacles"] == "penalty":
        brought["penalty"] = PRESET_PENALTY
    return brought | dict(overrides)
