"""Run Table 1 of Ahmed and Deb (2013) and print its columns beside the paper's.

Every run has a random scenario of section 6 of its own (a path kept free, the rest occupied with probability p0), so
that a row tells of its size and p0 and not of one lucky or unlucky draw. The paper seems to have had one scenario a
row, to judge by its whole numbers of obstacles; ``--scenarios 1`` does the same. Runs search by the paper's modified
NSGA-II with 200 individuals until the first legal path, or for 500 generations. The paper's lengths look like those of
runs that went on to the last generation, though it says that they ended with the first legal path: ``--full`` goes on.

Run with ``python benchmarks/table1.py``; ``--help`` lists the options. ``python benchmarks/paper.py --section 6`` has it, too.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Collection
from concurrent.futures import Executor, ProcessPoolExecutor
from functools import partial
from typing import Any, NamedTuple

# One thread for each process: the arrays are small, and threads of the linear algebra would only get in each other's way.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from pymoo.core.callback import Callback
from pymoo.optimize import minimize
from pymoo.termination.max_gen import MaximumGenerationTermination
from scipy import stats

from pymoo_gridpath.algorithms import FirstLegalPath, ahmed_deb_2013
from pymoo_gridpath.problems import random_dense_grid

SIZES = (8, 16, 32)

# Grid size, p0, obstacles, success in percent, median generations, mean length: the paper's Table 1.
PAPER = [
    (8, 0.1, 4, 100, 2, 9.90),
    (8, 0.2, 10, 100, 2, 10.49),
    (8, 0.3, 15, 100, 2, 10.49),
    (8, 0.4, 20, 100, 2, 10.49),
    (8, 0.5, 26, 100, 5, 11.07),
    (8, 0.6, 31, 100, 4, 11.07),
    (8, 0.7, 40, 100, 5, 11.07),
    (8, 0.8, 43, 100, 6, 11.07),
    (8, 0.9, 50, 100, 7, 11.07),
    (8, 1.0, 54, 100, 7, 11.07),
    (16, 0.1, 24, 100, 2, 21.21),
    (16, 0.2, 47, 100, 5, 22.14),
    (16, 0.3, 65, 100, 9, 23.30),
    (16, 0.4, 80, 100, 18, 22.34),
    (16, 0.5, 115, 100, 28, 22.37),
    (16, 0.6, 150, 100, 22, 22.57),
    (16, 0.7, 164, 100, 25, 22.30),
    (16, 0.8, 286, 100, 40, 22.13),  # more than the grid holds: a misprint of the paper, probably 186
    (16, 0.9, 214, 100, 41, 22.48),
    (16, 1.0, 233, 100, 46, 22.40),
    (32, 0.1, 81, 100, 6, 47.08),
    (32, 0.2, 173, 100, 16, 53.40),
    (32, 0.3, 253, 97, 38, 53.72),
    (32, 0.4, 386, 85, 73, 53.61),
    (32, 0.5, 470, 36, 230, 54.38),
    (32, 0.6, 556, 74, 144, 53.64),
    (32, 0.7, 666, 41, 295, 53.90),
    (32, 0.8, 767, 52, 298, 54.31),
    (32, 0.9, 870, 39, 378, 54.13),
    (32, 1.0, 967, 30, 339, 54.19),
]


class Run(NamedTuple):
    """What one run found."""

    found: bool
    generations: int
    length: float
    obstacles: int


class FirstLegalGeneration(Callback):
    """Remember the first generation with a legal path."""

    generation: int | None = None

    def _update(self, algorithm: Any) -> None:
        if self.generation is None and (algorithm.pop.get("interfering_cells") == 0).any():
            self.generation = algorithm.n_gen


def run(number: int, size: int, p0: float, n_scenarios: int, n_gen: int, full: bool, pop_size: int) -> Run:
    """Search one of the row's scenarios for a legal path."""
    scenario = 1 + (number - 1) % n_scenarios
    grid = random_dense_grid(size, p0, np.random.default_rng([size, round(100 * p0), scenario]))
    termination = MaximumGenerationTermination(n_gen) if full else FirstLegalPath(n_gen)
    setup = ahmed_deb_2013(grid, (0, 0), (size - 1, size - 1), pop_size=pop_size, termination=termination)
    callback = FirstLegalGeneration()
    pop = minimize(*setup, seed=number, callback=callback).pop
    assert pop is not None
    legal = np.asarray(pop.get("interfering_cells")) == 0
    length = setup.problem.decode(pop.get("X")[legal]).length.min() if legal.any() else np.nan
    found = callback.generation is not None
    return Run(found, callback.generation or n_gen, float(length), grid.n_occupied)


