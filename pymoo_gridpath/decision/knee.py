"""The knee of a trade-off."""

from __future__ import annotations

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError


def knee_point(F: np.ndarray) -> int:
    """Return the index of the knee of a set of mutually non-dominated points.

    Every objective is scaled to [0, 1] between its least and its largest value in the set (one that does not vary counts
    as 0). The knee is the point that lies furthest on the ideal's side of the hyperplane that cuts all scaled axes at 1;
    of two objectives, that is the line through the two extreme points.

    Parameters
    ----------
    F : array_like, shape (N, n_obj)
        Values to be minimised, N >= 1.

    Returns
    -------
    int
        Of points equally far (to 1e-12), the first. A single point is its own knee. Two points both lie on the line, so the
        first is returned; so is the first of the extreme points where a front of two objectives bulges away from the ideal.

    Raises
    ------
    GridPathError
        If F is no such array.

    References
    ----------
    I. Das, "On characterizing the 'knee' of the Pareto curve based on normal-boundary intersection", Structural
    Optimization 18, 1999; for more than two objectives the hyperplane is the one with equal intercepts, which, unlike the
    one through the individual minima, never degenerates.

    Examples
    --------
    >>> knee_point([[0, 10], [1, 2], [8, 1], [10, 0]])
    1
    """
    expected = "finite numbers of shape (N, n_obj), at least one row and one column"
    F = checks.array("F", F, (None, None), expected=expected, finite=True).astype(float)
    if not F.size:
        raise GridPathError(f"F is {checks.shown(F)}, expected {expected}")
    low, spread = F.min(axis=0), np.ptp(F, axis=0)
    scaled = (F - low) / np.where(spread > 0, spread, 1.0)
    distance = (1.0 - scaled.sum(axis=1)) / np.sqrt(F.shape[1])
    return int(np.argmax(distance.round(12)))
