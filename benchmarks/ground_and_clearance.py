"""Whether exact fronts with costs of the ground, climb and least clearance are those of other ways to find them.

    python benchmarks/ground_and_clearance.py [--grids 500] [--map lak304d.map] [--queries 3] [--seed 1]

First random small grids of all rules for steps, on which every path is enumerated and scored cell by cell in plain Python:
the fronts of six problems each. Then queries on a large map, compared with searches that share no code with the package and
read the file by themselves: length against least clearance by a search of SciPy's for every distance that there is, costs of
the ground and climb by a plain label search. What differs is printed, and makes the exit code 1.
"""

from __future__ import annotations

import argparse
import heapq
import itertools
import math
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np
from scipy import sparse
from scipy.ndimage import gaussian_filter
from scipy.sparse import csgraph
from scipy.spatial import KDTree

from pymoo_gridpath import GridPathProblem, OccupancyGrid, load_map
from pymoo_gridpath.exact import exact_front
from pymoo_gridpath.objectives import Climb, GroundCost
from pymoo_gridpath.representations import CellSequence
from pymoo_gridpath.testing.enumeration import RULES, enumerate_paths, non_dominated, query_on

STEPS = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]

KINDS = (
    ("length", "clearance"),
    ("length", "ground"),
    ("length", "climb"),
    ("tolls", "climb"),
    ("length", "ground", "climb"),
    ("ground", "climb", "clearance"),
)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--grids", type=int, default=500, help="small grids (default: 500)")
    parser.add_argument("--map", type=Path, help="a map of MovingAI, such as lak304d.map")
    parser.add_argument("--queries", type=int, default=3, help="queries on it (default: 3)")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    wrong = small(arguments.grids, arguments.seed)
    if arguments.map is not None:
        wrong += large(arguments.map, arguments.queries, arguments.seed)
    return int(wrong > 0)


# -- small grids ----------------------------------------------------------------------------------------------------------


def small(n_grids: int, seed: int) -> int:
    begin, wrong, n_fronts, n_points = time.process_time(), 0, 0, 0
    for number in range(n_grids):
        rng = np.random.default_rng([seed, number])
        grid, start, goal = few_free(rng)
        paths = [path.cells for path in enumerate_paths(grid, start, goal)]
        ground, tolls, heights = (rng.integers(0, 9, grid.shape).astype(float) for _ in range(3))
        own = {"ground": GroundCost(ground), "tolls": GroundCost(tolls, per="entry", name="tolls"), "climb": Climb(heights)}
        blocked = [(x, y) for y, x in np.argwhere(grid.occupied).tolist()]
        measures = {
            "length": [sum(math.dist(a, b) for a, b in itertools.pairwise(path)) for path in paths],
            "ground": [
                sum(math.dist(a, b) * (ground[a[1], a[0]] + ground[b[1], b[0]]) / 2 for a, b in itertools.pairwise(path))
                for path in paths
            ],
            "tolls": [sum(tolls[y, x] for x, y in path) for path in paths],
            "climb": [
                sum(max(heights[b[1], b[0]] - heights[a[1], a[0]], 0.0) for a, b in itertools.pairwise(path)) for path in paths
            ],
            "clearance": [
                -min((math.dist(a, b) for a in path for b in blocked), default=math.hypot(*grid.shape)) for path in paths
            ],
        }
        coding = CellSequence(grid, start, goal, max_cells=int((~grid.occupied).sum()))
        for names in KINDS:
            rows = np.round(np.column_stack([measures[name] for name in names]), 9)
            expected = non_dominated(tuple(row) for row in rows.tolist())
            found = exact_front(GridPathProblem(grid, start, goal, coding, [own.get(name, name) for name in names]))
            same = found.F.shape == expected.shape and np.allclose(found.F, expected, rtol=1e-9, atol=1e-8)
            if not same:
                print(f"grid {number}, {', '.join(names)}: {found.F.tolist()}, expected {expected.tolist()}")
            wrong, n_fronts, n_points = wrong + (not same), n_fronts + 1, n_points + len(expected)
    seconds = time.process_time() - begin
    print(f"{n_grids} small grids: {n_fronts - wrong} of {n_fronts} fronts as enumerated, {n_points} points, {seconds:.0f} s")
    return wrong


def few_free(rng):
    """Return a random query across a grid of at most 14 free cells, with some obstacle."""
    while True:
        occupied = rng.random(rng.integers(3, 6, 2)) < rng.uniform(0.05, 0.5)
        query = query_on(OccupancyGrid(occupied, **RULES[int(rng.integers(len(RULES)))]), rng, apart=0.6)
        if query is not None and occupied.sum() > 0 and (~occupied).sum() <= 14:
            return query


# -- a large map ----------------------------------------------------------------------------------------------------------


