"""Fronts among moving obstacles by enumeration, by rules that are written down a second time here."""

from __future__ import annotations

import functools
import itertools

import numpy as np

from pymoo_gridpath.testing.enumeration import non_dominated


def place(way, tick):
    """Return where an obstacle is that stays after its last state."""
    return tuple(way[min(tick, len(way) - 1)])


def step_is_legal(occupied, corner_cutting, ways, tick, cell, other):
    """Return whether a step to a neighbouring cell, or a wait, is legal from one tick to the next."""
    height, width = occupied.shape
    (x, y), (dx, dy) = other, (other[0] - cell[0], other[1] - cell[1])
    before, after = ({place(way, t) for way in ways} for t in (tick, tick + 1))
    if max(abs(dx), abs(dy)) > 1 or not (0 <= x < width and 0 <= y < height) or occupied[y, x] or (x, y) in after:
        return False
    beside = {(x, cell[1]), (cell[0], y)} if dx and dy and not corner_cutting else set()
    if beside & (before | after) or any(occupied[b, a] for a, b in beside):
        return False
    steps = [(place(way, tick), place(way, tick + 1)) for way in ways]
    return not ((dx or dy) and any(a != b and (a[0] + b[0], a[1] + b[1]) == (cell[0] + x, cell[1] + y) for a, b in steps))


def potential(occupied, ways, cell, tick):
    """Return the potential of a cell at a tick, in units of 2**-30."""
    sources = {(int(x), int(y)) for y, x in np.argwhere(occupied)} | {place(way, tick) for way in ways}
    return round(sum(np.exp(-((cell[0] - x) ** 2 + (cell[1] - y) ** 2) / 1.0) for x, y in sources) * 2**30)


def measured(occupied, corner_cutting, goal, ways, cells):
    """Return whether a path of a cell (x, y) at each tick is legal, and its arrival, length and vulnerability."""
    cells = cells[: cells.index(goal) + 1]
    legal = not occupied[cells[0][1], cells[0][0]] and all(place(way, 0) != cells[0] for way in ways)
    length = 0.0
    for tick, (cell, other) in enumerate(itertools.pairwise(cells)):
        legal = legal and step_is_legal(occupied, corner_cutting, ways, tick, cell, other)
        across, up = abs(other[0] - cell[0]), abs(other[1] - cell[1])
        length += abs(across - up) + min(across, up) * 2**0.5
    risk = sum(potential(occupied, ways, cell, tick) for tick, cell in enumerate(cells))
    return legal, (len(cells) - 1, length, risk * 2.0**-30)


def enumerated(occupied, corner_cutting, start, goal, ways, horizon):
    """Return the front by trying every path, with potentials worked out cell by cell."""
    height, width = occupied.shape
    points = set()
    known = {
        (x, y, t): potential(occupied, ways, (x, y), t) for x in range(width) for y in range(height) for t in range(horizon + 1)
    }

    @functools.cache
    def steps_from(cell, tick):
        """Return where one step or a wait may lead, and over how many sides of cells."""
        reach = [(cell[0] + dx, cell[1] + dy) for dx in (-1, 0, 1) for dy in (-1, 0, 1)]
        legal = [other for other in reach if step_is_legal(occupied, corner_cutting, ways, tick, cell, other)]
        return [(other, abs(other[0] - cell[0]) + abs(other[1] - cell[1])) for other in legal]

    # Every path there is; those that are at the same cell at the same costs are one.
    now = {(start, 0, 0, known[(*start, 0)])} if all(place(way, 0) != start for way in ways) else set()
    for tick in range(horizon):
        then = set()
        for cell, straight, diagonal, risk in now:
            for other, moved in steps_from(cell, tick):
                costs = straight + (moved == 1), diagonal + (moved == 2), risk + known[(*other, tick + 1)]
                if other == goal:
                    points.add((tick + 1, *costs))
                else:
                    then.add((other, *costs))
        now = then
    return non_dominated((t, s + d * 2**0.5, r * 2.0**-30) for t, s, d, r in points)


def wander(rng, size, n):
    """Return the cells of an obstacle that wanders at random for so many ticks."""
    way = [rng.integers(size, size=2)]
    for _ in range(n):
        way.append(np.clip(way[-1] + rng.integers(-1, 2, 2), 0, size - 1))
    return [tuple(cell.tolist()) for cell in way]
