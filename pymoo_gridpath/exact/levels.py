"""Exact fronts with objectives of which a path's worst cell decides, such as the least clearance.

By such an objective a cell has a level, 0 for the best. The front of the other objectives among the cells of a level and
all better ones has every point of the whole front whose worst cell is of that level; searching all levels, from the last to
the first, finds all. Most are skipped: where the worst cell that any path of a front visits is of a better level, the fronts
of the levels in between are the same.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from pymoo_gridpath.exact.budget import Meter
from pymoo_gridpath.grid import Box, OccupancyGrid
from pymoo_gridpath.objectives import Objective, field_of, levels_of
from pymoo_gridpath.search import Moves
from pymoo_gridpath.search.bottleneck import best_level


class Known(Objective):
    """An objective of a problem with the costs that it has in a box of the grid, worked out once for all searches."""

    local = True

    def __init__(self, problem, number: int, box: Box):
        objective = problem.objectives[number]
        self.name, self.label, self.turn_cost = objective.name, objective.label, objective.turn_cost
        self._field, self._moves = problem._costs_in(number, box)

    def field(self, grid):
        return self._field

    def field_in(self, grid, box):
        return self._field

    def moves(self, grid):
        return self._moves


def cell_levels(objective: Objective, grid: OccupancyGrid, box: Box) -> np.ndarray:
    """Return the level of each cell of a box by an objective whose worst cell decides, int64, shape (n_cells,)."""
    field = field_of(objective, grid, box)
    assert field is not None
    return levels_of(objective, field).ravel()


def over_levels(
    levels: Sequence[np.ndarray],
    moves: Moves,
    usable: np.ndarray,
    ends: tuple[int, int],
    alone: bool,
    meter: Meter,
    search: Callable[[Moves, np.ndarray], list],
) -> list:
    """Return what is found in all the parts of a grid that have to be searched.

    Parameters
    ----------
    levels : sequence of numpy.ndarray, each of int64, shape (n_cells,)
        Of the cells by each objective whose worst cell decides.
    moves : Moves
    usable : numpy.ndarray of bool, shape (n_cells,)
        The cells that paths may visit.
    ends : (int, int)
        Indices of start and goal.
    alone : bool
        Whether there is no other objective and any path will do, so that the best level of the last of these is enough.
    meter : Meter
        Ends the sweep with the search under way.
    search : callable
        From moves and usable cells to a list of parts, each with ``paths`` among which is the front of the other objectives.
    """
    if not levels:
        return search(moves, usable)
    first, *rest = levels
    if alone and not rest:
        usable = usable & (first <= best_level(moves, first, *ends))
        return search(moves.within(usable), usable)
    found = []
    while True:
        parts = over_levels(rest, moves, usable, ends, alone, meter, search)
        found += parts
        worst = max((int(first[path].max()) for part in parts for path in part.paths), default=-1)
        usable = usable & (first < worst)
        moves = moves.within(usable)
        if meter.message or best_level(moves, first, *ends) < 0:
            return found
