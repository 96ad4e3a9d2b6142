"""Animations of searches among obstacles that move: the map with the paths of the front, and the front, epoch by epoch."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.animation import FFMpegWriter, FuncAnimation, PillowWriter
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.colors import LinearSegmentedColormap, to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from matplotlib.ticker import MaxNLocator

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError, counted, visible
from pymoo_gridpath.files import write_whole
from pymoo_gridpath.objectives import axis_of
from pymoo_gridpath.plotting import style
from pymoo_gridpath.plotting.fronts import staircase
from pymoo_gridpath.plotting.maps import plot_map
from pymoo_gridpath.plotting.style import Units
from pymoo_gridpath.problems import MovingObstaclesProblem, ObstacleClock
from pymoo_gridpath.quality import ReferenceFront

# From the least of the first objective to the most; dark enough to be seen over the potential, and unlike the movers to all.
_COLORS = ["#08306b", style.NAME_STYLES["shortest"].color, "#3fb58a"]
_MOVER = "#D55E00"

# Cells before the present one that a mover's trail shows.
_TRAIL = 4

# Inches. Of more dots its pictures take gigabytes.
_WIDTH, _MOST_DPI = 8.0, 600
_WRITERS = {".gif": PillowWriter, ".mp4": FFMpegWriter}


def animate_moving(
    run,
    file: str | os.PathLike[str] | None = None,
    reference: bool = True,
    potential: bool = True,
    units: Units | None = None,
    fps: float = 1.0,
    dpi: float = 150,
) -> FuncAnimation:
    """Show how a search keeps up with obstacles that move, a picture an epoch.

    On the left the map as it was, with the movers, where they came from, and the paths of the front that had been found at the
    end of the epoch; on the right that front, in the same colours, from the least to the most of the first objective. Axes
    stay the same throughout.

    Parameters
    ----------
    run : pymoo.core.result.Result or ObstacleClock
        A run on a `MovingObstaclesProblem` with an `ObstacleClock` as callback, or that clock.
    file : path-like, optional
        Where to write it: ``.gif``, or ``.mp4`` where matplotlib finds ffmpeg. By default nothing is written.
    reference : bool, default True
        Whether to draw the exact front of each epoch under what was found, where `pareto_front` has it, and to say what share
        of its hypervolume that has.
    potential : bool, default True
        Whether to draw the obstacles' potential, as in `plot_map`.
    units : {"cells", "m"}, optional
        What the axes of the map measure.
    fps : float, default 1
        Pictures a second.
    dpi : float, default 150
        Dots per inch; the pictures are eight inches wide.

    Returns
    -------
    matplotlib.animation.FuncAnimation
        ``to_jshtml()`` shows it in a notebook.

    Raises
    ------
    GridPathError
        If the run has no clock that kept anything, has one objective, an argument is of another kind or out of its range, the
        file is of another format, ffmpeg is missing, or the file cannot be written.
    """
    clock = _clock_of(run)
    problem: MovingObstaclesProblem = clock.problem
    if problem.n_obj < 2:
        raise GridPathError("a front of one objective cannot be drawn, expected a run with two or more")
    reference, potential = checks.flag("reference", reference), checks.flag("potential", potential)
    units = style.check_units(units, problem.grid)
    fps = checks.number("fps", fps, 0.0, 60.0, above=True, expected="pictures a second, above 0, at most 60")
    dpi = checks.number("dpi", dpi, 10.0, _MOST_DPI, expected=f"dots per inch, 10 to {_MOST_DPI}")
    writer = None if file is None else _writer(file)
    fronts = [problem.stills[epoch].pareto_front() if reference else None for epoch in clock.epochs]
    film = _Film(clock, fronts, potential, units)
    shown = FuncAnimation(film.figure, film.draw, frames=len(clock.epochs), interval=1000.0 / fps, repeat_delay=1000)
    if file is not None and writer is not None:
        _write(shown, file, writer(fps=fps), dpi)
    return shown


class _Film:
    """The figure of an animation, drawn anew for each epoch."""

    def __init__(self, clock: ObstacleClock, fronts: list[np.ndarray | None], potential: bool, units: Units):
        self.clock, self.fronts, self.potential = clock, fronts, potential
        self.units: Units = units
        self.problem: MovingObstaclesProblem = clock.problem
        self.colors = LinearSegmentedColormap.from_list("front", _COLORS)
        grid = self.problem.grid
        wide = grid.width > 1.6 * grid.height
        # Small, so that its letters are large in a talk.
        size = (_WIDTH, min(_WIDTH * grid.height / grid.width, _WIDTH) + 3.4) if wide else (_WIDTH, 4.1)
        # Unknown to pyplot, which would keep it in memory.
        self.figure = Figure(figsize=size, layout="constrained")
        with style.figure_style(None):
            ratios = [1.0, 0.8] if wide else [1.0, 1.0]
            options: dict[str, Any] = {"height_ratios": ratios} if wide else {"width_ratios": ratios}
            self.axes = self.figure.subplots(2 if wide else 1, 1 if wide else 2, **options)
        words = [axis_of(objective, grid) for objective in self.problem.objectives]
        self.units_of = [label for label, _ in words], np.array([scale for _, scale in words])
        self.limits = self._limits()
        self.draw(0)
        # Laid out once, so that nothing jumps from picture to picture.
        engine = self.figure.get_layout_engine()
        if engine is not None:
            engine.execute(self.figure)
        self.figure.set_layout_engine("none")

    def draw(self, frame: int) -> list:
        """Draw the picture of an epoch."""
        with style.figure_style(None):
            for ax in self.axes:
                ax.clear()
            left, right = self.axes
            self._draw_map(left, frame)
            self._draw_front(right, frame)
            left.set_title(self._title(frame), loc="left", fontsize=12, pad=9)
        return []

    def _title(self, frame: int) -> str:
        words = f"Epoch {self.clock.epochs[frame] + 1} of {self.problem.n_epochs}: "
        words += counted(len(self.clock.F[frame]), "path") if len(self.clock.F[frame]) else "no legal path"
        front = self.fronts[frame]
        if front is None:
            return words
        ratio = ReferenceFront(front).hypervolume_ratio(self.clock.F[frame])
        # What is below 1 is never shown as 1.
        return f"{words}, hypervolume {'1.000' if ratio == 1.0 else f'{min(ratio, 0.999):.3f}'} of the exact front's"

    def _shades(self, frame: int) -> np.ndarray:
        """Return the colour of each point, in the order of the first objective, in which they are kept."""
        return self.colors(np.linspace(0.0, 1.0, max(len(self.clock.F[frame]), 2)))[: len(self.clock.F[frame])]

    def _draw_map(self, ax: Axes, frame: int) -> None:
        epoch = self.clock.epochs[frame]
        still = self.problem.stills[epoch]
        plot_map(still.grid, self.potential, still.start, still.goal, self.units, legend=False, ax=ax)
        if len(self.clock.X[frame]):
            cells, offsets = still.decode(self.clock.X[frame]).sequences
            points = self._points(np.column_stack([cells % still.grid.width, cells // still.grid.width]))
            # The last ones, with the least potential, are farthest from others, so that the first are drawn over them.
            lines = np.split(points, offsets[1:-1])[::-1]
            width = float(np.clip(150.0 / max(still.grid.shape), 1.0, 2.6))
            look = {"linewidths": width, "colors": self._shades(frame)[::-1], "alpha": 0.85, "capstyle": "round", "zorder": 3}
            ax.add_collection(LineCollection(lines, **look), autolim=False)
        self._draw_movers(ax, epoch)

    def _draw_movers(self, ax: Axes, epoch: int) -> None:
        corners = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
        places = [way[min(epoch, len(way) - 1)] for way in self.problem.movers]
        squares = [Polygon(self._points(place + corners)) for place in places]
        ax.add_collection(
            PatchCollection(squares, facecolors=_MOVER, edgecolors="black", linewidths=0.8, zorder=5), autolim=False
        )
        for way in self.problem.movers:
            trail = way[max(0, min(epoch, len(way) - 1) - _TRAIL) : min(epoch, len(way) - 1) + 1]
            steps = self._points(trail)
            pieces = np.stack([steps[:-1], steps[1:]], axis=1)
            fading = [(*to_rgb(_MOVER), share) for share in np.linspace(0.25, 0.9, _TRAIL)[_TRAIL - len(pieces) :]]
            ax.add_collection(LineCollection(list(pieces), colors=fading, linewidths=2.2, zorder=4), autolim=False)

    def _points(self, cells: np.ndarray) -> np.ndarray:
        return cells if self.units == "cells" else self.problem.grid.to_metres(cells)

    def _draw_front(self, ax: Axes, frame: int) -> None:
        F, front = self.clock.F[frame] * self.units_of[1], self.fronts[frame]
        front = front if front is None else front * self.units_of[1]
        plane = self.problem.n_obj == 2
        ring: dict[str, Any] = {
            "marker": "o",
            "linestyle": "none",
            "markerfacecolor": "none",
            "markeredgecolor": style.REFERENCE,
        }
        if front is not None:
            if plane:
                ax.plot(*staircase(front).T, color=style.REFERENCE, linewidth=0.8, linestyle=(0, (4, 2)), zorder=1)
            ax.plot(*front[:, :2].T, **ring, markersize=8, zorder=2)
        if len(F):
            ax.scatter(*F[:, :2].T, s=30, c=self._shades(frame), zorder=3, linewidths=0)
        low, high = self.limits
        labels, scales = self.units_of
        ax.set_xlim(low[0] * scales[0], high[0] * scales[0])
        ax.set_ylim(low[1] * scales[1], high[1] * scales[1])
        for axis, objective, label in zip((ax.xaxis, ax.yaxis), self.problem.objectives[:2], labels[:2], strict=True):
            axis.set_label_text(style.label_axis(axis, label, objective.maximise))
        ax.xaxis.set_major_locator(MaxNLocator(6))
        for side in ("top", "right"):
            ax.spines[side].set_visible(False)
        style.fix_ticks(ax)
        dot: dict[str, Any] = {"linestyle": "none", "color": self.colors(0.5)}
        handles = [Line2D([], [], marker="o", **dot, label="found, and its path on the map")]
        if any(each is not None for each in self.fronts):
            handles.append(Line2D([], [], **ring, label="exact front of this map"))
        look: dict[str, Any] = {"marker": "s", "markersize": 8, "markeredgecolor": "black", "linestyle": "none"}
        handles.append(Line2D([], [], color=_MOVER, **look, label="moving obstacle, and its way"))
        ax.legend(handles=handles, loc="upper right")

    def _limits(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the corners of a plane that holds the points of all epochs, with room for the legend."""
        given = [*self.clock.F, *(front for front in self.fronts if front is not None)]
        points = np.concatenate([F[:, :2] for F in given if len(F)] or [np.zeros((1, 2))])
        spans = np.array([style.span(column) for column in points.T]).T
        room = 0.06 * (spans[1] - spans[0])
        return spans[0] - room, spans[1] + room * (1.0, 3.0)


