"""The algorithms and operators of a study by name, each in the one form in which a study writes it."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Mapping
from typing import Any

from pymoo_gridpath.algorithms import Capability, find_algorithm
from pymoo_gridpath.algorithms.known import class_of
from pymoo_gridpath.errors import StudyError, nearest
from pymoo_gridpath.operators.known import BASES, find_operator
from pymoo_gridpath.operators.sets import PATH_SAMPLINGS
from pymoo_gridpath.planners import Planner
from pymoo_gridpath.registry import OPERATORS
from pymoo_gridpath.study.specification import own, values
from pymoo_gridpath.study.specification.kinds import ALGORITHM, of_package, operators_of_package
from pymoo_gridpath.study.specification.own import Kind
from pymoo_gridpath.study.specification.values import Where

#: Names of sets of operators.
SETS = ("default", "paper", *PATH_SAMPLINGS)


def read_algorithm(value: Any, where: Where) -> str:
    """Return the name of an algorithm, or the path of the class of one of your own.

    Raises
    ------
    StudyError
        As `algorithm_name`, or if there is no such class.
    """
    if not isinstance(value, type) and not own.is_path(value):
        return algorithm_name(values.text(value, where), where)
    given = own.read(value, ALGORITHM, where)
    row = find_algorithm(given.cls)
    if isinstance(row, type):
        return next((name for name, planner in of_package(Planner).items() if planner is row), given.name)
    return algorithm_name(row.name, where) if row.cls is None else given.name


def algorithm_name(name: str, where: Where) -> str:
    """Return an algorithm's name as the capability table writes it, or a planner's; of one that others registered, its path.

    Raises
    ------
    StudyError
        If there is no such algorithm, no grid problem suits it, a package that it needs is missing, or no other process can
        import its class.
    """
    row = values.told(where, find_algorithm, name)
    cls = row if isinstance(row, type) else row.cls
    if cls is not None:
        # By its class, since what one process has registered is unknown to others.
        return read_algorithm(cls, where)
    assert isinstance(row, Capability)
    if row.unfit:
        raise StudyError(f"{row.name} {row.unfit}", where)
    if row.needs == "automated_dm":
        raise StudyError(f"{row.name} asks a decision maker during the run, whom a study cannot describe", where)
    values.told(where, class_of, row)
    return row.name


def planner_of(algorithm: object) -> type[Planner] | None:
    """Return the class of a planner of this package by its name; None for all else that a study calls an algorithm."""
    return of_package(Planner).get(algorithm) if isinstance(algorithm, str) else None


def own_budget(planner: type[Planner]) -> tuple[str, ...]:
    """Return which keys of a study's budgets a planner takes."""
    return tuple(key for key in ("max_seconds", "max_labels") if key in planner.parameters())


def operators(given: Any, where: Where) -> dict[str, Any]:
    """Return the operators of an algorithm: ``base``, and each single one that is given with all of its arguments.

    Raises
    ------
    StudyError
        If there is no such set, operator or argument, or an operator is of another kind, or it refuses an argument.
    """
    if isinstance(given, str):
        return {"base": values.choice(given, SETS, where)}
    table = values.table(given, where)
    values.check_keys(table, ("base", *BASES), where, "operators")
    found: dict[str, Any] = {"base": values.choice(table.pop("base", "default"), SETS, (*where, "base"))}
    return found | {slot: _operator(slot, value, (*where, slot)) for slot, value in table.items()}


def make_operator(slot: str, spec: Mapping[str, Any]):
    """Return the operator that a canonical entry describes."""
    if own.is_path(spec["class"]):
        return own.make(spec, _kind_of(slot))
    return operators_of_package()[spec["class"]](**{key: value for key, value in spec.items() if key != "class"})


def _operator(slot: str, given: Any, where: Where) -> dict[str, Any]:
    table = values.table(given, where) if isinstance(given, Mapping) else {"class": given}
    if "class" not in table:
        example = next(name for name, cls in operators_of_package().items() if issubclass(cls, BASES[slot]))
        raise StudyError(f"{slot} has no class, expected such as {{ class = {example!r} }}", where)
    named = table["class"]
    if isinstance(named, str) and not own.is_path(named):
        cls = values.told(where, find_operator, slot, named)
        if own.is_of_package(cls):
            return _operator_of_package(slot, named, cls, table, where)
        # By its class, since what one process has registered is unknown to others.
        given = {**table, "class": cls}
    found = own.read(given, _kind_of(slot), where)
    if not own.is_path(found.name):
        return _operator_of_package(slot, found.name, found.cls, {"class": found.name, **found.arguments}, where)
    _try_operator(found.name, lambda: found.cls(**found.arguments), where)
    return {"class": found.name, **found.arguments}


def _operator_of_package(slot: str, name: str, cls: type, table: dict[str, Any], where: Where) -> dict[str, Any]:
    """Return an operator of this package with all of its arguments."""
    given = {key: value for key, value in table.items() if key != "class"}
    arguments = _own_arguments(cls)
    for key in given:
        if key not in arguments:
            hint = nearest(key, arguments, "it takes") if arguments else "it takes none"
            raise StudyError(f"{name} takes no argument {values.show(key)}; {hint}", (*where, key))
    for key, item in inspect.signature(cls).parameters.items():
        if key in arguments and item.default is item.empty and key not in given:
            raise StudyError(f"{name} has no {key}, expected such as {{ class = {name!r}, {key} = 2 }}", where)
    given = {key: values.like(arguments[key], values.plain_json(value, (*where, key))) for key, value in given.items()}
    spec = {"class": name, **arguments, **given}
    _try_operator(name, lambda: make_operator(slot, spec), where)
    return spec


def _try_operator(name: str, make: Callable[[], Any], where: Where) -> None:
    try:
        make()
    except (ValueError, TypeError, ArithmeticError) as error:
        raise StudyError(f"{name} cannot be made so: {error}", where) from None


def _kind_of(slot: str) -> Kind:
    return Kind(slot, BASES[slot], OPERATORS)


def operator_entry(slot: str, spec: Mapping[str, Any]) -> dict[str, Any]:
    """Return a single operator of a study in canonical form."""
    return own.entry(own.read(spec, _kind_of(slot), (slot,))) if own.is_path(spec["class"]) else dict(spec)


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
def default_operator(name: str) -> dict[str, Any]:
    """Return an operator of this package with the defaults of its arguments, in canonical form."""
    return {"class": name, **_own_arguments(operators_of_package()[name])}
