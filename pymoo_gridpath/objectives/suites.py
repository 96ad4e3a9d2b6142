"""What the paths of published suites of problems are scored by; the suites are in `pymoo_gridpath.problems`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.checks import shown
from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.errors import GridError, GridPathError
from pymoo_gridpath.grid import OccupancyGrid, check_grid
from pymoo_gridpath.neighbourhood import DIAGONAL, HEADINGS, LENGTHS
from pymoo_gridpath.objectives.base import OBJECTIVES, Objective
from pymoo_gridpath.objectives.ground import climbed, left_values

#: The hills of ASLETISMAC by the letters of its names.
HILLS = ("P1", "P2", "P3", "PM")

# Speed limits of ASLETISMAC: 130 where the wave is above the first mark, 50 where it is below the second, 100 between.
_FAST, _SLOW = 0.9, -0.4

# What a step is late by: between cells of a like limit, and between others.
_DELAYS, _DELAY_BETWEEN = {130.0: 0.2, 100.0: 1.0, 50.0: 3.0}, 2.0

#: Costs of edges are drawn from 1 to this.
MOST_COST = 10


@OBJECTIVES.register
class Ascent(Objective):
    """How much a path rises over the hills of ASLETISMAC, which cover any square grid.

    Parameters
    ----------
    hills : {"P1", "P2", "P3", "PM"}
        One hill, two on a diagonal, these and the first, or MATLAB's "peaks".

    Raises
    ------
    GridPathError
        If there are no such hills; once the grid is known, if it is no square.

    References
    ----------
    J. Weise and S. Mostaghim, "A scalable many-objective pathfinding benchmark suite", arXiv 2010.04501, 2020.
    """

    name = "ascent"
    label = "Ascent"
    best = "flattest"

    def __init__(self, hills: str):
        self.hills = checks.one_of("hills", hills, HILLS)

    def moves(self, grid):
        return climbed(elevation(self.hills, _side(grid, self.name)))


@OBJECTIVES.register
class Delay(Objective):
    """What a path is late by, by the speed limits of ASLETISMAC.

    A step takes 0.2, 1 or 3 between two cells with the limit 130, 100 or 50, and 2 where the limits differ.

    Raises
    ------
    GridPathError
        Once the grid is known, if it is no square.

    References
    ----------
    As of `Ascent`.
    """

    name = "delay"
    label = "Expected delay"

    def moves(self, grid):
        speed = speed_limits(_side(grid, self.name))
        alike = np.select([speed == limit for limit in _DELAYS], list(_DELAYS.values()))
        return np.stack([np.where(left_values(speed, dx, dy) == speed, alike, _DELAY_BETWEEN) for dx, dy in HEADINGS])


@OBJECTIVES.register
class TravelTime(Objective):
    """How long a path takes by the speed limits of ASLETISMAC: twice the length of each step by the sum of both cells' limits.

    Raises
    ------
    GridPathError
        Once the grid is known, if it is no square.

    References
    ----------
    As of `Ascent`.
    """

    name = "travel_time"
    label = "Travel time"
    best = "quickest"

    def moves(self, grid):
        speed = speed_limits(_side(grid, self.name))
        return np.stack(
            [2.0 * length / (speed + left_values(speed, dx, dy)) for (dx, dy), length in zip(HEADINGS, LENGTHS, strict=True)]
        )


@OBJECTIVES.register
class RandomCost(Objective):
    """A cost of each directed edge of a grid, drawn from the whole numbers 1 to 10 alike.

    The first and the last column of the grid stand for a source and a target: steps up and down in them are free, so that the
    edges between them and the next column are those of a source and of a target to each row.

    Parameters
    ----------
    number : int
        Which cost it is, from 1 on; each is drawn by itself.
    seed : int
        Of all costs of a grid.

    Raises
    ------
    GridPathError
        If an argument is no whole number, or out of its range.

    Notes
    -----
    The costs of a grid are ``numpy.random.default_rng([seed, number]).integers(1, 11, (4, height, width))``, by [heading, y, x]
    of the cell entered, the headings right, up, left, down. Two directions of an edge have costs of their own. Diagonal steps
    cost as much as the dearest edge; there are none where the suite is played.

    References
    ----------
    The random grids of the benchmark of Peer, Hernandez, Koenig, Felner and Salzman, arXiv 2603.24084, 2026, section 4.3.
    """

    name = "random_cost"
    label = "Random cost"

    def __init__(self, number: int, seed: int):
        self.number = checks.whole("number", number, 1, 1000)
        self.seed = checks.whole("seed", seed, 0)
        self.name = f"cost {number}"
        self.label = f"Cost {number}"

    def moves(self, grid):
        costs = np.full((8, *check_grid(grid).shape), float(MOST_COST))
        rng = np.random.default_rng([self.seed, self.number])
        costs[~DIAGONAL] = rng.integers(1, MOST_COST + 1, (4, *grid.shape))
        # Up and down in the source and in the target.
        costs[2:7:4, :, [0, -1]] = 0.0
        return costs


@OBJECTIVES.register
class IntegerLength(Objective):
    """Length in tenths of a cell as whole numbers: 10 for a straight step and 14 for a diagonal one.

    References
    ----------
    As of `Exposure`.
    """

    name = "integer_length"
    label = "Path length [10 straight, 14 diagonal]"
    best = "shortest"

    def moves(self, grid):
        return 10.0, 14.0


@OBJECTIVES.register
class Exposure(Objective):
    """By how many guards a path is seen: of each step those that see the cell entered.

    A diagonal step is seen as much as the most seen of the cell entered and the two cells beside it. The start counts nothing.
    A guard sees a cell if all cells of Bresenham's line from the guard to the cell are free, both ends included.

    Parameters
    ----------
    guards : sequence of (int, int)
        Their cells (x, y).

    Raises
    ------
    GridPathError
        If they are no cells; once the grid is known, if one is not free.

    Notes
    -----
    Bresenham's line from the cell to the guard may pass other cells; the suite's own files may have been made with these.

    References
    ----------
    GUARDS of the benchmark of Peer, Hernandez, Koenig, Felner and Salzman, arXiv 2603.24084, 2026, section 4.4.
    """

    name = "exposure"
    label = "Exposure to guards"
    best = "least seen"

    def __init__(self, guards: Sequence[Sequence[int]]):
        expected = "cells such as [(4, 9), (7, 2)]"
        cells = checks.array("guards", guards, (None, 2), "iu", expected=expected)
        if not len(cells):
            raise GridPathError(f"guards is {shown(guards)}, expected {expected}")
        self.guards: list[Sequence[int]] = [[int(x), int(y)] for x, y in cells]

    def moves(self, grid):
        seen = self.seen(grid)
        costs = np.repeat(seen[None], 8, axis=0)
        for heading in np.flatnonzero(DIAGONAL):
            dx, dy = HEADINGS[heading]
            # Cells beside a step that are no cells of the grid are those of steps that there are not.
            beside = [np.nan_to_num(left_values(seen, *step)) for step in ((dx, 0), (0, dy))]
            costs[heading] = np.maximum(seen, np.maximum(*beside))
        return costs

    def seen(self, grid: OccupancyGrid) -> np.ndarray:
        """Return how many guards see each cell, float, shape (height, width)."""
        for k, guard in enumerate(self.guards):
            if not check_grid(grid).contains(guard) or not grid.is_free(guard):
                raise GridError(f"guard {k} stands on {tuple(guard)}, expected a free cell of the grid {shown(grid.name)}")
        return _seen(grid.occupied, np.array(self.guards)).astype(float)


def speed_limits(n: int) -> np.ndarray:
    """Return the speed limits of ASLETISMAC on a square grid, shape (n, n)."""
    along = np.arange(n)
    wave = np.maximum(np.sin(along)[None, :], np.cos(along)[:, None])
    return np.select([wave > _FAST, wave < _SLOW], [130.0, 50.0], 100.0)


def elevation(hills: str, n: int) -> np.ndarray:
    """Return the heights of ASLETISMAC on a square grid, shape (n, n)."""
    along = -3.0 + 6.0 * np.arange(n) / n
    a, b = along[None, :], along[:, None]

    def hill(u: float, v: float) -> np.ndarray:
        return 5.0 * np.exp(-((a - u) ** 2) - (b - v) ** 2)

    if hills == "PM":
        return (
            3.0 * (1.0 - a) ** 2 * np.exp(-(a**2) - (b + 1.0) ** 2)
            - 10.0 * (a / 5.0 - a**3 - b**5) * np.exp(-(a**2) - b**2)
            - np.exp(-((a + 1.0) ** 2) - b**2) / 3.0
        )
    two = hill(-1.5, -1.5) + hill(1.5, 1.5)
    return {"P1": hill(1.5, -1.5), "P2": two, "P3": two + hill(1.5, -1.5)}[hills]


def _side(grid: OccupancyGrid, name: str) -> int:
    """Return how many cells a side a square grid has."""
    if check_grid(grid).width != grid.height:
        raise GridPathError(f"{name} is of square grids, and the map has {grid.width} x {grid.height} cells")
    return grid.width


@kernel
def _seen(occupied, guards):
    """Return how many of the guards (x, y) see each cell, int64, shape (height, width)."""
    height, width = occupied.shape
    seen = np.zeros((height, width), dtype=np.int64)
    for k in range(len(guards)):
        for goal_y in range(height):
            for goal_x in range(width):
                x, y = guards[k, 0], guards[k, 1]
                dx, dy = abs(goal_x - x), abs(goal_y - y)
                step_x = 1 if goal_x > x else -1
                step_y = 1 if goal_y > y else -1
                error = dx - dy
                while not occupied[y, x]:
                    if x == goal_x and y == goal_y:
                        seen[y, x] += 1
                        break
                    twice = 2 * error
                    if twice > -dy:
                        error -= dy
                        x += step_x
                    if twice < dx:
                        error += dx
                        y += step_y
    return seen
