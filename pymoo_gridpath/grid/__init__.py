"""Occupancy grids: which cells are occupied, how large they are, where they lie, and how corners are passed."""

from pymoo_gridpath.grid.arguments import Cell
from pymoo_gridpath.grid.box import Box
from pymoo_gridpath.grid.cells import SQRT2
from pymoo_gridpath.grid.occupancy import OccupancyGrid, check_box, check_grid

__all__ = ["SQRT2", "Box", "Cell", "OccupancyGrid", "check_box", "check_grid"]
