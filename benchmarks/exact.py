"""Time the exact solver, and count what its labels take.

Prints one row a case: points of the front, most labels at a time, bytes for each of them, and seconds (the median where a case
has several queries), beside the figure that it is held to. Everything that ``exact_front`` does is timed, bounds and paths
included; compilation is not, since a first query is solved before the clock starts.

Maps of the MovingAI benchmark are read from the folder given by ``--maps``; without it their rows are left out. Run with
``python benchmarks/exact.py --maps FOLDER``. It takes a few minutes, most of them for the queries of lak304d.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.compiled import COMPILED
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.exact import ExactResult, exact_front
from pymoo_gridpath.maps import load_map, read_scen
from pymoo_gridpath.objectives import Vulnerability
from pymoo_gridpath.representations import CellSequence

# The paper's.
TWO = "length", Vulnerability(variance=0.5)
THREE = (*TWO, "turn")


class Case(NamedTuple):
    """Queries that make one row."""

    name: str
    problems: Sequence[GridPathProblem]
    seconds: float | None


def random_problems(size: int, density: float, n: int, **options) -> list[GridPathProblem]:
    """Return queries from corner to corner of random grids, on which cells are occupied at random; seeds from 0 on."""
    problems, seed = [], 0
    while len(problems) < n:
        occupied = np.random.default_rng(seed).random((size, size)) < density
        occupied[0, 0] = occupied[-1, -1] = False
        seed += 1
        try:
            grid = OccupancyGrid(occupied, name=f"random {size}")
            options.setdefault("objectives", TWO)
            problems.append(GridPathProblem(grid, (0, 0), (size - 1, size - 1), **options))
        except GridPathError:  # no way through
            continue
    return problems


def map_problems(folder: Path, name: str, longest: bool, every: int = 1) -> list[GridPathProblem]:
    """Return the longest query of a map, or every so many of all."""
    grid = load_map(folder / f"{name}.map")
    queries = [query for query in read_scen(folder / f"{name}.map.scen", grid) if query.start != query.goal]
    queries = [max(queries, key=lambda query: query.optimal_length)] if longest else queries[::every]
    return [GridPathProblem(grid, query.start, query.goal, "cells", TWO) for query in queries]


def cases(arguments) -> Iterator[Case]:
    """Yield the rows of the table."""
    n = arguments.grids
    for size in (32, 128):
        yield Case(f"random {size}, 20 %, monotone", random_problems(size, 0.2, n), None)
    for corner in (False, True):
        problems = random_problems(128, 0.2, n, representation="cells")
        if corner:
            problems = [GridPathProblem(p.grid.replace(corner_cutting=True), p.start, p.goal, "cells", TWO) for p in problems]
        yield Case(f"random 128, 20 %, corners {'cut' if corner else 'kept'}", problems, 0.1)
    problems = random_problems(64, 0.2, n, representation="cells", objectives=THREE)
    yield Case("random 64, 20 %, 3 objectives", problems, 0.5)
    # Too short for part of the front.
    rows = [CellSequence(p.grid, p.start, p.goal, max_cells=98) for p in problems]
    problems = [GridPathProblem(row.grid, row.start, row.goal, row, THREE) for row in rows]
    yield Case("the same, at most 98 cells a path", problems, None)
    if arguments.maps is None:
        print("the rows of MovingAI maps are left out, expected their folder as --maps")
        return
    yield Case("lak304d, queries", map_problems(arguments.maps, "lak304d", False, arguments.every), 0.3)
    yield Case("random512-10-0, longest query", map_problems(arguments.maps, "random512-10-0", True), 5.0)


def row(case: Case, found: Sequence[ExactResult]) -> str:
    """Return a line of the table."""
    seconds = [result.seconds for result in found]
    labels = [result.n_labels for result in found]
    # The arrays begin with some room; only searches that outgrow it tell what a label takes.
    memory = max((result.n_bytes / result.n_labels for result in found if result.n_labels > 10_000), default=np.nan)
    points = int(np.median([len(result.F) for result in found]))
    target = "" if case.seconds is None else f"{case.seconds:.2f}"
    return (
        f"{case.name:<34} {len(found):>8} {points:>8} {int(np.median(labels)):>10,} {memory:>8.1f} "
        f"{np.median(seconds):>8.3f} {max(seconds):>8.3f} {target:>8}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--maps", type=Path, help="folder with lak304d and random512-10-0, .map and .map.scen")
    parser.add_argument("--grids", type=int, default=11, help="random grids of a case")
    parser.add_argument("--every", type=int, default=1, help="take every so many of the queries of lak304d")
    arguments = parser.parse_args()
    print(f"kernels {'compiled' if COMPILED else 'NOT compiled (the fast extra is not installed)'}")
    for objectives in (TWO, THREE):
        exact_front(random_problems(16, 0.2, 1, representation="cells", objectives=objectives)[0])
    print(
        f"{'case':<34} {'queries':>8} {'points':>8} {'labels':>10} {'B/label':>8} {'median s':>8} {'most s':>8} {'figure s':>8}"
    )
    for case in cases(arguments):
        print(row(case, [exact_front(problem) for problem in case.problems]), flush=True)


if __name__ == "__main__":
    main()