def table(
    pool: Executor,
    sizes: Collection[int] = SIZES,
    p0s: Collection[float] = (),
    n_runs: int = 100,
    n_scenarios: int | None = None,
    n_gen: int = 500,
    full: bool = False,
    pop_size: int = 200,
) -> None:
    """Run the rows of some sizes and probabilities, all by default, and print them beside the paper's.

    Parameters
    ----------
    n_scenarios : int, optional
        Scenarios shared out among a row's runs; by default one for each.
    full : bool
        Whether runs go on to the last generation after their first legal path.
    """
    when = "at the last generation" if full else "at the first legal path"
    n_scenarios = n_scenarios or n_runs
    print(f"{n_runs} runs a row on {n_scenarios} scenario(s), lengths {when}; ours beside the paper's, intervals of 95 %")
    print("grid     p0 |      obstacles |          success % | median generations |     mean length |  seconds a run")
    start = time.perf_counter()
    n_all, outside = 0, []
    for size, p0, obstacles, success, generations, length in PAPER:
        if size not in sizes or (p0s and p0 not in p0s):
            continue
        row_start = time.perf_counter()
        job = partial(run, size=size, p0=p0, n_scenarios=n_scenarios, n_gen=n_gen, full=full, pop_size=pop_size)
        runs = list(pool.map(job, range(1, n_runs + 1)))
        n_all += n_runs
        found = [r for r in runs if r.found]
        percent = 100.0 * len(found) / n_runs
        low, high = stats.binomtest(len(found), n_runs).proportion_ci(method="wilson")
        if not 100 * low <= success <= 100 * high:
            outside.append(f"{size} x {size} at p0 = {p0:g}")
        median = np.median([r.generations for r in found]) if found else np.nan
        mean = np.nanmean([r.length for r in found]) if found else np.nan
        cost = (time.perf_counter() - row_start) / n_runs
        print(
            f"{size:>2} x {size:<2} {p0:>4.1f} | {np.mean([r.obstacles for r in runs]):>7.1f} {obstacles:>6} | "
            f"{percent:>4.0f} [{100 * low:>3.0f}, {100 * high:>3.0f}] {success:>4} | {median:>9.1f} {generations:>8} | "
            f"{mean:>8.2f} {length:>6.2f} | {cost:>10.2f}",
            flush=True,
        )
    print(f"{n_all} runs in {time.perf_counter() - start:.0f} s")
    print("rows whose interval leaves out the paper's success: " + (", ".join(outside) or "none"))


def main() -> None:
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    parser.add_argument("--sizes", type=int, nargs="+", choices=SIZES, default=SIZES, help="grid sizes")
    parser.add_argument("--p0", type=float, nargs="+", default=(), help="obstacle probabilities (default: all)")
    parser.add_argument("--runs", type=int, default=100, help="runs of each row")
    parser.add_argument("--scenarios", type=int, help="random scenarios shared out among a row's runs (default: one for each)")
    parser.add_argument("--generations", type=int, default=500)
    parser.add_argument("--full", action="store_true", help="go on to the last generation after the first legal path")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes")
    given = parser.parse_args()
    with ProcessPoolExecutor(given.jobs) as pool:
        table(pool, given.sizes, given.p0, given.runs, given.scenarios, given.generations, given.full)


if __name__ == "__main__":
    main()
