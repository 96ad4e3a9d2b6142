"""The exact front of paths in time: arrival, length and vulnerability among obstacles whose motion is known."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.compiled import COMPILED, kernel
from pymoo_gridpath.errors import counted
from pymoo_gridpath.exact.budget import Budget, Meter
from pymoo_gridpath.exact.costs import OCTILE
from pymoo_gridpath.fields import QUANTUM, check_variance
from pymoo_gridpath.grid import SQRT2, OccupancyGrid, check_grid
from pymoo_gridpath.paths.trajectories import Trajectories
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.timetable import occupied_at, potential_at, steps_between

#: The length of a step along each heading, and of a wait.
_LENGTHS = np.append(OCTILE, 0)

# To eight neighbours, and a wait.
_STEPS = 9

# Labels that are gone on from before the budget is asked again.
_PART = 2**15 if COMPILED else 2**11


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
    n_labels, n_bytes : int
        The labels that were made, and the most bytes that they took at a time.
    """

    paths: list[np.ndarray]
    F: np.ndarray
    complete: bool
    message: str
    n_labels: int
    n_bytes: int


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
        Of the potential of all obstacles, in squared cells.
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
    variance = check_variance(variance)
    checks.instance("budget", budget, Budget, optional=True)
    meter = Meter(budget or Budget())
    moves = Moves(grid)
    first, last = moves.index(start), moves.index(goal)
    offsets = np.append(moves.offsets, 0)
    at = movers.cells(horizon)
    # Of the labels of all ticks: cell, parent, length, vulnerability.
    labels = [np.array([[first, -1, 0, potential_at(grid, at[0], variance)[first]]], dtype=np.int64)]
    n_before, ends = 0, np.empty((0, 4), dtype=np.int64)
    if occupied_at(grid, at[0]).flat[first]:
        labels[0] = labels[0][:0]
    for tick in range(1, horizon + 1):
        if not len(labels[-1]):
            break
        legal, potential = steps_between(grid, moves, at[tick - 1], at[tick]), potential_at(grid, at[tick], variance)
        made = _layer(meter, legal, offsets, potential, labels[-1], n_before, ends[:, 2:], last)
        if meter.message:
            break
        n_before += len(labels[-1])
        home = made[:, 0] == last
        if home.any():
            numbers = n_before + np.flatnonzero(home)
            more = np.column_stack([numbers, np.full(len(numbers), tick), made[home, 2:]])
            ends = np.concatenate([ends, more])
        labels.append(made)
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
    return TimedFront([paths[k] for k in order], F[order], complete, message, len(whole), meter.n_bytes)


def _scored(path: np.ndarray, arrival: int, vulnerability: int) -> tuple[float, float, float]:
    reach = np.abs(np.diff(path, axis=0))
    diagonal = int((reach.sum(axis=1) == 2).sum())
    straight = int((reach.sum(axis=1) == 1).sum())
    return float(arrival), straight + SQRT2 * diagonal, vulnerability * QUANTUM


def _layer(meter: Meter, legal, offsets, potential, labels: np.ndarray, n_before: int, ends: np.ndarray, goal: int):
    """Return the non-dominated labels of the next tick, int64, shape (n, 4); those at the goal lead no further.

    The meter, asked now and then, may end it early.
    """
    heads = np.full(len(legal), -1)
    made = np.empty((_STEPS * len(labels), 4), dtype=np.int64)
    following = np.full(len(made), -1)
    n = 0
    for begin in range(0, len(labels), _PART):
        n_labels = n_before + len(labels) + n
        meter.check(n_labels, labels.itemsize * (4 * n_labels + 5 * len(made)))
        if meter.message:
            break
        part = labels[begin : begin + _PART]
        n = _grow(legal, offsets, _LENGTHS, potential, part, n_before + begin, ends, goal, heads, made, following, n)
    made = made[:n]
    return made[made[:, 0] >= 0]


@kernel
def _grow(legal, offsets, lengths, potential, labels, n_before, ends, goal, heads, made, following, n):
    """Add the labels that follow from some to the ``n`` made already; return how many these are then, with dominated ones."""
    for i in range(len(labels)):
        cell = labels[i, 0]
        if cell == goal:
            continue
        for m in range(9):
            if not (legal[cell] >> m) & 1:
                continue
            other = cell + offsets[m]
            length = labels[i, 2] + lengths[m]
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
                if made[k, 2] <= length and made[k, 3] <= vulnerability:
                    dominated = True
                    break
                if made[k, 2] >= length and made[k, 3] >= vulnerability:
                    # Out of the list, and marked as no label.
                    made[k, 0] = -1
                    if last < 0:
                        heads[other] = following[k]
                    else:
                        following[last] = following[k]
                else:
                    last = k
                k = following[k]
            if dominated:
                continue
            made[n, 0] = other
            made[n, 1] = n_before + i
            made[n, 2] = length
            made[n, 3] = vulnerability
            following[n] = heads[other]
            heads[other] = n
            n += 1
    return n


def _traced(moves: Moves, labels: np.ndarray, number: int) -> np.ndarray:
    """Return the cells (x, y) of the path that a label ends."""
    cells = []
    while number >= 0:
        cells.append(labels[number, 0])
        number = int(labels[number, 1])
    return moves.cells(np.array(cells[::-1]))
