"""Multi-objective path planning on occupancy grids, as problems and operators for pymoo."""

from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.problems import GridPathProblem

__all__ = ["GridPathProblem", "OccupancyGrid"]
