"""What made a trade-off set: map, query, settings, seeds and versions, as plain data."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from pymoo_gridpath.checks import shown
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.grid import OccupancyGrid


def describe_source(grid: OccupancyGrid) -> dict:
    """Return what tells a map as it was read from others; ``unknown_cells`` is None where its format knows none."""
    return {
        "occupied_cells": grid.n_occupied,
        "unknown_cells": None if grid.unknown is None else int(np.count_nonzero(grid.unknown)),
        "sha256": grid.digest,
    }


def describe_problem(problem) -> dict:
    """Return ``map``, ``query`` and ``settings`` of a path problem as plain data."""
    grid, representation = problem.grid, problem.representation
    return {
        "map": {
            "name": grid.name,
            "width": grid.width,
            "height": grid.height,
            "resolution": grid.resolution,
            "origin": list(grid.origin),
            "corner_cutting": grid.corner_cutting,
            "moves": grid.moves,
            "occupied_cells": grid.n_occupied,
            "sha256": grid.digest,
            **_describe_growth(grid),
        },
        "query": {"start": list(problem.start), "goal": list(problem.goal)},
        "settings": {
            "problem": type(problem).__name__,
            "representation": representation.name,
            "axis": getattr(getattr(representation, "frame", None), "axis", None),
            "max_cells": representation.max_cells,
            **({} if representation.backtracking else {"backtracking": False}),
            "objectives": [{"name": f.name, **_scalars(f)} for f in problem.objectives],
            "obstacles": getattr(problem, "obstacles", None),
            "penalty": getattr(problem, "penalty", None),
            "potential_limit": getattr(problem, "potential_limit", None),
            # For each obstacle that moves its cell at each tick, (-9, -9) where it is nowhere.
            **({"movers": representation.timetable.at.swapaxes(0, 1).tolist()} if representation.timed else {}),
        },
    }


def _describe_growth(grid: OccupancyGrid) -> dict:
    """Return by what obstacles grew and what they were before, nothing of a grid on which none did."""
    if grid.original is grid:
        return {}
    return {"robot_radius": grid.robot_radius, "footprint": grid.footprint, "original": describe_source(grid.original)}


def describe_run(result) -> dict:
    """Return the algorithm of a pymoo Result, its parameters, operators, generations, evaluations and seed.

    What the Result does not tell is None. Of a planner, also whether it is complete, how it ended, and the budget that it had;
    and, as far as it has such, how near to the front it was to come, and is proven to.
    """
    algorithm = getattr(result, "algorithm", None)
    iterations = getattr(algorithm, "n_iter", None)
    mating = getattr(algorithm, "mating", None)
    operators = {
        "sampling": getattr(getattr(algorithm, "initialization", None), "sampling", None),
        "selection": getattr(mating, "selection", None),
        "crossover": getattr(mating, "crossover", None),
        "mutation": getattr(mating, "mutation", None),
        "repair": getattr(algorithm, "repair", None),
        "survival": getattr(algorithm, "survival", None),
    }
    return {
        "algorithm": None if algorithm is None else type(algorithm).__name__,
        "pop_size": getattr(algorithm, "pop_size", None),
        # pymoo counts the iteration that it would begin next.
        "generations": None if iterations is None else iterations - 1,
        "evaluations": getattr(getattr(algorithm, "evaluator", None), "n_eval", None),
        "seed": getattr(algorithm, "seed", None),
        **_search(result, algorithm),
        "operators": {
            role: {"name": type(operator).__name__, **_scalars(operator)}
            for role, operator in operators.items()
            if operator is not None
        },
    }


def _search(result, algorithm) -> dict:
    """Return how a planner ended and the budget that it had, nothing of other algorithms: their Results tell of no success."""
    success = getattr(result, "success", None)
    if not isinstance(success, bool):
        return {}
    certified, allowance = getattr(result, "certified", None), _scalars(getattr(algorithm, "allowance", None))
    return {
        # What comes near enough to a front is a success.
        "complete": getattr(getattr(algorithm, "found", None), "complete", success),
        "message": getattr(result, "message", ""),
        "budget": _scalars(getattr(algorithm, "budget", None)),
        **({"allowance": allowance} if any(allowance.values()) else {}),
        **({} if certified is None else {"certified": _scalars(certified)}),
    }


def plain(value) -> Any:
    """Return a value as what strict JSON can hold: numbers that are not finite become None, unknown objects their text."""
    try:
        return _plain(value)
    except RecursionError:
        raise GridPathError(f"{shown(value)} holds itself, expected plain data for a file") from None


def _plain(value):
    if isinstance(value, Mapping):
        return {
            str(key) if isinstance(key, str | int | float | None) else shown(key): _plain(item) for key, item in value.items()
        }
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, list | tuple | set | frozenset):
        return [_plain(item) for item in value]
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return str(value) if isinstance(value, Path) else shown(value)


def _scalars(thing) -> dict:
    """Return the public attributes of an object that are single numbers or words, pymoo's variables by their value."""
    found = {}
    for key, value in getattr(thing, "__dict__", {}).items():
        value = getattr(value, "value", value)
        if not key.startswith("_") and key != "name" and isinstance(value, bool | int | float | str | np.number):
            found[key] = plain(value)
    return found
