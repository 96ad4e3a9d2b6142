"""Algorithms and planners by name: pymoo's of the capability table, those of others that are registered, and planners."""

from __future__ import annotations

import difflib
import importlib
import importlib.util
import inspect
from dataclasses import replace

from pymoo.core.algorithm import Algorithm
from pymoo.core.problem import Problem

from pymoo_gridpath import checks
from pymoo_gridpath.algorithms.arguments import parameters
from pymoo_gridpath.algorithms.capabilities import CAPABILITIES, Capability
from pymoo_gridpath.algorithms.moead import SmoothMOEAD
from pymoo_gridpath.errors import CapabilityError, counted
from pymoo_gridpath.operators.sets import MEMBERS
from pymoo_gridpath.planners import PLANNERS, Planner
from pymoo_gridpath.problems import MovingObstaclesProblem
from pymoo_gridpath.registry import ALGORITHMS, key_of

_PACKAGES = {"scikit-learn": "sklearn"}
_OWN = {key_of(row.name): row for row in CAPABILITIES.values()}


def find_algorithm(name: str | type[Algorithm], n_obj: int | None = None) -> Capability | type[Planner]:
    """Return what an algorithm or planner can do: its row of the capability table, or the planner's class.

    Both have ``name``, ``deterministic``, ``reference``, ``takes_operators``, ``takes_pop_size`` and ``takes_generations``.

    Parameters
    ----------
    name : str or type
        Case and punctuation do not matter. Or the class itself, of pymoo, of this package or one's own.
    n_obj : int, optional
        Number of objectives of the problem, for the hint.

    Returns
    -------
    Capability or type
        The row of an algorithm, or the class of a planner.

    Raises
    ------
    CapabilityError
        If there is none, with the nearest that suits grid problems of so many objectives; if two go by that name; or if a class
        is no algorithm.

    Examples
    --------
    >>> find_algorithm("MOEA/D").deterministic, find_algorithm("exact").deterministic
    (False, True)
    """
    if isinstance(name, type):
        return _of_class(name)
    key = key_of(name)
    homes = [home for home in (_OWN, ALGORITHMS, PLANNERS) if key in home]
    if len(homes) > 1:
        raise CapabilityError(f"two algorithms are called {checks.shown(name)}, expected another name for the registered one")
    if key in _OWN:
        return _OWN[key]
    if key in ALGORITHMS:
        return _row_of_name(name)
    if key in PLANNERS:
        return PLANNERS[name]
    for planner in PLANNERS.values():
        if key == key_of(planner.__name__):
            return planner
    raise _unknown(name, key, n_obj)


def registered_name(cls: type[Algorithm]) -> str | None:
    """Return the name that an algorithm or planner is registered by; None if it is not."""
    return PLANNERS.name_of(cls) or ALGORITHMS.name_of(cls)


def _unknown(name: str, key: str, n_obj: int | None) -> CapabilityError:
    rows = [*CAPABILITIES.values(), *(_row_of_name(registered) for registered, _ in ALGORITHMS.items())]
    fit = {key_of(row.name): row.name for row in rows if not row.unfit and (n_obj is None or row.takes(n_obj))}
    fit |= {key_of(planner): planner for planner in PLANNERS}
    near = difflib.get_close_matches(key, fit, n=1, cutoff=0.6)
    many = "" if n_obj is None else f" for {counted(n_obj, 'objective')}"
    hint = f"did you mean {fit[near[0]]!r}?" if near else f"expected one of {', '.join(fit.values())}{many}"
    return CapabilityError(f"there is no algorithm {checks.shown(name)}; {hint}")


def _of_class(cls: type) -> Capability | type[Planner]:
    if not issubclass(cls, Algorithm):
        raise CapabilityError(f"the algorithm is the class {cls.__name__}, expected one derived from pymoo's Algorithm")
    if issubclass(cls, Planner):
        return cls
    if cls is SmoothMOEAD:
        return CAPABILITIES["MOEAD"]
    row = CAPABILITIES.get(cls.__name__)
    if row is not None and row.module == cls.__module__:
        return row
    # Rules for an algorithm of the table are not for another one of that name.
    taken = key_of(cls.__name__) in _OWN
    return _row_of(cls, f"{cls.__module__}.{cls.__qualname__}" if taken else cls.__name__)


def _row_of_name(name: str) -> Capability:
    # As it is registered.
    return _row_of(ALGORITHMS[name], next(known for known in ALGORITHMS if key_of(known) == key_of(name)))


def _row_of(cls: type[Algorithm], name: str) -> Capability:
    """Return what an algorithm of others can do: what it says itself, or else what its signature tells."""
    row = getattr(cls, "capability", None)
    if row is not None:
        row = checks.instance(f"the capability of {name}", row, Capability, error=CapabilityError)
        return replace(row, name=name, module=cls.__module__, cls=cls)
    takes = parameters(cls, name)
    bases = (CAPABILITIES.get(base.__name__) for base in cls.__mro__ if base.__module__.startswith("pymoo."))
    base = next(filter(None, bases), None)
    needed = [key for key in ("ref_dirs", "ref_points") if takes.get(key) is inspect.Parameter.empty]
    return Capability(
        name,
        cls.__module__,
        min_objectives=1,
        takes_operators=bool({"crossover", "mutation"} & takes.keys()),
        # Of as many directions, the default of what needs some.
        takes_pop_size="pop_size" in takes or "ref_dirs" in needed,
        constraints=base is None or base.constraints,
        one_child=base is not None and base.one_child,
        repair="repair" in takes,
        needs=needed[0] if needed else "",
        unpacks=set(MEMBERS) <= takes.keys(),
        deterministic=getattr(cls, "deterministic", False) is True,
        reference=getattr(cls, "reference", False) is True,
        cls=cls,
    )


def class_of(row: Capability) -> type:
    """Return the class of an algorithm.

    Raises
    ------
    CapabilityError
        If it needs a package that is not installed.
    """
    if row.cls is not None:
        return row.cls
    if row.name == "MOEAD":
        return SmoothMOEAD
    package = _PACKAGES.get(row.extra, row.extra)
    if package and importlib.util.find_spec(package) is None:
        raise CapabilityError(f"{row.name} needs the package {row.extra}, which is not installed: pip install {row.extra}")
    return getattr(importlib.import_module(row.module), row.name)


def refuse_problem(row: Capability, problem) -> None:
    """Raise a CapabilityError that says what an algorithm cannot do for a problem, if anything."""
    if not isinstance(problem, Problem):
        raise CapabilityError(f"the problem is of the class {type(problem).__name__}, expected one of pymoo: a Problem")
    if row.unfit:
        raise CapabilityError(f"{row.name} {row.unfit}")
    if problem.n_obj < row.min_objectives:
        raise CapabilityError(
            f"{row.name} needs at least {row.min_objectives} objectives, the problem has {problem.n_obj}; use 'GA' for one"
        )
    if row.max_objectives is not None and problem.n_obj > row.max_objectives:
        most = "one objective" if row.max_objectives == 1 else f"at most {row.max_objectives} objectives"
        raise CapabilityError(f"{row.name} takes {most}, the problem has {problem.n_obj}")
    if problem.has_constraints() and not row.constraints:
        raise CapabilityError(f"{row.name} cannot solve problems with constraints; use obstacles='penalty'")
    if isinstance(problem, MovingObstaclesProblem) and not row.moving:
        raise CapabilityError(
            f"{row.name} keeps members beside its population, whose values cannot be renewed when obstacles move; use 'DNSGA2'"
        )
