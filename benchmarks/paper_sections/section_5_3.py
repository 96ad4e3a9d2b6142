"""Section 5.3: binary, mixed and integer coding on 32 x 32 cells with 173 obstacles, ten runs each, merged.

The tests are those of Mann and Whitney, over the runs.
"""

from __future__ import annotations

import numpy as np

from paper_sections.base import (
    LOOKS,
    Runs,
    Settings,
    draw_set,
    exact,
    median,
    progress,
    ratio,
    several,
    show,
)
from pymoo_gridpath.plotting.fronts import staircase
from pymoo_gridpath.plotting.style import figure_style, fix_ticks, new_axes
from pymoo_gridpath.quality import ReferenceFront
from pymoo_gridpath.study.report.statistics.significance import mann_whitney

CODINGS = {"integer": "clearly better", "mixed": "between", "binary": "consistently poor"}


def run(settings: Settings) -> None:
    grid, n_runs = settings.scattered(32, 173, 1), settings.n_runs(10, 31)
    truth, found, rows = exact(grid), {}, []
    for name, published in CODINGS.items():
        runs = found[name] = several(settings, grid, n_runs, representation=name)
        ratios = runs.ratios(truth)
        p = mann_whitney(found["integer"].ratios(truth), ratios).p
        legal = sum(one.feasible for one in runs.each)
        rows.append(
            (
                name,
                published,
                median(ratios),
                f"{ratio(runs.merged, truth):.4f}",
                f"{legal} of {n_runs}",
                "" if name == "integer" else f"{p:.2g}",
            )
        )
        progress(*rows[-1])
    show(
        f"{grid.name}, {grid.n_occupied} obstacles (the published layout is lost), {n_runs} runs of each",
        (
            "coding",
            "published, in words",
            "hypervolume ratio",
            "merged",
            "with a legal path",
            "p against integer",
        ),
        rows,
    )
    if settings.output:
        draw_all(settings, found, truth)
    draw_set(settings, "section-5.3-figure-4", found["integer"].merged, truth)


def draw_all(settings: Settings, found: dict[str, Runs], truth: ReferenceFront) -> None:
    """Draw the fronts of all runs beside the exact one."""
    with figure_style(None):
        ax = new_axes((4.4, 3.3))
        # Those of the later codings are rings around those of the first, since many points are the same.
        for k, ((name, runs), look) in enumerate(zip(found.items(), LOOKS, strict=False)):
            legal = [one.F for one in runs.each if one.feasible]
            if legal:
                points, fill = np.concatenate(legal), "none" if k else "full"
                ax.plot(*points.T, look.marker, color=look.color, markersize=3 + 2 * k, fillstyle=fill, label=name)
        ax.plot(*staircase(truth.points).T, "k-", linewidth=0.8, label="exact front")
        ax.set(xlabel="Path length [cells]", ylabel="Path vulnerability")
        ax.legend()
        fix_ticks(ax)
    settings.save(ax, "section-5.3-figure-3")
