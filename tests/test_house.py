"""The shape of the house: which room may import which, no circles, no leaf folder that outgrows the others."""

from __future__ import annotations

import ast
from collections import Counter
from pathlib import Path

import pytest

import pymoo_gridpath

ROOT = Path(pymoo_gridpath.__file__).parent

# From the ground up: a room imports from itself and from those before it. What stands in one line is one floor.
FLOORS = (
    (
        *(
            "errors",
            "checks",
            "compiled",
            "deprecation",
            "files",
            "interrupt",
            "lazy",
            "memory",
            "neighbourhood",
            "parallel",
            "pictures",
            "progress",
            "registry",
        ),
        "versions",
    ),
    ("grid",),
    ("fields",),
    ("maps",),
    ("paths",),
    ("search",),
    ("objectives",),
    ("representations",),
    ("exact",),
    ("problems",),
    ("operators",),
    ("quality",),
    ("planners",),
    ("algorithms",),
    ("decision", "convergence"),
    ("plotting", "explorer"),
    ("study",),
    ("testing",),
    ("cli",),
    ("__init__",),
)
RANK = {room: k for k, floor in enumerate(FLOORS) for room in floor}
# The rooms of a study, likewise.
STUDY = ("specification", "planning", "running", "report", "__init__")


def _modules() -> dict[str, Path]:
    """Return the files of the package by their dotted names below it; a package's own file goes by the name of the package."""
    found = {}
    for path in ROOT.rglob("*.py"):
        parts = path.relative_to(ROOT).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


MODULES = _modules()


def _imports(name: str) -> set[str]:
    """Return the modules of the package that a module imports anywhere in it, late imports included."""
    found = set()
    for node in ast.walk(ast.parse(MODULES[name].read_text())):
        if isinstance(node, ast.Import):
            targets = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{name} imports relative to itself"
            targets = [f"{node.module}.{alias.name}" for alias in node.names]
        else:
            continue
        for target in targets:
            parts = target.split(".")
            if parts[0] == ROOT.name:
                inner = ".".join(parts[1:])
                found.add(inner if inner in MODULES else ".".join(parts[1:-1]))
    return found - {name}


IMPORTS = {name: _imports(name) for name in MODULES}


def test_every_room_has_its_floor():
    assert {name.split(".")[0] or "__init__" for name in MODULES} <= set(RANK)


@pytest.mark.parametrize("name", sorted(MODULES))
def test_no_import_from_a_higher_room(name):
    room = name.split(".")[0] or "__init__"
    higher = {other for other in IMPORTS[name] if RANK[other.split(".")[0] or "__init__"] > RANK[room]}
    assert not higher
    if room == "study":
        place = STUDY.index(name.split(".")[1] if "." in name else "__init__")
        inside = [other.split(".")[1] for other in IMPORTS[name] if other.startswith("study.")]
        assert not [other for other in inside if STUDY.index(other) > place]


def test_no_two_files_import_each_other():
    """Tarjan would say it faster; the house is small."""
    reach = {name: set(IMPORTS[name]) for name in MODULES}
    for middle in MODULES:
        for name in MODULES:
            if middle in reach[name]:
                reach[name] |= reach[middle]
    # What a package's own file gathers, its files do not take from it.
    assert not sorted(name for name in MODULES if name in reach[name])


def test_no_leaf_folder_over_a_sixth_of_the_house():
    lines = Counter()
    for path in MODULES.values():
        lines[path.parent] += path.read_text().count("\n")
    leaves = {
        folder: n for folder, n in lines.items() if not any(other != folder and folder in other.parents for other in lines)
    }
    assert max(leaves.values()) <= sum(lines.values()) / 6, max(leaves, key=lambda folder: leaves[folder])


@pytest.mark.parametrize("name", sorted(name for name, path in MODULES.items() if path.name == "__init__.py"))
def test_the_file_of_a_package_gathers_names_and_defines_none(name):
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Lambda)
    assert [node.lineno for node in ast.walk(ast.parse(MODULES[name].read_text())) if isinstance(node, kinds)] == []
