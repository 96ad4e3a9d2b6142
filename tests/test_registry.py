"""Registries: names of the package, of callers, and of installed packages."""

from __future__ import annotations

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
    with pytest.raises(GridPathError, match="expected a class derived from"):
        shapes.register(thing)
    with pytest.raises(GridPathError, match="expected a class derived from one of Shape"):
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
