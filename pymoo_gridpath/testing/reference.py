"""Slow references: paths measured cell by cell, by definition, with no use of the package's arithmetic; and fronts."""

import itertools
import math

import numpy as np


def length(cells):
    """Sum of the distances between consecutive cells."""
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
    """Occupied visited cells, and what each diagonal step crosses beside it."""
    count = sum(bool(grid.occupied[y, x]) for x, y in cells)
    for a, b in itertools.pairwise(cells):
        if a[0] != b[0] and a[1] != b[1]:
            count += crossed_beside(a, b, grid)
    return count


def crossed_beside(a, b, grid):
    """Number of cells that a diagonal step crosses besides its ends; the one that it leaves out, where there are none such."""
    if grid.moves == 4:
        return 1
    beside = int(grid.occupied[a[1], b[0]]) + int(grid.occupied[b[1], a[0]])
    if grid.corner_cutting == "one side":
        return beside if beside == 2 else 0
    return 0 if grid.corner_cutting else beside


def potential(grid, variance=0.5):
    """The sum of bells over all occupied cells, one cell at a time."""
    ys, xs = np.nonzero(grid.occupied)
    field = np.zeros(grid.shape)
    for y in range(grid.height):
        for x in range(grid.width):
            field[y, x] = np.exp(-((xs - x) ** 2 + (ys - y) ** 2) / (2 * variance)).sum()
    return field


def total(cells, field):
    """Sum of a field, indexed by [y, x], over visited cells."""
    return sum(field[y, x] for x, y in cells)


def vulnerability(cells, grid, variance=0.5):
    return total(cells, potential(grid, variance))


def is_connected(cells):
    """Whether consecutive cells are neighbours."""
    return all(max(abs(a[0] - b[0]), abs(a[1] - b[1])) == 1 for a, b in itertools.pairwise(cells))


# -- rows of cells with gaps and pauses -----------------------------------------------------------------------------------


def visited(row, width):
    """Cells (x, y) of a row of indices; one that follows itself counts once."""
    return [(int(cell) % width, int(cell) // width) for cell, _ in itertools.groupby(row)]


def distances(a, b):
    """Larger and smaller distance of two cells along the axes."""
    return sorted((abs(a[0] - b[0]), abs(a[1] - b[1])), reverse=True)


def octile_length(cells):
    """Length of the shortest way on an empty grid through all cells in order."""
    steps = [distances(a, b) for a, b in itertools.pairwise(cells)]
    return sum(long - short for long, short in steps) + math.sqrt(2.0) * sum(short for _, short in steps)


def sign_turn(cells):
    """Total turn in degrees where each step heads for the nearest cell in the direction of its signs."""

    def sign(value):
        return (value > 0) - (value < 0)

    steps = [(sign(b[0] - a[0]), sign(b[1] - a[1])) for a, b in itertools.pairwise(cells)]
    return turn(list(itertools.accumulate(steps, lambda a, b: (a[0] + b[0], a[1] + b[1]), initial=(0, 0))))


def broken_cells(cells, grid):
    """Occupied visited cells, occupied cells beside diagonal steps that cut corners, and cells left out by jumps."""
    count = sum(bool(grid.occupied[y, x]) for x, y in cells)
    for a, b in itertools.pairwise(cells):
        long, short = distances(a, b)
        if long == short == 1:
            count += crossed_beside(a, b, grid)
        else:
            count += long - 1
    return count


# -- fronts ---------------------------------------------------------------------------------------------------------------


def is_legal(cells, grid, start, goal):
    """Whether cells are a path from the start to the goal by steps between free neighbours that cut no forbidden corner."""
    ends = bool(cells) and tuple(cells[0]) == tuple(start) and tuple(cells[-1]) == tuple(goal)
    return ends and is_connected(cells) and broken_cells(cells, grid) == 0


def walk(grid, start, goal, rng, forward=lambda step: True):
    """A random shortest path by steps for which ``forward`` holds, as a list of cells (x, y), or None if there is none."""
    steps = [(dx, dy) for dx in (-1, 0, 1) for dy in (-1, 0, 1) if (dx or dy) and forward((dx, dy))]
    before: dict[tuple, tuple | None] = {tuple(start): None}
    queue = [tuple(start)]
    for cell in queue:
        for k in rng.permutation(len(steps)):
            x, y = cell[0] + steps[k][0], cell[1] + steps[k][1]
            inside = 0 <= x < grid.width and 0 <= y < grid.height
            if inside and (x, y) not in before and broken_cells([cell, (x, y)], grid) == 0:
                before[x, y] = cell
                queue.append((x, y))
    path, cell = [], tuple(goal) if tuple(goal) in before else None
    while cell is not None:
        path.append(cell)
        cell = before[cell]
    return path[::-1] or None


def dominates(a, b):
    return all(x <= y for x, y in zip(a, b, strict=True)) and any(x < y for x, y in zip(a, b, strict=True))


def legal_front(problem, X):
    """Points of the front of the legal paths among genes, as the problem scores them, each with the least turn on it."""
    paths = problem.decode(np.asarray(X))
    legal = [k for k in range(len(X)) if interfering_cells(paths.cells(k).tolist(), problem.grid) == 0]
    F = [tuple(row) for row in problem.score(paths).tolist()]
    points = {F[k] for k in legal}
    return {
        point: min(turn(paths.cells(k).tolist()) for k in legal if F[k] == point)
        for point in points
        if not any(dominates(other, point) for other in points)
    }
