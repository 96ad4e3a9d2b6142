"""Line of sight by definition: geometry in fractions, cell by cell."""

import math
from fractions import Fraction


def crosses(a, b, cell):
    """Whether the open segment between two centres meets the interior of a cell, in fractions: clipping, axis by axis."""
    low, high = Fraction(0), Fraction(1)
    for start, end, centre in zip(a, b, cell, strict=True):
        low_side, high_side = Fraction(2 * centre - 1, 2), Fraction(2 * centre + 1, 2)
        if start == end:
            if not low_side < start < high_side:
                return False
            continue
        ends = sorted(((low_side - start) / (end - start), (high_side - start) / (end - start)))
        low, high = max(low, ends[0]), min(high, ends[1])
    return low < high


def corners_on(a, b):
    """The corners of cells that a segment between two centres meets: the four cells around each."""
    (xa, ya), (xb, yb) = a, b
    for x in range(min(xa, xb), max(xa, xb)):
        t = (Fraction(2 * x + 1, 2) - xa) / (xb - xa)
        y = ya + t * (yb - ya)
        if y.denominator == 2:
            row = math.floor(y)
            yield [(i, j) for i in (x, x + 1) for j in (row, row + 1)]


def is_free(grid, a, b):
    """The first test, by definition."""
    xs, ys = (range(min(u, v), max(u, v) + 1) for u, v in zip(a, b, strict=True))
    if any(grid.occupied[y, x] and crosses(a, b, (x, y)) for x in xs for y in ys):
        return False
    if grid.moves == 4:
        return not list(corners_on(a, b))
    # Of the four cells around a corner the line touches two, and enters the others.
    most = {False: 0, "one side": 1, True: 2}[grid.corner_cutting]
    return all(sum(grid.occupied[y, x] for x, y in corner) <= most for corner in corners_on(a, b))


def nearest_cells(a, b):
    """The digital line, by definition."""
    n = max(abs(b[0] - a[0]), abs(b[1] - a[1]))
    return [tuple(math.floor(u + Fraction(k * (v - u), n) + Fraction(1, 2)) for u, v in zip(a, b)) for k in range(n + 1)]  # noqa: B905
