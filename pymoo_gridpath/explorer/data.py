"""What a page knows of a trade-off set, as plain data: texts and numbers as they are, arrays packed.

An array is ``{"kind", "bytes", "data"}``: its type ("u1", "u4" or "i2", little-endian), its size, and its bytes as a zlib
stream in base64. `unpacked` and ``inflate.js`` undo that.
"""

from __future__ import annotations

import base64
import re
import zlib
from typing import Any

import numpy as np

from pymoo_gridpath.decision.drawn import drawn_box, drawn_field
from pymoo_gridpath.decision.export import place_in_words, shown_measures
from pymoo_gridpath.errors import counted, visible
from pymoo_gridpath.grid import Box, OccupancyGrid
from pymoo_gridpath.objectives import axis_of

# Measures are for people to compare: so many digits tell apart all that figures could.
_DIGITS = 7

# What a page calls measures, and their units.
_LABELS = {
    "length": ("Length", "cells"),
    "length_m": ("Length", "m"),
    "clearance": ("Least clearance", "cells"),
    "clearance_m": ("Clearance of the robot", "m"),
    "turn": ("Total turn", "\u00b0"),
    "vulnerability": ("Vulnerability", ""),
    "interfering_cells": ("Occupied cells crossed", ""),
}


def page_data(trade_off, title: str) -> dict[str, Any]:
    """Return what a page of some title knows of a trade-off set.

    Returns
    -------
    dict
        ``map`` (name, size in cells, corner: the cell of the whole map that is (0, 0) here, resolution or None, unit, origin),
        ``start``, ``goal``, ``columns`` (key, label, unit, objective or not, maximised or not, values with None for infinity),
        ``names`` (name and path), ``occupied`` and ``grown`` (a bit a cell, row by row from the bottom; which of the first are
        so because obstacles grew, or None), ``field`` (0 to 255, or None), ``counts``, ``starts`` and ``steps`` (see
        `packed_paths`), ``waypoints`` (see `packed_waypoints`), and texts.
    """
    problem = trade_off.problem
    box = drawn_box(trade_off)
    grid = problem.grid.crop(box)
    resolution = problem.grid.resolution
    corner = np.array([box.x0, box.y0])
    cells = [np.asarray(record.cells) - corner for record in trade_off]
    field = _levels(drawn_field(trade_off, box), grid)
    return {
        "map": {
            "name": title,
            "size": [grid.width, grid.height],
            "corner": corner.tolist(),
            "resolution": resolution,
            "unit": "cells" if resolution is None else "m",
            "origin": list(problem.grid.origin),
        },
        "start": (np.asarray(problem.start) - corner).tolist(),
        "goal": (np.asarray(problem.goal) - corner).tolist(),
        "summary": _summary(trade_off, box, resolution),
        "caution": _caution(trade_off),
        "file_name": re.sub(r"[^A-Za-z0-9._-]+", "-", title).strip("-.")[:60] or "map",
        "field_label": "Potential",
        "columns": _columns(trade_off),
        "names": [{"name": name, "path": k} for name, k in trade_off.named.items()] if trade_off.feasible else [],
        "occupied": packed(np.packbits(grid.occupied)),
        "grown": None if grid.grown_cells is None else packed(np.packbits(grid.grown_cells)),
        "grown_label": _grown_label(problem.grid),
        "field": None if field is None else packed(field),
        **packed_paths(cells),
        "waypoints": packed_waypoints(trade_off),
    }


def _grown_label(grid: OccupancyGrid) -> str:
    """Return what the cells are called in which a robot would touch an obstacle."""
    unit = "cells" if grid.resolution is None else "m"
    return f"Too near for {'a radius' if grid.footprint is None else 'a footprint'} of {grid.robot_radius:.3g} {unit}"


def packed(array: np.ndarray) -> dict:
    """Return an array of bytes or whole numbers packed for a page."""
    kind = f"{array.dtype.kind}{array.dtype.itemsize}"
    data = np.ascontiguousarray(array, dtype=f"<{kind}").tobytes()
    return {"kind": kind, "bytes": len(data), "data": base64.b64encode(zlib.compress(data, 9)).decode()}


def unpacked(array: dict) -> np.ndarray:
    """Return the array, of one dimension, that `packed` packed.

    Examples
    --------
    >>> unpacked(packed(np.array([1, 2, 70000], dtype=np.uint32))).tolist()
    [1, 2, 70000]
    """
    return np.frombuffer(zlib.decompress(base64.b64decode(array["data"])), dtype=f"<{array['kind']}")


