"""What is known by name: classes of the package, of whoever calls `register`, and of installed packages' entry points."""

from __future__ import annotations

import itertools
import re
import warnings
from collections.abc import Callable, Iterator
from importlib.metadata import EntryPoint, entry_points
from typing import Any, Generic, TypeVar

from pymoo_gridpath.checks import shown
from pymoo_gridpath.errors import CapabilityError, GridPathError, nearest

T = TypeVar("T")
C = TypeVar("C", bound=type)


class Registry(Generic[T]):
    """Classes of one kind by name.

    Parameters
    ----------
    kind : str
        What messages call one of them, such as "objective".
    group : str
        Entry points of this group are known by their names, too; they are loaded when asked for.
    *bases : type or str
        What the classes inherit from, one of these. A base may be its import path: whoever derives from it has imported it,
        and nobody else need wait for it.
    error : type of GridPathError, optional
        What is raised where a name is unknown.
    key : callable, optional
        From a name to what two spellings of it have in common; by default names are taken as they are written.

    Examples
    --------
    >>> class Shape:
    ...     pass
    >>> shapes = Registry("shape", "an.example.of.shapes", Shape)
    >>> class Square(Shape):
    ...     name = "square"
    >>> shapes.register(Square) is Square
    True
    >>> shapes["square"].__name__, list(shapes)
    ('Square', ['square'])
    >>> shapes["sqare"]
    Traceback (most recent call last):
    ...
    pymoo_gridpath.errors.GridPathError: there is no shape 'sqare'; did you mean 'square'?
    """

    def __init__(
        self,
        kind: str,
        group: str,
        *bases: type | str,
        error: type[GridPathError] = GridPathError,
        key: Callable[[str], str] = str,
    ):
        self.kind, self.group = kind, group
        self._bases = [base if isinstance(base, str) else _path_of(base) for base in bases]
        self._error, self._key = error, key
        self._known: dict[str, T] = {}
        self._names: dict[str, str] = {}
        self._entry_points: dict[str, EntryPoint] | None = None
        _REGISTRIES.append(self)

    def register(self, thing: C, name: str | None = None) -> C:
        """Make a class known and return it, so that this serves as a decorator.

        Parameters
        ----------
        thing : type
            A class that inherits from one of the bases.
        name : str, optional
            By default its attribute ``name``, or the name of the class.

        Raises
        ------
        GridPathError
            If it is no such class, has no name, or the name is taken by another one.
        """
        if self._distance(thing) is None:
            raise GridPathError(f"{shown(thing)} cannot be registered as {self.kind}, expected {_derived_from(self._bases)}")
        name = _name_of(thing) if name is None else name
        if not (isinstance(name, str) and re.fullmatch(r"[\w./+-]+", name)):
            raise GridPathError(
                f"the name of the {self.kind} {thing.__name__} is {shown(name)}, expected letters, digits, - and _"
            )
        known = self._known.get(self._key(name))
        # A module that is run again brings the same class anew.
        if known is not None and _path_of(known) != _path_of(thing):
            raise GridPathError(f"the {self.kind} {name!r} is {_path_of(known)} already; give {_path_of(thing)} another name")
        known_as: Any = thing
        self._known[self._key(name)], self._names[self._key(name)] = known_as, name
        return thing

    def __getitem__(self, name: str) -> T:
        """Return the class of a name.

        Raises
        ------
        GridPathError
            Or `error`, if there is none, with the nearest, or an entry point cannot be loaded.
        """
        if not isinstance(name, str):
            raise self._error(f"there is no {self.kind} {shown(name)}; expected one of {', '.join(self)}")
        key = self._key(name)
        if key not in self._known and key in self._installed:
            self._load(key)
        if key not in self._known:
            raise self._error(f"there is no {self.kind} {shown(name)}; {nearest(name, self)}")
        return self._known[key]

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and (self._key(name) in self._known or self._key(name) in self._installed)

    def __iter__(self) -> Iterator[str]:
        """Yield the names, first those that are registered, then those of entry points."""
        yield from self._names.values()
        yield from (point.name for key, point in self._installed.items() if key not in self._known)

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def registered(self) -> dict[str, T]:
        """Return by name what is registered already; no entry point is loaded for it."""
        return {name: self._known[key] for key, name in self._names.items()}

    def name_of(self, thing: type) -> str | None:
        """Return the name that a class is known by; None if it is not. No entry point is loaded for it."""
        own = (name for name, known in self.registered().items() if known is thing)
        others = (point.name for point in self._installed.values() if point.value == f"{thing.__module__}:{thing.__qualname__}")
        return next(itertools.chain(own, others), None)

    def items(self) -> Iterator[tuple[str, T]]:
        """Yield the names with their classes; entry points that cannot be loaded are left out, with a warning."""
        for name in list(self):
            try:
                yield name, self[name]
            except GridPathError as error:
                warnings.warn(str(error), stacklevel=2)

    def values(self) -> Iterator[T]:
        """Yield the classes as `items` does."""
        return (thing for _, thing in self.items())

    def _distance(self, thing: object) -> int | None:
        """Return how far above a class the nearest of the bases is; None if it derives from none."""
        above = [_path_of(cls) for cls in thing.__mro__] if isinstance(thing, type) else []
        return min((above.index(base) for base in self._bases if base in above), default=None)

    @property
    def _installed(self) -> dict[str, EntryPoint]:
        if self._entry_points is None:
            self._entry_points = {self._key(point.name): point for point in entry_points(group=self.group)}
        return self._entry_points

    def _load(self, key: str) -> None:
        point = self._installed[key]
        try:
            thing: Any = point.load()
        except Exception as error:
            raise self._error(
                f"the {self.kind} {point.name!r} of the installed package cannot be imported from {point.value}: "
                f"{type(error).__name__}: {error}"
            ) from error
        # Its module may have registered it by itself.
        if self._known.get(key) is not thing:
            self.register(thing, point.name)


