"""A plan as a file holds it, checked: whoever reads one finds in it what a study plans, or a sentence says what is wrong."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pymoo_gridpath.algorithms import CAPABILITIES
from pymoo_gridpath.algorithms.arguments import check_pop_size
from pymoo_gridpath.algorithms.factory import DEFAULT_POP_SIZE
from pymoo_gridpath.errors import StudyError, nearest
from pymoo_gridpath.grid.arguments import as_footprint, as_pose
from pymoo_gridpath.objectives import Objective
from pymoo_gridpath.planners import Planner, reference_planner
from pymoo_gridpath.registry import SLOTS, key_of
from pymoo_gridpath.representations import Representation
from pymoo_gridpath.study.planning.canonical import steps_of
from pymoo_gridpath.study.specification import moving, own, values
from pymoo_gridpath.study.specification.algorithm import AlgorithmSpec
from pymoo_gridpath.study.specification.base import make_spec
from pymoo_gridpath.study.specification.kinds import is_monotone, objective_name, of_package, operators_of_package
from pymoo_gridpath.study.specification.operators import planner_of
from pymoo_gridpath.study.specification.problem import ProblemSpec, RandomFamily
from pymoo_gridpath.study.specification.study import Study
from pymoo_gridpath.study.specification.values import Where

_PLAN = ("name", "budget", "target", "problems", "algorithms", "runs")
_SETTINGS = ("objectives", "representation", "obstacles", "penalty", "potential_limit", "axis")
_OVERRIDES = ("representation", "obstacles", "penalty", "potential_limit", "axis")

# Longer keys are none, see `Store.path`; a million runs are checked by this.
_LONGEST_KEY = 200


def check_plan(data: Any) -> None:
    """Raise StudyError unless it is what `Plan.to_json` returns."""
    plan = _table(data, _PLAN, (), "the plan", ("reference",))
    algorithms = [
        _check_algorithm(_table(item, ("label", "spec", "overrides"), ("algorithms", k), "an algorithm"), ("algorithms", k))
        for k, item in enumerate(_list(plan["algorithms"], ("algorithms",)))
    ]
    problems = [
        _table(item, ("label", "group", "spec"), ("problems", k), "a problem", ("reference", "source", "place", "no_reference"))
        for k, item in enumerate(_list(plan["problems"], ("problems",)))
    ]
    for k, problem in enumerate(problems):
        _check_problem(problem, ("problems", k))
    _check_groups(problems)
    _check_limits(problems, algorithms)
    reference = plan.get("reference")
    if reference is not None:
        reference = _planner(reference, ("reference",))
    # What stands in a study as in its plan, so that the study checks it.
    moves = bool(problems) and all("moving" in problem["spec"] for problem in problems)
    Study(
        problems=[ProblemSpec(map="checked", moving={"movers": [[[0, 0]]]} if moves else None)],
        algorithms=[AlgorithmSpec(algorithm=reference_planner())],
        seeds=1,
        name=plan["name"],
        budget=None if moves and plan["budget"] == {} else plan["budget"],
        target=plan["target"],
        reference=False if reference is None else {key: value for key, value in reference.items() if key != "algorithm"},
    )
    _check_runs(_list(plan["runs"], ("runs",)), len(problems), len(algorithms), reference is not None)


# -- parts --------------------------------------------------------------------------------------------------------------


def _table(value: Any, keys: tuple[str, ...], where: Where, owner: str, optional: tuple[str, ...] = ()) -> dict[str, Any]:
    """Return a table that has these keys, perhaps the optional ones, and no others."""
    table = values.table(value, where)
    values.check_keys(table, (*keys, *optional), where, owner)
    for key in keys:
        if key not in table:
            raise StudyError(f"{owner} has no {key}, expected {', '.join(keys)}", where)
    return table


def _list(value: Any, where: Where) -> list:
    if not isinstance(value, list):
        raise StudyError(f"{values.key_of(where)} is {values.show(value)}, expected a list", where)
    return value


def _check_texts(table: Mapping[str, Any], keys: tuple[str, ...], where: Where) -> None:
    for key in keys:
        if not isinstance(table[key], str):
            raise StudyError(f"{key} is {values.show(table[key])}, expected a text", (*where, key))


def _is_key(value: Any) -> bool:
    return isinstance(value, str) and 0 < len(value) <= _LONGEST_KEY and value.isalnum()


def _check_problem(problem: Mapping[str, Any], where: Where) -> None:
    _check_texts({"source": "", "no_reference": "", **problem}, ("label", "group", "source", "no_reference"), where)
    reference = problem.get("reference")
    if reference is not None and not _is_key(reference):
        raise StudyError(f"reference is {values.show(reference)}, expected the key of a run, or none", (*where, "reference"))
    if problem.get("place") is not None:
        _check_place(problem["place"], (*where, "place"))
    place = (*where, "spec")
    spec = _table(problem["spec"], ("grid", "start", "goal", *_SETTINGS), place, "the problem", ("moving",))
    width, height = _check_grid(spec["grid"], (*place, "grid"))
    for role in ("start", "goal"):
        x, y = values.cell(spec[role], (*place, role))
        if not (0 <= x < width and 0 <= y < height):
            raise StudyError(f"{role} is {values.show(spec[role])}, expected a cell of {width} x {height}", (*place, role))
    settings = {key: spec[key] for key in _SETTINGS}
    settings["objectives"] = names = _own_objectives(spec["objectives"], (*place, "objectives"))
    settings["representation"] = _own_representation(spec["representation"], (*place, "representation"))
    if "moving" in spec:
        moving.check_entry(spec["moving"], (*place, "moving"))
        settings["moving"] = spec["moving"]
    made = _at(place, make_spec, ProblemSpec, {"map": "checked", **settings}, ())
    if list(made.objectives) != names:
        raise StudyError(f"objectives is {values.show(spec['objectives'])}, expected a list of names", (*place, "objectives"))
    if spec["representation"] is None or (spec["penalty"] is None) != (spec["obstacles"] == "constraint"):
        key = "representation" if spec["representation"] is None else "penalty"
        raise StudyError(f"{key} is {values.show(spec[key])}, expected what the problem is solved with", (*place, key))


def _check_place(value: Any, where: Where) -> None:
    """Refuse what `place_of_grid` did not say of a grid."""
    place = _table(value, (), where, "the place of a map", ("origin", "robot_radius", "footprint", "original"))
    grown = [key for key in ("robot_radius", "footprint", "original") if key in place]
    if len(grown) not in (0, 3):
        raise StudyError(f"there is {grown[0]} without the others, expected robot_radius, footprint and original", where)
    if "origin" in place:
        values.told((*where, "origin"), as_pose, place["origin"])
    if grown:
        values.real(place["robot_radius"], (*where, "robot_radius"))
        _check_texts(place, ("original",), where)
        if place["footprint"] is not None:
            values.told((*where, "footprint"), as_footprint, place["footprint"])


# Of things that a study's author brought along, a plan says enough: nothing is imported because a file names it.


def _own_objectives(given: Any, where: Where) -> list[Any]:
    """Return the objectives that have names in this package, or one in their place, once those of others have been checked."""
    if not isinstance(given, list):
        raise StudyError(f"objectives is {values.show(given)}, expected a list of names", where)
    for one in given:
        if isinstance(one, Mapping):
            more = {key: kind for key, kind in (("maximise", bool), ("files", dict)) if key in one}
            own.check_entry(one, "objective", where, name=str, label=str, **more)
        elif isinstance(one, str) and one not in of_package(Objective):
            raise StudyError(f"there is no objective {values.show(one)}; {nearest(one, of_package(Objective))}", where)
    names = [one for one in given if not isinstance(one, Mapping)]
    if len({objective_name(one) for one in given if isinstance(one, str | Mapping)}) < len(given):
        raise StudyError(f"objectives is {values.show(given)}, expected each once", where)
    return names if names or not given else ["length"]


def _own_representation(given: Any, where: Where) -> Any:
    """Return a representation that has a name in this package, or one in its place, once that of others has been checked."""
    if isinstance(given, Mapping):
        own.check_entry(given, "representation", where, monotone=bool, paper=bool)
        return next(name for name in of_package(Representation) if is_monotone(name) is given["monotone"])
    if isinstance(given, str):
        values.choice(given, of_package(Representation), where)
    return given


def _own_algorithm(spec: dict[str, Any], where: Where) -> dict[str, Any]:
    """Return what stands in for an algorithm that is not of this package or pymoo, once that has been checked."""
    place = (*where, "algorithm")
    facts: dict[str, type] = {"deterministic": bool, "reference": bool, "pop_size": bool, "slots": list}
    if "made" in spec["algorithm"]:
        facts = {"deterministic": bool, "reference": bool, "made": bool}
        own.check_entry(spec["algorithm"], "algorithm", place, **facts)
        spec = _table(spec, ("algorithm",), where, "the algorithm") | {"parameters": {}}
        return _stand_in(spec)
    if "planner" in spec["algorithm"]:
        facts["planner"] = bool
    own.check_entry(spec["algorithm"], "algorithm", place, **facts)
    takes = {"pop_size": spec["algorithm"]["pop_size"], "operators": spec["algorithm"]["slots"]}
    spec = _table(spec, ("algorithm", "parameters", *(key for key in takes if takes[key])), where, "the algorithm")
    values.table(spec["parameters"], (*where, "parameters"))
    return _stand_in(spec)


def _stand_in(spec: dict[str, Any]) -> dict[str, Any]:
    return {"pop_size": DEFAULT_POP_SIZE, "smoothness": None, "operators": {"base": "default"}} | {
        **spec,
        "algorithm": next(name for name, row in CAPABILITIES.items() if not row.unfit and not row.needs),
        "parameters": {},
    }


def _at(place: Where, function, *arguments) -> Any:
    """Return what a function returns, with a place before that in its errors."""
    try:
        return function(*arguments)
    except StudyError as error:
        raise StudyError(error.message, (*place, *error.where)) from None


def _check_grid(value: Any, where: Where) -> tuple[int, int]:
    """Return the width and the height of a grid."""
    if isinstance(value, Mapping) and "random" in value:
        place = (*where, "random")
        grid = _table(value, ("random",), where, "the grid")
        family = _table(grid["random"], ("size", "p0", "seed", "corner_cutting"), place, "the random grid", ("moves",))
        values.whole(family["seed"], (*place, "seed"), 0, values.MAX_SEED)
        _at(place, make_spec, RandomFamily, {key: value for key, value in family.items() if key != "seed"}, ())
        return family["size"], family["size"]
    grid = _table(value, ("digest", "width", "height", "corner_cutting"), where, "the grid", ("moves", "resolution"))
    _check_texts(grid, ("digest",), where)
    if "resolution" in grid:
        values.real(grid["resolution"], (*where, "resolution"), open_below=True)
    values.corner_cutting(grid["corner_cutting"], (*where, "corner_cutting"))
    values.moves(steps_of(grid)["moves"], (*where, "moves"))
    return values.whole(grid["width"], (*where, "width"), 1), values.whole(grid["height"], (*where, "height"), 1)


def _planner(value: Any, where: Where, *further: str) -> dict[str, Any]:
    """Return the table of a planner."""
    table = _table(value, ("algorithm",), where, "the planner", ("max_seconds", "max_labels", *further))
    if planner_of(table["algorithm"]) is None:
        raise StudyError(f"algorithm is {values.show(table['algorithm'])}, expected a planner", (*where, "algorithm"))
    return table


def _check_operator(slot: str, single: Any, where: Where) -> None:
    """Refuse an operator that is neither of this package nor said enough of, so that nothing is imported for its name."""
    name = values.table(single, where).get("class")
    if own.is_path(name):
        own.check_entry(single, slot, where)
    else:
        values.choice(name, operators_of_package(), (*where, "class"))


def _check_algorithm(algorithm: Mapping[str, Any], where: Where) -> Mapping[str, Any]:
    _check_texts(algorithm, ("label",), where)
    place = (*where, "spec")
    spec = values.table(algorithm["spec"], place)
    if "preset" in spec:
        spec = _table(spec, ("preset", "pop_size"), place, "the preset")
    elif planner_of(spec.get("algorithm")) is not None:
        spec = _planner(spec, place, "pop_size", "operators", "parameters")
    else:
        if isinstance(spec.get("algorithm"), Mapping):
            spec = _own_algorithm(spec, place)
        elif own.is_path(spec.get("algorithm")):
            raise StudyError(f"algorithm is {values.show(spec['algorithm'])}, expected what a plan says of it", place)
        elif isinstance(spec.get("algorithm"), str):
            _check_name(spec["algorithm"], (*place, "algorithm"))
        keys = ("algorithm", "pop_size", "smoothness", "operators", "parameters")
        spec = _table(spec, keys, place, "the algorithm")
        operators = _table(spec["operators"], ("base",), (*place, "operators"), "operators", tuple(SLOTS))
        for slot, single in operators.items():
            if slot != "base":
                _check_operator(slot, single, (*place, "operators", slot))
        kept = {slot: one for slot, one in operators.items() if slot == "base" or not own.is_path(one.get("class"))}
        spec["operators"] = kept
        values.table(spec["parameters"], (*place, "parameters"))
        values.told((*place, "pop_size"), check_pop_size, "an algorithm", spec["pop_size"])
    overrides = _table(algorithm["overrides"], (), (*where, "overrides"), "overrides", _OVERRIDES)
    for key, value in overrides.items():
        if value is None:
            raise StudyError(f"{key} is none, expected a change to the problem", (*where, "overrides", key))
    if "representation" in overrides:
        where_of = (*where, "overrides", "representation")
        overrides = {**overrides, "representation": _own_representation(overrides["representation"], where_of)}
    _at(place, make_spec, AlgorithmSpec, {**spec, **overrides}, ())
    return algorithm


def _check_name(name: str, where: Where) -> None:
    """Refuse what is no full name of an algorithm of this package: to look further could import what a plan names."""
    if name in CAPABILITIES:
        return
    for full in (*CAPABILITIES, *of_package(Planner)):
        if key_of(full) == key_of(name):
            raise StudyError(f"algorithm is {values.show(name)}, expected its full name, {full}", where)
    known = [row.name for row in CAPABILITIES.values() if not row.unfit]
    raise StudyError(f"there is no algorithm {values.show(name)}; {nearest(name, known)}", where)


def _check_groups(problems: list[dict[str, Any]]) -> None:
    """Refuse problems of one group that differ in more than their grid and query."""
    firsts: dict[str, Mapping[str, Any]] = {}
    for k, problem in enumerate(problems):
        spec = problem["spec"]
        first = firsts.setdefault(problem["group"], spec)
        for key in _SETTINGS:
            # Where obstacles are limited, the default penalty depends on the grid.
            if first[key] != spec[key] and key != "penalty":
                shown = values.show(spec[key])
                raise StudyError(f"{key} is {shown}, expected that of the others of its group", ("problems", k, "spec", key))
        if _clock(first) != _clock(spec):
            raise StudyError("moving has other epochs than those of its group", ("problems", k, "spec", "moving"))
        if ("random" in first["grid"]) != ("random" in spec["grid"]):
            raise StudyError("grid is of another kind than those of its group", ("problems", k, "spec", "grid"))


def _clock(spec: Mapping[str, Any]) -> tuple[int, int] | None:
    return (spec["moving"]["every"], moving.n_epochs(spec["moving"])) if "moving" in spec else None


def _check_limits(problems: list[dict[str, Any]], algorithms: list[Mapping[str, Any]]) -> None:
    """Refuse algorithms that limit the vulnerability in problems without saying to how much."""
    given = all(problem["spec"]["obstacles"] == "limit" for problem in problems)
    for k, algorithm in enumerate(algorithms):
        overrides = algorithm["overrides"]
        if overrides.get("obstacles") == "limit" and "potential_limit" not in overrides and not given:
            raise StudyError("obstacles 'limit' needs potential_limit beside it", ("algorithms", k, "overrides", "obstacles"))


def _check_runs(runs: list, n_problems: int, n_algorithms: int, has_reference: bool) -> None:
    seen: set[str] = set()
    for k, run in enumerate(runs):
        if not isinstance(run, list) or len(run) != 4 or not _is_key(run[0]):
            raise StudyError(f"a run is {values.show(run)}, expected its key, problem, algorithm and seed", ("runs", k))
        key, problem, algorithm, seed = run
        if key in seen:
            raise StudyError(f"the run {key} stands twice, expected each once", ("runs", k))
        seen.add(key)
        values.whole(problem, ("runs", k, "problem"), 0, n_problems - 1)
        values.whole(seed, ("runs", k, "seed"), 0, values.MAX_SEED)
        if algorithm is not None:
            values.whole(algorithm, ("runs", k, "algorithm"), 0, n_algorithms - 1)
        elif not has_reference:
            raise StudyError("a run has no algorithm, and the plan no reference", ("runs", k, "algorithm"))
