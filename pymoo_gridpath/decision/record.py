"""One path of a trade-off set, with its measures and its waypoints."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from pymoo_gridpath.decision import drawn
from pymoo_gridpath.errors import GridPathError, counted
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.pictures import png
from pymoo_gridpath.search.smoother import Smoother
from pymoo_gridpath.search.waypoints import Waypoints


@dataclass(frozen=True, eq=False)
class PathRecord:
    """One path of a trade-off set with its measures.

    Attributes
    ----------
    index : int
        Its place in the set.
    names : tuple of str
        Which of `NAMES` it goes by, or which else, such as "earliest" or "widest".
    cells : numpy.ndarray of int, shape (n_cells, 2)
        Visited cells (x, y), start and goal included; of a path in time its cell at each tick.
    points : numpy.ndarray of float, shape (n_cells, 2), or None
        Their centres in metres in the map's frame; None on a map in cells.
    length : float
        Length in cells.
    length_m : float or None
        Length in metres; None on a map in cells.
    vulnerability : float
        Sum of the obstacles' potential over the visited cells.
    turn : float
        Total turn in degrees.
    interfering_cells : int
        Number of occupied cells that it crosses; 0 for a legal path.
    clearance : float
        Least distance of a visited cell's centre from an occupied one's, in cells; ``inf`` on an empty grid. Of a path in time
        also from those of obstacles that move, at the same tick.
    clearance_m : float or None
        Least distance in metres between the robot on its way and the map's own obstacles, those of `OccupancyGrid.original`: of
        the straight lines through the centres of the cells from the nearest edge of an occupied cell, less the `robot_radius`.
        It is ``inf`` on an empty map, and never below 0 of a legal path on a grid that was inflated once, unless corners may be
        cut. Obstacles that move of paths in time are not among them. None on a map in cells.
    objectives : dict of str to float
        The plain objectives of the problem, to be minimised: of what is maximised, such as the least clearance, the negative.
    genes : numpy.ndarray, shape (n_var,)
        The row of decision variables that codes it.
    grid : OccupancyGrid, optional
        The map that it leads across.
    smoother : Smoother, optional
        What makes waypoints of the paths of its set.
    """

    index: int
    names: tuple[str, ...]
    cells: np.ndarray = field(repr=False)
    points: np.ndarray | None = field(repr=False)
    length: float
    length_m: float | None
    vulnerability: float
    turn: float
    interfering_cells: int
    clearance: float
    clearance_m: float | None
    objectives: dict[str, float]
    genes: np.ndarray = field(repr=False)
    grid: OccupancyGrid | None = field(default=None, repr=False)
    smoother: Smoother | None = field(default=None, repr=False)

    def as_dict(self) -> dict:
        """Return the record as a dict of its attributes but for what it shares with others of its set, arrays as arrays."""
        return {name: value for name, value in vars(self).items() if name not in ("grid", "smoother")}

    def waypoints(self, tolerance: float | None = None, spacing: float | None = None) -> Waypoints:
        """Return the few points between which the path can be driven straight, without its stairs.

        Each sees the next, as with the planners that go by line of sight, and the line is as clear of obstacles as the path was
        there: at each share of a piece's length it is at most ``tolerance`` nearer to an obstacle than the path at the same
        share of the stretch that the piece replaces. Safe detours stay detours so, which they would not if only the least
        clearance of the whole path had to be kept. Nor does the line come nearer than the robot's radius, by more than a 32nd
        of a cell, unless the path does. Distances are from the sides of the obstacles before they grew by that radius, of all
        points of the line and not of some. From each waypoint the next is the last of the path for which that holds; a step
        between neighbouring cells of the path always may be taken.

        Parameters
        ----------
        tolerance : float, optional
            In metres, or in cells on a map that has no metres; half a cell by default, since centres of cells stand for points
            half a cell around. Infinity asks for lines of sight alone. Below a 64th of a cell only steps in line are joined.
        spacing : float, optional
            Put points between, none further from the next, in the same unit. The corners stay.

        Returns
        -------
        Waypoints
            With length, turn, and least and mean clearance, of the path too (``before``), and ``to_csv``, ``to_nav_path`` and
            ``to_f1tenth``. Of a path in time they are its cells, a tick each, and neither argument is taken.

        Raises
        ------
        GridPathError
            If the path is not legal, is of no set, or an argument is out of its range.
        """
        if self.smoother is None:
            raise GridPathError("the path is of no set and knows no map, expected a member of a TradeOffSet")
        if self.interfering_cells:
            crossed = counted(self.interfering_cells, "occupied cell")
            raise GridPathError(f"path {self.index} crosses {crossed}, expected a legal path to drive along")
        return self.smoother.waypoints(self.cells, tolerance, spacing)

    def _repr_html_(self) -> str:
        return drawn.record_html(self)

    def _repr_png_(self) -> bytes:
        return png(drawn.record_scene(self))
