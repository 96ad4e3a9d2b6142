"""What a study names that is not of this package: classes by import path with arguments, so that every process can make them.

A class of one's own is written ``"package.module:Class"``, or as a table of ``class`` and its arguments; in Python the class or
an object serves, too. It is imported where a study is specified and where a run takes place, never where results are read.
"""

from __future__ import annotations

import functools
import hashlib
import importlib
import inspect
import re
import sys
from collections.abc import Mapping
from importlib.metadata import distributions
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from pymoo.core.variable import Variable

from pymoo_gridpath.errors import GridPathError, StudyError, nearest, visible
from pymoo_gridpath.planners.signature import parameters_of
from pymoo_gridpath.representations import Representation
from pymoo_gridpath.study.specification import values
from pymoo_gridpath.study.specification.values import Where

PATH = re.compile(r"[^\W\d]\w*(?:\.[^\W\d]\w*)*:[^\W\d]\w*(?:\.[^\W\d]\w*)*")

# Arguments that pymoo's operators inherit and that no file can hold.
_INHERITED = ("name", "vtype", "repair", "func", "cmp_func")
_ELSEWHERE = (*_INHERITED, "grid", "start", "goal")


class Kind(NamedTuple):
    """A kind of things that a study names: what messages call one, its base class, and classes by their names."""

    word: str
    base: type
    known: Any


class Given(NamedTuple):
    """A thing as it was given: its class, what the study calls that (a name, or an import path), and its arguments."""

    cls: type
    name: str
    arguments: dict[str, Any]


def is_path(name: object) -> bool:
    """Whether a name is the import path of a class."""
    return isinstance(name, str) and ":" in name


def is_of_package(cls: type) -> bool:
    """Whether a class is of this package."""
    return cls.__module__.startswith("pymoo_gridpath.")


def read(value: Any, kind: Kind, where: Where) -> Given:
    """Return what a study gives as a name, an import path, a table of ``class`` and arguments, a class, or an object.

    Raises
    ------
    StudyError
        If there is no such class, it cannot be imported, or is none of the kind; if it takes no such argument; or if an object
        cannot be written down as its class and arguments.
    """
    if isinstance(value, Mapping):
        table = values.table(value, where)
        if "class" not in table:
            raise StudyError(f"{kind.word} has no class, expected such as {{ class = 'package.module:Class' }}", where)
        cls, name = _named(table.pop("class"), kind, (*where, "class"))
        return Given(cls, name, _arguments(cls, name, table, where))
    if isinstance(value, kind.base) and not isinstance(value, type | str):
        cls, name = _named(type(value), kind, where)
        return Given(cls, name, _arguments_of(value, kind, where))
    return Given(*_named(value, kind, where), {})


def form(given: Given) -> Any:
    """Return a thing as a study holds it, and as a file can: its name or path, or a table with its arguments."""
    return {"class": given.name, **given.arguments} if given.arguments else given.name


def entry(given: Given, **facts: Any) -> Any:
    """Return a thing in canonical form: a name of this package, or a dictionary that says which code it was.

    Parameters
    ----------
    given : Given
    **facts
        What has to be known of it where its class is not imported.
    """
    if not is_path(given.name) and not given.arguments:
        return given.name
    # What is of this package is told apart by its version, which stands beside every run.
    code = {"code": code_of(given.cls)} if is_path(given.name) else {}
    return {"class": given.name, "arguments": given.arguments, **code, **facts}


def shown(content: Any) -> str:
    """Return what a report calls something in canonical form."""
    if isinstance(content, str):
        return content
    settings = ", ".join(f"{key}={_shown(value)}" for key, value in content["arguments"].items())
    name = content["class"].rpartition(":")[2]
    return f"{name}({settings})" if settings else name


def _shown(value: Any) -> str:
    if isinstance(value, Mapping) and "class" in value:
        return shown(value)
    return "..." if isinstance(value, Mapping) and "array" in value else str(value)


def check_entry(content: Any, word: str, where: Where, **facts: type) -> None:
    """Refuse what is no thing in canonical form, as something that was stored may hold; nothing is imported.

    Parameters
    ----------
    content : object
    word : str
        What messages call such a thing.
    where : tuple
    **facts : type
        What has to be known of it, and as what.
    """
    table = values.table(content, where)
    name = table.get("class")
    if not isinstance(name, str) or (is_path(name) and not PATH.fullmatch(name)):
        raise StudyError(f"the {word} has the class {values.show(name)}, expected 'package.module:Class'", (*where, "class"))
    kinds = {"class": str, "arguments": dict, **({"code": str} if is_path(name) else {}), **facts}
    values.check_keys(table, kinds, where, f"the {word}")
    for key, kind in kinds.items():
        if not isinstance(table.get(key), kind):
            expected = {str: "a text", dict: "a table", bool: "true or false", list: "a list"}[kind]
            raise StudyError(f"{key} is {values.show(table.get(key))}, expected {expected}", (*where, key))


