"""How well searches keep up with obstacles that move: the mean hypervolume ratio at the end of each epoch.

    python benchmarks/moving.py [--seeds 11] [--members 100]

Seeded maps of 20 x 20 cells, one empty and one with a tenth of the cells occupied; three seeded movers, a move every five
generations, ten epochs. The ratio is that of the legal members at the end of an epoch, as the algorithm has them, to the exact
front of its map. "Missed" counts members that an algorithm had kept with values of an earlier map, "stale" those in Results.
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np
from pymoo.optimize import minimize

from pymoo_gridpath import OccupancyGrid
from pymoo_gridpath.algorithms import make_algorithm
from pymoo_gridpath.problems import MovingObstaclesProblem, ObstacleClock, random_movers
from pymoo_gridpath.problems.members import Members
from pymoo_gridpath.quality import hypervolume_ratio

SIZE, TAUT, N_EPOCHS, N_MOVERS, SEED = 20, 5, 10, 3, 1
ENDS = (0, 0), (SIZE - 1, SIZE - 1)
MAX_SECONDS = 60


class Epochs(ObstacleClock):
    """The clock, which keeps the ratio of each epoch."""

    def __init__(self):
        super().__init__()
        self.ratios: list[float] = []

    def update(self, algorithm: Any) -> None:
        problem = algorithm.problem
        if problem.tau % TAUT == TAUT - 1:
            self.ratios.append(hypervolume_ratio(Members(algorithm).F, problem.pareto_front(max_seconds=MAX_SECONDS)))
        super().update(algorithm)


def problem_of(density: float) -> MovingObstaclesProblem:
    """Return the problem of a map of a density."""
    occupied = np.random.default_rng([SIZE, round(100 * density)]).random((SIZE, SIZE)) < density
    occupied[[0, -1], [0, -1]] = False
    base = OccupancyGrid(occupied, corner_cutting=True)
    movers, _ = random_movers(base, *ENDS, N_MOVERS, N_EPOCHS, SEED)
    return MovingObstaclesProblem(base, movers, *ENDS, TAUT)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=11, help="runs of each algorithm (default: 11)")
    parser.add_argument("--members", type=int, default=100, help="of a population (default: 100)")
    arguments = parser.parse_args()
    print("| density | algorithm | ratio, mean | least of a run | missed | stale |\n| --- | --- | --- | --- | --- | --- |")
    for density in (0.0, 0.1):
        problem = problem_of(density)
        for name in ("DNSGA2", "NSGA2"):
            means, missed, stale = [], 0, 0
            for seed in range(1, arguments.seeds + 1):
                problem.tau = 0
                algorithm = make_algorithm(name, problem, arguments.members)
                result: Any = minimize(problem, algorithm, ("n_gen", TAUT * N_EPOCHS), seed=seed, callback=Epochs())
                clock = result.algorithm.callback
                means.append(np.mean(clock.ratios))
                missed, stale = missed + clock.n_missed, stale + int(problem.is_stale(result.pop).sum())
            print(f"| {density} | {name} | {np.mean(means):.4f} | {min(means):.4f} | {missed} | {stale} |", flush=True)


if __name__ == "__main__":
    main()
