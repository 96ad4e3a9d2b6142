"""Section 4.1: obstacles as penalty, constraint and potential limit, with one objective and two, sparse and dense.

The paper shows no figures here. In words: constraints do on sparse grids, and fail on dense ones with a single objective; the
penalty is better. Each run ends with its first legal path, and has a scenario of its own, the same for all treatments. The
limit P0 is half of what an occupied cell adds, the number of cells. It is one on the vulnerability, and so not for the length
alone.
"""

from __future__ import annotations

import numpy as np

from paper_sections.base import LENGTH, TWO, VULNERABILITY, Settings, against, median, progress, share, show, until_legal

# Cells a side and p0.
SCENARIOS = {"sparse": (16, 0.1), "dense": (32, 0.5)}
TREATMENTS = ("penalty", "constraint", "limit")


def run(settings: Settings) -> None:
    for density, (side, p0) in SCENARIOS.items():
        grids = [settings.random(side, p0, seed) for seed in range(1, settings.n_runs(10, 100) + 1)]
        rows = []
        for objectives in (TWO, LENGTH, VULNERABILITY):
            penalised = None
            for obstacles in TREATMENTS:
                if obstacles == "limit" and objectives == LENGTH:
                    continue
                limit = {"potential_limit": grids[0].occupied.size / 2} if obstacles == "limit" else {}
                runs = until_legal(settings, grids, objectives=objectives, obstacles=obstacles, **limit)
                found = np.array([one.found for one in runs])
                generations = median([one.generations for one in runs if one.found], 0)
                published = "works" if density == "sparse" or obstacles == "penalty" else "-"
                if (density, obstacles) == ("dense", "constraint") and objectives != TWO:
                    published = "fails"
                test = "" if penalised is None else against(penalised, found)
                penalised = found if penalised is None else penalised
                rows.append((" and ".join(objectives), obstacles, published, share(found.sum(), len(found)), generations, test))
                progress(density, *rows[-1])
        show(
            f"{density}: {grids[0].name}, {len(grids)} runs of each, on a scenario each",
            (
                "objectives",
                "obstacles",
                "published",
                "found a legal path",
                "generations",
                "penalty alone : this alone",
            ),
            rows,
        )
