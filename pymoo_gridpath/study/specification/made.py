"""Algorithms that are made already, as a table of their class and what they were made with; objects within them likewise."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from typing import Any

import numpy as np

from pymoo_gridpath.errors import StudyError, nearest
from pymoo_gridpath.planners.signature import parameters_of
from pymoo_gridpath.registry import OPERATORS
from pymoo_gridpath.study.specification import own, values
from pymoo_gridpath.study.specification.kinds import ALGORITHM
from pymoo_gridpath.study.specification.own import Kind
from pymoo_gridpath.study.specification.values import Where

# What an algorithm holds may be of any class.
PART = Kind("part of the algorithm", object, OPERATORS)

# What the study does itself.
_ELSEWHERE = ("seed", "termination", "callback", "display", "archive", "verbose", "save_history", "return_least_infeasible")
# pymoo puts it together of other arguments.
_COMPOSED = ("mating",)


def table_of(algorithm: Any, where: Where) -> dict[str, Any]:
    """Return the table of ``class`` and arguments that an algorithm was made with.

    Raises
    ------
    StudyError
        If it has begun a run, sets what the study sets, or cannot be made again of what a file can hold.
    """
    name = type(algorithm).__name__
    if getattr(algorithm, "problem", None) is not None:
        raise StudyError(f"{name} has begun a run, expected an algorithm that has not, or its class", where)
    try:
        table = _table(algorithm, ALGORITHM, where, 0)
        same = own.alike(build(entry_of(table), ALGORITHM), algorithm)
    except StudyError:
        raise
    except Exception:
        table, same = {}, False
    if not same:
        raise StudyError(
            f"the algorithm {name} cannot be written down as a class and what it was made with; expected its class, and the "
            "arguments as pop_size, operators and parameters",
            where,
        )
    return checked(table, where)


def checked(given: Any, where: Where, kind: Kind = ALGORITHM) -> dict[str, Any]:
    """Return a table of ``class`` and arguments in one form; a table within it is another object, ``array`` one of numpy."""
    table = values.table(given, where)
    if not own.is_path(table.get("class")) and kind is ALGORITHM:
        raise StudyError(
            f"class is {values.show(table.get('class'))}, expected 'package.module:Class'; beside an algorithm "
            "that is given by its name stand pop_size, operators and parameters",
            where,
        )
    found = own.read(table.pop("class"), kind, (*where, "class"))
    takes = parameters_of(found.cls)
    form: dict[str, Any] = {"class": found.name}
    for key, value in table.items():
        place = (*where, key)
        if key not in takes:
            raise StudyError(f"{found.name} takes no argument {values.show(key)}; {nearest(key, takes, 'it takes')}", place)
        if kind is ALGORITHM and key in _ELSEWHERE:
            raise StudyError(f"{key} is set in {found.name}, expected it from the study alone", place)
        if isinstance(value, Mapping) and value.keys() == {"array"}:
            form[key] = {"array": values.plain_json(value["array"], place)}
        elif isinstance(value, Mapping) and "class" in value:
            form[key] = checked(value, place, PART)
        else:
            form[key] = values.like(takes[key], values.plain_json(value, place))
    return form


def entry_of(table: Mapping[str, Any], kind: Kind = ALGORITHM, **facts: Any) -> dict[str, Any]:
    """Return a table in canonical form, with the code of each class that is not known by its name."""
    arguments = {key: entry_of(value, PART) if _is_object(value) else value for key, value in table.items() if key != "class"}
    name = table["class"]
    code = {"code": own.code_of(own.read(name, kind, ("class",)).cls)} if own.is_path(name) else {}
    return {"class": name, "arguments": arguments, **code, **facts}


def build(content: Mapping[str, Any], kind: Kind = ALGORITHM) -> Any:
    """Return a new object of a table in canonical form, in whatever process."""
    return own.class_of(content, kind)(**{key: _built(value) for key, value in content["arguments"].items()})


def _built(value: Any) -> Any:
    if _is_object(value):
        return build(value, PART)
    return np.array(value["array"], dtype=float) if isinstance(value, Mapping) and "array" in value else value


def _is_object(value: Any) -> bool:
    return isinstance(value, Mapping) and "class" in value


def _table(thing: Any, kind: Kind, where: Where, depth: int) -> dict[str, Any]:
    """Return the table of an object, with as few arguments as make another like it."""
    if depth > 6:
        raise ValueError("objects within objects without an end")
    cls = type(thing)
    name = own.read(cls, kind, where).name
    held = {key: value for key in parameters_of(cls) if (value := _held(thing, key)) is not _held}
    signature = inspect.signature(cls).parameters
    given = {key: held[key] for key in held if key in signature and signature[key].default is inspect.Parameter.empty}
    try:
        plain = cls(**given)
    except Exception:
        # It cannot be made without what its signature calls optional.
        given |= {key: held[key] for key in held if key in signature and held[key] is not signature[key].default}
    else:
        for key in sorted(held.keys() - given.keys(), key=lambda key: (key in _COMPOSED, key)):
            if not (key in _COMPOSED and _makes(cls, given, thing)) and not own.alike(held[key], _held(plain, key)):
                given[key] = held[key]
    for key in list(given):
        fewer = {other: value for other, value in given.items() if other != key}
        given = fewer if _makes(cls, fewer, thing) else given
    takes = parameters_of(cls)
    return {"class": name, **{key: values.like(takes[key], _form(value, where, depth)) for key, value in given.items()}}


def _makes(cls: type, arguments: Mapping[str, Any], thing: Any) -> bool:
    """Whether arguments make an object like another."""
    try:
        return own.alike(cls(**arguments), thing)
    except Exception:
        return False


def _form(value: Any, where: Where, depth: int) -> Any:
    if isinstance(value, np.ndarray) and value.dtype == float:
        return {"array": value.tolist()}
    if value is None or isinstance(value, bool | int | float | str | list | np.generic):
        return values.plain_json(value, where)
    if isinstance(value, type) or inspect.isroutine(value) or type(value).__module__ == "builtins":
        raise ValueError("no object with a constructor")
    return _table(value, PART, where, depth + 1)


def _held(thing: Any, key: str) -> Any:
    """Return what an object, or one that it holds, has by the name of an argument; this function itself if nothing does."""
    for owner in (thing, *vars(thing).values()):
        if not isinstance(owner, type) and key in getattr(owner, "__dict__", ()):
            return own.held(owner, key)
    return _held
