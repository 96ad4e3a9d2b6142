"""ASLETISMAC once more, by its definitions and in plain Python: step costs, and fronts by a plain dynamic programme.

Cells are (x, y) from 1, as the suite counts them. Nothing here is of the package.
"""

from __future__ import annotations

import math
from collections import defaultdict

# Sums of the same costs in another order differ by less; so do no two paths of these instances otherwise.
TIE = 1e-9

HEADINGS = {"K2": [(1, 0), (0, 1)], "K3": [(1, 0), (0, 1), (1, 1)]}


def instance(name):
    """Return obstacles, cells a side, hills, neighbourhood and whether paths may backtrack."""
    _, obstacles, x, y, hills, neighbours, last = name.split("_")
    assert x[1:] == y[1:]
    return obstacles, int(x[1:]), hills, neighbours, last == "BT"


def steps(name):
    neighbours, backtracking = instance(name)[3:]
    ahead = HEADINGS[neighbours]
    if not backtracking:
        return ahead
    straight = [(1, 0), (0, 1), (-1, 0), (0, -1)]
    return straight if neighbours == "K2" else [*straight, (1, 1), (-1, 1), (-1, -1), (1, -1)]


def is_blocked(name, x, y):
    obstacles, n, *_ = instance(name)
    if obstacles == "CH":
        return x % 2 == 0 and y % 2 == 0 and (x, y) != (n, n)
    if obstacles == "LA":
        return (x - 1 - n / 2) ** 2 + (y - 1 - n / 2) ** 2 <= (n / 4) ** 2
    return False


def speed(x, y):
    w = max(math.sin(x - 1), math.cos(y - 1))
    return 130 if w > 0.9 else 50 if w < -0.4 else 100


def height(hills, n, x, y):
    a, b = -3 + 6 * (x - 1) / n, -3 + 6 * (y - 1) / n

    def g(u, v):
        return 5 * math.exp(-((a - u) ** 2) - (b - v) ** 2)

    if hills == "P1":
        return g(1.5, -1.5)
    if hills == "P2":
        return g(-1.5, -1.5) + g(1.5, 1.5)
    if hills == "P3":
        return g(-1.5, -1.5) + g(1.5, 1.5) + g(1.5, -1.5)
    return (
        3 * (1 - a) ** 2 * math.exp(-(a**2) - (b + 1) ** 2)
        - 10 * math.exp(-(a**2) - b**2) * (-(a**3) + a / 5 - b**5)
        - math.exp(-((a + 1) ** 2) - b**2) / 3
    )


def step_cost(name, objective, before, u, v):
    """Return what the step from u to v costs after one along the heading before, None for none."""
    _, n, hills, *_ = instance(name)
    d = math.dist(u, v)
    if objective == "length":
        return d
    if objective == "delay":
        return {130: 0.2, 100: 1.0, 50: 3.0}[speed(*u)] if speed(*u) == speed(*v) else 2.0
    if objective == "ascent":
        return max(0.0, height(hills, n, *v) - height(hills, n, *u))
    if objective == "travel_time":
        return 2 * d / (speed(*u) + speed(*v))
    assert objective == "turn"
    if before is None:
        return 0.0
    angle = abs(math.degrees(math.atan2(v[1] - u[1], v[0] - u[0]) - math.atan2(before[1], before[0]))) % 360
    return min(angle, 360 - angle)


def is_covered(vector, others):
    """Whether one of the others is no worse in anything, ties included."""
    return any(all(a <= b + TIE for a, b in zip(other, vector, strict=True)) for other in others)


def front(name, objectives):
    """Return the front, a list of tuples, by what can be reached with one step more at a time, until nothing new comes."""
    n = instance(name)[1]
    start, goal, turning = (1, 1), (n, n), "turn" in objectives
    costs = {}
    kept, ends = defaultdict(list), []
    layer = {} if is_blocked(name, *goal) else {(start, None): [(0.0,) * len(objectives)]}
    while layer:
        reached = defaultdict(list)
        for (cell, before), vectors in layer.items():
            for heading in steps(name):
                x, y = ahead = cell[0] + heading[0], cell[1] + heading[1]
                if not (1 <= x <= n and 1 <= y <= n) or is_blocked(name, x, y):
                    continue
                key = cell, before, heading
                if key not in costs:
                    costs[key] = [step_cost(name, objective, before, cell, ahead) for objective in objectives]
                state = ahead, heading if turning else None
                reached[state] += [tuple(map(sum, zip(vector, costs[key], strict=True))) for vector in vectors]
        layer = {}
        for state, vectors in reached.items():
            here = ends if state[0] == goal else kept[state]
            new = []
            for vector in sorted(vectors):
                if not is_covered(vector, ends) and not is_covered(vector, here):
                    here[:] = [other for other in here if not is_covered(other, [vector])]
                    new = [other for other in new if not is_covered(other, [vector])]
                    here.append(vector)
                    new.append(vector)
            if new and state[0] != goal:
                layer[state] = new
    return sorted(ends)


def same(front, other, tie=1e-5):
    """Whether two fronts are the same, but for points that differ from others by so little that they may be ties."""

    def close(one, points):
        return any(all(abs(a - b) <= tie for a, b in zip(one, point, strict=True)) for point in points)

    front, other = ([one for one in points if not _is_tie(one, points, tie)] for points in (front, other))
    return all(close(one, other) for one in front) and all(close(one, front) for one in other)


def _is_tie(one, points, tie):
    """Whether another point is better by more than a tie in something, and worse by no more than one in anything."""
    return any(
        all(a <= b + tie for a, b in zip(other, one, strict=True)) and any(a < b - tie for a, b in zip(other, one, strict=True))
        for other in points
    )
