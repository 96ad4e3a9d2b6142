"""Arrays that grow, and are copied, in kernels.

Number by number: a slice that is assigned to is compiled with the words of what is said where shapes differ, for two seconds.
"""

from __future__ import annotations

import numpy as np

from pymoo_gridpath.compiled import kernel


@kernel
def copy(source, target, n):
    """Copy the first ``n`` numbers of an array to the beginning of another."""
    for i in range(n):
        target[i] = source[i]


@kernel
def room(array: np.ndarray, n) -> np.ndarray:
    """Return an array with room for ``n`` numbers: itself, or a larger copy."""
    if n <= len(array):
        return array
    larger = np.empty(2 * n, dtype=array.dtype)
    copy(array, larger, len(array))
    return larger


@kernel
def grown(rows):
    """Return a copy of rows, such as those of a heap, with twice the room."""
    larger = np.empty((2 * rows.shape[0], rows.shape[1]), dtype=rows.dtype)
    for i in range(rows.shape[0]):
        for k in range(rows.shape[1]):
            larger[i, k] = rows[i, k]
    return larger
