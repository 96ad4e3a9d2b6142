"""Path planning among obstacles that move while the search goes on, as one of pymoo's dynamic problems."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pymoo.core.individual import Individual
from pymoo.core.population import Population
from pymoo.problems.dyn import DynamicTestProblem

from pymoo_gridpath import checks
from pymoo_gridpath.checks import shown
from pymoo_gridpath.errors import GridError, GridPathError
from pymoo_gridpath.grid import OccupancyGrid, check_grid
from pymoo_gridpath.neighbourhood import HEADINGS
from pymoo_gridpath.objectives import Objective, make_objectives
from pymoo_gridpath.problems.grid_path import GridPathProblem
from pymoo_gridpath.representations import CellSequence
from pymoo_gridpath.search.timetable import occupied_at

# More maps than any run has time for.
_MOST_EPOCHS = 10_000


class _Clocked(DynamicTestProblem):
    """pymoo's clock, one unit of time an epoch, for a problem whose constructor does not know of it."""

    def __init__(self, **kwargs):
        super().__init__(nt=1, taut=1, tau=0, **kwargs)


class MovingObstaclesProblem(GridPathProblem, _Clocked):
    """Paths among obstacles that move a cell every few generations; a path is rated on the map as it is now.

    The clock is that of the search, not of a robot: nobody meets anybody on the way. Time stands still until ``tic`` is called,
    as `ObstacleClock` does after each generation; after every ``taut`` of them an epoch ends, and the movers take their next
    positions. After its last one a mover stays. `DynamicTestProblem` is the base of pymoo's own dynamic problems, so that its
    algorithms for these take it, D-NSGA-II and KGB, as well as all that know nothing of change.

    All maps are made, and checked, with the problem, so that everything that is worked out for one of them, exact fronts
    included, is kept with that map and never used for another. Paths are coded as "cells", with as many genes as the map
    that needs the most; obstacles are a penalty, since dynamic algorithms take no constraints. Beside ``turn`` and
    ``interfering_cells`` an evaluation sets the attribute ``epoch``, see `is_stale`.

    Parameters
    ----------
    base : OccupancyGrid
        What does not move.
    movers : sequence of array_like, each of shape (n, 2)
        For each moving obstacle its cells (x, y) in epoch 0, 1, and so on. Where it is beyond the edge of the grid it is gone.
    start, goal : (int, int)
        Cells (x, y).
    taut : int, default 5
        Generations of an epoch; the paper's number.
    objectives : sequence of str or Objective, default ("length", "vulnerability")
    penalty : float, optional
        What an interfering cell costs, see `GridPathProblem`.
    max_cells : int, optional
        Genes of a row, see `CellSequence`. By default the most that any of the maps needs by its own default.

    Attributes
    ----------
    movers : tuple of numpy.ndarray
    n_epochs : int
        Different maps there are: the length of the longest of the movers' ways.
    taut : int
    tau : int
        Generations so far; it may be set, and a new run needs that: to 0, as `restart` does, or to where it is to begin.
    ran : bool
        Whether time has passed since ``tau`` was set.
    stills : tuple of GridPathProblem
        The problem of each epoch, which does not move, with its exact front: ``problem.stills[3].pareto_front()``.

    Raises
    ------
    GridPathError
        If an argument is of another kind or out of its range; or, with the epoch, if a mover stands on the start or the goal
        or cuts one off from the other.

    References
    ----------
    The variable-length genetic algorithm, see `variable_length_ga`, section 6.3, where an obstacle moves after each five
    generations.

    Examples
    --------
    An obstacle that comes down from above:

    >>> import numpy as np
    >>> problem = MovingObstaclesProblem(OccupancyGrid(np.zeros((3, 5))), [[(2, 2), (2, 1), (2, 0)]], (0, 1), (4, 1), taut=1)
    >>> for _ in range(problem.n_epochs):
    ...     print(problem.epoch, problem.pareto_front()[:, 0].round(2).tolist())
    ...     problem.tic()
    0 [4.0, 4.83]
    1 [4.83]
    2 [4.0, 4.83]
    """

    def __init__(
        self,
        base: OccupancyGrid,
        movers: Sequence[Any],
        start: Sequence[int],
        goal: Sequence[int],
        taut: int = 5,
        objectives: Sequence[str | Objective] = ("length", "vulnerability"),
        penalty: float | None = None,
        max_cells: int | None = None,
    ):
        check_grid(base)
        taut = checks.whole("taut", taut, 1)
        self.movers = tuple(
            _way(k, way) for k, way in enumerate(checks.items("movers", movers, "ways of obstacles, cells (x, y) an epoch"))
        )
        self.n_epochs = max(map(len, self.movers), default=1)
        made = make_objectives(objectives)
        self._stills = _stills(base, self.movers, self.n_epochs, start, goal, made, penalty, max_cells)
        still = self._stills[0]
        super().__init__(still.grid, start, goal, still.representation, made, "penalty", penalty)
        self.taut = taut
        self._enter()

    # -- the clock ----------------------------------------------------------------------------------------------------

    @property
    def tau(self) -> int:
        """Generations so far."""
        return self._tau

    @tau.setter
    def tau(self, value: int) -> None:
        self._tau, self.ran = checks.whole("tau", value, 0), False
        self._enter()

    def tic(self, elapsed: int = 1) -> None:
        """Let generations pass, one by default."""
        super().tic(elapsed)
        self.ran = True

    def restart(self) -> None:
        """Set the time back to the beginning, for a new run."""
        self.tau = 0

    @property
    def time(self):
        """Epochs so far, whether or not anything still moves; a number that is set holds from then on, None frees it."""
        return self.tau // self.taut if self._time is None else self._time

    @time.setter
    def time(self, value: int | None) -> None:
        self._time = None if value is None else checks.whole("time", value, 0)
        self._enter()

    @property
    def epoch(self) -> int:
        """The number of the map that there is now, 0 to ``n_epochs`` - 1."""
        return min(self.time, self.n_epochs - 1)

    @property
    def ends(self) -> bool:
        """Whether an epoch ends with this generation, and another one follows."""
        return self._time is None and self.epoch < self.n_epochs - 1 and (self.tau + 1) % self.taut == 0

    @property
    def still(self) -> GridPathProblem:
        """The problem of the map that there is now, which does not move."""
        return self._stills[self.epoch]

    @property
    def stills(self) -> tuple[GridPathProblem, ...]:
        """The problem of each epoch, which does not move."""
        return self._stills

    def _enter(self) -> None:
        """Take the map of this epoch, with all that hangs on it."""
        if "taut" not in vars(self) or "_time" not in vars(self):
            # pymoo's constructor sets one after the other.
            return
        still = self.still
        if still.representation is not self.representation:
            self.grid, self.representation, self._prepared = still.grid, still.representation, still._prepared
            # pymoo's front, ideal and nadir point.
            self.cache: dict = {}

    # -- what hangs on the map ----------------------------------------------------------------------------------------

    def _exact(self, max_seconds: float | None):
        return self.still._exact(max_seconds)

    def _near(self, *args, **kwargs):
        return self.still._near(*args, **kwargs)

    def _evaluate(self, x, out, *args, **kwargs):
        super()._evaluate(x, out, *args, **kwargs)
        out["epoch"] = np.full(len(x), self.epoch)

    def is_stale(self, pop) -> np.ndarray:
        """Return which individuals were evaluated on another map than there is now, or never, bool, shape (N,)."""
        if not isinstance(pop, Population) or not all(isinstance(one, Individual) for one in pop):
            raise GridPathError(f"pop is {checks.shown(pop)}, expected a Population of pymoo")
        return np.array([one is None or one != self.epoch for one in pop.get("epoch", to_numpy=False)], dtype=bool)


