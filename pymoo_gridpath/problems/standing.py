"""The query of which the goal is the start, whose only path is to stay."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pymoo_gridpath.grid import Cell, OccupancyGrid, check_grid
from pymoo_gridpath.objectives import Objective
from pymoo_gridpath.paths import CellPaths
from pymoo_gridpath.problems.grid_path import GridPathProblem, Obstacles
from pymoo_gridpath.representations import Representation


class Standing(Representation):
    """The code of the path that visits one cell: the index of that cell.

    Parameters
    ----------
    grid : OccupancyGrid
    cell : (int, int)
        A free cell.
    """

    name = "standing"

    def __init__(self, grid: OccupancyGrid, cell: Sequence[int]):
        self.grid = check_grid(grid)
        self.start = self.goal = grid.check_cell(cell, "start")
        self.n_var = self.max_cells = 1
        self.xl = self.xu = np.array([self.start[1] * grid.width + self.start[0]])

    def decode(self, X):
        """Return the same path for each row."""
        return CellPaths(self.grid, self.genes(X))

    def from_sequences(self, sequences):
        """Return the same row for each path."""
        return np.repeat(self.xl[None], len(self._checked_ends(sequences).lengths), axis=0)


class StandingProblem(GridPathProblem):
    """A robot that is where it is to go: what files and figures of its one path are made from. There is nothing to search.

    Parameters
    ----------
    grid : OccupancyGrid
    cell : (int, int)
        A free cell, start and goal.
    objectives, obstacles, penalty, potential_limit
        As of `GridPathProblem`.
    """

    def __init__(
        self,
        grid: OccupancyGrid,
        cell: Sequence[int],
        objectives: Sequence[str | Objective] = ("length", "vulnerability"),
        obstacles: Obstacles = "penalty",
        penalty: float | None = None,
        potential_limit: float | None = None,
    ):
        super().__init__(grid, cell, cell, Standing(grid, cell), objectives, obstacles, penalty, potential_limit)

    def _check_ends(self, start: Sequence[int], goal: Sequence[int]) -> tuple[Cell, Cell]:
        cell = self.grid.check_cell(start, "start")
        return cell, cell

    @property
    def row(self) -> np.ndarray:
        """The genes of the path, shape (1, 1)."""
        return self.representation.xl[None]
