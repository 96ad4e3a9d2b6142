"""All figures of a trade-off set as files."""

from __future__ import annotations

import io
import os
from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

from pymoo_gridpath import checks
from pymoo_gridpath.checks import shown
from pymoo_gridpath.decision.drawn import drawn_box
from pymoo_gridpath.decision.trade_off import check_set
from pymoo_gridpath.errors import GridPathError, visible
from pymoo_gridpath.files import write_whole
from pymoo_gridpath.plotting import style
from pymoo_gridpath.plotting.convergence import as_recorders, plot_convergence
from pymoo_gridpath.plotting.fronts import as_reference, plot_front
from pymoo_gridpath.plotting.maps import figure_size, plot_paths
from pymoo_gridpath.plotting.style import STYLE, Units

# What each format writes about the time of writing, which would make equal figures differ.
_METADATA: dict[str, dict] = {"png": {}, "pdf": {"CreationDate": None}, "svg": {"Date": None}}


# A figure is about 7 inches wide, and of more dots than these pictures take gigabytes.
_MOST_DPI = 1200

_NAMES = ("map", "front", "front_plane", "convergence")


def save_figures(
    trade_off,
    directory: str | os.PathLike[str],
    history=None,
    reference=None,
    formats: Sequence[str] = ("png", "pdf"),
    units: Units | None = None,
    dpi: float = 200,
) -> list[Path]:
    """Write the figures of a trade-off set: ``map``, ``front`` and ``convergence``.

    Parameters
    ----------
    trade_off : TradeOffSet
        With one objective, there is no ``front``; with three, ``front`` is three-dimensional and ``front_plane`` shows
        the first two; with more, ``front`` shows the first two.
    directory : str or path-like
        Made if it does not exist.
    history : optional
        What `plot_convergence` takes; without it there is no ``convergence``.
    reference : optional
        What `plot_front` takes.
    formats : sequence of {"png", "pdf", "svg"}, default ("png", "pdf")
    units : {"cells", "m"}, optional
        What the axes of the map measure, by default metres where the map has them.
    dpi : float, default 200
        Dots per inch of pictures.

    Returns
    -------
    list of pathlib.Path
        The written files. They hold no date: the same set gives the same bytes. Figures of these names that another set has
        left in the directory are removed.

    Raises
    ------
    GridPathError
        If an argument is of another kind or out of its range, a format is unknown, or a file cannot be written.
    """
    units = style.check_units(units, check_set(trade_off).problem.grid)
    dpi = checks.number("dpi", dpi, 1.0, _MOST_DPI, expected=f"dots per inch, 1 to {_MOST_DPI}")
    formats = checks.names("formats", formats)
    for name in formats:
        if name not in _METADATA:
            raise GridPathError(f"there is no figure format {shown(name)}, expected some of {', '.join(_METADATA)}")
    recorders = None if history is None else as_recorders(history)
    reference = as_reference(trade_off, reference)
    directory = Path(checks.file_path("directory", directory))
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise GridPathError(
            f"{visible(directory)}: the folder cannot be made ({error.strerror}), expected a writable place"
        ) from None
    for name in _NAMES:
        for form in _METADATA:
            # Of an earlier set, and no longer true.
            (directory / f"{name}.{form}").unlink(missing_ok=True)
    written = []
    with mpl.rc_context(STYLE):  # pyright: ignore[reportArgumentType]
        for name, figure in _figures(trade_off, recorders, reference, units).items():
            for form in formats:
                data = io.BytesIO()
                figure.savefig(data, format=form, dpi=dpi, bbox_inches="tight", metadata=_METADATA[form])
                written.append(write_whole(directory / f"{name}.{form}", data.getvalue()))
    return written


def _figures(trade_off, recorders, reference, units: Units) -> dict[str, Figure]:
    """Return the figures by name, unknown to pyplot, which would keep them in memory."""
    figures = {"map": Figure(figsize=figure_size(trade_off.problem.grid.crop(drawn_box(trade_off))), layout="constrained")}
    plot_paths(trade_off, units=units, ax=figures["map"].add_subplot())
    names = trade_off.objective_names
    if len(names) == 3:
        figures["front"] = Figure(figsize=(5.0, 4.0))
        plot_front(trade_off, reference, ax=figures["front"].add_subplot(projection="3d"))
    if len(names) > 1:
        plane = "front_plane" if len(names) == 3 else "front"
        figures[plane] = Figure(figsize=(4.4, 3.3), layout="constrained")
        plot_front(trade_off, reference, objectives=names[:2], ax=figures[plane].add_subplot())
    if recorders is not None:
        figures["convergence"] = _convergence(recorders)
    return figures


def _convergence(recorders) -> Figure:
    """Return a figure of the least length, and below it of the hypervolume if any run has one."""
    ended = any(len(recorder.fronts[-1]) for recorder in recorders)
    figure = Figure(figsize=(4.4, 4.6 if ended else 2.6), layout="constrained")
    axes = figure.subplots(2 if ended else 1, sharex=True, squeeze=False)[:, 0]
    for ax, quantity in zip(axes, ("length", "hypervolume"), strict=False):
        plot_convergence(recorders, quantity, ax=ax)
    for ax in axes[1:]:
        if ax.get_legend() is not None:
            ax.get_legend().remove()
    for ax in axes[:-1]:
        ax.set_xlabel("")
    return figure
