"""Grids, problems, algorithms and terminations from their canonical form, in whatever process a run takes place."""

from __future__ import annotations

import json
import math
import zlib
from collections import OrderedDict
from collections.abc import Mapping
from typing import Any

import numpy as np
from pymoo.algorithms.moo.rvea import RVEA
from pymoo.core.algorithm import Algorithm
from pymoo.core.termination import Termination
from pymoo.termination.max_eval import MaximumFunctionCallTermination
from pymoo.termination.max_gen import MaximumGenerationTermination

from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.operators import paper_operators
from pymoo_gridpath.problems import GridPathProblem, random_dense_grid
from pymoo_gridpath.representations import Representation, make_representation
from pymoo_gridpath.study.planning.canonical import settled_steps, steps_of
from pymoo_gridpath.study.planning.moving import build_moving, fresh
from pymoo_gridpath.study.specification import made, own
from pymoo_gridpath.study.specification.kinds import ALGORITHM, OBJECTIVE, REPRESENTATION
from pymoo_gridpath.study.specification.operators import make_operator, planner_of

# Problems that a process keeps, since many runs share one.
KEPT_PROBLEMS = 4

_problems: OrderedDict[str, GridPathProblem] = OrderedDict()


def pack_grid(grid: OccupancyGrid) -> tuple[dict[str, Any], bytes]:
    """Return the canonical form of a grid that came from a map, and its cells.

    Returns
    -------
    dict
        ``digest`` (see `OccupancyGrid.digest`), ``width``, ``height``, ``corner_cutting``, ``moves`` if these are not 8, and
        ``resolution`` if the map states it; names and poses change no result.
    bytes
        The cells, eight a byte, compressed.
    """
    spec = {"digest": grid.digest, "width": grid.width, "height": grid.height}
    spec |= settled_steps(grid.corner_cutting, grid.moves)
    if grid.resolution is not None:
        spec["resolution"] = grid.resolution
    return spec, zlib.compress(np.packbits(grid.occupied).tobytes())


def place_of_grid(grid: OccupancyGrid) -> tuple[dict[str, Any] | None, bytes | None]:
    """Return what of a grid that came from a map changes no result, but what pages show of paths, and its original's cells.

    Returns
    -------
    dict or None
        ``origin`` if it is not 0; of a grid whose obstacles grew also ``robot_radius``, ``footprint``, and the digest of the
        ``original``.
    bytes or None
        The cells of the original, packed as `pack_grid` does, if obstacles grew.
    """
    place: dict[str, Any] = {"origin": list(grid.origin)} if any(grid.origin) else {}
    if grid.original is grid:
        return place or None, None
    corners = None if grid.footprint is None else [list(corner) for corner in grid.footprint]
    place |= {"robot_radius": grid.robot_radius, "footprint": corners, "original": grid.original.digest}
    return place, pack_grid(grid.original)[1]


def placed(grid: OccupancyGrid, place: Mapping[str, Any], original: bytes | None) -> OccupancyGrid:
    """Return a grid with what `place_of_grid` said of it; without the cells of the original it has grown from nothing.

    Raises
    ------
    GridPathError
        If the cells of the original are those of another grid.
    """
    grid = grid.replace(origin=place.get("origin", grid.origin))
    if "original" not in place or original is None:
        return grid
    before = grid.replace(occupied=_unpacked(original, grid.shape))
    if before.digest != place["original"]:
        raise GridPathError("the cells of the map before it grew are not those that were planned with")
    return grid.grown_from(before, place["robot_radius"], place["footprint"])


def _unpacked(cells: bytes, shape: tuple[int, int]) -> np.ndarray:
    packed = np.frombuffer(zlib.decompress(cells), dtype=np.uint8)
    return np.unpackbits(packed, count=shape[0] * shape[1]).reshape(shape).astype(bool)


def build_grid(spec: Mapping[str, Any], cells: bytes | None = None) -> OccupancyGrid:
    """Return the grid that a canonical form describes.

    Parameters
    ----------
    spec : mapping
        ``{"random": ...}``, or what `pack_grid` returned.
    cells : bytes, optional
        What `pack_grid` returned; random grids need none.

    Raises
    ------
    GridPathError
        If the cells are missing or are those of another grid.
    """
    if "random" in spec:
        family = spec["random"]
        return random_dense_grid(family["size"], family["p0"], family["seed"]).replace(
            resolution=spec.get("resolution"), **steps_of(spec)
        )
    if cells is None:
        raise GridPathError("the cells of the map are missing, expected those that were planned with")
    grid = OccupancyGrid(_unpacked(cells, (spec["height"], spec["width"])), spec.get("resolution"), **steps_of(spec))
    if grid.digest != spec["digest"]:
        raise GridPathError("the cells of the map are not those that were planned with")
    return grid


def build_problem(
    problem: Mapping[str, Any],
    grid: bytes | None = None,
    place: Mapping[str, Any] | None = None,
    original: bytes | None = None,
) -> GridPathProblem:
    """Return the problem that a canonical form describes; the last few are kept, and must not be changed.

    One whose obstacles move has a time of its own, and begins with the first epoch.

    Parameters
    ----------
    problem : mapping
        `Task.problem`.
    grid : bytes, optional
        `Task.grid`.
    place, original : optional
        Those of a `PlannedProblem`, which no run asks for.

    Raises
    ------
    GridPathError
        As `GridPathProblem`.
    """
    key = json.dumps([problem, place, original is None], sort_keys=True)
    kept = _problems.get(key)
    if kept is None:
        cells = build_grid(problem["grid"], grid)
        if place is not None:
            cells = placed(cells, place, original)
        objectives = [one if isinstance(one, str) else own.make(one, OBJECTIVE) for one in problem["objectives"]]
        kept = (build_moving if "moving" in problem else _build_still)(problem, cells, objectives)
        _problems[key] = kept
        while len(_problems) > KEPT_PROBLEMS:
            _problems.popitem(last=False)
    return fresh(kept)


