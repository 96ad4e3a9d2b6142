"""Table 2 of Rajchandar et al. (2021), the cells that searches examine, beside what they examine here.

    python benchmarks/cells_examined.py [--queries 30]

The paper's six environments of 10 x 10 cells are lost; those of `small_environment` stand in for them. The
counts of the rivals in the paper are those of the demo of PathFinding.js, which adds up the cells that are opened, closed and,
by jumps, tested: each cell counts twice or more. That of quadrant selection is the authors' own tally. So two numbers stand
here for each search: operations, counted as the demo does, and for quadrant selection each test of a step; and distinct free
cells, each counted once whatever is done with it, which are the ones to compare. PACE is the paper's share of a rival's cells
that quadrant selection saves, in per cent, from the printed counts and from distinct cells here. On the shipped maps all are
medians over random queries at least a third of the map apart, with the robot's radius inflated.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import (
    AStar,
    BestFirst,
    BreadthFirst,
    Dijkstra,
    JumpPointSearch,
    OrthogonalJumpPointSearch,
    QuadrantSelection,
)
from pymoo_gridpath.maps import load_map, shipped_maps
from pymoo_gridpath.problems import SMALL_ENVIRONMENTS, small_environment
from pymoo_gridpath.representations import CellSequence
from pymoo_gridpath.testing.enumeration import query_on
from pymoo_gridpath.testing.reference import length

# As printed, in the order of `searches`; quadrant selection last. First the cells examined, then the lengths of paths.
PUBLISHED = {
    "spiral": (68, 92, 92, 66, 92, 70, 49),
    "caved": (109, 164, 164, 77, 118, 156, 68),
    "warehouse-alike": (43, 150, 145, 43, 67, 174, 21),
    "zigzag": (92, 112, 112, 71, 75, 120, 60),
    "random": (68, 186, 186, 52, 110, 313, 62),
    "narrow way": (76, 152, 152, 53, 94, 117, 60),
}
PUBLISHED_LENGTHS = {
    "spiral": (27.9, 27.9, 27.9, 27.9, 27.9, 32, 27.9),
    "caved": (17.07, 17.07, 17.07, 17.07, 17.07, 20, 16.72),
    "warehouse-alike": (12.31, 12.31, 12.31, 12.31, 12.31, 17, 12.313),
    "zigzag": (17.31, 17.31, 17.31, 17.31, 17.31, 22, 16.731),
    "random": (13.31, 13.31, 13.1, 13.9, 13.31, 18, 12.95),
    "narrow way": (14.31, 14.31, 14.31, 15.49, 14.31, 19, 13.82),
}


def searches() -> dict[str, Any]:
    """Return new planners: the paper's rivals, with Manhattan distance where they estimate, as in the demo, and its method."""
    return {
        "A*": AStar("manhattan"),
        "Dijkstra": Dijkstra(),
        "breadth-first": BreadthFirst(),
        "best-first": BestFirst("manhattan"),
        "JPS": JumpPointSearch("manhattan"),
        "orthogonal JPS": OrthogonalJumpPointSearch(),
        "QSA": QuadrantSelection(),
        "A* octile": AStar("octile"),
    }


def examine(grid: OccupancyGrid, start, goal) -> dict[str, tuple[int, int, float]]:
    """Return operations, distinct cells and the length of the path of each search, any-angle of quadrant selection."""
    problem = GridPathProblem(grid, start, goal, CellSequence(grid, start, goal, max_cells=grid.occupied.size))
    found: dict[str, tuple[int, int, float]] = {}
    for name, planner in searches().items():
        planner.plan(problem)
        what = planner.found
        if name == "QSA":
            found[name] = what.probes, what.free_cells, what.waypoints[0].length
        else:
            found[name] = what.operations, what.n_cells, length(what.cells.tolist())
    return found


def show(title: str, rows: Mapping[str, Sequence[object]]) -> None:
    """Print a table."""
    print(f"\n{title}")
    print(f"{'':16}" + "".join(f"{name:>15}" for name in searches()))
    for name, row in rows.items():
        print(f"{name:16}" + "".join(f"{value:>15}" for value in row))


def saved(cells: Sequence[float]) -> list[str]:
    """Return PACE: how many of the cells of each search quadrant selection, number 6 of them, does without, in per cent."""
    return [f"{100 * (1 - cells[6] / other):.1f}" for other in cells]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--queries", type=int, default=30, help="random queries on each shipped map (default: 30)")
    arguments = parser.parse_args()

    show("The paper's Table 2: cells examined", PUBLISHED)
    show("The paper's Table 2: lengths", PUBLISHED_LENGTHS)
    show("PACE of the paper's counts", {name: saved(row) for name, row in PUBLISHED.items()})
    for corner_cutting in (True, False):
        stated = f"Stand-ins, corners {'may' if corner_cutting else 'may not'} be cut"
        found = {name: list(examine(*small_environment(name, corner_cutting)).values()) for name in SMALL_ENVIRONMENTS}
        show(f"{stated}: operations / distinct cells", {name: [f"{a} / {b}" for a, b, _ in row] for name, row in found.items()})
        show(f"{stated}: lengths", {name: [f"{of:.2f}" for _, _, of in row] for name, row in found.items()})
        show(f"{stated}: PACE", {name: saved([b for _, b, _ in row]) for name, row in found.items()})
    rng = np.random.default_rng(1)
    medians: dict[str, np.ndarray] = {}
    for item in shipped_maps():
        grid = load_map(item.path).inflate(item.radius)
        found_here: list[list] = []
        while len(found_here) < arguments.queries:
            query = query_on(grid, rng, apart=1 / 3)
            if query is not None:
                found_here.append(list(examine(*query).values()))
        medians[item.name] = np.median(found_here, axis=0)
    stated = f"Shipped maps, {arguments.queries} queries each"
    show(
        f"{stated}: operations / distinct cells", {name: [f"{a:g} / {b:g}" for a, b, _ in row] for name, row in medians.items()}
    )
    show(f"{stated}: lengths", {name: [f"{of:.2f}" for _, _, of in row] for name, row in medians.items()})
    show(f"{stated}: PACE", {name: saved(row[:, 1].tolist()) for name, row in medians.items()})


if __name__ == "__main__":
    main()
