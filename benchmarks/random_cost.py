"""Measure exact fronts of grids with random costs of directed edges, beside those of undirected ones by an earlier version.

    python benchmarks/random_cost.py ../before --size 600 --rounds 2

``../before`` holds another version of the package, such as a git worktree of 4c4c0c3. It knows costs of cells alone, so that it
plans on the undirected form: a grid of twice the size, with a cell for each edge. In each round either version has a process of
its own, one after the other. Times are those of the processor, of `exact_front` alone; kernels have been compiled before. Last
comes the front by a label search of this script, which shares no code with the package and knows the grid as a list of edges;
the directed front has to be the same.

Of 600 x 600 cells a round takes a minute and the label search another.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numba
import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

MOST_COST = 10


# -- the package ----------------------------------------------------------------------------------------------------------


def directed(size: int, seed: int):
    """Return the problem of a suite."""
    from pymoo_gridpath.problems import make_suite

    return make_suite("random-cost", width=size, height=size, seed=seed).problem()


def undirected(size: int, seed: int):
    """Return the problem with one cost for both directions of an edge, each edge a cell between two others."""
    from pymoo_gridpath import GridPathProblem, OccupancyGrid
    from pymoo_gridpath.objectives import Objective

    shape = 2 * size - 1, 2 * size + 3
    y, x = np.indices(shape)
    ends = (x == 0) | (x == shape[1] - 1)
    # Cells of the grid are at even places; between four of them nobody passes.
    wall = (x % 2 == 1) & (y % 2 == 1)
    edge = ((x + y) % 2 == 1) & ~ends

    class Cost(Objective):
        def __init__(self, number: int):
            self.name = self.label = f"cost {number}"
            self.number = number

        def field(self, grid):
            drawn = np.random.default_rng([seed, self.number]).integers(1, MOST_COST + 1, shape)
            return np.where(edge, drawn, 0).astype(float)

        def __call__(self, paths, sums):
            return paths.total(sums)

    grid = OccupancyGrid(wall)
    return GridPathProblem(grid, (0, 0), (shape[1] - 1, shape[0] - 1), "cells", objectives=[Cost(1), Cost(2)])


def measure(form: str, size: int, seed: int) -> None:
    """Print, as JSON, how many seconds of the processor the front takes, and the front."""
    make = {"directed": directed, "undirected": undirected}[form]
    from pymoo_gridpath.exact import exact_front

    # Large enough for every kernel to be compiled.
    exact_front(make(40, seed))
    begin = time.process_time()
    problem = make(size, seed)
    made = time.process_time()
    found = exact_front(problem)
    ended = time.process_time()
    print(json.dumps({"made": made - begin, "seconds": ended - made, "complete": found.complete, "front": found.F.tolist()}))


def in_process(tree: Path, form: str, size: int, seed: int) -> dict:
    """Return what `measure` prints in a process that takes the package from a folder."""
    environment = {**os.environ, "PYTHONPATH": str(tree)}
    command = [sys.executable, __file__, str(tree), "--form", form, "--size", str(size), "--seed", str(seed)]
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, check=True, text=True)
    return json.loads(done.stdout.splitlines()[-1])


# -- the label search -----------------------------------------------------------------------------------------------------


def edges_of(size: int, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return where the edges lead from and to, and their two costs, shape (2, n); the last two nodes are source and target."""
    cell = np.arange(size * size).reshape(size, size)
    source, target = size * size, size * size + 1
    begins, ends, costs = [], [], []
    drawn = np.stack([np.random.default_rng([seed, k]).integers(1, MOST_COST + 1, (4, size, size + 2)) for k in (1, 2)])

    def add(begin, end, cost):
        begins.append(np.broadcast_to(begin, end.shape).ravel())
        ends.append(end.ravel())
        costs.append(cost.reshape(2, -1))

    # Column 0 of what was drawn is the source, the last one the target: right, up, left, down.
    add(cell[:, :-1], cell[:, 1:], drawn[:, 0, :, 2:-1])
    add(cell[:-1], cell[1:], drawn[:, 1, 1:, 1:-1])
    add(cell[:, 1:], cell[:, :-1], drawn[:, 2, :, 1:-2])
    add(cell[1:], cell[:-1], drawn[:, 3, :-1, 1:-1])
    add(source, cell[:, 0], drawn[:, 0, :, 1])
    add(cell[:, -1], np.full(size, target), drawn[:, 0, :, -1])
    return np.concatenate(begins), np.concatenate(ends), np.concatenate(costs, axis=1)


