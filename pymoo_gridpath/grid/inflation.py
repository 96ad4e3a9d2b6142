"""Obstacles that grow by the radius of a robot."""

from __future__ import annotations

import math

import numpy as np

from pymoo_gridpath.grid.box import Box


def disc_of(radius: float, most: int) -> np.ndarray:
    """Return the cells whose square a disc of so many cells, centred in the middle one, overlaps; bool, at most a grid wide.

    Parameters
    ----------
    radius : float
    most : int
        The larger side of the grid.

    Returns
    -------
    numpy.ndarray of bool, shape (2 * reach + 1, 2 * reach + 1)
    """
    reach = math.ceil(min(radius + 0.5, most))
    offset = np.maximum(np.abs(np.arange(-reach, reach + 1)) - 0.5, 0.0) ** 2
    return np.sqrt(offset[:, None] + offset[None, :]) < radius - 1e-9


def grown_by(occupied: np.ndarray, disc: np.ndarray, free: Box) -> np.ndarray:
    """Return the cells in which the disc would overlap an occupied one, and those themselves.

    Parameters
    ----------
    occupied : numpy.ndarray of bool, shape (height, width)
    disc : numpy.ndarray of bool
        See `disc_of`.
    free : Box
        Outside of which no cell is free.

    Returns
    -------
    numpy.ndarray of bool, shape (height, width), read-only
    """
    # It takes as long to import as the rest of the package, and is used by this function alone.
    from scipy import signal

    # No other cell can change, nor can one further away change any.
    part = free.grown(len(disc) // 2, occupied.shape).slices
    hits = signal.oaconvolve(occupied[part].astype(float), disc.astype(float), mode="same")
    inflated = occupied.copy()
    inflated[part] |= hits > 0.5
    inflated.flags.writeable = False
    return inflated
