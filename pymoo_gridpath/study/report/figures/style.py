"""How algorithms look in every figure of a report, and how figures become files."""

from __future__ import annotations

import io
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from pymoo_gridpath.checks import shown
from pymoo_gridpath.errors import GridPathError, nearest
from pymoo_gridpath.plotting.style import STYLE

#: Width in inches of a figure across a page.
WIDTH = 7.0

#: Colour of what is measured against.
REFERENCE = "#5b5f66"

# Okabe and Ito's palette without its yellow, which is too light for lines on white; markers tell further algorithms apart.
_COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#000000", "#E69F00", "#56B4E9")
_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*", "<", ">")

# What each format writes about the time and the program, which would make equal figures differ.
_METADATA: dict[str, dict] = {
    "png": {"Software": None},
    "pdf": {"CreationDate": None, "Producer": None, "Creator": None},
    "svg": {"Date": None, "Creator": None},
}

# Height in inches of a row of a legend.
_LEGEND_ROW = 0.17

# Longer names are shortened in figures.
_LONGEST = 30


@dataclass(frozen=True)
class AlgorithmStyle:
    """How an algorithm looks, the same in every figure of a report."""

    label: str
    color: str
    marker: str

    def handle(self, line: bool) -> Line2D:
        """Return what stands for it in a legend."""
        style = "-" if line else ""
        return Line2D([], [], color=self.color, marker=self.marker, markersize=4, linestyle=style, label=self.label)


def algorithm_styles(labels: Sequence[str], exact: Sequence[bool]) -> list[AlgorithmStyle]:
    """Return the look of each algorithm; the exact one is grey."""
    styles, place = [], 0
    for short, grey in zip(shortened(labels), exact, strict=True):
        if grey:
            styles.append(AlgorithmStyle(short, REFERENCE, "."))
        else:
            styles.append(AlgorithmStyle(short, _COLORS[place % len(_COLORS)], _MARKERS[place % len(_MARKERS)]))
            place += 1
    return styles


def shortened(names: Sequence[str]) -> list[str]:
    """Return names short enough for figures, still all different."""
    short = [" ".join(name.splitlines()) for name in names]
    short = [name if len(name) <= _LONGEST else f"{name[: _LONGEST - 11]}…{name[-10:]}" for name in short]
    return [f"{name} ({k + 1})" if short.count(name) > 1 else name for k, name in enumerate(short)]


def check_formats(formats: str | Sequence[str]) -> list[str]:
    """Return the names of figure formats as a list.

    Raises
    ------
    GridPathError
        If one is unknown.
    """
    formats = [formats] if isinstance(formats, str) else list(formats)
    for name in formats:
        if name not in _METADATA:
            raise GridPathError(f"there is no figure format {shown(name)}, {nearest(name, _METADATA)}")
    return formats


def rendered(figure: Figure, form: str) -> bytes:
    """Return a figure as the bytes of a file, within `report_style`; equal figures have equal bytes."""
    data = io.BytesIO()
    figure.savefig(data, format=form, dpi=200, metadata=_METADATA[form])
    return data.getvalue()


def report_style():
    """Return the context in which figures of a report are made."""
    # From matplotlib's defaults on, so that no file of the user's settings makes equal reports differ.
    settings: Any = {**mpl.rcParamsDefault, **STYLE, "font.size": 8, "axes.labelsize": 8, "axes.titlesize": 8}
    del settings["backend"]
    # Names may have dollar signs.
    settings["text.parse_math"] = False
    return mpl.rc_context(settings)


def new_figure(height: float) -> Figure:
    """Return a figure across the page, unknown to pyplot, which would keep it in memory."""
    return Figure(figsize=(WIDTH, height), layout="constrained")


def panel_figure(n_panels: int, n_columns: int, panel_height: float, extra: float = 0.0):
    """Return a figure and the axes of its panels, row by row, all with the same scales."""
    n_columns = min(n_columns, n_panels)
    n_rows = -(-n_panels // n_columns)
    figure = Figure(figsize=(min(WIDTH, 2.6 * n_columns + 0.6), n_rows * panel_height + extra), layout="constrained")
    axes = figure.subplots(n_rows, n_columns, sharex=True, sharey=True, squeeze=False).ravel()
    for k, ax in enumerate(axes[:n_panels]):
        plain(ax)
        # Panels of the last row may be missing below others.
        ax.tick_params(labelbottom=k + n_columns >= n_panels, labelleft=k % n_columns == 0)
    for ax in axes[n_panels:]:
        ax.set_visible(False)
    return figure, list(axes[:n_panels])


def plain(ax: Axes) -> None:
    """Leave out the frame's upper and right lines."""
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)


def legend_above(figure: Figure, handles: Sequence) -> None:
    """Put a legend above all panels, in as many columns as fit; the figure grows by its rows beyond the first."""
    if not handles:
        return
    widths = [0.07 * len(str(handle.get_label())) + 0.55 for handle in handles]
    # A legend is filled column by column.
    for rows in range(1, len(widths) + 1):
        columns = [widths[begin : begin + rows] for begin in range(0, len(widths), rows)]
        if sum(max(column) for column in columns) <= figure.get_size_inches()[0]:
            break
    figure.set_figheight(figure.get_figheight() + _LEGEND_ROW * (max(map(len, columns)) - 1))
    look = {"columnspacing": 1.4, "handlelength": 1.8}
    figure.legend(handles=handles, loc="outside upper center", ncols=len(columns), **look)


def panel_title(label: str) -> str:
    """Return a label as the title of a narrow panel, in two lines if it is long."""
    return textwrap.fill(label, 24, break_on_hyphens=True)
