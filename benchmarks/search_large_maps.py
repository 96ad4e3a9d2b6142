"""Compare path-aware search on large maps in two versions of the package: its time, and how much of the front it finds.

Give it two folders that hold a version each, such as two git worktrees:

    python benchmarks/search_large_maps.py ../before . --seeds 11

Maps of 512 x 512 cells, of random cells, of rooms and of mazes, are drawn anew for every seed. On each, both versions run
NSGA-II with path-aware operators and the same seed, one after the other and the second first every other time. Times are those
of the processor. The hypervolume is that over the exact front where that is found in ``--exact`` seconds, else over what both
versions found together. Rows show medians; how often the later version found more and how often less; and the probability of
such a difference, or a larger one, by chance, by Wilcoxon's signed-rank test.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
import warnings
from itertools import product
from pathlib import Path
from typing import Any

import moocore
import numpy as np
from before_after import SIDES, Version, drawn_maps, part_way
from quality import ratio
from scipy import stats

# How far apart start and goal are on each kind of map, of the farthest that there are.
KINDS = {"random 40 %": 1.0, "rooms of 32": 1.0, "maze of 8": 0.5}


def make_problem(kind: str, seed: int):
    """Return the query of a map, in the version that the environment names, with the paper's objectives."""
    from pymoo_gridpath import GridPathProblem, OccupancyGrid
    from pymoo_gridpath.objectives import Vulnerability

    grid = OccupancyGrid(drawn_maps(seed=seed)[kind])
    start, goal = part_way(grid, KINDS[kind])
    return GridPathProblem(grid, start, goal, "cells", ["length", Vulnerability(variance=0.5)])


def serve(evaluations: int) -> None:
    """Run what is asked for: the number of a kind and a seed come in, the seconds and the front go out."""
    warnings.simplefilter("ignore")
    from pymoo.optimize import minimize

    import pymoo_gridpath
    from pymoo_gridpath.algorithms import make_algorithm
    from pymoo_gridpath.operators import path_operators

    def run(problem, termination, seed):
        algorithm = make_algorithm("NSGA2", problem, pop_size=200, operators=path_operators(problem))
        begin = time.process_time()
        result = minimize(problem, algorithm, termination, seed=seed)
        population: Any = result.pop
        return time.process_time() - begin, population

    # Compiles.
    run(make_problem("rooms of 32", 1), ("n_gen", 3), 1)
    print(json.dumps([str(Path(pymoo_gridpath.__file__).parent.parent), *KINDS]), flush=True)
    for line in sys.stdin:
        seed, k = divmod(int(line), len(KINDS))
        seconds, population = run(make_problem(list(KINDS)[k], seed), ("n_eval", evaluations), seed)
        legal = population.get("interfering_cells") == 0
        print(json.dumps([seconds, population.get("F")[legal].tolist()]), flush=True)


def reference(kind: str, seed: int, seconds: float, found: list[np.ndarray]) -> tuple[np.ndarray, bool]:
    """Return the exact front of a query, or what was found of it, and which of them it is."""
    if seconds > 0:
        from pymoo_gridpath.exact import Budget, exact_front

        exact = exact_front(make_problem(kind, seed), Budget(max_seconds=seconds))
        if exact.complete:
            return exact.F, True
    together = np.unique(np.concatenate(found), axis=0)
    return together[moocore.is_nondominated(together)], False


def main() -> None:
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    parser.add_argument("before", type=Path, nargs="?", help="a folder with the package in it")
    parser.add_argument("after", type=Path, nargs="?", help="another one")
    parser.add_argument("--seeds", type=int, default=11, help="maps of each kind")
    parser.add_argument("--first", type=int, default=1, metavar="SEED", help="the first of them")
    parser.add_argument("--evaluations", type=int, default=20_000)
    parser.add_argument("--exact", type=float, default=120.0, metavar="SECONDS", help="for each exact front; 0 for none")
    parser.add_argument("--only", default="", help="kinds of map with this in their name alone")
    parser.add_argument("--serve", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.serve:
        return serve(arguments.evaluations)
    if arguments.after is None:
        parser.error("two folders are needed")

    options = "--evaluations", str(arguments.evaluations)
    versions = {side: Version(getattr(arguments, side), __file__, *options) for side in SIDES}
    kinds = [kind for kind in KINDS if arguments.only in kind]
    rows = {kind: [] for kind in kinds}
    # All kinds of one seed after another, so that whoever ends it early has as many of each.
    for seed, kind in product(range(arguments.first, arguments.first + arguments.seeds), kinds):
        found = {}
        for side in SIDES if seed % 2 else reversed(SIDES):
            found[side] = versions[side].turn(seed * len(KINDS) + list(KINDS).index(kind))
        fronts = [np.array(found[side][1]) for side in SIDES]
        front, is_exact = reference(kind, seed, arguments.exact, fronts)
        rows[kind].append([*(found[side][0] for side in SIDES), *(ratio(F, front) for F in fronts), is_exact])
        before, after, less, more, _ = rows[kind][-1]
        print(f"{kind}, seed {seed}: {before:.2f} {after:.2f} s, {less:.5f} {more:.5f}", file=sys.stderr, flush=True)
    for version in versions.values():
        version.end()

    head = f"{'kind of map':15}{'seconds: before':>16}{'after':>8}{'ratio':>8}"
    print(f"{head}{'hypervolume: before':>21}{'after':>9}{'more':>6}{'less':>6}{'chance':>8}{'exact':>7}")
    for kind in kinds:
        before, after, less, more, exact = np.array(rows[kind]).T
        gains = more - less
        test: Any = stats.wilcoxon(gains) if gains.any() else None
        chance = test.pvalue if test else 1.0
        print(
            f"{kind:15}{np.median(before):>16.2f}{np.median(after):>8.2f}{np.median(after / before):>8.3f}"
            f"{np.median(less):>21.5f}{np.median(more):>9.5f}{(gains > 0).sum():>6}{(gains < 0).sum():>6}{chance:>8.3f}"
            f"{exact.sum():>7.0f}"
        )


if __name__ == "__main__":
    main()
