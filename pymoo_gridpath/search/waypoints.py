"""Waypoints: the corners of a line that can be driven, what they measure, and the files that controllers take."""

from __future__ import annotations

import functools
import math
import os
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.files import write_whole
from pymoo_gridpath.grid import OccupancyGrid, check_grid
from pymoo_gridpath.search import waypoint_files
from pymoo_gridpath.search.nearest import Nearest

# More points than this are a slip of the spacing.
_MOST_POINTS = 1_000_000


class Clearance(NamedTuple):
    """Distance of a robot on a line from obstacles: least, and mean along the line."""

    least: float
    mean: float


class Waypoints:
    """Points of a line from a start to a goal, straight from each to the next.

    Those of planners, and what `PathRecord.waypoints` makes of a path, are the corners of a line every piece of which is a line
    of sight: it crosses no occupied cell, and the cells that stand for it on the grid are a chain of legal steps.

    Parameters
    ----------
    grid : OccupancyGrid
    cells : array_like, shape (n, 2)
        The points in cells (x, y): whole numbers are centres.
    before : Waypoints, optional
        Each cell of the path that these were made of.
    nearest : Nearest, optional
        Of the obstacles that clearance is from, if it is known already.

    Attributes
    ----------
    grid : OccupancyGrid
    cells : numpy.ndarray, shape (n, 2)
        Of type int where all points are centres of cells.
    before : Waypoints or None

    Raises
    ------
    GridPathError
        If the points are none, or not one.

    Examples
    --------
    >>> grid = OccupancyGrid([[0, 0, 0, 0, 0], [0, 0, 0, 0, 0], [0, 0, 0, 0, 1]], resolution=0.5)
    >>> line = Waypoints(grid, [[0, 0], [3, 0], [3, 2]])
    >>> line.length_m, line.yaw.round(2).tolist(), line.clearance_m.least
    (2.5, [0.0, 1.57, 1.57], 0.25)
    >>> line.resampled(0.7).points.tolist()
    [[0.25, 0.25], [0.75, 0.25], [1.25, 0.25], [1.75, 0.25], [1.75, 0.75], [1.75, 1.25]]
    """

    def __init__(self, grid: OccupancyGrid, cells: ArrayLike, before: Waypoints | None = None, nearest: Nearest | None = None):
        self.grid, self.before, self._given = check_grid(grid), before, nearest
        self.cells = checks.array(
            "cells", cells, (None, 2), "iuf", expected="points (x, y) in cells, one at least, of shape (n, 2)", finite=True
        )
        if not len(self.cells):
            raise GridPathError("there are no cells, expected one point at least")

    def __len__(self) -> int:
        return len(self.cells)

    # -- what they measure --------------------------------------------------------------------------------------------

    @functools.cached_property
    def points(self) -> np.ndarray:
        """The points in metres in the frame of the map, float, shape (n, 2); in cells, on a map that has no metres."""
        return self.cells.astype(float) if self.grid.resolution is None else self.grid.to_metres(self.cells)

    @property
    def length(self) -> float:
        """Euclidean length in cells."""
        return float(np.hypot(*np.diff(self.cells, axis=0).T).sum())

    @property
    def length_m(self) -> float | None:
        """Euclidean length in metres, None on a map in cells."""
        return None if self.grid.resolution is None else self.length * self.grid.resolution

    @property
    def yaw(self) -> np.ndarray:
        """Heading at each point, radians from the map's x axis, counter-clockwise, from -pi to pi, shape (n,).

        It is that of the line to the next point; at the last, and where a path waits, that before. A single point has 0.
        """
        legs = np.diff(self.points, axis=0)
        moves = np.flatnonzero(legs.any(axis=1))
        if not len(moves):
            return np.zeros(len(self))
        # Of each point the last leg, up to the next one, that leads somewhere, or else the first of all.
        last = np.maximum(np.searchsorted(moves, np.arange(len(self)), side="right") - 1, 0)
        return np.arctan2(legs[moves, 1], legs[moves, 0])[last]

    @property
    def turn(self) -> float:
        """Total turn in degrees, the sum of the absolute changes of heading."""
        return math.degrees(np.abs(np.remainder(np.diff(self.yaw) + math.pi, 2 * math.pi) - math.pi).sum())

    @property
    def curvature(self) -> tuple[float, float]:
        """Greatest and mean curvature, 1 / m; one by cells on a map in cells.

        A polyline has none of its own: it is 0 along a piece and infinite at a corner. So the line is cut into pieces of one
        cell, as near as their number allows, and the curvature is Menger's, that of the circle through three of their ends.
        """
        along_it = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(self.points, axis=0).T))])
        at = np.linspace(0.0, along_it[-1], max(round(self.length), 2) + 1)
        points = np.stack([np.interp(at, along_it, self.points[:, axis]) for axis in (0, 1)], axis=1)
        curvature = np.abs(waypoint_files.signed_curvature(points))
        return float(curvature.max()), float(curvature.mean())

    @functools.cached_property
    def clearance(self) -> Clearance:
        """Distance in cells from the sides of obstacles, beyond the radius of the robot if the grid was inflated by one.

        It is that of the line, not of its points alone: the least is exact, the mean is that of 8 points a cell.
        """
        radius = self.grid.growth
        return Clearance(self._nearest.least(self.cells) - radius, self._nearest.mean(self.cells) - radius)

    @property
    def clearance_m(self) -> Clearance | None:
        """The same in metres, None on a map in cells."""
        metres = self.grid.resolution
        return None if metres is None else Clearance(self.clearance.least * metres, self.clearance.mean * metres)

    @functools.cached_property
    def _nearest(self) -> Nearest:
        return Nearest(self.grid.original.occupied) if self._given is None else self._given

    def __repr__(self) -> str:
        return f"<Waypoints: {len(self)} points, {self.length:.2f} cells>"

    def __str__(self) -> str:
        """Return what they measure in words, after what the path did."""
        unit, metres = "cells" if self.grid.resolution is None else "m", metres_of(self.grid)
        lines = [self] if self.before is None else [self.before, self]
        said = {
            "points": [f"{len(one)}" for one in lines],
            "length": [f"{one.length * metres:.2f}" for one in lines],
            "turn": [f"{one.turn:.0f}" for one in lines],
            "least clearance": [f"{one.clearance.least * metres:.3f}" for one in lines],
            "mean": [f"{one.clearance.mean * metres:.3f}" for one in lines],
        }
        units = {"points": "", "length": f" {unit}", "turn": " degrees"}
        return ", ".join(f"{key} {' to '.join(values)}{units.get(key, f' {unit}')}" for key, values in said.items())

    # -- other points of the same line --------------------------------------------------------------------------------

    def resampled(self, spacing: float) -> Waypoints:
        """Return points of the same line, corners among them, none further from the next than a spacing.

        Parameters
        ----------
        spacing : float
            In metres; in cells on a map that has no metres. Each piece of the line is divided evenly.

        Raises
        ------
        GridPathError
            If it is not above 0, or so small that there would be more than a million points.
        """
        expected = "a distance in metres, above zero" if self.grid.resolution is not None else "a number of cells, above zero"
        spacing = checks.number("spacing", spacing, 0.0, above=True, expected=expected) / metres_of(self.grid)
        legs = np.hypot(*np.diff(self.cells, axis=0).T)
        with np.errstate(over="ignore"):
            # A piece that is a whole number of spacings long is not to have one more for rounding.
            parts = np.maximum(np.ceil(legs / spacing - 1e-9), 1.0)
        if parts.sum() >= _MOST_POINTS:
            raise GridPathError(
                f"a spacing of {spacing * metres_of(self.grid):g} makes over a million points, expected a larger one"
            )
        steps = [np.arange(n) / n for n in parts.astype(int)]
        between = [a + t[:, None] * (b - a) for a, b, t in zip(self.cells[:-1], self.cells[1:], steps, strict=True)]
        return Waypoints(self.grid, np.concatenate([*between, self.cells[-1:].astype(float)]), self.before, self._given)

    # -- files --------------------------------------------------------------------------------------------------------

    def to_csv(self, path: str | os.PathLike[str]) -> Path:
        """Write a line ``x,y,yaw`` a point under one that says so, metres and radians in the frame of the map.

        On a map that has no metres, x and y are cells.
        """
        return write_whole(path, waypoint_files.csv_text(self.points, self.yaw).encode())

    def to_nav_path(self, path: str | os.PathLike[str], frame_id: str = "map") -> Path:
        """Write the ROS 2 message nav_msgs/Path as YAML, such as ``ros2 topic echo`` prints and ``ros2 topic pub`` takes.

        Parameters
        ----------
        path : str or path-like
        frame_id : str, default "map"
            The frame in which the map stands, of the message and of each pose. Stamps are 0.

        Raises
        ------
        GridPathError
            If the map has no metres, the frame is no text, or the file cannot be written.
        """
        self.grid.check_resolution("nav_msgs/Path")
        text = waypoint_files.nav_path_text(self.points, self.yaw, str(checks.text("frame_id", frame_id)))
        return write_whole(path, text.encode())

    def to_f1tenth(self, path: str | os.PathLike[str], speed: float = 1.0) -> Path:
        """Write a racing line file of F1TENTH: ``s_m; x_m; y_m; psi_rad; kappa_radpm; vx_mps; ax_mps2``, under three comments.

        Parameters
        ----------
        path : str or path-like
        speed : float, default 1.0
            Metres per second at every point, so that the acceleration is 0.

        Raises
        ------
        GridPathError
            If the map has no metres, the speed is negative or not finite, or the file cannot be written.

        Notes
        -----
        Headings are from the x axis and from 0 to 2 pi, as in the tracks of F1TENTH; the optimiser that these come from is
        documented to count from the y axis. Curvature is that of the circle through a point and those before and after,
        positive to the left, and 0 at both ends: take a spacing. These files hold laps in general; a path has an end.
        """
        self.grid.check_resolution("a racing line")
        speed = checks.number("speed", speed, 0.0, expected="metres per second, zero or more")
        return write_whole(path, waypoint_files.f1tenth_text(self.points, self.yaw, speed).encode())


def metres_of(grid: OccupancyGrid) -> float:
    """Return the side of a cell in metres, 1 of a map in cells, whose unit they are."""
    return 1.0 if grid.resolution is None else grid.resolution
