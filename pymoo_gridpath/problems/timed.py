"""Path planning among obstacles whose motion is known, by a robot's clock."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.fields import PAPER_VARIANCE, check_variance, given_bell
from pymoo_gridpath.grid import OccupancyGrid, check_grid
from pymoo_gridpath.objectives import Length, Objective, Vulnerability
from pymoo_gridpath.paths.timed import TimedCellPaths
from pymoo_gridpath.paths.trajectories import Trajectories
from pymoo_gridpath.problems.grid_path import GridPathProblem, Obstacles
from pymoo_gridpath.representations import TimedPaths


class _Arrival(Objective):
    """The tick at which a path first reaches the goal."""

    name = "arrival"
    label = "Arrival [ticks]"
    best = "earliest"

    def __call__(self, paths, prepared):
        return _in_time(paths).arrival.astype(float)


class _TimedVulnerability(Vulnerability):
    """Sum, over all ticks from 0 to the arrival, of the potential of all obstacles at that tick in the cell of the path.

    The field is that of the obstacles which stand still.
    """

    label = "Vulnerability on the way"

    def __call__(self, paths, prepared):
        assert self.variance is not None
        return _in_time(paths).vulnerability(self.variance)


def _in_time(paths) -> TimedCellPaths:
    return checks.instance("paths", paths, TimedCellPaths, ", as decode of a TimedPathProblem returns them")


class TimedPathProblem(GridPathProblem):
    """Paths among obstacles whose motion is known, to be minimised in arrival, length and vulnerability.

    The clock is a robot's: a step to a neighbouring cell takes one tick, and so does a wait. A legal path enters no cell that
    is occupied when it arrives there, and meets no obstacle halfway: to exchange cells with one, or to cross its way
    diagonally, is illegal. Where corners may not be cut, no obstacle may be beside a diagonal step before or after it. A path
    ends when it first reaches the goal. These are the rules of `exact_timed_front`, which finds the front. Rows are those of
    `TimedPaths`, the cell at each tick.

    Parameters
    ----------
    grid : OccupancyGrid
        What does not move.
    start, goal : (int, int)
        Cells (x, y).
    movers : Trajectories or sequence
        The obstacles that move; what is none yet is handed to `Trajectories`: they stay after their last state, wait before
        their first, and gaps between states are refused.
    horizon : int
        The last tick at which a path may arrive, 1 to 100,000. A row has a gene for each tick.
    variance : float, optional
        Of the potential of all obstacles, in squared cells; by default 0.5, on maps in metres, too, since moving obstacles
        are cells.
    obstacles : {"penalty", "constraint"}, default "penalty"
        How illegal paths are told from others, as in `GridPathProblem`: by a ``penalty`` on every objective for each occupied
        cell that is crossed and each step that a moving obstacle bars, or by their number as the constraint ``G``.
    penalty : float, optional
        2 by default, see `GridPathProblem`.
    sigma_m : float, optional
        In place of the variance, the standard deviation in metres, on a map that states its resolution.

    Raises
    ------
    GridPathError
        If an argument is unknown or out of its range, or the query cannot be solved on the still grid.
    GridError, UnreachableError
        If an obstacle is on the start at tick 0, or no path arrives by the horizon: the message tells whether there is none at
        all or the search gave up at the horizon. Or if the grid and the horizon are too large together.

    Attributes
    ----------
    movers : Trajectories
    horizon : int
    variance : float
        In squared cells, whichever was given.

    Notes
    -----
    ``pareto_front()`` and ``pareto_set()`` are as in `GridPathProblem`. Attributes of evaluated individuals are the same, too;
    ``interfering_cells`` counts what moving obstacles bar with the rest, and ``turn`` knows no waits.

    Examples
    --------
    Somebody comes the other way along the middle of three rows, and goes on to the right of the start:

    >>> import numpy as np
    >>> grid = OccupancyGrid(np.zeros((3, 5)))
    >>> problem = TimedPathProblem(grid, (0, 1), (4, 1), [[(4, 1), (3, 1), (2, 1), (1, 1), (0, 1)]], horizon=6)
    >>> problem.pareto_front(max_seconds=60).round(2).tolist()
    [[4.0, 4.83, 0.38], [5.0, 4.83, 0.27], [5.0, 5.41, 0.27]]
    >>> problem.decode(np.array([[5, 6, 7, 8, 9, 9, 9]])).interfering_cells.tolist()
    [1]
    """

    timed = True
    representation: TimedPaths  # pyright: ignore[reportIncompatibleVariableOverride]

    def __init__(
        self,
        grid: OccupancyGrid,
        start: Sequence[int],
        goal: Sequence[int],
        movers: Trajectories | Sequence,
        horizon: int,
        variance: float | None = None,
        obstacles: Obstacles = "penalty",
        penalty: float | None = None,
        sigma_m: float | None = None,
    ):
        checks.one_of("obstacles", obstacles, ("penalty", "constraint"))
        bell = given_bell(variance, sigma_m)
        self.variance: float = bell.get("variance", PAPER_VARIANCE)
        if "sigma_m" in bell:
            cell = check_grid(grid).check_resolution("sigma_m of the potential, in metres,")
            self.variance = check_variance((bell["sigma_m"] / cell) ** 2)
        objectives = _Arrival(), Length(), _TimedVulnerability(self.variance)
        if not isinstance(movers, Trajectories):
            movers = Trajectories(movers)
        coding = TimedPaths(check_grid(grid), start, goal, movers, horizon)
        self.movers, self.horizon = movers, coding.horizon
        super().__init__(grid, start, goal, coding, objectives, obstacles, penalty)

    @property
    def potential(self) -> np.ndarray:
        """The potential of all obstacles at each tick, in units of 2**-30, int64, shape (horizon + 1, n_cells)."""
        return self.representation.timetable.potential(self.variance)
