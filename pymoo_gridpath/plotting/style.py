"""What all figures share: colours that colour-blind readers can tell apart, line styles, and the creation of figures."""

from __future__ import annotations

import contextlib
import weakref
from dataclasses import dataclass
from typing import Any, Literal

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator, ScalarFormatter
from numpy.typing import ArrayLike

from pymoo_gridpath import checks
from pymoo_gridpath.decision.trade_off import names_for
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.pictures import GROWN as GROWN
from pymoo_gridpath.pictures import INK, PALETTE
from pymoo_gridpath.pictures import OCCUPIED as OCCUPIED
from pymoo_gridpath.pictures import OTHERS as OTHERS
from pymoo_gridpath.pictures import UNSEEN as UNSEEN

Units = Literal["cells", "m"]


@dataclass(frozen=True)
class NameStyle:
    """How a named path looks on maps and fronts."""

    color: str
    dashes: Any
    marker: str


# Dashes and markers tell the paths apart in grey print too.
NAME_STYLES = {
    "earliest": NameStyle(PALETTE["earliest"], (0, (7, 1.2)), "v"),
    "shortest": NameStyle(PALETTE["shortest"], "-", "s"),
    "safest": NameStyle(PALETTE["safest"], (0, (5, 1.6)), "D"),
    "smoothest": NameStyle(PALETTE["smoothest"], (0, (1.2, 1.2)), "^"),
    "knee": NameStyle(PALETTE["knee"], (0, (6, 1.5, 1.2, 1.5)), "o"),
    "widest": NameStyle(PALETTE["widest"], (0, (3, 1)), "P"),
    "cheapest": NameStyle(PALETTE["cheapest"], (0, (4, 1, 1, 1, 1, 1)), "p"),
    "flattest": NameStyle(PALETTE["flattest"], (0, (2, 1.6)), "h"),
}
# Of names that the objectives of others have for their best path.
OTHER_NAME = NameStyle(INK, (0, (3, 1, 1, 1, 1, 1)), "X")
POTENTIAL = ["#ffffff", "#f3d9a4"]  # a list: of a tuple of two, matplotlib 3.8.0 takes the second for an opacity
REFERENCE = "#5b5f66"
WARNING = "#b00020"

STYLE = {
    "font.size": 9,
    "axes.labelsize": 9,
    "axes.titlesize": 9,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "legend.fontsize": 8,
    "axes.linewidth": 0.7,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "xtick.major.size": 3,
    "ytick.major.size": 3,
    "legend.frameon": False,
    "grid.color": "#d5d8dc",
    "grid.linewidth": 0.5,
    # Text stays text in files, which journals ask for.
    "pdf.fonttype": 42,
    "svg.fonttype": "none",
    "svg.hashsalt": "pymoo_gridpath",
}


# Values that differ by no more than this share of the largest are drawn as the same.
_SAME = 1e-6

# A value that all points share is drawn as zero if it is smaller than this.
_NEAR_ZERO = 1e-3

# Axes that this package made, so that later calls draw into them in the same style.
_OWN: weakref.WeakSet[Axes] = weakref.WeakSet()


def style_of(names) -> NameStyle:
    """Return the style of a path that goes by one or more names: that of the first."""
    return NAME_STYLES.get(names[0], OTHER_NAME)


def figure_style(ax: Axes | None):
    """Return the context in which to draw: this package's style for Axes of its own, that of the caller for others."""
    return _style() if ax is None or ax in _OWN else contextlib.nullcontext()


@contextlib.contextmanager
def _style():
    # Not matplotlib's rc_context, which would also put back what the first figure of a notebook switches on.
    settings: dict[str, Any] = mpl.rcParams  # pyright: ignore[reportAssignmentType]
    before = {key: settings[key] for key in STYLE}
    settings.update(STYLE)
    try:
        yield
    finally:
        settings.update(before)


