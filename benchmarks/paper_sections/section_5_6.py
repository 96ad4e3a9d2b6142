"""Section 5.6: turn as a third objective, by the original NSGA-II; does it lose the shortest path?

On the sparse scenario of section 5.4 and the one of section 5.3. What is asked of each run: whether it ends with a path as
short as the shortest, how much its paths turn at least, and what its projection on length and vulnerability holds of the exact
front of these.
"""

from __future__ import annotations

import numpy as np
from scipy import stats

from paper_sections.base import LENGTH, TWO, Runs, Settings, draw_map, exact, median, progress, several, share, show
from pymoo_gridpath.decision import TradeOffSet
from pymoo_gridpath.plotting import plot_front
from pymoo_gridpath.plotting.style import figure_style
from pymoo_gridpath.quality import ReferenceFront

THREE = (*TWO, "turn")


def run(settings: Settings) -> None:
    n_runs = settings.n_runs(10, 31)
    for grid in (settings.random(16, 0.1, 1), settings.scattered(32, 173, 1)):
        truth, shortest = exact(grid), exact(grid, LENGTH).points[0, 0]
        found = {name: several(settings, grid, n_runs, objectives=name) for name in (TWO, THREE)}
        hits = {
            name: sum(one.feasible and one.F[:, 0].min() <= shortest + 1e-9 for one in runs.each)
            for name, runs in found.items()
        }
        rows = []
        for name, runs in found.items():
            rows.append(
                (
                    ", ".join(name),
                    "kept" if name == TWO else "lost",
                    share(hits[name], n_runs),
                    median([projected(one, truth) for one in runs.each]),
                    f"{projected(runs.merged, truth):.4f}",
                    median([least_turn(one) for one in runs.each], 0),
                    f"{least_turn(runs.merged):.0f}",
                )
            )
            progress(*rows[-1])
        p = stats.fisher_exact([[hits[name], n_runs - hits[name]] for name in found])[1]
        show(
            f"{grid.name}, {grid.n_occupied} obstacles, {n_runs} runs of each: the shortest path, p = {p:.2g} (Fisher)",
            ("objectives", "published", "runs that end with it", "ratio, projected", "merged", "least turn", "merged"),
            rows,
        )
        draw(settings, f"section-5.6-{grid.width}", found, truth)


def projected(found: TradeOffSet, truth: ReferenceFront) -> float:
    """Return the hypervolume of legal paths in length and vulnerability alone over that of the exact front."""
    return truth.hypervolume_ratio(found.F[:, :2] if found.feasible else found.F[:0, :2])


def least_turn(found: TradeOffSet) -> float:
    """Return the least turn of legal paths, in degrees."""
    return float(np.min(found.paths.turn)) if found.feasible else np.inf


def draw(settings: Settings, name: str, found: dict[tuple, Runs], truth: ReferenceFront) -> None:
    three = found[THREE].merged
    if not settings.output or not three.feasible:
        return
    settings.save(plot_front(three), f"{name}-figure-8a")
    ax = plot_front(three, objectives=TWO)
    with figure_style(ax):
        ax.plot(*truth.points.T, "k+", markersize=6, label="exact front of two objectives", zorder=5)
        # What is named is labelled at its point.
        handles = [
            one for one in (*ax.collections, *ax.lines) if one.get_label() in ("trade-off paths", ax.lines[-1].get_label())
        ]
        ax.legend(handles=handles, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
    settings.save(ax, f"{name}-figure-8b")
    draw_map(settings, f"{name}-figure-9", three.problem.grid, {"path H, the smoothest": three.smoothest.cells})
