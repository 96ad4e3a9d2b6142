"""Paths whose worst cell is as good as can be."""

from __future__ import annotations

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.search.heap import drop_first, push
from pymoo_gridpath.search.moves import Moves


def best_level(moves: Moves, levels: np.ndarray, start: int, goal: int) -> int:
    """Return the lowest level that a path needs to pass: some path visits no cell of a higher one.

    Parameters
    ----------
    moves : Moves
    levels : numpy.ndarray of int64, shape (n_cells,)
        Of each cell, zero or more.
    start, goal : int
        Indices of two cells.

    Returns
    -------
    int
        -1 if no path joins the two.

    References
    ----------
    M. Pollack, "The maximum capacity through a network", Operations Research 8(5), 1960; by a search in the line of Dijkstra's.
    """
    return int(_best_level(moves.legal, moves.offsets, levels, start, goal))


@kernel
def _best_level(legal, offsets, levels, start, goal):
    seen = np.zeros(len(legal), dtype=np.uint8)
    # Each cell comes once.
    heap = np.empty((len(legal), 3), dtype=np.int64)
    push(heap, 0, levels[start], 0, start)
    n = 1
    seen[start] = 1
    while n > 0:
        level, cell = heap[0, 0], heap[0, 2]
        if cell == goal:
            return level
        drop_first(heap, n)
        n -= 1
        for m in range(8):
            other = cell + offsets[m]
            # The first to come to a cell comes by the lowest level, since they come in that order.
            if (legal[cell] >> m) & 1 and not seen[other]:
                seen[other] = 1
                push(heap, n, max(level, levels[other]), 0, other)
                n += 1
    return -1
