"""What is public: the names of the package itself, and that two pages say of everything else what it is."""

from __future__ import annotations

import ast
import importlib
import pkgutil
import re
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

import pymoo_gridpath as gp
from pymoo_gridpath.deprecation import deprecated
from pymoo_gridpath.errors import GridPathError

DOCS = Path(__file__).resolve().parents[1] / "docs"
SOURCE = Path(gp.__file__)


def test_the_names_of_the_package_are_said_alike_three_times():
    """To Python, to those who read the file without running it, and to `from pymoo_gridpath import *`."""
    tree = ast.parse(SOURCE.read_text(encoding="utf-8"))
    (block,) = [node for node in tree.body if isinstance(node, ast.If)]
    typed = {
        alias.name: str(node.module).removeprefix("pymoo_gridpath.")
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    assert {**typed, "__version__": "versions"} == gp._HOMES
    assert gp.__all__ == sorted(gp._HOMES) == dir(gp)


@pytest.mark.parametrize("name", gp.__all__)
def test_each_name_is_there(name):
    assert getattr(gp, name) == getattr(importlib.import_module(f"pymoo_gridpath.{gp._HOMES[name]}"), name)
    with pytest.raises(AttributeError, match=f"'pymoo_gridpath' has no attribute '{name}_'"):
        getattr(gp, f"{name}_")


def test_the_package_alone_costs_nothing():
    code = (
        "import sys, pymoo_gridpath\n"
        "loaded = {name.partition('.')[0] for name in sys.modules} & {'numpy', 'scipy', 'numba', 'pymoo', 'matplotlib'}\n"
        "ours = sorted(name for name in sys.modules if name.startswith('pymoo_gridpath'))\n"
        "sys.exit(str(loaded) if loaded or ours != ['pymoo_gridpath', 'pymoo_gridpath.lazy'] else 0)\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


# -- pages ------------------------------------------------------------------------------------------------------------


def _reference() -> dict[str, set[str]]:
    """Return the names in the reference by the module that they are said to be in."""
    found: dict[str, set[str]] = {}
    module = ""
    for line in (DOCS / "reference.md").read_text(encoding="utf-8").splitlines():
        if line.startswith(".. currentmodule:: "):
            module = line.split()[-1]
        elif match := re.fullmatch(r"   (\w+)|\.\. py:data:: (\w+)", line):
            found.setdefault(module, set()).add(match[1] or match[2])
    return found


REFERENCE = _reference()
NAMES = set().union(*REFERENCE.values())
_ROWS = re.findall(
    r"^\| `(pymoo_gridpath[\w.]*)` \| (.*) \|$", (DOCS / "internals.md").read_text(encoding="utf-8"), re.MULTILINE
)
# Of these modules some names are internal, or all.
INTERNAL_NAMES = {module: set(re.findall(r"`(\w+)`", text)) for module, text in _ROWS if text.startswith("`")}
INTERNAL = {module for module, _ in _ROWS} - set(INTERNAL_NAMES)
ROOMS = sorted(module.name for module in pkgutil.iter_modules(gp.__path__, "pymoo_gridpath.") if module.name[15] != "_")


def _own_names(module) -> set[str]:
    """Return the names that a room lists, or those of what a module defines."""
    if hasattr(module, "__path__"):
        return set(module.__all__)
    return {
        name
        for name, value in vars(module).items()
        if not name.startswith("_") and getattr(value, "__module__", None) == module.__name__ and hasattr(value, "__qualname__")
    }


def test_every_name_of_the_package_stands_in_the_reference():
    assert set(gp.__all__) - {"__version__"} - NAMES == set()


@pytest.mark.parametrize("module", sorted(REFERENCE))
def test_the_reference_names_what_there_is(module):
    found = importlib.import_module(module)
    assert [name for name in sorted(REFERENCE[module]) if not hasattr(found, name)] == []


@pytest.mark.parametrize("room", [room for room in ROOMS if room not in INTERNAL])
def test_what_is_not_in_the_reference_is_private_or_internal(room):
    """A name of a room or module stands in one of the two pages, or carries an underscore."""
    own = _own_names(importlib.import_module(room))
    internal = INTERNAL_NAMES.get(room, set())
    assert sorted(own - NAMES - internal) == [], "neither in reference.md nor in internals.md"
    assert sorted(internal - own) == [], "in internals.md, and no longer there"
    assert sorted(internal & REFERENCE.get(room, set())) == [], "in both pages"


def test_internal_rooms_exist_and_hold_nothing_public():
    assert set(ROOMS) >= INTERNAL
    assert [module for module in REFERENCE if ".".join(module.split(".")[:2]) in INTERNAL] == []


# -- how names go -----------------------------------------------------------------------------------------------------


def test_a_deprecated_function_warns_at_the_line_of_its_caller_and_works():
    @deprecated("0.2.0", "0.4.0", instead="load_map")
    def read(path, *, threshold=0.5):
        """Read a map."""
        return path, threshold

    with pytest.warns(DeprecationWarning) as said:
        assert read("m", threshold=1) == ("m", 1)
    assert str(said[0].message) == "read is deprecated since 0.2.0 and will be removed in 0.4.0; use load_map instead"
    assert said[0].filename == __file__
    assert read.__name__ == "read" and read.__doc__.startswith("Read a map.\n\n.. deprecated:: 0.2.0\n   Use load_map")


def test_a_deprecated_class_stays_a_class():
    @deprecated("0.2.0", "1.0.0", instead="Better")
    class Old:
        """What was."""

        def __init__(self, value):
            self.value = value

    with pytest.warns(DeprecationWarning, match="Old is deprecated since 0.2.0 and will be removed in 1.0.0"):
        old = Old(3)
    assert isinstance(old, Old) and old.value == 3

    class Derived(Old):
        pass

    with pytest.warns(DeprecationWarning), warnings.catch_warnings(record=False):
        assert Derived(4).value == 4


@pytest.mark.parametrize(
    ("since", "remove_in"), [("0.2.0", "0.3.0"), ("0.2.0", "0.2.5"), ("1.4.0", "0.9.0"), ("1.1.3", "1.2.9")]
)
def test_a_name_does_not_go_too_early(since, remove_in):
    with pytest.raises(GridPathError, match="expected 2 minor releases later"):
        deprecated(since, remove_in, instead="x")


@pytest.mark.parametrize("release", ["0.2", "next", "0.2.0rc1", ""])
def test_a_release_has_three_numbers(release):
    with pytest.raises(GridPathError, match=r"is not a release, expected one such as '0\.2\.0'"):
        deprecated(release, "1.0.0", instead="x")
