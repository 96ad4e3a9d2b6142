"""The known motion of obstacles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError

# More ticks than any plan has.
_MOST_TICKS = 1_000_000


class Trajectories:
    """Where obstacles are at each tick of a robot's clock.

    Parameters
    ----------
    movers : sequence of mapping or array_like
        For each obstacle its cells (x, y) by tick, ``{0: (3, 1), 1: (3, 2)}``, or an array of shape (n, 2) from tick 0 on. A
        cell beyond the edge of a grid is no cell of it. An obstacle moves at most one cell, straight or diagonal, a tick.
    after : {"stays", "gone"}, default "stays"
        Where an obstacle is after its last state: there, which is the safe reading, or nowhere.
    before : {"waits", "absent"}, default "waits"
        Where it is before its first state: there already, or nowhere.
    gaps : {"refuse", "interpolate"}, default "refuse"
        What to do about ticks without a state between two that have one: refuse them, or take the nearest cells to the
        straight line between the two. Nobody is ever taken for absent in a gap.

    Raises
    ------
    GridPathError
        If an argument is of another kind, a tick is no whole number (numpy's are, 1.5 is none), states are missing and gaps are
        refused, or an obstacle moves farther than a cell in a tick.

    Examples
    --------
    >>> Trajectories([{2: (0, 0), 4: (2, 2)}], gaps="interpolate").cells(5)[:, 0].tolist()
    [[0, 0], [0, 0], [0, 0], [1, 1], [2, 2], [2, 2]]
    """

    def __init__(self, movers: Sequence[Any], after: str = "stays", before: str = "waits", gaps: str = "refuse"):
        self.after = checks.one_of("after", after, ("stays", "gone"))
        self.before = checks.one_of("before", before, ("waits", "absent"))
        self.gaps = checks.one_of("gaps", gaps, ("refuse", "interpolate"))
        given = checks.items("movers", movers, "states of obstacles, cells (x, y) by tick")
        self._first, self._ways = zip(*(self._way(k, one) for k, one in enumerate(given)), strict=True) if given else ((), ())

    def __len__(self) -> int:
        """Return the number of obstacles."""
        return len(self._ways)

    def _way(self, number: int, mover: Any) -> tuple[int, np.ndarray]:
        """Return the first tick of an obstacle and its cells from then on, one a tick."""
        what = f"mover {number}"
        if isinstance(mover, Mapping):
            ticks = [checks.whole(f"a tick of {what}", tick, 0, _MOST_TICKS) for tick in mover]
            cells = list(mover.values())
        else:
            cells = checks.items(what, mover, "cells (x, y) by tick, or an array of shape (n, 2)")
            ticks = list(range(len(cells)))
        if not ticks:
            raise GridPathError(f"{what} has no state, expected at least one")
        if len(set(ticks)) < len(ticks):
            raise GridPathError(f"{what} has two states of one tick, expected one")
        found = checks.array(f"the cells of {what}", cells, (None, 2), "iu", expected="cells (x, y) of whole numbers")
        order = np.argsort(ticks)
        at, found = np.array(ticks)[order], found.astype(np.int64)[order]
        missing = np.flatnonzero(np.diff(at) > 1)
        if len(missing) and self.gaps == "refuse":
            raise GridPathError(
                f"{what} has no state at tick {at[missing[0]] + 1}, between its first and its last, expected one a tick, "
                f"or gaps='interpolate'"
            )
        every = np.arange(at[0], at[-1] + 1)
        left = np.searchsorted(at, every, side="right") - 1
        right = np.minimum(left + 1, len(at) - 1)
        span = np.maximum(at[right] - at[left], 1)[:, None]
        # The nearest whole numbers, halves upwards.
        share = 2 * (found[right] - found[left]) * (every - at[left])[:, None] + span
        way = found[left] + share // (2 * span)
        fast = np.flatnonzero(np.abs(np.diff(way, axis=0)).max(axis=1, initial=0) > 1)
        if len(fast):
            k = fast[0]
            raise GridPathError(
                f"{what} moves from {tuple(way[k].tolist())} to {tuple(way[k + 1].tolist())} after tick {every[k]}, expected "
                f"at most one cell a tick; shorter ticks make it slower"
            )
        return int(at[0]), way

    def cells(self, n_ticks: int) -> np.ndarray:
        """Return where the obstacles are at ticks 0 to ``n_ticks``, int64, shape (n_ticks + 1, n, 2); (-9, -9) is nowhere."""
        ticks = np.arange(checks.whole("n_ticks", n_ticks, 0, _MOST_TICKS) + 1)
        cells = np.full((len(ticks), len(self), 2), -9, dtype=np.int64)
        for k, (first, way) in enumerate(zip(self._first, self._ways, strict=True)):
            there = np.ones(len(ticks), dtype=bool)
            if self.before == "absent":
                there &= ticks >= first
            if self.after == "gone":
                there &= ticks < first + len(way)
            cells[there, k] = way[np.clip(ticks[there] - first, 0, len(way) - 1)]
        return cells
