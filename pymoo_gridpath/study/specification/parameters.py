"""Further arguments of the algorithms, as a study gives them."""

from __future__ import annotations

from typing import Any

from pymoo_gridpath.algorithms import CAPABILITIES
from pymoo_gridpath.algorithms import arguments as _arguments
from pymoo_gridpath.algorithms.known import class_of
from pymoo_gridpath.errors import StudyError, nearest
from pymoo_gridpath.planners.signature import parameters_of
from pymoo_gridpath.registry import SLOTS
from pymoo_gridpath.study.specification import own, values
from pymoo_gridpath.study.specification.kinds import ALGORITHM
from pymoo_gridpath.study.specification.operators import planner_of
from pymoo_gridpath.study.specification.values import Where

# Arguments of pymoo's algorithms that are not for a study file to set.
_ELSEWHERE = {
    "seed": "the seeds of the study",
    "termination": "the budget of the study",
    "pop_size": "the key pop_size of the algorithm",
    "smoothness": "the key smoothness of the algorithm",
    **dict.fromkeys(SLOTS, "the key operators of the algorithm"),
}
# Those of planners.
_BUDGETS = ("max_seconds", "max_labels")
_NOT_HERE = "not among its parameters"
_NO_EFFECT = ("return_least_infeasible", "save_history", "verbose", "save_ps")
_OBJECTS = (
    "output",
    "display",
    "callback",
    "archive",
    "evaluator",
    "decomposition",
    "automated_dm",
    "ps",
    "watch",
)


def parameters(algorithm: str, given: Any, where: Where) -> dict[str, Any]:
    """Return further arguments of an algorithm, without those at their default.

    Raises
    ------
    StudyError
        If it takes no such argument, a study cannot set it, or the value is of another type than the default or means nothing.
    """
    given = values.table(given, where)
    accepted = accepted_parameters(algorithm)
    if own.is_path(algorithm):
        return _own_parameters(algorithm, given, accepted, where)
    free = [key for key in accepted if key not in (*_ELSEWHERE, *_BUDGETS, *_NO_EFFECT, *_OBJECTS)]
    found = {}
    for key, value in given.items():
        place = (*where, key)
        values.refuse_key_of_study(key, place, "the parameters of an algorithm")
        if key in _ELSEWHERE or (key in _BUDGETS and key in accepted):
            raise StudyError(f"{key} is set by {_ELSEWHERE.get(key, f'the key {key} of the algorithm')}, {_NOT_HERE}", place)
        if key in accepted and key in (*_NO_EFFECT, *_OBJECTS):
            why = "is an object of Python, which" if key in _OBJECTS else "changes no result, so that"
            raise StudyError(f"{key} {why} a study does not set; {algorithm} takes {', '.join(free) or 'nothing else'}", place)
        if key not in free:
            hint = nearest(key, free, "it takes") if free else "it takes none"
            raise StudyError(f"{algorithm} takes no parameter {values.show(key)}; {hint}", place)
        value = values.like(accepted[key], values.plain_json(value, place))
        if value != accepted[key] or isinstance(value, bool) is not isinstance(accepted[key], bool):
            values.told(place, _arguments.check_values, algorithm, {key: value}, accepted)
            found[key] = value
    return found


def accepted_parameters(algorithm: str) -> dict[str, Any]:
    """Return what the class of an algorithm or planner takes, with the defaults."""
    if own.is_path(algorithm):
        return parameters_of(own.read(algorithm, ALGORITHM, ("algorithm",)).cls)
    planner = planner_of(algorithm)
    if planner is not None:
        return planner.parameters()
    row = CAPABILITIES[algorithm]
    return _arguments.parameters(class_of(row), row.name)


def _own_parameters(algorithm: str, given: dict[str, Any], accepted: dict[str, Any], where: Where) -> dict[str, Any]:
    """Return arguments of an algorithm of others, who check the values of what they list themselves."""
    theirs = _arguments.own_parameters(own.read(algorithm, ALGORITHM, ("algorithm",)).cls)
    free = ("smoothness", *({"selection", "survival"} & theirs))
    for key in given:
        if key in accepted and key in _ELSEWHERE and key not in free:
            raise StudyError(f"{key} is set by {_ELSEWHERE[key]}, {_NOT_HERE}", (*where, key))
        if key in accepted and key in (*_NO_EFFECT, *_OBJECTS) and key not in theirs:
            why = "is an object of Python, which" if key in _OBJECTS else "changes no result, so that"
            raise StudyError(f"{key} {why} a study does not set", (*where, key))
    return own.read({"class": algorithm, **given}, ALGORITHM, where).arguments
