"""Any of pymoo's multi-objective algorithms by name, ready for a path problem, or a sentence that says why not."""

from __future__ import annotations

import copy
import importlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from pymoo.algorithms.moo.ctaea import CTAEA
from pymoo.algorithms.moo.nsde import VariantDE
from pymoo.core.algorithm import Algorithm
from pymoo.core.crossover import Crossover
from pymoo.core.duplicate import NoDuplicateElimination
from pymoo.util.reference_direction import (
    UniformReferenceDirectionFactory,
    get_number_of_uniform_points,
    get_partition_closest_to_points,
)

from pymoo_gridpath import checks
from pymoo_gridpath.algorithms import arguments as _arguments
from pymoo_gridpath.algorithms.capabilities import CAPABILITIES, Capability
from pymoo_gridpath.algorithms.differential import WholeNumberDE
from pymoo_gridpath.algorithms.evaluator import ArrayEvaluator
from pymoo_gridpath.algorithms.known import class_of, find_algorithm, refuse_problem
from pymoo_gridpath.algorithms.rvea import FiniteAPDSurvival
from pymoo_gridpath.algorithms.spea2 import ArraySPEA2Survival, FitnessTournament, StrengthAndSmoothness, StrengthTournament
from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.operators import ArrayMating, RankAndSmoothness, SmoothnessTournament, default_operators
from pymoo_gridpath.operators.known import operator_of
from pymoo_gridpath.operators.mating import mates_on_arrays
from pymoo_gridpath.operators.selection import CrowdingTournament, NeighborTournament
from pymoo_gridpath.operators.sets import MEMBERS
from pymoo_gridpath.operators.survival import ArrayRankAndCrowding
from pymoo_gridpath.planners import PathOutput, Planner
from pymoo_gridpath.planners.signature import parameters_of, refuse_missing, refuse_unknown
from pymoo_gridpath.problems import GridPathProblem
from pymoo_gridpath.registry import SLOTS

#: Members of a population unless told.
DEFAULT_POP_SIZE = 100

# Operators that an algorithm does without where it does not take them.
_LEFT_OUT = ("repair", "eliminate_duplicates")


def make_algorithm(
    name: str | type[Algorithm] | Algorithm,
    problem,
    pop_size: int | None = None,
    smoothness: bool | None = None,
    operators: Mapping[str, Any] | None = None,
    **kwargs,
) -> Algorithm:
    """Return an algorithm with operators that fit a path problem.

    Parameters
    ----------
    name : str, type or pymoo.core.algorithm.Algorithm
        An algorithm of the capability table, one that is registered, see `pymoo_gridpath.registry.register`, or a planner, such
        as "exact" for `ExactFront`; case and punctuation do not matter: "NSGA-II", "nsga2", "MOEA/D". Or a class, of your own,
        say, which is given what its constructor takes; or an algorithm that is made already, of which a copy is returned, and
        for which no other argument is left.
    problem : GridPathProblem
        What it is to solve.
    pop_size : int, optional
        Population size, by default 100. Algorithms whose population is the set of reference directions (MOEAD, ParallelMOEAD,
        CTAEA) have at most as many, see `reference_directions`; RNSGA3 at most as many as divide evenly among its reference
        points. Planners that have no population refuse it.
    smoothness : bool, optional
        Whether ties are broken by total turn. By default they are where the algorithm can, unless turn is an objective of
        the problem or ``selection`` or ``survival`` is given.
    operators : mapping, optional
        ``sampling``, ``crossover``, ``mutation``, ``repair`` and ``eliminate_duplicates``, such as `path_operators` returns,
        ``selection`` and ``survival``; each may be left out, and may be the name of one of `OPERATORS` in place of an object.
        By default those of `default_operators`: the paper's for its codings, and path-aware ones for cell sequences. A repair
        or duplicate elimination that the algorithm does not take is left out.
    **kwargs
        Other arguments of the algorithm: what its pymoo class takes and heeds, such as ``ref_dirs``, ``n_neighbors``,
        ``termination``, ``seed`` or ``output``, by default a `PathOutput`, which ``verbose=True`` prints.

    Returns
    -------
    pymoo.core.algorithm.Algorithm
        A new one that shares no operator, survival or output with any other, except for those given.

    Raises
    ------
    CapabilityError
        If there is no such algorithm or operator; if it cannot solve this problem (number of objectives, constraints, genes);
        if it has no smoothness tie-break but one is asked for; if an argument is unknown, means nothing, or is needed and
        missing; or if a package it needs is not installed.

    Examples
    --------
    >>> import numpy as np
    >>> from pymoo_gridpath import GridPathProblem, OccupancyGrid
    >>> problem = GridPathProblem(OccupancyGrid(np.zeros((8, 8))), (0, 0), (7, 7), obstacles="constraint")
    >>> type(make_algorithm("MOEA/D", problem, pop_size=20)).__name__
    'SmoothMOEAD'
    >>> make_algorithm("D-NSGA-II", problem)
    Traceback (most recent call last):
    ...
    pymoo_gridpath.errors.CapabilityError: DNSGA2 cannot solve problems with constraints; use obstacles='penalty'
    """
    row = find_algorithm(type(name) if isinstance(name, Algorithm) else name, getattr(problem, "n_obj", None))
    if isinstance(row, Capability):
        refuse_problem(row, problem)
    given = {"pop_size": pop_size, "smoothness": smoothness, "operators": operators}
    given = {key: value for key, value in given.items() if value is not None}
    if isinstance(name, Algorithm):
        return _copied(name, given | kwargs)
    if not isinstance(row, Capability):
        row.refuse(problem)
        return _planner(row, given | kwargs)
    return build(row, problem, pop_size, smoothness, operators, **kwargs)


