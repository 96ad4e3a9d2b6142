"""What a grid takes as cells, poses and points."""

from __future__ import annotations

from numbers import Real
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from pymoo_gridpath import checks
from pymoo_gridpath.checks import shown
from pymoo_gridpath.errors import GridError, GridPathError
from pymoo_gridpath.neighbourhood import MOVES, ONE_SIDE

Cell = tuple[int, int]

#: Corners of a robot's outline, metres in its own frame.
Footprint = tuple[tuple[float, float], ...]

#: Whether a diagonal step may touch an occupied cell: never, always, or one of the two beside it.
CornerCutting = bool | Literal["one side"]


def as_cells(name: str, cells: ArrayLike) -> np.ndarray:
    """Return a read-only bool copy of an array of 0 and 1, or the array itself if it is as such a copy."""
    values = "0 (free) and 1 (occupied)" if name == "occupied" else "0 and 1"
    array = checks.array(name, cells, expected=f"a two-dimensional array of booleans, or of {values}", error=GridError)
    if array.ndim != 2:
        raise GridError(f"a grid needs a two-dimensional array of {name} cells, got {array.ndim} dimensions")
    if array.size == 0:
        raise GridError(f"a grid needs at least one cell, got an array of shape {array.shape}")
    if array.dtype != bool and not np.isin(array, (0, 1)).all():
        raise GridError(f"a grid needs an array of booleans, or of {values}, as {name} cells, got other values")
    flags = array.flags
    if type(array) is np.ndarray and array.dtype == bool and flags.owndata and flags.c_contiguous and not flags.writeable:
        return array  # nobody writes into it, and on large maps copies are what takes the memory
    # Row by row whatever the order of the given one, for its bytes and its flat view are those of the grid.
    copy = array.astype(bool, order="C")
    copy.flags.writeable = False
    return copy


def as_corner_cutting(value: Any, error: type[GridPathError] = GridError) -> CornerCutting:
    """Return a rule for corners."""
    if isinstance(value, str) and value == ONE_SIDE:
        return "one side"
    return checks.flag("corner_cutting", value, error, expected=f"True, False or {ONE_SIDE!r}")


def as_moves(value: Any, error: type[GridPathError] = GridError) -> int:
    """Return a number of steps from a cell."""
    expected = " or ".join(map(str, MOVES))
    if checks.whole("moves", value, expected=expected, error=error) not in MOVES:
        raise error(f"moves is {shown(value)}, expected {expected}")
    return int(value)


def as_cell(role: str, cell) -> Cell:
    """Return a cell as a pair of ints, on the grid or not."""
    if type(cell) is tuple and len(cell) == 2 and type(cell[0]) is int and type(cell[1]) is int:
        return cell
    try:
        x, y = (int(v) for v in cell)
        whole = all(isinstance(v, Real) for v in cell) and (x, y) == tuple(cell)
    except Exception:
        whole, x, y = False, 0, 0
    if not whole or (isinstance(cell, np.ma.MaskedArray) and np.ma.getmaskarray(cell).any()):
        raise GridError(f"{role} is {shown(cell)}, expected a cell (x, y) of two whole numbers")
    return x, y


def as_resolution(resolution) -> float | None:
    """Return the side of a cell in metres; None of a map in cells."""
    if resolution is None:
        return None
    expected = "a positive number of metres per cell"
    return checks.number("resolution", resolution, 0.0, above=True, expected=expected, error=GridError)


def as_pose(origin) -> tuple[float, ...]:
    """Return (x, y, yaw)."""
    expected = "(x, y) or (x, y, yaw) in metres and radians"
    try:
        pose = tuple(checks.number("origin", v, expected=expected) for v in checks.items("origin", origin, expected, most=3))
    except GridPathError:
        pose = ()
    if len(pose) not in (2, 3):
        raise GridError(f"origin is {shown(origin)}, expected {expected}")
    return pose if len(pose) == 3 else (*pose, 0.0)


def as_footprint(corners) -> Footprint:
    """Return the corners of a robot's outline."""
    expected = "the corners (x, y) of the robot in metres, three or more"
    found = checks.array("footprint", corners, (None, 2), expected=expected, finite=True, error=GridError).astype(float)
    if len(found) < 3 or not (found != found[0]).any():
        raise GridError(f"footprint is {shown(corners)}, expected {expected}")
    return tuple(map(tuple, found.tolist()))


def pairs(name: str, values: ArrayLike, what: str) -> np.ndarray:
    """Return an array of pairs of finite numbers, shape (..., 2)."""
    expected = f"{what} as numbers of shape (..., 2)"
    found = checks.array(name, values, expected=expected, finite=True, error=GridError)
    if found.shape[-1:] != (2,):
        raise GridError(f"{name} is {shown(found)}, expected {expected}")
    return found
