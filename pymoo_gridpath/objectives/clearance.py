"""The least clearance of a path."""

from __future__ import annotations

import math

import numpy as np

from pymoo_gridpath.fields import clearance
from pymoo_gridpath.objectives.base import OBJECTIVES, Objective


@OBJECTIVES.register
class LeastClearance(Objective):
    """Least distance of a visited cell from an obstacle, start and goal included, centre to centre in cells; more is better.

    As all objectives are minimised, ``F`` holds its negative: -2.0 is a path that keeps two cells away. Tables and figures show
    the distance itself, figures and pages in metres where the map has them. Obstacles are those of the grid that is planned on:
    where they were grown by a robot's radius, it is what there is beyond the robot. The path that keeps furthest away is the
    widest of those from start to goal, and goes by that name.

    On a map without obstacles every path has the diagonal of the map, more than any distance on it. The edge of the map is no
    obstacle.

    Notes
    -----
    The path of the largest least value is that of the maximum capacity, or widest path, problem (M. Pollack, "The maximum
    capacity through a network", Operations Research 8(5), 1960).

    Examples
    --------
    >>> from pymoo_gridpath import GridPathProblem, OccupancyGrid
    >>> post = np.zeros((4, 9))
    >>> post[0, 4] = 1
    >>> problem = GridPathProblem(OccupancyGrid(post), (0, 0), (8, 0), "cells", objectives=["length", "clearance"])
    >>> problem.pareto_front().round(2).tolist()
    [[8.83, -1.0], [9.66, -2.0], [10.49, -2.83], [11.66, -3.0]]
    """

    name = "clearance"
    label = "Least clearance [cells]"
    combine = "least"
    maximise = True
    best = "widest"
    in_cells = True

    def field(self, grid):
        distance = clearance(grid)
        return np.where(np.isfinite(distance), distance, math.hypot(*grid.shape))
