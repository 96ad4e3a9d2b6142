"""What several tests of exact fronts need."""

from __future__ import annotations

import math
from fractions import Fraction
from functools import lru_cache
from itertools import chain

import numpy as np

from pymoo_gridpath import OccupancyGrid
from pymoo_gridpath.exact import Certificate
from pymoo_gridpath.objectives import Objective
from pymoo_gridpath.testing.enumeration import RULES, STEPS, EnumeratedPath, enumerate_paths, non_dominated


def random_grid(size, seed, density=0.2):
    occupied = np.random.default_rng(seed).random((size, size)) < density
    occupied[0] = occupied[:, -1] = False
    return OccupancyGrid(occupied)


class Cost(Objective):
    """The sum of given costs of cells."""

    def __init__(self, name, values):
        self.name = self.label = name
        self.values = np.asarray(values)

    def field(self, grid):
        return self.values


class Along:
    """Sums along many enumerated paths at once, in the order of their cells."""

    def __init__(self, paths: list[EnumeratedPath]):
        self.n_cells = np.array([len(path.cells) for path in paths])
        self.length = np.array([path.straight + math.sqrt(2) * path.diagonal for path in paths])
        self.turn = np.array([45.0 * path.turn for path in paths])
        flat = np.fromiter(chain.from_iterable(chain.from_iterable(path.cells for path in paths)), dtype=np.int64)
        self._x, self._y = flat.reshape(-1, 2).T
        self._path = np.repeat(np.arange(len(paths)), self.n_cells)
        # The cells that a step leads to.
        self._after = np.flatnonzero(np.diff(self._path, prepend=-1) == 0)
        steps = np.column_stack([np.diff(self._x), np.diff(self._y)])[self._after - 1]
        heading = np.full((3, 3), -1)
        for m, (dx, dy) in enumerate(STEPS):
            heading[dx, dy] = m
        self._heading = heading[steps[:, 0], steps[:, 1]]

    def cells(self, field) -> np.ndarray:
        """The sum of a field over the cells of each path, shape (n_paths,)."""
        return np.bincount(self._path, field[self._y, self._x], len(self.n_cells))

    def least(self, field) -> np.ndarray:
        """The least value of a field over the cells of each path, shape (n_paths,)."""
        return np.minimum.reduceat(field[self._y, self._x], np.cumsum([0, *self.n_cells[:-1]]))

    def moves(self, costs) -> np.ndarray:
        """The sum of the costs of the moves of each path: a straight and a diagonal one, or one a heading and cell entered."""
        if isinstance(costs, tuple):
            each = np.where(self._heading % 2 == 0, *costs)
        else:
            each = costs[self._heading, self._y[self._after], self._x[self._after]]
        return np.bincount(self._path[self._after], each, len(self.n_cells))


@lru_cache(maxsize=64)
def queries_of(part: int, n_parts: int, count: int):
    """Return solvable random queries: seed, grid, start, goal, all paths between them, and sums along these.

    Parts have none in common.
    """
    found, seed = [], part
    while len(found) < count:
        case = random_case(seed)
        if case is not None:
            grid, start, goal, _ = case
            paths = enumerate_paths(grid, tuple(start), tuple(goal), range(8))
            if paths:
                found.append((seed, grid, start, goal, paths, Along(paths)))
        seed += n_parts
    return found


def front_of(measures, names):
    """Return the non-dominated rows of measures by name, each once and in ascending order."""
    return non_dominated(zip(*(np.asarray(measures[name]).tolist() for name in names), strict=True))


def random_case(seed):
    """Return a random small query, its headings and a representation, or None if it has no answer."""
    random_state = np.random.default_rng(seed)
    height, width = random_state.integers(3, 6, size=2)
    occupied = random_state.random((height, width)) < 0.2
    # No more than 14 free cells, for the sake of the enumeration.
    free = np.argwhere(~occupied)
    for y, x in random_state.permutation(free)[14:]:
        occupied[y, x] = True
    free = sorted(((int(x), int(y)) for y, x in np.argwhere(~occupied)), key=sum)
    if len(free) < 2:
        return None
    grid = OccupancyGrid(occupied, **RULES[int(random_state.integers(len(RULES)))])
    start, goal = random_state.permutation([free[0], free[-1]]).tolist()
    representation = str(random_state.choice(["cells", "integer", "absolute", "binary", "mixed"], p=[0.5, 0.2, 0.1, 0.1, 0.1]))
    return grid, start, goal, representation


def holds(certified: Certificate, F, front) -> bool:
    """Whether a certificate is true of points with whole numbers, by its definition."""
    F, front = ([[int(value) for value in row] for row in np.asarray(rows)] for rows in (F, front))
    factor, share = 1 + Fraction(min(certified.epsilon, 1e30)), Fraction(certified.share)
    ranges = [max(column) - min(column) for column in zip(*front, strict=True)]
    return all(
        any(all(a <= factor * b for a, b in zip(p, q, strict=True)) for p in F)
        and any(all(a <= b + share * extent for a, b, extent in zip(p, q, ranges, strict=True)) for p in F)
        for q in front
    )


def whole_costs(shape, seed, names="ab"):
    draw = np.random.default_rng(seed)
    return {name: draw.integers(0, int(draw.choice([2, 6, 1000])), shape) for name in names}
