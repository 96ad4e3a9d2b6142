"""Section 6: dense grids, Table 1, and 64 x 64 and 128 x 128 cells.

The paper's method, ended by its first legal path, on 64 x 64 cells with 791 obstacles and on 128 x 128 with 4,979, which is
30 % of the cells and not 91; there, path-aware operators beside it, by the hypervolume that they find in 20,000 evaluations. On
one of the scenarios of 64 x 64 cells ten runs go on to the end and are merged, as the paper does in section 5.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from pymoo.optimize import minimize
from table1 import SIZES, table

from paper_sections.base import (
    Settings,
    corners,
    draw_map,
    draw_set,
    exact,
    median,
    progress,
    ratio,
    several,
    share,
    show,
    until_legal,
)
from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import ahmed_deb_2013, make_algorithm
from pymoo_gridpath.decision import TradeOffSet
from pymoo_gridpath.operators import path_operators

# Cells a side, obstacles, and what the paper found.
LARGE = [(64, 791, "80 %"), (128, 4979, "one path")]
# Members, evaluations and runs of the path-aware searches.
POP_SIZE, N_EVALUATIONS, N_RUNS = 200, 20_000, 11


def run(settings: Settings) -> None:
    sizes = [size for size in SIZES if size <= settings.largest]
    pop_size, n_gen = settings.members or 200, settings.size["n_gen"]
    table(settings.pool, sizes, n_runs=settings.n_runs(10, 100), n_gen=n_gen, pop_size=pop_size)
    large(settings)
    merged(settings)
    path_aware(settings)


def large(settings: Settings) -> None:
    rows = []
    for side, n_obstacles, published in LARGE:
        grids = [settings.scattered(side, n_obstacles, seed) for seed in range(1, settings.n_runs(10, 100) + 1)]
        runs = until_legal(settings, grids)
        found = [one for one in runs if one.found]
        generations = median([one.generations for one in found], 0)
        fewest = min(one.crossed for one in runs)
        rows.append((grids[0].name, grids[0].n_occupied, published, share(len(found), len(runs)), generations, fewest))
        progress(*rows[-1])
        best = min(range(len(runs)), key=lambda k: runs[k].crossed)
        label = f"crosses {runs[best].crossed} obstacles\nafter {runs[best].generations} generations"
        draw_map(settings, f"section-6-figure-11-{side}", grids[best], {label: runs[best].cells})
    show(
        "the paper's method, a scenario for each run",
        ("grid", "obstacles", "published", "found a legal path", "generations until then", "fewest cells crossed"),
        rows,
    )


def merged(settings: Settings) -> None:
    grid, n_runs = settings.scattered(64, 791, 1), settings.n_runs(10, 10)
    runs, truth = several(settings, grid, n_runs), exact(grid)
    legal = sum(one.feasible for one in runs.each)
    ratios = median(runs.ratios(truth)), f"{ratio(runs.merged, truth):.4f}"
    show(
        f"one of the scenarios of {grid.name} cells, {n_runs} runs to the end, merged",
        ("method", "with a legal path", "hypervolume ratio of a run", "merged"),
        [("the paper's", f"{legal} of {n_runs}", *ratios)],
    )
    draw_set(settings, "section-6-merged", runs.merged, truth)


def path_aware(settings: Settings) -> None:
    grid, n_runs, rows = settings.scattered(128, 4979, 1), settings.runs or N_RUNS, []
    truth = exact(grid)
    for sampling in ("scalarized", "random"):
        search = partial(_search, grid, sampling, settings.members or POP_SIZE, settings.generations)
        found = [TradeOffSet.from_genes(_problem(grid), X) for X in settings.pool.map(search, range(1, n_runs + 1))]
        ratios = np.array([ratio(one, truth) for one in found])
        legal = sum(one.feasible for one in found)
        rows.append((f"path-aware, {sampling} start", f"{legal} of {n_runs}", median(ratios), f"{ratios.min():.4f}"))
        progress(*rows[-1])
    n_eval = (settings.members or POP_SIZE) * settings.generations if settings.generations else N_EVALUATIONS
    show(
        f"{grid.name}, {grid.n_occupied} obstacles, {len(truth)} points on the exact front, {n_eval:,} evaluations a run",
        ("operators", "with a legal path", "hypervolume ratio", "least"),
        rows,
    )


def _problem(grid: OccupancyGrid) -> GridPathProblem:
    return ahmed_deb_2013(*corners(grid)).problem


def _search(grid: OccupancyGrid, sampling: Any, pop_size: int, n_gen: int | None, seed: int) -> np.ndarray:
    problem = _problem(grid)
    algorithm = make_algorithm("NSGA2", problem, pop_size, operators=path_operators(problem, sampling))
    result = minimize(problem, algorithm, ("n_gen", n_gen) if n_gen else ("n_eval", N_EVALUATIONS), seed=seed)
    return TradeOffSet.from_results(result).X
