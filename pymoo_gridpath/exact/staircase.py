"""The staircase below which a path has to end to be on the front: what is known of two costs, in bins of the first one."""

from __future__ import annotations

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.exact.nearness import lowered

# Bins, as a power of two: about as many as there are states, but no more than fit into a processor's cache.
_MOST_BITS = 14

# Weighted sums are floats: what is compared with them leaves room for more than their rounding.
_ROUNDING = 1e-12


class Staircase:
    """The least second cost of known paths that have no more than a first cost, for first costs from the least of the front on.

    A path that costs no less than the staircase is dominated by a known one, or is its equal. In bins it is a little higher
    than it might be, and so cheap to lower and to look at, however many paths become known.

    Parameters
    ----------
    left, right : (int, int)
        The costs of the ends of the front.
    n_states : int
        States of the search, by which it is decided how fine the staircase is.

    Attributes
    ----------
    least : numpy.ndarray of int64, shape (n_bins,)
        The least second cost of known paths whose first cost is at most that where each bin begins.
    low : int
        Where the first bin begins.
    shift : int
        Bins are 2**shift wide.
    """

    def __init__(self, left: tuple[int, int], right: tuple[int, int], n_states: int):
        self.low, extent = left[0], right[0] - left[0]
        self.shift = max(extent.bit_length() - min(n_states.bit_length(), _MOST_BITS), 0)
        self.least = np.full((extent >> self.shift) + 1, left[1])

    @property
    def steps(self) -> int:
        """How many steps it has, about as many as there are known points on it."""
        return 1 + int(np.count_nonzero(np.diff(self.least)))

    def ceiling(self, low: tuple[int, int], high: tuple[int, int], weights: tuple[float, float]) -> float:
        """Return the least upper bound of a weighted sum of the costs of what may end below it between two known points."""
        first, last = (min((end[0] - self.low) >> self.shift, len(self.least) - 1) for end in (low, high))
        return ceiling(self.least, self.low, self.shift, first, last + 1, *weights)

    def gaps(self, points: np.ndarray) -> np.ndarray:
        """Return the gap between neighbours of points, shape (n, 2), in which each bin ends, int64, shape (n_bins,)."""
        ends = self.low + (np.arange(1, len(self.least) + 1) << self.shift) - 1
        return np.minimum(np.searchsorted(points[1:, 0], ends), max(len(points) - 2, 0))


@kernel
def lower(least, low, shift, first, second):
    """Lower a staircase to the costs of a path, and return whether that does anything to it."""
    k = (first - low + (1 << shift) - 1) >> shift
    if k >= len(least) or least[k] <= second:
        return False
    while k < len(least) and least[k] > second:
        least[k] = second
        k += 1
    return True


@kernel
def ceiling(least, low, shift, begin, end, first_weight, second_weight):
    """Return the highest weighted sum of the corners of some bins, which lie one unit beyond what is known."""
    highest = 0.0
    for k in range(begin, end):
        highest = max(highest, first_weight * (low + ((k + 1) << shift)) + second_weight * (least[k] + 1))
    return highest * (1.0 + _ROUNDING)


@kernel
def lower_marks(least, low, shift, gaps, weights, allowed, begin, all_gaps, ceilings, marks):
    """Fill in what labels must stay below in each gap, and return the first gap in which they can, from a bin on.

    A corner lies one unit beyond the known points, which have to be found again; where points may be missed, by what is allowed
    below them.

    Parameters
    ----------
    least, low, shift
        See `Staircase`.
    gaps : int64, shape (n_bins,)
        See `Staircase.gaps`.
    weights : float, shape (n_gaps, 2)
    allowed : int64, shape (2, 3)
        By how much points may be missed, see `Allowance.counted`.
    begin : int
        The bin.
    all_gaps : bool
        Whether anything has lowered the staircase; otherwise only the first gap has less of it than before.
    ceilings : float, shape (n_gaps,)
        Least upper bound of the weighted sum over the corners of each gap.
    marks : int64, shape (n_gaps, 2)
        Least upper bounds of f1 over the corners of each gap, and of f2 over those of this gap and the ones behind.
    """
    first = gaps[begin]
    end = len(weights) if all_gaps else first + 1
    exact = allowed[0, 1] == 0 and allowed[0, 2] == 0 and allowed[1, 1] == 0 and allowed[1, 2] == 0
    for j in range(first, end):
        ceilings[j] = -1.0
        marks[j, 0] = -1
        marks[j, 1] = -1
    for k in range(begin, len(least)):
        j = gaps[k]
        if j >= end:
            break
        one = low + ((k + 1) << shift)
        two = least[k]
        if not exact:
            one = lowered(one, allowed[0, 0], allowed[0, 1], allowed[0, 2])
            two = lowered(two, allowed[1, 0], allowed[1, 1], allowed[1, 2])
        two += 1
        ceilings[j] = max(ceilings[j], (weights[j, 0] * one + weights[j, 1] * two) * (1.0 + _ROUNDING))
        marks[j, 0] = max(marks[j, 0], one)
        marks[j, 1] = max(marks[j, 1], two)
    for j in range(min(end, len(weights) - 1) - 1, first - 1, -1):
        # A gap may be narrower than a bin, and those behind it still have corners.
        marks[j, 1] = max(marks[j, 1], marks[j + 1, 1])
    return first