def _copied(algorithm: Any, given: Mapping[str, Any]) -> Algorithm:
    """Return a copy of an algorithm that somebody has made, before it runs."""
    name = type(algorithm).__name__
    if given:
        key = checks.shown(next(iter(given)))
        raise CapabilityError(f"{name} is made already and takes no argument {key}; give its class to set it")
    if algorithm.problem is not None:
        raise CapabilityError(f"{name} has begun a run, expected an algorithm that has not, or its class")
    return copy.deepcopy(algorithm)


def _planner(cls: type[Planner], given: Mapping[str, Any]) -> Planner:
    """Return a planner with arguments that it takes."""
    accepted = cls.parameters()
    for key, taken in (("pop_size", cls.takes_pop_size), ("operators", cls.takes_operators)):
        if not taken:
            accepted.pop(key, None)
    refuse_unknown(cls.__name__, given, accepted)
    refuse_missing(cls.__name__, given, accepted)
    named = {"operators": _named(given["operators"])} if "operators" in given else {}
    return cls(**{**given, **named})


def build(
    row: Capability,
    problem,
    pop_size: int | None = None,
    smoothness: bool | None = None,
    operators: Mapping[str, Any] | None = None,
    **kwargs,
) -> Algorithm:
    """Return an algorithm without asking whether it can solve the problem; see `make_algorithm`."""
    if pop_size is not None and not row.takes_pop_size:
        raise CapabilityError(f"{row.name} takes no argument 'pop_size'")
    pop_size = _arguments.check_pop_size(row.name, DEFAULT_POP_SIZE if pop_size is None else pop_size)
    cls = class_of(row)
    accepted = _arguments.parameters(cls, row.name)
    given = dict(kwargs)
    if row.cls is None:
        # These two classes need not be told: smoothness is an argument of this function.
        accepted.pop("smoothness", None)
    elif smoothness is not None and "smoothness" in accepted:
        given["smoothness"], smoothness = smoothness, None
    if operators is not None:
        given.update(_fitted(row, _named(operators), accepted))
    refuse_unknown(row.name, given, (*accepted, *["pop_size"] * row.takes_pop_size, "smoothness", "operators"))
    unchecked = {"smoothness", *_arguments.own_parameters(cls)}
    _arguments.check_values(row.name, {key: value for key, value in given.items() if key not in unchecked}, accepted)
    _arguments.check_pop_size(row.name, pop_size, _least_pop_size(accepted, kwargs))
    settings = _arguments.fresh_defaults(accepted)
    if isinstance(problem, GridPathProblem) and "output" in accepted:
        settings["output"] = PathOutput()
    settings |= {key: value for key, value in _operators(row, problem, given).items() if key in accepted}
    settings |= _smoothness(row, problem, smoothness, given)
    settings |= given | _references(row, problem, pop_size, given, accepted)
    _arguments.check_together(row.name, given, problem.n_obj, settings.get("ref_dirs"))
    if "pop_size" in accepted:
        settings["pop_size"] = pop_size
    if "survival" not in given and getattr(settings.get("crossover"), "makes_legal", False):
        survival = settings.get("survival")
        if isinstance(survival, RankAndSmoothness):
            survival.distinct = True
    if row.name in ("NSGA2", "SPEA2") and all(mates_on_arrays(given[key]) for key in MEMBERS[1:] if key in given):
        # The same mating several times as fast; some operators need pymoo's.
        settings["mating"] = ArrayMating(*(settings[key] for key in ("selection", "crossover", "mutation", "repair")))
    if row.name == "OmniOptimizer" and "selection" not in given:
        settings["selection"] = NeighborTournament()
    if row.name == "RVEA" and given.get("survival") is None:
        settings["survival"] = FiniteAPDSurvival(settings["ref_dirs"], given.get("alpha", accepted["alpha"]))
    if "evaluator" in accepted:
        settings.setdefault("evaluator", ArrayEvaluator())
    termination = settings.pop("termination", None)
    refuse_missing(row.name, settings, accepted)
    algorithm = cls(**settings)
    if termination is not None:
        # Several constructors overwrite the one they are given.
        algorithm.termination = termination
    if row.name in ("AGEMOEA", "AGEMOEA2"):
        # Their constructors take none. The module needs numba, as they do.
        age = importlib.import_module("pymoo_gridpath.algorithms.age")
        algorithm.survival = age.FiniteAGEMOEASurvival() if row.name == "AGEMOEA" else age.FiniteAGEMOEA2Survival()
    if isinstance(algorithm, CTAEA):
        # It fills its archive from the first population and never ends if duplicates are missing there.
        algorithm.initialization.eliminate_duplicates = NoDuplicateElimination()
    if isinstance(algorithm.__dict__.get("mating"), VariantDE):
        algorithm.mating = _whole_number_mating(algorithm)
    return algorithm


