"""Section 2.1: the coding of Sugihara and Smith beside the paper's three.

Each run has a random scenario of its own, the same for all codings. What is measured is the hypervolume of its legal paths over
that of the exact front of all paths that never turn back. The figure is the paper's second: its two paths, and what the coding
of Sugihara and Smith makes of their binary genes, as it ignores every climb after a diagonal step.
"""

from __future__ import annotations

import numpy as np

from paper_sections.base import Settings, corners, draw_map, exact, median, one_each, progress, ratio, show
from pymoo_gridpath import OccupancyGrid
from pymoo_gridpath.representations import make_representation
from pymoo_gridpath.study.report.statistics.significance import wilcoxon

CODINGS = {"sugihara-smith": "restrictive", "binary": "better", "mixed": "more efficient", "integer": "the best"}

# Fig. 2.
PATHS = {
    "Path 1": "000 11-010 11-000 10-000 00-001 00-000 10-000 11",
    "Path 2": "101 11-000 01-000 11-000 00-001 00-000 11-001 11",
}


def run(settings: Settings) -> None:
    grids = [settings.random(16, 0.2, seed) for seed in range(1, settings.n_runs(11, 31) + 1)]
    fronts = [exact(grid) for grid in grids]
    ratios, rows = {}, []
    for name, published in CODINGS.items():
        found = one_each(settings, grids, representation=name)
        ratios[name] = np.array([ratio(one, front) for one, front in zip(found, fronts, strict=True)])
        legal = sum(one.feasible for one in found)
        rows.append([name, published, median(ratios[name]), f"{legal} of {len(grids)}"])
        progress(*rows[-1])
    for row, values in zip(rows, ratios.values(), strict=True):
        difference = ratios["integer"] - values
        row.append(f"{wilcoxon(difference).p:.2g}" if difference.any() else "")
    show(
        f"random {grids[0].width} x {grids[0].width}, p0 = 0.2: {len(grids)} runs of each, on a scenario each",
        ("coding", "published, in words", "hypervolume ratio", "runs with a legal path", "p against integer (Wilcoxon)"),
        rows,
    )
    grid = OccupancyGrid(np.zeros((8, 8)), corner_cutting=True)
    for name, bits in PATHS.items():
        X = np.array([[bit == "1" for bit in bits if bit in "01"]])
        paths = {coding: make_representation(coding, *corners(grid)).decode(X) for coding in ("binary", "sugihara-smith")}
        labels = {f"{name}, {coding}": path.cells(0) for coding, path in paths.items()}
        draw_map(settings, f"section-2.1-figure-2-{name.lower().replace(' ', '-')}", grid, labels)
