"""Cells that have a place and a size in metres, where the map states it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from pymoo_gridpath import checks
from pymoo_gridpath.checks import shown
from pymoo_gridpath.errors import GridError
from pymoo_gridpath.grid.arguments import CornerCutting, as_pose, as_resolution, pairs
from pymoo_gridpath.grid.cells import Cells

# Numbers of cells that a float holds without gaps, with one bit to spare.
_FARTHEST = 2.0**52


class PlacedCells(Cells):
    """What an `OccupancyGrid` knows of metres; see there for the parameters."""

    def __init__(
        self,
        occupied: ArrayLike,
        resolution: float | None,
        origin: Sequence[float],
        corner_cutting: CornerCutting,
        name: str,
        unknown: ArrayLike | None,
        moves: int,
    ):
        super().__init__(occupied, corner_cutting, unknown, moves)
        self._resolution = as_resolution(resolution)
        self._origin = as_pose(origin)
        if self._resolution is None and any(self._origin):
            raise GridError(f"origin is {shown(origin)}, in metres, and no resolution is given, expected both or neither")
        if not math.isfinite((self._resolution or 0.0) * max(self.shape) + max(abs(v) for v in self._origin)):
            raise GridError(f"resolution {resolution} and origin {origin!r} put the map beyond what numbers can hold")
        self._name = checks.text("name", name, GridError)

    @property
    def resolution(self) -> float | None:
        """Side of a cell in metres; None of a map in cells."""
        return self._resolution

    @property
    def origin(self) -> tuple[float, ...]:
        """Pose (x, y, yaw) of the bottom-left corner of cell (0, 0), in metres and radians."""
        return self._origin

    @property
    def name(self) -> str:
        """What figures and files call this grid."""
        return self._name

    def check_resolution(self, need: str) -> float:
        """Return the side of a cell in metres, if the map states it.

        Parameters
        ----------
        need : str
            What needs it, as the error message names it, for instance ``"a radius in metres"``.

        Raises
        ------
        GridError
            If the map is one in cells.
        """
        if self._resolution is None:
            raise GridError(
                f"the grid {shown(self._name)} is in cells, and {checks.text('need', need, GridError)} needs their size; "
                "expected a map that states its resolution, or one given in metres per cell: resolution=0.05, or "
                "--resolution 0.05"
            )
        return self._resolution

    def to_metres(self, cells: ArrayLike) -> np.ndarray:
        """Return the centres of cells in the map's frame.

        Parameters
        ----------
        cells : array_like, shape (..., 2)
            Cells (x, y).

        Returns
        -------
        numpy.ndarray, shape (..., 2)
            Metres.

        Raises
        ------
        GridError
            If the cells are no pairs of numbers, or the map is one in cells.
        """
        resolution = self.check_resolution("a point in metres")
        local = (pairs("cells", cells, "cells (x, y)").astype(float) + 0.5) * resolution
        x0, y0, yaw = self._origin
        cos, sin = math.cos(yaw), math.sin(yaw)
        return local @ np.array([[cos, sin], [-sin, cos]]) + np.array([x0, y0])

    def to_cells(self, points: ArrayLike) -> np.ndarray:
        """Return the cells that hold points given in metres; the inverse of `to_metres` (cells may lie outside the grid).

        Parameters
        ----------
        points : array_like, shape (..., 2)
            Metres.

        Returns
        -------
        numpy.ndarray of int, shape (..., 2)

        Raises
        ------
        GridError
            If the points are no pairs of finite numbers, or lie more than 2**52 cells away; or if the map is one in cells.
        """
        resolution = self.check_resolution("a point in metres")
        x0, y0, yaw = self._origin
        cos, sin = math.cos(yaw), math.sin(yaw)
        local = (pairs("points", points, "points (x, y) in metres") - np.array([x0, y0])) @ np.array([[cos, -sin], [sin, cos]])
        with np.errstate(over="ignore"):
            cells = np.floor(local / resolution)
        if not (np.abs(cells) <= _FARTHEST).all():
            raise GridError("points lie further away than cells can be counted, expected metres in the frame of the map")
        return cells.astype(int)
