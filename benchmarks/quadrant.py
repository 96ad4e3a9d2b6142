"""What quadrant selection keeps of its promises: legal paths for all solvable queries, all alternatives counted.

    python benchmarks/quadrant.py [--maps FOLDER] [--random 20000] [--each 1000] [--small 1000] [--many 500] [--claims 30]

FOLDER holds MovingAI maps (``*.map``); without it there are none. Random grids have 3 to 40 cells a side, both corner rules and
densities up to one half. Small ones have up to 12 cells a side, and their alternatives are walked one by one besides.

Of queries with many alternatives, more than the 64 that are listed and up to 1,000, it is counted how often the first is the
quickest of all.

What the paper claims is looked at on the shipped maps, the robot's radius inflated, by random queries at least a third of the
map apart: lengths over the shortest in the median and at most, before and after smoothing; how many paths the exact front of
length and vulnerability dominates; and free cells looked at, beside A* with Manhattan and octile estimates, in the median.

Any number may be 0.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import AStar, ExactFront, QuadrantSelection
from pymoo_gridpath.grid import Cell
from pymoo_gridpath.maps import load_map, shipped_maps
from pymoo_gridpath.objectives import Vulnerability
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


def queries_on(
    grid: OccupancyGrid, n: int, rng: np.random.Generator, apart: float = 0.0
) -> Iterator[tuple[OccupancyGrid, Cell, Cell]]:
    """Yield queries on a map that have a path."""
    while n:
        query = query_on(grid, rng, apart)
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
        alternatives.append(float(min(found.n_alternatives, 10**300)))
        ratios.append(length(cells) / grid.shortest_length(start, goal))
    print(
        f"{name}: {solved} of {n} solved, {legal} legal; length over the shortest {np.median(ratios):.3f} in the median, "
        f"{max(ratios):.3f} at most; alternatives {np.median(alternatives):g}, {max(alternatives):.3g}",
        flush=True,
    )


def try_small(n: int, rng: np.random.Generator) -> None:
    """Print on how many small grids number and best of the alternatives are those of an enumeration."""
    counted = quickest = 0
    for _ in range(n):
        query = random_query(rng, 3, 12)
        paths, (_, found) = enumerate_branches(*query), plan(*query)
        best = min(length(path) / 0.24 + 0.02 * turn(path) for path in paths)
        counted += len(paths) == found.n_alternatives
        quickest += abs(best - found.seconds[0]) < 1e-6
    print(f"small grids: of {n} the number of alternatives is right on {counted}, the least time on {quickest}", flush=True)


def try_many(n: int, rng: np.random.Generator) -> None:
    """Print how often the first of those that are listed is the quickest of all, and how much slower it may be."""
    ratios: list[float] = []
    while len(ratios) < n:
        query = random_query(rng, 20, 40)
        _, found = plan(*query)
        if 64 < found.n_alternatives <= 1000:
            _, whole = plan(*query, max_paths=1000)
            ratios.append(found.seconds[0] / whole.seconds[0])
    same = np.count_nonzero(np.array(ratios) < 1 + 1e-9)
    print(
        f"many alternatives: the first is the quickest in {same} of {n}, and takes {max(ratios):.3f} times as long at most",
        flush=True,
    )


def try_claims(name: str, grid: OccupancyGrid, n: int, rng: np.random.Generator) -> None:
    """Print what is true of the paper's claims on a map."""
    raw, smooth = [], []
    cells: list[list[int]] = []
    solved = strictly = dominated = 0
    for grid_, start, goal in queries_on(grid, n, rng, apart=1 / 3):
        path, found = plan(grid_, start, goal)
        solved += bool(path)
        strictly += bool(plan(grid_, start, goal, strict=True)[0])
        shortest = grid.shortest_length(start, goal)
        raw.append(length([tuple(cell) for cell in found.raw[0].tolist()]) / shortest)
        smooth.append(length(path) / shortest)
        problem = GridPathProblem(grid, start, goal, "cells", ("length", Vulnerability(variance=0.5)))
        F, front = (np.asarray(minimize(problem, planner).F) for planner in (QuadrantSelection(), ExactFront()))
        dominated += bool(((front <= F + 1e-9).all(axis=1) & (front < F - 1e-9).any(axis=1)).any())
        cells.append([found.free_cells])
        for search in (AStar("manhattan"), AStar("octile")):
            search.plan(problem)
            cells[-1].append(search.found.n_cells)
    lengths = [f"{np.median(ratios):.3f} ({max(ratios):.3f})" for ratios in (raw, smooth)]
    print(
        f"{name}: {solved} of {n} solved, {strictly} by the letter; length {lengths[0]}, smoothed {lengths[1]}; {dominated} "
        f"dominated; cells {' / '.join(f'{k:g}' for k in np.median(cells, axis=0))}",
        flush=True,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--maps", type=Path, help="a folder of MovingAI maps")
    parser.add_argument("--random", type=int, default=20_000, help="queries on random grids (default: 20,000)")
    parser.add_argument("--each", type=int, default=1000, help="queries on each map (default: 1,000)")
    parser.add_argument("--small", type=int, default=1000, help="small grids, all paths enumerated (default: 1,000)")
    parser.add_argument("--many", type=int, default=500, help="queries with many alternatives (default: 500)")
    parser.add_argument("--claims", type=int, default=30, help="queries on each shipped map (default: 30)")
    arguments = parser.parse_args()

    rng = np.random.default_rng(1)
    if arguments.random:
        try_all("random grids", (random_query(rng, 3, 40) for _ in range(arguments.random)))
    if arguments.small:
        try_small(arguments.small, rng)
    if arguments.many:
        try_many(arguments.many, rng)
    for item in shipped_maps() if arguments.claims else []:
        try_claims(item.name, load_map(item.path).inflate(item.radius), arguments.claims, rng)
    for path in sorted(arguments.maps.glob("*.map")) if arguments.maps else []:
        try_all(path.stem, queries_on(load_map(path), arguments.each, rng))


if __name__ == "__main__":
    main()
