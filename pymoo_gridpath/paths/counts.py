"""What is counted along paths that are given by the cells that they visit: steps, turns and occupied cells."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pymoo_gridpath.compiled import COMPILED, kernel
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.neighbourhood import HEADING_OF, turn_units, turns_between
from pymoo_gridpath.paths.sequences import Sequences, for_kernels

# The heading of a step by the signs of (dx, dy): entry 4 + sign(dx) + 3 * sign(dy).
_HEADING = HEADING_OF.ravel().astype(np.int8)

_TURNS = turn_units()


class Counts(NamedTuple):
    """What is counted along each of N paths, each int64, shape (N,), by the rules of `Paths`.

    Attributes
    ----------
    straight, diagonal : numpy.ndarray
        Steps; those of a jump are the ones of the shortest way on an empty grid.
    turns : numpy.ndarray
        The sum of the absolute heading changes in units of 45 degrees.
    interfering : numpy.ndarray
        Occupied cells that are crossed.
    """

    straight: np.ndarray
    diagonal: np.ndarray
    turns: np.ndarray
    interfering: np.ndarray


def counts_of(sequences: Sequences, grid: OccupancyGrid) -> Counts:
    """Return what is counted along paths on a grid, none of which has a cell that follows itself."""
    if COMPILED:
        cells, offsets = (for_kernels(values) for values in sequences)
        return Counts(*_path_by_path(cells, offsets, grid.width, grid.occupied.ravel(), grid.neighbourhood.crossed))
    return _all_at_once(sequences, grid)


@kernel
def _path_by_path(cells, offsets, width, occupied, crossed):
    """Do what `_all_at_once` does, many times as fast if compiled, and as much slower if not."""
    n = len(offsets) - 1
    straight, diagonal = np.zeros(n, dtype=np.int64), np.zeros(n, dtype=np.int64)
    turns, interfering = np.zeros(n, dtype=np.int64), np.zeros(n, dtype=np.int64)
    for i in range(n):
        cell = cells[offsets[i]]
        y = cell // width
        x = cell - y * width
        n_straight, n_diagonal, n_turns, n_interfering = 0, 0, 0, 1 if occupied[cell] else 0
        # What is known of the step before: what it adds to the index of a cell, and along x and y; how long it is.
        by, dx, dy, steps, both, heading = 0, 0, 0, 0, 0, 8
        for k in range(offsets[i] + 1, offsets[i + 1]):
            other = cells[k]
            if other - cell != by or not 0 <= x + dx < width:
                by = other - cell
                # Mostly in the same row of the grid or one beside it, which is known without a division.
                dy = 0
                if not 0 <= x + by < width:
                    dy = 1 if by > 0 else -1
                    if not 0 <= x + by - dy * width < width:
                        dy = other // width - y
                dx = by - dy * width
                across, up = abs(dx), abs(dy)
                steps, both = max(across, up), min(across, up)
                before, heading = heading, _HEADING[4 + min(max(dx, -1), 1) + 3 * min(max(dy, -1), 1)]
                n_turns += _TURNS[before, heading]
            x += dx
            y += dy
            n_straight += steps - both
            n_diagonal += both
            if occupied[other]:
                n_interfering += 1
            if steps > 1:
                n_interfering += steps - 1
            elif both == 1:
                beside = (1 if occupied[cell + dx] else 0) + (1 if occupied[cell + dy * width] else 0)
                n_interfering += crossed[beside]
            cell = other
        straight[i], diagonal[i], turns[i], interfering[i] = n_straight, n_diagonal, n_turns, n_interfering
    return straight, diagonal, turns, interfering


def _all_at_once(sequences: Sequences, grid: OccupancyGrid) -> Counts:
    cells, offsets = sequences
    dx, dy = steps_of(sequences, grid.width)
    across, up = np.abs(dx), np.abs(dy)
    steps, both = np.maximum(across, up), np.minimum(across, up)
    diagonal = sums_of(both, offsets)
    units = np.zeros(len(cells), dtype=np.int64)
    heading = headings_of(dx, dy)
    turns_between(heading[:-1], heading[1:], out=units[1:])
    # No turn is made at the first and at the last cell of a path.
    units[offsets[:-1]] = units[offsets[1:] - 1] = 0
    occupied, neighbourhood = grid.occupied.ravel(), grid.neighbourhood
    crossed = np.maximum(steps - 1, 0)
    crossed += occupied.take(cells)
    if neighbourhood.restricts:
        at = np.flatnonzero((steps == 1) & (both == 1))
        beside = cells[at] + dx[at], cells[at] + dy[at] * grid.width
        crossed[at] += neighbourhood.crossings(*(occupied.take(some) for some in beside))
    return Counts(sums_of(steps, offsets) - diagonal, diagonal, sums_of(units, offsets), sums_of(crossed, offsets))


def steps_of(sequences: Sequences, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the step (dx, dy) from each visited cell, (0, 0) from the last one of a path, each int, shape (n_cells,)."""
    cells, offsets = sequences
    y = cells // width
    x = cells - y * width
    dx, dy = np.zeros_like(cells), np.zeros_like(cells)
    np.subtract(x[1:], x[:-1], out=dx[:-1])
    np.subtract(y[1:], y[:-1], out=dy[:-1])
    dx[offsets[1:] - 1] = dy[offsets[1:] - 1] = 0
    return dx, dy


def headings_of(dx: np.ndarray, dy: np.ndarray) -> np.ndarray:
    """Return the headings of steps, those of jumps by their signs, int8; -1 for no step."""
    return _HEADING.take(np.sign(dx) + 3 * np.sign(dy) + 4)


def sums_of(values: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """Return the sum of the values of each path, which begin at its offset, shape (N,)."""
    return np.add.reduceat(values, offsets[:-1]) if len(offsets) > 1 else values[:0]
