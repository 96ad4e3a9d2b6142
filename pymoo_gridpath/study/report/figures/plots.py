"""Figures of convergence, of final ratios, and of average ranks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from pymoo_gridpath.study.report.figures.stretched_axis import stretch, stretch_unit
from pymoo_gridpath.study.report.figures.style import (
    REFERENCE,
    WIDTH,
    AlgorithmStyle,
    legend_above,
    new_figure,
    plain,
    shortened,
)
from pymoo_gridpath.study.report.results import Curve, Results
from pymoo_gridpath.study.report.statistics.significance import ALPHA, Friedman, cliques
from pymoo_gridpath.study.report.statistics.summaries import quartiles

# Numbers of evaluations at which bands are drawn.
_STEPS = 121

# From this share of the evaluations on, curves decide how far the axes reach.
_SETTLED = 0.1

_PANELS = (
    ("ratio", "Hypervolume ratio", 1.0),
    ("length", "Least length / shortest", 1.0),
    ("legal", "Legal members [%]", 100.0),
)


def band(curves: Sequence[Curve], quantity: str) -> tuple[np.ndarray, np.ndarray]:
    """Return evenly spaced evaluations and the quartiles over runs of a quantity there.

    They begin where every run has a record; a run that stopped keeps its last value.

    Returns
    -------
    evaluations : numpy.ndarray, shape (n,)
    values : numpy.ndarray, shape (3, n)
    """
    begin = max(curve.evaluations[0] for curve in curves)
    end = max(curve.evaluations[-1] for curve in curves)
    steps = np.unique(np.linspace(begin, end, _STEPS).round()) if end > begin else np.array([begin])
    rows = [getattr(curve, quantity)[np.searchsorted(curve.evaluations, steps, side="right") - 1] for curve in curves]
    return steps, quartiles(np.array(rows))


def plot_convergence(results: Results, problems: Sequence[int], styles: Sequence[AlgorithmStyle]) -> Figure | None:
    """Draw median and quartiles over the runs on some problems against evaluations; None if no run has a history."""
    curves = {}
    for k in range(len(styles)):
        found = [run.curve for run in results.finished(k, problems) if run.curve is not None]
        if found:
            curves[k] = found
    if not curves:
        return None
    with_length = not any(np.isnan(curve.length).any() for found in curves.values() for curve in found)
    panels = [panel for panel in _PANELS if with_length or panel[0] != "length"]
    figure = new_figure(2.7)
    axes = figure.subplots(1, len(panels), squeeze=False)[0]
    for ax, (quantity, label, unit) in zip(axes, panels, strict=True):
        late = []
        for place, (k, found) in enumerate(curves.items()):
            steps, values = band(found, quantity)
            low, middle, high = unit * values
            shown = np.isfinite(high)
            late.append(unit * values[:, steps >= _SETTLED * steps[-1]])
            style = styles[k]
            ax.fill_between(steps[shown], low[shown], high[shown], step="post", color=style.color, alpha=0.15, linewidth=0)
            every = (place * 20 // max(len(curves), 1), 20)
            look = {"marker": style.marker, "markersize": 3.5, "markevery": every, "linewidth": 1.1, "drawstyle": "steps-post"}
            ax.plot(steps, np.where(np.isfinite(middle), middle, np.nan), color=style.color, **look)
        # What came before does not flatten what runs have settled to.
        settled = np.concatenate(late, axis=1)
        settled = settled[np.isfinite(settled)]
        ax.set_xlabel("Evaluations")
        ax.set_ylabel(label)
        ax.set_xlim(left=0.0)
        ax.xaxis.set_major_locator(MaxNLocator(4, integer=True))
        ax.yaxis.get_major_formatter().set_useOffset(False)
        if quantity == "ratio":
            stretch(ax.yaxis, stretch_unit(results, problems), settled, n_marks=12)
        elif quantity == "length" and len(settled):
            # Where all lengths are equal, the room is above them, since nothing lies below the shortest.
            span = max(np.ptp(settled), 0.01)
            ax.set_ylim(settled.min() - 0.06 * span, settled.min() + 1.06 * span)
        plain(ax)
    handles = [styles[k].handle(line=True) for k in curves]
    low, high = axes[0].get_ylim()
    if low <= results.target <= high:
        look = {"color": REFERENCE, "linewidth": 0.8, "linestyle": (0, (4, 2))}
        axes[0].axhline(results.target, **look)
        handles.append(Line2D([], [], **look, label=f"target {results.target:g}"))
    legend_above(figure, handles)
    return figure


def plot_ratios(results: Results, groups: dict[str, list[int]], styles: Sequence[AlgorithmStyle]) -> Figure:
    """Draw the final ratios of all finished runs as boxes and points, one panel a group."""
    n_columns = min(3, len(groups))
    n_rows = -(-len(groups) // n_columns)
    height = n_rows * (0.17 * len(styles) + 0.55) + 0.1
    figure = Figure(figsize=(WIDTH if n_columns > 1 else 4.4, height), layout="constrained")
    axes = figure.subplots(n_rows, n_columns, sharey=True, squeeze=False).ravel()
    for ax in axes[len(groups) :]:
        ax.set_visible(False)
    for ax, name, problems in zip(axes, shortened(list(groups)), groups.values(), strict=False):
        for k, style in enumerate(styles):
            _strip(ax, results.values("ratio", k, problems), k, style)
        ax.set_title(name, loc="left")
        ratios = np.concatenate([results.values("ratio", k, problems) for k in range(len(styles))])
        stretch(ax.xaxis, stretch_unit(results, problems), ratios, n_marks=6)
        ax.tick_params(axis="y", length=0)
        plain(ax)
    axes[0].set_yticks(range(len(styles)), [style.label for style in styles])
    axes[0].set_ylim(len(styles) - 0.4, -0.6)
    figure.supxlabel("Hypervolume ratio of the final front", fontsize=8)
    return figure


def _strip(ax, values: np.ndarray, place: int, style: AlgorithmStyle) -> None:
    """Draw values as points that lie beside one another, and their quartiles as a box."""
    if not len(values):
        ax.text(0.02, place, "no finished run", transform=ax.get_yaxis_transform(), va="center", fontsize=7, color=REFERENCE)
        return
    # Multiples of the golden ratio spread points evenly, and always in the same way.
    offsets = np.mod(np.arange(1, len(values) + 1) * 0.6180339887, 1.0) - 0.5
    size, alpha = (9, 0.5) if len(values) <= 60 else (4, max(30.0 / len(values), 0.04))
    look = {"s": size, "alpha": alpha, "linewidths": 0, "rasterized": len(values) > 200}
    ax.scatter(np.sort(values), place + 0.5 * offsets, color=style.color, marker=style.marker, **look)
    low, middle, high = quartiles(values)
    bottom, top = place - 0.34, place + 0.34
    box = [low, high, high, low, low], [bottom, bottom, top, top, bottom]
    # On a white ground, where they would otherwise not stand out from so many points.
    for color, extra in [("white", 1.4)] * (len(values) > 60) + [(style.color, 0.0)]:
        ax.plot(*box, color=color, linewidth=0.9 + extra, solid_joinstyle="miter")
        ax.plot([middle, middle], [bottom, top], color=color, linewidth=2.0 + extra, solid_capstyle="butt")


def plot_ranks(friedman: Friedman, labels: Sequence[str]) -> Figure:
    """Draw a critical-difference diagram: average ranks, and bars that join those that do not differ significantly.

    Parameters
    ----------
    friedman : Friedman
    labels : sequence of str
        Of the algorithms, three or more.

    References
    ----------
    Demsar (2006), Statistical comparisons of classifiers over multiple data sets.
    """
    order = np.argsort(friedman.ranks, kind="stable")
    ranks, names = friedman.ranks[order], [shortened(labels)[k] for k in order]
    k = len(ranks)
    bars = [(0, k - 1)] if friedman.p >= ALPHA else cliques(ranks, friedman.critical_difference)
    half = -(-k // 2)
    # In inches, downwards from the axis of the ranks.
    sides = [0.062 * max(len(name) for name in part) + 0.65 for part in (names[:half], names[half:])]
    left, right = sides[0], WIDTH - sides[1]
    x = left + (ranks - 1.0) / (k - 1) * (right - left)
    first_label = 0.2 + 0.11 * len(bars)
    bottom = first_label + 0.2 * (half - 1) + 0.15
    top = -0.55
    figure = Figure(figsize=(WIDTH, bottom - top))
    ax = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    ax.set_xlim(0.0, WIDTH)
    ax.set_ylim(bottom, top)
    ax.axis("off")
    line = {"color": "black", "linewidth": 0.8, "solid_capstyle": "butt"}
    ax.plot([left, right], [0, 0], **line)
    for tick in np.arange(1.0, k + 0.25, 0.5):
        place, whole = left + (tick - 1.0) / (k - 1) * (right - left), tick == int(tick)
        ax.plot([place, place], [0, -0.06 if whole else -0.03], **line)
        if whole:
            ax.text(place, -0.08, f"{tick:.0f}", ha="center", va="bottom")
    _draw_difference(ax, friedman.critical_difference, k, left, right)
    for place, (rank, name) in enumerate(zip(ranks, names, strict=True)):
        on_left = place < half
        depth = first_label + 0.2 * (place if on_left else k - 1 - place)
        edge = left - 0.12 if on_left else right + 0.12
        ax.plot([x[place], x[place], edge], [0, depth, depth], **{**line, "linewidth": 0.6})
        text = f"{name}  {rank:.2f}" if on_left else f"{rank:.2f}  {name}"
        ax.text(edge + (-0.04 if on_left else 0.04), depth, text, ha="right" if on_left else "left", va="center")
    reach = min(0.05, 0.15 * (right - left) / (k - 1))
    for place, (first, last) in enumerate(bars):
        depth = 0.11 + 0.11 * place
        ax.plot([x[first] - reach, x[last] + reach], [depth, depth], color="black", linewidth=2.6, solid_capstyle="butt")
    return figure


def _draw_difference(ax, difference: float, k: int, left: float, right: float) -> None:
    """Draw the critical difference above the axis, from rank 1 on as far as there is room."""
    fits = difference <= k - 1
    end = left + min(difference / (k - 1), 1.0) * (right - left)
    line = {"color": "black", "linewidth": 1.2, "solid_capstyle": "butt"}
    ax.plot([left, end], [-0.34, -0.34], **line)
    for place in (left, end) if fits else (left,):
        ax.plot([place, place], [-0.31, -0.37], **line)
    text = f"critical difference {difference:.2f}"
    if fits and end + 1.7 < WIDTH:
        ax.text(end + 0.06, -0.34, text, ha="left", va="center")
    else:
        text += "" if fits else ", more than the ranks' range"
        ax.text(end, -0.38, text, ha="right", va="bottom")
