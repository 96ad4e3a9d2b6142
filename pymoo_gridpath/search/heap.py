"""Heaps in arrays, for kernels.

The kernels only move entries: whoever calls them keeps the count and sees that there is room. Two are binary, of rows of whole
numbers, their keys, compared one after another, and their load: one of two keys, in which of equal entries the first stays
before, and one of four. The third is of single keys, whole numbers or others, beside the cells that they belong to, with four
entries below each.
"""

from __future__ import annotations

from pymoo_gridpath.compiled import kernel


@kernel
def push(heap, n, first, second, load):
    """Add an entry to the ``n`` that a heap of two keys holds."""
    i = n
    while i > 0:
        up = (i - 1) >> 1
        if heap[up, 0] < first or (heap[up, 0] == first and heap[up, 1] <= second):
            break
        heap[i, 0] = heap[up, 0]
        heap[i, 1] = heap[up, 1]
        heap[i, 2] = heap[up, 2]
        i = up
    heap[i, 0] = first
    heap[i, 1] = second
    heap[i, 2] = load


@kernel
def drop_first(heap, n):
    """Remove the least entry, ``heap[0]``, of the ``n`` that a heap of two keys holds."""
    last = n - 1
    first = heap[last, 0]
    second = heap[last, 1]
    load = heap[last, 2]
    i = 0
    while True:
        down = 2 * i + 1
        if down >= last:
            break
        # Without a branch, which processors would guess wrong half the time; what was the last entry is still in its place.
        right = down + 1
        down += (heap[right, 0] < heap[down, 0]) | ((heap[right, 0] == heap[down, 0]) & (heap[right, 1] < heap[down, 1]))
        if first < heap[down, 0] or (first == heap[down, 0] and second <= heap[down, 1]):
            break
        heap[i, 0] = heap[down, 0]
        heap[i, 1] = heap[down, 1]
        heap[i, 2] = heap[down, 2]
        i = down
    heap[i, 0] = first
    heap[i, 1] = second
    heap[i, 2] = load


@kernel
def _before(a, i, first, second, third, fourth):
    """Whether entry i of a heap comes before four keys; without a branch."""
    last_two = (a[i, 2] < third) | ((a[i, 2] == third) & (a[i, 3] < fourth))
    return (a[i, 0] < first) | ((a[i, 0] == first) & ((a[i, 1] < second) | ((a[i, 1] == second) & last_two)))


@kernel
def _move(heap, source, target):
    """Copy an entry of a heap."""
    for k in range(5):
        heap[target, k] = heap[source, k]


@kernel
def _fill(heap, i, first, second, third, fourth, load):
    """Write an entry of a heap."""
    heap[i, 0] = first
    heap[i, 1] = second
    heap[i, 2] = third
    heap[i, 3] = fourth
    heap[i, 4] = load


@kernel
def push_four(heap, n, first, second, third, fourth, load):
    """Add an entry to the ``n`` that a heap of four keys holds."""
    i = n
    while i > 0:
        up = (i - 1) >> 1
        if _before(heap, up, first, second, third, fourth):
            break
        _move(heap, up, i)
        i = up
    _fill(heap, i, first, second, third, fourth, load)


@kernel
def drop_first_of_four(heap, n):
    """Remove the least entry, ``heap[0]``, of the ``n`` that a heap of four keys holds."""
    last = n - 1
    first, second, third, fourth, load = heap[last, 0], heap[last, 1], heap[last, 2], heap[last, 3], heap[last, 4]
    i = 0
    while True:
        down = 2 * i + 1
        if down >= last:
            break
        down += _before(heap, down + 1, heap[down, 0], heap[down, 1], heap[down, 2], heap[down, 3])
        if not _before(heap, down, first, second, third, fourth):
            break
        _move(heap, down, i)
        i = down
    _fill(heap, i, first, second, third, fourth, load)


@kernel
def push_key(keys, cells, n, key, cell):
    """Add an entry to the ``n`` of a heap of single keys."""
    i = n
    while i > 0:
        up = (i - 1) >> 2
        if keys[up] <= key:
            break
        keys[i] = keys[up]
        cells[i] = cells[up]
        i = up
    keys[i] = key
    cells[i] = cell


@kernel
def drop_key(keys, cells, n):
    """Move the last entry, number ``n``, of a heap of single keys to the place of the first, which has been taken."""
    key = keys[n]
    cell = cells[n]
    i = 0
    while True:
        least = 4 * i + 1
        if least >= n:
            break
        for k in range(least + 1, min(least + 4, n)):
            if keys[k] < keys[least]:
                least = k
        if key <= keys[least]:
            break
        keys[i] = keys[least]
        cells[i] = cells[least]
        i = least
    keys[i] = key
    cells[i] = cell
