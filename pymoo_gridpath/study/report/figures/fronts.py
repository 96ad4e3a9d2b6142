"""Figures of fronts in the plane of the first two objectives: attainment surfaces and merged fronts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import moocore
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from pymoo_gridpath.plotting.style import label_axis
from pymoo_gridpath.quality import SAME, ReferenceFront, merge_fronts
from pymoo_gridpath.study.report.figures.style import REFERENCE, AlgorithmStyle, legend_above, panel_figure, panel_title
from pymoo_gridpath.study.report.results import Results
from pymoo_gridpath.study.specification.kinds import is_maximised, objective_axis

# Lines of attainment surfaces, which differ in grey print too.
_BENEATH: dict[str, Any] = {"color": "#bcc0c6", "linewidth": 2.8, "solid_joinstyle": "miter"}
_BEST: dict[str, Any] = {"linewidth": 0.9, "linestyle": (0, (0.9, 1.3))}
_WORST: dict[str, Any] = {"linewidth": 0.8, "linestyle": (0, (6, 2))}
# The edge tells the band from the pale line beneath.
_BAND: dict[str, Any] = {"linewidth": 0.4}


def attainment_surfaces(fronts: Sequence[np.ndarray], shares: Sequence[float]) -> list[np.ndarray]:
    """Return for each share the points that at least this share of runs attain, with none of them dominated.

    Parameters
    ----------
    fronts : sequence of numpy.ndarray, each of shape (n, n_obj)
        One a run; a run without points attains nothing.
    shares : sequence of float
        0 stands for a single run.

    Returns
    -------
    list of numpy.ndarray, each of shape (K, n_obj)
        K is 0 where so many runs attain nothing together.

    References
    ----------
    Grunert da Fonseca, Fonseca and Hall (2001), Inferential performance assessment of stochastic optimisers and the attainment
    function.
    """
    found = [front for front in fronts if len(front)]
    empty = np.empty((0, fronts[0].shape[1] if len(fronts) else 0))
    if not found:
        return [empty for _ in shares]
    sets = np.repeat(np.arange(1, len(found) + 1), [len(front) for front in found])
    surfaces = moocore.eaf(np.concatenate(found), sets)
    levels = np.rint(surfaces[:, -1] * len(found) / 100.0)
    # The small amount taken off keeps 0.1 * 30 at 3.
    needed = [max(int(np.ceil(share * len(fronts) - 1e-9)), 1) for share in shares]
    return [surfaces[levels == level, :-1] if level <= len(found) else empty for level in needed]


def plot_attainment(results: Results, problem: int, styles: Sequence[AlgorithmStyle]) -> Figure | None:
    """Draw the attainment surfaces of each algorithm on a problem of two objectives; None if there is nothing to draw."""
    fronts = _fronts(results, problem)
    if len(results.plan.problems[problem].spec["objectives"]) != 2 or not fronts:
        return None
    reference = results.references[problem].front
    surfaces = {k: attainment_surfaces(found, (0.0, 0.25, 0.5, 0.75, 1.0)) for k, found in fronts.items()}
    shown = [front for found in surfaces.values() for front in found[:4]]
    low, high = _limits([reference.points, *shown])
    # Bands reach out of the plane, so that their edges do not run along its border.
    beyond = high + 0.1 * (high - low)
    figure, axes = panel_figure(len(surfaces), 4, 1.75, extra=0.45)
    for ax, (k, (best, upper, median, lower, worst)) in zip(axes, surfaces.items(), strict=True):
        color = styles[k].color
        x = np.unique(np.concatenate([upper[:, 0], lower[:, 0], [low[0], beyond[0]]]))
        between = _height(upper, x, beyond[1]), _height(lower, x, beyond[1])
        ax.fill_between(x, *between, step="post", facecolor=(color, 0.25), edgecolor=color, **_BAND)
        # Broad and pale, so that it is seen beneath surfaces that reach it.
        ax.plot(*_stairs(reference.points, low, high), **_BENEATH)
        ax.plot(*_stairs(best, low, high), color=color, **_BEST)
        ax.plot(*_stairs(worst, low, high), color=color, **_WORST)
        ax.plot(*_stairs(median, low, high), color=color, linewidth=1.1)
        legal = sum(len(front) > 0 for front in fronts[k])
        some = f"\nlegal in {legal} of {len(fronts[k])} runs" if legal < len(fronts[k]) else ""
        ax.set_title(f"{panel_title(styles[k].label)}{some}", loc="left")
    _finish(results, problem, figure, axes, low, high)
    handles = [
        Line2D([], [], **_BENEATH, label=_reference_name(reference)),
        Line2D([], [], color="black", **_BEST, label="attained by any run"),
        Line2D([], [], color="black", linewidth=1.1, label="by half of the runs"),
        Patch(facecolor=("black", 0.25), edgecolor="black", **_BAND, label="by 25 % to 75 %"),
        Line2D([], [], color="black", **_WORST, label="by all runs"),
    ]
    legend_above(figure, handles)
    return figure


def plot_fronts(results: Results, problem: int, styles: Sequence[AlgorithmStyle]) -> Figure | None:
    """Draw the merged front of each algorithm's runs on a problem beside the reference; None if there is nothing to draw."""
    fronts = _fronts(results, problem)
    n_obj = len(results.plan.problems[problem].spec["objectives"])
    if n_obj < 2 or not fronts:
        return None
    reference = results.references[problem].front
    merged = {k: merge_fronts(found) for k, found in fronts.items()}
    low, high = _limits([reference.points, *merged.values()])
    figure, axes = panel_figure(len(merged), 4, 1.85, extra=0.45)
    for ax, (k, front) in zip(axes, merged.items(), strict=True):
        if n_obj == 2:
            ax.plot(*_stairs(reference.points, low, high), color=REFERENCE, linewidth=0.7, zorder=1)
        ax.scatter(*reference.points[:, :2].T, s=18, facecolors="none", edgecolors=REFERENCE, linewidths=0.6, zorder=2)
        ax.scatter(*front[:, :2].T, s=9, color=styles[k].color, linewidths=0, marker=styles[k].marker, zorder=3)
        found = f"{_found(reference, front)} of {len(reference)} points"
        ax.set_title(f"{panel_title(styles[k].label)}\n{found}", loc="left")
    _finish(results, problem, figure, axes, low, high)
    ring = {"marker": "o", "markersize": 4, "markerfacecolor": "none", "linestyle": "-" if n_obj == 2 else ""}
    handles = [
        Line2D([], [], color=REFERENCE, linewidth=0.7, **ring, label=_reference_name(reference)),
        Line2D([], [], color="black", marker="o", markersize=3, linestyle="", label="all runs of the algorithm, merged"),
    ]
    legend_above(figure, handles)
    return figure


