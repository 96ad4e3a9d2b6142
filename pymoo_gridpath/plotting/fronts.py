"""Fronts of two and three objectives."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from pymoo_gridpath import checks
from pymoo_gridpath.decision.trade_off import check_set
from pymoo_gridpath.errors import GridPathError, visible
from pymoo_gridpath.objectives import axis_of
from pymoo_gridpath.plotting import style
from pymoo_gridpath.plotting.labels import place_labels


def plot_front(
    trade_off,
    reference=None,
    which: Sequence[str] | None = None,
    objectives: Sequence[str] | None = None,
    reference_label: str = "reference front",
    ax: Axes | None = None,
) -> Axes:
    """Draw the front of a trade-off set with its named paths marked; lengths are in metres where the map has them.

    Parameters
    ----------
    trade_off : TradeOffSet
        Of two or more objectives.
    reference : TradeOffSet or array_like of shape (K, n_obj), optional
        Another front in the same objectives, for instance the true one, drawn under it.
    which : sequence of str, optional
        Names of the paths to mark, by default all that there are: "shortest", "safest", "smoothest", "knee" and what the
        objectives call their best path, such as "widest" or, of paths in time, "earliest".
    objectives : sequence of two or three str, optional
        Names of the objectives to draw, by default all. Two of three give a projection with the third as colour.
    reference_label : str, default "reference front"
        What the legend calls the reference.
    ax : matplotlib.axes.Axes, optional
        Where to draw, three-dimensional for three objectives; by default in a new figure.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    GridPathError
        If there are not two or three objectives to draw, a name is unknown, the reference has another number of
        columns, or the Axes have not as many dimensions as there are objectives.

    References
    ----------
    Ahmed and Deb (2013), figures 4 and 8.
    """
    columns = _columns(check_set(trade_off), objectives)
    groups = style.by_path(trade_off, which)
    other = as_reference(trade_off, reference)
    other = None if other is None else _on_axes(trade_off, other)
    reference_label = visible(checks.text("reference_label", reference_label))
    style.check_axes(ax)
    solid = len(columns) == 3
    if ax is not None and (ax.name == "3d") != solid:
        raise GridPathError(f"the Axes are {ax.name}, expected {'3d' if solid else 'plane'} ones for {len(columns)} objectives")
    with style.figure_style(ax):
        if ax is None:
            ax = style.new_axes((5.0, 4.0), "3d") if solid else style.new_axes((4.4, 3.3))
        if solid:
            _draw_solid(ax, trade_off, columns, groups, other, reference_label)
        else:
            _draw_plane(ax, trade_off, columns, groups, other, reference_label)
    return ax


def _columns(trade_off, objectives: Sequence[str] | None) -> list[int]:
    names = trade_off.objective_names
    chosen = names if objectives is None else checks.names("objectives", objectives)
    unknown = [name for name in chosen if name not in names]
    if unknown:
        raise GridPathError(
            f"the trade-off set has no objective {checks.shown(unknown[0])}, expected some of {', '.join(names)}"
        )
    if len(chosen) not in (2, 3) or len(set(chosen)) < len(chosen):
        hint = "" if len(names) < 4 else "; choose them by objectives="
        raise GridPathError(f"a front of {len(chosen)} objectives cannot be drawn, expected two or three different ones{hint}")
    return [names.index(name) for name in chosen]


def as_reference(trade_off, reference) -> np.ndarray | None:
    """Return the points of a reference front; see `plot_front`."""
    if reference is None:
        return None
    expected = f"a TradeOffSet or finite numbers of shape (K, {trade_off.F.shape[1]})"
    values = checks.array("reference", getattr(reference, "F", reference), expected=expected, finite=True)
    values = np.atleast_2d(values.astype(float))
    if values.ndim != 2 or not values.size:
        raise GridPathError(f"reference is {checks.shown(reference)}, expected {expected}")
    if values.shape[1] != trade_off.F.shape[1]:
        raise GridPathError(f"the reference has {values.shape[1]} columns, expected {trade_off.F.shape[1]}, one an objective")
    return values


def staircase(F: np.ndarray) -> np.ndarray:
    """Return the corners of the edge of the region that mutually non-dominated points in two objectives dominate."""
    F = F[np.lexsort(F.T[::-1])]
    corners = np.column_stack([F[1:, 0], F[:-1, 1]])
    line = np.empty((2 * len(F) - 1, 2))
    line[::2], line[1::2] = F, corners
    return line


def _draw_plane(ax: Axes, trade_off, columns, groups, other, reference_label: str) -> None:
    F = _on_axes(trade_off, trade_off.F)[:, columns]
    whole = len(columns) == trade_off.F.shape[1]
    lines = [F[[k]] for k in range(len(F))]
    if other is not None:
        shown = other[:, columns]
        if whole:
            shown = shown[np.lexsort(shown.T[::-1])]
            lines.append(staircase(shown))
            ax.plot(*lines[-1].T, color=style.REFERENCE, linewidth=0.7, linestyle=(0, (4, 2)), zorder=1)
        look = {"s": 16, "marker": "o", "facecolors": "none", "edgecolors": style.REFERENCE, "linewidths": 0.7}
        ax.scatter(*shown.T, **look, label=reference_label, zorder=2)
        lines += [shown[[k]] for k in range(len(shown))]
    if whole:
        stairs = staircase(F)
        ax.plot(*stairs.T, color=style.OTHERS, linewidth=0.8, zorder=2)
        lines.append(stairs)
    rest = [k for k in range(trade_off.F.shape[1]) if k not in columns]
    if len(rest) == 1:
        other_one = trade_off.problem.objectives[rest[0]]
        values = _on_axes(trade_off, trade_off.F)[:, rest[0]] * (-1.0 if other_one.maximise else 1.0)
        low, high = style.span(values)
        look = {"c": values, "cmap": "cividis", "vmin": low, "vmax": high}
        dots = ax.scatter(*F.T, s=18, **look, zorder=3, label="trade-off paths")
        bar = ax.figure.colorbar(dots, ax=ax, label=axis_of(other_one, trade_off.problem.grid)[0], pad=0.02)
        bar.outline.set_linewidth(0.5)  # pyright: ignore[reportCallIssue]
    else:
        ax.scatter(*F.T, s=14, color=style.OTHERS, zorder=3, label="trade-off paths")
    for index, names in groups.items():
        look = style.style_of(names)
        face = "none" if rest else look.color
        ax.plot(*F[index], look.marker, markersize=7, markerfacecolor=face, markeredgecolor=look.color, zorder=4)
        ax.lines[-1].set_label(", ".join(names))
    _label_axes((ax.xaxis, ax.yaxis), trade_off, columns)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    style.widen_limits(ax)
    ax.margins(0.1)
    style.fix_ticks(ax)
    style.warn_infeasible(ax, trade_off)
    if other is not None:
        handles = [h for h in ax.collections if h.get_label() in (reference_label, "trade-off paths")]
        ax.legend(handles=handles[::-1], loc="best")
    texts = [", ".join(names) for names in groups.values()]
    place_labels(ax, F[list(groups)], texts, [style.style_of(names).color for names in groups.values()], lines)


def _draw_solid(ax, trade_off, columns, groups, other, reference_label: str) -> None:
    F = _on_axes(trade_off, trade_off.F)[:, columns]
    if other is not None:
        ax.scatter(
            *other[:, columns].T, s=10, facecolors="none", edgecolors=style.REFERENCE, linewidths=0.5, label=reference_label
        )
    plain = np.setdiff1d(np.arange(len(F)), list(groups))
    if len(plain):
        ax.scatter(*F[plain].T, s=14, color=style.OTHERS, depthshade=False, linewidths=0, label="trade-off paths")
    shown = F if other is None else np.concatenate([F, other[:, columns]])
    spans = [style.span(values) for values in shown.T]
    low, high = spans[2]
    floor = low - 0.05 * (high - low)
    for k, point in enumerate(F):
        # Stems tell where on the floor a point stands.
        names = groups.get(k)
        color = style.style_of(names).color if names else style.OTHERS
        x, y, z = point
        ax.plot([x, x], [y, y], [floor, z], color=color, linewidth=0.9 if names else 0.4, alpha=1.0 if names else 0.6)
    for index, names in groups.items():
        look = style.style_of(names)
        ax.plot(*F[index][:, None], look.marker, color=look.color, markersize=7, label=", ".join(names), zorder=10)
    _label_axes((ax.xaxis, ax.yaxis, ax.zaxis), trade_off, columns)
    style.fix_ticks(ax)
    ax.auto_scale_xyz(*spans, had_data=True)
    ax.set_zlim(bottom=floor)
    for axis in (ax.xaxis, ax.yaxis, ax.zaxis):
        axis.set_major_locator(MaxNLocator(5))
    ax.view_init(elev=24, azim=-130)
    style.warn_infeasible(ax, trade_off)
    ax.legend(loc="upper left", bbox_to_anchor=(1.02, 0.92), borderaxespad=0.0)


def _label_axes(axes, trade_off, columns: Sequence[int]) -> None:
    problem = trade_off.problem
    for axis, column in zip(axes, columns, strict=True):
        objective = problem.objectives[column]
        axis.set_label_text(style.label_axis(axis, axis_of(objective, problem.grid)[0], objective.maximise))


def _on_axes(trade_off, F: np.ndarray) -> np.ndarray:
    """Return points in the units that the axes say."""
    problem = trade_off.problem
    return F * [axis_of(objective, problem.grid)[1] for objective in problem.objectives]
