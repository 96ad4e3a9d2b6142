"""Searching a grid: its legal steps as arrays, and the shortest-path kernels that read them."""

from __future__ import annotations

from pymoo_gridpath.search.moves import DIAGONAL, HEADING_OF, HEADINGS, Moves, turn_units
from pymoo_gridpath.search.shortest import UNREACHABLE, backward_costs

__all__ = ["DIAGONAL", "HEADINGS", "HEADING_OF", "UNREACHABLE", "Moves", "backward_costs", "turn_units"]
