"""Which names of the package are public."""

from __future__ import annotations

import importlib
import inspect
import itertools
import pkgutil
import re
from collections.abc import Iterator
from pathlib import Path

import pymoo_gridpath

REFERENCE = Path(__file__).resolve().parents[2] / "docs" / "reference.md"

#: Kernels, which trust their callers; the reference does not list them.
INTERNAL = ("pymoo_gridpath.search", "pymoo_gridpath.testing")

# What extensions are made of. It is called with what the package hands over, and does not check that.
BUILDING_BLOCKS = (
    "Box",
    "Cell",
    "CornerCutting",
    "CountedPath",
    "CountedSearch",
    "MoveCosts",
    "Moves",
    "Plan",
    "Prepared",
    "QuadrantPaths",
    "ReferenceFront",
    "Registry",
    "SequencePaths",
    "Sequences",
    "SightPaths",
    "TimedFront",
    "avoiding_costs",
    "axis_of",
    "boxed_field_of",
    "check_box",
    "check_grid",
    "check_paths",
    "check_size",
    "field_of",
    "levels_of",
    "make_grid",
    "moves_of",
    "prepared",
    "reference_planner",
    "settled",
    "visiting_costs",
)


def documented() -> Iterator[tuple[str, str]]:
    """Yield the module and the name of everything that the reference lists, and of everything in an ``__all__``."""
    module = ""
    for line in REFERENCE.read_text().splitlines():
        if match := re.match(r"\.\. currentmodule:: (\S+)", line):
            module = match[1]
        elif match := re.fullmatch(r"   ([A-Za-z_]\w*)", line):
            yield module, match[1]
    for found in itertools.chain([pymoo_gridpath.__name__], (info.name for info in _modules())):
        for name in getattr(importlib.import_module(found), "__all__", ()):
            yield found, name


def _modules():
    for info in pkgutil.walk_packages(pymoo_gridpath.__path__, "pymoo_gridpath."):
        if not info.name.endswith("__main__") and info.name not in INTERNAL:
            yield info


def public_names() -> set[str]:
    """Return all public functions, classes that can be made, and methods of these, as the keys of `calls.calls`."""
    names: set[str] = set()
    for module, name in documented():
        if module.startswith(INTERNAL) or name in BUILDING_BLOCKS:
            continue
        thing = getattr(importlib.import_module(module), name)
        if not inspect.isclass(thing):
            names |= {name} if callable(thing) else set()
        elif not (inspect.isabstract(thing) or issubclass(thing, BaseException)):
            names |= {name, *(f"{name}.{method}" for method in _methods(thing))}
    return names


def _methods(cls: type) -> Iterator[str]:
    """Yield the public methods of a class that are ours; those that replace another package's are called by it alone."""
    for name in dir(cls):
        if name.startswith("_") or inspect.isclass(getattr(cls, name)):
            continue
        homes = [base for base in cls.__mro__ if name in vars(base)]
        ours = all(base.__module__.startswith("pymoo_gridpath") for base in homes)
        if ours and callable(getattr(cls, name)):
            yield name
