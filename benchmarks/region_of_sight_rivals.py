"""Region of sight beside its rivals, tables I to III of its paper: particles, ants and bees that shorten the same path.

    python benchmarks/region_of_sight_rivals.py [--maps 30] [--kinds maze] [--evaluations 2500] [--fronts 3] [--jobs 2]

On seeded maps of the paper's three kinds, since its own are lost. All begin with the path that region of sight begins with, on
its road, and rivals search `ShorteningProblem` on it: between obstacles grown by the same distance, and, as the distances that
the paper prints for them suggest that its rivals did, between obstacles as they are. Beside them the optimum of the
same problem, by dynamic programming; that optimum anew on the cells of its own path, and so on until a tenth of a cell is no
longer gained; and region of sight from a shortest path. ``--fronts`` is on how many maps of each kind the exact front of
length and vulnerability is searched, for two minutes at most, and by NSGA-II. Bees need NiaPy, the extra ``swarm``; without it
their rows are left out. Tables go to standard output, in Markdown, how far it is to standard error.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import sys
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from typing import Any, NamedTuple

# One thread for each process: the arrays are small, and threads of the linear algebra would only get in each other's way.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from pymoo.algorithms.soo.nonconvex.pso import PSO
from pymoo.core.callback import Callback
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import AntColony, BeeColony, RegionOfSight, Waypoints, make_algorithm
from pymoo_gridpath.exact import Budget, exact_front
from pymoo_gridpath.fields import clearance
from pymoo_gridpath.objectives import Vulnerability
from pymoo_gridpath.problems import (
    ShorteningProblem,
    concave_environment,
    convex_environment,
    far_corners,
    maze_environment,
)
from pymoo_gridpath.search.sight import shorten

KINDS: dict[str, Callable[[int], OccupancyGrid]] = {
    "convex": convex_environment,
    "concave": concave_environment,
    "maze": maze_environment,
}

# Length, distance to obstacles, curvature in 1 / m and iterations, tables I to III.
PRINTED = {
    "convex": {
        "region of sight": "677.49, 5, 0.005, 7",
        "particles": "687.19 ± 12.5, 1, 0.2304, 72 ± 20",
        "ants": "681.06 ± 9.25, 1, 0.1856, 100 ± 25",
        "bees": "726.75 ± 18.6, 3 ± 2, 0.2639, 36 ± 12",
    },
    "concave": {
        "region of sight": "623.74, 4, 0.1123, 4",
        "particles": "660.55 ± 20.58, 2 ± 1, 1.315, 120 ± 25",
        "ants": "616.30 ± 8.69, 1, 1.5465, 75 ± 20",
        "bees": "654.75 ± 17.26, 2 ± 1, 1.3626, 51 ± 17",
    },
    "maze": {
        "region of sight": "356.77, 3, 0.1806, 7",
        "particles": "349.87 ± 5.3, 2 ± 1, 3.5806, 100 ± 25",
        "ants": "344.4 ± 4.3, 1, 3.202, 79 ± 25",
        "bees": "415.22 ± 8.2, 4 ± 2, 2.7572, 66 ± 32",
    },
}

RIVALS: dict[str, Callable[[], Any]] = {
    "particles": partial(PSO, pop_size=25),
    "ants": partial(AntColony, pop_size=25),
    "bees": partial(BeeColony, pop_size=24),
}
if importlib.util.find_spec("niapy") is None:
    del RIVALS["bees"]

# Rows of tables; rivals and optimum stand twice, among grown obstacles and among others.
OURS, OPTIMUM, GROWTHS = "region of sight", "optimum on the road", ("", ", no growth")

# A gain below this, in cells, is none: as in region of sight.
LEAST_GAIN = 0.1

# Lengths, clearances and curvatures that differ by no more are equal.
SLACK = (LEAST_GAIN, 1e-9, 1e-9, 1e-9)

# Genes of a row.
POINTS = 10

SECONDS = 120.0


class Row(NamedTuple):
    """A path, and what it took: iterations and evaluations until less than a tenth of a cell was left to gain, and all."""

    length: float
    clearance: float
    greatest: float
    mean: float
    iterations: float = np.nan
    evaluations: float = np.nan
    seconds: float = np.nan


class Best(Callback):
    """Keeps the best length, and the evaluations, after each iteration."""

    def __init__(self):
        super().__init__()
        self.seen: list[tuple[float, int]] = []

    def _update(self, algorithm: Any) -> None:
        self.seen.append((algorithm.opt[0].F[0], algorithm.evaluator.n_eval))


def say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def row(grid: OccupancyGrid, waypoints: Waypoints, cells: np.ndarray, *cost: float) -> Row:
    """Return what is measured of a path."""
    field = clearance(grid)
    return Row(waypoints.length, field[cells[:, 1], cells[:, 0]].min(), *waypoints.curvature, *cost)


def search(problem: ShorteningProblem, make: Callable[[], Any], n_eval: int, seed: int) -> Row:
    """Return what a rival finds."""
    best, begin = Best(), time.process_time()
    result = minimize(problem, make(), ("n_eval", n_eval), seed=seed, callback=best)
    seconds = time.process_time() - begin
    lengths, evaluations = np.array(best.seen).T
    k = int(np.argmax(lengths <= lengths[-1] + LEAST_GAIN))
    return row(problem.grid, problem.waypoints(result.X), problem.cells(result.X), k + 1, evaluations[k], seconds)


def optimum(problem: ShorteningProblem, again: bool = False) -> Row:
    """Return the optimum of a problem; or then that on the cells of its path, and so on."""
    begin, rounds, best = time.process_time(), 0, np.inf
    while True:
        rounds += 1
        x: Any = problem.pareto_set()
        waypoints, cells = problem.waypoints(x[0]), problem.cells(x[0])
        if not again or waypoints.length > best - LEAST_GAIN:
            return row(problem.grid, waypoints, cells, rounds, np.nan, time.process_time() - begin)
        best = waypoints.length
        problem = ShorteningProblem(problem.grid, cells, problem.radius, min(3 * POINTS, len(cells) - 2))


def measure(kind: str, seed: int, n_eval: int) -> dict[str, Row]:
    """Return the rows of one map."""
    grid = KINDS[kind](seed)
    rows: dict[str, Row] = {}
    for name, road in ((OURS, "skeleton"), ("the same from a shortest path", "shortest")):
        planner, begin = RegionOfSight(road=road), time.process_time()
        planner.plan(GridPathProblem(grid, *far_corners(grid), representation="cells"))
        found = planner.found
        rows[name] = row(grid, found.waypoints[0], found.cells[0], found.passes[0], np.nan, time.process_time() - begin)
        if road == "skeleton":
            initial, radius = found.initial[0], found.radius[0]
            rows["the initial path"] = row(grid, Waypoints(grid, initial), initial)
        else:
            shortest = found.initial[0]
            rows["the shortest path, eight directions"] = row(grid, Waypoints(grid, shortest), shortest)
    for growth, distance in zip(GROWTHS, (radius, 0.0), strict=True):
        problem = ShorteningProblem(grid, initial, distance, POINTS)
        if distance == 0:
            corners, cells, lengths = shorten(problem.moves, problem.road, 100)
            waypoints = Waypoints(grid, problem.moves.cells(corners))
            rows[OURS + growth] = row(grid, waypoints, problem.moves.cells(cells), len(lengths) - 1)
        rows[OPTIMUM + growth] = optimum(problem)
        rows[OPTIMUM + ", and again on its path" + growth] = optimum(problem, again=True)
        for name, make in RIVALS.items():
            rows[name + growth] = search(problem, make, n_eval, seed)
    rows["radius"] = Row(radius, radius, 0.0, 0.0)
    return rows


def table(kind: str, maps: list[dict[str, Row]]) -> None:
    """Print the medians of all methods on maps of a kind, and how region of sight compares with each rival."""
    grid = KINDS[kind](0)
    print(f"\n{kind}, {len(maps)} maps of {grid.width} x {grid.height}, radius {maps[0]['radius'].length:g}:\n")
    head = ("Method", "Length", "over region of sight's", "Clearance (least)", "Curvature, greatest", "mean", "Iterations")
    lines = [[*head, "Evaluations", "Seconds", "Printed: length, clearance, curvature, iterations"]]
    lines += [[name, *shown(maps, name), PRINTED[kind].get(name, "")] for name in maps[0] if name != "radius"]
    show(lines)
    print("\nMaps on which region of sight is better : worse than each:\n")
    lines = [["Rival", "Length", "Clearance", "Curvature, greatest", "mean", "Rival over its optimum, median (most)"]]
    ours = np.array([rows[OURS] for rows in maps])
    for growth in GROWTHS:
        least = np.array([rows[OPTIMUM + growth].length for rows in maps])
        for name in RIVALS:
            theirs = np.array([rows[name + growth] for rows in maps])
            # A larger clearance is better, of all else less.
            gains = (theirs[:, :4] - ours[:, :4]) * [1, -1, 1, 1]
            counts = [
                (int((gain > slack).sum()), int((gain < -slack).sum())) for gain, slack in zip(gains.T, SLACK, strict=True)
            ]
            over = theirs[:, 0] / least - 1
            lines.append([name + growth, *map("{0[0]} : {0[1]}".format, counts), f"{np.median(over):.2%} ({over.max():.2%})"])
    show(lines)
    sys.stdout.flush()


def shown(maps: list[dict[str, Row]], name: str) -> list[str]:
    """Return the cells of a row of the table: medians over the maps."""
    values = np.array([rows[name] for rows in maps])
    ratio = values[:, 0] / np.array([rows[OURS].length for rows in maps])
    median = np.median(values, axis=0)
    return [
        f"{median[0]:.1f}",
        f"{np.median(ratio):.3f} ({ratio.min():.3f} to {ratio.max():.3f})",
        f"{median[1]:.1f} ({values[:, 1].min():.1f})",
        f"{median[2]:.3f}",
        f"{median[3]:.4f}",
        *("" if np.isnan(value) else f"{value:,.0f}" for value in median[4:6]),
        "" if np.isnan(median[6]) else f"{median[6]:.2f}",
    ]


def show(lines: list[list[str]]) -> None:
    """Print a table."""
    for line in [lines[0], ["---"] * len(lines[0]), *lines[1:]]:
        print(f"| {' | '.join(line)} |")


class Fronts(NamedTuple):
    """What the exact front of length and vulnerability and that of NSGA-II say of region of sight's path on one map."""

    points: float
    seconds: float
    over_shortest: float
    dominated: float
    nsga_seconds: float
    nsga_over_shortest: float
    dominated_by_nsga: float


