"""What the dataclasses of a study share: how they are made of tables, checked, and written as tables."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from pymoo_gridpath.errors import StudyError
from pymoo_gridpath.study.specification import own, values
from pymoo_gridpath.study.specification.kinds import REPRESENTATION
from pymoo_gridpath.study.specification.values import Where

AXES = ("auto", "x", "y")


def make_spec(cls: Any, value: Any, where: Where) -> Any:
    """Return a dataclass of a study made of a table, with the place in the study in its errors."""
    if isinstance(value, cls):
        return value
    known = [item.name for item in dataclasses.fields(cls)]
    given = values.table(value, where)
    values.check_keys(given, [name for name in known if name != "grid"], where, cls.owner)
    required = [item.name for item in dataclasses.fields(cls) if item.default is dataclasses.MISSING]
    for key in required:
        if key not in given:
            raise StudyError(f"{cls.owner} has no {key}, expected {', '.join(required)}", where)
    try:
        return cls(**given)
    except StudyError as error:
        raise StudyError(error.message, (*where, *error.where)) from None


def set_fields(spec: Any, **changes) -> None:
    """Set fields of a frozen dataclass that is being made."""
    for key, value in changes.items():
        object.__setattr__(spec, key, value)


def set_given(spec: Any, *keys: str, check) -> None:
    """Check the fields that are not None."""
    for key in keys:
        if getattr(spec, key) is not None:
            set_fields(spec, **{key: check(getattr(spec, key), (key,))})


def check_problem_settings(spec: Any) -> None:
    set_given(spec, "representation", check=lambda value, where: own.form(own.read(value, REPRESENTATION, where)))
    set_given(spec, "penalty", "potential_limit", check=lambda value, where: values.real(value, where, open_below=True))
    set_given(spec, "axis", check=lambda value, where: values.choice(value, AXES, where))


def to_table(spec: Any) -> dict[str, Any]:
    """Return a dataclass as the table of a file, without what is at its default or no file can hold."""
    if getattr(spec, "grid", None) is not None:
        raise StudyError("a grid made in Python has no place in a study file; save it as a map and name that")
    found = {}
    for item in dataclasses.fields(spec):
        value = getattr(spec, item.name)
        if item.name not in ("folder", "source") and value != item.default and value is not None:
            found[item.name] = _plain(value)
    return found


def _plain(value: Any) -> Any:
    if dataclasses.is_dataclass(value):
        return to_table(value)
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items() if item is not None}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return value
