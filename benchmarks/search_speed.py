"""Processor time of A* and of quadrant selection beside that of Dijkstra's search, kernel by kernel, alternating in one run.

    python benchmarks/search_speed.py MAP [--queries 50] [--repeats 5]

MAP is a map file, such as lak304d.map of the MovingAI benchmark, or the name of a shipped map. Queries are random pairs of
cells that a path joins. Two compiled searches stand for Dijkstra's: the kernel that finds the costs from all cells to one, of
which bounds are made (`backward_costs`), and the one that stops at the goal, as the planner "dijkstra". Each query takes the
least time of all repeats. Planners are timed from a problem that is made to the genes of the path, without its evaluation.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np

from pymoo_gridpath import GridPathProblem
from pymoo_gridpath.algorithms import AStar, JumpPointSearch, QuadrantSelection
from pymoo_gridpath.compiled import COMPILED
from pymoo_gridpath.maps import load_map
from pymoo_gridpath.neighbourhood import DIAGONAL as IS_DIAGONAL
from pymoo_gridpath.search.counted import DIAGONAL, STRAIGHT, best_first
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.shortest import backward_costs


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("map", help="a map file, or the name of a shipped map")
    parser.add_argument("--queries", type=int, default=50)
    parser.add_argument("--repeats", type=int, default=5)
    arguments = parser.parse_args()

    grid = load_map(arguments.map)
    moves = Moves(grid)
    rng = np.random.default_rng(1)
    free = np.argwhere(~grid.occupied)
    problems: list[GridPathProblem] = []
    while len(problems) < arguments.queries:
        (ya, xa), (yb, xb) = free[rng.choice(len(free), 2, replace=False)].tolist()
        if grid.regions[ya, xa] == grid.regions[yb, xb]:
            problems.append(GridPathProblem(grid, (xa, ya), (xb, yb), "cells"))

    lengths = np.tile(np.where(IS_DIAGONAL, DIAGONAL, STRAIGHT), (9, 1)).astype(np.int64)
    step, field = np.stack([lengths, 0 * lengths]), np.zeros((2, moves.n_cells), dtype=np.int64)

    def to_the_goal(problem: GridPathProblem, heuristic: str):
        return best_first(moves, moves.index(problem.start), moves.index(problem.goal), heuristic)

    searches: dict[str, Callable[[GridPathProblem], object]] = {
        "Dijkstra, to all cells": lambda problem: backward_costs(moves, step, field, moves.index(problem.goal)),
        "Dijkstra, to the goal": lambda problem: to_the_goal(problem, "none"),
        "A*, octile, kernel": lambda problem: to_the_goal(problem, "octile"),
        "A*, octile": AStar().plan,
        "jump points": JumpPointSearch().plan,
        "quadrant selection": QuadrantSelection().plan,
    }
    times = np.full((len(searches), len(problems), arguments.repeats + 1), np.inf)
    for k in range(arguments.repeats + 1):
        for j, problem in enumerate(problems):
            for i, search in enumerate(searches.values()):
                begin = time.process_time()
                search(problem)
                times[i, j, k] = time.process_time() - begin
    # Kernels are compiled, and caches filled, in the first round.
    least = times[:, :, 1:].min(axis=2)
    print(f"{grid.name}: {grid.width} x {grid.height}, {len(problems)} queries, kernels {'' if COMPILED else 'not '}compiled")
    for name, row in zip(searches, least, strict=True):
        ratios = [f"{row.sum() / least[i].sum():.2f} and {np.median(row / least[i]):.2f}" for i in range(2)]
        print(f"  {name:24} {row.mean() * 1e3:7.3f} ms in the mean; share of each Dijkstra's: {'; '.join(ratios)}")
    print("shares: of the sums of times, and the median of those query by query")


if __name__ == "__main__":
    main()
