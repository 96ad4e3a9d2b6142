"""Figures of runs among obstacles that move: how good what had been found was at the end of each epoch."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from pymoo_gridpath.study.report.figures.stretched_axis import stretch, stretch_unit
from pymoo_gridpath.study.report.figures.style import AlgorithmStyle, legend_above, new_figure, plain
from pymoo_gridpath.study.report.results import Results
from pymoo_gridpath.study.report.statistics.summaries import quartiles

_PANELS = (("ratio", "Hypervolume ratio"), ("igd_plus", "IGD+"))


def plot_epochs(results: Results, problems: Sequence[int], styles: Sequence[AlgorithmStyle]) -> Figure | None:
    """Draw median and quartiles over the runs on some problems by epoch, but of planners; None if there is nothing to draw."""
    found = {}
    for k in range(len(styles)):
        epochs = [run.epochs for run in results.finished(k, problems) if run.epochs is not None]
        if epochs and not results.is_deterministic(k):
            found[k] = epochs
    if not found:
        return None
    figure = new_figure(2.6)
    for ax, (measure, label) in zip(figure.subplots(1, len(_PANELS)), _PANELS, strict=True):
        shown = []
        for k, epochs in found.items():
            rows = np.array([getattr(each, measure) for each in epochs])
            # An epoch without a legal path is infinitely far from its front.
            low, middle, high = (np.where(np.isfinite(part), part, np.nan) for part in quartiles(rows))
            numbers, style = np.arange(rows.shape[1]), styles[k]
            ax.fill_between(numbers, low, high, color=style.color, alpha=0.15, linewidth=0)
            ax.plot(numbers, middle, color=style.color, marker=style.marker, markersize=3.5, linewidth=1.1)
            shown += [low, middle, high]
        values = np.concatenate(shown)
        values = values[np.isfinite(values)]
        ax.set_xlabel("Epoch")
        ax.set_ylabel(label)
        ax.xaxis.set_major_locator(MaxNLocator(10, integer=True))
        if measure == "ratio":
            stretch(ax.yaxis, stretch_unit(results, problems), values, n_marks=12)
        else:
            top = values.max(initial=0.0)
            ax.set_ylim(-0.04 * (top or 1.0), 1.06 * (top or 1.0))
        plain(ax)
    legend_above(figure, [styles[k].handle(line=True) for k in found])
    return figure
