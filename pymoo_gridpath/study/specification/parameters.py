"""Further arguments of the algorithms, as a study gives them, with the values that pymoo takes without a word refused."""

from __future__ import annotations

from typing import Any

from pymoo_gridpath.algorithms import CAPABILITIES
from pymoo_gridpath.algorithms import arguments as _arguments
from pymoo_gridpath.algorithms.known import class_of
from pymoo_gridpath.errors import StudyError, nearest
from pymoo_gridpath.operators.sets import SLOTS
from pymoo_gridpath.planners.signature import parameters_of
from pymoo_gridpath.study.specification import own, values
from pymoo_gridpath.study.specification.kinds import ALGORITHM
from pymoo_gridpath.study.specification.operators import planner_of
from pymoo_gridpath.study.specification.values import MAX_POP_SIZE, Where

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
    "selection",
    "survival",
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
            _check(key, value, accepted[key], place)
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
    for key in given:
        if key in accepted and key in _ELSEWHERE and key != "smoothness":
            raise StudyError(f"{key} is set by {_ELSEWHERE[key]}, {_NOT_HERE}", (*where, key))
        if key in accepted and key in (*_NO_EFFECT, *_OBJECTS) and key not in theirs:
            why = "is an object of Python, which" if key in _OBJECTS else "changes no result, so that"
            raise StudyError(f"{key} {why} a study does not set", (*where, key))
    return own.read({"class": algorithm, **given}, ALGORITHM, where).arguments


def _check(key: str, value: Any, default: Any, where: Where) -> None:
    """Refuse a value that means nothing, or is of another type than the default."""
    if key in _arguments.NAMES:
        values.choice(value, _arguments.NAMES[key], where)
    elif key in _arguments.LEAST:
        values.whole(value, where, _arguments.LEAST[key], MAX_POP_SIZE)
    elif key in _arguments.SHARES or key == "adapt_freq":
        values.real(value, where, 0.0, 1.0, open_below=key == "adapt_freq")
    elif key in _OWN_CHECKS:
        _OWN_CHECKS[key](value, where)
    elif isinstance(default, bool):
        values.flag(value, where)
    elif isinstance(default, int):
        values.whole(value, where, 1)
    elif isinstance(default, str):
        values.text(value, where)
    else:
        values.real(value, where)


def _check_variant(value: Any, where: Where) -> None:
    bases, crossovers = _arguments.BASES_OF_VARIANTS, _arguments.CROSSOVERS_OF_VARIANTS
    match = _arguments.VARIANT.fullmatch(value) if isinstance(value, str) else None
    if match is None or match["base"] not in bases or match["crossover"] not in crossovers:
        number = match["n_diffs"] if match else "1"
        values.choice(value, [f"DE/{a}/{number}/{b}" for a in bases for b in crossovers], where)


def _check_scale(value: Any, where: Where) -> None:
    """Refuse what is neither a scale factor of differences nor a range that it is drawn from."""
    ends = value if isinstance(value, list) else [value, value]
    if not _are_numbers(ends) or len(ends) != 2 or not 0 <= ends[0] <= ends[1] <= 2 or ends[1] == 0:
        raise StudyError(
            f"{where[-1]} is {values.show(value)}, expected a number above 0, at most 2, or a range such as [0.2, 0.8]", where
        )


def _check_weights(value: Any, where: Where) -> None:
    if not _are_numbers(value) or min(value) < 0 or not any(value):
        raise StudyError(f"{where[-1]} is {values.show(value)}, expected one for each objective, such as [0.5, 0.5]", where)


def _check_points(value: Any, where: Where) -> None:
    if not _are_rows(value):
        raise StudyError(
            f"{where[-1]} is {values.show(value)}, expected points of a number for each objective, such as [[30, 5], [40, 2]]",
            where,
        )


def _check_directions(value: Any, where: Where) -> None:
    if not _are_rows(value) or any(min(row) < 0 or not any(row) for row in value):
        raise StudyError(
            f"{where[-1]} is {values.show(value)}, expected directions of a share for each objective, such as [[0, 1], [1, 0]]",
            where,
        )


def _are_rows(value: Any) -> bool:
    """Whether it is one or more lists of numbers, all as long as the first."""
    return isinstance(value, list) and len(value) > 0 and all(_are_numbers(row) and len(row) == len(value[0]) for row in value)


def _are_numbers(value: Any) -> bool:
    return isinstance(value, list) and len(value) > 0 and all(type(item) in (int, float) for item in value)


_OWN_CHECKS = {
    "variant": _check_variant,
    "F": _check_scale,
    "weights": _check_weights,
    "ref_points": _check_points,
    "ref_dirs": _check_directions,
}
