"""Occupancies in percent, as messages of ROS have them, made occupied, free and unknown cells; and larger cells of several."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridError

UNKNOWN = -1

UNKNOWN_CHOICES = ("occupied", "free")


def cells_of_occupancy(
    occupancy: ArrayLike, width: int | None, occupied_from: float, free_up_to: float, unknown: str
) -> tuple[np.ndarray, np.ndarray]:
    """Return which cells are occupied and which unknown, bool, shape (height, width)."""
    expected = "whole numbers from -1 (unknown) to 100 (percent) of shape (height, width), or flat with a width"
    values = checks.array("occupancy", occupancy, kinds="iu", expected=expected, error=GridError)
    if width is not None:
        width = checks.whole("width", width, 1, expected="a number of columns", error=GridError)
        if values.ndim != 1 or values.size == 0 or values.size % width:
            n = f"{values.size:,} values" if values.ndim == 1 else f"the shape {values.shape}"
            raise GridError(f"occupancy has {n}, expected a flat array of rows of {checks.shown(width)} values, the width")
        values = values.reshape(-1, width)
    if values.ndim != 2 or values.size == 0:
        raise GridError(f"occupancy has the shape {values.shape}, expected {expected}")
    wrong = (values < UNKNOWN) | (values > 100)
    if wrong.any():
        y, x = np.unravel_index(int(wrong.argmax()), values.shape)
        raise GridError(f"occupancy of cell ({x}, {y}) is {values[y, x]}, expected -1 (unknown) or 0 to 100 percent")
    limits = {
        name: checks.number(name, value, 0.0, 100.0, expected="a number of percent from 0 to 100", error=GridError)
        for name, value in (("free_up_to", free_up_to), ("occupied_from", occupied_from))
    }
    if limits["free_up_to"] >= limits["occupied_from"]:
        raise GridError(f"free_up_to is {free_up_to} and occupied_from {occupied_from}, expected the first below the second")
    checks.one_of("unknown", unknown, UNKNOWN_CHOICES, GridError)
    occupied = values >= limits["occupied_from"]
    unseen = ~occupied & ~((values >= 0) & (values <= limits["free_up_to"]))
    return occupied | unseen if unknown == "occupied" else occupied, unseen


def decimal_of(resolution: float) -> float:
    """Return a resolution that went through single precision, as in messages, as the decimal number that it was before."""
    single = np.float32(resolution)
    return float(str(single)) if float(single) == float(resolution) else float(resolution)


def blocks_of(cells: np.ndarray, factor: int, beyond: bool) -> np.ndarray:
    """Return whether any of ``factor`` x ``factor`` cells is True, from the bottom left on; those beyond the edge are given."""
    height, width = cells.shape
    padded = np.pad(cells, ((0, -height % factor), (0, -width % factor)), constant_values=beyond)
    return np.logical_or.reduce(padded.reshape(padded.shape[0] // factor, factor, -1, factor), axis=(1, 3))
