"""The coding of paths in time: the cell at each tick."""

from __future__ import annotations

import functools
from collections.abc import Sequence

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.grid import Box, OccupancyGrid
from pymoo_gridpath.paths import Paths
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.paths.timed import TimedCellPaths
from pymoo_gridpath.paths.trajectories import Trajectories
from pymoo_gridpath.representations.base import Representation
from pymoo_gridpath.search.timed import make_timed_terrain, mend_timed
from pymoo_gridpath.search.timetable import Timetable

#: The latest horizon, as of the exact front.
MOST_TICKS = 100_000


class TimedPaths(Representation):
    """The genes are the cells at tick 0, 1, 2, and so on, and the goal again from the arrival to the end of the row.

    A cell that follows itself is a wait, unlike in `CellSequence`. Gene k is the index ``y * width + x`` of a cell; gene 0 is
    fixed to the start, and the last one, of tick ``horizon``, to the goal. A path ends when it first reaches the goal, whatever
    comes after in its row.

    Nearly no row of random genes is a legal path; `repair` makes legal paths of them. It is the coding of a
    `TimedPathProblem`, which gives it its ``movers`` and ``horizon``; problems whose obstacles stand still refuse it.

    Parameters
    ----------
    grid : OccupancyGrid
        What does not move.
    start, goal : (int, int)
        Cells (x, y).
    movers : Trajectories
        The obstacles that move.
    horizon : int
        The last tick at which a path may arrive, 1 to 100,000.

    Raises
    ------
    GridError, UnreachableError
        If start or goal is no free cell, both are the same, no path joins them, an obstacle is on the start at tick 0, or no
        path arrives by the horizon; the message tells whether there is none at all or it gave up there. Or if the grid and the
        horizon are too large together.
    GridPathError
        If the movers are no `Trajectories` or the horizon is no whole number in its range.

    Attributes
    ----------
    movers : Trajectories
    horizon : int
    max_cells : int
        1 more than the horizon: a cell for each tick.

    Examples
    --------
    An obstacle that passes by while the path waits:

    >>> from pymoo_gridpath.paths import Trajectories
    >>> lane = OccupancyGrid([[0, 0, 0, 0], [1, 0, 1, 1]])
    >>> coding = TimedPaths(lane, (0, 0), (3, 0), Trajectories([[(1, 1), (1, 0), (1, 1)]]), horizon=5)
    >>> paths = coding.decode([[0, 1, 2, 3, 3, 3], [0, 0, 1, 2, 3, 3]])
    >>> paths.interfering_cells.tolist(), paths.arrival.tolist(), paths.length.tolist()
    ([1, 0], [3, 4], [3.0, 3.0])
    >>> paths.cells(1).tolist()
    [[0, 0], [0, 0], [1, 0], [2, 0], [3, 0]]
    """

    name = "timed"
    timed = True
    max_cells: int

    def __init__(self, grid: OccupancyGrid, start: Sequence[int], goal: Sequence[int], movers: Trajectories, horizon: int):
        super().__init__(grid, start, goal)
        self.movers = checks.instance("movers", movers, Trajectories)
        self.horizon = checks.whole("horizon", horizon, 1, MOST_TICKS)
        self.timetable = Timetable(self.grid, self.movers, self.horizon)
        #: The legal steps that lie on a path of the query.
        self.useful = self.timetable.useful(self.start, self.goal)
        self.max_cells = self.n_var = self.horizon + 1
        self.xl = np.zeros(self.n_var, dtype=int)
        self.xu = np.full(self.n_var, grid.occupied.size - 1)
        self.xl[0] = self.xu[0] = self.moves.index(self.start)
        self.xl[-1] = self.xu[-1] = self.moves.index(self.goal)

    @property
    def box(self) -> Box:  # pyright: ignore[reportIncompatibleVariableOverride]
        """The whole grid."""
        return self.grid.whole

    @functools.cached_property
    def moves(self):
        """The steps that are legal where nothing moves."""
        return self.timetable.moves

    def decode(self, X: np.ndarray) -> TimedCellPaths:
        """Return the paths that the rows of X code.

        Parameters
        ----------
        X : numpy.ndarray, shape (N, n_var)
            Genes. Real numbers are rounded to the nearest gene.

        Returns
        -------
        TimedCellPaths
            N paths from the start to the goal, legal or not, with their ``arrival`` and, by a method, ``vulnerability``.
        """
        return TimedCellPaths(self.timetable, self.genes(X), int(self.xl[-1]))

    def from_sequences(self, sequences: Sequences) -> np.ndarray:
        """Return the rows of genes that code paths given by the cell at each tick.

        Parameters
        ----------
        sequences : Sequences
            N paths from the start to the goal; a cell that follows itself is a wait.

        Returns
        -------
        numpy.ndarray of int, shape (N, n_var)
            Padded with the goal, from its first visit on.

        Raises
        ------
        GridPathError
            If a path leads from or to another cell, or arrives after the horizon.
        """
        cells, offsets = self._checked_ends(sequences)
        lengths = np.diff(offsets)
        goal = self.xl[-1]
        tick = np.arange(len(cells)) - np.repeat(offsets[:-1], lengths)
        row = np.repeat(np.arange(len(lengths)), lengths)
        arrival = np.full(len(lengths), np.iinfo(np.int64).max)
        np.minimum.at(arrival, row[cells == goal], tick[cells == goal])
        if len(lengths) and arrival.max() > self.horizon:
            raise GridPathError(f"a path arrives at tick {arrival.max()}, expected at most {self.horizon}, the horizon")
        X = np.full((len(lengths), self.n_var), goal, dtype=np.int64)
        kept = tick < arrival[row]
        X[row[kept], tick[kept]] = cells[kept]
        return X

    def to_sequences(self, X: np.ndarray) -> Sequences:
        """Return the cells of the decoded paths at each tick, waits included, the inverse of `from_sequences`."""
        return self.decode(X).visits

    def encode(self, paths: Paths) -> np.ndarray:
        """Return the genes of paths, see `from_sequences`; those that know no time take a step each tick."""
        paths = self._on_grid(paths)
        return self.from_sequences(paths.visits if isinstance(paths, TimedCellPaths) else paths.sequences)

    def repair(self, X: np.ndarray, random_state: np.random.Generator) -> np.ndarray:
        """Return X with rows rewritten that are no legal paths.

        Parameters
        ----------
        X : numpy.ndarray, shape (N, n_var)
        random_state : numpy.random.Generator
            Not drawn from.

        Returns
        -------
        numpy.ndarray of int, shape (N, n_var)
            A new array of legal paths. One that is none is followed as long as it can be, by legal steps from where the goal
            can be reached in time, and then goes the way that arrives first, of these the shortest.
        """
        return mend_timed(make_timed_terrain(self), self.genes(X))
