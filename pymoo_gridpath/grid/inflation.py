"""Obstacles that grow by the radius of a robot."""

from __future__ import annotations

import math

import numpy as np

from pymoo_gridpath.grid.box import Box

# Discs up to this side grow obstacles row by row, which is quicker: twice at this size, ten times at three cells.
_LARGEST_BY_ROWS = 21


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
    # No other cell can change, nor can one further away change any.
    part = free.grown(len(disc) // 2, occupied.shape).slices
    inflated = occupied.copy()
    inflated[part] |= _by_rows(occupied[part], disc) if len(disc) <= _LARGEST_BY_ROWS else _by_convolution(occupied[part], disc)
    inflated.flags.writeable = False
    return inflated


def _by_rows(occupied: np.ndarray, disc: np.ndarray) -> np.ndarray:
    """Return the cells in which a disc meets an occupied one, row by row of the disc, each an unbroken stretch."""
    grown, (height, reach) = np.zeros_like(occupied), (len(occupied), len(disc) // 2)
    for dy in range(-min(reach, height - 1), min(reach, height - 1) + 1):
        stretch = int(disc[dy + reach].sum())
        if stretch:
            rows = slice(max(0, -dy), height - max(0, dy)), slice(max(0, dy), height - max(0, -dy))
            grown[rows[1]] |= _widened(occupied[rows[0]], stretch // 2)
    return grown


def _widened(occupied: np.ndarray, half: int) -> np.ndarray:
    """Return the cells that lie at most so many to the left or right of an occupied one."""
    done = 0
    while done < half:
        # Each turn covers twice as much; a longer step would lead to some cells by way of others beyond the edge alone.
        step = min(done + 1, half - done)
        wider = occupied.copy()
        wider[:, step:] |= occupied[:, :-step]
        wider[:, :-step] |= occupied[:, step:]
        occupied, done = wider, done + step
    return occupied


def _by_convolution(occupied: np.ndarray, disc: np.ndarray) -> np.ndarray:
    """Return the same, in a time that hardly depends on the size of the disc."""
    # It takes as long to import as the rest of the package, and is used by this function alone.
    from scipy import signal

    return signal.oaconvolve(occupied.astype(float), disc.astype(float), mode="same") > 0.5
