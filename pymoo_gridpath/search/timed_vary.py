"""The kernels that make paths in time of other paths in time."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.paths.timed import WAIT
from pymoo_gridpath.search.timed import TimedTerrain, fill, find_timed_route, make_timed_work, step_between, write_route

#: Ways to change a path.
REROUTE, DELAY, HURRY = 0, 1, 2

# Cells at ticks that a search for a way between two paths may go on from.
JOIN_LIMIT = np.int64(4096)


class TimedChanges(NamedTuple):
    """What is to change in each of N paths.

    Attributes
    ----------
    way : numpy.ndarray of int64, shape (N,)
        `REROUTE` takes the cheapest way between the two ends of a stretch; `DELAY` waits at its beginning; `HURRY` drops the
        next wait after it. What comes after keeps its cells, earlier or later, and waits where obstacles make it.
    begin, end : numpy.ndarray of int64, shape (N,)
        Ticks of the two ends.
    shift : numpy.ndarray of int64, shape (N,)
        How many ticks later than before the end is reached, or how long to wait.
    weights, noise : numpy.ndarray of int64, shape (N, 3)
        See `find_timed_route`.
    """

    way: np.ndarray
    begin: np.ndarray
    end: np.ndarray
    shift: np.ndarray
    weights: np.ndarray
    noise: np.ndarray


def splice_timed(
    terrain: TimedTerrain, rows: np.ndarray, first: np.ndarray, second: np.ndarray, draws, weights: np.ndarray, reach: int
) -> np.ndarray:
    """Return children of pairs of paths, int64, shape (N, T + 1).

    A child follows the first path up to a cell that the second visits, too, and from there the second. Where they visit it at
    the same tick that is all. Where the first is there earlier, the child waits for as long, or goes on at once; where it is
    later, it goes on at once. It waits on the way where an obstacle bars the next step, and if that cannot be the next cell
    that both visit is tried. Where all have been, a cheapest way leads from a random cell of the first to the second as soon as
    it can be there in time, if that is within ``reach`` ticks.

    Parameters
    ----------
    terrain : TimedTerrain
    rows : numpy.ndarray of int64, shape (n, T + 1)
        Legal paths.
    first, second : numpy.ndarray of int64, shape (N,)
        Numbers of the paths to splice.
    draws : numpy.ndarray of float, shape (N, 2)
        Random numbers from [0, 1) that choose where.
    weights : numpy.ndarray of int64, shape (N, 3)
    reach : int
    """
    return _splice(terrain, make_timed_work(terrain), rows, first, second, draws, weights, reach)


def vary_timed(terrain: TimedTerrain, rows: np.ndarray, changes: TimedChanges, limit: int) -> np.ndarray:
    """Return paths with a stretch changed; those that cannot be changed so are as they were, int64, shape (N, T + 1)."""
    return _vary(terrain, make_timed_work(terrain), rows, changes, limit)


@kernel
def _arrival(row, goal):
    tick = 0
    while row[tick] != goal:
        tick += 1
    return tick


@kernel
def _follow(terrain, row, tick, source, begin):
    """Go on in a row at a tick as another path does after one of its own; return whether that leads to the goal in time."""
    cell = row[tick]
    k = begin
    while cell != terrain.goal:
        other = source[k + 1]
        if step_between(terrain, tick, cell, other) >= 0:
            cell = other
            k += 1
        elif other == cell:
            # A wait that the other time does not need.
            k += 1
            continue
        elif not (terrain.legal[tick, cell] >> WAIT) & 1:
            return False
        tick += 1
        row[tick] = cell
    fill(row, tick, terrain.goal)
    return True


@kernel
def _same(a, b):
    k = 0
    while k < len(a) and a[k] == b[k]:
        k += 1
    return k == len(a)


@kernel
def _splice(terrain, work, rows, first, second, draws, weights, reach):
    children = np.empty((len(first), rows.shape[1]), dtype=np.int64)
    place = np.full(terrain.legal.shape[1], -1)
    for i in range(len(first)):
        a, b, child = rows[first[i]], rows[second[i]], children[i]
        end, other_end = _arrival(a, terrain.goal), _arrival(b, terrain.goal)
        for s in range(other_end + 1):
            place[b[s]] = s
        done = False
        begin = int(draws[i, 0] * end)
        for k in range(end):
            tick = (begin + k) % end
            s = place[a[tick]]
            if b[tick] == a[tick]:
                s = tick
            if s < 0 or (s == tick and tick == 0):
                continue
            _copy(a, child, tick)
            if s > tick and draws[i, 1] < 0.5:
                done = _waited(terrain, child, tick, s) and _follow(terrain, child, s, b, s)
            else:
                done = _follow(terrain, child, tick, b, s)
            done = done and not _same(child, a) and not _same(child, b)
            if done:
                break
        for s in range(other_end + 1):
            place[b[s]] = -1
        if not done:
            done = _joined(terrain, work, a, b, child, begin, other_end, weights[i], reach)
        if not done:
            _copy(a, child, len(a) - 1)
    return children


@kernel
def _copy(source, row, last):
    for t in range(last + 1):
        row[t] = source[t]


@kernel
def _waited(terrain, row, tick, until):
    """Wait in a row from a tick until another; return whether no obstacle comes."""
    for t in range(tick, until):
        if not (terrain.legal[t, row[t]] >> WAIT) & 1:
            return False
        row[t + 1] = row[t]
    return True


@kernel
def _joined(terrain, work, a, b, child, tick, other_end, weight, reach):
    """Follow one path up to a tick, and then another from where it can be met in time; return whether that can be."""
    noise = np.zeros(3, dtype=np.int64)
    width = terrain.width
    x, y = a[tick] % width, a[tick] // width
    for s in range(tick + 1, min(tick + reach, other_end - 1) + 1):
        if max(abs(b[s] % width - x), abs(b[s] // width - y)) > s - tick:
            continue
        if find_timed_route(terrain, work, a[tick], tick, b[s], s, weight, noise, JOIN_LIMIT) == s:
            _copy(a, child, tick)
            write_route(terrain, work, tick, b[s], s, child)
            return _follow(terrain, child, s, b, s)
    return False


@kernel
def _vary(terrain, work, rows, changes, limit):
    varied = np.empty_like(rows)
    horizon = len(terrain.legal)
    for i in range(len(rows)):
        old, row = rows[i], varied[i]
        begin, end = changes.begin[i], changes.end[i]
        done = False
        if changes.way[i] == REROUTE:
            target = old[end]
            # Whoever replaces the way to the goal may be as late as may be.
            last = horizon if target == terrain.goal else min(max(end + changes.shift[i], begin + 1), horizon)
            arrival = find_timed_route(
                terrain, work, old[begin], begin, target, last, changes.weights[i], changes.noise[i], limit
            )
            if arrival >= 0:
                _copy(old, row, begin)
                write_route(terrain, work, begin, target, arrival, row)
                done = _follow(terrain, row, arrival, old, end)
        elif changes.way[i] == DELAY:
            until = begin + changes.shift[i]
            if until < horizon:
                _copy(old, row, begin)
                done = _waited(terrain, row, begin, until) and _follow(terrain, row, until, old, begin)
        else:
            arrival = _arrival(old, terrain.goal)
            for k in range(arrival):
                tick = (begin + k) % arrival
                if old[tick + 1] == old[tick]:
                    _copy(old, row, tick)
                    done = _follow(terrain, row, tick, old, tick + 1)
                    break
        if not done:
            _copy(old, row, len(old) - 1)
    return varied
