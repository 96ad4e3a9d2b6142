"""Maps with paths."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, to_rgb
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Affine2D, ScaledTranslation

from pymoo_gridpath import checks
from pymoo_gridpath.decision.drawn import drawn_box, drawn_field
from pymoo_gridpath.decision.trade_off import check_set
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.fields import check_field, obstacle_potential
from pymoo_gridpath.grid import Box, OccupancyGrid, check_grid
from pymoo_gridpath.plotting import style
from pymoo_gridpath.plotting.style import Units

#: Larger maps are drawn without lines between cells.
MAX_RULED = 32

# The names of the two ends of a path, their markers and how large these are.
_ENDS = (("start", "o", 1.0), ("goal", "*", 1.6))


def plot_map(
    grid: OccupancyGrid,
    potential: bool | np.ndarray = True,
    start: Sequence[int] | None = None,
    goal: Sequence[int] | None = None,
    units: Units | None = None,
    legend: bool = True,
    ax: Axes | None = None,
) -> Axes:
    """Draw a grid: occupied cells dark, over the obstacles' potential in a light colour.

    Of cells that are occupied because obstacles grew, see `OccupancyGrid.inflate`, the colour is another one.

    Parameters
    ----------
    grid : OccupancyGrid
    potential : bool or numpy.ndarray of shape (height, width), default True
        The field under the cells; True computes `obstacle_potential`, False draws none.
    start, goal : (int, int), optional
        Cells (x, y), marked by a circle and a star.
    units : {"cells", "m"}, optional
        What the axes measure, by default metres where the map has them. Metres are those of the map's frame, with its origin
        and yaw: a turned map is drawn turned.
    legend : bool, default True
        Whether to name the marks in a legend beside the map.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default in a new figure.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    GridPathError
        If the units are unknown, or metres on a map in cells; the field has another shape than the grid; or start or goal is
        off the grid.
    """
    check_grid(grid)
    units = style.check_units(units, grid)
    style.check_axes(ax)
    legend = checks.flag("legend", legend)
    field = _field(grid, potential)
    ends: list[Any] = [
        (cell, role, *mark) for cell, (role, *mark) in zip((start, goal), _ENDS, strict=True) if cell is not None
    ]
    for cell, role, *_ in ends:
        grid.check_cell(cell, role)
    with style.figure_style(ax):
        if ax is None:
            ax = style.new_axes(figure_size(grid))
        _draw_cells(ax, grid, field, units)
        for cell, role, marker, scale in ends:
            _draw_mark(ax, grid, grid, cell, role, marker, scale, units)
        if legend:
            _draw_legend(ax, grid)
    return ax


def plot_paths(
    trade_off,
    which: Sequence[str] | None = None,
    all_paths: bool = True,
    potential: bool | np.ndarray = True,
    units: Units | None = None,
    legend: bool = True,
    ax: Axes | None = None,
) -> Axes:
    """Draw the chosen paths of a trade-off set on their map, where obstacles that grew are told from what they were.

    Of a large map of which little can be reached from the start, that part is drawn, see `OccupancyGrid.box_of`. Of paths in
    time the ways of the obstacles that move are drawn until the last path arrives, with a square where each is at tick 0; who
    is where at the same tick a figure of all ticks does not say. The potential is that of what stands still.

    Parameters
    ----------
    trade_off : TradeOffSet
    which : sequence of str, optional
        Names of the paths to draw, by default all that there are, see `plot_front`; one path with several names is drawn once.
        Where paths share cells, they are drawn side by side, by less than a quarter of a cell.
    all_paths : bool, default True
        Whether to draw the other paths as thin grey lines.
    potential : bool or numpy.ndarray of shape (height, width), default True
        As in `plot_map`; True takes the variance of the problem's vulnerability.
    units, legend, ax
        As in `plot_map`.

    Returns
    -------
    matplotlib.axes.Axes
        The lines of chosen paths are its first `lines`, with their names as labels.

    Raises
    ------
    GridPathError
        If a name or the units are unknown, or metres on a map in cells.

    References
    ----------
    Ahmed and Deb (2013), figures 5 to 7.
    """
    groups = style.by_path(check_set(trade_off), which)
    units = style.check_units(units, trade_off.problem.grid)
    style.check_axes(ax)
    all_paths, legend = checks.flag("all_paths", all_paths), checks.flag("legend", legend)
    problem = trade_off.problem
    box = drawn_box(trade_off)
    grid = problem.grid.crop(box)
    if isinstance(potential, bool | np.bool_) and potential:
        field = drawn_field(trade_off, box)
    else:
        field = _field(problem.grid, potential)
        field = field if field is None else field[box.slices]
    with style.figure_style(ax):
        ax = ax or style.new_axes(figure_size(grid))
        _draw_cells(ax, grid, field, units, box)
        others = [_points(record, units) for record in trade_off if record.index not in groups]
        if others and all_paths:
            label = "other trade-off paths"
            ax.add_collection(LineCollection(others, colors=style.OTHERS, linewidths=0.7, zorder=2, label=label), autolim=False)
        _draw_chosen(ax, trade_off, grid, groups, units)
        if problem.representation.timed:
            _draw_movers(ax, trade_off, units)
        for cell, (role, marker, scale) in zip((problem.start, problem.goal), _ENDS, strict=True):
            _draw_mark(ax, problem.grid, grid, cell, role, marker, scale, units)
        style.warn_infeasible(ax, trade_off)
        if legend:
            _draw_legend(ax, grid)
    return ax


def _field(grid: OccupancyGrid, potential: bool | np.ndarray) -> np.ndarray | None:
    if isinstance(potential, bool | np.bool_):
        return obstacle_potential(grid) if potential else None
    field = check_field("potential", potential, grid).astype(float)
    if not np.isfinite(field[~grid.occupied]).all():
        raise GridPathError("potential is not finite in a free cell, expected finite numbers there")
    return np.where(np.isfinite(field), field, 0.0)


def _points(record, units: Units) -> np.ndarray:
    return record.cells if units == "cells" else record.points


def _draw_cells(ax: Axes, grid: OccupancyGrid, field: np.ndarray | None, units: Units, box: Box | None = None) -> None:
    """Draw the cells as one image and set the limits of the Axes to the grid's edge; the grid may be a box of a larger one."""
    colors = LinearSegmentedColormap.from_list("potential", style.POTENTIAL)
    top = 0.0 if field is None else field[~grid.occupied].max(initial=0.0)
    share = np.zeros(grid.shape) if field is None or top <= 0 else np.clip(field / top, 0.0, 1.0)
    image = colors(share)[..., :3]
    image[grid.occupied] = to_rgb(style.OCCUPIED)
    unseen = None if grid.unknown is None else grid.unknown & grid.occupied
    if unseen is not None and unseen.any():
        image[unseen] = to_rgb(style.UNSEEN)
        ax.scatter([], [], marker="s", color=style.UNSEEN, label="unknown, taken as occupied")
    near = grid.grown_cells
    if near is not None and near.any():
        image[near] = to_rgb(style.GROWN)
        ax.scatter([], [], marker="s", color=style.GROWN, label="too near for the robot")
    frame = _cells_to_axes(grid, units, box or grid.whole)
    # Between the image's cell coordinates and the Axes', so that a turned map needs no resampling here.
    width, height = grid.width, grid.height
    ax.imshow(
        image,
        origin="lower",
        extent=(-0.5, width - 0.5, -0.5, height - 0.5),
        transform=frame + ax.transData,
        interpolation="antialiased",
        zorder=0,
    )
    if max(grid.shape) <= MAX_RULED:
        upright = [[(x, -0.5), (x, height - 0.5)] for x in np.arange(width + 1) - 0.5]
        level = [[(-0.5, y), (width - 0.5, y)] for y in np.arange(height + 1) - 0.5]
        lines = [frame.transform(line) for line in upright + level]
        ax.add_collection(LineCollection(lines, colors="#c9ccd1", linewidths=0.4, zorder=1), autolim=False)
    corners = frame.transform([(-0.5, -0.5), (width - 0.5, -0.5), (width - 0.5, height - 0.5), (-0.5, height - 0.5)])
    ax.set_xlim(corners[:, 0].min(), corners[:, 0].max())
    ax.set_ylim(corners[:, 1].min(), corners[:, 1].max())
    ax.set_aspect("equal")
    unit = "cells" if units == "cells" else "m"
    ax.set_xlabel(f"$x$ [{unit}]")
    ax.set_ylabel(f"$y$ [{unit}]")
    for axis, extent in ((ax.xaxis, grid.width), (ax.yaxis, grid.height)):
        few = max(3, min(8, round(8 * extent / max(grid.shape))))
        axis.set_major_locator(MaxNLocator(few, integer=units == "cells"))
    style.fix_ticks(ax)


