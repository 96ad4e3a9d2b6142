"""A query on a grid as arrays that the route kernels read."""

from __future__ import annotations

import weakref
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from pymoo_gridpath.grid import SQRT2
from pymoo_gridpath.neighbourhood import DIAGONAL
from pymoo_gridpath.search.moves import Moves, taken_backwards
from pymoo_gridpath.search.shortest import UNREACHABLE, backward_costs

#: Weights of terms are whole numbers from 0 to this, 1 or more for the length.
FULL_WEIGHT = 1024

# The largest cost of a step in any term. With a full weight, the roughest noise (8 times) and a path of a million cells, sums
# stay below 2**61.
LARGEST_COST = 2**26

# A term that varies less than this over the extreme paths, relative to its least value, is scaled as if it varied as much.
LEAST_RANGE = 1e-3

# A cost that is so many times all lesser ones together, over all cells, stands for a prohibition.
PROHIBITIVE = 100.0

# Lesser costs that add up to less than this, relative to the largest one, are but the tail of a steep field.
LEAST_TAIL = 1e-30


class Terrain(NamedTuple):
    """The legal steps between a start and a goal, and what they cost in K terms: the length and K - 1 fields.

    Each term is scaled to whole numbers such that its range over the extreme paths is about the same as that of the others.

    Attributes
    ----------
    legal : numpy.ndarray of uint8, shape (n_cells,)
        As in `Moves`, without the steps to cells that lie on no path from the start to the goal.
    offsets : numpy.ndarray of int64, shape (8,)
        As in `Moves`.
    width, start, goal : int
        Width of the grid and indices of the two cells.
    straight, diagonal : int
        Cost of a step in term 0, 1 or more. Where the best paths of the terms differ a lot, these numbers may be so small that
        by them another path is the shortest than on a `plain_terrain`.
    square : bool
        Whether the grid has no diagonal steps.
    fields : numpy.ndarray of int64, shape (n_cells, K - 1)
        Cost of entering each cell in the other terms.
    bounds : numpy.ndarray of int64, shape (n_cells, 2 * K)
        Least cost in term k from each cell to the goal, in column 2 k, and from the start to each cell, in column 2 k + 1;
        `UNREACHABLE` where there is no path.
    """

    legal: np.ndarray
    offsets: np.ndarray
    width: int
    start: int
    goal: int
    straight: int
    diagonal: int
    square: bool
    fields: np.ndarray
    bounds: np.ndarray

    @property
    def n_terms(self) -> int:
        """Number of terms, K."""
        return self.fields.shape[1] + 1

    @property
    def useful(self) -> np.ndarray:
        """Whether each cell lies on a path from the start to the goal, shape (n_cells,)."""
        return (self.bounds[:, 0] < UNREACHABLE) & (self.bounds[:, 1] < UNREACHABLE)


# Terrains without fields, by what they are made of.
_PLAIN: weakref.WeakKeyDictionary[Moves, dict[tuple[int, int], Terrain]] = weakref.WeakKeyDictionary()


def plain_terrain(moves: Moves, start: int, goal: int) -> Terrain:
    """Return the terrain of a query without fields, made once."""
    made = _PLAIN.setdefault(moves, {})
    if (start, goal) not in made:
        made[start, goal] = make_terrain(moves, start, goal)
    return made[start, goal]


def make_terrain(moves: Moves, start: int, goal: int, fields: Sequence[np.ndarray] = ()) -> Terrain:
    """Return the terrain of a query.

    Parameters
    ----------
    moves : Moves
    start, goal : int
        Indices of two cells that a path joins.
    fields : sequence of numpy.ndarray, each of n_cells values
        Cost of entering each cell. Where some of the cells that paths visit have negative costs, all are raised by the same
        amount, such that the least is 0, since searches take no profit from a detour. Costs so large that they stand for a
        prohibition are lowered to what the cheapest path of all costs, and those that are not finite are taken for such.

    Returns
    -------
    Terrain
    """
    back = moves.backward()
    visited = steps_through(moves, start, goal) < UNREACHABLE if len(fields) else np.empty(0)
    straight, fields_ = _scaled(moves, start, goal, [_raised(np.ravel(field), visited) for field in fields])
    diagonal = round(SQRT2 * straight)
    bounds = np.empty((moves.n_cells, 2 * len(fields_) + 2), dtype=np.int64)
    for k, (step, field) in enumerate(_terms(straight, diagonal, fields_, moves.n_cells)):
        bounds[:, 2 * k] = _least_costs(moves, step, field, goal)
        # The other way round a path enters the start instead of its last cell.
        bounds[:, 2 * k + 1] = _least_costs(back, step, field, start) + field - field[start]
    bounds = np.minimum(bounds, UNREACHABLE)
    useful = (bounds[:, 0] < UNREACHABLE) & (bounds[:, 1] < UNREACHABLE)
    bounds[~useful] = UNREACHABLE
    stacked = np.stack(fields_, axis=1) if fields_ else np.zeros((moves.n_cells, 0), dtype=np.int64)
    return Terrain(
        moves.within(useful).legal,
        moves.offsets,
        moves.width,
        int(start),
        int(goal),
        straight,
        diagonal,
        not moves.diagonal,
        stacked,
        bounds,
    )


