"""Of all paths that have the costs of a point of the front, the one that visits the fewest cells, and of these turns least.

A label search keeps one label for each state and costs, and one path to it. But whatever else leads there at the same costs
comes from labels that it has kept, too: the beginning of a path to a point of the front is dominated by no other. So the labels
hold all paths to the front, and the fewest steps and the least turn among them follow from the start on.

With the length among the objectives, all of them take the same number of steps.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.exact.budget import Meter
from pymoo_gridpath.exact.costs import TURN_UNITS, Costs
from pymoo_gridpath.neighbourhood import HEADING_OF
from pymoo_gridpath.search import Moves
from pymoo_gridpath.search.arrays import grown, room

# More than any path turns.
_NEVER = np.iinfo(np.int32).max // 2

# Bytes of a closed label while the labels are put in order, besides 8 for each cost, and of one that leads to the ends at hand.
_BYTES_OF_CLOSED, _BYTES_OF_LEADING = 8 + 4 + 4, 2 * 4 + 8 + 8 * (4 + 4 + 1)

# The same for the search for the fewest steps.
_BYTES_OF_STEPS = 8 * 4 + 8 + 8 + 4 + 4

# Ends are taken together until this share of the labels, or this number, leads to them: they have beginnings in common.
_SHARE_AT_A_TIME, _LEAST_AT_A_TIME = 1 / 16, 2**9


def traced_paths(closed: np.ndarray, ends: np.ndarray) -> list[np.ndarray]:
    """Return the cells of the path by which each of some labels was found."""
    return [_traced(closed, end) for end in ends]


def smoothest_paths(moves: Moves, costs: Costs, closed: np.ndarray, ends: np.ndarray, meter: Meter) -> list[np.ndarray]:
    """Return the cells of the best path to each of some labels.

    Where costs depend on headings, or there is too little memory, it is that by which the label was found.

    Parameters
    ----------
    moves : Moves
    costs : Costs
    closed : numpy.ndarray of int32, shape (n, 2)
        Cells and parents of the labels, those of each cell in ascending order of the first cost; the first is the start. None
        but the ends may be missing among those that could lead to an end at its costs.
    ends : numpy.ndarray of int64, shape (N,)
        Numbers of labels that are non-dominated paths.
    meter : Meter
    """
    if costs.with_heading:
        return traced_paths(closed, ends)
    same_steps = costs.tells_steps
    of_closed = _BYTES_OF_CLOSED + 8 * len(costs.step)
    of_leading = _BYTES_OF_LEADING + (0 if same_steps else _BYTES_OF_STEPS)
    if not meter.has_room(meter.n_fixed + len(closed) * (of_closed + of_leading)):
        return traced_paths(closed, ends)
    first, place = _grouped(closed, moves.n_cells)
    cell, spent = _spent(closed, place, moves.width, HEADING_OF, costs.step, costs.field, costs.enter)
    start, end = place[0], place[ends]
    del place
    grid = moves.legal, moves.offsets, costs.step, costs.field, costs.enter
    slot = np.full(len(closed), -1, dtype=np.int32)
    at_a_time = max(_LEAST_AT_A_TIME, int(len(closed) * _SHARE_AT_A_TIME))
    paths: list[np.ndarray] = []
    labels: Any
    steps: Any
    while len(paths) < len(end):
        # From here on labels are known by their place in the order of the cells, and those that lead to the ends by their slot.
        labels, parents, n = _leading_to(end[len(paths) :], at_a_time, cell, spent, first, *grid, slot)
        if same_steps:
            # Each step costs something.
            order = np.argsort(spent[labels].sum(axis=1), kind="stable")
        else:
            steps = _fewest_steps(parents, slot[start])
            parents[(parents >= 0) & (steps[parents] + 1 != steps[:, None])] = -1
            order = np.argsort(steps, kind="stable")
        turn = np.full((len(labels), 8), _NEVER, dtype=np.int32)
        before = np.full((len(labels), 8), -1, dtype=np.int8)
        _least_turns(order, parents, slot[start], TURN_UNITS, turn, before)
        cells = cell[labels]
        paths += [_trace(cells, parents, slot[start], turn, before, slot[k]) for k in end[len(paths) : len(paths) + n]]
        slot[labels] = -1
        meter.note(len(closed), len(closed) * of_closed + len(labels) * of_leading)
    return paths


@kernel
def _grouped(closed, n_cells):
    """Return where the labels of each cell begin when ordered by cells, and the place of each label in that order."""
    first = np.zeros(n_cells + 1, dtype=np.int64)
    for k in range(len(closed)):
        first[closed[k, 0] + 1] += 1
    for cell in range(n_cells):
        first[cell + 1] += first[cell]
    following = first.copy()
    place = np.empty(len(closed), dtype=np.int32)
    for k in range(len(closed)):
        place[k] = following[closed[k, 0]]
        following[closed[k, 0]] += 1
    return first, place


@kernel
def _spent(closed, place, width, heading_of, step, field, enter):
    """Return the cell, int32, shape (n,), and the costs, int64, shape (n, k), of the label at each place."""
    cells = np.empty(len(closed), dtype=np.int32)
    cells[place[0]] = closed[0, 0]
    spent = np.zeros((len(closed), len(step)), dtype=np.int64)
    for k in range(1, len(closed)):
        cell = closed[k, 0]
        parent = closed[k, 1]
        before = closed[parent, 0]
        m = heading_of[cell // width - before // width + 1, cell % width - before % width + 1]
        for i in range(len(step)):
            spent[place[k], i] = spent[place[parent], i] + step[i, 8, m] + field[i, cell]
            if enter is not None:
                spent[place[k], i] += enter[i, cell, m]
        cells[place[k]] = cell
    return cells, spent


@kernel
def _find_parents(label, cell, spent, first, legal, offsets, step, field, enter, parents):
    """Fill in the label from which a step along each heading leads to a label at its costs, -1 if there is none."""
    here = cell[label]
    for m in range(8):
        parents[m] = -1
        before = here - offsets[m]
        if before < 0 or before >= len(legal) or not (legal[before] >> m) & 1:
            continue
        wanted = spent[label, 0] - step[0, 8, m] - field[0, here]
        if enter is not None:
            wanted -= enter[0, here, m]
        low = first[before]
        high = first[before + 1]
        while low < high:
            middle = (low + high) >> 1
            if spent[middle, 0] < wanted:
                low = middle + 1
            else:
                high = middle
        while low < first[before + 1] and spent[low, 0] == wanted:
            same = True
            for i in range(1, len(step)):
                before_it = spent[label, i] - step[i, 8, m] - field[i, here]
                if enter is not None:
                    before_it -= enter[i, here, m]
                same = same and spent[low, i] == before_it
            if same:
                parents[m] = low
                break
            low += 1


@kernel
def _leading_to(ends, at_a_time, cell, spent, first, legal, offsets, step, field, enter, slot):
    """Return the labels on paths to the first so many ends, the slots of their parents by heading, and how many ends these are.

    The slot of each of those labels is filled in.
    """
    labels = np.empty(1024, dtype=np.int32)
    parents = np.empty((1024, 8), dtype=np.int32)
    n = 0
    i = 0
    n_ends = 0
    while n_ends < len(ends) and n < at_a_time:
        end = ends[n_ends]
        n_ends += 1
        labels = room(labels, n + 1)
        if slot[end] < 0:
            slot[end] = n
            labels[n] = end
            n += 1
        while i < n:
            labels = room(labels, n + 8)
            if i == len(parents):
                parents = grown(parents)
            grid = legal, offsets, step, field, enter
            i, n = _add_parents(i, n, labels, parents, cell, spent, first, *grid, slot)
    return labels[:n].copy(), parents[:n].copy(), n_ends


@kernel
def _add_parents(i, n, labels, parents, cell, spent, first, legal, offsets, step, field, enter, slot):
    """Add the parents of ``n`` labels, from number ``i`` on, as long as there is room; return both numbers then."""
    while i < n and i < len(parents) and n + 8 <= len(labels):
        _find_parents(labels[i], cell, spent, first, legal, offsets, step, field, enter, parents[i])
        for m in range(8):
            parent = parents[i, m]
            if parent < 0:
                continue
            if slot[parent] < 0:
                slot[parent] = n
                labels[n] = parent
                n += 1
            parents[i, m] = slot[parent]
        i += 1
    return i, n


@kernel
def _fewest_steps(parents, start):
    """Return the fewest steps of a path to each label, int32, shape (n,), by a breadth-first search."""
    first = np.zeros(len(parents) + 1, dtype=np.int64)
    for i in range(len(parents)):
        for m in range(8):
            if parents[i, m] >= 0:
                first[parents[i, m] + 1] += 1
    for i in range(len(parents)):
        first[i + 1] += first[i]
    following = first.copy()
    children = np.empty(first[len(parents)], dtype=np.int32)
    for i in range(len(parents)):
        for m in range(8):
            if parents[i, m] >= 0:
                children[following[parents[i, m]]] = i
                following[parents[i, m]] += 1
    steps = np.full(len(parents), -1, dtype=np.int32)
    queue = np.empty(len(parents), dtype=np.int32)
    queue[0] = start
    steps[start] = 0
    n = 1
    k = 0
    while k < n:
        label = queue[k]
        k += 1
        for j in range(first[label], first[label + 1]):
            child = children[j]
            if steps[child] < 0:
                steps[child] = steps[label] + 1
                queue[n] = child
                n += 1
    return steps


@kernel
def _least_turns(order, parents, start, units, turn, before):
    """Fill in the least turn of a path to each label that comes along each heading, and the heading before that."""
    for i in order:
        for m in range(8):
            parent = parents[i, m]
            if parent == start:
                # Nothing comes before the first step.
                turn[i, m] = 0
                continue
            if parent < 0:
                continue
            for h in range(8):
                total = turn[parent, h] + units[h, m]
                if total < turn[i, m]:
                    turn[i, m] = total
                    before[i, m] = h


@kernel
def _trace(cell, parents, start, turn, before, end):
    """Return the cells of the path with the least turn to a label."""
    last = 0
    for m in range(8):
        if turn[end, m] < turn[end, last]:
            last = m
    n = 1
    label = end
    heading = last
    while label != start:
        parent = parents[label, heading]
        heading = before[label, heading]
        label = parent
        n += 1
    cells = np.empty(n, dtype=np.int64)
    label = end
    heading = last
    for k in range(n - 1, -1, -1):
        cells[k] = cell[label]
        if k > 0:
            parent = parents[label, heading]
            heading = before[label, heading]
            label = parent
    return cells


@kernel
def _traced(closed, number):
    """Return the cells of the path that ends with a closed label, int64."""
    n = 0
    label = number
    while label >= 0:
        n += 1
        label = closed[label, 1]
    cells = np.empty(n, dtype=np.int64)
    label = number
    for k in range(n - 1, -1, -1):
        cells[k] = closed[label, 0]
        label = closed[label, 1]
    return cells
