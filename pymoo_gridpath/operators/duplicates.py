"""Duplicate elimination by exact comparison."""

from __future__ import annotations

import functools
from collections.abc import Hashable

import numpy as np
from pymoo.core.duplicate import DuplicateElimination

from pymoo_gridpath.registry import OPERATORS

# Rows of more genes are not hashed byte by byte.
_LONG = 2000


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


def row_keys(X: np.ndarray) -> list[Hashable]:
    """Return what tells each row of a matrix from others, byte by byte: equal and hashed alike where rows are equal."""
    rows = np.ascontiguousarray(X)
    if rows.dtype.itemsize == 8 and rows.shape[1] > _LONG:
        words = rows.view(np.uint64)
        return list(map(_LongRow, words, np.einsum("ij,j->i", words, _factors(words.shape[1])).tolist()))
    return rows.view(np.dtype((np.void, rows.dtype.itemsize * rows.shape[1]))).ravel().tolist()


class _LongRow:
    """A row of so many bytes that to copy and hash them takes several times as long as to weigh and add them up."""

    __slots__ = "hashed", "words"

    def __init__(self, words: np.ndarray, hashed: int):
        self.words, self.hashed = words, hashed

    def __hash__(self) -> int:
        return hash(self.hashed)

    def __eq__(self, other) -> bool:
        return type(other) is _LongRow and self.hashed == other.hashed and np.array_equal(self.words, other.words)


@functools.lru_cache(maxsize=4)
def _factors(n: int) -> np.ndarray:
    """Return odd numbers of 64 bits without a pattern, so that sums of multiples of them, which overflow, hardly ever agree."""
    z = np.arange(1, n + 1, dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return (z ^ (z >> np.uint64(31))) | np.uint64(1)