def class_of(content: Any, kind: Kind) -> type:
    """Return the class of something in canonical form, in whatever process.

    Raises
    ------
    GridPathError
        If it cannot be imported here, or its code is not what the study was planned with.
    """
    if isinstance(content, str):
        return kind.known[content]
    name = content["class"]
    if not is_path(name):
        return kind.known[name]
    cls = _imported(name, kind)
    here = code_of(cls)
    if here != content["code"]:
        raise GridPathError(
            f"the {kind.word} {name} is of {here} in this process, expected {content['code']}, with which the study was planned"
        )
    return cls


def make(content: Any, kind: Kind, *positional: Any, **options: Any) -> Any:
    """Return a new object of something in canonical form.

    Raises
    ------
    GridPathError
        If its class cannot be had here, or a file that it is made of is not what the study was planned with.
    """
    arguments, files = ({}, {}) if isinstance(content, str) else (content["arguments"], content.get("files", {}))
    for key, digest in files.items():
        name = arguments.get(key)
        if not isinstance(name, str) or digest_of(name) != digest:
            raise GridPathError(f"{visible(name)} is not what the study was planned with, expected the same {kind.word} {key}")
    return class_of(content, kind)(*positional, **options, **arguments)


def digest_of(file: str) -> str:
    """Return the SHA-256 of a file, in hexadecimal.

    Raises
    ------
    GridPathError
        If it cannot be read.
    """
    try:
        return hashlib.sha256(Path(file).read_bytes()).hexdigest()
    except OSError as error:
        raise GridPathError(f"{visible(file)} cannot be read: {error.strerror or error}") from None


@functools.cache
def code_of(cls: type) -> str:
    """Return what code a class is: its distribution with version, or of what is no part of one its file's SHA-256.

    Raises
    ------
    GridPathError
        If its module has no file.
    """
    file = getattr(sys.modules.get(cls.__module__), "__file__", None)
    if file is None or not Path(file).is_file():
        raise GridPathError(f"the module {cls.__module__} has no file, expected code that other processes can import")
    path = Path(file).resolve()
    # Where its package lies, a distribution that it is of says so; to ask all that are installed takes a tenth of a second.
    names = cls.__module__.split(".")
    place = path.parents[len(names) - (path.stem != "__init__")]
    for found in distributions(path=[str(place)]):
        packages = found.read_text("top_level.txt")
        if packages is not None and names[0] not in packages.split():
            continue
        # What is installed for development changes while its version stays: its files are elsewhere, or lie there uninstalled.
        if all(found.read_text(record) is None for record in ("RECORD", "installed-files.txt")):
            continue
        if any(part.name == path.name and Path(str(found.locate_file(part))).resolve() == path for part in found.files or ()):
            return f"{found.name} {found.version}"
    return f"sha256 {hashlib.sha256(path.read_bytes()).hexdigest()}"


# -- parts --------------------------------------------------------------------------------------------------------------


def _named(value: Any, kind: Kind, where: Where) -> tuple[type, str]:
    """Return a class that is given by its name, its path or itself, and what the study calls it."""
    if isinstance(value, type):
        cls = value
    elif isinstance(value, str) and is_path(value):
        try:
            cls = _imported(value, kind)
        except GridPathError as error:
            raise StudyError(str(error), where) from None
    else:
        if not isinstance(value, str):
            raise StudyError(
                f"{values.key_of(where)} is {values.show(value)}, expected the name of one, 'package.module:Class', a class or "
                f"an object of {kind.base.__name__}",
                where,
            )
        try:
            # A dictionary's own KeyError says nothing of what there is.
            cls = kind.known[value] if value in kind.known else kind.known[values.choice(value, kind.known, where)]
        except GridPathError as error:
            raise error if isinstance(error, StudyError) else StudyError(str(error), where) from None
        if is_of_package(cls):
            return cls, str(value)
    _check_class(cls, kind, where)
    if is_of_package(cls):
        for name in kind.known:
            if name in (cls.__name__, getattr(cls, "name", None)) and kind.known[name] is cls:
                return cls, str(name)
    path = f"{cls.__module__}:{cls.__qualname__}"
    if cls.__module__ == "__main__" or not PATH.fullmatch(path):
        raise StudyError(
            f"{kind.word} {cls.__qualname__} is of the script or function that made it, which no other process can import; "
            "expected a class at the top of a module",
            where,
        )
    try:
        if _imported(path, kind) is not cls:
            raise GridPathError(f"{path} is another class than the one that was given, expected one that its path leads to")
        code_of(cls)
    except GridPathError as error:
        raise StudyError(str(error), where) from None
    return cls, path


