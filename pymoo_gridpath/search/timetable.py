"""The rule of steps in time: what obstacles of known motion leave of a grid's steps, and their potential, tick by tick."""

from __future__ import annotations

import numpy as np

from pymoo_gridpath.errors import GridError, UnreachableError
from pymoo_gridpath.fields import QUANTUM, obstacle_potential
from pymoo_gridpath.grid import Cell, OccupancyGrid
from pymoo_gridpath.neighbourhood import HEADINGS
from pymoo_gridpath.paths.timed import WAIT
from pymoo_gridpath.paths.trajectories import Trajectories
from pymoo_gridpath.search.moves import Moves, ending_in, uncut

# Cells times ticks: the tables of more would be of gigabytes.
_MOST_STATES = 2**25


def steps_between(grid: OccupancyGrid, moves: Moves, before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Return the legal steps and waits from one tick to the next.

    A step ends in a cell that is free at its end, meets no obstacle halfway, that is, exchanges no cells with one and crosses
    no one's way diagonally, and cuts no corner of what is there before or after it where corners may not be cut. A wait is a
    step that ends where it begins.

    Parameters
    ----------
    grid : OccupancyGrid
        What does not move.
    moves : Moves
        Its steps, of the whole grid.
    before, after : numpy.ndarray of int, shape (n, 2)
        The cells (x, y) of the obstacles at the two ticks.

    Returns
    -------
    numpy.ndarray of uint16, shape (n_cells,)
        Bit m is set where the step along heading m is legal, bit `WAIT` where a wait is.
    """
    free_after = ~occupied_at(grid, after)
    both = np.pad(free_after & ~occupied_at(grid, before), 1)
    legal = moves.legal.reshape(grid.shape) & ending_in(np.pad(free_after, 1)) & uncut(grid, both)
    # Who meets an obstacle halfway has the middle of the step in common with it.
    moved = np.abs(after - before).max(axis=1) == 1
    twice = (before[moved] + after[moved])[:, None] - HEADINGS
    x, y = np.moveaxis(twice // 2, 2, 0)
    k, m = np.nonzero((twice % 2 == 0).all(axis=2) & (x >= 0) & (x < grid.width) & (y >= 0) & (y < grid.height))
    np.bitwise_and.at(legal, (y[k, m], x[k, m]), ~(np.uint8(1) << m.astype(np.uint8)))
    return (legal | free_after.astype(np.uint16) << np.uint16(WAIT)).ravel()


def occupied_at(grid: OccupancyGrid, cells: np.ndarray) -> np.ndarray:
    """Return which cells of a grid are occupied, by what does not move or by obstacles in cells (x, y), bool, shape (h, w)."""
    x, y = cells.T
    inside = (x >= 0) & (x < grid.width) & (y >= 0) & (y < grid.height)
    occupied = grid.occupied.copy()
    occupied[y[inside], x[inside]] = True
    return occupied


def potential_at(grid: OccupancyGrid, cells: np.ndarray, variance: float) -> np.ndarray:
    """Return the potential of all obstacles, of which some are in cells (x, y), in units of `QUANTUM`, int64, (n_cells,)."""
    potential = obstacle_potential(grid.replace(occupied=occupied_at(grid, cells)), variance)
    return np.rint(potential.ravel() / QUANTUM).astype(np.int64)


class Timetable:
    """What obstacles of known motion leave of the steps on a grid, for all ticks up to a horizon.

    Parameters
    ----------
    grid : OccupancyGrid
    movers : Trajectories
    horizon : int
        The last tick, T.

    Raises
    ------
    GridError
        If the grid has so many cells and the horizon so many ticks that the tables would take gigabytes.

    Attributes
    ----------
    moves : Moves
        The steps of the grid without the obstacles that move.
    at : numpy.ndarray of int64, shape (T + 1, n_movers, 2)
        Where these are.
    still : numpy.ndarray of uint16, shape (n_cells,)
        The steps and waits that would be legal without them, bits as of `steps_between`.
    legal : numpy.ndarray of uint16, shape (T, n_cells)
        Those that are, from each tick to the next.
    """

    def __init__(self, grid: OccupancyGrid, movers: Trajectories, horizon: int):
        if (states := (horizon + 1) * grid.occupied.size) > _MOST_STATES:
            raise GridError(
                f"{grid.occupied.size:,} cells and {horizon + 1:,} ticks are {states:,} together, expected at most "
                f"{_MOST_STATES:,}; crop the grid, or lower the horizon"
            )
        self.grid, self.horizon = grid, horizon
        self.moves = Moves(grid)
        self.at = movers.cells(horizon)
        nobody = np.empty((0, 2), dtype=np.int64)
        self.still = steps_between(grid, self.moves, nobody, nobody)
        self.legal = np.empty((horizon, grid.occupied.size), dtype=np.uint16)
        for tick in range(horizon):
            self.legal[tick] = steps_between(grid, self.moves, self.at[tick], self.at[tick + 1])
        self._potentials: dict[float, np.ndarray] = {}

    def potential(self, variance: float) -> np.ndarray:
        """Return the potential of all obstacles at each tick, in units of `QUANTUM`, int64, shape (T + 1, n_cells)."""
        if variance not in self._potentials:
            self._potentials[variance] = np.stack([potential_at(self.grid, cells, variance) for cells in self.at])
        return self._potentials[variance]

    @property
    def offsets(self) -> np.ndarray:
        """What each step, and a wait, adds to the index of a cell, int64, shape (9,)."""
        return np.append(self.moves.offsets, 0)

    def useful(self, start: Cell, goal: Cell) -> np.ndarray:
        """Return the legal steps that lie on a path from the start at tick 0 to the goal, where it ends, as `legal`.

        Raises
        ------
        UnreachableError
            If there is none: no path at all, or none that arrives by the horizon.
        """
        first, last = self.moves.index(start), self.moves.index(goal)
        if (on := np.flatnonzero((self.at[0] == start).all(axis=1))).size:
            raise UnreachableError(f"at tick 0 mover {on[0]} is on the start {start}, expected it elsewhere")
        useful = self.legal.copy()
        useful[:, last] = 0
        reached = np.zeros(self.legal.shape[1], dtype=bool)
        reached[first] = True
        arrives = False
        for tick, steps in enumerate(useful):
            steps[~reached] = 0
            if not steps.any() and not arrives:
                raise UnreachableError(f"no legal path: wherever the path could be, an obstacle comes by tick {tick + 1}")
            reached = np.zeros_like(reached)
            for m, offset in enumerate(self.offsets):
                reached[np.flatnonzero(steps >> np.uint16(m) & 1) + offset] = True
            arrives |= bool(reached[last])
        if not arrives:
            raise UnreachableError(
                f"gave up at the horizon, tick {self.horizon}: no path arrives by then; a later one may let one arrive"
            )
        leads = np.zeros_like(reached)
        leads[last] = True
        for steps in useful[::-1]:
            kept = np.zeros_like(steps)
            for m, offset in enumerate(self.offsets):
                cells = np.flatnonzero(steps >> np.uint16(m) & 1)
                kept[cells[leads[cells + offset]]] |= np.uint16(1 << m)
            steps[:] = kept
            leads = kept > 0
            leads[last] = True
        return useful
