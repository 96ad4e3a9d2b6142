"""Keys of runs as they were before studies took things of one's own: what is stored stays valid."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.study import ProblemSpec, Study, plan_study

KEYS = json.loads((Path(__file__).parent / "keys.json").read_text(encoding="utf-8"))


def test_keys_of_runs_stay():
    occupied = np.zeros((6, 9))
    occupied[2, 3] = occupied[3, 4] = 1
    grid = OccupancyGrid(occupied)
    query = {"start": (0, 0), "goal": (8, 5)}
    paper = {"base": "paper", "crossover": {"class": "DiscreteSBX", "eta": 5}}
    limit = {"obstacles": "limit", "potential_limit": 3.0}
    one = Study(
        problems=[
            {"name": "r", "random": {"size": 8, "p0": 0.2, "seeds": 2}, "representation": "integer"},
            ProblemSpec(name="l", grid=grid, representation="mixed", **query, **limit),
        ],
        algorithms=[
            {"algorithm": "NSGA2"},
            {"algorithm": "exact"},
            {"algorithm": "SPEA2", "pop_size": 20, "operators": "random", "name": "s"},
            {"algorithm": "NSGA2", "name": "ops", "operators": paper, "parameters": {"n_offsprings": 40}},
            {"algorithm": "RVEA", "pop_size": 16, "name": "rv"},
            {"preset": "ahmed-deb-2013", "pop_size": 30},
            {"algorithm": "NSGA2", "name": "over", "representation": "cells", "axis": "auto", "smoothness": False},
        ],
        seeds=[1, 7],
        budget={"evaluations": 400},
    )
    free = {"representation": "cells", "objectives": ["length", "turn"], "obstacles": "constraint"}
    absolute = {"representation": "absolute", "obstacles": "constraint", "axis": "x"}
    other = Study(
        problems=[
            {"name": "c", "random": {"size": 8, "p0": 0.2, "seeds": 1}, **free},
            ProblemSpec(name="d", grid=grid.replace(corner_cutting=False), **query, **absolute),
        ],
        algorithms=[
            {"algorithm": "NSGA2", "operators": "scalarized"},
            {"algorithm": "GDE3", "pop_size": 20},
            {"algorithm": "exact", "max_seconds": 5.0},
            {"preset": "ahmed-deb-2013"},
        ],
        seeds=2,
        budget={"generations": 5},
        reference=False,
    )
    found = []
    for plan in map(plan_study, (one, other)):
        for run in plan.runs:
            label = None if run.algorithm is None else plan.algorithms[run.algorithm].label
            found.append([plan.problems[run.problem].label, label, run.seed, run.key])
    assert found == KEYS
