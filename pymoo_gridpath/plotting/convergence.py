"""Convergence of one run, or of several as median and quartiles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import is_color_like
from matplotlib.ticker import AutoLocator, MaxNLocator, NullLocator

from pymoo_gridpath import checks
from pymoo_gridpath.convergence import ConvergenceRecorder, common_reference_point
from pymoo_gridpath.errors import GridPathError, visible
from pymoo_gridpath.plotting import style

Quantity = Literal["length", "vulnerability", "hypervolume"]

_LABELS = {"length": "Least length [cells]", "vulnerability": "Least vulnerability", "hypervolume": "Hypervolume"}


def plot_convergence(
    history,
    quantity: Quantity = "length",
    reference_point: Sequence[float] | np.ndarray | None = None,
    label: str | None = None,
    color: str = "#0072B2",
    ax: Axes | None = None,
) -> Axes:
    """Draw how a quantity of the legal paths converges over the evaluations.

    Parameters
    ----------
    history : ConvergenceRecorder or pymoo.core.result.Result, or sequence of either
        One run is drawn as a line; several as the line of their median, within a band from the lower to the upper quartile.
        Results must have been made with a `ConvergenceRecorder` as callback. A run without a legal path counts as infinitely
        long or vulnerable, or as hypervolume 0.
    quantity : {"length", "vulnerability", "hypervolume"}, default "length"
    reference_point : sequence of float, optional
        Of the hypervolume; by default the recorders' own, else `common_reference_point`.
    label : str, optional
        What the legend calls the line; call the function again with the same Axes to compare algorithms.
    color : str
        Colour of line and band.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default in a new figure.

    Returns
    -------
    matplotlib.axes.Axes
        A dotted upright line marks the first legal path, of several runs their median.

    Raises
    ------
    GridPathError
        If nothing was recorded or the quantity is unknown.
    """
    checks.one_of("quantity", quantity, _LABELS)
    if not _is_colour(color):
        raise GridPathError(f"color is {checks.shown(color)}, expected a colour of matplotlib such as '#0072B2'")
    if label is not None:
        label = visible(checks.text("label", label))
    style.check_axes(ax)
    recorders = as_recorders(history)
    evaluations, values = _common(recorders, _series(recorders, quantity, reference_point))
    middle = np.median(values, axis=0)
    with style.figure_style(ax):
        ax = style.new_axes((4.4, 3.0)) if ax is None else ax
        # A single generation makes no line.
        look = {"color": color, "linewidth": 1.4, "drawstyle": "steps-post", "marker": "." if len(evaluations) == 1 else ""}
        name = label or ("median" if len(recorders) > 1 else "")
        if not any(any(recorder.n_feasible) for recorder in recorders):
            name = f"{name}: no legal path" if name else "no legal path"
        ax.plot(evaluations, np.where(np.isfinite(middle), middle, np.nan), **look, label=name or None, zorder=3)
        if len(recorders) > 1:
            # Quartiles that are values of runs: interpolation fails between infinite ones.
            low = np.quantile(values, 0.25, axis=0, method="lower")
            high = np.quantile(values, 0.75, axis=0, method="higher")
            shown = np.isfinite(high)
            band = "quartiles" if label is None else None
            ax.fill_between(
                evaluations[shown], low[shown], high[shown], step="post", color=color, alpha=0.2, linewidth=0, label=band
            )
        _mark_first(ax, recorders, color, brief=label is not None)
        axis = _LABELS[quantity]
        _dress(ax, axis if _metres(recorders) is None else axis.replace("[cells]", "[m]"))
    return ax


def _is_colour(value: object) -> bool:
    try:
        return is_color_like(value)
    except Exception:  # what an object raises that is asked for its items
        return False


def as_recorders(history) -> list[ConvergenceRecorder]:
    """Return the recorders of one run or of several; see `plot_convergence`."""
    single = isinstance(history, ConvergenceRecorder) or hasattr(history, "algorithm")
    items = [history] if single else checks.items("history", history, "a run with a ConvergenceRecorder, or several")
    recorders = []
    for item in items:
        if not isinstance(item, ConvergenceRecorder):
            item = getattr(getattr(item, "algorithm", None), "callback", None)
        if not isinstance(item, ConvergenceRecorder) or not len(item):
            raise GridPathError("a run has no recorded convergence, expected minimize(..., callback=ConvergenceRecorder())")
        recorders.append(item)
    if not recorders:
        raise GridPathError("there is no recorded convergence to draw, expected one run or more")
    return recorders


def _series(recorders: list[ConvergenceRecorder], quantity: Quantity, reference_point) -> list[np.ndarray]:
    if quantity == "length":
        metres = _metres(recorders) or 1.0
        return [metres * np.array(recorder.best_length) for recorder in recorders]
    if quantity == "vulnerability":
        return [np.array(recorder.best_vulnerability) for recorder in recorders]
    if reference_point is None:
        own = [recorder.reference_point for recorder in recorders]
        reference_point = own[0] if own[0] is not None else common_reference_point(recorders)
    return [recorder.hypervolume(reference_point) for recorder in recorders]


def _metres(recorders: list[ConvergenceRecorder]) -> float | None:
    """Return the metres a cell of the maps of runs, if they all have the same."""
    found = {recorder.resolution for recorder in recorders}
    return found.pop() if len(found) == 1 else None


def _common(recorders: list[ConvergenceRecorder], series: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return all numbers of evaluations at which any run was recorded and each run's latest value there.

    They begin where every run has a record; a run that stopped keeps its last value.
    """
    steps = np.unique(np.concatenate([recorder.evaluations for recorder in recorders]))
    steps = steps[steps >= max(recorder.evaluations[0] for recorder in recorders)]
    rows = [
        values[np.searchsorted(recorder.evaluations, steps, side="right") - 1]
        for recorder, values in zip(recorders, series, strict=True)
    ]
    return steps, np.array(rows)