def _least_pop_size(accepted: Mapping[str, Any], given: Mapping[str, Any]) -> int:
    """Return the smallest population with which an algorithm ends."""
    if "variant" not in accepted:
        return 1
    # Differential evolution draws distinct parents: the target, the base, and two for each difference.
    match = _arguments.VARIANT.fullmatch(given.get("variant", "DE/rand/1/bin"))
    assert match is not None
    return 2 + 2 * (int(match["n_diffs"]) + ("-to-" in match["base"]))


def reference_directions(n_obj: int, n_points: int) -> np.ndarray:
    """Return evenly spread reference directions by the method of Das and Dennis.

    Parameters
    ----------
    n_obj : int
        Number of objectives, 1 to 100.
    n_points : int
        At most how many, up to 100,000; the largest simplex lattice within is taken. With two objectives there are exactly
        ``n_points``, with three 1, 3, 6, 10, ..., 91, ...

    Returns
    -------
    numpy.ndarray, shape (n_directions, n_obj)

    Raises
    ------
    CapabilityError
        If either is no whole number in its range, or n_points is less than n_obj, the directions of the objectives themselves.

    References
    ----------
    I. Das and J. E. Dennis, "Normal-boundary intersection: a new method for generating the Pareto surface in nonlinear
    multicriteria optimization problems", SIAM Journal on Optimization 8(3), 1998.

    Examples
    --------
    >>> reference_directions(2, 3).tolist()
    [[0.0, 1.0], [0.5, 0.5], [1.0, 0.0]]
    >>> len(reference_directions(3, 100))
    91
    """
    _arguments.check_whole("reference directions", "n_obj", n_obj, 1, 100)
    _arguments.check_whole("reference directions", "n_points", n_points, 1, _arguments.MOST)
    if n_points < n_obj:
        raise CapabilityError(f"{n_obj} objectives need at least {n_obj} reference directions, got room for {n_points}")
    n_partitions = get_partition_closest_to_points(n_points, n_obj)
    return UniformReferenceDirectionFactory(n_obj, n_partitions=n_partitions).do()


def _named(operators: Any) -> dict[str, Any]:
    """Return operators by what they are for, made of their names where these are given."""
    if not isinstance(operators, Mapping):
        raise CapabilityError(f"operators is {checks.shown(operators)}, expected a mapping such as path_operators returns")
    refuse_unknown("operators", operators, SLOTS)
    return {slot: operator_of(slot, given) for slot, given in operators.items()}


def _fitted(row: Capability, operators: Mapping[str, Any], accepted) -> dict[str, Any]:
    """Return operators without those that an algorithm does not take, and with one child a mating if it needs that."""
    fitted = {key: value for key, value in operators.items() if key in accepted or key not in _LEFT_OUT}
    own = [key for key in ("crossover", "mutation") if key in fitted and not row.takes_operators]
    if own:
        raise CapabilityError(
            f"{row.name} takes no argument {own[0]!r}, since it makes children in a way of its own; give operators without "
            f"crossover and mutation"
        )
    if row.one_child and _may_give_one_child(fitted.get("crossover")):
        crossover: Any = copy.copy(fitted["crossover"])
        crossover.n_offsprings = 1
        fitted["crossover"] = crossover
    return fitted


