"""Section 5.4: the front of two objectives, ten runs merged.

The layouts of the paper's Fig. 5 and 6 are lost with the figures, and so is the path of Castillo and Trujillo beside which it
puts its own. The shipped field `paper16` stands for the benchmark of 16 x 16 cells, random scenarios of 16 and 32 cells a side
for the sparse one.
"""

from __future__ import annotations

from paper_sections.base import TWO, Settings, draw_set, exact, median, ratio, several, show
from pymoo_gridpath.maps import load_shipped


def run(settings: Settings) -> None:
    n_runs, rows = settings.n_runs(10, 31), []
    # From corner to corner, as it says itself.
    grids = {
        "5": load_shipped("paper16"),
        "6": settings.random(16, 0.1, 1),
        "6, 32 a side": settings.random(32, 0.1, 1),
    }
    for figure, grid in grids.items():
        runs, truth = several(settings, grid, n_runs), exact(grid)
        merged = runs.merged
        ends = [
            "yes" if merged.feasible and merged.F[:, k].min() <= truth.points[:, k].min() + 1e-9 else "no"
            for k in range(len(TWO))
        ]
        n_exact = round(truth.share_found(merged.F) * len(truth)) if merged.feasible else 0
        measured = f"{n_exact} of {len(truth)}", median(runs.ratios(truth)), f"{ratio(merged, truth):.4f}"
        rows.append((figure, grid.name, "a front with a knee", *measured, *ends))
        draw_set(settings, f"section-5.4-figure-{figure.replace(', ', '-').replace(' ', '-')}", merged, truth)
    show(
        f"{n_runs} runs of each, merged (the published layouts are lost)",
        ("figure", "grid", "published", "exact points", "ratio of a run", "merged", "shortest", "safest"),
        rows,
    )
