"""Representations: how a path becomes a row of decision variables, and back."""

from __future__ import annotations

from collections.abc import Sequence

from pymoo_gridpath.errors import GridPathError, nearest
from pymoo_gridpath.frame import Axis
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.representations.absolute import AbsoluteRepresentation
from pymoo_gridpath.representations.base import MonotoneRepresentation, Representation
from pymoo_gridpath.representations.binary import BinaryRepresentation
from pymoo_gridpath.representations.integer import IntegerRepresentation
from pymoo_gridpath.representations.mixed import MixedRepresentation

#: The representations by name.
REPRESENTATIONS: dict[str, type[MonotoneRepresentation]] = {
    cls.name: cls for cls in (IntegerRepresentation, BinaryRepresentation, MixedRepresentation, AbsoluteRepresentation)
}


def make_representation(
    name: str, grid: OccupancyGrid, start: Sequence[int], goal: Sequence[int], axis: Axis = "auto"
) -> MonotoneRepresentation:
    """Return the representation of that name for a query on a grid.

    Parameters
    ----------
    name : {"integer", "binary", "mixed", "absolute"}
    grid : OccupancyGrid
    start, goal : (int, int)
        Cells (x, y).
    axis : {"auto", "x", "y"}, default "auto"
        See `MonotoneFrame`.

    Raises
    ------
    GridPathError
        If there is no such representation.
    GridError, UnreachableError
        If the query cannot be used, see `MonotoneFrame`.
    """
    if name not in REPRESENTATIONS:
        raise GridPathError(f"there is no representation {name!r}; {nearest(name, REPRESENTATIONS)}")
    return REPRESENTATIONS[name](grid, start, goal, axis)


__all__ = [
    "REPRESENTATIONS",
    "AbsoluteRepresentation",
    "BinaryRepresentation",
    "IntegerRepresentation",
    "MixedRepresentation",
    "MonotoneRepresentation",
    "Representation",
    "make_representation",
]