def _mark_first(ax: Axes, recorders: list[ConvergenceRecorder], color: str, brief: bool) -> None:
    """Mark the evaluation of the first legal path and say its generation."""
    first = [recorder.first_feasible for recorder in recorders]
    found = [(r.evaluations[k], r.generations[k]) for r, k in zip(recorders, first, strict=True) if k is not None]
    if 2 * len(found) <= len(recorders):
        return
    missing = [(np.inf, np.inf)] * (len(recorders) - len(found))
    # The lower median is a generation of one of the runs.
    evaluation, generation = sorted([*found, *missing])[(len(recorders) - 1) // 2]
    words = f"first legal (gen. {generation})" if brief else f"first legal path (generation {generation})"
    ax.axvline(evaluation, color=color, linewidth=0.9, linestyle=":", zorder=2, label=words)


def _dress(ax: Axes, label: str) -> None:
    ax.set_xlabel("Evaluations")
    ax.set_ylabel(label)
    style.widen_limits(ax)
    ax.xaxis.set_major_locator(MaxNLocator(6, integer=True))
    curves = [np.asarray(line.get_xydata(), dtype=float) for line in ax.lines if line.get_drawstyle() == "steps-post"]
    ax.set_xlim(0.0, 1.04 * max(curve[-1, 0] for curve in curves))
    ax.yaxis.set_major_locator(AutoLocator() if any(np.isfinite(curve[:, 1]).any() for curve in curves) else NullLocator())
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    style.fix_ticks(ax)
    if not ax.get_legend_handles_labels()[0]:
        return
    # Above the Axes, for curves may pass anywhere within.
    columns = 3 if len(ax.get_legend_handles_labels()[0]) <= 3 else 2
    look = {"borderaxespad": 0.2, "columnspacing": 1.2, "handlelength": 1.8}
    ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns, **look)
