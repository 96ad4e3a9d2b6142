"""Occupancy grids: which cells are occupied, how large they are, where they lie, and how corners are passed."""

from pymoo_gridpath.grid.arguments import Cell, CornerCutting
from pymoo_gridpath.grid.box import Box
from pymoo_gridpath.grid.occupancy import OccupancyGrid, check_box, check_grid
from pymoo_gridpath.neighbourhood import SQRT2

__all__ = ["SQRT2", "Box", "Cell", "CornerCutting", "OccupancyGrid", "check_box", "check_grid"]
