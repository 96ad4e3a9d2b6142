"""A binary heap in one array, for kernels.

An entry is a row of three whole numbers, compared by the first and then by the second; the third is its load. The kernels
only move entries: whoever calls them keeps the count and sees that there is room.
"""

from __future__ import annotations

from pymoo_gridpath.compiled import kernel


@kernel
def push(heap, n, first, second, load):
    """Add an entry to the ``n`` that the heap holds."""
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
    """Remove the least entry, ``heap[0]``, of the ``n`` that the heap holds."""
    last = n - 1
    first = heap[last, 0]
    second = heap[last, 1]
    load = heap[last, 2]
    i = 0
    while True:
        down = 2 * i + 1
        if down >= last:
            break
        right = down + 1
        if right < last and (
            heap[right, 0] < heap[down, 0] or (heap[right, 0] == heap[down, 0] and heap[right, 1] < heap[down, 1])
        ):
            down = right
        if first < heap[down, 0] or (first == heap[down, 0] and second <= heap[down, 1]):
            break
        heap[i, 0] = heap[down, 0]
        heap[i, 1] = heap[down, 1]
        heap[i, 2] = heap[down, 2]
        i = down
    heap[i, 0] = first
    heap[i, 1] = second
    heap[i, 2] = load
