"""How often the variable-length genetic algorithm finds a shortest path, repaired and by the rules as they are printed.

    python benchmarks/variable_length.py [--seeds 1000] [--printed-seeds 20] [--jobs 2]

Thirty seeded instances of 10 x 10 cells, ten of each density of obstacles: the first leads from corner to corner, the others
join random cells at least six apart; every second one forbids to cut corners. A run has 50 members and up to 50 generations and
counts if its best string is a legal path as short as the shortest by Dijkstra's method. "At least" is the lower bound of the
Wilson interval of 95 %; "at first" the share of runs whose first population holds a shortest path, before any selection; "last
generation" the latest in which one was found.
"""

from __future__ import annotations

import argparse
import itertools
import math
import os
import warnings
from concurrent.futures import ProcessPoolExecutor
from typing import Any, NamedTuple

import numpy as np
from pymoo.core.termination import Termination
from pymoo.optimize import minimize

from pymoo_gridpath import OccupancyGrid
from pymoo_gridpath.algorithms import PRINTED_RULES, variable_length_ga

DENSITIES = (0.0, 0.1, 0.2)
EACH = 10
SIZE, APART, GENERATIONS = 10, 6, 50
ROUNDING = 1e-9


class Run(NamedTuple):
    """What one run found."""

    found: bool
    at_first: bool
    generation: int
    legal: float
    distinct: int


class Shortest(Termination):
    """End a run once its best string is a shortest path, if told to, or after so many generations."""

    def __init__(self, shortest: float, stops: bool):
        super().__init__()
        self.shortest, self.stops = shortest, stops
        self.found, self.at_first, self.distinct = False, False, 0

    def _update(self, algorithm: Any) -> float:
        paths = algorithm.problem.decode(algorithm.opt.get("X"))
        self.found = bool(((paths.interfering_cells == 0) & (paths.length <= self.shortest + ROUNDING)).any())
        if algorithm.n_gen == 1:
            self.at_first, self.distinct = self.found, len(np.unique(algorithm.pop.get("X"), axis=0))
        return 1.0 if self.found and self.stops else algorithm.n_gen / GENERATIONS


def instance(density: float, number: int) -> tuple[OccupancyGrid, tuple[int, int], tuple[int, int]]:
    """Return a grid and a query that has a path."""
    rng = np.random.default_rng([SIZE, round(100 * density), number])
    while True:
        occupied = rng.random((SIZE, SIZE)) < density
        ends = rng.integers(0, SIZE, (2, 2)) if number else np.array([[0, 0], [SIZE - 1, SIZE - 1]])
        (x, y), (gx, gy) = ends.tolist()
        occupied[[y, gy], [x, gx]] = False
        grid = OccupancyGrid(occupied, corner_cutting=number % 2 == 0)
        if np.abs(ends[0] - ends[1]).max() >= APART and grid.regions[y, x] == grid.regions[gy, gx]:
            return grid, (x, y), (gx, gy)


def run(density: float, number: int, seed: int, printed: tuple[str, ...]) -> Run:
    """Search an instance once."""
    grid, start, goal = instance(density, number)
    # A string may be the shortest path for a while where another one is printed as shorter.
    termination = Shortest(grid.shortest_length(start, goal), stops="distances" not in printed)
    setup = variable_length_ga(grid, start, goal, printed=printed, termination=termination)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = minimize(*setup, seed=seed)
    ended: Any = result.algorithm.termination
    pop: Any = result.pop
    legal = np.mean(np.asarray(pop.get("interfering_cells")) == 0)
    return Run(ended.found, ended.at_first, result.algorithm.n_gen - 1, float(legal), ended.distinct)


def runs_of(job: tuple[float, int, int, tuple[str, ...]]) -> list[Run]:
    """Search an instance with so many seeds."""
    density, number, n_seeds, printed = job
    return [run(density, number, seed, printed) for seed in range(1, n_seeds + 1)]


def wilson(found: int, n: int, z: float = 1.959964) -> float:
    """Return the lower bound of Wilson's interval of a share."""
    share = found / n
    middle, half = share + z**2 / (2 * n), z * math.sqrt(share * (1 - share) / n + z**2 / (4 * n**2))
    return (middle - half) / (1 + z**2 / n)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=1000, help="of each instance, with the repaired rules (default: 1,000)")
    parser.add_argument("--printed-seeds", type=int, default=20, help="the same with printed rules (default: 20)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes")
    arguments = parser.parse_args()
    rules = [(), *((rule,) for rule in PRINTED_RULES), PRINTED_RULES]
    heads = (
        "printed rules",
        "density",
        "found",
        "at least",
        "at first",
        "last generation",
        "legal at the end",
        "distinct at first",
    )
    print(f"| {' | '.join(heads)} |\n|{' --- |' * len(heads)}")
    with ProcessPoolExecutor(arguments.jobs) as pool:
        for printed in rules:
            n_seeds = arguments.printed_seeds if printed else arguments.seeds
            if not n_seeds:
                continue
            jobs = [(density, number, n_seeds, printed) for density, number in itertools.product(DENSITIES, range(EACH))]
            results = list(pool.map(runs_of, jobs))
            for density in (*DENSITIES, None):
                runs = [one for job, some in zip(jobs, results, strict=True) if density in (job[0], None) for one in some]
                found = sum(one.found for one in runs)
                at_first = sum(one.at_first for one in runs) / len(runs)
                last = max([one.generation for one in runs if one.found], default=0)
                print(
                    f"| {', '.join(printed) or 'none'} | {'all' if density is None else density} | {found} of {len(runs)} "
                    f"| {wilson(found, len(runs)):.4f} | {at_first:.3f} | {last} "
                    f"| {np.mean([one.legal for one in runs]):.2f} | {np.mean([one.distinct for one in runs]):.1f} |",
                    flush=True,
                )


if __name__ == "__main__":
    main()