def fronts(kind: str, seed: int) -> Fronts | None:
    """Return that for a map, or None if its exact front takes too long."""
    grid = KINDS[kind](seed)
    problem = GridPathProblem(grid, *far_corners(grid), "cells", ("length", Vulnerability(variance=0.5)))
    ours = problem.evaluate(np.asarray(RegionOfSight().plan(problem).paths))[0]
    begin = time.process_time()
    exact = exact_front(problem, Budget(max_seconds=SECONDS))
    seconds, begin = time.process_time() - begin, time.process_time()
    if not exact.complete:
        return None
    result = minimize(problem, make_algorithm("NSGA2", problem, pop_size=100), ("n_gen", 100), seed=seed)
    nsga_seconds, pop = time.process_time() - begin, result.pop
    assert pop is not None
    F, shortest = pop.get("F")[pop.get("interfering_cells") == 0], exact.F[:, 0].min()
    return Fronts(
        float(len(exact.F)),
        seconds,
        ours[0] / shortest,
        dominates(exact.F, ours),
        nsga_seconds,
        F[:, 0].min() / shortest,
        dominates(F, ours),
    )


def dominates(F: np.ndarray, point: np.ndarray) -> bool:
    """Return whether one of some points dominates another."""
    return bool(((point + 1e-9 >= F).all(axis=1) & (point - 1e-9 > F).any(axis=1)).any())


