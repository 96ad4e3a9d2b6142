"""Searching a grid: its legal steps as arrays, and the shortest-path kernels that read them."""

from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.shortest import UNREACHABLE, backward_costs

__all__ = ["UNREACHABLE", "Moves", "backward_costs"]
