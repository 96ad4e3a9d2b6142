"""Cheapest costs from every cell to a goal."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.search.arrays import grown
from pymoo_gridpath.search.heap import drop_first, push
from pymoo_gridpath.search.moves import Moves

#: The cost where no path leads; sums of two such numbers do not overflow.
UNREACHABLE = 2**61

# Cells that are expanded before it is asked whether to stop: milliseconds when compiled.
_POPS = 2**13

# No more lists than this: to pass empty ones takes its time, too.
_MOST_LISTS = 2**14

# The dearest step leads so many lists ahead, as a power of two, where they are taken from in order: many steps are far cheaper.
_LIST_BITS = 10

# Why the kernel returned.
_DONE, _PAUSED, _HEAP_FULL = range(3)


def backward_costs(
    moves: Moves,
    step: np.ndarray,
    field: np.ndarray,
    goal: int,
    with_heading: bool = False,
    spent: np.ndarray | None = None,
    limit: int = UNREACHABLE,
    stop: Callable[[], bool] | None = None,
    enter: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the costs of the lexicographically cheapest path to a goal from every cell, or from every cell and heading.

    Of all paths with the least first cost it is one with the least second cost.

    Parameters
    ----------
    moves, step, field, goal, with_heading, spent, limit, enter
        See `Backward`.
    stop : callable, optional
        Asked many times a second; if it returns True the search ends, and what it has found so far holds for nothing.

    Returns
    -------
    costs : numpy.ndarray of int64, shape (2, n_cells) or (2, 8 * n_cells)
        Entry ``8 * cell + heading`` of the latter belongs to a path that has come to the cell along the heading.
        `UNREACHABLE` where no path leads.
    ahead : numpy.ndarray of int8, shape (n_cells,) or (8 * n_cells,)
        Heading of the first step of that path; -1 at the goal, and where no path leads.
    """
    search = Backward(moves, step, field, goal, with_heading, spent, limit, enter)
    search.run(stop)
    return search.cost, search.ahead


