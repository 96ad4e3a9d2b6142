"""What several tests of exact fronts need."""

import numpy as np

from pymoo_gridpath import OccupancyGrid
from pymoo_gridpath.objectives import Objective
from pymoo_gridpath.testing.enumeration import non_dominated


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


def front_of(measures, names):
    """Return the non-dominated rows of measures by name, each once and in ascending order."""
    return non_dominated(zip(*(measures[name] for name in names), strict=True))


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
    grid = OccupancyGrid(occupied, corner_cutting=bool(random_state.integers(2)))
    start, goal = random_state.permutation([free[0], free[-1]]).tolist()
    representation = str(random_state.choice(["cells", "integer", "absolute", "binary", "mixed"], p=[0.5, 0.2, 0.1, 0.1, 0.1]))
    return grid, start, goal, representation
