"""The kinds of things that a study may bring along, and what has to be known of each without importing it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pymoo.core.algorithm import Algorithm

from pymoo_gridpath.algorithms import find_algorithm
from pymoo_gridpath.objectives import OBJECTIVES, Objective
from pymoo_gridpath.operators.sets import MEMBERS
from pymoo_gridpath.planners import PLANNERS, Planner
from pymoo_gridpath.planners.base import is_reference
from pymoo_gridpath.planners.signature import parameters_of
from pymoo_gridpath.problems import SUITES, Suite
from pymoo_gridpath.registry import OPERATORS
from pymoo_gridpath.representations import REPRESENTATIONS, Representation
from pymoo_gridpath.study.specification import own
from pymoo_gridpath.study.specification.own import Kind

OBJECTIVE = Kind("objective", Objective, OBJECTIVES)
REPRESENTATION = Kind("representation", Representation, REPRESENTATIONS)
ALGORITHM = Kind("algorithm", Algorithm, {})
SUITE = Kind("suite", Suite, SUITES)

_REGISTRIES = {Objective: OBJECTIVES, Planner: PLANNERS, Representation: REPRESENTATIONS}


def objective_entry(form: Any) -> Any:
    """Return an objective of a study in canonical form; one that has a name in this package alone keeps that."""
    given = own.read(form, OBJECTIVE, ("objectives",))
    made = given.cls(**given.arguments)
    facts = {"maximise": True} if made.maximise else {}
    files = {key: own.digest_of(given.arguments[key]) for key in given.cls.files if isinstance(given.arguments.get(key), str)}
    content = own.entry(given, label=made.label, **facts, **({"files": files} if files else {}))
    return content if isinstance(content, str) else {**content, "name": made.name}


def objective_name(content: Any) -> str:
    """Return the name of an objective in canonical form."""
    return content if isinstance(content, str) else content["name"]


def objective_label(content: Any) -> str:
    """Return how figures call an objective in canonical form, with its unit."""
    return of_package(Objective)[content].label if isinstance(content, str) else content["label"]


def objective_axis(content: Any, grid: Mapping[str, Any]) -> tuple[str, float]:
    """Return what an axis says of an objective on a grid, both in canonical form, and the factor of its values there."""
    label, resolution = objective_label(content), grid.get("resolution")
    return (label, 1.0) if resolution is None else (label.replace("[cells]", "[m]"), resolution if "[cells]" in label else 1.0)


def is_maximised(content: Any) -> bool:
    """Whether an objective in canonical form is maximised, so that runs hold its negative."""
    return of_package(Objective)[content].maximise if isinstance(content, str) else content.get("maximise", False)


def representation_entry(form: Any) -> Any:
    """Return a representation of a study in canonical form."""
    given: Any = own.read(form, REPRESENTATION, ("representation",))
    return own.entry(given, monotone=given.cls.monotone, paper=given.cls.paper)


def is_monotone(content: Any) -> bool:
    """Whether paths of a representation in canonical form advance along an axis."""
    return of_package(Representation)[content].monotone if isinstance(content, str) else content["monotone"]


def is_of_paper(content: Any) -> bool:
    """Whether the default operators of a representation in canonical form are those of the paper."""
    return of_package(Representation)[content].paper if isinstance(content, str) else content["paper"]


def of_package(base: Any) -> dict[str, Any]:
    """Return the registered classes of this package by name, for those who read what was stored: none is imported for it."""
    return {name: cls for name, cls in _REGISTRIES[base].registered().items() if own.is_of_package(cls)}


def operators_of_package() -> dict[str, type]:
    """Return the operators of this package by name, likewise."""
    return {name: cls for name, cls in OPERATORS.registered().items() if own.is_of_package(cls)}


def operator_slots(cls: type) -> list[str]:
    """Return which operators of a set an algorithm takes: its constructor one by one, a planner all together."""
    if issubclass(cls, Planner):
        return list(MEMBERS) if cls.takes_operators else []
    takes = parameters_of(cls)
    return [slot for slot in MEMBERS if slot in takes]


def takes_pop_size(cls: type) -> bool:
    """Whether an algorithm takes a population size."""
    return "pop_size" in parameters_of(cls) and find_algorithm(cls).takes_pop_size


def algorithm_entry(path: str, arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Return an algorithm of one's own, that is given some arguments, in canonical form.

    Its class attributes ``deterministic`` and ``reference``, or those of its ``capability``, say whether one run of it is
    enough, and whether that is the truth which others are measured against.
    """
    given = own.read(path, ALGORITHM, ("algorithm",))
    facts = flags_of(given.cls, arguments)
    if issubclass(given.cls, Planner):
        # Of others it is not said, as their keys were made without.
        facts["planner"] = True
    return own.entry(given, slots=operator_slots(given.cls), pop_size=takes_pop_size(given.cls), **facts)


def flags_of(cls: type, arguments: Mapping[str, Any]) -> dict[str, bool]:
    """Return what an algorithm of one's own says of itself: whether it draws nothing, and whether it is the truth."""
    says = getattr(cls, "capability", cls)
    return {"deterministic": bool(getattr(says, "deterministic", False)), "reference": is_reference(cls, arguments)}