def large(file: Path, n_queries: int, seed: int) -> int:
    rng, wrong = np.random.default_rng(seed), 0
    free = cells_of(file)
    edges = edges_of(free)
    cells = np.argwhere(free)
    distance = np.zeros(free.shape)
    # Beyond the edge there are no obstacles.
    distance[free] = KDTree(np.argwhere(~free)).query(cells)[0]
    grid = load_map(file)
    # Whole numbers, so that labels of equal costs meet: swamp among hills.
    swamp = np.rint(1 + 8 * (gaussian_filter(rng.random(free.shape), 6) > 0.5))
    hills = np.rint(400 * gaussian_filter(rng.random(free.shape), 10))
    _, regions = csgraph.connected_components(edges[0], directed=True, connection="strong")
    largest = np.flatnonzero((regions == np.bincount(regions[np.flatnonzero(free)]).argmax()) & free.ravel())

    def length_and_climb(a, b, step):
        return step, max(hills.flat[b] - hills.flat[a], 0.0)

    def ground_and_climb(a, b, step):
        return step * (swamp.flat[a] + swamp.flat[b]) / 2, max(hills.flat[b] - hills.flat[a], 0.0)

    for number in range(n_queries):
        start, goal = rng.choice(largest, 2, replace=False).tolist()
        ends = [(one % free.shape[1], one // free.shape[1]) for one in (start, goal)]
        for what, objectives, search in (
            ("length, clearance", ["length", "clearance"], partial(by_thresholds, edges[0], distance.ravel())),
            ("length, climb", ["length", Climb(hills)], partial(by_labels, edges[1], cost=length_and_climb)),
            ("ground, climb", [GroundCost(swamp), Climb(hills)], partial(by_labels, edges[1], cost=ground_and_climb)),
        ):
            problem = GridPathProblem(grid, ends[0], ends[1], "cells", objectives)
            begin = time.process_time()
            found = exact_front(problem)
            middle = time.process_time()
            expected = search(start, goal)
            end = time.process_time()
            same = found.complete and found.F.shape == expected.shape and np.allclose(found.F, expected, rtol=1e-9, atol=1e-7)
            wrong += not same
            print(
                f"{file.stem}, query {number}, {what}: {len(found.F)} points, {'as' if same else 'NOT AS'} expected "
                f"({len(expected)}); {middle - begin:.2f} s, the other search {end - middle:.1f} s",
                flush=True,
            )
    return wrong


def cells_of(file: Path) -> np.ndarray:
    """Return which cells are free, row 0 at the bottom."""
    _, _, rows = file.read_text().partition("\nmap\n")
    return np.array([[letter in ".GS" for letter in row] for row in rows.split()])[::-1]


def edges_of(free: np.ndarray) -> tuple[sparse.csr_array, list[list[tuple[int, float]]]]:
    """Return the lengths of the steps that cut no corner as a matrix, and as a list for each cell."""
    height, width = free.shape
    lists: list[list[tuple[int, float]]] = [[] for _ in range(free.size)]
    for y, x in np.argwhere(free).tolist():
        for dx, dy in STEPS:
            if not (0 <= x + dx < width and 0 <= y + dy < height):
                continue
            if free[y + dy, x + dx] and free[y, x + dx] and free[y + dy, x]:
                lists[y * width + x].append(((y + dy) * width + x + dx, math.hypot(dx, dy)))
    head = [b for ends in lists for b, _ in ends]
    tail = np.repeat(np.arange(free.size), [len(ends) for ends in lists])
    lengths = [step for ends in lists for _, step in ends]
    return sparse.csr_array((lengths, (tail, head)), shape=(free.size, free.size)), lists


def by_thresholds(edges: sparse.csr_array, distance: np.ndarray, start: int, goal: int) -> np.ndarray:
    """Return the front of length against least clearance: a search among the cells of at least each distance."""
    whole, rows = edges.tocoo(), []
    for least in np.unique(distance[distance <= min(distance[start], distance[goal])]):
        keep = (distance[whole.row] >= least) & (distance[whole.col] >= least)
        graph = sparse.csr_array((whole.data[keep], (whole.row[keep], whole.col[keep])), shape=whole.shape)
        length = csgraph.dijkstra(graph, indices=start)[goal]
        if np.isfinite(length):
            rows.append((round(float(length), 9), -float(least)))
    return non_dominated(rows)


def by_labels(edges, start: int, goal: int, cost) -> np.ndarray:
    """Return the front of two costs of steps by a label search without bounds or any other help."""
    heap: list[tuple[float, float, int]] = [(0.0, 0.0, start)]
    least, rows = np.full(len(edges), np.inf), []
    while heap:
        first, second, cell = heapq.heappop(heap)
        if second >= least[cell] - 1e-9 or second >= least[goal] - 1e-9:
            continue
        least[cell] = second
        if cell == goal:
            rows.append((round(first, 9), second))
            continue
        for other, step in edges[cell]:
            a, b = cost(cell, other, step)
            # Sums of the same lengths in another order are the same.
            if second + b < least[other] - 1e-9:
                heapq.heappush(heap, (round(first + a, 9), second + b, other))
    return non_dominated(rows)


if __name__ == "__main__":
    sys.exit(main())