def _cells_to_axes(grid: OccupancyGrid, units: Units, box: Box) -> Affine2D:
    """Return the transform from cells, centres at whole numbers, to the coordinates of the Axes."""
    if units == "cells":
        return Affine2D().translate(box.x0, box.y0)
    x0, y0, yaw = grid.origin
    return Affine2D().translate(0.5, 0.5).scale(grid.check_resolution("an axis in metres")).rotate(yaw).translate(x0, y0)


def _draw_mark(
    ax: Axes, grid: OccupancyGrid, drawn: OccupancyGrid, cell, role: str, marker: str, scale: float, units: Units
) -> None:
    cell = grid.check_cell(cell, role)
    x, y = cell if units == "cells" else grid.to_metres(cell)
    size = float(np.clip(0.5 * _cell_points(ax, drawn), 6.0, 10.0)) * scale
    ax.plot(
        [x],
        [y],
        linestyle="none",
        marker=marker,
        markersize=size,
        markerfacecolor="#ffd92f",
        markeredgecolor="black",
        markeredgewidth=0.8,
        label=role,
        zorder=6,
        clip_on=False,
    )


def _draw_chosen(ax: Axes, trade_off, grid: OccupancyGrid, groups: dict[int, list[str]], units: Units) -> None:
    """Draw the named paths, moved sideways on paper, not in their data, so that shared cells show all of them."""
    cell = _cell_points(ax, grid)
    width = float(np.clip(0.1 * cell, 1.3, 2.2))
    gap = min(width + 0.3, max(0.22 * cell, 0.5))
    # Where cells are too small for lines side by side, those drawn first are wider and show behind the next.
    taper = np.linspace(1.0 + 0.7 * (len(groups) - 1) * (1.0 - gap / (width + 0.3)), 1.0, len(groups))
    first, last = (_points(trade_off[0], units)[k] for k in (0, -1))
    along = (last - first) / max(np.hypot(*(last - first)), 1e-300)
    scale = ax.figure.dpi_scale_trans
    for k, (index, names) in enumerate(groups.items()):
        shift = (k - (len(groups) - 1) / 2) * gap / 72.0
        aside = ScaledTranslation(-along[1] * shift, along[0] * shift, scale)
        look = style.style_of(names)
        points = _points(trade_off[index], units)
        ax.plot(
            points[:, 0],
            points[:, 1],
            color=look.color,
            linestyle=look.dashes,
            linewidth=width * taper[k],
            dash_capstyle="butt",
            solid_joinstyle="round",
            label=", ".join(names),
            zorder=4,
            transform=ax.transData + aside,
        )


