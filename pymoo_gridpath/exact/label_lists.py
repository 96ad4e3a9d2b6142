"""Lists of what is non-dominated among a second cost, a third one for each heading, and a number of steps, one for each cell.

A list is a block of rows of an array that all lists share, in descending order of the second cost. The third costs of a row are
the least of its own and of those behind it that take no more steps: where steps are not counted one row tells whether a list
covers what is new. Whoever comes to a cell may turn there, so that what comes along one heading counts for the others, too.
"""

from __future__ import annotations

import numpy as np

from pymoo_gridpath.compiled import inlined, kernel

# Rows of the smallest block; that of a level has twice as many as that of the level below.
_LEAST_ROWS = 4

# Columns of the array of lists: first row, number of rows in use, and number of the level above, 0 before there is a block.
BEGIN, SIZE, ABOVE = range(3)

# Columns of the rows; those of the third costs, one for each heading, come last.
SECOND, STEPS, THIRD = range(3)

# Places in the array of what is taken: rows, the highest level, and the first free block of each level.
N_ROWS, HIGHEST, FREE = range(3)


def empty_lists(n_lists: int, n_headings: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return so many lists, int64, shape (n_lists, 3), their rows, shape (n, 2 + n_headings), and what is taken, all int64."""
    taken = np.full(64, -1)
    taken[N_ROWS] = taken[HIGHEST] = 0
    return np.zeros((n_lists, 3), dtype=np.int64), np.empty((1024, THIRD + n_headings), dtype=np.int64), taken


@kernel
def has_room(rows, taken, n_inserts):
    """Whether so many lists can be inserted into, once each."""
    return taken[N_ROWS] + n_inserts * (_LEAST_ROWS << (taken[HIGHEST] + 1)) <= len(rows)


@kernel
def place_of(rows, begin, end, second):
    """Return the first of the rows from ``begin`` to ``end`` whose second cost is no larger, or ``end``."""
    n = end - begin
    while n > 0:
        # Without a branch, which processors would guess wrong half the time.
        half = (n + 1) >> 1
        begin += half * (rows[begin + half - 1, SECOND] > second)
        n -= half
    return begin


@kernel
def covered(lists, rows, number, heading, second, third, steps):
    """Whether two costs and a number of steps, along a heading, are dominated by, or equal to, a row of a list."""
    end = lists[number, BEGIN] + lists[number, SIZE]
    for k in range(place_of(rows, lists[number, BEGIN], end, second), end):
        if rows[k, THIRD + heading] <= third:
            if rows[k, STEPS] <= steps:
                return True
        elif rows[k, STEPS] >= steps:
            # Nor does one behind it that takes no more steps.
            return False
    return False


@inlined
def insert(lists, rows, taken, number, second, third, steps):
    """Add a second cost and third ones, int64, shape (n_headings,), to a list, unless a row of it covers them all.

    ``third`` is written over.
    """
    begin, size = lists[number, BEGIN], lists[number, SIZE]
    place = place_of(rows, begin, begin + size, second)
    is_new = True
    for k in range(place, begin + size):
        if rows[k, STEPS] > steps:
            continue
        is_new = False
        for h in range(len(third)):
            is_new |= third[h] < rows[k, THIRD + h]
            third[h] = min(third[h], rows[k, THIRD + h])
        if rows[k, STEPS] == steps or not is_new:
            break
    if not is_new:
        return
    if lists[number, ABOVE] == 0 or size == _LEAST_ROWS << (lists[number, ABOVE] - 1):
        enlarge(lists, rows, taken, number)
        place += lists[number, BEGIN] - begin
        begin = lists[number, BEGIN]
    end = begin + size
    # Behind those of the same second cost.
    while place < end and rows[place, SECOND] == second:
        place += 1
    first = place
    while first > begin:
        first -= 1
        if rows[first, STEPS] >= steps:
            is_lower = False
            for h in range(len(third)):
                is_lower |= third[h] < rows[first, THIRD + h]
                rows[first, THIRD + h] = min(rows[first, THIRD + h], third[h])
            if not is_lower and rows[first, STEPS] == steps:
                # Those before it cover the new one in all, too.
                break
    kept = first
    for k in range(first, place):
        serves = rows[k, STEPS] < steps
        for h in range(len(third)):
            serves |= rows[k, THIRD + h] != third[h]
        if serves:
            copy(rows, k, kept, 1)
            kept += 1
    copy(rows, place, kept + 1, end - place)
    rows[kept, SECOND] = second
    rows[kept, STEPS] = steps
    for h in range(len(third)):
        rows[kept, THIRD + h] = third[h]
    lists[number, SIZE] = kept + 1 + end - place - begin


@inlined
def copy(rows, source, target, n):
    """Copy ``n`` rows to where they, too, may be."""
    if source < target:
        for i in range(n - 1, -1, -1):
            for j in range(rows.shape[1]):
                rows[target + i, j] = rows[source + i, j]
    elif source > target:
        for i in range(n):
            for j in range(rows.shape[1]):
                rows[target + i, j] = rows[source + i, j]


@kernel
def enlarge(lists, rows, taken, number):
    """Move a list to a block of the next level."""
    old, level = lists[number, BEGIN], lists[number, ABOVE]
    new = taken[FREE + level]
    if new >= 0:
        taken[FREE + level] = rows[new, 0]
    else:
        new = taken[N_ROWS]
        taken[N_ROWS] += _LEAST_ROWS << level
        taken[HIGHEST] = max(taken[HIGHEST], level)
    if level > 0:
        copy(rows, old, new, lists[number, SIZE])
        rows[old, 0] = taken[FREE + level - 1]
        taken[FREE + level - 1] = old
    lists[number, BEGIN] = new
    lists[number, ABOVE] = level + 1