def new_axes(figsize: tuple[float, float], projection: str | None = None) -> Axes:
    """Return the Axes of a new figure."""
    from matplotlib import pyplot as plt

    # Three-dimensional axes overflow the box that constrained layout sees.
    figure = plt.figure(figsize=figsize, layout=None if projection else "constrained")
    ax = figure.add_subplot(projection=projection)
    _OWN.add(ax)
    return ax


def fix_ticks(ax: Axes) -> None:
    """Give the ticks the sizes of now; they are made when drawn, out of the style's context."""
    now = {str(key): value for key, value in mpl.rcParams.items()}
    for axis in ("x", "y"):
        size, width, length = (now[f"{axis}tick.{key}"] for key in ("labelsize", "major.width", "major.size"))
        ax.tick_params(axis=axis, labelsize=size, width=width, length=length)


def span(values: ArrayLike) -> tuple[float, float]:
    """Return the range that an axis should show: that of the values, or one around them where they hardly differ.

    Left to itself, matplotlib would zoom in on rounding errors, and show negative numbers where every value is 0.
    """
    low, high = float(np.min(values)), float(np.max(values))
    size = max(abs(low), abs(high))
    if high - low > _SAME * size:
        return low, high
    return (low, low + 1.0) if size < _NEAR_ZERO else (low - 0.1 * size, high + 0.1 * size)


def widen_limits(ax: Axes) -> None:
    """Let the limits of Axes take in the `span` of what is drawn, and give its ticks full numbers."""
    if not np.isfinite(ax.dataLim.get_points()).all():
        return
    spans = np.array([span(ax.dataLim.intervalx), span(ax.dataLim.intervaly)])
    ax.update_datalim(spans.T)
    ax.autoscale_view()
    low, high = spans[0]
    if high - low < 1e-3 * max(abs(low), abs(high)):
        # Few, for the numbers are long.
        ax.xaxis.set_major_locator(MaxNLocator(4))
    for axis in (ax.xaxis, ax.yaxis):
        formatter = axis.get_major_formatter()
        if isinstance(formatter, ScalarFormatter):
            # Not their differences from a number at the axis's end.
            formatter.set_useOffset(False)


class _Scaled(ScalarFormatter):
    """Labels of the values of an axis times a factor."""

    def __init__(self, factor: float):
        super().__init__(useOffset=False)
        self.factor = factor

    def set_locs(self, locs):
        super().set_locs([0.0 + self.factor * value for value in locs])

    def __call__(self, x, pos=None):
        return super().__call__(0.0 + self.factor * x, pos)


def label_axis(axis, label: str, maximise: bool, factor: float = 1.0) -> str:
    """Return what to write beside an axis, and have its ticks say its values times a factor.

    Of what is maximised it holds the negative, and its ticks say the value itself.
    """
    if maximise or factor != 1.0:
        axis.set_major_formatter(_Scaled(-factor if maximise else factor))
    return f"{label}, more is better" if maximise else label


def check_units(units: Units | None, grid: OccupancyGrid) -> Units:
    """Return the units of a map, by default metres where it has them; refuse others, and metres of a map that has none."""
    if units is None:
        return "cells" if grid.resolution is None else "m"
    if not (isinstance(units, str) and units in ("cells", "m")):
        raise GridPathError(f"units is {checks.shown(units)}, expected 'cells' or 'm'")
    if units == "m":
        grid.check_resolution("an axis in metres")
    return units


def check_axes(ax: Axes | None) -> None:
    """Refuse what is no Axes to draw into."""
    checks.instance("ax", ax, Axes, " of matplotlib", optional=True)


def warn_infeasible(ax: Axes, trade_off) -> None:
    """Say above the Axes that the paths are not legal, if so."""
    if not trade_off.feasible:
        words = trade_off.infeasibility.replace("; ", ";\n")
        ax.set_title(f"Not feasible: {words}", color=WARNING)


def by_path(trade_off, which) -> dict[int, list[str]]:
    """Return the names to show, by default all, by the index of the path that bears them, in the order of the names."""
    groups: dict[int, list[str]] = {}
    for name in names_for(trade_off.problem.objectives) if which is None else checks.names("which", which):
        groups.setdefault(trade_off.index(name), []).append(name)
    return groups
