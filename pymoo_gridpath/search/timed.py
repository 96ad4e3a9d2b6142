"""Cheapest ways over cells and ticks, as kernels, and the terrain that they read."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.grid import SQRT2
from pymoo_gridpath.paths.timed import WAIT
from pymoo_gridpath.search.route import block_noise
from pymoo_gridpath.search.terrain import FULL_WEIGHT, LARGEST_COST, LEAST_RANGE

# No way costs as much.
_ENDLESS = np.int64(2**62)

# Blocks of equal noise are apart in time, too.
_NEXT_BLOCK = np.int64(0x1F123BB5)

#: The terms of the costs: ticks, length, and potential.
N_TERMS = 3


class TimedTerrain(NamedTuple):
    """The legal steps of a query in time, and what they cost in three terms: a tick, their length, and the potential.

    Attributes
    ----------
    legal : numpy.ndarray of uint16, shape (T, n_cells)
        Steps and waits that lie on a path of the query, see `Timetable.useful`: whoever follows them arrives.
    offsets : numpy.ndarray of int64, shape (9,)
        What each adds to the index of a cell.
    width, start, goal : int
        Width of the grid and indices of the two cells.
    tick, straight, diagonal : int
        Costs of a tick, in term 0, and of the two kinds of steps, in term 1.
    risk : numpy.ndarray of int64, shape (T + 1, n_cells)
        Cost of being in a cell at a tick, in term 2; of shape (1, 1) where it is not asked for.
    """

    legal: np.ndarray
    offsets: np.ndarray
    width: int
    start: int
    goal: int
    tick: int
    straight: int
    diagonal: int
    risk: np.ndarray


class TimedWork(NamedTuple):
    """What searches write to, made once for many of them.

    Attributes
    ----------
    count : numpy.ndarray of int64, shape (3,)
        Number of the layer that is on, counted over all searches, and of the cells in it and in the next.
    cells : numpy.ndarray of int64, shape (2, n_cells)
        The cells of a layer and of the next one.
    stamp, cost : numpy.ndarray of int64, shape (2, n_cells)
        In which layer each of them was reached last, and at which least cost.
    came : numpy.ndarray of int8, shape (T + 1, n_cells)
        Along which step the cheapest way comes to each cell at each tick.
    """

    count: np.ndarray
    cells: np.ndarray
    stamp: np.ndarray
    cost: np.ndarray
    came: np.ndarray


def make_timed_terrain(coding: Any, potential: np.ndarray | None = None) -> TimedTerrain:
    """Return the terrain of a query in time.

    Parameters
    ----------
    coding : TimedPaths
    potential : numpy.ndarray of int64, shape (T + 1, n_cells), optional
        Of all obstacles at each tick; without it only ticks and length are told apart, and ticks count first.

    Returns
    -------
    TimedTerrain
        Terms are scaled to whole numbers such that their ranges over the best paths in each are about the same.
    """
    moves = coding.timetable.moves
    ends = moves.index(coding.start), moves.index(coding.goal)
    straight = FULL_WEIGHT
    plain = TimedTerrain(
        coding.useful, coding.timetable.offsets, moves.width, *ends, straight, straight, round(SQRT2 * straight),
        np.zeros((1, 1), dtype=np.int64),
    )  # fmt: skip
    if potential is None:
        # A path that arrives first is no longer than its ticks.
        return plain._replace(tick=2 * straight * coding.horizon)
    highest = max(int(potential.max()), 1)
    # Each term's best path; a trace of the other two keeps it from wandering where it costs nothing.
    coarse = plain._replace(risk=np.rint(potential * (FULL_WEIGHT / highest)).astype(np.int64))
    weights = np.full((N_TERMS, N_TERMS), 1) + (FULL_WEIGHT - 1) * np.eye(N_TERMS, dtype=np.int64)
    rows = draw_timed(coarse, weights, np.zeros((N_TERMS, 3), dtype=np.int64))
    paths = coding.decode(rows)
    risk = np.array([potential[np.arange(end), row[:end]].sum() for row, end in zip(rows, paths.arrival + 1, strict=True)])
    totals = np.column_stack([paths.arrival.astype(float), paths.length, risk])
    least, most = totals.min(axis=0), totals.max(axis=0)
    peaks = np.array([1.0, SQRT2, highest])
    spans = np.maximum(most - least, LEAST_RANGE * np.maximum(most, peaks))
    scale = LARGEST_COST / (peaks / spans).max()
    tick, straight = (max(round(scale / span), 1) for span in spans[:2])
    risk = np.rint(potential * (scale / spans[2])).astype(np.int64)
    return plain._replace(tick=tick, straight=straight, diagonal=round(SQRT2 * straight), risk=risk)


def make_timed_work(terrain: TimedTerrain) -> TimedWork:
    """Return the working arrays for searches of a terrain."""
    horizon, n = terrain.legal.shape
    cells, cost = np.empty((2, 2, n), dtype=np.int64)
    return TimedWork(
        np.zeros(3, dtype=np.int64), cells, np.zeros((2, n), dtype=np.int64), cost, np.empty((horizon + 1, n), dtype=np.int8)
    )


def draw_timed(terrain: TimedTerrain, weights: np.ndarray, noise: np.ndarray, via: np.ndarray | None = None) -> np.ndarray:
    """Return the cheapest paths for weights of the terms, see `find_timed_route`, int64, shape (N, T + 1).

    Parameters
    ----------
    terrain : TimedTerrain
    weights, noise : numpy.ndarray of int64, shape (N, 3)
    via : numpy.ndarray of int64, shape (N, 2), optional
        The index of a cell and the tick at which the path is to be there, of a state of a path of the query.
    """
    through = np.tile([terrain.start, 0], (len(weights), 1)) if via is None else via
    return _draw(terrain, make_timed_work(terrain), weights, noise, through)


def mend_timed(terrain: TimedTerrain, rows: np.ndarray) -> np.ndarray:
    """Return legal paths that keep to rows of cells as long as these can be followed, int64, shape (N, T + 1)."""
    return _mend(terrain, make_timed_work(terrain), rows)


@kernel
def find_timed_route(terrain, work, cell, tick, target, end, weight, noise, limit):
    """Find a cheapest way from a cell at a tick to another; return when it arrives, or -1 if there is none.

    Parameters
    ----------
    terrain, work
    cell, tick : int
        A state of a path of the query.
    target, end : int
        A cell and the tick at which to be there; where it is the goal, the tick at which to be there at the latest.
    weight : int64, shape (3,)
        Weight of each term, 0 to `FULL_WEIGHT`.
    noise : int64, shape (3,)
        As in `find_route`; blocks of cells are blocks of as many ticks, too.
    limit : int
        Cells at ticks to go on from before giving up.
    """
    width, goal = terrain.width, terrain.goal
    tx, ty = target % width, target // width
    best, arrival = _ENDLESS, np.int64(-1)
    now = 0
    work.cells[0, 0] = cell
    work.cost[0, cell] = 0
    n_now = 1
    expanded = 0
    while n_now > 0 and tick < end:
        expanded += n_now
        if expanded > limit:
            break
        work.count[0] += 1
        run = work.count[0]
        after = 1 - now
        n_after = 0
        late = (noise[2] + (tick >> noise[1]) * _NEXT_BLOCK) & 0x7FFFFFFF
        for i in range(n_now):
            here = work.cells[now, i]
            reached = work.cost[now, here]
            if reached >= best:
                continue
            steps = terrain.legal[tick, here]
            for m in range(9):
                if not (steps >> m) & 1:
                    continue
                other = here + terrain.offsets[m]
                x, y = other % width, other // width
                far, near = max(abs(tx - x), abs(ty - y)), min(abs(tx - x), abs(ty - y))
                if far > end - tick - 1 or (other == goal and target != goal):
                    continue
                step = weight[0] * terrain.tick
                if m != WAIT:
                    step += weight[1] * (terrain.straight if m & 1 == 0 else terrain.diagonal)
                if len(terrain.risk) > 1:
                    step += weight[2] * terrain.risk[tick + 1, other]
                if noise[0] > 0:
                    step += (step * noise[0] >> 10) * block_noise(x >> noise[1], y >> noise[1], late) >> 10
                total = reached + step
                # The rest costs no less than the way on an empty map.
                if total + weight[0] * terrain.tick * far + weight[1] * _octile(terrain, far, near) >= best:
                    continue
                if work.stamp[after, other] == run:
                    if total >= work.cost[after, other]:
                        continue
                else:
                    work.stamp[after, other] = run
                    if other != goal:
                        work.cells[after, n_after] = other
                        n_after += 1
                work.cost[after, other] = total
                work.came[tick + 1, other] = m
        tick += 1
        if target == goal and work.stamp[after, goal] == run and work.cost[after, goal] < best:
            best, arrival = work.cost[after, goal], tick
        now, n_now = after, n_after
        if target != goal and tick == end and work.stamp[now, target] == work.count[0]:
            return end
    return arrival


@kernel
def _octile(terrain, far, near):
    return (far - near) * terrain.straight + near * terrain.diagonal


@kernel
def write_route(terrain, work, tick, target, arrival, row):
    """Write the way that `find_timed_route` found, from a tick to the arrival at its target, into a row after that tick."""
    cell = target
    for t in range(arrival, tick, -1):
        row[t] = cell
        cell -= terrain.offsets[work.came[t, cell]]


@kernel
def fill(row, tick, goal):
    """Write the goal into a row after a tick."""
    for t in range(tick + 1, len(row)):
        row[t] = goal


@kernel
def step_between(terrain, tick, cell, other):
    """Return the legal step or wait from a cell at a tick to another at the next, or -1."""
    for m in range(9):
        if (terrain.legal[tick, cell] >> m) & 1 and cell + terrain.offsets[m] == other:
            return m
    return -1


@kernel
def _draw(terrain, work, weights, noise, via):
    horizon = len(terrain.legal)
    rows = np.empty((len(weights), horizon + 1), dtype=np.int64)
    for i in range(len(rows)):
        row, cell, tick = rows[i], via[i, 0], via[i, 1]
        row[0] = terrain.start
        if tick > 0:
            find_timed_route(terrain, work, terrain.start, 0, cell, tick, weights[i], noise[i], _ENDLESS)
            write_route(terrain, work, 0, cell, tick, row)
        arrival = find_timed_route(terrain, work, cell, tick, terrain.goal, horizon, weights[i], noise[i], _ENDLESS)
        write_route(terrain, work, tick, terrain.goal, arrival, row)
        fill(row, arrival, terrain.goal)
    return rows


@kernel
def _mend(terrain, work, rows):
    mended = np.empty_like(rows)
    horizon = len(terrain.legal)
    weight, noise = np.array([1, 1, 0]), np.zeros(3, dtype=np.int64)
    for i in range(len(rows)):
        mended[i, 0] = terrain.start
        cell, tick = terrain.start, 0
        while cell != terrain.goal and step_between(terrain, tick, cell, rows[i, tick + 1]) >= 0:
            tick += 1
            cell = rows[i, tick]
            mended[i, tick] = cell
        if cell != terrain.goal:
            arrival = find_timed_route(terrain, work, cell, tick, terrain.goal, horizon, weight, noise, _ENDLESS)
            write_route(terrain, work, tick, terrain.goal, arrival, mended[i])
            tick = arrival
        fill(mended[i], tick, terrain.goal)
    return mended
