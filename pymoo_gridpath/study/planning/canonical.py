"""The one form in which a study writes each problem and algorithm, so that what is the same has the same key.

Defaults are written out, or left out wherever they are given, so that a study that spells a default out means the same runs.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pymoo_gridpath.algorithms import CAPABILITIES
from pymoo_gridpath.algorithms.paper import REPRESENTATION, paper_treatment
from pymoo_gridpath.grid import CornerCutting
from pymoo_gridpath.operators.sets import MEMBERS, default_set, paper_classes, path_classes
from pymoo_gridpath.problems.grid_path import default_penalty
from pymoo_gridpath.representations import Representation
from pymoo_gridpath.study.specification.kinds import is_monotone, is_of_paper, objective_name, of_package
from pymoo_gridpath.study.specification.operators import default_operator, planner_of

# How many neighbours a cell has where nothing is said: in all that was planned before it could be.
MOVES_UNLESS_SAID = 8


def settle(problem: Mapping[str, Any]) -> dict[str, Any]:
    """Return a problem with the default penalty of its obstacle handling written out."""
    settled = dict(problem)
    if settled["penalty"] is None:
        settled["penalty"] = default_penalty(settled["obstacles"], n_cells(settled["grid"]))
    return settled


def n_cells(grid: Mapping[str, Any]) -> int:
    """Return how many cells a grid in canonical form has."""
    return grid["random"]["size"] ** 2 if "random" in grid else grid["width"] * grid["height"]


def steps_of(grid: Mapping[str, Any]) -> dict[str, Any]:
    """Return the arguments by which a grid in canonical form has its steps."""
    content = grid.get("random", grid)
    return {"corner_cutting": content["corner_cutting"], "moves": content.get("moves", MOVES_UNLESS_SAID)}


def settled_steps(corner_cutting: CornerCutting, moves: int) -> dict[str, Any]:
    """Return what the canonical form of a grid says of its steps: of their number, only if it is another than usual."""
    return {"corner_cutting": corner_cutting} | ({} if moves == MOVES_UNLESS_SAID else {"moves": moves})


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
        # Each would bring its own.
        given = {"selection", "survival"} & settled["operators"].keys()
        settled["smoothness"] = CAPABILITIES[settled["algorithm"]].smoothness and not turns and not given
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
        brought["representation"] = REPRESENTATION
    # "penalty" is what a problem has unless it says otherwise.
    asked = overrides.get("obstacles", problem["obstacles"] if problem["obstacles"] != "penalty" else None)
    obstacles, penalty = paper_treatment(len(problem["objectives"]), asked, overrides.get("penalty"))
    if obstacles != problem["obstacles"]:
        brought["obstacles"] = obstacles
    if penalty is not None:
        brought["penalty"] = penalty
    return brought | dict(overrides)


def _resolved_operators(given: Mapping[str, Any], algorithm: Any, representation: Any) -> dict[str, Any]:
    """Return every operator of an algorithm on problems of a representation; "paper" where `paper_operators` decides."""
    base = given["base"]
    if base == "default":
        base = default_set(is_of_paper(representation))
    if not isinstance(algorithm, str):
        slots = algorithm["slots"]
    else:
        # Differential evolution makes its children itself.
        whole = planner_of(algorithm) is not None or CAPABILITIES[algorithm].takes_operators
        slots = list(MEMBERS) if whole or given["base"] != "default" else ["sampling", "repair"]
    if base != "paper":
        classes = path_classes(base)
    elif isinstance(representation, str):
        # All have their defaults, but for the rate of the mutation: the problem decides.
        classes = {
            slot: cls for slot, cls in paper_classes(of_package(Representation)[representation]).items() if slot != "mutation"
        }
    else:
        # Of a coding of one's own, the problem decides on all.
        classes = {}
    names = {slot: cls.__name__ for slot, cls in classes.items()}
    found: dict[str, Any] = {slot: dict(default_operator(names[slot])) if slot in names else "paper" for slot in slots}
    return found | {slot: dict(value) for slot, value in given.items() if slot != "base"}
