"""Measure the waypoints of paths on maps of ROS: whether they keep what they promise, and what they save.

    python benchmarks/waypoints.py maps/depot.yaml maps/tb3_sandbox.yaml

The queries stand in waypoints_queries.csv beside this script, by the names of the maps: cells, and the radius of the robot.
Of each, the shortest path, the knee and the safest of some weighted sums are smoothed. Distances are checked by a search tree
over the centres of all occupied cells, 16 points a cell, which shares nothing with the package. The maps are not shipped.
"""

from __future__ import annotations

import argparse
import csv
import sys
import time
from collections import defaultdict
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.spatial import KDTree

from pymoo_gridpath import GridPathProblem, OccupancyGrid, TradeOffSet, load_map
from pymoo_gridpath.algorithms import Waypoints
from pymoo_gridpath.operators import ScalarizedSampling

QUERIES = Path(__file__).with_name("waypoints_queries.csv")
N_WEIGHTS, POINTS_A_CELL = 12, 16
NAMES = ("shortest", "knee", "safest")


class Obstacles:
    """Distances to occupied cells by a search tree: squares whose centres are not much further away than the nearest."""

    def __init__(self, occupied: np.ndarray):
        self.centres = np.argwhere(occupied)[:, ::-1].astype(float)
        self.tree = KDTree(self.centres)

    def distances(self, points: np.ndarray) -> np.ndarray:
        nearest, _ = self.tree.query(points)
        found = np.empty(len(points))
        for k, near in enumerate(self.tree.query_ball_point(points, nearest + 0.71)):
            beyond = np.maximum(np.abs(self.centres[near] - points[k]) - 0.5, 0.0)
            found[k] = np.hypot(beyond[:, 0], beyond[:, 1]).min()
        return found


def along(points: np.ndarray, shares: np.ndarray) -> np.ndarray:
    """Return the points at some shares of the length of a line."""
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    return np.stack([np.interp(shares * length[-1], length, points[:, axis]) for axis in (0, 1)], axis=1)


def to_spare(cells: np.ndarray, corners: np.ndarray, obstacles: Obstacles, robot: float) -> float:
    """Return by how many cells the line is clearer than promised, at the least."""
    places = {tuple(cell): k for k, cell in enumerate(cells.tolist())}
    least = np.inf
    for a, b in pairwise(corners.tolist()):
        stretch = cells[places[tuple(a)] : places[tuple(b)] + 1].astype(float)
        length = np.hypot(*np.diff(stretch, axis=0).T).sum()
        shares = np.linspace(0.0, 1.0, int(np.ceil(POINTS_A_CELL * length)) + 1)
        line = obstacles.distances(along(stretch[[0, -1]], shares))
        path = obstacles.distances(along(stretch, shares))
        # Half a cell nearer than the path, and a 32nd of one nearer than the robot is wide.
        least = min(least, float((line - np.maximum(path - 0.5, np.minimum(path, robot) - 1 / 32)).min()))
    return least


def queries() -> Iterator[dict[str, str]]:
    with open(QUERIES, newline="", encoding="utf-8") as file:
        yield from csv.DictReader(file)


def paths_of(grid: OccupancyGrid, start: tuple[int, int], goal: tuple[int, int]) -> TradeOffSet:
    problem = GridPathProblem(grid, start, goal, "cells", ("length", "vulnerability"))
    pop = ScalarizedSampling().do(problem, N_WEIGHTS, random_state=np.random.default_rng(1))
    return TradeOffSet.from_genes(problem, pop.get("X"))


def corridor() -> float:
    """Print what becomes of the safest path of an empty slanted corridor; return how far its waypoints turn, in degrees."""
    x, y = np.meshgrid(np.arange(200), np.arange(100))
    grid = OccupancyGrid(np.abs(y - 12 - 0.37 * x) > 8, 0.05, name="slanted corridor")
    record = paths_of(grid, (2, 13), (197, 85)).safest
    made = record.waypoints()
    print(f"slanted corridor: {made}")
    return made.turn


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("maps", nargs="+", type=Path)
    parser.add_argument("--every", type=int, default=1, metavar="N", help="take every Nth query")
    arguments = parser.parse_args(argv)
    maps = {path.stem: load_map(path) for path in arguments.maps}
    grids, trees = {}, {name: Obstacles(grid.occupied) for name, grid in maps.items()}
    rows: dict[tuple[str, str, bool], list[tuple[float, ...]]] = defaultdict(list)
    worst, longer, seconds, n = np.inf, -np.inf, 0.0, 0
    for query in list(queries())[:: arguments.every]:
        if query["map"] not in maps:
            continue
        key = query["map"], float(query["radius"])
        grid = grids.setdefault(key, maps[key[0]].inflate(key[1]))
        start, goal = ((int(query[f"{end}_x"]), int(query[f"{end}_y"])) for end in ("start", "goal"))
        found = paths_of(grid, start, goal)
        n += 1
        for name in NAMES:
            record = found[name]
            before = time.process_time()
            made = record.waypoints()
            seconds += time.process_time() - before
            worst = min(
                worst, to_spare(record.cells, made.cells, trees[key[0]], key[1] / maps[key[0]].check_resolution("a radius"))
            )
            path = Waypoints(grid, record.cells)
            longer = max(longer, made.length - path.length)
            for one in (path, made):
                lengths = np.array([one.length, *one.clearance]) * grid.check_resolution("a map of ROS")
                rows[key[0], name, one is made].append((lengths[0], one.turn, len(one), *lengths[1:]))
    if not n:
        raise SystemExit("no query is on these maps, expected depot.yaml and tb3_sandbox.yaml")
    print(f"{n} queries, {len(NAMES) * n} paths, {1000 * seconds / (len(NAMES) * n):.1f} ms of processor time a path")
    print("map          path      length [m]     turn [deg]     points      least clearance [m]  mean clearance [m]")
    for name in maps:
        for which in NAMES:
            if (name, which, True) in rows:
                a, b = (np.mean(rows[name, which, smooth], axis=0) for smooth in (False, True))
                print(
                    f"{name:<12} {which:<9} {a[0]:6.2f} {b[0]:6.2f}  {a[1]:6.0f} {b[1]:6.0f}  {a[2]:5.0f} {b[2]:5.1f}  "
                    f"{a[3]:8.3f} {b[3]:8.3f}    {a[4]:8.3f} {b[4]:8.3f}"
                )
    print(f"to spare of the promise, of all points looked at: {worst:.4f} cells at the least, expected 0 or more")
    print(f"longer than the path: {longer:.2g} cells at the most, expected 0 or less")
    turn = corridor()
    return 0 if worst > -1e-9 and longer < 1e-9 and turn <= 45 else 1


if __name__ == "__main__":
    sys.exit(main())
