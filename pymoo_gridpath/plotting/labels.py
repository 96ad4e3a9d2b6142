"""Labels of points that cover neither one another nor the data."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

_ANGLES = np.deg2rad([45, 315, 135, 225, 0, 90, 180, 270, 22.5, 67.5, 292.5, 337.5])
_RADII = (9.0, 16.0, 26.0, 38.0, 52.0)


def place_labels(
    ax: Axes, points: np.ndarray, texts: Sequence[str], colors: Sequence[str], avoid: Sequence[np.ndarray]
) -> None:
    """Annotate points, each where its label covers least; a label that stands off is joined to its point by a line.

    Parameters
    ----------
    ax : matplotlib.axes.Axes
    points : numpy.ndarray, shape (K, 2)
        In data coordinates.
    texts, colors : sequence of K str
    avoid : sequence of numpy.ndarray, each of shape (n, 2)
        Polylines in data coordinates that labels should not cover; a single point is a line of one.
    """
    ax.figure.canvas.figure.draw_without_rendering()
    unit = ax.figure.dpi / 72.0
    inside = ax.get_window_extent()
    dots = np.concatenate([_dense(ax.transData.transform(line), 3.0 * unit) for line in [*avoid, points]])
    taken: list[tuple[float, float, float, float]] = []
    for point, text, color in zip(points, texts, colors, strict=True):
        note = ax.annotate(text, point, (0, 0), textcoords="offset points", color=color, ha="center", va="center", zorder=7)
        box = note.get_window_extent()
        half = np.array([box.width, box.height]) / 2.0
        best, best_box = (np.inf, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)
        for radius in _RADII:
            for angle in _ANGLES:
                direction = np.array([np.cos(angle), np.sin(angle)])
                centre = ax.transData.transform(point) + direction * (radius * unit + half * (np.abs(direction) > 0.1))
                low, high = centre - half - 1.5 * unit, centre + half + 1.5 * unit
                cost = radius / 10.0
                cost += 3.0 * np.count_nonzero(((dots > low) & (dots < high)).all(axis=1))
                cost += 500.0 * sum(low[0] < b[2] and b[0] < high[0] and low[1] < b[3] and b[1] < high[1] for b in taken)
                cost += 500.0 * bool((low < inside.min).any() or (high > inside.max).any())
                if cost < best[0]:
                    best = (cost, radius, *((centre - ax.transData.transform(point)) / unit))
                    best_box = (*low, *high)
        taken.append(best_box)
        note.set_position(best[2:])
        if best[1] > _RADII[0]:
            _join(ax, note, point, best[2:], color)


def _join(ax: Axes, note, point, offset, color: str) -> None:
    """Draw a thin line from a label to its point."""
    ax.annotate(
        "",
        point,
        offset,
        textcoords="offset points",
        arrowprops={"arrowstyle": "-", "color": color, "linewidth": 0.6, "shrinkA": 5, "shrinkB": 4},
        zorder=5,
    )


def _dense(line: np.ndarray, step: float) -> np.ndarray:
    """Return points along a polyline no further apart than ``step``."""
    line = np.atleast_2d(line)
    parts = [line[:1]]
    for a, b in itertools.pairwise(line):
        count = max(int(np.ceil(np.hypot(*(b - a)) / step)), 1)
        parts.append(a + (b - a) * (np.arange(1, count + 1) / count)[:, None])
    return np.concatenate(parts)
