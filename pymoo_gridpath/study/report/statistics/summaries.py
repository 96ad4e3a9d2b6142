"""Many values in a few: quartiles, and when a history reached something."""

from __future__ import annotations

import numpy as np


def first_reaching(ratios: np.ndarray, target: float) -> int | None:
    """Return the first record whose ratio is at least the target, None if there is none."""
    reached = np.flatnonzero(ratios >= target)
    return int(reached[0]) if len(reached) else None


def quartiles(values: np.ndarray, axis: int = 0) -> np.ndarray:
    """Return lower quartile, median and upper quartile, interpolated linearly; values may be infinite.

    Parameters
    ----------
    values : numpy.ndarray
        Without NaN; ``inf`` stands for something that was not reached and makes infinite what lies between it and a number.
    axis : int, default 0

    Returns
    -------
    numpy.ndarray, shape (3, ...)
        NaN if there are no values.
    """
    values = np.sort(np.moveaxis(np.asarray(values, dtype=float), axis, 0), axis=0)
    if not len(values):
        return np.full((3, *values.shape[1:]), np.nan)
    places = np.array([0.25, 0.5, 0.75]) * (len(values) - 1)
    below = np.floor(places).astype(int)
    above = np.ceil(places).astype(int)
    low, high = values[below], values[above]
    weight = (places - below).reshape(3, *[1] * (values.ndim - 1))
    with np.errstate(invalid="ignore"):
        between = low + weight * (high - low)
    return np.where(weight == 0.0, low, np.where(np.isinf(high), high, between))
