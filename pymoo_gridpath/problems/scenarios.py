"""Scenario generators: grids with a path that is sure to exist.

The maps of Hliwa and Atieh are lost; `convex_environment` and its kin are stand-ins of the same kinds and sizes, in which each
obstacle keeps to a block of its own, so that streets are left between them.
"""

from __future__ import annotations

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridError
from pymoo_gridpath.grid import OccupancyGrid, check_grid
from pymoo_gridpath.paths import ColumnPaths
from pymoo_gridpath.paths.frame import MonotoneFrame

#: The largest grid to draw has so many cells a side.
MOST_CELLS = 4096

# The shares of the shorter side that lie between the edge of a block and its obstacle, and between a corner of the map and an
# end of the query.
_STREET, _INSET = 0.025, 0.02

# Letters as bars (x0, y0, x1, y1) in a square from -1 to 1: L, T and U.
_LETTERS = (
    ((-1.0, -1.0, -0.5, 1.0), (-1.0, -1.0, 1.0, -0.5)),
    ((-1.0, 0.5, 1.0, 1.0), (-0.25, -1.0, 0.25, 1.0)),
    ((-1.0, -1.0, -0.6, 1.0), (0.6, -1.0, 1.0, 1.0), (-1.0, -1.0, 1.0, -0.6)),
)

# The maze: rooms in x and y, half the thickness of a wall in cells, and the share of walls that are taken out of a maze with
# one way between any two rooms.
_ROOMS, _HALF_WALL, _OPENED = (10, 10), 1, 0.3


def random_dense_grid(size: int, p0: float, random_state: np.random.Generator | int) -> OccupancyGrid:
    """Return a square grid of the paper's section 6: a random valid path kept free, the rest occupied with probability p0.

    The path leads from the bottom-left to the top-right corner. The paper does not say how it is drawn; here each
    column but the last is left at a uniformly random row, the rows in ascending order, and the cells are those of the
    integer coding. Over 200 draws such paths have 10.8, 21.8 and 43.7 cells on average for sizes 8, 16 and 32; Table 1
    implies 10, 23 and 57.

    Parameters
    ----------
    size : int
        Cells a side, 2 to 4096.
    p0 : float
        Probability of an obstacle in every cell off the path, 0 to 1.
    random_state : numpy.random.Generator or int
        Source of randomness, or a seed.

    Returns
    -------
    OccupancyGrid
        With ``corner_cutting=True``, as in the paper.

    Raises
    ------
    GridError
        If an argument is of another kind or out of its range.

    References
    ----------
    Ahmed and Deb (2013), section 6.
    """
    size = checks.whole("size", size, 2, MOST_CELLS, expected=f"2 to {MOST_CELLS:,} cells a side", error=GridError)
    p0 = checks.number("p0", p0, 0.0, 1.0, expected="a probability from 0 to 1", error=GridError)
    random_state = _generator(random_state)
    empty = OccupancyGrid(np.zeros((size, size), dtype=bool), corner_cutting=True)
    frame = MonotoneFrame(empty, (0, 0), (size - 1, size - 1))
    rows = np.sort(random_state.integers(0, size, size=size - 1))
    path = ColumnPaths.through(frame, rows[None, :]).cells(0)
    occupied = random_state.random((size, size)) < p0
    occupied[path[:, 1], path[:, 0]] = False
    return OccupancyGrid(occupied, corner_cutting=True, name=f"random {size} x {size}, p0 = {p0:g}")


def convex_environment(random_state: np.random.Generator | int) -> OccupancyGrid:
    """Return a map of 500 x 500 cells with nine convex obstacles: polygons with 5 to 9 corners on ellipses.

    A stand-in for the simple environment of Hliwa and Atieh.

    Parameters
    ----------
    random_state : numpy.random.Generator or int
        Source of randomness, or a seed.

    Raises
    ------
    GridError
        If it is neither.

    References
    ----------
    H. Hliwa and B. Atieh, "Multi objective path planning in static environment using region of sight", section III A.
    """
    return _of_blocks("convex", 500, 3, _polygon, _generator(random_state))


def concave_environment(random_state: np.random.Generator | int) -> OccupancyGrid:
    """Return a map of 400 x 400 cells with 16 obstacles that are not convex: letters L, T and U, turned by any angle.

    Parameters
    ----------
    random_state : numpy.random.Generator or int
        Source of randomness, or a seed.

    Raises
    ------
    GridError
        If it is neither.

    References
    ----------
    Hliwa and Atieh, section III B.
    """
    return _of_blocks("concave", 400, 4, _letter, _generator(random_state))