def random_movers(
    grid: OccupancyGrid, start: Sequence[int], goal: Sequence[int], n_movers: int, n_epochs: int, random_state: Any
) -> tuple[list[np.ndarray], int]:
    """Return obstacles that wander at random, a step to a free neighbour each epoch, and never cut off the goal.

    A step that would take a mover onto an obstacle, another mover, the start or the goal, or part these two, is skipped.

    Parameters
    ----------
    grid : OccupancyGrid
    start, goal : (int, int)
        Cells (x, y).
    n_movers, n_epochs : int
    random_state : numpy.random.Generator or int
        Source of randomness, or a seed.

    Returns
    -------
    movers : list of numpy.ndarray of int, each of shape (n_epochs, 2)
        As `MovingObstaclesProblem` takes them.
    n_skipped : int
        Steps that were skipped.

    Raises
    ------
    GridPathError
        If an argument is of another kind or out of its range, or there is no room for so many.
    """
    start, goal = check_grid(grid).check_query(start, goal)
    n_movers = checks.whole("n_movers", n_movers, 0, grid.occupied.size)
    n_epochs = checks.whole("n_epochs", n_epochs, 1, _MOST_EPOCHS)
    if not isinstance(random_state, np.random.Generator):
        seed = checks.whole("random_state", random_state, 0, expected="a seed or a numpy.random.Generator")
        random_state = np.random.default_rng(seed)
    places: list[tuple[int, int]] = []
    for y, x in random_state.permutation(np.argwhere(~grid.occupied)).tolist():
        if len(places) < n_movers and _leaves_a_way(grid, [*places, (x, y)], start, goal):
            places.append((x, y))
    if len(places) < n_movers:
        raise GridError(f"there is room for {len(places)} movers that leave a way, expected {n_movers}")
    ways, n_skipped = [list(places)], 0
    for _ in range(n_epochs - 1):
        for k, (x, y) in enumerate(places):
            dx, dy = HEADINGS[random_state.integers(len(HEADINGS))].tolist()
            moved = [*places[:k], (x + dx, y + dy), *places[k + 1 :]]
            if len(set(moved)) == n_movers and grid.is_free(moved[k]) and _leaves_a_way(grid, moved, start, goal):
                places = moved
            else:
                n_skipped += 1
        ways.append(list(places))
    cells = np.array(ways, dtype=np.int64).reshape(n_epochs, n_movers, 2)
    return [cells[:, k] for k in range(n_movers)], n_skipped


