"""Problems of a study whose obstacles move: their canonical form, what is made of it, and how long their runs are."""

from __future__ import annotations

import contextlib
import copy
import warnings
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pymoo.core.callback import Callback

from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.objectives import Objective
from pymoo_gridpath.problems import GridPathProblem, MovingObstaclesProblem, ObstacleClock, random_dense_grid, random_movers
from pymoo_gridpath.study.specification import moving as specified
from pymoo_gridpath.study.specification.moving import REPRESENTATION, TREATMENT, MovingObstacles

# What a trial on a small grid is made among: one that moves with each generation.
_TRIED = {"n_movers": 1, "n_epochs": 2, "random_state": 1}


def moving_entry(spec: MovingObstacles, grid: OccupancyGrid, start: Sequence[int], goal: Sequence[int]) -> dict[str, Any]:
    """Return the obstacles that move on a grid in canonical form.

    Raises
    ------
    GridError
        If there is no room for so many.
    """
    if not isinstance(spec.movers, int):
        return specified.entry(spec.ways(), spec.every)
    assert spec.epochs is not None
    ways, _ = random_movers(grid, start, goal, spec.movers, spec.epochs, 1 if spec.seed is None else spec.seed)
    return specified.entry(ways, spec.every)


def build_moving(problem: Mapping[str, Any], grid: OccupancyGrid, objectives: Sequence[str | Objective]):
    """Return the problem that a canonical form with obstacles that move describes.

    Raises
    ------
    CapabilityError
        If an algorithm has changed in it what cannot be.
    GridPathError
        As `MovingObstaclesProblem`.
    """
    for key, fits in (("representation", REPRESENTATION), ("obstacles", TREATMENT)):
        if problem[key] != fits:
            found = problem[key] if isinstance(problem[key], str) else problem[key]["class"]
            raise CapabilityError(f"it asks for {key}={found!r}, and where obstacles move there is {fits!r} alone")
    movers, every = problem["moving"]["movers"], problem["moving"]["every"]
    return MovingObstaclesProblem(grid, movers, problem["start"], problem["goal"], every, objectives, problem["penalty"])


def fresh(problem: GridPathProblem) -> GridPathProblem:
    """Return a problem for one run: one whose obstacles move has a time of its own, and begins with the first epoch."""
    if not isinstance(problem, MovingObstaclesProblem):
        return problem
    own = copy.copy(problem)
    own.cache = {}
    own.restart()
    return own


def clock_of(problem: GridPathProblem, callback: Callback) -> Callback:
    """Return what to call after each generation: the callback, by a clock where obstacles move."""
    return ObstacleClock(callback=callback) if isinstance(problem, MovingObstaclesProblem) else callback


@contextlib.contextmanager
def quietly(problem: GridPathProblem) -> Iterator[None]:
    """Where obstacles move, let nobody be warned of genes that are no whole numbers: KGB makes them between others."""
    with warnings.catch_warnings():
        if isinstance(problem, MovingObstaclesProblem):
            warnings.filterwarnings("ignore", "genes that are no whole numbers")
        yield


def budget_of(problem: Mapping[str, Any], budget: Mapping[str, int]) -> dict[str, int]:
    """Return the budget of a run on a problem in canonical form: where obstacles move it ends with the last epoch."""
    return {"generations": specified.generations(problem["moving"])} if "moving" in problem else dict(budget)


def tried(problem: Mapping[str, Any], family: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """Return a problem in canonical form whose obstacles move in each generation, so that two generations see it.

    Parameters
    ----------
    problem : mapping
    family : mapping, optional
        The random grid that stands in for the problem's.
    """
    if family is None:
        return {**problem, "moving": {**problem["moving"], "every": 1}}
    grid = random_dense_grid(family["size"], family["p0"], family["seed"])
    ways, _ = random_movers(grid, problem["start"], problem["goal"], **_TRIED)
    return {**problem, "moving": specified.entry(ways, 1)}