def packed_paths(paths: list[np.ndarray]) -> dict:
    """Return paths packed: how many cells each has, its first cell, and the steps of all paths one after the other.

    A step is a byte: dx + 16 dy of two numbers of four bits, in two's complement. Only where a path jumps by more than seven
    cells, as some do that cross obstacles, all are pairs of 16 bits.
    """
    starts = np.array([cells[0] for cells in paths], dtype=np.uint32)
    steps = np.concatenate([np.diff(cells, axis=0) for cells in paths]).astype(np.int64)
    near = steps.size == 0 or (steps.min() >= -8 and steps.max() <= 7)
    coded = (steps[:, 0] & 15 | (steps[:, 1] & 15) << 4).astype(np.uint8) if near else steps.astype(np.int16).ravel()
    counts = np.array([len(cells) for cells in paths], dtype=np.uint32)
    return {"counts": packed(counts), "starts": packed(starts.ravel()), "steps": packed(coded)}


def unpacked_paths(data: dict) -> list[np.ndarray]:
    """Return the cells of the paths that `packed_paths` packed.

    Examples
    --------
    >>> found = unpacked_paths(packed_paths([np.array([[3, 4], [2, 5], [2, 6]]), np.array([[7, 0]])]))
    >>> [cells.tolist() for cells in found]
    [[[3, 4], [2, 5], [2, 6]], [[7, 0]]]
    """
    counts, starts = unpacked(data["counts"]), unpacked(data["starts"]).reshape(-1, 2).astype(np.int64)
    coded = unpacked(data["steps"]).astype(np.int64)
    signed = ((coded & 15) ^ 8) - 8, ((coded >> 4) ^ 8) - 8
    steps = np.stack(signed, axis=1) if data["steps"]["kind"] == "u1" else coded.reshape(-1, 2)
    ends = np.cumsum(counts.astype(np.int64) - 1)[:-1]
    return [np.cumsum([first, *part], axis=0) for first, part in zip(starts, np.split(steps, ends), strict=True)]


def packed_waypoints(trade_off) -> dict | None:
    """Return which cells of the paths are their waypoints: how many each has, and the steps up to each from the last.

    None of paths that are not legal, which nobody is to drive along.
    """
    if not trade_off.feasible:
        return None
    places = [trade_off.smoother.places(record.cells) for record in trade_off]
    counts = np.array([len(one) for one in places], dtype=np.uint32)
    gaps = np.concatenate([np.diff(one, prepend=0) for one in places]).astype(np.uint32)
    return {"counts": packed(counts), "gaps": packed(gaps)}


def _levels(field: np.ndarray, grid: OccupancyGrid) -> np.ndarray | None:
    """Return a field as shares of its largest value in a free cell, 0 to 255; nothing is shown where cells are occupied."""
    free = np.where(grid.occupied, 0.0, field)
    top = float(free.max(initial=0.0))
    return np.rint(free / top * 255.0).astype(np.uint8) if 0.0 < top < np.inf else None


def _caution(trade_off) -> str:
    if not trade_off.feasible:
        return f"Not feasible: {trade_off.infeasibility}."
    advice = trade_off.advice
    return f"{advice[0].upper()}{advice[1:]}." if advice else ""


def _summary(trade_off, box: Box, resolution: float | None) -> str:
    problem = trade_off.problem
    whole = problem.grid
    size = f"{whole.width} x {whole.height} cells"
    if resolution is not None:
        size += f" of {resolution:g} m"
    if box != whole.whole:
        size += f", of which {box.x1 - box.x0} x {box.y1 - box.y0} are shown"
    ends = " to ".join(place_in_words(whole, end) for end in (problem.start, problem.goal))
    return f"{counted(len(trade_off), 'trade-off path')} from {ends}; {size}"


def _columns(trade_off) -> list[dict]:
    """Return the objectives of a set, and after them its other measures, lengths in metres where the map has them."""
    measures, columns = shown_measures(trade_off), []
    if trade_off.feasible:
        del measures["interfering_cells"]  # they cross none
    for objective in trade_off.problem.objectives:
        label, scale = axis_of(objective, trade_off.problem.grid)
        words, unit = _LABELS.get(objective.name) or _split(visible(label))
        in_metres = objective.in_cells and trade_off.problem.grid.resolution is not None
        values = trade_off.measures[objective.name] * scale
        columns.append(_column(objective.name, words, "m" if in_metres else unit, values, True, objective.maximise))
        # Of the length there is the same in metres.
        measures.pop("length_m" if in_metres and objective.name == "length" else objective.name, None)
    return columns + [_column(name, *_LABELS.get(name, (name, "")), values) for name, values in measures.items()]


def _column(key: str, label: str, unit: str, values: np.ndarray, objective: bool = False, maximise: bool = False) -> dict:
    flags = {"objective": objective, "maximise": maximise}
    return {"key": key, "label": label, "unit": unit, **flags, "values": [*map(_number, np.asarray(values).tolist())]}


def _split(label: str) -> tuple[str, str]:
    """Return the words of a label and the unit that it ends with in brackets."""
    match = re.fullmatch(r"(.+?)\s*\[(.*)\]", label)
    return (match[1], match[2]) if match else (label, "")


def _number(value: float) -> float | int | None:
    if not np.isfinite(value):
        return None
    return value if isinstance(value, int) else float(f"{value:.{_DIGITS}g}")
