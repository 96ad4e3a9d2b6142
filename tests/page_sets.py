"""Trade-off sets for pages: of two and of three objectives, with names that nobody should have."""

import functools

import numpy as np

from pymoo_gridpath import GridPathProblem, OccupancyGrid, TradeOffSet
from pymoo_gridpath.objectives import Objective, Vulnerability

HOSTILE = "</script><script>window.hacked = 1</script><img src=x onerror=hacked=1> \"'&\u2028 @data@"


class Hostile(Objective):
    name = "</title><b>\"'"
    label = "<img src=x onerror='hacked=1'> [</script>]"

    def field(self, grid):
        return np.add.outer(np.arange(grid.height), np.zeros(grid.width))


@functools.cache
def grown_set() -> TradeOffSet:
    """Return that of a robot in the same room, about which obstacles grew."""
    grid = exact_set().problem.grid.inflate(0.3)
    problem = GridPathProblem(grid, (0, 5), (15, 6), "cells", ["length", Vulnerability(variance=2.0)])
    return TradeOffSet.from_genes(problem, problem.pareto_set(max_seconds=60))


@functools.cache
def exact_set(n_obj: int = 2, name: str = "room", hostile: bool = False, resolution: float | None = 0.25) -> TradeOffSet:
    """Return the exact front of a room with two obstacles, on a map that is turned."""
    occupied = np.zeros((12, 16), dtype=bool)
    occupied[3:9, 4:6] = occupied[4:11, 10:12] = True
    origin = (0.0, 0.0) if resolution is None else (1.5, -2.0, 0.5)
    grid = OccupancyGrid(occupied, resolution, origin, name=name)
    objectives = ["length", Vulnerability(variance=2.0), Hostile() if hostile else "turn"][:n_obj]
    problem = GridPathProblem(grid, (0, 5), (15, 6), "cells", objectives)
    return TradeOffSet.from_genes(problem, problem.pareto_set(max_seconds=60))
