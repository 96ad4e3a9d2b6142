"""How long the exact front among moving obstacles takes, whether it is that of an enumeration, and what searches find of it.

    python benchmarks/timed.py [--cases 200] [--seeds 11]

First so many random cases of 4 x 4 cells, up to 10 ticks and up to 3 movers, compared with an enumeration; then
32 x 32 cells, 64 ticks and 8 movers, in seconds of processor time once the kernels are compiled. Then six cases of
20 x 20 cells, 40 ticks, 3 to 5 movers and ten points on the front or more: the share of the exact front's hypervolume that
NSGA-II finds with 100 members in 100 generations, its operators those that know of time, or those for whole numbers with the
repair that does. All its rows are looked at by the slow rules of `testing`. Last, how long a population takes to evaluate.
"""

from __future__ import annotations

import argparse
import time
from typing import Any

import numpy as np
from pymoo.optimize import minimize

from pymoo_gridpath import OccupancyGrid, make_algorithm, path_operators
from pymoo_gridpath.errors import UnreachableError
from pymoo_gridpath.exact import exact_front, exact_timed_front
from pymoo_gridpath.operators import DiscretePolynomialMutation, RandomSampling, TwoPointCrossover
from pymoo_gridpath.paths import Trajectories
from pymoo_gridpath.problems import TimedPathProblem
from pymoo_gridpath.quality import hypervolume_ratio
from pymoo_gridpath.testing.timed import enumerated, measured, wander

# Of the searches: cells a side, ticks, and the cases as (movers, number).
SIZE, HORIZON = 20, 40
CASES = [(n_movers, number) for n_movers in (3, 4, 5) for number in (0, 1)]
N_GEN = 100
# Runs of operators that know nothing of time, which take longer.
FEW = 3


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=200, help="small cases to enumerate (default: 200)")
    parser.add_argument("--seeds", type=int, default=11, help="runs of each search (default: 11)")
    arguments = parser.parse_args()
    speed()
    enumerations(arguments.cases)
    problems = [case(*one) for one in CASES]
    searches(problems, arguments.seeds)
    evaluations(problems[0][0])


def speed() -> None:
    rng = np.random.default_rng(32)
    occupied = rng.random((32, 32)) < 0.1
    occupied[[0, -1], [0, -1]] = False
    ways = [wander(rng, 32, 64) for _ in range(8)]
    for what in ("with compiling", "compiled"):
        begin = time.process_time()
        found = exact_timed_front(OccupancyGrid(occupied), (0, 0), (31, 31), Trajectories(ways), 64)
        print(f"{what}: {time.process_time() - begin:.2f} s, {found.n_labels:,} labels, {found.message}", flush=True)


def enumerations(n_cases: int) -> None:
    same = n_points = 0
    for number in range(n_cases):
        rng = np.random.default_rng([4, number])
        # Walls that leave a way along one side or the other.
        occupied = rng.random((4, 4)) < 0.2
        occupied[0], occupied[:, -1] = False, False
        horizon, n_movers, cutting = int(rng.integers(3, 11)), int(rng.integers(1, 4)), bool(rng.integers(2))
        ways = [wander(rng, 4, horizon) for _ in range(n_movers)]
        grid = OccupancyGrid(occupied, corner_cutting=cutting)
        F = exact_timed_front(grid, (0, 0), (3, 3), Trajectories(ways), horizon).F
        n_points += len(F)
        expected = np.reshape(enumerated(occupied, cutting, (0, 0), (3, 3), ways, horizon), (-1, 3))
        same += F.shape == expected.shape and np.allclose(F, expected, rtol=0, atol=1e-12)
    print(f"{same} of {n_cases} small cases equal the enumeration, {n_points} points in all", flush=True)


def case(n_movers: int, number: int) -> tuple[TimedPathProblem, list]:
    """Return a random problem with ten points on its front or more, and the ways of its obstacles."""
    rng = np.random.default_rng([SIZE, n_movers, number])
    while True:
        occupied = rng.random((SIZE, SIZE)) < 0.2
        occupied[[0, -1], [0, -1]] = False
        ways = [wander(rng, SIZE, HORIZON) for _ in range(n_movers)]
        try:
            problem = TimedPathProblem(OccupancyGrid(occupied), (0, 0), (SIZE - 1, SIZE - 1), ways, HORIZON)
        except UnreachableError:
            continue
        if len(exact_front(problem).F) >= 10:
            return problem, ways


def searches(problems: list, n_seeds: int) -> None:
    print(f"hypervolume ratio of NSGA-II, 100 members, {N_GEN} generations, {n_seeds} seeds: least / median; illegal rows")
    for (n_movers, number), (problem, ways) in zip(CASES, problems, strict=True):
        front = exact_front(problem).F
        aware = path_operators(problem)
        whole = {
            "sampling": RandomSampling(),
            "crossover": TwoPointCrossover(),
            "mutation": DiscretePolynomialMutation(prob_var=1 / problem.n_var),
            "repair": aware["repair"],
            "eliminate_duplicates": aware["eliminate_duplicates"],
        }
        said = []
        for operators, n_runs in ((aware, n_seeds), (whole, min(n_seeds, FEW))):
            ratios, illegal, seconds = [], 0, time.process_time()
            for seed in range(n_runs):
                algorithm = make_algorithm("NSGA2", problem, 100, operators=operators)
                result: Any = minimize(problem, algorithm, ("n_gen", N_GEN), seed=seed)
                ratios.append(hypervolume_ratio(result.F, front))
                illegal += sum(not _is_legal(problem, ways, row) for row in result.X)
            seconds = (time.process_time() - seconds) / n_runs
            said.append(f"{min(ratios):.4f} / {np.median(ratios):.4f}; {illegal} ({seconds:.1f} s a run)")
        print(f"  {n_movers} movers, case {number}, {len(front)} points: {said[0]}; repaired: {said[1]}", flush=True)


def _is_legal(problem: TimedPathProblem, ways: list, row: np.ndarray) -> bool:
    cells = [(int(cell) % SIZE, int(cell) // SIZE) for cell in row]
    return measured(problem.grid.occupied, problem.grid.corner_cutting, problem.goal, ways, cells)[0]


def evaluations(problem: TimedPathProblem) -> None:
    X = np.tile(exact_front(problem).X, (1000, 1))[:1000]
    best = np.inf
    for _ in range(20):
        begin = time.perf_counter()
        problem.evaluate(X)
        best = min(best, time.perf_counter() - begin)
    print(f"evaluation of {len(X)} rows of {problem.n_var} genes: {1e3 * best:.2f} ms, the least of 20 times")


if __name__ == "__main__":
    main()
