"""Stand-ins for the six environments of Rajchandar et al. (2021), whose layouts are lost: drawn by hand after their names."""

from __future__ import annotations

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridError
from pymoo_gridpath.grid import Cell, OccupancyGrid

# Top row first: "S" the start, "G" the goal, "#" occupied.
_DRAWN = {
    "spiral": """
        S......... ########.. .......#.. .#####.#.. .#...#.#.. .#.G.#.#.. .#.###.#.. .#.....#.. .#######.. ..........
    """,
    "caved": """
        .......... .#####.... .#...#.... .#.S.#.##. .#...#.#.. .##.##.#.. .......#.. ..######.. .......#G. ..........
    """,
    "warehouse-alike": """
        S......... .##.##.##. .##.##.##. .......... .##.##.##. .##.##.##. .......... .##.##.##. .##.##.##. ........G.
    """,
    "zigzag": """
        S......... ########.. .......... ..######## .......... ########.. .......... ..######## .......... .........G
    """,
    "random": """
        S...#..... ..#....#.. ....#..... .#....#... ...#....#. ......#... .#..#..... ......#.#. ..#....... .....#...G
    """,
    "narrow way": """
        S....#.... .....#.... .....#.... .....#.... .......... .....#.... .....#.... .....#.... .....#.... .....#...G
    """,
}

#: Names of the environments, in the order of the paper's Table 2, where they are I to VI.
SMALL_ENVIRONMENTS = tuple(_DRAWN)


def small_environment(name: str, corner_cutting: bool = False) -> tuple[OccupancyGrid, Cell, Cell]:
    """Return one of six environments of 10 x 10 cells with its query.

    Parameters
    ----------
    name : {"spiral", "caved", "warehouse-alike", "zigzag", "random", "narrow way"}
    corner_cutting : bool, default False
        Whether a diagonal step may pass an occupied cell.

    Returns
    -------
    grid : OccupancyGrid
    start, goal : (int, int)
        Cells (x, y).

    Raises
    ------
    GridError
        If there is no such environment, or an argument is of another kind.

    References
    ----------
    Rajchandar et al. (2021), section 3 and Table 2. The paper shows them in figures that are lost; what is known of them is the
    name, the size and the lengths of the shortest paths.

    Examples
    --------
    >>> grid, start, goal = small_environment("spiral")
    >>> round(grid.shortest_length(start, goal), 2)
    50.0
    """
    checks.known("environment", name, SMALL_ENVIRONMENTS, GridError)
    checks.flag("corner_cutting", corner_cutting)
    rows = _DRAWN[name].split()[::-1]
    start, goal = (next((row.index(letter), y) for y, row in enumerate(rows) if letter in row) for letter in "SG")
    occupied = [[letter == "#" for letter in row] for row in rows]
    return OccupancyGrid(occupied, corner_cutting=corner_cutting, name=name), start, goal
