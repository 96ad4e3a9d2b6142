"""Compare the search quality of this package's NSGA-II, SPEA2 and MOEA/D with that of pymoo's own, seed by seed.

Run with ``python benchmarks/fast_generation.py``; ``--help`` lists the options. Both sides have the same operators and no
tie-break by smoothness. NSGA-II and SPEA2 should tie: they are the same algorithms on arrays. MOEA/D differs by design (scaled
objectives, a limit on replacements); MOEAD/1 compares it with itself, one child at a time and with pymoo's mating, and should
tie. The test is Wilcoxon's signed-rank test on the pairs of final hypervolumes.
"""

from __future__ import annotations

import argparse
import time
from typing import Any

import numpy as np
from pymoo.algorithms.moo.moead import MOEAD, NeighborhoodSelection
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.algorithms.moo.spea2 import SPEA2
from pymoo.core.algorithm import Algorithm
from pymoo.core.mating import Mating
from pymoo.indicators.hv import Hypervolume
from pymoo.optimize import minimize
from scipy.stats import wilcoxon

from pymoo_gridpath.algorithms import SmoothMOEAD, make_algorithm, reference_directions
from pymoo_gridpath.objectives import Vulnerability
from pymoo_gridpath.operators import default_operators
from pymoo_gridpath.problems import GridPathProblem, random_dense_grid

# The paper's.
OBJECTIVES = ("length", Vulnerability(variance=0.5), "turn")


def stock(name: str, problem, pop_size: int) -> Algorithm:
    """Return what an algorithm is compared with: pymoo's with the same operators, and all else as pymoo has it."""
    operators: dict[str, Any] = default_operators(problem) | {"eliminate_duplicates": True}
    if not name.startswith("MOEAD"):
        return {"NSGA2": NSGA2, "SPEA2": SPEA2}[name](pop_size=pop_size, **operators)
    del operators["eliminate_duplicates"]
    directions = reference_directions(problem.n_obj, pop_size)
    if name == "MOEAD":
        return MOEAD(directions, **operators)
    mating = Mating(NeighborhoodSelection(0.9), operators["crossover"], operators["mutation"], repair=operators["repair"])
    return SmoothMOEAD(directions, smoothness=False, batch_size=1, mating=mating, **operators)


def fronts(problem, algorithm: Algorithm, n_gen: int, n_seeds: int) -> tuple[list[np.ndarray], float]:
    """Return the final front of each seed, and the processor milliseconds of a generation."""
    start = time.process_time()
    results: list[Any] = [minimize(problem, algorithm, ("n_gen", n_gen), seed=seed) for seed in range(1, n_seeds + 1)]
    return [result.opt.get("F") for result in results], 1e3 * (time.process_time() - start) / (n_seeds * n_gen)


def hypervolumes(*sides: list[np.ndarray]) -> list[np.ndarray]:
    """Return the hypervolume of each front, in objectives scaled to the range of all fronts; the reference point is 1.1."""
    points = np.concatenate([front for side in sides for front in side])
    ideal, span = points.min(axis=0), np.ptp(points, axis=0)
    volume = Hypervolume(ref_point=np.full(points.shape[1], 1.1))
    return [np.array([volume((front - ideal) / np.where(span > 0, span, 1.0)) for front in side]) for side in sides]


def main() -> None:
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    parser.add_argument("--size", type=int, default=12, help="cells a side")
    parser.add_argument("--p0", type=float, default=0.1, help="share of occupied cells")
    parser.add_argument("--pop-size", type=int, default=60)
    parser.add_argument("--n-gen", type=int, default=25)
    parser.add_argument("--seeds", type=int, default=21)
    parser.add_argument("--representation", default="integer", help="cells has path-aware operators, others the paper's")
    parser.add_argument("--algorithms", nargs="+", default=["NSGA2", "SPEA2", "MOEAD"], help="NSGA2, SPEA2, MOEAD or MOEAD/1")
    arguments = parser.parse_args()

    size, pop_size = arguments.size, arguments.pop_size
    grid = random_dense_grid(size, arguments.p0, 1)
    print(
        f"{size} x {size}, p0 = {arguments.p0}, population {pop_size}, {arguments.n_gen} generations, {arguments.seeds} seeds"
    )
    print(
        "median final hypervolume, median difference, in how many runs ours is better and worse, p, milliseconds a generation"
    )
    print(f"{'':9}{'goals':>6}{'ours':>9}{'stock':>9}{'diff.':>9}{'better':>8}{'worse':>7}{'p':>7}{'ours':>8}{'stock':>8}")
    for n_obj in (2, 3):
        goal = size - 1, size - 1
        problem = GridPathProblem(grid, (0, 0), goal, arguments.representation, objectives=OBJECTIVES[:n_obj])
        for name in arguments.algorithms:
            sides = make_algorithm(name.split("/")[0], problem, pop_size, smoothness=False), stock(name, problem, pop_size)
            runs = [fronts(problem, side, arguments.n_gen, arguments.seeds) for side in sides]
            a, b = hypervolumes(*(found for found, _ in runs))
            p = wilcoxon(a, b)[1] if (a != b).any() else 1.0
            print(
                f"{name:9}{n_obj:>6}{np.median(a):>9.4f}{np.median(b):>9.4f}{np.median(a - b):>+9.4f}"
                f"{(a > b).sum():>8}{(a < b).sum():>7}{p:>7.3f}{runs[0][1]:>8.1f}{runs[1][1]:>8.1f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
