"""The algorithms and operators of a study by name, each in the one form in which a study writes it."""

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
from pymoo_gridpath.study.specification import values
from pymoo_gridpath.study.specification.values import Where

BASES = ("default", "paper", "scalarized", "random")

#: What `make_algorithm` takes as operators, and what each must be.
SLOTS: dict[str, type] = {
    "sampling": Sampling,
    "crossover": Crossover,
    "mutation": Mutation,
    "repair": Repair,
    "eliminate_duplicates": DuplicateElimination,
}

# An example of each, for messages.
_EXAMPLES: dict[str, str] = {
    "sampling": "ScalarizedSampling",
    "crossover": "SpliceCrossover",
    "mutation": "PathMutation",
    "repair": "PathRepair",
    "eliminate_duplicates": "RowDuplicates",
}


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
        raise StudyError(f"{slot} has no class, expected such as {{ class = {_EXAMPLES[slot]!r} }}", where)
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
def default_operator(name: str, slot: str) -> dict[str, Any]:
    return {"class": name, **_own_arguments(operator_classes(slot)[name])}