def _raised(field: np.ndarray, visited: np.ndarray) -> np.ndarray:
    """Return a field that is finite and not negative, and 0 in cells that no path visits."""
    known = visited & np.isfinite(field)
    cost = np.where(known, field, 0.0)
    cost[known] -= min(cost[known].min(initial=0.0), 0.0)
    # Not finite: more than all others together.
    cost[visited & ~known] = 2 * PROHIBITIVE * cost.sum() or 1.0
    return cost


def _bounded(cost: np.ndarray) -> tuple[np.ndarray, bool]:
    """Return a field without costs that would leave nothing of the others when scaled, and whether there were any.

    They become as large as all others together, so that no path is the better for meeting one.
    """
    values, counts = np.unique(cost[cost > 0.0], return_counts=True)
    below = np.cumsum(values * counts)[:-1]
    gaps = np.flatnonzero((values[1:] > PROHIBITIVE * below) & (below > LEAST_TAIL * values.max(initial=0.0)))
    return (cost, False) if len(gaps) == 0 else (np.minimum(cost, below[gaps[0]]), True)


def _scaled(moves: Moves, start: int, goal: int, costs: list[np.ndarray]) -> tuple[int, list[np.ndarray]]:
    """Return the cost of a straight step and the costs of cells as whole numbers of comparable ranges."""
    bounded = [_bounded(cost) for cost in costs]
    costs = [cost for cost, _ in bounded]
    # Each term's best path, found with every term on a coarse scale of its own.
    coarse = [np.rint(cost * (2.0**20 / _peak(cost))).astype(np.int64) for cost in costs]
    straight, diagonal = 2**20, round(SQRT2 * 2**20)
    paths = []
    for step, field in _terms(straight, diagonal, coarse, moves.n_cells):
        # A trace of the length keeps the best path from wandering where it costs nothing.
        paths.append(_best_path(moves, step + straight // 2**10, field, start, goal))
    for k, (cost, prohibits) in enumerate(bounded):
        if prohibits:
            # A cell as dear as a whole best path is avoided just as one that is dearer.
            costs[k] = np.minimum(cost, cost[paths[k + 1][1:]].sum())
    peaks = [SQRT2, *map(_peak, costs)]
    lengths = [np.where(_is_diagonal(cells, moves.width), SQRT2, 1.0).sum() for cells in paths]
    totals = np.column_stack([lengths, *([cost[cells[1:]].sum() for cells in paths] for cost in costs)])
    least, most = totals.min(axis=0), totals.max(axis=0)
    spans = np.maximum(most - least, LEAST_RANGE * np.maximum(most, np.array(peaks)))
    scale = LARGEST_COST / (np.array(peaks) / spans).max()
    # Every step costs something, however long the paths, so that none wander.
    return max(round(scale / spans[0]), 1), [
        np.rint(cost * (scale / span)).astype(np.int64) for cost, span in zip(costs, spans[1:], strict=True)
    ]


def _peak(cost: np.ndarray) -> float:
    return max(float(cost.max()), 1e-300)


def _terms(straight: int, diagonal: int, fields: list[np.ndarray], n_cells: int):
    """Yield the cost of steps, shape (9, 8), and of cells in each term."""
    steps = np.tile(np.where(DIAGONAL, diagonal, straight), (9, 1))
    yield steps, np.zeros(n_cells, dtype=np.int64)
    for field in fields:
        yield np.zeros_like(steps), field


def _least_costs(moves: Moves, step: np.ndarray, field: np.ndarray, goal: int) -> np.ndarray:
    """Return the least cost to the goal from every cell, shape (n_cells,)."""
    return backward_costs(moves, np.stack([step, 0 * step]), np.stack([field, 0 * field]), goal)[0][0]


def _best_path(moves: Moves, step: np.ndarray, field: np.ndarray, start: int, goal: int) -> np.ndarray:
    """Return the cells of a cheapest path."""
    cost = _least_costs(moves, step, field, goal)
    cells = [start]
    while cells[-1] != goal:
        headings = np.flatnonzero((moves.legal[cells[-1]] >> np.arange(8)) & 1)
        ahead = cells[-1] + moves.offsets[headings]
        cells.append(int(ahead[np.argmin(cost[ahead] + step[8, headings] + field[ahead])]))
    return np.array(cells)


def _is_diagonal(cells: np.ndarray, width: int) -> np.ndarray:
    return (np.diff(cells % width) != 0) & (np.diff(cells // width) != 0)


def steps_through(moves: Moves, start: int, goal: int) -> np.ndarray:
    """Return the fewest steps of a path from the start through each cell to the goal; `UNREACHABLE` or more for none."""
    back = moves.backward()
    step, nothing = np.ones((9, 8), dtype=np.int64), np.zeros(moves.n_cells, dtype=np.int64)
    return _least_costs(moves, step, nothing, goal) + _least_costs(back, step, nothing, start)


def backwards(terrain: Terrain) -> Terrain:
    """Return the terrain with every step taken backwards, for floods from the goal; its bounds do not hold."""
    return terrain._replace(legal=taken_backwards(terrain.legal, terrain.offsets), start=terrain.goal, goal=terrain.start)