def _way(number: int, way: Any) -> np.ndarray:
    """Return the cells of a mover if they are such."""
    expected = "cells (x, y), one an epoch, whole numbers of shape (n, 2), n at least 1"
    found = checks.array(f"mover {number}", way, (None, 2), "iu", expected=expected)
    if not 0 < len(found) <= _MOST_EPOCHS:
        raise GridPathError(f"mover {number} has {len(found):,} cells, expected {expected} and at most {_MOST_EPOCHS:,}")
    found = found.astype(np.int64)
    found.flags.writeable = False
    return found


def _with(grid: OccupancyGrid, cells: np.ndarray) -> OccupancyGrid:
    """Return a grid with further occupied cells, of which those beyond its edge are none."""
    made = grid.replace(occupied=occupied_at(grid, cells.reshape(-1, 2)))
    if grid.original is grid:
        return made
    return made.grown_from(_with(grid.original, cells), grid.robot_radius, grid.footprint)


def _leaves_a_way(grid: OccupancyGrid, places: list[tuple[int, int]], start, goal) -> bool:
    try:
        _with(grid, np.array(places)).check_query(start, goal)
    except GridError:
        return False
    return True


def _stills(base, movers, n_epochs: int, start, goal, objectives, penalty, max_cells) -> tuple[GridPathProblem, ...]:
    """Return the problem of each epoch, all with rows of the same length."""
    start, goal = base.check_query(start, goal)
    grids = []
    for epoch in range(n_epochs):
        cells = np.array([way[min(epoch, len(way) - 1)] for way in movers], dtype=np.int64).reshape(-1, 2)
        for name, cell in (("start", start), ("goal", goal)):
            on = np.flatnonzero((cells == cell).all(axis=1))
            if len(on):
                raise GridError(f"in epoch {epoch} mover {on[0]} stands on the {name} {shown(cell)}, expected it elsewhere")
        grid = _with(base, cells)
        try:
            grid.check_query(start, goal)
        except GridError as error:
            raise type(error)(f"in epoch {epoch}: {error}") from None
        grids.append(grid)
    if max_cells is None:
        made = [GridPathProblem(grid, start, goal, "cells", objectives, "penalty", penalty) for grid in grids]
        max_cells = max(problem.n_var for problem in made)
    codings = [CellSequence(grid, start, goal, max_cells) for grid in grids]
    return tuple(
        GridPathProblem(grid, start, goal, coding, objectives, "penalty", penalty)
        for grid, coding in zip(grids, codings, strict=True)
    )
