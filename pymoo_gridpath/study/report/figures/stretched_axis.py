"""An axis of hypervolume ratios that stretches what is near 1, where good algorithms differ although others are far from it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axis import Axis
from matplotlib.scale import FuncScale
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator
from numpy.typing import ArrayLike

from pymoo_gridpath.study.report.results import Results

#: How an axis is scaled, for the definitions.
SCALE_DEFINITION = (
    "Axes of hypervolume ratios: linear in arsinh((1 - ratio) / u), that is, nearly linear where less than u is missing to 1, "
    "and logarithmic in what is missing to 1 where that is more. Each panel has its u, which the caption states: of the "
    "algorithms' median final ratios, over all finished runs on the panel's problems, the best that is below 1 is taken, and u "
    "is what it misses to 1, rounded to one significant digit, at least 0.0001; u is 1 where no median is below 1."
)

# The least that is told apart near 1, as in the tables, and what passes for nothing.
_FINEST = 1e-4
_NONE = 1e-6

# What is marked first, before numbers in between.
_MARKS = (1.0, 0.0, 0.9, 0.99, 0.999, 0.5, 0.75, 0.25)


def stretch_unit(results: Results, problems: Sequence[int]) -> float:
    """Return the shortfall from 1 beyond which an axis is logarithmic: that of the best median that is not 1 itself.

    Where all algorithms are far from 1, this leaves the axis nearly linear.

    Returns
    -------
    float
        With one significant digit, 0.0001 to 1.
    """
    samples = [results.values("ratio", k, problems) for k in range(len(results.algorithms))]
    shortfalls = [1.0 - float(np.median(values)) for values in samples if len(values)]
    least = min((shortfall for shortfall in shortfalls if shortfall > _NONE), default=1.0)
    return float(f"{min(max(least, _FINEST), 1.0):.0e}")


def scale_sentence(results: Results, panels: Sequence[Sequence[int]]) -> str:
    """Return how the axes of panels are scaled, each on its problems, for captions."""
    units = [f"{stretch_unit(results, problems):g}" for problems in panels]
    if len(set(units)) == 1:
        return f"The axis of ratios stretches what is near 1 (see Definitions, u = {units[0]})."
    return f"The axes of ratios stretch what is near 1 (see Definitions, u = {', '.join(units)} from panel to panel)."


def stretched(ratios: ArrayLike, unit: float) -> np.ndarray:
    """Return where ratios lie on the axis: nearly linear within a unit of 1, logarithmic in the distance from 1 beyond."""
    return -np.arcsinh((1.0 - np.asarray(ratios)) / unit)


def stretch(axis: Axis, unit: float, ratios: np.ndarray, n_marks: int) -> None:
    """Scale an axis, let it reach a little beyond all of some ratios, and mark so many or fewer of those in between."""

    def forward(ratios):
        return stretched(ratios, unit)

    def inverse(places):
        return 1.0 - unit * np.sinh(-np.asarray(places))

    scale: Any = FuncScale(axis, (forward, inverse))
    begin, end = stretched([ratios.min(), ratios.max()] if len(ratios) else [0.0, 1.0], unit)
    room = max(0.06 * (end - begin), 0.05)
    low, high = inverse([begin - room, end + room])
    marks = _marks(low, high, unit, (end - begin + 2 * room) / n_marks)
    if axis is axis.axes.xaxis:
        axis.axes.set_xscale(scale)
        axis.axes.set_xlim(low, high)
    else:
        axis.axes.set_yscale(scale)
        axis.axes.set_ylim(low, high)
    axis.set_major_locator(FixedLocator(marks))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.10g}"))


def _marks(low: float, high: float, unit: float, apart: float) -> list[float]:
    """Return ratios to mark between two, so far apart on the axis."""
    kept: list[float] = []
    for mark in [*_MARKS, *np.round(MaxNLocator(4).tick_values(low, high), 12)]:
        away = [abs(stretched(mark, unit) - stretched(other, unit)) for other in kept]
        if low <= mark <= high and min(away, default=apart) >= apart:
            kept.append(float(mark))
    return sorted(kept)
