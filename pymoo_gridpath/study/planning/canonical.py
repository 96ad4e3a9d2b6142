"""The one form in which a study writes each problem and algorithm, so that what is the same has the same key.

Defaults are written out, or left out wherever they are given, so that a study that spells a default out means the same runs.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pymoo_gridpath.algorithms import CAPABILITIES
from pymoo_gridpath.algorithms.paper import PENALTY
from pymoo_gridpath.problems.grid_path import DEFAULT_PENALTY
from pymoo_gridpath.study.specification.kinds import SLOTS, is_monotone, is_of_paper, objective_name
from pymoo_gridpath.study.specification.operators import default_operator, planner_of

# What `path_operators` and `paper_operators` return, all with their default arguments; the mutation of the latter depends on
# the problem, so that "paper" stands for it.
_PATH: dict[str, str] = {
    "sampling": "ScalarizedSampling",
    "crossover": "SpliceCrossover",
    "mutation": "PathMutation",
    "repair": "PathRepair",
    "eliminate_duplicates": "RowDuplicates",
}
_PAPER = {"sampling": "RandomSampling", "repair": "EdgeFixing", "eliminate_duplicates": "RowDuplicates"}
_PAPER_CROSSOVERS = {"binary": "TwoPointCrossover", "mixed": "MixedCrossover"}


def settle(problem: Mapping[str, Any]) -> dict[str, Any]:
    """Return a problem with the default penalty of its obstacle handling written out."""
    settled = dict(problem)
    if settled["penalty"] is None and settled["obstacles"] == "penalty":
        settled["penalty"] = DEFAULT_PENALTY
    elif settled["penalty"] is None and settled["obstacles"] == "limit":
        settled["penalty"] = float(n_cells(settled["grid"]))
    return settled


def n_cells(grid: Mapping[str, Any]) -> int:
    """Return how many cells a grid in canonical form has."""
    return grid["random"]["size"] ** 2 if "random" in grid else grid["width"] * grid["height"]


def resolve(
    problem: Mapping[str, Any], algorithm: Mapping[str, Any], overrides: Mapping[str, Any]
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the problem and the algorithm of a run in canonical form.

    Parameters
    ----------
    problem : mapping
        `PlannedProblem.spec`.
    algorithm, overrides : mapping
        `PlannedAlgorithm.spec` and ``overrides``.

    Returns
    -------
    tuple of two dicts
        The problem with the overrides applied, and the algorithm with the defaults written out that depend on the problem.
    """
    if "preset" in algorithm:
        return _overridden(problem, _preset_overrides(problem, overrides)), dict(algorithm)
    changed = _overridden(problem, overrides)
    settled = dict(algorithm)
    if "smoothness" in settled and settled["smoothness"] is None:
        turns = "turn" in map(objective_name, changed["objectives"])
        settled["smoothness"] = CAPABILITIES[settled["algorithm"]].smoothness and not turns
    if "operators" in settled:
        settled["operators"] = _resolved_operators(settled["operators"], settled["algorithm"], changed["representation"])
    return changed, settled


def _overridden(problem: Mapping[str, Any], overrides: Mapping[str, Any]) -> dict[str, Any]:
    changed = dict(problem)
    if overrides.get("obstacles", problem["obstacles"]) != problem["obstacles"]:
        # They belong to the handling that is given up.
        changed |= {"penalty": None, "potential_limit": None}
    if "representation" in overrides and not is_monotone(overrides["representation"]):
        changed["axis"] = "auto"
    return settle(changed | dict(overrides))


def _preset_overrides(problem: Mapping[str, Any], overrides: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the paper's planner changes in a problem, see `ahmed_deb_2013`."""
    brought: dict[str, Any] = {}
    if not is_of_paper(problem["representation"]):
        brought["representation"] = "integer"
    if len(problem["objectives"]) == 1 and problem["obstacles"] == "penalty":
        brought["obstacles"] = "constraint"
    if {**problem, **brought, **overrides}["obstacles"] == "penalty":
        brought["penalty"] = PENALTY
    return brought | dict(overrides)


def _resolved_operators(given: Mapping[str, Any], algorithm: Any, representation: Any) -> dict[str, Any]:
    """Return every operator of an algorithm on problems of a representation; "paper" where `paper_operators` decides."""
    base = given["base"]
    if base == "default":
        base = "paper" if is_of_paper(representation) else "scalarized"
    if not isinstance(algorithm, str):
        slots = algorithm["slots"]
    else:
        # Differential evolution makes its children itself.
        whole = planner_of(algorithm) is not None or CAPABILITIES[algorithm].takes_operators
        slots = list(SLOTS) if whole or given["base"] != "default" else ["sampling", "repair"]
    names: dict[str, str] = dict(_PATH)
    named = isinstance(representation, str)
    if base == "random":
        names["sampling"] = "ReachableSampling"
    elif base == "paper":
        # Of a coding of one's own, the problem decides.
        names = {**_PAPER, "crossover": _PAPER_CROSSOVERS.get(representation, "DiscreteSBX")} if named else {}
    found: dict[str, Any] = {slot: dict(default_operator(names[slot], slot)) if slot in names else "paper" for slot in slots}
    return found | {slot: dict(value) for slot, value in given.items() if slot != "base"}
