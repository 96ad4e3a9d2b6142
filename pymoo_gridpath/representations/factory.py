"""Representations by name, and which is taken where none is given."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.grid import CornerCutting, OccupancyGrid
from pymoo_gridpath.grid.arguments import as_corner_cutting
from pymoo_gridpath.paths.frame import Axis, check_axis
from pymoo_gridpath.representations.absolute import AbsoluteRepresentation
from pymoo_gridpath.representations.base import REPRESENTATIONS, Representation
from pymoo_gridpath.representations.binary import BinaryRepresentation
from pymoo_gridpath.representations.cell_sequence import CellSequence
from pymoo_gridpath.representations.integer import IntegerRepresentation
from pymoo_gridpath.representations.mixed import MixedRepresentation
from pymoo_gridpath.representations.sugihara_smith import SugiharaSmithRepresentation

for _cls in (
    IntegerRepresentation,
    BinaryRepresentation,
    MixedRepresentation,
    AbsoluteRepresentation,
    SugiharaSmithRepresentation,
    CellSequence,
):
    REPRESENTATIONS.register(_cls)


def default_representation(corner_cutting: CornerCutting, axis: Axis = "auto") -> str:
    """Return the name of the representation of a query for which none is given.

    Parameters
    ----------
    corner_cutting : bool or "one side"
        How corners may be cut on the grid.
    axis : {"auto", "x", "y"}, default "auto"

    Returns
    -------
    str
        "cells", which codes every path; "integer", the paper's, where all corners may be cut, as in the world of the paper, or
        where an axis is given, along which paths are to advance.

    Raises
    ------
    GridPathError
        If there is no such rule for corners, or no such axis.

    Examples
    --------
    >>> default_representation(corner_cutting=False), default_representation(corner_cutting=True)
    ('cells', 'integer')
    """
    check_axis(axis)
    corner_cutting = as_corner_cutting(corner_cutting, GridPathError)
    return IntegerRepresentation.name if corner_cutting is True or axis != "auto" else CellSequence.name


def make_representation(
    representation: str | type[Representation],
    grid: OccupancyGrid,
    start: Sequence[int],
    goal: Sequence[int],
    axis: Axis = "auto",
    fields: Iterable = (),
    turning: bool = False,
) -> Representation:
    """Return the representation of a name for a query on a grid.

    Parameters
    ----------
    representation : str or type
        One of `REPRESENTATIONS`: "integer", "binary", "mixed", "absolute", "sugihara-smith", "cells", or another that is
        registered; or the class itself.
    grid : OccupancyGrid
    start, goal : (int, int)
        Cells (x, y).
    axis : {"auto", "x", "y"}, default "auto"
        See `MonotoneFrame`. Those that are not monotone, such as "cells", have no axis and take "auto" only.
    fields : iterable of numpy.ndarray, shape (height, width), optional
        Costs of cells, the sums of which paths are to be scored by; for representations that want them.
    turning : bool, default False
        Whether paths are to be scored by how much they turn, too. Such paths, and compromises between several fields, may be
        longer than the cheapest in one field: a representation that wants fields is told to spare room for twice their length.

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
    cls: Any = representation
    if not isinstance(cls, type):
        cls = REPRESENTATIONS[checks.known("representation", representation, REPRESENTATIONS)]
    elif not issubclass(cls, Representation):
        raise GridPathError(f"representation is {checks.shown(cls)}, expected a class derived from Representation")
    if not cls.monotone and check_axis(axis) != "auto":
        raise GridPathError(f"axis is {axis!r}, but paths of the {cls.name} representation advance along none; expected 'auto'")
    options: dict[str, Any] = {"axis": axis} if cls.monotone else {}
    if cls.wants_fields:
        costs = list(fields)
        options |= {"fields": costs, "spare": 2.0 if turning or len(costs) > 1 else 1.0}
    return cls(grid, start, goal, **options)