def _fronts(results: Results, problem: int) -> dict[int, list[np.ndarray]]:
    """Return the fronts of the finished runs of each algorithm of which some run has one, besides the exact one."""
    fronts = {}
    for k in range(len(results.algorithms)):
        found = [run.F for run in results.finished(k, [problem]) if run.F is not None]
        if any(len(front) for front in found) and not results.is_deterministic(k):
            fronts[k] = found
    return fronts


def _reference_name(reference: ReferenceFront) -> str:
    return "exact front" if reference.exact else "merged front of all algorithms (not exact)"


def _found(reference: ReferenceFront, front: np.ndarray) -> int:
    return round(reference.share_found(front) * len(reference))


def _limits(fronts: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners of the plane that holds all points, with some room around them."""
    points = np.concatenate([front[:, :2] for front in fronts if len(front)])
    low, high = points.min(axis=0), points.max(axis=0)
    room = np.where(high - low > SAME * np.abs(high), 0.06 * (high - low), 1.0)
    return low - room, high + room


def _stairs(front: np.ndarray, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the border of what a front of two objectives attains, within the corners of a plane."""
    if not len(front):
        return np.empty(0), np.empty(0)
    x, y = front[np.argsort(front[:, 0], kind="stable")].T
    return np.append(np.repeat(x, 2), high[0]), np.append(high[1], np.repeat(y, 2))


def _height(front: np.ndarray, x: np.ndarray, top: float) -> np.ndarray:
    """Return the least second objective attained at values of the first, no more than `top`."""
    if not len(front):
        return np.full(len(x), top)
    front = front[np.argsort(front[:, 0], kind="stable")]
    least = np.minimum.accumulate(front[:, 1])
    place = np.searchsorted(front[:, 0], x, side="right") - 1
    return np.minimum(np.where(place >= 0, least[place], top), top)


def _finish(results: Results, problem: int, figure: Figure, axes, low: np.ndarray, high: np.ndarray) -> None:
    spec = results.plan.problems[problem].spec
    labels = ["", ""]
    for ax in axes:
        labels = [
            label_axis(axis, label, is_maximised(name), factor)
            for axis, name in zip((ax.xaxis, ax.yaxis), spec["objectives"][:2], strict=True)
            for label, factor in [objective_axis(name, spec["grid"])]
        ]
        ax.set_xlim(low[0], high[0])
        ax.set_ylim(low[1], high[1])
        ax.xaxis.set_major_locator(MaxNLocator(3))
        ax.yaxis.set_major_locator(MaxNLocator(4))
    figure.supxlabel(labels[0], fontsize=8)
    figure.supylabel(labels[1], fontsize=8)