def front_by_labels(size: int, seed: int) -> np.ndarray:
    """Return the front by a search with labels in lexicographic order and bounds from two shortest-path searches."""
    begins, ends, costs = edges_of(size, seed)
    n = size * size + 2
    left = [dijkstra(csr_array((cost, (ends, begins)), shape=(n, n)), indices=n - 1) for cost in costs]
    order = np.argsort(begins, kind="stable")
    first = np.searchsorted(begins[order], np.arange(n + 1))
    # Costs that are lost on the way to the target do not matter: from each node there is a way.
    bounds = np.stack(left).astype(np.int64)
    return labels(first, ends[order], costs[:, order].astype(np.int64), bounds, n - 2, n - 1)


@numba.njit(cache=True)
def labels(first, ends, costs, bounds, source, target):
    n_nodes = len(first) - 1
    least = np.full(n_nodes, 2**60)
    keys, nodes = np.empty(2**20, dtype=np.int64), np.empty(2**20, dtype=np.int64)
    keys[0], nodes[0], n = (bounds[0, source] << 30) + bounds[1, source], source, 1
    points = [(0, 0)]
    points.clear()
    while n > 0:
        key, node = keys[0], nodes[0]
        n -= 1
        last_key, last_node, at = keys[n], nodes[n], 0
        while 2 * at + 1 < n:
            child = 2 * at + 1
            if child + 1 < n and keys[child + 1] < keys[child]:
                child += 1
            if keys[child] >= last_key:
                break
            keys[at], nodes[at] = keys[child], nodes[child]
            at = child
        keys[at], nodes[at] = last_key, last_node
        f1, f2 = key >> 30, key & (2**30 - 1)
        g2 = f2 - bounds[1, node]
        if g2 >= least[node] or f2 >= least[target]:
            continue
        least[node] = g2
        if node == target:
            points.append((f1, f2))
            continue
        g1 = f1 - bounds[0, node]
        for k in range(first[node], first[node + 1]):
            end = ends[k]
            next2 = g2 + costs[1, k]
            if next2 >= least[end] or next2 + bounds[1, end] >= least[target]:
                continue
            if n == len(keys):
                keys = np.concatenate((keys, np.empty_like(keys)))
                nodes = np.concatenate((nodes, np.empty_like(nodes)))
            new = ((g1 + costs[0, k] + bounds[0, end]) << 30) + next2 + bounds[1, end]
            at = n
            n += 1
            while at > 0 and keys[(at - 1) // 2] > new:
                keys[at], nodes[at] = keys[(at - 1) // 2], nodes[(at - 1) // 2]
                at = (at - 1) // 2
            keys[at], nodes[at] = new, end
    return np.array(points)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", type=Path, help="a folder with another version of the package")
    parser.add_argument("--size", type=int, default=600, help="cells a side")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--form", choices=("directed", "undirected"), help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.form:
        measure(arguments.form, arguments.size, arguments.seed)
        return
    here = Path(__file__).resolve().parents[1]
    sides = {"undirected": arguments.before.resolve(), "directed": here}
    seconds: dict[str, list[float]] = {form: [] for form in sides}
    found: dict = {}
    for k in range(arguments.rounds):
        for form in list(sides)[:: 1 if k % 2 == 0 else -1]:
            found = in_process(sides[form], form, arguments.size, arguments.seed)
            assert found["complete"]
            seconds[form].append(found["seconds"])
            print(
                f"{form}: {len(found['front'])} points, {found['seconds']:.1f} s, and {found['made']:.1f} s to make the problem"
            )
            if form == "directed":
                directed_front = np.array(found["front"])
    ratio = np.median(seconds["directed"]) / np.median(seconds["undirected"])
    print(f"directed by undirected: {ratio:.2f} of the processor time")
    begin = time.process_time()
    expected = front_by_labels(arguments.size, arguments.seed)
    equal = np.array_equal(directed_front, expected)
    print(f"label search: {len(expected)} points, {time.process_time() - begin:.1f} s")
    print("the fronts are equal" if equal else "the fronts differ")
    sys.exit(not equal)


if __name__ == "__main__":
    main()
