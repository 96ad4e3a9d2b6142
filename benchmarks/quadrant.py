"""What quadrant selection keeps of its promises: legal paths for all solvable queries, all alternatives counted.

    python benchmarks/quadrant.py [--maps FOLDER] [--random 20000] [--each 1000] [--small 1000]

FOLDER holds MovingAI maps (``*.map``); without it random grids alone are tried. Random grids have 3 to 40 cells a side, both
corner rules and densities up to one half; small ones up to 12 cells a side, whose alternatives are walked one by one besides.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import QuadrantSelection
from pymoo_gridpath.maps import load_map
from pymoo_gridpath.neighbourhood import HEADING_OF, HEADINGS
from pymoo_gridpath.paths import CellPaths
from pymoo_gridpath.representations import CellSequence
from pymoo_gridpath.testing.reference import is_legal, length, turn

Cell = tuple[int, int]
Query = tuple[OccupancyGrid, Cell, Cell]


def random_query(rng: np.random.Generator, least: int, most: int) -> Query:
    """Return a random grid and a query on it that has a path."""
    while True:
        occupied = rng.random(rng.integers(least, most + 1, 2)) < rng.uniform(0, 0.5)
        grid = OccupancyGrid(occupied, corner_cutting=bool(rng.integers(2)))
        query = draw_query(grid, rng)
        if query is not None:
            return query


def draw_query(grid: OccupancyGrid, rng: np.random.Generator) -> Query | None:
    """Return a query on a grid, or None if two cells were drawn that no path joins."""
    free = np.argwhere(~grid.occupied)
    if len(free) < 2:
        return None
    (ya, xa), (yb, xb) = free[rng.choice(len(free), 2, replace=False)].tolist()
    return (grid, (xa, ya), (xb, yb)) if grid.regions[ya, xa] == grid.regions[yb, xb] else None


def plan(grid: OccupancyGrid, start: Cell, goal: Cell, **arguments):
    """Return the cells of the path that is found, and what else is."""
    problem = GridPathProblem(grid, start, goal, CellSequence(grid, start, goal, max_cells=grid.occupied.size))
    planner = QuadrantSelection(**arguments)
    planned = planner.plan(problem)
    paths = problem.decode(np.asarray(planned.paths))
    assert isinstance(paths, CellPaths)
    return [tuple(cell) for cell in paths.cells(0).tolist()] if len(paths) else [], planner.found


def all_paths(grid: OccupancyGrid, start: Cell, goal: Cell) -> list[list[Cell]]:
    """Return the paths of every branch, each walked anew."""
    found: list[list[Cell]] = []

    def legal(cell: Cell, m: int) -> bool:
        (x, y), (dx, dy) = cell, HEADINGS[m % 8].tolist()
        beside = not (dx and dy) or grid.corner_cutting or (grid.is_free((x + dx, y)) and grid.is_free((x, y + dy)))
        return grid.is_free((x + dx, y + dy)) and beside

    def step(cell: Cell, m: int) -> Cell:
        return cell[0] + int(HEADINGS[m % 8, 0]), cell[1] + int(HEADINGS[m % 8, 1])

    def ahead(cell: Cell) -> int:
        return int(HEADING_OF[np.sign(goal[1] - cell[1]) + 1, np.sign(goal[0] - cell[0]) + 1])

    def far(cell: Cell) -> float:
        low, high = sorted((abs(goal[0] - cell[0]), abs(goal[1] - cell[1])))
        return high - low + math.sqrt(2) * low

    def branch(before: list[Cell], stretch: list[Cell]) -> None:
        while stretch[-1] != goal and legal(stretch[-1], ahead(stretch[-1])):
            stretch.append(step(stretch[-1], ahead(stretch[-1])))
        path = before + without_loops(stretch)
        if path[-1] == goal:
            found.append(without_loops(path))
            return
        way = [path[-1]]
        while way[-1] != goal:
            way.append(step(way[-1], ahead(way[-1])))
        for side in (-1, 1):
            branch(path[:-1], around(path[-1], way[1:], side))

    def around(hit: Cell, way: list[Cell], side: int) -> list[Cell]:
        cells, m = [hit], ahead(hit) + side
        while True:
            while not legal(cells[-1], m):
                m += side
            cells.append(step(cells[-1], m))
            cell = cells[-1]
            if far(cell) < far(hit) and (cell in way or legal(cell, ahead(cell))):
                return cells
            onto = [step(cell, k) for k in range(8) if legal(cell, k)]
            onto = [other for other in onto if other in way and far(other) < far(hit)]
            if onto:
                return [*cells, min(onto, key=far)]
            m -= side * (1 if grid.corner_cutting and m % 2 == 0 else 2)

    branch([], [start])
    return found


def without_loops(path: list[Cell]) -> list[Cell]:
    """Return a path without what lies between the first and the last visit of a cell."""
    last, kept, k = {cell: i for i, cell in enumerate(path)}, [], 0
    while k < len(path):
        kept.append(path[k])
        k = last[path[k]] + 1
    return kept


def queries_of(path: Path, n: int, rng: np.random.Generator) -> Iterator[Query]:
    """Yield queries on a map that have a path."""
    grid = load_map(path)
    while n:
        query = draw_query(grid, rng)
        if query is not None:
            n -= 1
            yield query


def try_all(name: str, queries) -> None:
    """Print how many of some queries are solved, and legally."""
    n = solved = legal = 0
    ratios, alternatives = [], []
    for grid, start, goal in queries:
        cells, found = plan(grid, start, goal)
        n, solved, legal = n + 1, solved + bool(cells), legal + is_legal(cells, grid, start, goal)
        alternatives.append(float(found.n_alternatives))
        ratios.append(length(cells) / grid.shortest_length(start, goal))
    print(
        f"{name}: {solved} of {n} solved, {legal} legal; length over the shortest {np.median(ratios):.3f} in the median, "
        f"{max(ratios):.3f} at most; alternatives {np.median(alternatives):g}, {max(alternatives):.3g}",
        flush=True,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--maps", type=Path, help="a folder of MovingAI maps")
    parser.add_argument("--random", type=int, default=20_000, help="queries on random grids (default: 20,000)")
    parser.add_argument("--each", type=int, default=1000, help="queries on each map (default: 1,000)")
    parser.add_argument("--small", type=int, default=1000, help="small grids, all paths enumerated (default: 1,000)")
    arguments = parser.parse_args()

    rng = np.random.default_rng(1)
    if arguments.random:
        try_all("random grids", (random_query(rng, 3, 40) for _ in range(arguments.random)))
    if arguments.small:
        counted = quickest = 0
        for _ in range(arguments.small):
            query = random_query(rng, 3, 12)
            paths, (_, found) = all_paths(*query), plan(*query)
            best = min(length(path) / 0.24 + 0.02 * turn(path) for path in paths)
            counted += len(paths) == found.n_alternatives
            quickest += abs(best - found.seconds[0]) < 1e-6
        print(
            f"small grids: of {arguments.small} the number of alternatives is right on {counted}, the least time on {quickest}"
        )
    for path in sorted(arguments.maps.glob("*.map")) if arguments.maps else []:
        try_all(path.stem, queries_of(path, arguments.each, rng))


if __name__ == "__main__":
    main()
