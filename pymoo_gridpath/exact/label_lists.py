"""Lists of what is non-dominated among a second and a third cost and a number of steps, one list for each state of a search.

A list is a block of rows of an array that all lists share, in ascending order of the third cost. Where steps are not counted
the second cost falls, so that one row tells whether a list covers what is new.
"""

from __future__ import annotations

import numpy as np

from pymoo_gridpath.compiled import inlined, kernel

# Rows of the smallest block; that of a level has twice as many as that of the level below.
_LEAST_ROWS = 4

# Columns of the array of lists: first row, number of rows in use, and number of the level above, 0 before there is a block.
BEGIN, SIZE, ABOVE = range(3)

# Places in the array of what is taken: rows, the highest level, and the first free block of each level.
N_ROWS, HIGHEST, FREE = range(3)


def empty_lists(n_lists: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return so many lists, int64, shape (n_lists, 3), their rows, int64, shape (n, 3), and what is taken of these, int64."""
    taken = np.full(64, -1)
    taken[N_ROWS] = taken[HIGHEST] = 0
    return np.zeros((n_lists, 3), dtype=np.int64), np.empty((4096, 3), dtype=np.int64), taken


@kernel
def has_room(rows, taken, n_inserts):
    """Whether so many lists can be inserted into, once each."""
    return taken[N_ROWS] + n_inserts * (_LEAST_ROWS << (taken[HIGHEST] + 1)) <= len(rows)


@kernel
def place_behind(rows, begin, end, third):
    """Return the first of the rows from ``begin`` to ``end`` whose third cost is larger, or ``end``."""
    n = end - begin
    while n > 0:
        # Without a branch, which processors would guess wrong half the time.
        half = (n + 1) >> 1
        begin += half * (rows[begin + half - 1, 1] <= third)
        n -= half
    return begin


@kernel
def covered(lists, rows, number, second, third, steps):
    """Whether two costs and a number of steps are dominated by, or equal to, a row of a list."""
    begin = lists[number, BEGIN]
    return covered_before(rows, begin, place_behind(rows, begin, begin + lists[number, SIZE], third), second, steps)


@kernel
def covered_before(rows, begin, behind, second, steps):
    """The same, where those before a row are the ones that have no larger third cost."""
    for k in range(behind - 1, begin - 1, -1):
        if rows[k, 0] <= second:
            if rows[k, 2] <= steps:
                return True
        elif rows[k, 2] >= steps:
            # A row before this one that covered the new one would cover this one, too.
            return False
    return False


@inlined
def insert(lists, rows, taken, number, second, third, steps):
    """Add a row to a list and drop those that it dominates; nothing if the list covers it already."""
    begin, size = lists[number, BEGIN], lists[number, SIZE]
    place = place_behind(rows, begin, begin + size, third)
    if covered_before(rows, begin, place, second, steps):
        return
    while place > begin and rows[place - 1, 1] == third:
        place -= 1
    if lists[number, ABOVE] == 0 or size == _LEAST_ROWS << (lists[number, ABOVE] - 1):
        enlarge(lists, rows, taken, number)
        place += lists[number, BEGIN] - begin
        begin = lists[number, BEGIN]
    end = begin + size
    kept = place
    k = place
    while k < end:
        if rows[k, 0] < second and rows[k, 2] <= steps:
            # What comes behind it is not dominated, or it would be by this one.
            break
        if rows[k, 0] < second or rows[k, 2] < steps:
            copy(rows, k, kept, 1)
            kept += 1
        k += 1
    # The new row, those kept, and all behind.
    copy(rows, k, kept + 1, end - k)
    copy(rows, place, place + 1, kept - place)
    rows[place, 0] = second
    rows[place, 1] = third
    rows[place, 2] = steps
    lists[number, SIZE] = kept + 1 + end - k - begin


@inlined
def copy(rows, source, target, n):
    """Copy ``n`` rows to where they, too, may be."""
    if source < target:
        for i in range(n - 1, -1, -1):
            for j in range(3):
                rows[target + i, j] = rows[source + i, j]
    elif source > target:
        for i in range(n):
            for j in range(3):
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
