"""Registries: names of the package, of callers, and of installed packages."""

from __future__ import annotations

import subprocess
import sys
from importlib.metadata import EntryPoint

import pytest

from pymoo_gridpath import registry
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.registry import Registry, register


class Shape:
    name: str


class Circle(Shape):
    name = "circle"


class Sphere(Circle):
    name = "sphere"


class Nameless(Shape):
    pass


class Solid:
    pass


class Cube(Solid, Shape):
    pass


@pytest.fixture
def shapes(monkeypatch):
    monkeypatch.setattr(registry, "_REGISTRIES", [])
    points = [
        EntryPoint("disc", f"{__name__}:Nameless", "shapes"),
        EntryPoint("gone", "no_such_module:Thing", "shapes"),
        EntryPoint("wrong", "builtins:len", "shapes"),
    ]
    monkeypatch.setattr(registry, "entry_points", lambda group: [point for point in points if point.group == group])
    monkeypatch.setattr(EntryPoint, "load", lambda self: _load(self))
    return Registry("shape", "shapes", Shape, key=str.lower)


def _load(point):
    if point.name == "gone":
        raise ModuleNotFoundError("No module named 'no_such_module'")
    return len if point.name == "wrong" else Nameless


def test_names_of_classes_and_of_entry_points(shapes):
    assert shapes.register(Circle) is Circle
    assert register(Sphere) is Sphere
    assert list(shapes) == ["circle", "sphere", "disc", "gone", "wrong"] and len(shapes) == 5
    assert shapes["CIRCLE"] is Circle and "Sphere" in shapes and "disc" in shapes and "cube" not in shapes
    assert shapes["disc"] is Nameless
    assert list(shapes)[:3] == ["circle", "sphere", "disc"]


@pytest.mark.parametrize("name", ["crcle", "", None, 3, ["circle"]])
def test_unknown_names_are_refused_with_the_nearest(shapes, name):
    shapes.register(Circle)
    with pytest.raises(GridPathError, match=r"there is no shape .*; (did you mean 'circle'|expected one of circle)"):
        shapes[name]
    assert name not in shapes


def test_a_name_is_taken_once(shapes):
    shapes.register(Circle)
    shapes.register(Circle)  # again: the same
    with pytest.raises(GridPathError, match=r"the shape 'circle' is .*Circle already; give .*Sphere another name"):
        shapes.register(Sphere, "circle")


@pytest.mark.parametrize("thing", [3, int, "circle", Circle()])
def test_what_is_no_class_of_the_kind_is_refused(shapes, thing):
    Registry("way", "ways", "no_such_module.Path")
    with pytest.raises(GridPathError, match=r"cannot be registered as shape, expected a class derived from Shape$"):
        shapes.register(thing)
    with pytest.raises(GridPathError, match=r"cannot be registered, expected a class derived from one of Shape, Path$"):
        register(thing)


def test_a_class_without_a_name_goes_by_its_own(shapes):
    register(Nameless)
    assert shapes["nameless"] is Nameless
    with pytest.raises(GridPathError, match="expected letters"):
        shapes.register(Circle, "two words")


def test_the_closest_base_decides(shapes):
    circles = Registry("circle", "circles", Circle)
    register(Sphere)
    assert "sphere" in circles and "sphere" not in shapes


def test_entry_points_that_cannot_be_loaded_say_so_when_asked_for(shapes):
    with pytest.raises(
        GridPathError, match=r"the shape 'gone' of the installed package cannot be imported from no_such_module"
    ):
        shapes["gone"]
    with pytest.raises(GridPathError, match="expected a class derived from Shape"):
        shapes["wrong"]
    with pytest.warns(UserWarning, match=r"gone|cannot be registered") as caught:
        assert list(shapes.values()) == [Nameless]
    assert sum(issubclass(one.category, UserWarning) for one in caught) == 2
    with pytest.warns(UserWarning):
        assert list(shapes.items()) == [("disc", Nameless)]


def test_what_is_registered_needs_no_entry_point(shapes):
    assert shapes.registered() == {}
    shapes.register(Circle)
    assert shapes.registered() == {"circle": Circle}


def test_bases_may_be_several_and_import_paths(shapes):
    """Of a class whose base no one has imported there is none, so that a path is enough to tell."""
    things = Registry("thing", "things", Shape, f"{__name__}.Solid", "no_such_module.Base")
    assert things.register(Cube) is Cube and things.register(Circle) is Circle
    # The nearest of several bases counts, in whatever registry.
    assert register(Cube) is Cube and "Cube" not in shapes
    with pytest.raises(GridPathError, match=r"expected a class derived from one of Shape, Solid, Base$"):
        things.register(int)


FRESH = """
import sys
import pymoo_gridpath as gp
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.mutation import Mutation

@gp.register
class Mine(NSGA2):
    pass

@gp.register
class Still(Mutation):
    def _do(self, problem, X, **kwargs):
        return X

rooms = {name for name in sys.modules if name.startswith("pymoo_gridpath.")}
assert rooms == {"pymoo_gridpath." + name for name in ("checks", "errors", "lazy", "registry")}, rooms
problem = gp.GridPathProblem(gp.random_dense_grid(8, 0.1, 1), (0, 0), (7, 7), "integer")
algorithm = gp.make_algorithm("mine", problem, operators={"mutation": "Still"})
assert (type(algorithm), type(algorithm.mating.mutation)) == (Mine, Still)
"""


def test_classes_of_pymoo_are_known_whatever_was_imported():
    subprocess.run([sys.executable, "-c", FRESH], check=True)