def _imported(path: str, kind: Kind) -> type:
    """Return the class of an import path."""
    if not PATH.fullmatch(path):
        raise GridPathError(f"the {kind.word} is {values.show(path)}, expected such as 'package.module:Class'")
    module, _, name = path.partition(":")
    if module == "__main__":
        raise GridPathError(f"the {kind.word} {path} is of a script, which no other process can import; expected a module")
    try:
        cls: Any = functools.reduce(getattr, name.split("."), importlib.import_module(module))
    except Exception as error:
        text = f"{type(error).__name__}: {' '.join(str(error).split())}"
        raise GridPathError(
            f"the {kind.word} {path} cannot be imported in this process ({text}); install its package where the study is "
            "planned and where its runs take place"
        ) from error
    if not (isinstance(cls, type) and issubclass(cls, kind.base)):
        raise GridPathError(f"{path} is {values.show(cls)}, expected a class derived from {kind.base.__name__}")
    return cls


def _check_class(cls: type, kind: Kind, where: Where) -> None:
    if not issubclass(cls, kind.base):
        raise StudyError(
            f"{values.key_of(where)} is the class {cls.__name__}, expected one derived from {kind.base.__name__}", where
        )


def _arguments(cls: type, name: str, given: Mapping[str, Any], where: Where) -> dict[str, Any]:
    """Return arguments that a class takes, in one form, without those at the defaults of a class of this package."""
    takes = parameters_of(cls)
    found = {}
    for key, value in given.items():
        if key not in takes:
            hint = nearest(key, takes, "it takes") if takes else "it takes none"
            raise StudyError(f"{name} takes no argument {values.show(key)}; {hint}", (*where, key))
        value = values.like(takes[key], values.plain_json(value, (*where, key)))
        if is_path(name) or value != takes[key]:
            found[key] = value
    return found


def _arguments_of(thing: Any, kind: Kind, where: Where) -> dict[str, Any]:
    """Return the arguments that make an object like the one that is given."""
    cls = type(thing)
    elsewhere = _ELSEWHERE if isinstance(thing, Representation) else _INHERITED
    kept = {key: held(thing, key) for key in parameters_of(cls) if key not in elsewhere and hasattr(thing, key)}
    needed = [item.name for item in inspect.signature(cls).parameters.values() if item.default is item.empty][
        len(_leading(thing)) :
    ]
    try:
        found = {key: values.plain_json(kept[key], where) for key in needed if key in kept}
        # What bases would set themselves is no argument to give.
        plain = cls(*_leading(thing), **found)
        for key, value in kept.items():
            if key not in found and value != held(plain, key):
                found[key] = values.like(parameters_of(cls)[key], values.plain_json(value, where))
        same = alike(cls(*_leading(thing), **found), thing)
    except Exception:
        same = False
    if not same:
        raise StudyError(
            f"the {kind.word} {cls.__name__} cannot be written down as a class and its arguments; expected an object that "
            "keeps each argument, a number, text or list, as the attribute of that name, and nothing else",
            where,
        )
    return found


def held(thing: Any, key: str) -> Any:
    """Return what an object holds of an argument; pymoo's operators hold variables, in order to tune them."""
    value = getattr(thing, key)
    return value.get() if isinstance(value, Variable) else value


def alike(one: Any, other: Any, depth: int = 0) -> bool:
    """Whether two objects hold the same values."""
    if one is other:
        return True
    if {type(one), type(other)} == {int, float}:
        # As they are written down, 3 and 3.0 are the same.
        return one == other
    if type(one) is not type(other) or depth > 8:
        return False
    if isinstance(one, np.ndarray):
        return one.dtype == other.dtype and np.array_equal(one, other)
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(alike(one[key], other[key], depth + 1) for key in one)
    if isinstance(one, list | tuple):
        return len(one) == len(other) and all(alike(a, b, depth + 1) for a, b in zip(one, other, strict=True))
    if hasattr(one, "__dict__") and not isinstance(one, type) and not inspect.isroutine(one):
        return alike(_kept(one), _kept(other), depth + 1)
    return bool(one == other)


def _kept(thing: Any) -> dict[str, Any]:
    """Return the attributes of an object but those that follow from others."""
    cls = type(thing)
    return {
        key: value for key, value in vars(thing).items() if not isinstance(getattr(cls, key, None), functools.cached_property)
    }


def _leading(thing: Any) -> tuple[Any, ...]:
    """Return what an object is made for, which the problems of a study say anew."""
    return (thing.grid, thing.start, thing.goal) if isinstance(thing, Representation) else ()