def _clock_of(run: Any) -> ObstacleClock:
    """Return the clock of a run if it has kept something."""
    clock = run if isinstance(run, ObstacleClock) else getattr(getattr(run, "algorithm", None), "callback", None)
    if not isinstance(clock, ObstacleClock) or not clock.epochs:
        raise GridPathError(
            f"run is {checks.shown(run)}, expected a Result of minimize(..., callback=ObstacleClock()), or that clock"
        )
    return clock


def _writer(file: str | os.PathLike[str]) -> Any:
    """Return the class that writes a file of a format."""
    suffix = Path(checks.file_path("file", file)).suffix.lower()
    if suffix not in _WRITERS:
        raise GridPathError(f"{visible(file)}: there is no animation of that format, expected a name that ends in .gif or .mp4")
    writer = _WRITERS[suffix]
    if not writer.isAvailable():
        raise GridPathError(
            f"{visible(file)}: matplotlib finds no ffmpeg, which writes its MP4 files; expected that it is installed, or a .gif"
        )
    return writer


def _write(shown: FuncAnimation, file: str | os.PathLike[str], writer: Any, dpi: float) -> None:
    """Write an animation, whole or not at all."""
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / f"made{Path(file).suffix.lower()}"
        shown.save(made, writer=writer, dpi=dpi)
        write_whole(file, made.read_bytes())
