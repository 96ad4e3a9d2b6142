"""Duplicate elimination by exact comparison."""

from __future__ import annotations

import numpy as np
from pymoo.core.duplicate import DuplicateElimination

from pymoo_gridpath.registry import OPERATORS


@OPERATORS.register
class RowDuplicates(DuplicateElimination):
    """Drop individuals whose genes equal those of an earlier one, by hashing rows.

    It keeps what `pymoo.core.duplicate.DefaultDuplicateElimination` keeps on genes that are whole numbers, in O(N) rather than
    O(N**2) time.
    """

    # Mating on arrays compares rows, too.
    arrays = True

    def _do(self, pop, other, is_duplicate):
        seen = set() if other is None else set(row_keys(other.get("X")))
        for k, key in enumerate(row_keys(pop.get("X"))):
            if key in seen:
                is_duplicate[k] = True
            elif other is None:
                seen.add(key)
        return is_duplicate


def row_keys(X: np.ndarray) -> list[bytes]:
    """Return the bytes of each row of a matrix, to compare rows by hashing."""
    rows = np.ascontiguousarray(X)
    return rows.view(np.dtype((np.void, rows.dtype.itemsize * rows.shape[1]))).ravel().tolist()
