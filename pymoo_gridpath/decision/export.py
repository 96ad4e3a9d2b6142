"""Export of trade-off sets: text tables, CSV and JSON."""

from __future__ import annotations

import csv
import importlib
import io
import json
from collections.abc import Sequence

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.decision.provenance import describe_problem, plain
from pymoo_gridpath.errors import GridPathError, counted
from pymoo_gridpath.grid import Cell, OccupancyGrid

FORMAT = "pymoo_gridpath trade-off set"
FORMAT_VERSION = 3

HEADERS = {
    "length": "length",
    "length_m": "length [m]",
    "vulnerability": "vulnerability",
    "turn": "turn [deg]",
    "interfering_cells": "interfering",
    "clearance": "clearance",
    "clearance_m": "clearance [m]",
}


def csv_text(trade_off) -> str:
    """Return one row a path: its number, its names joined by ``;``, and every measure in full precision."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["path", "names", *trade_off.measures])
    columns = [values.tolist() for values in trade_off.measures.values()]
    for k, row in enumerate(zip(*columns, strict=True)):
        writer.writerow([k, ";".join(trade_off.names(k)), *row])
    return text.getvalue()


def data_frame(trade_off):
    """Return what `csv_text` writes as a pandas.DataFrame; see `TradeOffSet.to_pandas`."""
    try:
        pandas = importlib.import_module("pandas")
    except ImportError:
        raise GridPathError(
            "pandas is not installed, expected it for to_pandas; pip install 'pymoo_gridpath[pandas]'"
        ) from None
    names = [";".join(trade_off.names(k)) for k in range(len(trade_off))]
    return pandas.DataFrame({"path": range(len(trade_off)), "names": names, **trade_off.measures})


def json_text(trade_off) -> str:
    """Return a trade-off set as strict JSON, one path a line."""
    problem = trade_off.problem
    head = {
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        **describe_problem(problem),
        **trade_off.meta,
        "objectives": list(trade_off.objective_names),
        "labels": {objective.name: objective.label for objective in problem.objectives},
        "maximised": [objective.name for objective in problem.objectives if objective.maximise],
        "best": {objective.name: objective.best for objective in problem.objectives if objective.best},
        "feasible": trade_off.feasible,
    }
    grids = {"occupied_runs": problem.grid}
    if problem.grid.original is not problem.grid:
        grids["original_runs"] = problem.grid.original
    runs = "".join(f' "{key}": {json.dumps(runs_of(grid.occupied))},\n' for key, grid in grids.items())
    records = [json.dumps(plain(record.as_dict()), allow_nan=False) for record in trade_off]
    lines = ",\n".join(f"  {record}" for record in records)
    start = json.dumps(plain(head), allow_nan=False, indent=1).removesuffix("\n}")
    return f'{start},\n{runs} "paths": [\n{lines}\n ]\n}}\n'


def runs_of(occupied: np.ndarray) -> list[int]:
    """Return how many cells are free, then occupied, then free, and so on, row by row from the bottom.

    Examples
    --------
    >>> runs_of(np.array([[True, True, False], [False, False, True]]))
    [0, 2, 3, 1]
    """
    flat = occupied.ravel()
    changes = np.flatnonzero(flat[1:] != flat[:-1]) + 1
    runs = np.diff(changes, prepend=0, append=flat.size).tolist()
    return [0, *runs] if flat[0] else runs


def table_text(trade_off, max_rows: int | None = None) -> str:
    """Return a table for terminals; see `TradeOffSet.table`."""
    if max_rows is not None:
        max_rows = checks.whole("max_rows", max_rows, 0)
    measures = shown_measures(trade_off)
    rows = _rows_shown(trade_off, max_rows)
    columns = [["path", *(str(k) for k in rows)]]
    for name, values in measures.items():
        columns.append([HEADERS.get(name) or name, *_numbers(values[rows])])
    marks = ["", *(", ".join(trade_off.names(k)) for k in rows)]
    widths = [max(map(len, column)) for column in columns]
    lines = [_heading(trade_off)]
    for k, mark in enumerate(marks):
        cells = (column[k].rjust(width) for column, width in zip(columns, widths, strict=True))
        lines.append(f"{'  '.join(cells)}  {mark}".rstrip())
    hidden = len(trade_off) - len(rows)
    if hidden:
        lines.append(f"... and {hidden} more")
    if trade_off.least_length is not None:
        resolution = trade_off.problem.grid.resolution
        cells = trade_off.least_length
        shortest = f"{cells:.3f}" if resolution is None else f"{cells * resolution:.3f} m"
        still = " where nothing moves" if trade_off.problem.representation.timed else ""
        lines.append(f"for comparison, the shortest of all paths on this grid{still} has length {shortest}")
    if trade_off.advice:
        lines.append(f"NOTE: {trade_off.advice}")
    return "\n".join(lines)


def shown_measures(trade_off) -> dict[str, np.ndarray]:
    """Return the measures that tables show: of those that there are in cells and in metres, the metres."""
    measures = trade_off.measures
    # The least clearance, as an objective, is another one than the room beside the robot.
    kept = [name for name in trade_off.objective_names if name != "length"]
    return {name: values for name, values in measures.items() if f"{name}_m" not in measures or name in kept}


def _heading(trade_off) -> str:
    problem = trade_off.problem
    start, goal = (place_in_words(problem.grid, end) for end in (problem.start, problem.goal))
    heading = f"{counted(len(trade_off), 'trade-off path')} from {start} to {goal} on {problem.grid.name!r}"
    return heading if trade_off.feasible else f"{heading}\nNOT FEASIBLE: {trade_off.infeasibility}"


def place_in_words(grid: OccupancyGrid, cell: Cell) -> str:
    """Return a cell in words, in metres where the map has them."""
    if grid.resolution is None:
        return f"{tuple(cell)}"
    x, y = (f"{value:.6g}" for value in np.round(grid.to_metres(cell), 6) + 0.0)
    return f"({x}, {y}) m"


def _rows_shown(trade_off, max_rows: int | None) -> Sequence[int]:
    """Return the rows to show: the named paths, then the others spread evenly, in order."""
    everything = list(range(len(trade_off)))
    if max_rows is None or max_rows >= len(everything):
        return everything
    named = sorted({trade_off.index(name) for name in trade_off.named})
    others = [k for k in everything if k not in named]
    room = max(max_rows - len(named), 0)
    spread = np.linspace(0, len(others) - 1, room).round().astype(int) if room else []
    return sorted({*named, *(others[k] for k in spread)})


def _numbers(values: np.ndarray) -> list[str]:
    if values.dtype.kind in "iub" or (np.isfinite(values).all() and (values == values.round()).all()):
        return [f"{value:.0f}" for value in values]
    return [f"{value:.4g}" if value and abs(value) < 0.1 else f"{value:.3f}" for value in values]
