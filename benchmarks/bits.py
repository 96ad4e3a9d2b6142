"""Whether results have kept their bits: 100 small runs of search and exact fronts, each as a digest of its genes and values.

Run it on one version of the package, keep the output, and hold another version against it:

    python benchmarks/bits.py --write bits.json
    python benchmarks/bits.py --against bits.json

Runs differ in algorithm, representation, operators, objectives, treatment of obstacles, corner rule, grid and seed. Each level
of each occurs several times. All is named, so that a change of a default is no change of a result.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import warnings
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import make_algorithm
from pymoo_gridpath.maps import load_map
from pymoo_gridpath.objectives import Vulnerability
from pymoo_gridpath.operators import default_operators, path_operators

N_RUNS = 100

ALGORITHMS = (
    "NSGA2",
    "SPEA2",
    "MOEAD",
    "ParallelMOEAD",
    "NSGA3",
    "UNSGA3",
    "DNSGA2",
    "SMSEMOA",
    "AGEMOEA",
    "CTAEA",
    "RVEA",
    "OmniOptimizer",
    "GDE3",
    "NSDE",
    "exact",
)
# The same seed does not give these the same result with constraints.
UNSEEDED_WITH_CONSTRAINTS = ("NSGA3", "UNSGA3")
WITHOUT_CONSTRAINTS = ("ParallelMOEAD", "DNSGA2")
# Their crossover and mutation are their own.
OWN_CHILDREN = ("GDE3", "NSDE")

REPRESENTATIONS = ("integer", "binary", "mixed", "absolute", "cells")
OBJECTIVES = (("length", "vulnerability"), ("length", "turn"), ("vulnerability", "turn"), ("length", "vulnerability", "turn"))
OBSTACLES = ("penalty", "constraint", "limit")
OPERATORS = {"default": default_operators, "path": path_operators}


def configurations() -> list[tuple]:
    """Return the runs: from all combinations, each level as often as the others, in a fixed order."""
    every = list(product(ALGORITHMS, REPRESENTATIONS, OBJECTIVES, OBSTACLES, OPERATORS, (False, True), range(4)))
    order = np.random.default_rng(1).permutation(len(every))
    chosen, seen = [], {}
    for item in (every[k] for k in order):
        algorithm, _, objectives, obstacles, operators, _, _ = item
        if obstacles == "limit" and "vulnerability" not in objectives:
            continue
        if obstacles != "penalty" and algorithm in (*UNSEEDED_WITH_CONSTRAINTS, *WITHOUT_CONSTRAINTS):
            continue
        if algorithm in OWN_CHILDREN and operators == "path":
            continue
        if seen.get(algorithm, 0) <= len(chosen) // len(ALGORITHMS):
            chosen.append(item)
            seen[algorithm] = seen.get(algorithm, 0) + 1
        if len(chosen) == N_RUNS:
            break
    return chosen


def grid_of(corner_cutting: bool, number: int) -> OccupancyGrid:
    """Return one of eight grids on which every representation finds a path from corner to corner."""
    if number == 0:
        return load_map("warehouse", corner_cutting=corner_cutting)
    rng = np.random.default_rng(10 * number + corner_cutting)
    height, width = 14 + number, 18
    occupied = rng.random((height, width)) < 0.06 * number
    # The bottom row and the right column lead to the goal.
    occupied[0], occupied[:, -1] = False, False
    return OccupancyGrid(occupied, corner_cutting=corner_cutting)


def digest(configuration: tuple) -> str:
    """Return the digest of the final population, its values and the front of one run."""
    algorithm, representation, objectives, obstacles, operators, corner_cutting, number = configuration
    grid = grid_of(corner_cutting, number)
    goal = (grid.width - 1, grid.height - 1)
    limit = 40.0 if obstacles == "limit" else None
    # The paper's, also on a map in metres.
    named = [Vulnerability(variance=0.5) if name == "vulnerability" else name for name in objectives]
    problem = GridPathProblem(grid, (0, 0), goal, representation, named, obstacles, potential_limit=limit)
    if algorithm == "exact":
        made = make_algorithm("exact", problem)
    else:
        given = {} if algorithm in OWN_CHILDREN else {"operators": OPERATORS[operators](problem)}
        made = make_algorithm(algorithm, problem, pop_size=24, **given)
    result: Any = minimize(problem, made, ("n_gen", 12), seed=number + 1, return_least_infeasible=True)
    total = hashlib.sha256()
    for values in (*result.pop.get("X", "F", "turn"), result.X, result.F):
        array = np.ascontiguousarray(values)
        total.update(f"{array.dtype.kind}{array.shape}".encode() + array.tobytes())
    return total.hexdigest()[:16]


def main() -> int:
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    parser.add_argument("--write", type=Path, metavar="FILE", help="where the digests go")
    parser.add_argument("--against", type=Path, metavar="FILE", help="digests of another version; says which runs differ")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    digests = {}
    for configuration in configurations():
        digests[" ".join(map(str, configuration))] = digest(configuration)
    if arguments.write:
        arguments.write.write_text(json.dumps(digests, indent=1))
    print(f"{len(digests)} runs, {len(set(digests.values()))} different results")
    if not arguments.against:
        return 0
    before = json.loads(arguments.against.read_text())
    assert before.keys() == digests.keys(), "the other file has other runs"
    changed = [name for name, value in digests.items() if before[name] != value]
    print(*(f"changed: {name}" for name in changed), sep="\n", end="\n" if changed else "")
    print(f"{len(digests) - len(changed)} of {len(digests)} are identical")
    return bool(changed)


if __name__ == "__main__":
    sys.exit(main())