class Backward:
    """A search for the cheapest paths to a goal that can be interrupted, and go on.

    Parameters
    ----------
    moves : Moves
    step : numpy.ndarray of int64, shape (2, 9, 8)
        First and second cost of a step along heading m (last index) after one along heading h (8: none before).
    field : numpy.ndarray of int64, shape (2, n_cells)
        First and second cost of entering each cell.
    goal : int
        Index of the goal cell.
    with_heading : bool, default False
        Whether costs depend on the heading before a step.
    spent : numpy.ndarray of int64, shape (n_cells,), or (2, n_cells) with weights, optional
        Least first cost of a path from somewhere to each cell, 0 by default; with weights, least costs of both kinds.
    limit : int, optional
        Cells are left out, as if no path led on, where the least first cost of what is spent and what lies ahead reaches it.
    enter : numpy.ndarray of int64, shape (2, n_cells, 8), optional
        First and second cost of entering each cell along each heading, besides.
    weights : (float, float), optional
        What is minimised then is the sum of both costs times these, each part of it rounded down, and next the first cost.

    Attributes
    ----------
    cost, ahead
        See `backward_costs`. Those of a search that is not at its end hold for what is nearer than it has come.
    """

    def __init__(
        self,
        moves: Moves,
        step: np.ndarray,
        field: np.ndarray,
        goal: int,
        with_heading: bool = False,
        spent: np.ndarray | None = None,
        limit: int = UNREACHABLE,
        enter: np.ndarray | None = None,
        weights: tuple[float, float] | None = None,
    ):
        self.moves, self.field, self.enter, self.with_heading, self.weights = moves, field, enter, with_heading, weights
        self.step = step if weights is None else _sums(step, weights)
        self.spent, self.limit = spent, limit
        self.cost = np.full((2, moves.n_cells * (8 if with_heading else 1)), UNREACHABLE)
        self.ahead = np.full(self.cost.shape[1], -1, dtype=np.int8)
        self.cost[:, slice(8 * goal, 8 * goal + 8) if with_heading else goal] = 0
        # Weights are applied on the way, to what each step takes.
        width, n_lists, in_order = self._lists(goal)
        self._shift = width.bit_length() - 1
        self._first_of, self._links = np.full(n_lists, -1, dtype=np.int32), np.full((2, self.cost.shape[1]), -1, dtype=np.int32)
        goals = np.arange(8 * goal, 8 * goal + 8) if with_heading else np.array([goal])
        self._first_of[0] = goals[0]
        self._links[0, goals[:-1]], self._links[1, goals[1:]] = goals[1:], goals[:-1]
        self._blocks = np.zeros(max(n_lists >> 6, 1), dtype=np.int32)
        self._blocks[0] = len(goals)
        self._in_order, self._heap = in_order or None, np.empty((1024, 3), dtype=np.int64)
        self._counts = np.array([0, len(goals), 0])
        self.spent = None if spent is None else np.atleast_2d(spent)

    def _lists(self, goal: int) -> tuple[int, int, bool]:
        """Return the width in first cost of the lists that states are taken from, how many, and whether in order from each.

        From a list that is no wider than the least step they may be taken in any order: no step leads from it to itself. That
        does no harm, either, in one of a single cost, if the second is the same.
        """
        least, most = int(self.step[0].min()), int(self.step[0].max())
        for costs in (self.field, self.enter):
            if costs is not None and self.weights is None:
                most += int(costs[0].max())
            elif costs is not None and self.weights is not None:
                most += sum(int(weight * int(part.max())) + 1 for weight, part in zip(self.weights, costs, strict=True))
        if self.weights is None and not self.with_heading:
            # Steps lead to the goal, and to cells that steps lead on from.
            least += int(min(self.field[0, goal], self.field[0].min(initial=UNREACHABLE, where=self.moves.legal > 0)))
        width = 1 << (max(least, 1).bit_length() - 1)
        any_order = ((least > 0 and not self.with_heading) or self._alone) and most // width + 2 <= _MOST_LISTS
        if not any_order:
            # A heap of one list at a time; no more lists than a quarter of the states.
            bits = min(max(self.cost.shape[1].bit_length() - 2, 6), _LIST_BITS, _MOST_LISTS.bit_length() - 2)
            width = 1 << max(most.bit_length() - bits, 0)
        return width, 1 << (most // width + 2).bit_length(), not any_order

    @property
    def _alone(self) -> bool:
        """Whether both costs are the same."""
        pairs = self.step, self.field, self.enter
        return self.weights is None and all(pair is None or np.array_equal(*pair) for pair in pairs)

    def run(self, stop: Callable[[], bool] | None = None, until: int | None = None, beyond: int = UNREACHABLE) -> None:
        """Go on until all is found.

        Parameters
        ----------
        stop : callable, optional
            Asked many times a second; if it returns True the search ends, and what it has found so far holds for nothing.
        until : int, optional
            Or until the cost of this cell is found, and all that are no greater; only without headings.
        beyond : int, optional
            Or until all first costs below this are found.
        """
        moves, until = self.moves, -1 if until is None else until
        while True:
            costs = self.step, self.field, self.enter, 8 if self.with_heading else None
            costs = *costs, self.weights is not None, self.weights or (1.0, 0.0), self.spent
            lists = self._first_of, self._blocks, self._links, self._heap, self._counts, self._shift, self._in_order
            status = _take(moves.legal, moves.offsets, *costs, self.limit, self.cost, self.ahead, *lists, until, beyond, _POPS)
            if status == _HEAP_FULL:
                self._heap = grown(self._heap)
            elif status == _DONE or (stop is not None and stop()):
                break

    def first_step(self, cell: int) -> tuple[int, int]:
        """Return the first cost of the cheapest path that begins in a cell, and the heading of its first step, -1 for none."""
        costs = self.step, self.field, self.enter, self.with_heading, self.weights is not None, self.weights or (1.0, 0.0)
        return first_step(self.moves.legal, self.moves.offsets, *costs, self.cost, cell)


@kernel
def first_step(legal, offsets, step, field, enter, with_heading, fused, weights, cost, cell):
    """Return the first cost of the cheapest path that begins in a cell, and the heading of its first step, -1 for none."""
    best1 = best2 = UNREACHABLE
    first = -1
    for m in range(8):
        if not (legal[cell] >> m) & 1:
            continue
        after = cell + offsets[m]
        state = 8 * after + m if with_heading else after
        one, two = cost[0, state] + step[0, 8, m], cost[1, state] + step[1, 8, m]
        if fused:
            one += np.int64(np.floor(weights[0] * field[0, after] + weights[1] * field[1, after]))
            two += field[0, after]
        else:
            one += field[0, after]
            two += field[1, after]
        if enter is not None and fused:
            one += np.int64(np.floor(weights[0] * enter[0, after, m] + weights[1] * enter[1, after, m]))
            two += enter[0, after, m]
        elif enter is not None:
            one += enter[0, after, m]
            two += enter[1, after, m]
        if one < best1 or (one == best1 and two < best2):
            best1, best2, first = one, two, m
    return best1, first


def _sums(costs: np.ndarray, weights: tuple[float, float]) -> np.ndarray:
    """Return weighted sums of two costs, rounded down, and the first cost."""
    return np.stack([np.floor(weights[0] * costs[0] + weights[1] * costs[1]).astype(np.int64), costs[0]])


@kernel
def _take(
    legal,
    offsets,
    step,
    field,
    enter,
    headings,
    fused,
    weights,
    spent,
    limit,
    cost,
    ahead,
    lists,
    blocks,
    links,
    heap,
    counts,
    shift,
    in_order,
    until,
    beyond,
    max_pops,
):
    """Take at most so many states from lists, those of the list with the least first costs first.

    States are in the list of their first cost, by its bits from ``shift`` on; lists come round again. If no step costs less
    than a list is wide, the costs of what is in it are final once its turn has come. Otherwise they are taken in order, from a
    heap.

    Parameters
    ----------
    headings : int, or None
        8 where costs depend on the heading; None, so that the compiler leaves out what is for them, where they do not.
    lists : int32, shape (n,)
        The first state of each list, -1 if it has none; n is a power of two.
    blocks : int32, shape (max(n // 64, 1),)
        How many states are in each 64 lists together: where steps differ much, most lists have none.
    links : int32, shape (2, n_states)
        The next state in the list of each, and the one before, -1 at the ends.
    heap : int64, shape (n, 3)
        Of the list whose turn it is, if it is taken from in order: costs and states; those that have found lower ones since do
        not count.
    counts : int64, shape (3,)
        The number of the list whose turn it is, how many states are in all lists, and how many entries in the heap.
    in_order : True, or None
        None, for the compiler again, where states are taken from lists in any order.

    Returns
    -------
    status : int
        Whether the search has come as far as it is to, there is no room in the heap, or so many states have been taken.
    """
    mask = len(lists) - 1
    pops = 0
    while pops < max_pops:
        here = counts[0] & mask
        if counts[2] == 0:
            if counts[1] == 0:
                return _DONE
            if lists[here] < 0:
                turn = counts[0]
                while lists[turn & mask] < 0:
                    turn += 1
                    while turn & 63 == 0 and blocks[(turn & mask) >> 6] == 0:
                        turn += 64
                counts[0] = turn
                here = turn & mask
                reached = turn << shift
                if reached >= beyond or (until >= 0 and reached > cost[0, until]):
                    return _DONE
        if in_order is not None:
            if lists[here] >= 0:
                move_to_heap(lists, blocks, links, here, cost, heap, counts)
            # As many as one state leads to, or the whole list.
            if counts[2] + 8 > len(heap) or lists[here] >= 0:
                return _HEAP_FULL
            first, second, state = heap[0, 0], heap[0, 1], heap[0, 2]
            if first >= beyond or (until >= 0 and first > cost[0, until]):
                return _DONE
            drop_first(heap, counts[2])
            counts[2] -= 1
            if first > cost[0, state] or second > cost[1, state]:
                continue
        else:
            state = np.int64(lists[here])
            _unlink(lists, blocks, links, here, state)
            counts[1] -= 1
        pops += 1
        cell = state if headings is None else state >> 3
        if fused:
            first = cost[0, state] + np.int64(np.floor(weights[0] * field[0, cell] + weights[1] * field[1, cell]))
            second = cost[1, state] + field[0, cell]
        else:
            first = cost[0, state] + field[0, cell]
            second = cost[1, state] + field[1, cell]
        for m in range(8):
            # A state with a heading can only have been reached along it.
            if headings is not None and m != state & 7:
                continue
            before = cell - offsets[m]
            if before < 0 or before >= len(legal) or not (legal[before] >> m) & 1:
                continue
            into1 = first
            into2 = second
            if enter is not None:
                if fused:
                    into1 += np.int64(np.floor(weights[0] * enter[0, cell, m] + weights[1] * enter[1, cell, m]))
                    into2 += enter[0, cell, m]
                else:
                    into1 += enter[0, cell, m]
                    into2 += enter[1, cell, m]
            so_far = 0
            if spent is not None:
                so_far = spent[0, before]
                if fused:
                    so_far = np.int64(np.floor(weights[0] * so_far + weights[1] * spent[1, before]))
            for h in range(1 if headings is None else 8):
                origin = before if headings is None else 8 * before + h
                heading = 8 if headings is None else h
                total1 = into1 + step[0, heading, m]
                total2 = into2 + step[1, heading, m]
                known = cost[0, origin]
                if total1 > known or (total1 == known and total2 >= cost[1, origin]) or total1 + so_far >= limit:
                    continue
                cost[0, origin] = total1
                cost[1, origin] = total2
                ahead[origin] = m
                if in_order is not None and total1 >> shift == counts[0]:
                    if known < UNREACHABLE and known >> shift != counts[0]:
                        _unlink(lists, blocks, links, (known >> shift) & mask, origin)
                        counts[1] -= 1
                    push(heap, counts[2], total1, total2, origin)
                    counts[2] += 1
                    continue
                if known < UNREACHABLE and known >> shift == total1 >> shift:
                    continue
                if known < UNREACHABLE:
                    _unlink(lists, blocks, links, (known >> shift) & mask, origin)
                else:
                    counts[1] += 1
                here = (total1 >> shift) & mask
                links[0, origin] = lists[here]
                links[1, origin] = -1
                if lists[here] >= 0:
                    links[1, lists[here]] = origin
                lists[here] = origin
                blocks[here >> 6] += 1
    return _DONE if counts[1] == 0 and counts[2] == 0 else _PAUSED


@kernel
def move_to_heap(lists, blocks, links, number, cost, heap, counts):
    """Move the states of a list to the heap, as many as there is room for."""
    state = np.int64(lists[number])
    while state >= 0 and counts[2] < len(heap):
        push(heap, counts[2], cost[0, state], cost[1, state], state)
        counts[2] += 1
        counts[1] -= 1
        blocks[number >> 6] -= 1
        state = np.int64(links[0, state])
    lists[number] = state
    if state >= 0:
        links[1, state] = -1


@kernel
def _unlink(lists, blocks, links, number, state):
    """Take a state out of a list."""
    blocks[number >> 6] -= 1
    after = links[0, state]
    before = links[1, state]
    if before >= 0:
        links[0, before] = after
    else:
        lists[number] = after
    if after >= 0:
        links[1, after] = before
