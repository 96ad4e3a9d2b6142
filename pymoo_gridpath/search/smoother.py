"""Waypoints of paths that keep as clear of obstacles as the paths do."""

from __future__ import annotations

import functools
import math

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.grid import Cell, OccupancyGrid
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.nearest import Nearest
from pymoo_gridpath.search.sight import Promise, places_of_farthest
from pymoo_gridpath.search.waypoints import Waypoints, metres_of

# In cells: centres of cells stand for points half a cell around.
DEFAULT_TOLERANCE = 0.5


class Smoother:
    """What makes waypoints of the paths from a start; what all of them need is made once, and only if it is needed.

    Parameters
    ----------
    grid : OccupancyGrid
    start : (int, int)
    timed : bool, default False
        Whether paths are cells at each tick. Their waypoints are these cells: at any other place an obstacle may be in the way.
    """

    def __init__(self, grid: OccupancyGrid, start: Cell, timed: bool = False):
        self.grid, self.start, self.timed = grid, start, timed

    @functools.cached_property
    def _moves(self) -> Moves:
        return Moves(self.grid, box=self.grid.box_of(self.start))

    @functools.cached_property
    def _nearest(self) -> Nearest:
        # The nearest grown obstacles are in the part that can be reached; what they grew from is within the radius of that.
        further = math.ceil(self.grid.growth) + 2
        box = self._moves.box.grown(further, self.grid.shape)
        return Nearest(self.grid.original.occupied[box.slices], (box.x0, box.y0))

    def waypoints(self, cells: np.ndarray, tolerance: float | None = None, spacing: float | None = None) -> Waypoints:
        """Return the waypoints of a legal path, see `PathRecord.waypoints`."""
        before = Waypoints(self.grid, cells, nearest=self._nearest)
        made = Waypoints(self.grid, cells[self.places(cells, tolerance)], before, self._nearest)
        if spacing is None:
            return made
        if self.timed:
            raise GridPathError("spacing is not for a path in time, whose waypoints are its cells at each tick")
        return made.resampled(spacing)

    def places(self, cells: np.ndarray, tolerance: float | None = None) -> np.ndarray:
        """Return which cells of a legal path are its waypoints, int64, by their places in it."""
        if self.timed:
            if tolerance is not None:
                raise GridPathError("tolerance is not for a path in time, whose waypoints are its cells at each tick")
            return np.arange(len(cells))
        promise = Promise.of(self._nearest, cells, self._in_cells(tolerance), self.grid.growth)
        corner = self._moves.box.x0, self._moves.box.y0
        path = (cells - corner) @ np.array([1, self._moves.width])
        return places_of_farthest(self._moves, path.astype(np.int64), False, promise)

    def _in_cells(self, tolerance: float | None) -> float:
        if tolerance is None:
            return DEFAULT_TOLERANCE
        expected = f"a number of {'cells' if self.grid.resolution is None else 'metres'}, zero or more"
        return checks.number("tolerance", tolerance, 0.0, infinite=True, expected=expected) / metres_of(self.grid)
