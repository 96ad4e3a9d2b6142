"""Measure how much of the exact front searches find: hypervolume over that of the exact front.

The reference point is the nadir of the exact front plus a tenth of its range in each objective. Every run has
its own seed, and on random grids its own scenario of section 6 of Ahmed and Deb (2013); rows show the median and the least
over the runs. Only legal paths count. Where the front is a single point, a run that finds it has 1, and any other 0.

``--feasibility`` measures instead how many first generations hold a legal path, for all rows of the paper's Table 1 and
for grids of 64 and 128 cells a side with a single free way.

Maps of the MovingAI benchmark are read from the folder given by ``--maps``; without it their rows are left out. Run with
``python benchmarks/quality.py --maps FOLDER``; ``--help`` lists the options.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import cache, partial
from pathlib import Path
from typing import Any, NamedTuple

# One thread for each process: the arrays are small, and threads of the linear algebra would only get in each other's way.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import moocore
import numpy as np
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem
from pymoo_gridpath.algorithms import make_algorithm
from pymoo_gridpath.maps import load_map, read_scen
from pymoo_gridpath.objectives import Vulnerability
from pymoo_gridpath.operators import paper_operators, path_operators
from pymoo_gridpath.problems import random_dense_grid

ALGORITHMS = ("NSGA2", "SPEA2", "MOEAD")

# The paper's.
OBJECTIVES = ("length", Vulnerability(variance=0.5))


class Case(NamedTuple):
    """One row: where paths are sought, how, and what ratio is asked for."""

    place: str
    representation: str
    operators: str
    algorithm: str
    figure: float | None


def make_problem(place: str, representation: str, seed: int, maps: Path | None) -> GridPathProblem:
    """Return the query of a place: the longest of a map, or from corner to corner of a random grid."""
    if place.startswith("random-"):
        _, size, p0 = place.split("-")
        n = int(size)
        return GridPathProblem(random_dense_grid(n, float(p0), seed), (0, 0), (n - 1, n - 1), representation, OBJECTIVES)
    assert maps is not None
    grid, query = longest_query(place, maps)
    return GridPathProblem(grid, query.start, query.goal, representation, OBJECTIVES)


@cache
def longest_query(name: str, maps: Path):
    """Return the grid of a map and its longest query."""
    grid = load_map(maps / f"{name}.map")
    return grid, max(read_scen(maps / f"{name}.map.scen", grid), key=lambda query: query.optimal_length)


def ratio(F: np.ndarray, exact: np.ndarray) -> float:
    """Return the hypervolume of legal points over that of the exact front."""
    if len(exact) == 1:
        return float(any(np.array_equal(point, exact[0]) for point in F))
    low, high = exact.min(axis=0), exact.max(axis=0)
    reference = np.full(exact.shape[1], 1.1)

    def volume(points):
        return moocore.hypervolume((points - low) / (high - low), ref=reference) if len(points) else 0.0

    return volume(F) / volume(exact)


def operators_of(name: str, problem) -> dict:
    """Return the paper's operators, or the path-aware ones with a sampling."""
    if name == "paper":
        return paper_operators(problem)
    return path_operators(problem, "random" if name == "random" else "scalarized")


def run(seed: int, case: Case, maps: Path | None, pop_size: int, n_eval: int) -> tuple[float, float]:
    """Return the ratio that one run reaches, and its seconds."""
    problem = make_problem(case.place, case.representation, seed, maps)
    operators = operators_of(case.operators, problem)
    exact: Any = problem.pareto_front(max_seconds=600.0)
    algorithm = make_algorithm(case.algorithm, problem, pop_size=pop_size, operators=operators)
    begin = time.perf_counter()
    result = minimize(problem, algorithm, ("n_eval", n_eval), seed=seed)
    seconds = time.perf_counter() - begin
    population: Any = result.pop
    legal = population.get("interfering_cells") == 0
    return ratio(population.get("F")[legal], exact), seconds


