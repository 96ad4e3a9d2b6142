"""How well searches keep up with obstacles that move: mean hypervolume ratio and mean IGD+ over epochs, and what is stale.

    python benchmarks/moving.py [--seeds 11] [--members 100]

Seeded maps of 20 x 20 cells, one empty and one with a tenth of the cells occupied; three seeded movers, a move every five
generations, ten epochs. What had been found at the end of each epoch is measured, as it is on the map of that epoch, against
the exact front of that map. "Untold" is NSGA-II whose clock lets time pass only. "Missed" counts members that an algorithm had
kept with values of an earlier map over a generation and the clock renewed; of the members at the end of all epochs, "stale"
counts those with values of an earlier map, "wrong" those whose values are others now, and "illegal" those that pass for legal
paths and are none.
"""

from __future__ import annotations

import argparse
import sys
import warnings
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from pymoo.optimize import minimize

from pymoo_gridpath import OccupancyGrid
from pymoo_gridpath.algorithms import make_algorithm
from pymoo_gridpath.problems import MovingObstaclesProblem, ObstacleClock, random_movers
from pymoo_gridpath.quality import mean_hypervolume_ratio, mean_igd_plus

SIZE, TAUT, N_EPOCHS, N_MOVERS, SEED = 20, 5, 10, 3, 1
ENDS = (0, 0), (SIZE - 1, SIZE - 1)
MAX_SECONDS = 60

# Runs of KGB take as long as twenty of the others.
FEW = 3


class Search(NamedTuple):
    """An algorithm, its clock, and how many runs there are at most."""

    name: str
    clock: Callable[[], ObstacleClock] = ObstacleClock
    most: int = sys.maxsize


SEARCHES = {
    "DNSGA2": Search("DNSGA2"),
    "KGB": Search("KGB", most=FEW),
    "NSGA2, told": Search("NSGA2"),
    "NSGA2, untold": Search("NSGA2", lambda: ObstacleClock(renew=False)),
}
HEADER = "| density | algorithm | runs | ratio, mean | least of a run | IGD+, mean | most of a run "
HEADER += "| missed | stale | wrong | illegal |"


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
    # KGB makes members between others.
    warnings.filterwarnings("ignore", "genes that are no whole numbers")
    print(HEADER + "\n|" + " --- |" * HEADER.count(" | ") + " --- |")
    for density in (0.0, 0.1):
        problem = problem_of(density)
        fronts = [still.pareto_front(max_seconds=MAX_SECONDS) for still in problem.stills]
        for label, search in SEARCHES.items():
            ratios, distances, missed, found = [], [], 0, np.zeros(3, dtype=int)
            for seed in range(1, min(arguments.seeds, search.most) + 1):
                problem.restart()
                algorithm, clock = make_algorithm(search.name, problem, arguments.members), search.clock()
                minimize(problem, algorithm, ("n_gen", TAUT * N_EPOCHS), seed=seed, callback=clock)
                ratios.append(mean_hypervolume_ratio(clock.F, fronts))
                distances.append(mean_igd_plus(clock.F, fronts))
                missed, found = missed + clock.n_missed, found + np.sum(clock.faults, axis=0)
            quality = [np.mean(ratios), min(ratios), np.mean(distances), max(distances)]
            cells = [density, label, len(ratios), *(f"{value:.4f}" for value in quality), missed, *found]
            print(f"| {' | '.join(map(str, cells))} |", flush=True)


if __name__ == "__main__":
    main()
