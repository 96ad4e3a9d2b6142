"""What a front that is certified to be near costs: beside the exact search, and on a map of 4096 x 4096 cells.

    python benchmarks/near_fronts.py --maps MOVINGAI --turns 5

Prints the processor time of epsilon 0.02 over that of the exact search, medians of turns that alternate, on
random512-10-0 of MovingAI's (its longest query, with ``--maps``), rooms, and a maze; then, of a random map in a process of its
own, seconds and memory of the problem and of a front that is certified to be within 3 %, and what was handed
over on the way. Every certificate of the former is held against the exact front.
"""

from __future__ import annotations

import argparse
import math
import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from before_after import drawn_maps, part_way

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.exact import exact_front
from pymoo_gridpath.maps import load_map, read_scen
from pymoo_gridpath.objectives import Vulnerability

EPSILON, WITHIN = 0.02, 0.03


def problem_of(grid: OccupancyGrid, start, goal) -> GridPathProblem:
    return GridPathProblem(grid, start, goal, "cells", ["length", Vulnerability(variance=0.5)])


def problems(folder: Path | None) -> Iterator[tuple[str, GridPathProblem]]:
    """Yield the problems by their names."""
    if folder is not None:
        name = "random512-10-0"
        query = [query for query in read_scen(folder / f"{name}.map.scen") if query.start != query.goal][-1]
        yield f"{name}, longest", problem_of(load_map(folder / f"{name}.map"), query.start, query.goal)
    for name, occupied in drawn_maps().items():
        share = {"rooms of 32": 1.0, "maze of 8": 0.1}.get(name)
        if share is not None:
            grid = OccupancyGrid(occupied)
            yield name, problem_of(grid, *part_way(grid, share))


def beside_the_exact(folder: Path | None, turns: int) -> None:
    """Print what it takes beside the exact search."""
    ratios = []
    for name, problem in problems(folder):
        ways = {"exact": lambda problem=problem: exact_front(problem)}
        ways["near"] = lambda problem=problem: exact_front(problem, epsilon=EPSILON)
        seconds: dict[str, list[float]] = {way: [] for way in ways}
        found = {way: search() for way, search in ways.items()}
        for _ in range(turns):
            for way, search in ways.items():
                begin = time.process_time()
                search()
                seconds[way].append(time.process_time() - begin)
        exact, near = found["exact"].F, found["near"].F
        reached = (near[:, None] / exact).max(axis=2).min(axis=0).max() - 1
        certificate = found["near"].certified
        assert certificate is not None and reached <= certificate.epsilon + 1e-9 and certificate.epsilon <= EPSILON
        medians = {way: statistics.median(values) for way, values in seconds.items()}
        ratios.append(medians["near"] / medians["exact"])
        print(
            f"{name}: {medians['exact']:.3f} s exact, {len(exact)} points; {medians['near']:.3f} s near, {len(near)} points, "
            f"within {100 * certificate.epsilon:.2f} % certified, {100 * reached:.2f} % reached; ratio {ratios[-1]:.2f}",
            flush=True,
        )
    print(f"geometric mean of the ratios: {math.exp(statistics.mean(map(math.log, ratios))):.2f}", flush=True)


def on_a_large_map(side: int) -> None:
    """Print what a problem and a front near to its own take on a random map, with 20 % of the cells occupied."""
    from pymoo_gridpath.exact.front import better_fronts
    from pymoo_gridpath.exact.steps import handed_over

    def drawn(side: int) -> OccupancyGrid:
        occupied = np.random.default_rng(0).random((side, side)) < 0.2
        occupied[0, 0] = occupied[-1, -1] = False
        return OccupancyGrid(occupied)

    def said(what: str) -> None:
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e9
        spent = time.process_time() - processor, time.perf_counter() - clock
        print(f"{spent[0]:6.1f} s of the processor, {spent[1]:6.1f} s, peak {peak:.2f} GB: {what}", flush=True)

    # Compiles, and loads what it needs.
    exact_front(problem_of(drawn(300), (0, 0), (299, 299)), epsilon=WITHIN)
    grid = drawn(side)
    processor, clock = time.process_time(), time.perf_counter()
    problem = problem_of(grid, (0, 0), (side - 1, side - 1))
    said(f"problem, {side} x {side} cells")
    processor, clock = time.process_time(), time.perf_counter()
    for found, _ in handed_over(better_fronts(problem, epsilon=WITHIN)):
        said(f"{len(found.F)} points, {found.certified}")


def main() -> None:
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    parser.add_argument("--maps", type=Path, help="folder with random512-10-0, .map and .map.scen")
    parser.add_argument("--turns", type=int, default=5, metavar="N", help="turns of either search (default: 5)")
    parser.add_argument("--side", type=int, default=4096, help="of the large map (default: 4096); 0 for none")
    parser.add_argument("--large", action="store_true", help="the large map alone, in this process")
    arguments = parser.parse_args()
    if arguments.large:
        on_a_large_map(arguments.side)
        return
    if arguments.turns:
        beside_the_exact(arguments.maps, arguments.turns)
    if arguments.side:
        # Its peak of memory is its own.
        subprocess.run([sys.executable, __file__, "--large", "--side", str(arguments.side)], check=True)


if __name__ == "__main__":
    main()