def compare_fronts(found: dict[str, list[Fronts]]) -> None:
    """Print medians over the maps of each kind."""
    print("\nLengths of cells, and fronts of length and vulnerability, 100 members and generations of NSGA-II:\n")
    head = (
        "Kind",
        "Maps",
        "Points of the exact front",
        "Seconds",
        "Region of sight over the shortest path",
        "dominated by the front",
    )
    lines = [[*head, "NSGA-II, seconds", "over the shortest path", "dominates region of sight"]]
    for kind, rows in found.items():
        values = np.array(rows)
        points, seconds, over, _, nsga_seconds, nsga_over, _ = np.median(values, axis=0)
        n_exact, n_nsga = (int(values[:, k].sum()) for k in (3, 6))
        line = [kind, str(len(rows)), f"{points:.0f}", f"{seconds:.1f}", f"{over:.3f}", f"on {n_exact}"]
        lines.append([*line, f"{nsga_seconds:.1f}", f"{nsga_over:.3f}", f"on {n_nsga}"])
    show(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--maps", type=int, default=30, help="maps of each kind (default: 30)")
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=list(KINDS), help="kinds of maps (default: all)")
    parser.add_argument("--evaluations", type=int, default=2500, help="of each run of a rival (default: 2,500)")
    parser.add_argument("--fronts", type=int, default=3, help="maps of each kind on which fronts are searched (default: 3)")
    parser.add_argument("--jobs", type=int, default=2, help="processes (default: 2)")
    arguments = parser.parse_args()
    if "bees" not in RIVALS:
        say("NiaPy, the extra swarm, is not installed: no bees")

    begin = time.perf_counter()
    with ProcessPoolExecutor(arguments.jobs) as pool:
        for kind in arguments.kinds if arguments.maps else ():
            done = []
            for rows in pool.map(partial(measure, kind, n_eval=arguments.evaluations), range(arguments.maps)):
                done.append(rows)
                say(f"{kind}: {len(done)} of {arguments.maps} maps, {time.perf_counter() - begin:.0f} s")
            table(kind, done)
        found: dict[str, list[Fronts]] = {}
        for kind in arguments.kinds if arguments.fronts else ():
            known = [one for one in pool.map(partial(fronts, kind), range(arguments.fronts)) if one is not None]
            say(f"fronts, {kind}: {len(known)} of {arguments.fronts} known, {time.perf_counter() - begin:.0f} s")
            if known:
                found[kind] = known
        if found:
            compare_fronts(found)


if __name__ == "__main__":
    main()
