"""The grids of the benchmark of multi-objective search of 2026, by their definitions."""

from __future__ import annotations

import functools
import os
from collections.abc import Sequence

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.grid import Cell, OccupancyGrid
from pymoo_gridpath.maps import Query, load_map, query_of
from pymoo_gridpath.maps.queries import ends_of
from pymoo_gridpath.neighbourhood import neighbourhood_of
from pymoo_gridpath.objectives import Exposure, IntegerLength, RandomCost
from pymoo_gridpath.problems.scenarios import MOST_CELLS
from pymoo_gridpath.problems.suites.base import SUITES, Suite

# More objectives than anyone has used.
_MOST_OBJECTIVES = 100


@SUITES.register
class RandomCostGrid(Suite):
    """A grid with random costs of its directed edges, without obstacles and without diagonal steps.

    A path leads from a source beside the leftmost column to a target beside the rightmost one, by any of their rows. Both are
    columns of their own here, in which steps up and down are free, so that the grid is two columns wider; the costs of the
    edges between them and the grid are drawn like all others, see `RandomCost`.

    Parameters
    ----------
    width, height : int
        Cells without the source and the target, 2 to 4096; 300, 350, and so on to 600 in the benchmark.
    n_obj : int, default 2
        Number of costs.
    seed : int, default 1
        The first costs of a seed are the same, whatever their number.

    Raises
    ------
    GridPathError
        If an argument is no whole number or out of its range.

    References
    ----------
    Peer, Hernandez, Koenig, Felner and Salzman, arXiv 2603.24084, 2026, section 4.3.

    Examples
    --------
    >>> problem = RandomCostGrid(6, 4, seed=3).problem()
    >>> problem.pareto_front().tolist()
    [[33.0, 31.0], [39.0, 27.0], [46.0, 26.0], [47.0, 25.0], [48.0, 21.0]]
    """

    name = "random-cost"
    follows = (
        "follows the definition of the random grids of Peer, Hernandez, Koenig, Felner and Salzman (arXiv 2603.24084, section "
        "4.3), with costs of its own: the benchmark's files were not to be had"
    )

    def __init__(self, width: int, height: int, n_obj: int = 2, seed: int = 1):
        self.width, self.height = (
            checks.whole(key, side, 2, MOST_CELLS) for key, side in (("width", width), ("height", height))
        )
        self.n_obj = checks.whole("n_obj", n_obj, 1, _MOST_OBJECTIVES)
        self.seed = checks.whole("seed", seed, 0)

    @property
    def label(self):
        costs = "" if self.n_obj == 2 else f"-{self.n_obj}-costs"
        return f"random-cost-{self.width}x{self.height}-{self.seed}{costs}"

    @functools.cached_property
    def query(self):
        grid = OccupancyGrid(np.zeros((self.height, self.width + 2), dtype=bool), moves=4, name=self.label)
        return grid, (0, 0), (self.width + 1, self.height - 1)

    @functools.cached_property
    def objectives(self):
        return tuple(RandomCost(number, self.seed) for number in range(1, self.n_obj + 1))


@SUITES.register
class GuardsGrid(Suite):
    """A map with guards: short paths against paths that few guards see.

    Parameters
    ----------
    map : OccupancyGrid, str or path-like
        A grid of eight moves whose corners may not be cut, a map file, which is read as such, or the name of a shipped map.
    guards : sequence of (int, int)
        Free cells (x, y), y up.
    start, goal : (int, int), optional
        By default those that the map file names.

    Raises
    ------
    GridPathError
        If guards are no cells; once the problem is made, if one of them is not free, or the grid has other steps.
    MapError
        Once the problem is made, if the map cannot be read.

    References
    ----------
    Peer, Hernandez, Koenig, Felner and Salzman, arXiv 2603.24084, 2026, section 4.4.

    Examples
    --------
    >>> problem = GuardsGrid("warehouse", guards=[(20, 20), (44, 12)]).problem()
    >>> problem.objective_names
    ['integer_length', 'exposure']
    """

    name = "guards"
    follows = (
        "follows the definition of GUARDS by Peer, Hernandez, Koenig, Felner and Salzman (arXiv 2603.24084, section 4.4) for "
        "guards that are given: where the benchmark's own stand is in files that were not to be had, and so is the direction "
        "of the lines of sight, here from the guard to the cell"
    )
    files = ("map",)

    def __init__(
        self,
        map: OccupancyGrid | str | os.PathLike[str],
        guards: Sequence[Sequence[int]],
        start: Cell | None = None,
        goal: Cell | None = None,
    ):
        self.map = map if isinstance(map, OccupancyGrid) else checks.file_path("map", map)
        self.guards = Exposure(guards).guards
        self.start, self.goal = start, goal

    @property
    def label(self):
        name = self.map.name if isinstance(self.map, OccupancyGrid) else os.path.splitext(os.path.basename(self.map))[0]
        return f"guards-{len(self.guards)}-{name}"

    @functools.cached_property
    def query(self):
        known = Query()
        if isinstance(self.map, OccupancyGrid):
            grid = self.map
            if grid.neighbourhood != neighbourhood_of(8, False):
                raise GridPathError(f"the steps of {grid} are not those of GUARDS, expected eight moves that cut no corner")
        else:
            grid = load_map(self.map, moves=8, corner_cutting=False)
            if not (self.start and self.goal):
                known = query_of(self.map)
        return grid, *grid.check_query(*ends_of(grid, known, self.start, self.goal))

    @functools.cached_property
    def objectives(self):
        return IntegerLength(), Exposure(self.guards)
