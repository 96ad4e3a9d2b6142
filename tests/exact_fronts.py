"""What several tests of exact fronts need."""

import numpy as np

from pymoo_gridpath import OccupancyGrid
from pymoo_gridpath.objectives import Objective


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

    def __call__(self, paths, sums):
        return paths.total(sums).astype(float)
