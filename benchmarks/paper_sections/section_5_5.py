"""Section 5.5: each objective alone against both.

On a sparse grid of 16 x 16 cells a genetic algorithm minimises the length, or the vulnerability, and what it finds is compared
with the ends of the front of the two-objective runs, and with the truth. Then 64 x 64 cells with 791 obstacles, each run on a
scenario of its own, the same one for all methods: the paper compares two objectives and a penalty with one objective and a
constraint, so that what differs is two things; one objective with a penalty tells them apart.
"""

from __future__ import annotations

import numpy as np

from paper_sections.base import (
    LENGTH,
    TWO,
    VULNERABILITY,
    Ended,
    Settings,
    against,
    draw_map,
    exact,
    median,
    progress,
    several,
    share,
    show,
    until_legal,
)
from pymoo_gridpath.decision import TradeOffSet

SIDE, N_OBSTACLES = 64, 791
# What is minimised, how obstacles are treated, and the paper's share of runs that found a legal path.
METHODS = [
    ("two objectives, penalty", TWO, "penalty", "80 %"),
    ("length, constraint", LENGTH, "constraint", "0 of 10"),
    ("vulnerability, constraint", VULNERABILITY, "constraint", "0 of 10"),
    ("length, penalty", LENGTH, "penalty", "-"),
    ("vulnerability, penalty", VULNERABILITY, "penalty", "-"),
]


def run(settings: Settings) -> None:
    sparse(settings)
    dense(settings)


def sparse(settings: Settings) -> None:
    grid, n_runs = settings.random(16, 0.1, 1), settings.n_runs(10, 10)
    both, truth = several(settings, grid, n_runs), exact(grid).points.min(axis=0)
    alone = {name: several(settings, grid, n_runs, objectives=(name,)) for name in TWO}
    rows = []
    for k, (name, one) in enumerate(alone.items()):
        values = [[least(found, column) for found in (runs.merged, *runs.each)] for runs, column in ((one, 0), (both, k))]
        hits = [f"{sum(value <= truth[k] + 1e-9 for value in found[1:])} of {n_runs}" for found in values]
        rows.append((name, "alike", *(f"{found[0]:.4f}" for found in values), f"{truth[k]:.4f}", *hits))
    show(
        f"{grid.name}, {grid.n_occupied} obstacles (the published layout is lost): the least of {n_runs} runs",
        ("objective", "published", "alone", "end of the front", "exact", "alone: runs that reach it", "both: runs"),
        rows,
    )
    paths = {f"least {name}": found.merged[0].cells for name, found in alone.items()}
    draw_map(settings, "section-5.5-figure-7a", grid, paths)


def least(found: TradeOffSet, column: int) -> float:
    """Return the least value of an objective of legal paths."""
    return found.F[:, column].min() if found.feasible else np.inf


def dense(settings: Settings) -> None:
    grids = [settings.scattered(SIDE, N_OBSTACLES, seed) for seed in range(1, settings.n_runs(10, 100) + 1)]
    found: dict[str, list[Ended]] = {}
    rows = []
    for name, objectives, obstacles, published in METHODS:
        found[name] = runs = until_legal(settings, grids, objectives=objectives, obstacles=obstacles)
        successes = [one for one in runs if one.found]
        first, here = (np.array([one.found for one in some]) for some in (found[METHODS[0][0]], runs))
        rows.append(
            (
                name,
                published,
                share(len(successes), len(runs)),
                median([one.generations for one in successes], 0),
                max(one.crossed for one in runs),
                against(first, here) if len(found) > 1 else "",
            )
        )
        progress(*rows[-1])
    show(
        f"{grids[0].name}, {grids[0].n_occupied} obstacles: {len(grids)} runs of each, on a scenario each",
        (
            "method",
            "published",
            "found a legal path",
            "generations until then",
            "most cells crossed",
            "the first alone : this alone",
        ),
        rows,
    )
    names = [name for name, _, obstacles, _ in METHODS if obstacles == "constraint"]
    paths = {f"{name}:\ncrosses {found[name][0].crossed} obstacles": found[name][0].cells for name in names}
    draw_map(settings, "section-5.5-figure-7b", grids[0], paths)