def _may_give_one_child(crossover: Any) -> bool:
    """Return whether the number of children is a parameter of a crossover, rather than what its class hands to pymoo's."""
    return isinstance(crossover, Crossover) and "n_offsprings" in parameters_of(type(crossover), below=Crossover)


def _operators(row: Capability, problem, given: Mapping[str, Any]) -> dict[str, Any]:
    if row.one_child and getattr(given.get("crossover"), "n_offsprings", 1) != 1:
        raise CapabilityError(f"{row.name} needs a crossover that gives one child: n_offsprings=1")
    if given.keys() >= set(MEMBERS):
        return {}
    made = default_operators(problem)
    if row.one_child:
        made["crossover"].n_offsprings = 1
    if not row.repair:
        del made["repair"]
    return made


def _smoothness(row: Capability, problem, smoothness: bool | None, given: Mapping[str, Any]) -> dict[str, Any]:
    if smoothness is not None:
        smoothness = checks.flag("smoothness", smoothness, CapabilityError, expected="True, False or None")
    own = [key for key in ("selection", "survival") if key in given]
    if smoothness and not row.smoothness:
        able = ", ".join(other.name for other in CAPABILITIES.values() if other.smoothness)
        raise CapabilityError(f"{row.name} has no smoothness tie-break; {able} have one")
    if smoothness and own:
        raise CapabilityError(f"smoothness=True brings its own {own[0]}; leave out one of the two")
    if smoothness is None:
        smoothness = row.smoothness and not own and "turn" not in getattr(problem, "objective_names", ())
    if row.name == "MOEAD":
        return {"smoothness": smoothness}
    if not row.smoothness:
        return {}
    if row.name == "SPEA2":
        selection, survival = (
            (StrengthTournament, StrengthAndSmoothness) if smoothness else (FitnessTournament, ArraySPEA2Survival)
        )
    else:
        selection, survival = (
            (SmoothnessTournament, RankAndSmoothness) if smoothness else (CrowdingTournament, ArrayRankAndCrowding)
        )
    return {"selection": selection(), "survival": survival()}


def _references(row: Capability, problem, pop_size: int, given: Mapping[str, Any], accepted) -> dict[str, Any]:
    if row.needs == "ref_dirs":
        return {"ref_dirs": _ref_dirs(problem, pop_size, given.get("ref_dirs"), accepted)}
    if row.needs == "automated_dm" and given.get("automated_dm") is None:
        raise CapabilityError(f"{row.name} asks a decision maker during the run; give one as automated_dm")
    if row.needs != "ref_points":
        return {}
    if given.get("ref_points") is None:
        raise CapabilityError(
            f"{row.name} searches near reference points; give ref_points, one row of {problem.n_obj} values each"
        )
    points = _arguments.rows("ref_points", given["ref_points"], problem.n_obj)
    if "pop_per_ref_point" in given or "pop_per_ref_point" not in accepted:
        return {"ref_points": points}
    room = (pop_size - problem.n_obj) // len(points)
    if room < problem.n_obj:
        least = len(points) * problem.n_obj + problem.n_obj
        raise CapabilityError(f"{row.name} needs pop_size {least} or more for {len(points)} reference points, got {pop_size}")
    per_point = get_number_of_uniform_points(get_partition_closest_to_points(room, problem.n_obj), problem.n_obj)
    return {"ref_points": points, "pop_per_ref_point": per_point}


def _ref_dirs(problem, pop_size: int, ref_dirs, accepted) -> np.ndarray:
    if ref_dirs is None:
        return reference_directions(problem.n_obj, pop_size)
    ref_dirs = _arguments.rows("ref_dirs", ref_dirs, problem.n_obj)
    if len(ref_dirs) < 2 or (len(ref_dirs) > pop_size and "pop_size" in accepted):
        raise CapabilityError(f"ref_dirs has {len(ref_dirs)} rows, expected 2 to pop_size = {pop_size}")
    return ref_dirs


def _whole_number_mating(algorithm) -> WholeNumberDE:
    """Return pymoo's mating of a differential evolution with its settings, made fit for whole numbers."""
    mating = WholeNumberDE(repair=algorithm.repair)
    kept = {key: value for key, value in vars(algorithm.mating).items() if key != "repair"}
    mating.__dict__.update(kept)
    return mating
