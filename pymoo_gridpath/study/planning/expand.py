"""From a study to its plan: maps read, queries and pairs checked, and every run given its key."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.algorithms import CAPABILITIES, find_algorithm
from pymoo_gridpath.algorithms.factory import DEFAULT_POP_SIZE
from pymoo_gridpath.algorithms.paper import POP_SIZE
from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.neighbourhood import neighbourhood_of
from pymoo_gridpath.planners import reference_planner
from pymoo_gridpath.problems import MovingObstaclesProblem
from pymoo_gridpath.study.planning import canonical
from pymoo_gridpath.study.planning.build import build_algorithm, build_grid, build_problem, build_representation
from pymoo_gridpath.study.planning.moving import budget_of
from pymoo_gridpath.study.planning.plan import (
    MAX_RUNS,
    Plan,
    PlannedAlgorithm,
    PlannedProblem,
    PlannedRun,
    has_own_budget,
    is_deterministic,
    run_key,
)
from pymoo_gridpath.study.planning.planned_problems import place_of, plan_problems, refuse
from pymoo_gridpath.study.planning.trial import Pair, one_of_each_kind, run_briefly
from pymoo_gridpath.study.specification import made, own
from pymoo_gridpath.study.specification.algorithm import AlgorithmSpec
from pymoo_gridpath.study.specification.kinds import ALGORITHM, algorithm_entry, flags_of, is_monotone, representation_entry
from pymoo_gridpath.study.specification.operators import operator_entry, own_budget, planner_of
from pymoo_gridpath.study.specification.study import Study

# Work, in cells, that checking the queries of a group for a path that advances column by column may take: about two seconds.
_CHECKED_CELLS = 8_000_000
_CELLS_A_CHECK = 8_000


def plan_study(study: Study) -> Plan:
    """Return every run of a study, once all that can be known before a run has been checked.

    Parameters
    ----------
    study : Study

    Raises
    ------
    StudyError
        If a map cannot be read, a query cannot be solved, an algorithm cannot solve a problem or stops with an error in its
        first two generations, or two of them are the same.

    Examples
    --------
    >>> study = Study(
    ...     problems=[{"random": {"size": 16, "p0": 0.2, "seeds": 3}}],
    ...     algorithms=[{"algorithm": "NSGA2"}, {"algorithm": "SPEA2"}],
    ...     seeds=5,
    ...     budget={"generations": 20},
    ... )
    >>> plan = plan_study(study)
    >>> len(plan.problems), len(plan.runs)  # 2 algorithms x 5 seeds and a reference for each problem
    (3, 33)
    """
    checks.instance("study", study, Study)
    problems, groups = plan_problems(study)
    reference = None if study.reference is False else {"algorithm": reference_planner(), **study.reference}
    algorithms = [_algorithm(spec, reference) for spec in study.algorithms]
    n_runs = sum(1 if is_deterministic(algorithm.spec) else len(study.seeds) for algorithm in algorithms) * len(problems)
    if n_runs > MAX_RUNS:
        raise study.error(f"the study has {n_runs:,} runs, expected at most {MAX_RUNS:,}", ("seeds",))
    _check_pairs(study, problems, groups, algorithms)
    runs = _runs(study, problems, algorithms)
    if reference is not None:
        problems, runs = _with_references(problems, groups, runs, reference)
    return Plan(study.name, study.budget or {}, study.target, tuple(problems), tuple(algorithms), tuple(runs), reference)


# -- algorithms ---------------------------------------------------------------------------------------------------------


def _algorithm(spec: AlgorithmSpec, reference: Mapping[str, Any] | None) -> PlannedAlgorithm:
    """Return the canonical form of an algorithm, but for the defaults that depend on the problem."""
    if spec.preset is not None:
        content: dict[str, Any] = {"preset": spec.preset, "pop_size": spec.pop_size or POP_SIZE}
    elif spec.is_made:
        flags = flags_of(own.read(spec.algorithm["class"], ALGORITHM, ("algorithm",)).cls, spec.algorithm)
        content = {"algorithm": made.entry_of(spec.algorithm, ALGORITHM, made=True, **flags)}
    elif (planner := planner_of(spec.algorithm)) is not None:
        budget = {key: getattr(spec, key) for key in own_budget(planner)}
        content = {"algorithm": spec.algorithm, **budget}
        if reference is not None and reference["algorithm"] == spec.algorithm and set(budget.values()) == {None}:
            content = dict(reference)
        if planner.takes_pop_size:
            content["pop_size"] = spec.pop_size or DEFAULT_POP_SIZE
        if planner.takes_operators:
            content["operators"] = _operators(spec.operators)
        if spec.parameters:
            content["parameters"] = spec.parameters
    elif own.is_path(spec.algorithm):
        entry = algorithm_entry(spec.algorithm, spec.parameters)
        content = {"algorithm": entry, "parameters": spec.parameters}
        if entry["pop_size"]:
            content["pop_size"] = spec.pop_size or DEFAULT_POP_SIZE
        if entry["slots"]:
            content["operators"] = _operators(spec.operators)
    else:
        content = {
            "algorithm": spec.algorithm,
            "pop_size": spec.pop_size or DEFAULT_POP_SIZE,
            "smoothness": spec.smoothness,
            "operators": _operators(spec.operators),
            "parameters": spec.parameters,
        }
    overrides = dict(spec.overrides)
    if "representation" in overrides:
        overrides["representation"] = representation_entry(overrides["representation"])
    return PlannedAlgorithm(spec.label, content, overrides)


def _operators(given: Mapping[str, Any]) -> dict[str, Any]:
    return {slot: value if slot == "base" else operator_entry(slot, value) for slot, value in given.items()}


def _check_pairs(study: Study, problems, groups: list[int], algorithms: list[PlannedAlgorithm]) -> None:
    """Build one problem of each group, and every algorithm on it, and try them, so that what fails does so before the runs."""
    pairs: list[Pair] = []
    first = {group: k for k, group in reversed(list(enumerate(groups)))}
    for group in sorted(first):
        planned = problems[first[group]]
        about = f"problem {planned.label!r}: "
        refuse(study, place_of(group), about, build_problem, planned.spec, planned.grid)
        members = [problems[k] for k in range(len(problems)) if groups[k] == group]
        checked = [planned.spec["representation"]]
        if is_monotone(planned.spec["representation"]):
            _check_advancing(study, place_of(group), members, planned.spec)
        for k, algorithm in enumerate(algorithms):
            where, about = ("algorithms", k), f"{algorithm.label!r} does not suit the problem {planned.label!r}: "
            content, settled = canonical.resolve(planned.spec, algorithm.spec, algorithm.overrides)
            if content["obstacles"] == "limit" and content["potential_limit"] is None:
                message = "obstacles 'limit' needs potential_limit, the largest vulnerability of a path, beside it"
                raise study.error(message, (*where, "obstacles"))
            suite = study.problems[group].made_suite()
            if suite is not None and not suite.backtracking and content["representation"] != planned.spec["representation"]:
                message = "it changes the representation, and paths of the suite do not backtrack, which only its own codes"
                raise study.error(f"{about}{message}", where)
            problem = refuse(study, where, about, build_problem, content, planned.grid)
            built = refuse(study, where, about, build_algorithm, settled, problem)
            _check_pop_size(study, k, built, settled)
            _check_promises(study, k, problem, settled, built)
            if not has_own_budget(settled):
                pairs.append(Pair(content, settled, planned.grid, planned.label, k))
            if content["representation"] not in checked and is_monotone(content["representation"]):
                checked.append(content["representation"])
                _check_advancing(study, where, members, content)
    for pair in one_of_each_kind(pairs):
        about = f"{algorithms[pair.index].label!r} fails on the problem {pair.label!r}: "
        refuse(study, ("algorithms", pair.index), about, run_briefly, pair)


def _check_advancing(study: Study, where, members: list[PlannedProblem], content: Mapping[str, Any]) -> None:
    """Refuse queries that no path can solve which advances column by column, as far as that can be told in little time."""
    if "random" in content["grid"] and not neighbourhood_of(**canonical.steps_of(content["grid"])).restricts:
        return
    grid = build_grid(members[0].spec["grid"], members[0].grid)
    most = max(1, _CHECKED_CELLS // (grid.occupied.size + _CELLS_A_CHECK))
    chosen = np.unique(np.linspace(0, len(members) - 1, min(most, len(members))).astype(int))
    for planned in (members[k] for k in chosen):
        if "random" in planned.spec["grid"]:
            grid = build_grid(planned.spec["grid"])
        start, goal = planned.spec["start"], planned.spec["goal"]
        about = f"problem {planned.label!r}: "
        refuse(study, where, about, build_representation, content["representation"], grid, start, goal, content["axis"])


def _check_pop_size(study: Study, k: int, built: Any, algorithm: Mapping[str, Any]) -> None:
    """Refuse a size of populations beside what decides about it."""
    given = algorithm.get("parameters", {})
    decided = [key for key in ("ref_dirs", "pop_per_ref_point") if key in given]
    if decided and study.algorithms[k].pop_size is not None and built.pop_size != algorithm["pop_size"]:
        raise study.error(
            f"pop_size is {algorithm['pop_size']}, but {decided[0]} makes it {built.pop_size}; leave pop_size out",
            ("algorithms", k, "pop_size"),
        )


def _check_promises(study: Study, k: int, problem, algorithm: Mapping[str, Any], built: Any) -> None:
    """Refuse what would run, but not as a study promises."""
    name = algorithm.get("algorithm")
    row: Any = CAPABILITIES.get(name) if isinstance(name, str) else None
    if isinstance(name, Mapping) and "made" in name:
        row = find_algorithm(type(built))
    if row is not None and problem.has_constraints() and not row.reproducible_constrained:
        raise study.error(
            f"{row.name} gives another result each time on problems with constraints, whatever the seed; "
            f"expected obstacles 'penalty', or another algorithm",
            ("algorithms", k),
        )
    most = None if isinstance(problem, MovingObstaclesProblem) else (study.budget or {}).get("evaluations")
    if most is not None and "pop_size" in algorithm and most < built.pop_size:
        raise study.error(
            f"pop_size is {built.pop_size}, expected at most the {most} evaluations of the budget",
            ("algorithms", k, "pop_size"),
        )


# -- runs ---------------------------------------------------------------------------------------------------------------


def _runs(study: Study, problems: list[PlannedProblem], algorithms: list[PlannedAlgorithm]) -> list[PlannedRun]:
    """Return every run, those of a problem together, so that a process that makes several builds it once."""
    runs: list[PlannedRun] = []
    seen: dict[str, PlannedRun] = {}
    for i, problem in enumerate(problems):
        for j, algorithm in enumerate(algorithms):
            content, settled = canonical.resolve(problem.spec, algorithm.spec, algorithm.overrides)
            budget = None if has_own_budget(settled) else budget_of(content, study.budget or {})
            for seed in (0,) if is_deterministic(settled) else study.seeds:
                run = PlannedRun(run_key(content, settled, budget, seed), i, j, seed)
                if run.key in seen:
                    raise _twins(study, problems, algorithms, seen[run.key], run)
                seen[run.key] = run
                runs.append(run)
    return runs


def _twins(study: Study, problems, algorithms, one: PlannedRun, other: PlannedRun):
    """Return the error of two runs that are the same."""
    assert one.algorithm is not None and other.algorithm is not None
    first, second = algorithms[one.algorithm].label, algorithms[other.algorithm].label
    if one.problem == other.problem:
        message = (
            f"{second!r} is the same on the problem {problems[one.problem].label!r} as {first!r} "
            f"({study.line(('algorithms', one.algorithm))}), so that it would be compared with itself"
        )
    else:
        message = (
            f"{second!r} makes the problem {problems[other.problem].label!r} the same as {problems[one.problem].label!r} "
            f"is to {first!r}, so that runs would count twice"
        )
    return study.error(message, ("algorithms", other.algorithm))


def _with_references(
    problems: list[PlannedProblem], groups: list[int], runs: list[PlannedRun], reference: Mapping[str, Any]
) -> tuple[list[PlannedProblem], list[PlannedRun]]:
    """Return the problems with the keys of their references, or why there are none, and the runs with these first."""
    why: dict[int, str] = {}
    for problem, group in zip(problems, groups, strict=True):
        if group not in why:
            why[group] = _why_none(problem, reference)
    keys = {
        k: run_key(problem.spec, reference, None, 0)
        for k, (problem, group) in enumerate(zip(problems, groups, strict=True))
        if not why[group]
    }
    wanted = set(keys.values())
    asked = {run.key: run for run in runs if run.key in wanted}
    first = [asked.get(key, PlannedRun(key, k, None, 0)) for k, key in keys.items()]
    problems = [replace(one, reference=keys.get(k), no_reference=why[groups[k]]) for k, one in enumerate(problems)]
    return problems, first + [run for run in runs if run.key not in asked]


def _why_none(planned: PlannedProblem, reference: Mapping[str, Any]) -> str:
    """Return why the algorithm of the references cannot solve a problem, as with four objectives; empty if it can."""
    planner: Any = planner_of(reference["algorithm"])
    try:
        planner.refuse(build_problem(planned.spec, planned.grid))
    except CapabilityError as error:
        return str(error)
    return ""
