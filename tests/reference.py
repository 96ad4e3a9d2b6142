"""Plain Python references: paths measured cell by cell, by definition, with no use of the package's arithmetic."""

import itertools
import math

import numpy as np


def length(cells):
    return sum(math.dist(a, b) for a, b in itertools.pairwise(cells))


def turn(cells):
    """Total turn in degrees from the angles of the steps."""
    angles = [math.degrees(math.atan2(b[1] - a[1], b[0] - a[0])) for a, b in itertools.pairwise(cells)]
    total = 0.0
    for a, b in itertools.pairwise(angles):
        change = abs(b - a) % 360
        total += min(change, 360 - change)
    return round(total)


def interfering_cells(cells, grid):
    """Occupied visited cells and, where corners may not be cut, occupied cells beside each diagonal step."""
    count = sum(bool(grid.occupied[y, x]) for x, y in cells)
    if not grid.corner_cutting:
        for (xa, ya), (xb, yb) in itertools.pairwise(cells):
            if xa != xb and ya != yb:
                count += bool(grid.occupied[ya, xb]) + bool(grid.occupied[yb, xa])
    return count


def potential(grid, variance=0.5):
    """The sum of bells over all occupied cells, one cell at a time."""
    ys, xs = np.nonzero(grid.occupied)
    field = np.zeros(grid.shape)
    for y in range(grid.height):
        for x in range(grid.width):
            field[y, x] = np.exp(-((xs - x) ** 2 + (ys - y) ** 2) / (2 * variance)).sum()
    return field


def vulnerability(cells, grid, variance=0.5):
    field = potential(grid, variance)
    return sum(field[y, x] for x, y in cells)


def is_connected(cells):
    """Whether consecutive cells are neighbours."""
    return all(max(abs(a[0] - b[0]), abs(a[1] - b[1])) == 1 for a, b in itertools.pairwise(cells))
