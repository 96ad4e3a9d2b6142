"""Path planning as pymoo problems, and generators of scenarios."""

from pymoo_gridpath.problems.grid_path import OBSTACLES, GridPathProblem
from pymoo_gridpath.problems.scenarios import (
    concave_environment,
    convex_environment,
    far_corners,
    maze_environment,
    random_dense_grid,
)

__all__ = [
    "OBSTACLES",
    "GridPathProblem",
    "concave_environment",
    "convex_environment",
    "far_corners",
    "maze_environment",
    "random_dense_grid",
]
