"""Path planning as pymoo problems, and generators of scenarios."""

from pymoo_gridpath.problems.clock import ObstacleClock
from pymoo_gridpath.problems.environments import SMALL_ENVIRONMENTS, small_environment
from pymoo_gridpath.problems.grid_path import OBSTACLES, GridPathProblem
from pymoo_gridpath.problems.moving import MovingObstaclesProblem, random_movers
from pymoo_gridpath.problems.scenarios import (
    concave_environment,
    convex_environment,
    far_corners,
    maze_environment,
    random_dense_grid,
)
from pymoo_gridpath.problems.shortening import ShorteningProblem
from pymoo_gridpath.problems.suites import (
    SUITES,
    Asletismac,
    GuardsGrid,
    RandomCostGrid,
    RegionOfSightMaps,
    SmallEnvironments,
    Suite,
    make_suite,
)
from pymoo_gridpath.problems.timed import TimedPathProblem

__all__ = [
    "OBSTACLES",
    "SMALL_ENVIRONMENTS",
    "SUITES",
    "Asletismac",
    "GridPathProblem",
    "GuardsGrid",
    "MovingObstaclesProblem",
    "ObstacleClock",
    "RandomCostGrid",
    "RegionOfSightMaps",
    "ShorteningProblem",
    "SmallEnvironments",
    "Suite",
    "TimedPathProblem",
    "concave_environment",
    "convex_environment",
    "far_corners",
    "make_suite",
    "maze_environment",
    "random_dense_grid",
    "random_movers",
    "small_environment",
]