def cases(arguments) -> Iterator[Case]:
    """Yield the rows of the table."""
    for size in (32, 64, 128):
        for p0 in (0.2, 0.3):
            place = f"random-{size}-{p0}"
            for representation in ("integer", "cells"):
                for sampling in ("scalarized", "random"):
                    figure = 0.99 if sampling == "scalarized" else (0.90 if size == 128 else 0.97)
                    for algorithm in ALGORITHMS:
                        yield Case(place, representation, sampling, algorithm, figure * (1.0 if algorithm == "NSGA2" else 0.97))
            if size == 32:
                yield Case(place, "integer", "paper", "NSGA2", None)
    if arguments.maps is None:
        print("the rows of MovingAI maps are left out, expected their folder as --maps")
        return
    for place, figure in (("arena", 0.99), ("lak304d", 0.99), ("random512-10-0", 0.95)):
        for algorithm in ALGORITHMS if figure == 0.99 else ("NSGA2",):
            yield Case(place, "cells", "scalarized", algorithm, figure * (1.0 if algorithm == "NSGA2" else 0.97))


def wanted(case: Case, arguments) -> bool:
    """Whether the options ask for a row."""
    return all(
        not chosen or value in chosen
        for value, chosen in (
            (case.place, arguments.places),
            (case.representation, arguments.representations),
            (case.operators, arguments.operators),
            (case.algorithm, arguments.algorithms),
        )
    )


def first_generation_is_legal(seed: int, size: int, p0: float, representation: str, sampling: str) -> bool:
    """Return whether the first generation of a run holds a legal path."""
    problem = make_problem(f"random-{size}-{p0}", representation, seed, None)
    algorithm = make_algorithm("NSGA2", problem, pop_size=20, operators=operators_of(sampling, problem))
    result = minimize(problem, algorithm, ("n_gen", 1), seed=seed)
    population: Any = result.pop
    return bool(np.any(population.get("interfering_cells") == 0))


def feasibility(arguments, executor) -> None:
    """Print how many first generations hold a legal path."""
    rows = [(size, p0 / 10) for size in (8, 16, 32) for p0 in range(1, 11)] + [(64, 1.0), (128, 1.0)]
    print(f"{'grid':>5} {'p0':>4}   first generations with a legal path, of {arguments.runs}")
    for size, p0 in rows:
        counts = []
        for representation in ("integer", "cells"):
            for sampling in ("scalarized", "random"):
                one = partial(first_generation_is_legal, size=size, p0=p0, representation=representation, sampling=sampling)
                counts.append(f"{representation} {sampling} {sum(executor.map(one, range(1, arguments.runs + 1)))}")
        print(f"{size:>5} {p0:>4}   {', '.join(counts)}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--maps", type=Path, help="folder with arena, lak304d and random512-10-0, .map and .map.scen")
    parser.add_argument("--runs", type=int, help="runs of each row (default: 11, or 100 with --feasibility)")
    parser.add_argument("--evaluations", type=int, default=20_000)
    parser.add_argument("--pop-size", type=int, default=200)
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes")
    parser.add_argument("--places", nargs="+", help="only these, such as random-32-0.2 or arena")
    parser.add_argument("--representations", nargs="+", help="only these: integer, cells")
    parser.add_argument("--operators", nargs="+", help="only these: scalarized, random, paper")
    parser.add_argument("--algorithms", nargs="+", help="only these: NSGA2, SPEA2, MOEAD")
    parser.add_argument("--feasibility", action="store_true", help="count legal first generations instead")
    arguments = parser.parse_args()
    arguments.runs = arguments.runs or (100 if arguments.feasibility else 11)
    with ProcessPoolExecutor(arguments.jobs) as executor:
        if arguments.feasibility:
            feasibility(arguments, executor)
            return
        print(f"{arguments.evaluations} evaluations, population {arguments.pop_size}, {arguments.runs} runs")
        print(f"{'place':<16} {'coding':<8} {'operators':<11} {'algorithm':<9}  median   least   figure  seconds a run")
        for case in cases(arguments):
            if not wanted(case, arguments):
                continue
            one = partial(run, case=case, maps=arguments.maps, pop_size=arguments.pop_size, n_eval=arguments.evaluations)
            ratios, seconds = np.array(list(executor.map(one, range(1, arguments.runs + 1)))).T
            figure = "" if case.figure is None else f"{case.figure:.3f}"
            print(
                f"{case.place:<16} {case.representation:<8} {case.operators:<11} {case.algorithm:<9} {np.median(ratios):7.4f} "
                f"{ratios.min():7.4f}  {figure:>7}  {np.median(seconds):8.2f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
