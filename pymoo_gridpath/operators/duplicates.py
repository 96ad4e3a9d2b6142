"""Duplicate elimination by exact comparison."""

from __future__ import annotations

import numpy as np
from pymoo.core.duplicate import DuplicateElimination


class RowDuplicates(DuplicateElimination):
    """Drop individuals whose genes equal those of an earlier one, by hashing rows.

    It keeps what `pymoo.core.duplicate.DefaultDuplicateElimination` keeps on genes that are whole numbers, in O(N) rather than
    O(N**2) time.
    """

    def _do(self, pop, other, is_duplicate):
        seen = set() if other is None else set(_keys(self.func(other)))
        for k, key in enumerate(_keys(self.func(pop))):
            if key in seen:
                is_duplicate[k] = True
            elif other is None:
                seen.add(key)
        return is_duplicate


def _keys(X: np.ndarray) -> list[bytes]:
    rows = np.ascontiguousarray(X)
    return rows.view(np.dtype((np.void, rows.dtype.itemsize * rows.shape[1]))).ravel().tolist()
