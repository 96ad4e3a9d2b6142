"""Grids whose obstacles were grown by a robot's size, which remember what the obstacles were before."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, Self

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.checks import shown
from pymoo_gridpath.errors import GridError, GridPathWarning
from pymoo_gridpath.grid.arguments import Footprint, as_footprint
from pymoo_gridpath.grid.inflation import disc_of, grown_by
from pymoo_gridpath.grid.placed import PlacedCells


class Growth(NamedTuple):
    """What the obstacles of a grid were grown from, and by what: see the properties of `GrownCells` of these names."""

    original: Any
    robot_radius: float
    footprint: Footprint | None


class GrownCells(PlacedCells):
    """What an `OccupancyGrid` knows of the obstacles that there were before they grew."""

    replace: Any

    _growth: Growth | None = None

    @property
    def original(self) -> Self:
        """The grid from whose obstacles those of this one were grown, of the same shape and place; itself where none were.

        However often obstacles grew, it is the first. `crop`, `downsample` and `replace` do to it what they do to the grid,
        but ``replace(occupied=...)`` makes cells that were grown from nothing. As the unknown cells, it is no part of what
        makes two grids equal, nor of the `digest`.
        """
        return self if self._growth is None else self._growth.original

    @property
    def robot_radius(self) -> float:
        """By how many metres obstacles grew in all (of a map in cells, how many cells): the robot's radius, 0 of a point.

        Of a footprint it is the distance of its farthest corner from the robot's origin; of a grid that was inflated twice it
        is the sum.
        """
        return 0.0 if self._growth is None else self._growth.robot_radius

    @property
    def growth(self) -> float:
        """The `robot_radius` in cells, whatever the unit of the map; at most the width and height together."""
        return min(self.robot_radius / self._cell, float(sum(self.shape)))

    @property
    def footprint(self) -> Footprint | None:
        """Corners (x, y) of the robot in metres, if obstacles grew by its footprint, and by nothing else."""
        return None if self._growth is None else self._growth.footprint

    @property
    def grown_cells(self) -> np.ndarray | None:
        """Cells that are occupied because obstacles grew, bool, shape (height, width); None where none did."""
        return None if self._growth is None else self._occupied & ~self._growth.original.occupied

    def grown_from(self, original: Self, robot_radius: float, footprint: Sequence[Sequence[float]] | None = None) -> Self:
        """Return this grid as one whose obstacles are those of another, grown; for what was inflated elsewhere.

        Parameters
        ----------
        original : OccupancyGrid
            Of the same shape, resolution and origin; each of its occupied cells is occupied here.
        robot_radius : float
            Metres by which they grew, or on a map in cells the number of cells; zero or more.
        footprint : sequence of (float, float), optional
            Corners of the robot, if they grew by these.

        Returns
        -------
        OccupancyGrid
            Its `original` is that of ``original``.

        Raises
        ------
        GridError
            If the other grid is none from which this one can have been grown, or the radius or the footprint is none.
        """
        checks.instance("original", original, GrownCells, error=GridError)
        radius = checks.number("robot_radius", robot_radius, 0.0, expected="metres, zero or more", error=GridError)
        corners = None if footprint is None else as_footprint(footprint)
        for what in ("shape", "resolution", "origin"):
            mine, other = getattr(self, what), getattr(original, what)
            if mine != other:
                raise GridError(f"the original grid has the {what} {shown(other)}, expected that of the grid, {shown(mine)}")
        lost = original.occupied & ~self._occupied
        if lost.any():
            y, x = np.argwhere(lost)[0].tolist()
            raise GridError(f"({x}, {y}) is occupied on the original grid and free on the grown one, expected it occupied")
        made = self.replace(occupied=self._occupied, unknown=self._unknown)
        made._growth = Growth(original.original, radius, corners)
        return made

    def _with_growth(self, made, change: Callable, scale: float = 1.0):
        """Return a grid that was made of this one as grown from what the same change makes of the original."""
        if self._growth is None:
            return made
        original, radius, corners = self._growth
        scaled = None if corners is None else [(x * scale, y * scale) for x, y in corners]
        return made.grown_from(change(original), radius * scale, scaled)

    # -- growing ------------------------------------------------------------------------------------------------------

    def inflate(self, radius: float = 0.0, footprint: Sequence[Sequence[float]] | None = None) -> Self:
        """Return a grid on which a disc of ``radius`` metres can be planned for as a point, or a robot of some footprint.

        A cell becomes occupied when a disc centred in it would overlap the square of an occupied cell. The edge of the grid
        is not an obstacle. The grid remembers what it grew from, see `original` and `robot_radius`.

        Parameters
        ----------
        radius : float, default 0.0
        footprint : sequence of (float, float), optional
            In place of the radius, the corners (x, y) of the robot's outline in metres, in its own frame: what stands at a
            path's point is (0, 0). Obstacles grow by the union of the outline over all headings, which is the disc out to its
            farthest corner: safe whichever way the robot heads or turns on its way, and no tighter, so that a long robot is
            kept out of passages which it could take lengthwise.

        Raises
        ------
        GridError
            If the radius is negative or not finite, the footprint is no polygon, both are given, or the map is one in cells,
            for which there is `grow`.

        Warns
        -----
        GridPathWarning
            If the radius is not zero but too small to have an effect: at most half a cell.
        """
        corners = None if footprint is None else as_footprint(footprint)
        cells = self.radius_in_cells(radius)
        if corners is not None:
            if cells > 0:
                raise GridError(f"there are a radius of {shown(radius)} and a footprint, expected one of them")
            radius = max(math.hypot(*corner) for corner in corners)
            cells = self.radius_in_cells(radius)
        if cells == 0:
            return self
        occupied = self._grown(cells)
        if occupied is self._occupied:
            warnings.warn(
                f"the robot radius of {radius:g} m is at most half a cell of {checks.shown(self.name)}, {self.resolution:g} m "
                "wide, so that no obstacle grows",
                GridPathWarning,
                stacklevel=2,
            )
        return self._as_grown(occupied, float(radius), corners)

    def grow(self, cells: float) -> Self:
        """Return what `inflate` does for a radius that is given in cells, without a warning; half a cell or less grows nothing.

        Raises
        ------
        GridError
            If the number is negative or not finite.
        """
        cells = checks.number("growth", cells, 0.0, expected="a number of cells, zero or more", error=GridError)
        occupied = self._grown(cells)
        return self if occupied is self._occupied else self._as_grown(occupied, cells * self._cell, None)

    def radius_in_cells(self, radius: float) -> float:
        """Return the radius of a robot, given in metres, in cells; at most the width and height together, which cover all.

        Raises
        ------
        GridError
            If the radius is negative or not finite, or not zero on a map in cells.
        """
        radius = checks.number("robot radius", radius, 0.0, expected="a number of metres, zero or more", error=GridError)
        if radius == 0.0:
            return 0.0
        return min(radius / self.check_resolution("a radius in metres"), float(sum(self.shape)))

    @property
    def _cell(self) -> float:
        """The side of a cell in the unit of the map: metres, or cells."""
        return 1.0 if self.resolution is None else self.resolution

    def _grown(self, cells: float) -> np.ndarray:
        """Return the occupied cells grown by a disc, or themselves if it is no wider than a cell."""
        disc = disc_of(cells, max(self.shape))
        return self._occupied if disc.sum() <= 1 else grown_by(self._occupied, disc, self._free_box)

    def _as_grown(self, occupied: np.ndarray, radius: float, corners: Footprint | None):
        before = self._growth
        made = self.replace(occupied=occupied)
        made._growth = Growth(self.original, self.robot_radius + radius, corners if before is None else None)
        return made
