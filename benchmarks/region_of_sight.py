"""What region of sight keeps of its promises, and of its paper's claims.

    python benchmarks/region_of_sight.py [--each 30] [--maps FOLDER] [--queries 1000] [--speed MAP]

On seeded maps of the paper's three kinds, so many of each: passes, distance to obstacles and lengths, beside the numbers that
the paper prints for its own maps, which are lost. FOLDER holds MovingAI maps (``*.map``): on these and on the maps that ship,
so many random queries that have a path, all together, solved or not. MAP, such as lak304d.map, is a map on which processor
time is compared with that of the compiled search by Dijkstra's method from all cells to the goal, in turn, 50 queries, the
least of five rounds each.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import RegionOfSight
from pymoo_gridpath.compiled import COMPILED
from pymoo_gridpath.maps import load_map, load_shipped, shipped_maps
from pymoo_gridpath.neighbourhood import DIAGONAL as IS_DIAGONAL
from pymoo_gridpath.objectives import Vulnerability
from pymoo_gridpath.problems import concave_environment, convex_environment, far_corners, maze_environment
from pymoo_gridpath.search.counted import DIAGONAL, STRAIGHT
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.shortest import backward_costs
from pymoo_gridpath.testing.reference import is_legal, length

Cell = tuple[int, int]
Query = tuple[OccupancyGrid, Cell, Cell]

# Of Ahmed and Deb (2013).
OBJECTIVES = ("length", Vulnerability(variance=0.5))

# Length, distance to obstacles, curvature in 1 / m and passes, tables I to III.
_PRINTED: dict[Callable[[int], OccupancyGrid], str] = {
    convex_environment: "677.49, 5, 0.005, 7",
    concave_environment: "623.74, 4, 0.1123, 4",
    maze_environment: "356.77, 3, 0.1806, 7",
}


def plan(query: Query, **arguments):
    """Return what is found, and the problem."""
    problem = GridPathProblem(*query, "cells", OBJECTIVES)
    planner = RegionOfSight(**arguments)
    return planner.plan(problem), planner.found, problem


def cells_of(planned, problem) -> list[Cell]:
    """Return the cells of the path that is returned, from its genes."""
    paths = problem.decode(np.asarray(planned.paths))
    return [tuple(cell) for cell in paths.cells(0).tolist()] if len(paths) else []


def spread(values) -> str:
    return f"{np.median(values):.3f} ({np.min(values):.3f} to {np.max(values):.3f})"


def claims(make: Callable[[int], OccupancyGrid], n: int) -> np.ndarray:
    """Print what holds on maps of one kind; return the passes."""
    rows, lowered, fallback = [], 0, 0
    for seed in range(n):
        grid = make(seed)
        query = grid, *far_corners(grid)
        planned, found, problem = plan(query)
        _, from_shortest, _ = plan(query, road="shortest")
        lowered, fallback = lowered + ("none at" in planned.message), fallback + int(found.fallback[0])
        rows.append(
            (
                found.passes[0],
                found.clearance[0] - found.radius[0],
                found.waypoints[0].length,
                length(cells_of(planned, problem)) / from_shortest.lengths[0][0],
                found.waypoints[0].length / from_shortest.waypoints[0].length,
                *found.curvature[0],
                from_shortest.passes[0],
            )
        )
    passes, room, lengths, octile, euclidean, most, mean, without = np.array(rows).T
    print(f"{make(0).name}, {n} maps: radius lowered {lowered}, road left {fallback}; the paper's map: {_PRINTED[make]}")
    print(f"  passes: {np.median(passes):g} in the median, {passes.max():g} at most; {np.median(without):g} without a road")
    print(f"  clearance less radius: {spread(room)}; at least the radius on {(room >= 0).sum()}")
    print(f"  length along waypoints: {spread(lengths)}")
    print(f"  length of the cells over the shortest between the grown obstacles: {spread(octile)}")
    print(f"  length along waypoints over that of the same shortening of a shortest path: {spread(euclidean)}")
    print(f"  curvature, greatest: {spread(most)}; mean: {spread(mean)}", flush=True)
    return passes


def queries_of(grid: OccupancyGrid, n: int, rng: np.random.Generator) -> Iterator[Query]:
    """Yield queries on a map that have a path."""
    free = np.argwhere(~grid.occupied)
    while n:
        (ya, xa), (yb, xb) = free[rng.choice(len(free), 2, replace=False)].tolist()
        if grid.regions[ya, xa] == grid.regions[yb, xb]:
            n -= 1
            yield grid, (xa, ya), (xb, yb)


def promises(grid: OccupancyGrid, n: int, rng: np.random.Generator) -> None:
    """Print how many queries on a map are solved, and legally."""
    for road in ("skeleton", "shortest"):
        solved = legal = lowered = fallback = 0
        passes, ratios = [], []
        for query in queries_of(grid, n, rng):
            planned, found, problem = plan(query, road=road)
            cells = cells_of(planned, problem)
            solved, legal = solved + planned.success, legal + is_legal(cells, *query)
            lowered, fallback = lowered + ("none at" in planned.message), fallback + int(found.fallback[0])
            passes.append(found.passes[0])
            ratios.append(length(cells) / grid.shortest_length(*query[1:]))
        print(
            f"{grid.name}, road {road}: {solved} of {n} solved, {legal} legal; radius lowered {lowered}, road left {fallback}; "
            f"passes {np.median(passes):g}, {max(passes)}; length over the shortest {spread(ratios)}",
            flush=True,
        )


def speed(grid: OccupancyGrid, rng: np.random.Generator) -> None:
    """Print processor times beside those of Dijkstra's search."""
    moves = Moves(grid)
    problems = [GridPathProblem(*query, "cells", OBJECTIVES) for query in queries_of(grid, 50, rng)]
    lengths = np.tile(np.where(IS_DIAGONAL, DIAGONAL, STRAIGHT), (9, 1)).astype(np.int64)
    step, field = np.stack([lengths, 0 * lengths]), np.zeros((2, moves.n_cells), dtype=np.int64)
    searches: dict[str, Callable[[GridPathProblem], object]] = {
        "Dijkstra, to all cells": lambda problem: backward_costs(moves, step, field, moves.index(problem.goal)),
        "region of sight, no road": RegionOfSight(road="shortest").plan,
        "region of sight, skeleton": RegionOfSight().plan,
    }
    times = np.empty((len(searches), len(problems), 6))
    for k in range(times.shape[2]):
        for j, problem in enumerate(problems):
            for i, search in enumerate(searches.values()):
                begin = time.process_time()
                search(problem)
                times[i, j, k] = time.process_time() - begin
    # Kernels are compiled in the first round.
    least = times[:, :, 1:].min(axis=2)
    print(f"{grid.name}: {grid.width} x {grid.height}, {len(problems)} queries, kernels {'' if COMPILED else 'not '}compiled")
    for name, row in zip(searches, least, strict=True):
        print(f"  {name:26} {row.mean() * 1e3:6.2f} ms in the mean, {row.sum() / least[0].sum():.2f} of Dijkstra's")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--each", type=int, default=30, help="maps of each of the paper's kinds (default: 30)")
    parser.add_argument("--maps", type=Path, help="a folder of MovingAI maps")
    parser.add_argument("--queries", type=int, default=1000, help="queries on maps, all together (default: 1,000)")
    parser.add_argument("--speed", help="a map on which to compare processor times")
    arguments = parser.parse_args()

    rng = np.random.default_rng(1)
    if arguments.each:
        passes = np.concatenate([claims(make, arguments.each) for make in _PRINTED])
        print(f"all three kinds: {np.median(passes):g} passes in the median, {passes.max():g} at most")
    if arguments.maps:
        grids = [load_map(path) for path in sorted(arguments.maps.glob("*.map"))]
        grids += [load_shipped(item.name).inflate(item.radius) for item in shipped_maps()]
        for grid in grids:
            promises(grid, -(-arguments.queries // len(grids)), rng)
    if arguments.speed:
        speed(load_map(arguments.speed), rng)


if __name__ == "__main__":
    main()
