"""The path problems of Weise and Mostaghim."""

from __future__ import annotations

import functools
import re

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.objectives import Length, Turn
from pymoo_gridpath.objectives.suites import HILLS, Ascent, Delay, TravelTime
from pymoo_gridpath.problems.scenarios import MOST_CELLS
from pymoo_gridpath.problems.suites.base import SUITES, Suite

_OBSTACLES, _NEIGHBOURS, _BACKTRACKING = ("NO", "CH", "LA"), ("K2", "K3"), ("BF", "BT")

#: Sides of the squares of which fronts were published.
PUBLISHED_SIDES = range(3, 15)

_NAME = re.compile(
    rf"ASLETISMAC_({'|'.join(_OBSTACLES)})_X(\d+)_Y(\d+)_({'|'.join(HILLS)})_({'|'.join(_NEIGHBOURS)})_"
    rf"({'|'.join(_BACKTRACKING)})"
)


@SUITES.register
class Asletismac(Suite):
    """A path problem of the suite of Weise and Mostaghim, with five objectives: length, delay, ascent, travel time and turn.

    Parameters
    ----------
    instance : str
        Its published name, ``ASLETISMAC_{NO|CH|LA}_X{n}_Y{n}_{P1|P2|P3|PM}_{K2|K3}_{BF|BT}``: obstacles (none, a chequerboard,
        a lake), cells a side, hills, steps (to the right and up, or diagonally to both as well), and whether paths may
        backtrack. Where they may (BT), steps lead along four or eight headings.

    Raises
    ------
    GridPathError
        If there is no such instance, or it has over 4,096 cells a side.

    Notes
    -----
    The definitions are those by which fronts were published with PlatEMO: the lake includes its rim, diagonal steps may pass
    occupied cells, and n is the number of cells a side. Sixteen instances without backtracking, all with a lake and of 3 or 4
    cells a side, do not have a path.

    References
    ----------
    J. Weise and S. Mostaghim, "A scalable many-objective pathfinding benchmark suite", arXiv 2010.04501, 2020.

    Examples
    --------
    >>> suite = Asletismac("ASLETISMAC_NO_X14_Y14_P2_K3_BF")
    >>> [objective.name for objective in suite.objectives]
    ['length', 'delay', 'ascent', 'travel_time', 'turn']
    """

    name = "asletismac"
    follows = (
        "follows the definitions of Weise and Mostaghim (arXiv 2010.04501) by which PlatEMO publishes fronts of 3 to 14 cells "
        "a side; the exact fronts of every two and three objectives are those"
    )

    def __init__(self, instance: str):
        found = _NAME.fullmatch(checks.text("instance", instance))
        if not found or found[2] != found[3] or not 2 <= int(found[2]) <= MOST_CELLS:
            raise GridPathError(
                f"instance is {checks.shown(instance)}, expected a name such as ASLETISMAC_NO_X14_Y14_PM_K3_BF, with "
                f"{_or(_OBSTACLES)}, X and Y alike from 2 to {MOST_CELLS:,}, {_or(HILLS)}, {_or(_NEIGHBOURS)}, and "
                f"{_or(_BACKTRACKING)}"
            )
        self.instance = instance
        self.backtracking = found[6] == "BT"
        self._parts = found[1], int(found[2]), found[4], found[5]

    @classmethod
    def instances(cls, backtracking: bool = False) -> list[str]:
        """Return the names of the instances of 3 to 14 cells a side; fronts of those without backtracking were published."""
        last = _BACKTRACKING[checks.flag("backtracking", backtracking)]
        return [
            f"ASLETISMAC_{obstacles}_X{n}_Y{n}_{hills}_{neighbours}_{last}"
            for obstacles in _OBSTACLES
            for n in PUBLISHED_SIDES
            for hills in HILLS
            for neighbours in _NEIGHBOURS
        ]

    @property
    def label(self):
        return self.instance

    @functools.cached_property
    def query(self):
        obstacles, n, _, neighbours = self._parts
        x, y = np.meshgrid(np.arange(n), np.arange(n))
        occupied = np.zeros((n, n), dtype=bool)
        if obstacles == "CH":
            # Both coordinates even, counted from 1.
            occupied = (x % 2 == 1) & (y % 2 == 1)
            occupied[-1, -1] = False
        elif obstacles == "LA":
            # Within n / 4 of n / 2, without fractions.
            occupied = 4 * ((2 * x - n) ** 2 + (2 * y - n) ** 2) <= n**2
        moves = 4 if neighbours == "K2" else 8
        grid = OccupancyGrid(occupied, corner_cutting=True, name=self.instance, moves=moves)
        return grid, (0, 0), (n - 1, n - 1)

    @functools.cached_property
    def objectives(self):
        return Length(), Delay(), Ascent(self._parts[2]), TravelTime(), Turn()


def _or(names: tuple[str, ...]) -> str:
    return f"{', '.join(names[:-1])} or {names[-1]}"