def maze_environment(random_state: np.random.Generator | int) -> OccupancyGrid:
    """Return a map of 230 x 200 cells that is like a maze: rooms that a depth-first walk has joined, and some walls less.

    Parameters
    ----------
    random_state : numpy.random.Generator or int
        Source of randomness, or a seed.

    Raises
    ------
    GridError
        If it is neither.

    References
    ----------
    Hliwa and Atieh, section III C.
    """
    random_state = _generator(random_state)
    (n_x, n_y), (height, width) = _ROOMS, (200, 230)
    # Whether each room is open to the next one in x, and in y.
    open_x, open_y = (random_state.random((n_y, n_x)) < _OPENED for _ in range(2))
    seen = np.zeros((n_y, n_x), dtype=bool)
    seen[0, 0] = True
    walk = [(0, 0)]
    while walk:
        x, y = walk[-1]
        beside = [(x + d * (k == 0), y + d * (k == 1)) for k in (0, 1) for d in (-1, 1)]
        beside = [(i, j) for i, j in beside if 0 <= i < n_x and 0 <= j < n_y and not seen[j, i]]
        if not beside:
            walk.pop()
            continue
        i, j = beside[random_state.integers(len(beside))]
        (open_x if j == y else open_y)[min(y, j), min(x, i)] = seen[j, i] = True
        walk.append((i, j))
    xs, ys = (np.linspace(0, side, n + 1).round().astype(int) for side, n in ((width, n_x), (height, n_y)))
    occupied = np.zeros((height, width), dtype=bool)
    for y in range(n_y):
        for x in range(n_x):
            # Walls end in posts, whatever is open.
            right, up = (slice(at - _HALF_WALL, at + _HALF_WALL + 1) for at in (xs[x + 1], ys[y + 1]))
            if x + 1 < n_x:
                occupied[slice(ys[y], ys[y + 1]) if not open_x[y, x] else up, right] = True
            if y + 1 < n_y:
                occupied[up, slice(xs[x], xs[x + 1]) if not open_y[y, x] else right] = True
    return OccupancyGrid(occupied, name="maze")


def far_corners(grid: OccupancyGrid) -> tuple[tuple[int, int], tuple[int, int]]:
    """Return start and goal for `convex_environment` and its kin: near the bottom-left and the top-right corner, both free.

    Raises
    ------
    GridError
        If it is no grid.
    """
    x, y = (round(_INSET * side) for side in (check_grid(grid).width, grid.height))
    return (x, y), (grid.width - 1 - x, grid.height - 1 - y)


def _generator(random_state) -> np.random.Generator:
    """Return a source of randomness."""
    if isinstance(random_state, np.random.Generator):
        return random_state
    expected = "a seed or a numpy.random.Generator"
    return np.random.default_rng(checks.whole("random_state", random_state, 0, expected=expected, error=GridError))


def _of_blocks(name: str, side: int, n: int, draw, random_state: np.random.Generator) -> OccupancyGrid:
    """Return a square map of n x n blocks, with an obstacle in each: what is drawn are convex parts of it in the unit disc."""
    occupied = np.zeros((side, side), dtype=bool)
    centres = np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).astype(float)
    edges = np.linspace(0, side, n + 1)
    room = (edges[1] - edges[0]) / 2 - _STREET * side
    for block in range(n * n):
        reach = room * random_state.uniform(0.8, 1.0)
        middle = edges[[block % n, block // n]] + side / (2 * n) + (room - reach) * random_state.uniform(-1, 1, 2)
        angle = random_state.uniform(0, 2 * np.pi)
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        for part in draw(random_state):
            occupied |= _inside(middle + reach * part @ turn, centres)
    return OccupancyGrid(occupied, name=name)


def _polygon(random_state: np.random.Generator) -> list[np.ndarray]:
    """Return the corners of a convex polygon, counter-clockwise."""
    n = random_state.integers(5, 10)
    angles = (np.arange(n) + random_state.uniform(0, 0.8, n)) * 2 * np.pi / n
    return [np.stack([np.cos(angles), random_state.uniform(0.6, 1.0) * np.sin(angles)], axis=1)]


def _letter(random_state: np.random.Generator) -> list[np.ndarray]:
    """Return the corners of the bars of a letter, each counter-clockwise."""
    bars = _LETTERS[random_state.integers(len(_LETTERS))]
    return [np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]) / np.sqrt(2) for x0, y0, x1, y1 in bars]


def _inside(corners: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return whether points lie in a convex polygon, whose corners come counter-clockwise."""
    inside = np.ones(points.shape[:-1], dtype=bool)
    for (ax, ay), (bx, by) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        inside &= (bx - ax) * (points[..., 1] - ay) - (by - ay) * (points[..., 0] - ax) >= 0
    return inside
