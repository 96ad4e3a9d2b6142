"""What quadrant selection keeps of its promises: legal paths for all solvable queries, all alternatives counted.

    python benchmarks/quadrant.py [--maps FOLDER] [--random 20000] [--each 1000] [--small 1000]

FOLDER holds MovingAI maps (``*.map``); without it random grids alone are tried. Random grids have 3 to 40 cells a side, both
corner rules and densities up to one half; small ones up to 12 cells a side, whose alternatives are walked one by one besides.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import QuadrantSelection
from pymoo_gridpath.grid import Cell
from pymoo_gridpath.maps import load_map
from pymoo_gridpath.paths import CellPaths
from pymoo_gridpath.representations import CellSequence
from pymoo_gridpath.testing.branches import enumerate_branches
from pymoo_gridpath.testing.enumeration import query_on, random_query
from pymoo_gridpath.testing.reference import is_legal, length, turn


def plan(grid: OccupancyGrid, start: Cell, goal: Cell, **arguments):
    """Return the cells of the path that is found, and what else is."""
    problem = GridPathProblem(grid, start, goal, CellSequence(grid, start, goal, max_cells=grid.occupied.size))
    planner = QuadrantSelection(**arguments)
    planned = planner.plan(problem)
    paths = problem.decode(np.asarray(planned.paths))
    assert isinstance(paths, CellPaths)
    return [tuple(cell) for cell in paths.cells(0).tolist()] if len(paths) else [], planner.found


def queries_of(path: Path, n: int, rng: np.random.Generator) -> Iterator[tuple[OccupancyGrid, Cell, Cell]]:
    """Yield queries on a map that have a path."""
    grid = load_map(path)
    while n:
        query = query_on(grid, rng)
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
            paths, (_, found) = enumerate_branches(*query), plan(*query)
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
