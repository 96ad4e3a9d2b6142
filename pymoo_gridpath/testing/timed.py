"""Fronts among moving obstacles by enumeration, by rules that are written down a second time here."""

from __future__ import annotations

import functools

import numpy as np

from pymoo_gridpath.testing.enumeration import non_dominated


def place(way, tick):
    """Return where an obstacle is that stays after its last state."""
    return tuple(way[min(tick, len(way) - 1)])


def enumerated(occupied, corner_cutting, start, goal, ways, horizon):
    """Return the front by trying every path, with potentials worked out cell by cell."""
    height, width = occupied.shape
    walls = [(int(x), int(y)) for y, x in np.argwhere(occupied)]
    points = set()

    def potential(cell, tick):
        sources = set(walls) | {place(way, tick) for way in ways}
        total = sum(np.exp(-((cell[0] - x) ** 2 + (cell[1] - y) ** 2) / 1.0) for x, y in sources)
        return round(total * 2**30)

    known = {(x, y, t): potential((x, y), t) for x in range(width) for y in range(height) for t in range(horizon + 1)}

    @functools.cache
    def steps_from(cell, tick):
        """Return where one step or a wait may lead, and over how many sides of cells."""
        found = []
        before, after = ({place(way, t) for way in ways} for t in (tick, tick + 1))
        for dx in (-1, 0, 1):
            for dy in (-1, 0, 1):
                x, y = cell[0] + dx, cell[1] + dy
                if not (0 <= x < width and 0 <= y < height) or occupied[y, x] or (x, y) in after:
                    continue
                if dx and dy and not corner_cutting and {(x, cell[1]), (cell[0], y)} & (before | after | set(walls)):
                    continue
                steps = [(place(way, tick), place(way, tick + 1)) for way in ways]
                if (dx or dy) and any(a != b and (a[0] + b[0], a[1] + b[1]) == (cell[0] + x, cell[1] + y) for a, b in steps):
                    continue
                found.append(((x, y), abs(dx) + abs(dy)))
        return found

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
