"""What path-aware operators know of a problem."""

from __future__ import annotations

import weakref
from typing import Any

import numpy as np

from pymoo_gridpath.errors import CapabilityError, GridPathError
from pymoo_gridpath.objectives import Objective, avoiding_costs, field_of, moves_of, visiting_costs
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.representations.base import Representation, max_cells, representation_of
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.sequences import are_legal, mend
from pymoo_gridpath.search.terrain import FULL_WEIGHT, Terrain, make_terrain

# Made once for each problem, and anew when its map is another; kept apart from it, so that it pickles and compares as before.
_TERRAINS: weakref.WeakKeyDictionary[Any, tuple[Representation, Terrain, list[int]]] = weakref.WeakKeyDictionary()

# Weight of the length where it is no objective: of ways that cost the same, the shorter.
LEAST_WEIGHT = FULL_WEIGHT // 64


def terrain_of(problem) -> Terrain:
    """Return the terrain of a problem: the length, and what visiting each cell costs in its objectives.

    See `visiting_costs`, and `avoiding_costs` of those of which the worst cell decides.

    Raises
    ------
    GridPathError
        If the problem has no path representation, or one that does not code every path.
    """
    return _known_of(problem)[1]


def _known_of(problem) -> tuple[Representation, Terrain, list[int]]:
    """Return the representation and terrain of a problem, and the numbers of the terms that are objectives, at least one."""
    representation = representation_of(problem)
    if representation.timed:
        raise GridPathError(
            f"these operators know nothing of time, and the problem is of the class {type(problem).__name__}, expected those "
            f"of path_operators(problem)"
        )
    if not representation.codes_all:
        raise CapabilityError(
            f"path-aware operators make paths that the {representation.name} representation does not code, expected one that "
            f"codes every path, such as 'integer' or 'cells'; paper_operators are for the codings of the paper"
        )
    known = _TERRAINS.get(problem)
    if known is None or known[0] is not representation:
        moves = representation.moves
        start, goal = moves.index(representation.start), moves.index(representation.goal)
        fields = [_costs(objective, problem.grid, moves, start, goal) for objective in problem.objectives]
        terrain = make_terrain(moves, start, goal, [np.asarray(field) for field in fields if field is not None])
        terms = list(range(1, terrain.n_terms))
        # What tells straight steps from diagonal ones goes by the length.
        if not terms or any(isinstance(moves_of(objective, problem.grid), tuple) for objective in problem.objectives):
            terms.insert(0, 0)
        _TERRAINS[problem] = known = representation, terrain, terms
    return known


def _costs(objective: Objective, grid, moves: Moves, start: int, goal: int):
    """Return about what visiting each cell of the moves' box costs by an objective, or None."""
    if not objective.bottleneck:
        return visiting_costs(objective, grid, moves.box)
    field = field_of(objective, grid, moves.box)
    assert field is not None
    return avoiding_costs(objective, moves, start, goal, field)


def paths_of(problem, X: np.ndarray) -> Sequences:
    """Return the paths that rows of genes code; if some are illegal, all are mended."""
    representation, terrain = problem.representation, terrain_of(problem)
    paths = representation.to_sequences(X)
    if are_legal(paths, terrain).all():
        return paths
    return mend(paths, representation.moves, terrain.start, terrain.goal, max_cells(problem))


def random_weights(problem, n: int, random_state) -> np.ndarray:
    """Return random weights of the terms of a problem's terrain, uniform over the simplex, int64, shape (n, K)."""
    terms = objective_terms(problem)
    draws = random_state.standard_exponential((n, len(terms)))
    return whole_weights(problem, draws / draws.sum(axis=1, keepdims=True))


def objective_terms(problem) -> list[int]:
    """Return the numbers of the terms that are objectives, at least one."""
    return _known_of(problem)[2]


def whole_weights(problem, shares: np.ndarray) -> np.ndarray:
    """Return weights of all terms, int64, shape (N, K), from the shares of those that are objectives, (N, n_terms)."""
    weights = np.zeros((len(shares), terrain_of(problem).n_terms), dtype=np.int64)
    terms = objective_terms(problem)
    weights[:, terms] = np.rint(FULL_WEIGHT * shares)
    least = 1 if 0 in terms else LEAST_WEIGHT
    weights[:, 0] = np.maximum(weights[:, 0], least)
    # Every term counts, if only to choose among ways that are equal in the others.
    return np.maximum(weights, 1)
