"""The exact front of paths in time: arrival, length and vulnerability among obstacles whose motion is known."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.errors import counted
from pymoo_gridpath.exact.budget import Budget, Meter
from pymoo_gridpath.exact.costs import OCTILE
from pymoo_gridpath.fields import QUANTUM, obstacle_potential
from pymoo_gridpath.grid import SQRT2, OccupancyGrid, check_grid
from pymoo_gridpath.neighbourhood import HEADINGS
from pymoo_gridpath.paths.trajectories import Trajectories
from pymoo_gridpath.search.moves import Moves, uncut

#: The length of a step along each heading, and of a wait.
_LENGTHS = np.append(OCTILE, 0)


class TimedFront(NamedTuple):
    """What `exact_timed_front` found.

    Attributes
    ----------
    paths : list of numpy.ndarray of int, each of shape (arrival + 1, 2)
        The cell (x, y) at each tick from 0 on, for each point; a cell twice in a row is a wait.
    F : numpy.ndarray of float, shape (N, 3)
        Arrival in ticks, length in cells, vulnerability; non-dominated, in ascending order.
    complete : bool
        Whether this is the whole front of the paths that arrive within the horizon.
    message : str
        How the search ended. Without a path within the horizon it gave up, which is not to say that there is none.
    n_labels : int
    """

    paths: list[np.ndarray]
    F: np.ndarray
    complete: bool
    message: str
    n_labels: int


def exact_timed_front(
    grid: OccupancyGrid, start, goal, movers: Trajectories, horizon: int, variance: float = 0.5, budget: Budget | None = None
) -> TimedFront:
    """Return the exact front of arrival, length and vulnerability of paths among obstacles that move.

    A step to a neighbouring cell or a wait takes one tick. A path may enter no cell that is occupied when it arrives there, and
    may not meet an obstacle halfway: to exchange cells with one, or to cross its way diagonally, is illegal. Where corners may
    not be cut, no obstacle may be beside a diagonal step before or after it. A path ends when it reaches the goal. The
    vulnerability is the sum, over all ticks from 0 to the arrival, of the potential of all obstacles at that tick.

    Parameters
    ----------
    grid : OccupancyGrid
        What does not move.
    start, goal : (int, int)
        Cells (x, y).
    movers : Trajectories
    horizon : int
        The last tick at which a path may arrive.
    variance : float, default 0.5
        Of the potential, see `obstacle_potential`.
    budget : Budget, optional

    Returns
    -------
    TimedFront

    Raises
    ------
    GridPathError
        If an argument is of another kind or out of its range, or the query cannot be solved on the still grid.

    Notes
    -----
    Labels are made layer by layer over the ticks; of those at a cell and tick the non-dominated ones are kept.
    """
    start, goal = check_grid(grid).check_query(start, goal)
    checks.instance("movers", movers, Trajectories)
    horizon = checks.whole("horizon", horizon, 1, 100_000)
    checks.instance("budget", budget, Budget, optional=True)
    meter = Meter(budget or Budget())
    moves = Moves(grid)
    first, last = moves.index(start), moves.index(goal)
    at = movers.cells(horizon)
    # Of the labels of all ticks: cell, parent, length, vulnerability.
    labels = [np.array([[first, -1, 0, 0]], dtype=np.int64)]
    occupied, potential = _tick(grid, at[0], variance)
    labels[0][0, 3] = potential[first]
    n_before, ends = 0, np.empty((0, 4), dtype=np.int64)
    if occupied[first]:
        labels[0] = labels[0][:0]
    for tick in range(1, horizon + 1):
        meter.check(n_before + len(labels[-1]), 32 * (n_before + len(labels[-1])))
        if meter.message or not len(labels[-1]):
            break
        after, potential = _tick(grid, at[tick], variance)
        barred = _barred(grid, at[tick - 1], at[tick], occupied, after)
        made = _layer(moves.legal & ~barred, moves.offsets, _LENGTHS, after, potential, labels[-1], n_before, ends[:, 2:], last)
        n_before += len(labels[-1])
        home = made[:, 0] == last
        if home.any():
            numbers = n_before + np.flatnonzero(home)
            more = np.column_stack([numbers, np.full(len(numbers), tick), made[home, 2:]])
            ends = np.concatenate([ends, more])
        labels.append(made)
        occupied = after
    whole = np.concatenate(labels)
    paths = [_traced(moves, whole, int(number)) for number in ends[:, 0]]
    F = np.array(
        [_scored(path, arrival, vulnerability) for path, (_, arrival, _, vulnerability) in zip(paths, ends, strict=True)]
    )
    F = F.reshape(-1, 3)
    order = np.lexsort(F.T[::-1])
    if meter.message:
        message = f"gave up, {meter.message}; {counted(len(F), 'point')} found"
    elif len(F):
        message = f"all {counted(len(F), 'point')} found that arrive by tick {horizon}"
    elif not len(labels[-1]):
        message = "no legal path: wherever the path could be, an obstacle comes"
    else:
        message = f"gave up at the horizon, tick {horizon}: no path arrives by then"
    complete = not meter.message and (len(F) > 0 or not len(labels[-1]))
    return TimedFront([paths[k] for k in order], F[order], complete, message, len(whole))


def _scored(path: np.ndarray, arrival: int, vulnerability: int) -> tuple[float, float, float]:
    reach = np.abs(np.diff(path, axis=0))
    diagonal = int((reach.sum(axis=1) == 2).sum())
    straight = int((reach.sum(axis=1) == 1).sum())
    return float(arrival), straight + SQRT2 * diagonal, vulnerability * QUANTUM


def _tick(grid: OccupancyGrid, cells: np.ndarray, variance: float) -> tuple[np.ndarray, np.ndarray]:
    """Return whether each cell is occupied, and the potential in units of `QUANTUM`, each of shape (n_cells,)."""
    x, y = cells.T
    inside = (x >= 0) & (x < grid.width) & (y >= 0) & (y < grid.height)
    occupied = grid.occupied.copy()
    occupied[y[inside], x[inside]] = True
    potential = obstacle_potential(grid.replace(occupied=occupied), variance)
    return occupied.ravel(), np.rint(potential.ravel() / QUANTUM).astype(np.int64)


def _barred(grid: OccupancyGrid, before, after, occupied, occupied_after) -> np.ndarray:
    """Return the steps that moving obstacles bar besides those into their cells, as bits, uint8, shape (n_cells,)."""
    barred = ~uncut(grid, np.pad(~(occupied | occupied_after).reshape(grid.shape), 1))
    # Who meets an obstacle halfway has the middle of the step in common with it.
    for (x0, y0), (x1, y1) in zip(before.tolist(), after.tolist(), strict=True):
        if max(abs(x1 - x0), abs(y1 - y0)) != 1:
            continue
        for m, (dx, dy) in enumerate(HEADINGS.tolist()):
            twice = x0 + x1 - dx, y0 + y1 - dy
            x, y = twice[0] // 2, twice[1] // 2
            if twice[0] % 2 == twice[1] % 2 == 0 and 0 <= x < grid.width and 0 <= y < grid.height:
                barred[y, x] |= np.uint8(1 << m)
    return barred.ravel()


@kernel
def _layer(legal, offsets, lengths, occupied, potential, labels, n_before, ends, goal):
    """Return the non-dominated labels of the next tick, int64, shape (n, 4); those at the goal lead no further."""
    heads = np.full(len(legal), -1)
    out = np.empty((9 * len(labels), 4), dtype=np.int64)
    following = np.full(9 * len(labels), -1)
    n = 0
    for i in range(len(labels)):
        cell = labels[i, 0]
        if cell == goal:
            continue
        for m in range(9):
            other = cell
            length = labels[i, 2] + lengths[m]
            if m < 8:
                if not (legal[cell] >> m) & 1:
                    continue
                other = cell + offsets[m]
            if occupied[other]:
                continue
            vulnerability = labels[i, 3] + potential[other]
            dominated = False
            # A path that has arrived is earlier, so that it dominates what is no better in the other two.
            for k in range(len(ends)):
                if ends[k, 0] <= length and ends[k, 1] <= vulnerability:
                    dominated = True
                    break
            if dominated:
                continue
            last = -1
            k = heads[other]
            while k >= 0:
                if out[k, 2] <= length and out[k, 3] <= vulnerability:
                    dominated = True
                    break
                if out[k, 2] >= length and out[k, 3] >= vulnerability:
                    # Out of the list, and marked as no label.
                    out[k, 0] = -1
                    if last < 0:
                        heads[other] = following[k]
                    else:
                        following[last] = following[k]
                else:
                    last = k
                k = following[k]
            if dominated:
                continue
            out[n, 0] = other
            out[n, 1] = n_before + i
            out[n, 2] = length
            out[n, 3] = vulnerability
            following[n] = heads[other]
            heads[other] = n
            n += 1
    kept = 0
    for k in range(n):
        if out[k, 0] >= 0:
            for j in range(4):
                out[kept, j] = out[k, j]
            kept += 1
    return out[:kept].copy()


def _traced(moves: Moves, labels: np.ndarray, number: int) -> np.ndarray:
    """Return the cells (x, y) of the path that a label ends."""
    cells = []
    while number >= 0:
        cells.append(labels[number, 0])
        number = int(labels[number, 1])
    return moves.cells(np.array(cells[::-1]))
