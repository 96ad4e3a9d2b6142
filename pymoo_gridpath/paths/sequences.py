"""Batches of cell sequences of different lengths."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError


class Sequences(NamedTuple):
    """N paths as the indices of the cells that they visit, one after another in one array.

    What every representation codes and every search finds. Which cells the indices stand for says whoever hands them on:
    `Paths.sequences` counts those of the whole grid, ``y * width + x``; `Representation.from_sequences` and ``to_sequences``
    count those of the representation's box, as its `Moves` do, whose ``to_grid`` and ``from_grid`` lead from one to the other.

    Attributes
    ----------
    cells : numpy.ndarray of int64, shape (n,)
        Path i is ``cells[offsets[i]:offsets[i + 1]]``, from its start to its goal.
    offsets : numpy.ndarray of int64, shape (N + 1,)
        Rising from 0 to n.

    Examples
    --------
    >>> import numpy as np
    >>> paths = Sequences(np.array([0, 1, 2, 0, 4, 8]), np.array([0, 3, 6]))
    >>> paths.lengths.tolist(), paths.take(np.array([1])).cells.tolist()
    ([3, 3], [0, 4, 8])
    """

    cells: np.ndarray
    offsets: np.ndarray

    @property
    def lengths(self) -> np.ndarray:
        """Number of cells of each path, int64, shape (N,)."""
        # `numpy.diff` takes several times as long for a few paths.
        return self.offsets[1:] - self.offsets[:-1]

    def take(self, chosen: np.ndarray | slice) -> Sequences:
        """Return some of the paths, by a slice, by a bool for each, shape (N,), or by their numbers, in that order."""
        index = np.arange(len(self.offsets) - 1)[chosen]
        lengths = self.lengths[index]
        offsets = np.zeros(len(lengths) + 1, dtype=np.int64)
        np.cumsum(lengths, out=offsets[1:])
        # How far each cell of what is taken lies from where its path begins, and where that is here.
        shift = np.repeat(self.offsets[:-1][index] - offsets[:-1], lengths)
        return Sequences(self.cells[np.arange(offsets[-1]) + shift], offsets)


def check_sequences(sequences: Sequences, n_cells: int) -> Sequences:
    """Return sequences if they are such, of cells of a grid or box of so many.

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
    if not rising or not checks.within(cells, 0, n_cells - 1):
        raise GridPathError(f"sequences hold other numbers, expected {expected}")
    return Sequences(for_kernels(cells), for_kernels(offsets))


def for_kernels(values: np.ndarray) -> np.ndarray:
    """Return numbers as kernels are compiled for: contiguous, and not read-only; for others they would be compiled again."""
    flags = values.flags
    if values.dtype == np.int64 and flags.c_contiguous and flags.writeable and type(values) is np.ndarray:
        return values
    return np.require(values, np.int64, ("C", "W"))