def _draw_movers(ax: Axes, trade_off, units: Units) -> None:
    """Draw the ways of obstacles that move, until the last path arrives."""
    problem = trade_off.problem
    at = problem.representation.timetable.at[: int(trade_off.paths.arrival.max()) + 1]
    points = (at if units == "cells" else problem.grid.to_metres(at.reshape(-1, 2)).reshape(at.shape)).astype(float)
    inside = ((at >= 0) & (at < (problem.grid.width, problem.grid.height))).all(axis=2)
    points[~inside] = np.nan
    for k in range(at.shape[1]):
        label = "obstacles that move" if k == 0 else None
        look = {"color": style.OCCUPIED, "linewidth": 1.0, "linestyle": ":", "marker": "s", "markersize": 5, "zorder": 3}
        ax.plot(*points[:, k].T, markevery=[0], label=label, **look)


def figure_size(grid: OccupancyGrid) -> tuple[float, float]:
    """Return a figure size in inches that leaves room for the legend: on the right of a square map, under a wide one."""
    ratio = grid.width / grid.height
    if _is_wide(grid):
        return 6.6, max(5.9 / ratio, 1.0) + 1.1
    height = min(4.2, 4.2 / ratio) if ratio >= 0.6 else 6.0
    return max(height * ratio, 1.2) + 2.0, height + 0.4


def _is_wide(grid: OccupancyGrid) -> bool:
    return grid.width > 1.3 * grid.height


def _cell_points(ax: Axes, grid: OccupancyGrid) -> float:
    """Return about how many points a cell is wide on paper."""
    box = ax.get_window_extent()
    return 72.0 / ax.figure.dpi * min(box.width / grid.width, box.height / grid.height)


def _draw_legend(ax: Axes, grid: OccupancyGrid) -> None:
    """Put the legend where it covers nothing."""
    handles, labels = ax.get_legend_handles_labels()
    if not handles:
        return
    # Chosen paths first, then the ends, then the rest.
    order = sorted(
        range(len(labels)), key=lambda k: 2 if labels[k].startswith(("other", "too")) else labels[k] in ("start", "goal")
    )
    handles, labels = [handles[k] for k in order], [labels[k] for k in order]
    if not _is_wide(grid):
        ax.legend(handles, labels, loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0, handlelength=3)
        return
    # A fixed way below the axes, however tall they become; a legend much wider than they are would make them narrower.
    below = ax.transAxes + ScaledTranslation(0.0, -0.42, ax.figure.dpi_scale_trans)
    most = len(handles) if len(handles) <= 4 else (len(handles) + 1) // 2
    ax.apply_aspect()
    width = 1.15 * ax.get_window_extent().width  # to which a figure of its own stretches them
    look = {"loc": "upper center", "bbox_to_anchor": (0.5, 0.0), "bbox_transform": below, "handlelength": 3}
    for columns in range(most, 0, -1):
        legend = ax.legend(handles, labels, ncols=columns, **look)
        if legend.get_window_extent().width <= width:
            break
