"""Measure evaluations per second, and a generation of this package's set-up beside pymoo's own NSGA-II.

Run with ``python benchmarks/throughput.py``; ``--help`` lists the options. Evaluations are the best of several repetitions.
Generations of this package, with and without its tie-break by smoothness, are timed beside those of pymoo's NSGA-II, once as
its documentation sets it up and once with this package's operators, so that all else is compared. The set-ups take turns in one
process: a noisy machine distorts their ratios little.
"""

from __future__ import annotations

import argparse
import platform
import time
from typing import Any

import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM
from pymoo.operators.repair.rounding import RoundingRepair
from pymoo.operators.sampling.rnd import IntegerRandomSampling
from pymoo.optimize import minimize

from pymoo_gridpath.algorithms import ahmed_deb_2013, make_algorithm
from pymoo_gridpath.objectives import Vulnerability
from pymoo_gridpath.operators import RandomSampling, default_operators
from pymoo_gridpath.problems import GridPathProblem, random_dense_grid


def evaluations_per_second(size: int, pop_size: int, representation: str, seconds: float) -> float:
    """Return how many paths of one population are evaluated in a second (objectives, turn and interfering cells)."""
    grid, objectives = random_dense_grid(size, 0.2, 1), ("length", Vulnerability(variance=0.5))
    problem = GridPathProblem(grid, (0, 0), (size - 1, size - 1), representation, objectives)
    rng = np.random.default_rng(0)
    X = problem.representation.repair(RandomSampling().do(problem, pop_size, random_state=rng).get("X"), rng)
    best, end = np.inf, time.perf_counter() + seconds
    while time.perf_counter() < end:
        start = time.perf_counter()
        for _ in range(10):
            problem.evaluate(X, return_as_dictionary=True)
        best = min(best, (time.perf_counter() - start) / 10)
    return pop_size / best


def stock_nsga2(pop_size: int) -> NSGA2:
    """Return pymoo's NSGA-II as its documentation sets it up for whole numbers: SBX and PM with rounding, all else its own."""
    return NSGA2(
        pop_size=pop_size,
        sampling=IntegerRandomSampling(),
        crossover=SBX(prob=0.9, eta=10, vtype=float, repair=RoundingRepair()),
        mutation=PM(eta=20, vtype=float, repair=RoundingRepair()),
        eliminate_duplicates=True,
    )


def seconds_per_generation(size: int, pop_size: int, n_gen: int, repeats: int) -> np.ndarray:
    """Return processor seconds per generation, a row per repetition.

    The columns are ours, ours without the tie-break, stock, and stock with our operators.
    """
    grid = random_dense_grid(size, 0.2, 1)
    problem, ours, termination = ahmed_deb_2013(grid, (0, 0), (size - 1, size - 1), pop_size=pop_size, n_gen=n_gen)
    plain = make_algorithm("NSGA2", problem, pop_size, smoothness=False)
    our_operators: dict[str, Any] = default_operators(problem) | {"eliminate_duplicates": True}
    sides = ours, plain, stock_nsga2(pop_size), NSGA2(pop_size, **our_operators)
    seconds = np.empty((repeats, len(sides)))
    for repeat in range(repeats):
        for k, algorithm in enumerate(sides):
            start = time.process_time()
            minimize(problem, algorithm, termination, seed=repeat + 1)
            seconds[repeat, k] = (time.process_time() - start) / n_gen
    return seconds


def main() -> None:
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    parser.add_argument("--sizes", type=int, nargs="+", default=[16, 32, 64, 128, 256], help="cells a side")
    parser.add_argument("--representations", nargs="+", default=["integer"], help="representations to evaluate")
    parser.add_argument("--pop-size", type=int, default=500)
    parser.add_argument("--seconds", type=float, default=2.0, help="time spent on each evaluation figure")
    parser.add_argument("--generation-sizes", type=int, nargs="+", default=[32, 128], help="cells a side of the timed runs")
    parser.add_argument("--n-gen", type=int, default=100, help="generations of each timed run")
    parser.add_argument("--repeats", type=int, default=5, help="how often the timed runs take turns")
    arguments = parser.parse_args()

    print(f"{platform.machine()}, Python {platform.python_version()}, NumPy {np.__version__}")
    print(f"\nevaluations per second, population {arguments.pop_size}, p0 = 0.2")
    print(f"{'cells a side':>12}  " + "  ".join(f"{name:>10}" for name in arguments.representations))
    for size in arguments.sizes:
        rates = [
            evaluations_per_second(size, arguments.pop_size, name, arguments.seconds) for name in arguments.representations
        ]
        print(f"{size:>12}  " + "  ".join(f"{rate:>10,.0f}" for rate in rates), flush=True)

    for size in arguments.generation_sizes:
        print(f"\nprocessor seconds per generation, NSGA-II, {size} x {size}, {size - 1} genes,")
        print(f"population {arguments.pop_size}, {arguments.n_gen} generations")
        seconds = seconds_per_generation(size, arguments.pop_size, arguments.n_gen, arguments.repeats)
        for ours, plain, stock, same in seconds:
            print(f"ours {ours:.4f}  without tie-break {plain:.4f}  stock {stock:.4f}  stock with our operators {same:.4f}")
        for side, name in ((2, "stock"), (3, "stock with our operators")):
            ours, plain = np.median(seconds[:, [side]] / seconds[:, :2], axis=0)
            print(f"times faster than {name}, median: ours {ours:.2f}, without tie-break {plain:.2f}", flush=True)


if __name__ == "__main__":
    main()
