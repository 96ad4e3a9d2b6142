"""What of a trade-off set's map is drawn: in figures, on pages, in notebooks and on terminals."""

from __future__ import annotations

import numpy as np

from pymoo_gridpath.decision.export import HEADERS, shown_measures
from pymoo_gridpath.decision.measures import PathMeasures, risk_of
from pymoo_gridpath.errors import counted, visible
from pymoo_gridpath.fields import obstacle_potential
from pymoo_gridpath.grid import Box
from pymoo_gridpath.pictures import INK, PALETTE, Line, Scene, page, png


def drawn_box(trade_off) -> Box:
    """Return the part of the map that is drawn: that which can be reached, unless paths lead elsewhere."""
    problem = trade_off.problem
    box = problem.representation.box
    cells = np.concatenate([record.cells for record in trade_off])
    inside = (cells >= (box.x0, box.y0)).all() and (cells < (box.x1, box.y1)).all()
    return box if inside else problem.grid.whole


def drawn_field(trade_off, box: Box) -> np.ndarray:
    """Return the potential under the cells of the part that is drawn, that of the problem's risk."""
    problem = trade_off.problem
    if box == problem.representation.box:
        return PathMeasures(problem).field
    risk = risk_of(problem)
    return obstacle_potential(problem.grid) if risk is None else risk.potential(problem.grid)


def scene_of(trade_off) -> Scene:
    """Return the map with all paths of a set, those with names in their colours."""
    problem = trade_off.problem
    groups: dict[int, list[tuple[str, str]]] = {}
    for name, index in trade_off.named.items():
        groups.setdefault(index, []).append((name, PALETTE.get(name, INK)))
    lines = [
        Line(trade_off[index].cells, same[0][1], ", ".join(name for name, _ in same) if trade_off.feasible else "not legal")
        for index, same in groups.items()
    ]
    others = [record.cells for record in trade_off if record.index not in groups]
    grid = problem.grid
    scene = Scene(grid.occupied, grid.unknown, others, lines, problem.start, problem.goal, grid.grown_cells)
    return scene.cropped(*drawn_box(trade_off))


def html_of(trade_off) -> str:
    """Return a picture of a set beside a table of its named paths."""
    measures = [name for name in shown_measures(trade_off) if name != "interfering_cells"]
    rows: list[list[str]] = [["", "path", *(visible(HEADERS.get(name, name)) for name in measures)]]
    for name, k in trade_off.named.items():
        rows.append([name if trade_off.feasible else "", str(k), *(f"{trade_off.measures[key][k]:.5g}" for key in measures)])
    title = f"{counted(len(trade_off), 'trade-off path')} on {visible(trade_off.problem.grid.name)}"
    if not trade_off.feasible:
        title += f"; NOT FEASIBLE: {trade_off.infeasibility}"
    return page(png(scene_of(trade_off)), title, rows, "map with the paths, those with names coloured")


def record_scene(record) -> Scene:
    """Return the map with one path."""
    line = Line(record.cells, PALETTE["shortest"], f"path {record.index}")
    ends = [tuple(cell.tolist()) for cell in record.cells[[0, -1]]]
    if record.grid is None:
        # Of a record made by hand nothing else is known.
        low, high = record.cells.min(axis=0), record.cells.max(axis=0) + 1
        return Scene(np.zeros((high[1], high[0]), dtype=bool), None, [], [line], ends[0], ends[1]).cropped(*low, *high)
    grid = record.grid
    return Scene(grid.occupied, grid.unknown, [], [line], ends[0], ends[1], grid.grown_cells).cropped(*grid.box_of(ends[0]))


def record_html(record) -> str:
    """Return a picture of a path beside its measures."""
    rows = {
        "length": f"{record.length:.5g} cells" if record.length_m is None else f"{record.length_m:.5g} m",
        "vulnerability": f"{record.vulnerability:.5g}",
        "turn": f"{record.turn:g}\u00b0",
        "clearance": f"{record.clearance:.5g} cells" if record.clearance_m is None else f"{record.clearance_m:.5g} m",
        **({"occupied cells crossed": record.interfering_cells} if record.interfering_cells else {}),
        **{visible(name): f"{value:.5g}" for name, value in record.objectives.items() if not hasattr(record, name)},
    }
    names = f" ({', '.join(record.names)})" if record.names else ""
    return page(png(record_scene(record)), f"Path {record.index}{names}", rows, "map with the path")
