"""On how many queries of a robot's map there is nothing to choose from, and how paths of a slanted corridor turn.

    python benchmarks/one_point_fronts.py FOLDER [--max-seconds 60]

FOLDER holds ``depot.yaml`` and its image, the map of 604 x 307 cells of 5 cm of AWS RoboMaker's small warehouse as it ships with
Navigation2. On it are 40 queries, 20 for a robot of 0.2 m radius and 20 for one of 0.3 m, drawn at random. For each the exact front
of length and risk is found, with the paper's risk, which was the default on all maps, and with the robot's, which is the
default on maps that state their resolution. Printed are the fronts of a single point, and the points of a front.

The corridor is empty and rises by a cell in three. Printed is the turn of its safest path: with the robot's risk, with the same but
not cut off, and with the paper's; of the exact front, and of NSGA-II with path-aware operators.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid, TradeOffSet
from pymoo_gridpath.algorithms import make_algorithm
from pymoo_gridpath.exact import Budget, exact_front
from pymoo_gridpath.maps import load_map
from pymoo_gridpath.objectives import Objective, Vulnerability

RISKS: dict[str, Objective] = {"paper": Vulnerability(variance=0.5), "robot": Vulnerability()}

# Start and goal, x and y of each, by the robot's radius in metres.
QUERIES: dict[float, list[tuple[int, int, int, int]]] = {}


def front_of(grid: OccupancyGrid, start, goal, risk: Objective, seconds: float) -> TradeOffSet:
    """Return the exact front of length and risk; it is an error if there is no time for it."""
    problem = GridPathProblem(grid, start, goal, "cells", ("length", risk))
    found = exact_front(problem, Budget(max_seconds=seconds))
    assert found.complete, found.message
    return TradeOffSet.from_genes(problem, found.X)


def count(folder: Path, seconds: float) -> None:
    """Print the fronts of a single point."""
    grid = load_map(folder / "depot.yaml")
    totals = dict.fromkeys(RISKS, 0)
    print(f"{'risk':<8}{'radius':>8}{'one point':>11}{'points, median':>16}{'most':>6}{'safest less clear':>19}")
    for radius, queries in QUERIES.items():
        grown = grid.inflate(radius)
        for name, risk in RISKS.items():
            fronts = [front_of(grown, (xa, ya), (xb, yb), risk, seconds) for xa, ya, xb, yb in queries]
            sizes = [len(front) for front in fronts]
            totals[name] += sizes.count(1)
            worse = sum(_mean_clearance(grown, front.safest) < _mean_clearance(grown, front.shortest) for front in fronts)
            median = f"{np.median(sizes):g}"
            print(f"{name:<8}{radius:>8g}{sizes.count(1):>8} of {len(sizes)}{median:>13}{max(sizes):>6}{worse:>19}", flush=True)
    n = sum(map(len, QUERIES.values()))
    print(
        f"fronts of one point of {n}: {totals['paper']} by the paper's risk, {totals['robot']} by the robot's (expected at most 2)"
    )


def _mean_clearance(grid: OccupancyGrid, record) -> float:
    """Return the mean distance to obstacles along a path, in cells."""
    from pymoo_gridpath.fields import clearance

    x, y = record.cells.T
    return float(clearance(grid)[y, x].mean())


def corridor() -> tuple[OccupancyGrid, tuple[int, int], tuple[int, int]]:
    """Return an empty corridor of 5 cm cells that rises by one cell in three, with its ends in the middle."""
    length, half = 150, 40
    x, y = np.meshgrid(np.arange(length), np.arange(length // 3 + 2 * half + 3))
    grid = OccupancyGrid(np.abs(y - x / 3 - half - 1) > half, 0.05, name="corridor")
    return grid, (2, half + 2), (length - 3, (length - 3) // 3 + half + 1)


def turn(seconds: float) -> None:
    """Print how the safest paths of the corridor turn."""
    grid, start, goal = corridor()
    for name, risk in {**RISKS, "robot, not cut off": Vulnerability(cutoff=0.0)}.items():
        exact = front_of(grid, start, goal, risk, seconds)
        problem = GridPathProblem(grid, start, goal, "cells", ("length", risk))
        found = TradeOffSet.from_results(
            minimize(problem, make_algorithm("NSGA2", problem, pop_size=100), ("n_gen", 100), seed=1)
        )
        print(
            f"corridor, {name}: the safest of {len(exact)} exact paths turns by {exact.safest.turn:g} degrees"
            f"{' (expected at most 360)' * (name == 'robot')}, that of NSGA-II by {found.safest.turn:g}"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="where depot.yaml lies")
    parser.add_argument("--max-seconds", type=float, default=60.0, help="time of an exact front")
    arguments = parser.parse_args()
    turn(arguments.max_seconds)
    count(arguments.folder, arguments.max_seconds)


if __name__ == "__main__":
    main()
