"""Representations: how a path becomes a row of decision variables, and back."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.paths.frame import Axis, check_axis
from pymoo_gridpath.representations.absolute import AbsoluteRepresentation
from pymoo_gridpath.representations.base import MonotoneRepresentation, Representation
from pymoo_gridpath.representations.binary import BinaryRepresentation
from pymoo_gridpath.representations.cell_sequence import CellSequence
from pymoo_gridpath.representations.integer import IntegerRepresentation
from pymoo_gridpath.representations.mixed import MixedRepresentation

#: The representations by name.
REPRESENTATIONS: dict[str, type[Representation]] = {
    cls.name: cls
    for cls in (IntegerRepresentation, BinaryRepresentation, MixedRepresentation, AbsoluteRepresentation, CellSequence)
}


def default_representation(corner_cutting: bool, axis: Axis = "auto") -> str:
    """Return the name of the representation of a query for which none is given.

    Parameters
    ----------
    corner_cutting : bool
        Whether corners may be cut on the grid.
    axis : {"auto", "x", "y"}, default "auto"

    Returns
    -------
    str
        "cells", which codes every path; "integer", the paper's, where corners may be cut, which is the world of the paper, or
        where an axis is given, along which paths are to advance.

    Raises
    ------
    GridPathError
        If corner_cutting is no truth value, or there is no such axis.

    Examples
    --------
    >>> default_representation(corner_cutting=False), default_representation(corner_cutting=True)
    ('cells', 'integer')
    """
    check_axis(axis)
    return IntegerRepresentation.name if checks.flag("corner_cutting", corner_cutting) or axis != "auto" else CellSequence.name


def make_representation(
    name: str, grid: OccupancyGrid, start: Sequence[int], goal: Sequence[int], axis: Axis = "auto"
) -> Representation:
    """Return the representation of that name for a query on a grid.

    Parameters
    ----------
    name : {"integer", "binary", "mixed", "absolute", "cells"}
    grid : OccupancyGrid
    start, goal : (int, int)
        Cells (x, y).
    axis : {"auto", "x", "y"}, default "auto"
        See `MonotoneFrame`; "cells" has no axis and takes "auto" only.

    Returns
    -------
    Representation

    Raises
    ------
    GridPathError
        If there is no such representation, or it has no axis and one is given.
    GridError, UnreachableError
        If the query cannot be used, see `MonotoneFrame` and `CellSequence`.
    """
    representation: Any = REPRESENTATIONS[checks.known("representation", name, REPRESENTATIONS)]
    if issubclass(representation, MonotoneRepresentation):
        return representation(grid, start, goal, axis)
    if check_axis(axis) != "auto":
        raise GridPathError(f"axis is {axis!r}, but paths of the {name} representation advance along none; expected 'auto'")
    return representation(grid, start, goal)


__all__ = [
    "REPRESENTATIONS",
    "AbsoluteRepresentation",
    "BinaryRepresentation",
    "CellSequence",
    "IntegerRepresentation",
    "MixedRepresentation",
    "MonotoneRepresentation",
    "Representation",
    "default_representation",
    "make_representation",
]
