"""Paths among obstacles of known motion: a cell a tick."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.fields import QUANTUM
from pymoo_gridpath.neighbourhood import HEADING_OF
from pymoo_gridpath.paths.base import Paths, check_chosen, check_place
from pymoo_gridpath.paths.sequences import Sequences

#: The number of a wait among the headings of steps.
WAIT = 8

# The number of a step at [dy + 1, dx + 1].
_STEP_OF = HEADING_OF.copy()
_STEP_OF[1, 1] = WAIT


class TimedCellPaths(Paths):
    """N paths given by their cell at each tick; a cell twice in a row is a wait, and a path ends when it reaches the goal.

    Measures of cells and steps are those of `Paths`, where waits are no steps; `arrival` and `vulnerability` know of time, and
    so does `interfering_cells`. `TimedPaths` decodes rows of genes to them.

    Parameters
    ----------
    timetable : Timetable
        The legal steps from each tick to the next, with ``grid``, ``horizon``, ``still``, ``legal``, ``at`` and ``potential``.
    rows : numpy.ndarray of int64, shape (N, horizon + 1)
        Indices of cells, ``y * width + x``, of which the last is the goal.
    goal : int
        Its index.
    """

    def __init__(self, timetable: Any, rows: np.ndarray, goal: int):
        self.grid, self.timetable, self.rows, self.goal = timetable.grid, timetable, rows, goal

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, index) -> TimedCellPaths:
        """Return the paths at a slice, a mask or an array of indices."""
        return TimedCellPaths(self.timetable, self.rows[check_chosen(index, len(self))], self.goal)

    @functools.cached_property
    def _walked(self) -> tuple[np.ndarray, np.ndarray]:
        return walked(self.rows, self.grid.width, self.goal, self.timetable.still, self.timetable.legal, _STEP_OF)

    @property
    def arrival(self) -> np.ndarray:
        """The tick at which each path first visits the goal, int64, shape (N,)."""
        return self._walked[0]

    @functools.cached_property
    def visits(self) -> Sequences:
        """The cells of the paths at each tick from 0 to the arrival, waits included."""
        offsets = np.concatenate([[0], np.cumsum(self.arrival + 1)])
        return Sequences(self.rows[np.arange(self.rows.shape[1]) <= self.arrival[:, None]], offsets)

    @functools.cached_property
    def sequences(self) -> Sequences:
        """The cells that the paths visit, in order, none following itself, as `Sequences`."""
        cells, offsets = self.visits
        moved = np.ones(len(cells), dtype=bool)
        np.not_equal(cells[1:], cells[:-1], out=moved[1:])
        moved[offsets[:-1]] = True
        return Sequences(cells[moved], np.concatenate([[0], np.cumsum(moved)])[offsets])

    def vulnerability(self, variance: float) -> np.ndarray:
        """Return the sum, over all ticks from 0 to the arrival, of the potential of all obstacles at that tick, (N,)."""
        return summed(self.rows, self.arrival, self.timetable.potential(variance)) * QUANTUM

    @functools.cached_property
    def interfering_cells(self) -> np.ndarray:
        """Number of occupied cells that each path crosses, int, shape (N,); a legal path has 0, and no other has.

        Besides those of `Paths`, a step or a wait counts one that an obstacle bars which moves, see `Timetable`.
        """
        return Paths.interfering_cells.fget(self) + self._walked[1]  # pyright: ignore[reportOptionalCall]

    @property
    def mover_distance(self) -> np.ndarray:
        """Least distance of a path's cell from that of an obstacle that moves, at the same tick, in cells, float, (N,)."""
        at = self.timetable.at
        found = np.full(len(self), np.inf)
        if not at.shape[1]:
            return found
        x, y = self.rows % self.grid.width, self.rows // self.grid.width
        on_grid = ((at >= 0) & (at < (self.grid.width, self.grid.height))).all(axis=2)
        under_way = np.arange(self.rows.shape[1]) <= self.arrival[:, None]
        for k in range(at.shape[1]):
            apart = np.hypot(x - at[:, k, 0], y - at[:, k, 1])
            found = np.minimum(found, np.where(under_way & on_grid[:, k], apart, np.inf).min(axis=1, initial=np.inf))
        return found

    def cells(self, index: int) -> np.ndarray:
        """Return the grid cell (x, y) of one path at each tick from 0 to its arrival, int, shape (arrival + 1, 2)."""
        index = check_place(index, len(self))
        row = self.rows[index, : self.arrival[index] + 1]
        return np.stack([row % self.grid.width, row // self.grid.width], axis=-1)


@kernel
def walked(rows, width, goal, still, legal, step_of):
    """Return the arrival of each path, and how many of its steps and waits are legal but for obstacles that move."""
    n, horizon = len(rows), len(legal)
    arrival, barred = np.empty(n, dtype=np.int64), np.zeros(n, dtype=np.int64)
    for i in range(n):
        tick = 0
        cell = rows[i, 0]
        while cell != goal and tick < horizon:
            other = rows[i, tick + 1]
            dx, dy = other % width - cell % width, other // width - cell // width
            if abs(dx) <= 1 and abs(dy) <= 1:
                barred[i] += ((still[cell] & ~legal[tick, cell]) >> step_of[dy + 1, dx + 1]) & 1
            cell = other
            tick += 1
        arrival[i] = tick
    return arrival, barred


@kernel
def summed(rows, arrival, table):
    """Return the sum of what a table by [tick, cell] holds for each path, from tick 0 to its arrival, int64, shape (N,)."""
    total = np.zeros(len(rows), dtype=np.int64)
    for i in range(len(rows)):
        for tick in range(arrival[i] + 1):
            total[i] += table[tick, rows[i, tick]]
    return total
