"""On how many queries of a robot's map there is nothing to choose from, and how paths of a slanted corridor turn.

    python benchmarks/one_point_fronts.py FOLDER [--max-seconds 60]

FOLDER holds ``depot.yaml`` and its image, a map of 604 x 307 cells of 5 cm that ships with Navigation2. On it are 40 queries,
20 for a robot of 0.2 m radius and 20 for one of 0.3 m, drawn at random, at least a third of the map apart. For each the exact
front of length and risk is found, with the paper's risk, which was the default on all maps, and with the robot's, which is the
default on maps that state their resolution. Printed are the fronts of a single point, the points of a front, and on how many
queries the safest path has a lower mean clearance than the shortest.

Two corridors are empty and rise by a cell in three. Printed is the turn of the safest path, of the exact front and of NSGA-II,
with a risk that is cut off and with one that is not, of which the tail alone tells paths apart: the robot's in a corridor 4 m
wide, and the paper's in one of 0.55 m. All over the narrow one the robot's risk tells paths apart by more than a tail, so that
the safest path follows the stairs of the middle; its waypoints are what to drive by.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid, TradeOffSet
from pymoo_gridpath.algorithms import make_algorithm
from pymoo_gridpath.exact import Budget, exact_front
from pymoo_gridpath.fields import clearance
from pymoo_gridpath.maps import load_map
from pymoo_gridpath.objectives import Objective, Vulnerability

RISKS: dict[str, Objective] = {"paper": Vulnerability(variance=0.5), "robot": Vulnerability()}

# Start and goal, x and y of each, by the robot's radius in metres.
QUERIES: dict[float, list[tuple[int, int, int, int]]] = {
    0.2: [
        (482, 132, 88, 180),
        (550, 114, 317, 295),
        (591, 104, 195, 257),
        (34, 141, 443, 253),
        (154, 213, 405, 13),
        (507, 30, 489, 272),
        (420, 187, 105, 221),
        (182, 22, 205, 251),
        (571, 134, 56, 79),
        (255, 86, 8, 82),
        (210, 299, 203, 86),
        (297, 259, 552, 87),
        (353, 28, 143, 154),
        (289, 157, 526, 150),
        (469, 38, 489, 252),
        (93, 196, 499, 120),
        (440, 148, 84, 19),
        (286, 58, 264, 264),
        (204, 292, 96, 43),
        (588, 32, 72, 293),
    ],
    0.3: [
        (140, 245, 581, 97),
        (264, 143, 543, 187),
        (287, 31, 40, 254),
        (392, 191, 154, 54),
        (78, 207, 588, 235),
        (170, 278, 544, 137),
        (252, 164, 577, 257),
        (237, 286, 459, 190),
        (243, 55, 473, 195),
        (403, 174, 129, 193),
        (54, 212, 320, 151),
        (125, 232, 311, 23),
        (211, 167, 461, 160),
        (432, 227, 164, 127),
        (92, 245, 310, 153),
        (362, 192, 152, 53),
        (12, 186, 225, 292),
        (509, 36, 221, 126),
        (206, 60, 589, 145),
        (443, 267, 13, 282),
    ],
}


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
    paper, robot = totals.values()
    print(f"fronts of one point, of {n}: {paper} by the paper's risk, {robot} by the robot's (expected at most 2)")


def _mean_clearance(grid: OccupancyGrid, record) -> float:
    """Return the mean distance to obstacles along a path, in cells."""
    x, y = record.cells.T
    return float(clearance(grid)[y, x].mean())


def corridor(length: int, half: int) -> tuple[OccupancyGrid, tuple[int, int], tuple[int, int]]:
    """Return an empty corridor of 5 cm cells, ``half`` of them from its middle to its sides, with its ends in the middle."""
    x, y = np.meshgrid(np.arange(length), np.arange(length // 3 + 2 * half + 3))
    grid = OccupancyGrid(np.abs(y - x / 3 - half - 1) > half, 0.05, name="corridor")
    return grid, (2, half + 2), (length - 3, (length - 3) // 3 + half + 1)


# Length and half the width in cells; the risk, and what the turn of its safest path is expected to be.
CORRIDORS: tuple[tuple[int, int, str, Objective, str], ...] = (
    (150, 40, "robot's", Vulnerability(), "expected at most 360"),
    (150, 40, "robot's, not cut off", Vulnerability(cutoff=0.0), ""),
    (80, 5, "paper's, cut off", Vulnerability(variance=0.5, cutoff=1e-3), "expected at most 360"),
    (80, 5, "paper's", Vulnerability(variance=0.5), ""),
    (80, 5, "robot's", Vulnerability(), ""),
)


def turn(seconds: float) -> None:
    """Print how the safest paths of the corridors turn."""
    print(f"{'corridor':<14}{'risk':<22}{'exact paths':>12}{'turn of safest':>16}{'by NSGA-II':>12}")
    for length, half, name, risk, expected in CORRIDORS:
        grid, start, goal = corridor(length, half)
        exact = front_of(grid, start, goal, risk, seconds)
        problem = exact.problem
        found = minimize(problem, make_algorithm("NSGA2", problem, pop_size=100), ("n_gen", 100), seed=1)
        searched = TradeOffSet.from_results(found).safest.turn
        print(
            f"{f'{length} x {2 * half + 1}':<14}{name:<22}{len(exact):>12}{exact.safest.turn:>16g}{searched:>12g}  {expected}",
            flush=True,
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