# Every registry there is, from the first made on.
_REGISTRIES: list[Registry] = []


def register(cls: C) -> C:
    """Make a class of your own known by its name, wherever the package takes a name; a decorator.

    What it is follows from what it inherits from: a `Representation`, an `Objective`, a `Planner`, a `MapFormat`, a
    `Suite`, an operator or an algorithm of pymoo. To be found without an import of its module, a class stands in the entry
    points of an installed package instead: ``pymoo_gridpath.representations``, ``.objectives``, ``.operators``, ``.planners``,
    ``.map_formats``, ``.suites`` or ``.algorithms``.

    Parameters
    ----------
    cls : type

    Returns
    -------
    type
        The same class.

    Raises
    ------
    GridPathError
        If it inherits from none of these, has no name, or another class has that name.
    """
    fitting = {one: far for one in _REGISTRIES if (far := one._distance(cls)) is not None}
    if not fitting:
        bases = [base for one in _REGISTRIES for base in one._bases]
        raise GridPathError(f"{shown(cls)} cannot be registered, expected {_derived_from(bases)}")
    # The closest base: a planner is an algorithm as well.
    return min(fitting, key=lambda one: fitting[one]).register(cls)


def key_of(name: object) -> str:
    """Return what all spellings of the name of an algorithm have in common: "NSGA-II", "nsga2" and "Nsga_2" are one."""
    key = re.sub(r"[^a-z0-9]", "", name.lower()) if isinstance(name, str) else ""
    return re.sub(r"ii$", "2", re.sub(r"iii$", "3", key))


def _name_of(thing: type) -> str:
    """Return the attribute ``name`` of a class if it is a text; an operator of pymoo has none before it is made."""
    name = getattr(thing, "name", None)
    return name if isinstance(name, str) else thing.__name__


def _path_of(thing: Any) -> str:
    return f"{thing.__module__}.{thing.__qualname__}"


def _derived_from(bases: list[str]) -> str:
    names = [base.rpartition(".")[2] for base in bases]
    return f"a class derived from {'one of ' * (len(names) > 1)}{', '.join(names)}"


# What derives from pymoo's own classes: here, so that whoever registers one need not have imported its room before.

#: The arguments of pymoo's algorithms that operators are for, each with the base class of the operators that fit.
SLOTS: dict[str, str] = {
    "sampling": "pymoo.core.sampling.Sampling",
    "crossover": "pymoo.core.crossover.Crossover",
    "mutation": "pymoo.core.mutation.Mutation",
    "repair": "pymoo.core.repair.Repair",
    "eliminate_duplicates": "pymoo.core.duplicate.DuplicateElimination",
    "selection": "pymoo.core.selection.Selection",
    "survival": "pymoo.core.survival.Survival",
}

#: Operators by name: those of this package, those that were registered, and those of installed packages. Which argument one is
#: for follows from the class that it derives from.
OPERATORS: Registry[type] = Registry("operator", "pymoo_gridpath.operators", *SLOTS.values(), error=CapabilityError)

#: Algorithms of others: derived from pymoo's ``Algorithm``, no planners. What one can do is its class attribute ``capability``,
#: a `Capability`, or else what the signature of its constructor says.
ALGORITHMS: Registry[type] = Registry(
    "algorithm", "pymoo_gridpath.algorithms", "pymoo.core.algorithm.Algorithm", error=CapabilityError, key=key_of
)
