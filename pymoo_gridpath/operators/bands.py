"""Bands of objectives within which paths count as equal, so that their turn can decide."""

from __future__ import annotations

from typing import Any

import numpy as np
from moocore import is_nondominated

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError


def band_of(value: Any, error: type[GridPathError] = GridPathError) -> float:
    """Return the width of a band if it is one: a share of the range of each objective, from 0 for none to 0.5."""
    return checks.number("band", value, 0.0, 0.5, expected="a share from 0 to 0.5 of the range of each objective", error=error)


def range_of_front(F: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the ideal point of points and the range of those of them that no other dominates, 1 where that is 0."""
    front = F[is_nondominated(F, keep_weakly=True)]
    low = front.min(axis=0)
    span = front.max(axis=0) - low
    return low, np.where(span > 0, span, 1.0)


def boxes(F: np.ndarray, low: np.ndarray, span: np.ndarray, band: float) -> np.ndarray:
    """Return in which band of each objective points lie, counted in whole numbers from ``low``; a box is where all agree.

    Parameters
    ----------
    F : numpy.ndarray, shape (..., n_obj)
    low, span : numpy.ndarray, shape (n_obj,)
        Where the first band begins, and the range that counts as 1.
    band : float
        The width of a band as a share of the range, above 0.

    References
    ----------
    M. Laumanns, L. Thiele, K. Deb and E. Zitzler, "Combining convergence and diversity in evolutionary multiobjective
    optimization", Evolutionary Computation 10(3), 2002, section 4.2.
    """
    return np.floor((F - low) / (band * span))
