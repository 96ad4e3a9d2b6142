"""Path planning as pymoo problems, and generators of scenarios."""

from pymoo_gridpath.problems.grid_path import OBSTACLES, GridPathProblem
from pymoo_gridpath.problems.scenarios import random_dense_grid

__all__ = ["OBSTACLES", "GridPathProblem", "random_dense_grid"]