def _build_still(problem: Mapping[str, Any], grid: OccupancyGrid, objectives: list) -> GridPathProblem:
    settings = {name: problem[name] for name in ("obstacles", "penalty", "potential_limit")}
    query = problem["start"], problem["goal"]
    representation, axis = problem["representation"], problem["axis"]
    if not isinstance(representation, str):
        if representation["arguments"]:
            representation, axis = build_representation(representation, grid, *query, axis), "auto"
        else:
            # As a class, which is told of the objectives if it asks.
            representation = own.class_of(representation, REPRESENTATION)
    return GridPathProblem(grid, *query, representation, objectives, axis=axis, **settings)


def build_representation(content: Any, grid: OccupancyGrid, start, goal, axis: Any) -> Representation:
    """Return a representation in canonical form for a query on a grid."""
    if isinstance(content, str):
        return make_representation(content, grid, start, goal, axis)
    if not content["arguments"]:
        return make_representation(own.class_of(content, REPRESENTATION), grid, start, goal, axis)
    if not content["monotone"] and axis != "auto":
        raise GridPathError(f"axis is {axis!r}, but paths of {own.shown(content)} advance along none; expected 'auto'")
    return own.make(content, REPRESENTATION, grid, start, goal, **({"axis": axis} if content["monotone"] else {}))


def build_algorithm(algorithm: Mapping[str, Any], problem: GridPathProblem) -> Algorithm:
    """Return a new algorithm that a canonical form describes, for a problem.

    Raises
    ------
    GridPathError
        As `make_algorithm`.
    """
    from pymoo_gridpath.algorithms import ahmed_deb_2013, make_algorithm

    if "preset" in algorithm:
        setup: Any = ahmed_deb_2013(
            problem.grid,
            problem.start,
            problem.goal,
            # As an object, so that it is not made again.
            representation=problem.representation,  # pyright: ignore[reportArgumentType]
            objectives=problem.objectives,
            pop_size=algorithm["pop_size"],
            penalty=None if problem.obstacles == "constraint" else problem.penalty,
            obstacles=problem.obstacles,
            potential_limit=problem.potential_limit,
        )
        return setup.algorithm
    given = {key: value for key, value in algorithm.items() if key not in ("algorithm", "parameters")}
    if "operators" in given:
        given["operators"] = _operators(given["operators"], problem)
    named = algorithm["algorithm"]
    if not isinstance(named, str):
        named = made.build(named) if "made" in named else own.class_of(named, ALGORITHM)
    return make_algorithm(named, problem, **given, **algorithm.get("parameters", {}))


def build_planner(algorithm: Mapping[str, Any], problem: GridPathProblem, **most: float) -> tuple[Any, bool]:
    """Return a new planner with budgets of no more than is said, and whether it takes any of these.

    Parameters
    ----------
    algorithm : mapping
        The canonical form of a planner.
    problem : GridPathProblem
    **most : float
        Such as ``max_seconds``; planners that do not take it are made without.
    """
    named = algorithm["algorithm"]
    planner: Any = planner_of(named) or own.class_of(named, ALGORITHM)
    # What is not of this package has them among its parameters.
    given = dict(algorithm if isinstance(named, str) else algorithm["parameters"])
    taken = {key: value for key, value in most.items() if key in planner.parameters()}
    for key, value in taken.items():
        given[key] = value if given.get(key) is None else min(given[key], value)
    content = given if isinstance(named, str) else {**algorithm, "parameters": given}
    return build_algorithm(content, problem), bool(taken)


def _operators(specs: Mapping[str, Any], problem: GridPathProblem) -> dict[str, Any]:
    paper = paper_operators(problem) if "paper" in specs.values() else {}
    return {slot: paper[slot] if spec == "paper" else make_operator(slot, spec) for slot, spec in specs.items()}


def build_termination(budget: Mapping[str, int], algorithm: Algorithm | None = None) -> Termination:
    """Return the termination of ``{"evaluations": n}`` or ``{"generations": n}``.

    Parameters
    ----------
    budget : mapping
    algorithm : pymoo.core.algorithm.Algorithm, optional
        What is to end so. RVEA has to know how many generations there will be, and of evaluations it would make a generation
        too few of them.
    """
    if "generations" in budget:
        return MaximumGenerationTermination(budget["generations"])
    if isinstance(algorithm, RVEA):
        return _EvaluationsOfGenerations(budget["evaluations"], algorithm)
    return MaximumFunctionCallTermination(budget["evaluations"])


class _EvaluationsOfGenerations(MaximumGenerationTermination):
    """End a run after a number of evaluations, and say beforehand how many generations these are."""

    def __init__(self, n_max_evals: int, algorithm: Any):
        # pymoo's RVEA leaves out the first generation.
        super().__init__(1 + math.ceil(max(n_max_evals - algorithm.pop_size, 0) / algorithm.n_offsprings))
        self.n_max_evals = n_max_evals

    def _update(self, algorithm: Any) -> float:
        return algorithm.evaluator.n_eval / self.n_max_evals
