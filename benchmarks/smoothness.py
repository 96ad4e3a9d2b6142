"""Whether ties broken by smoothness smooth fronts, and what that costs: turn and hypervolume with and without, seed by seed.

Each row is an algorithm and a way to break its ties: "off", "on" as the paper has it, or "band", where objectives count in
steps of a share of their range. Columns are medians over the seeds, for the legal paths of the last population: the hypervolume
over that of the exact front and the mean turn of the paths on their front; the same of the front that `TradeOffSet` makes of
them with a band; how many different objective vectors the population has, how many ranks, and how many of all pairs have
equal ranks, so that turn has a say between them.

Run with ``python benchmarks/smoothness.py``; ``--help`` lists the options. With 21 seeds it takes about three minutes of
processor time with the path-aware operators and 100 generations, and half an hour with those of the paper and 500.
"""

from __future__ import annotations

import argparse
import os
from concurrent.futures import ProcessPoolExecutor
from functools import cache, partial
from typing import Any

# One thread for each process: the arrays are small, and threads of the linear algebra would only get in each other's way.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from pymoo.optimize import minimize
from pymoo.util.nds.non_dominated_sorting import NonDominatedSorting

from pymoo_gridpath import GridPathProblem, TradeOffSet
from pymoo_gridpath.algorithms import make_algorithm
from pymoo_gridpath.objectives import Vulnerability
from pymoo_gridpath.operators import RankAndSmoothness, SmoothnessTournament, paper_operators, path_operators
from pymoo_gridpath.problems import random_dense_grid
from pymoo_gridpath.quality import hypervolume_ratio

ROWS = ("NSGA2 off", "NSGA2 on", "NSGA2 band", "SPEA2 off", "SPEA2 on", "MOEAD off", "MOEAD on", "MOEAD band")
OPERATORS = {"paper": paper_operators, "path": path_operators}
COLUMNS = "ratio   turn  paths |  ratio   turn  paths | points  ranks  equal ranks"


def algorithm_of(row: str, problem, pop_size: int, operators: dict, band: float) -> Any:
    """Return the algorithm of a row."""
    name, ties = row.split()
    options: dict[str, Any] = {"smoothness": ties != "off"}
    if row == "NSGA2 band":
        options = {"selection": SmoothnessTournament(), "survival": RankAndSmoothness(band=band)}
    elif name == "MOEAD" and ties != "off":
        options["band"] = band if ties == "band" else 0.0
    return make_algorithm(name, problem, pop_size, operators=operators, **options)


@cache
def problem_of(size: int, p0: float, seed: int) -> GridPathProblem:
    """Return the problem of a grid, which remembers its exact front."""
    grid = random_dense_grid(size, p0, seed)
    return GridPathProblem(grid, (0, 0), (size - 1, size - 1), "integer", ("length", Vulnerability(variance=0.5)))


def run(seed: int, row: str, arguments) -> list[float]:
    """Return the columns of one run."""
    problem = problem_of(arguments.size, arguments.p0, seed if arguments.grids == "each" else 1)
    exact: Any = problem.pareto_front(max_seconds=600.0)
    operators = OPERATORS[arguments.operators](problem)
    algorithm = algorithm_of(row, problem, arguments.pop_size, operators, arguments.band)
    pop: Any = minimize(problem, algorithm, ("n_gen", arguments.generations), seed=seed).pop
    legal = pop.get("interfering_cells") == 0
    found: list[float] = []
    for band in (0.0, arguments.band):
        if not legal.any():
            found += [0.0, np.nan, 0]
            continue
        paths = TradeOffSet.from_genes(problem, pop.get("X")[legal], band=band)
        found += [hypervolume_ratio(paths.F, exact), paths.measures["turn"].mean(), len(paths)]
    F = pop.get("F").astype(float)
    sizes = np.array([len(front) for front in NonDominatedSorting().do(F)])
    equal = (sizes * (sizes - 1)).sum() / (len(F) * (len(F) - 1))
    return [*found, len(np.unique(F, axis=0)), len(sizes), equal]


def main() -> None:
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    parser.add_argument("--operators", choices=OPERATORS, default="path", help="the path-aware ones, or the paper's")
    parser.add_argument("--grids", choices=("one", "each"), default="one", help="one grid for all seeds, or for each its own")
    parser.add_argument("--size", type=int, default=32, help="cells a side")
    parser.add_argument("--p0", type=float, default=0.17, help="share of occupied cells")
    parser.add_argument("--pop-size", type=int, default=200)
    parser.add_argument("--generations", type=int, default=100)
    parser.add_argument("--seeds", type=int, default=21)
    parser.add_argument("--band", type=float, default=0.01)
    parser.add_argument("--rows", nargs="+", choices=ROWS, default=ROWS, metavar="ROW", help=", ".join(ROWS))
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes")
    arguments = parser.parse_args()
    print(
        f"{arguments.size} x {arguments.size}, p0 = {arguments.p0:g}, {arguments.grids} grid, {arguments.operators} operators, "
        f"population {arguments.pop_size}, {arguments.generations} generations, {arguments.seeds} seeds, "
        f"band {arguments.band:g}"
    )
    print(f"{'':10} |  {'front':20} |  {'front with a band':20} | last population")
    print(f"{'':10} |  {COLUMNS}")
    with ProcessPoolExecutor(arguments.jobs) as pool:
        for row in arguments.rows:
            runs = pool.map(partial(run, row=row, arguments=arguments), range(1, arguments.seeds + 1))
            a, b, c, d, e, f, g, h, i = np.nanmedian(list(runs), axis=0)
            columns = f"{a:.4f} {b:6.0f} {c:6.0f} | {d:.4f} {e:6.0f} {f:6.0f} | {g:6.0f} {h:6.0f}  {100 * i:9.1f} %"
            print(f"{row:10} | {columns}", flush=True)


if __name__ == "__main__":
    main()
