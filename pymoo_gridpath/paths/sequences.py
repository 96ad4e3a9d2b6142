"""Batches of cell sequences of different lengths."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError


class Sequences(NamedTuple):
    """N paths as the indices of the cells that they visit, one after another in one array.

    Attributes
    ----------
    cells : numpy.ndarray of int64, shape (n,)
        Indices of cells as in `Moves`; path i is ``cells[offsets[i]:offsets[i + 1]]``, from its start to its goal.
    offsets : numpy.ndarray of int64, shape (N + 1,)
    """

    cells: np.ndarray
    offsets: np.ndarray

    @property
    def lengths(self) -> np.ndarray:
        """Number of cells of each path, int64, shape (N,)."""
        return np.diff(self.offsets)

    def take(self, chosen: np.ndarray) -> Sequences:
        """Return some of the paths, by a bool for each, shape (N,)."""
        lengths = self.lengths
        return Sequences(self.cells[np.repeat(chosen, lengths)], np.cumsum([0, *lengths[chosen]]))


def check_sequences(sequences: Sequences, n_cells: int) -> Sequences:
    """Return sequences if they are such, of cells of a grid of so many.

    Raises
    ------
    GridPathError
        If they are of another class, hold what is no cell, or their offsets do not cut them into pieces.
    """
    cells, offsets = checks.instance("sequences", sequences, Sequences)
    expected = "Sequences of int64 arrays: indices of cells of the grid, and offsets that rise from 0 to their number"
    cells = checks.array("cells", cells, (None,), "iu", expected=expected)
    offsets = checks.array("offsets", offsets, (None,), "iu", expected=expected)
    rising = len(offsets) and offsets[0] == 0 and offsets[-1] == len(cells) and (offsets[1:] >= offsets[:-1]).all()
    if not rising or (len(cells) and not 0 <= cells.min() <= cells.max() < n_cells):
        raise GridPathError(f"sequences hold other numbers, expected {expected}")
    # Kernels are compiled for contiguous arrays that can be written into, and would be again for others.
    return Sequences(*(np.require(values, np.int64, ("C", "W")) for values in (cells, offsets)))
