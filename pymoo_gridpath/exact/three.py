"""The exact front of three objectives: a label-setting search in the line of LTMOA*."""

from __future__ import annotations

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.exact.budget import Meter
from pymoo_gridpath.exact.costs import Costs
from pymoo_gridpath.exact.smooth import smoothest_paths
from pymoo_gridpath.exact.two import CLOSED_FULL, DIRECT, DONE, FOUND_FULL, HEAP_FULL, PAUSED, Front, grow, trace
from pymoo_gridpath.search import UNREACHABLE, Moves, backward_costs

# Places in the array of counts.
N_OPEN, N_CLOSED, N_FOUND, N_POPPED, N_NODES, FREE_NODE = range(6)

# Why the kernel returned, besides the reasons that the search for two objectives has.
NODES_FULL = 5

_POPS_AT_A_TIME = 2**17


def front_of_three(moves: Moves, costs: Costs, start: int, goal: int, meter: Meter) -> Front:
    """Return the exact front of three objectives.

    Of paths with the same costs it holds the one that `smoothest_paths` chooses, as long as memory lasts; any one if a cost
    depends on headings.

    Labels are popped in lexicographic order, so that the first objective needs no comparison: a label is dominated if and only
    if one of the pairs (g2, g3) closed so far at its state is. With headings, a pair counts for the other headings of the
    cell too, by the turn that it takes to get there.

    Parameters
    ----------
    moves : Moves
    costs : Costs
        Of three objectives. If one depends on headings it must be the third.
    start, goal : int
    meter : Meter
        Ends the search when a budget is used up; the part of the front with the least first costs is returned then.

    References
    ----------
    C. Hernandez, W. Yeoh, J. A. Baier, A. Felner, O. Salzman, H. Zhang, S.-H. Chan and S. Koenig, "Multi-objective search via
    lazy and efficient dominance checks", IJCAI 2023 (LTMOA*). F.-J. Pulido, L. Mandow and J.-L. Perez-de-la-Cruz,
    "Dimensionality reduction in multiobjective shortest path search", Computers & Operations Research 64, 2015.
    """
    search = _Search(moves, costs, start, goal, meter)
    meter.n_fixed = search.n_fixed
    if not meter.message:
        search.run(meter)
    return Front(search.paths() if meter.message else search.smoothest_paths(meter), search.points())


class _Search:
    """The arrays of one search, which grow between calls of the kernel."""

    def __init__(self, moves: Moves, costs: Costs, start: int, goal: int, meter: Meter):
        self.moves, self.costs, self.start, self.goal = moves, costs, start, goal
        self.n_headings = 8 if costs.with_heading else 1
        self.bounds = np.stack([self._bound(k, meter) for k in range(3)], axis=1)
        # The last list is that of the paths found.
        self.lists = np.full(len(self.bounds) + 1, -1, dtype=np.int32)
        self.nodes = np.empty((4096, 3), dtype=np.int64)
        self.heap = np.empty((1024, 4), dtype=np.int64)
        self.closed = np.empty((1024, 2), dtype=np.int32)
        self.found = np.empty((64, 4), dtype=np.int64)
        self.counts = np.zeros(6, dtype=np.int64)
        self.counts[FREE_NODE] = -1
        self._open_first_steps()

    def _bound(self, k: int, meter: Meter) -> np.ndarray:
        """Return the least cost in one objective from every state."""
        pair = self.costs.take((k, k))
        with_heading = self.costs.with_heading and k == 2
        bound = backward_costs(self.moves, pair.step, pair.field, self.goal, with_heading, stop=meter.stop)[0][0]
        return bound if with_heading else np.repeat(bound, self.n_headings)

    def _open_first_steps(self) -> None:
        self.closed[0] = (self.start, -1)
        self.counts[N_CLOSED] = 1
        for m in range(8):
            if self.moves.legal[self.start] >> m & 1:
                cell = self.start + int(self.moves.offsets[m])
                state = 8 * cell + m if self.costs.with_heading else cell
                f = self.costs.step[:, 8, m] + self.costs.field[:, cell] + self.bounds[state]
                if f.max() < UNREACHABLE:
                    push(self.heap, self.counts[N_OPEN], f[0], f[1], 2 * f[2] + (cell == self.goal), (8 * cell + m) << 32)
                    self.counts[N_OPEN] += 1

    def run(self, meter: Meter) -> None:
        """Search until no label is left or a budget is used up."""
        status = PAUSED
        full = {HEAP_FULL: self.heap, CLOSED_FULL: self.closed, FOUND_FULL: self.found, NODES_FULL: self.nodes}
        while status != DONE:
            meter.check(self.n_labels, sum(array.nbytes for array in full.values()))
            if meter.message:
                return
            status = search_three(
                self.moves.legal,
                self.moves.offsets,
                self.costs.step,
                self.costs.field,
                self.costs.with_heading,
                DIRECT,
                self.bounds,
                self.start,
                self.goal,
                self.lists,
                self.nodes,
                self.heap,
                self.closed,
                self.found,
                self.counts,
                meter.pops(self.n_labels, _POPS_AT_A_TIME),
            )
            meter.note(self.n_labels, sum(array.nbytes for array in full.values()))
            if status in full:
                grow(full[status])

    @property
    def n_fixed(self) -> int:
        """Bytes of the arrays whose size is that of the grid."""
        return self.bounds.nbytes + self.lists.nbytes + self.costs.field.nbytes

    @property
    def n_labels(self) -> int:
        """Labels open and closed."""
        return int(self.counts[N_OPEN] + self.counts[N_CLOSED])

    def points(self) -> np.ndarray:
        """Return the costs of the paths found, int64, shape (N, 3)."""
        return self.found[: self.counts[N_FOUND], 1:].copy()

    def paths(self) -> list[np.ndarray]:
        """Return the cells of the paths found."""
        return [trace(self.closed, int(number)) for number in self.found[: self.counts[N_FOUND], 0]]

    def smoothest_paths(self, meter: Meter) -> list[np.ndarray]:
        """Return the cells of the paths found, or of better ones with the same costs."""
        if self.costs.with_heading:
            return self.paths()
        # What the search alone needed has served.
        self.heap = self.nodes = self.heap[:0].copy()
        closed, ends = self.closed[: self.counts[N_CLOSED]], self.found[: self.counts[N_FOUND], 0]
        paths = smoothest_paths(self.moves, self.costs, closed, ends, meter)
        return self.paths() if paths is None else paths


@kernel
def before(a, i, first, second, third):
    """Whether entry i of a heap comes before three keys."""
    if a[i, 0] != first:
        return a[i, 0] < first
    if a[i, 1] != second:
        return a[i, 1] < second
    return a[i, 2] < third


@kernel
def move(heap, source, target):
    """Copy an entry of a heap."""
    for k in range(4):
        heap[target, k] = heap[source, k]


@kernel
def push(heap, n, first, second, third, load):
    """Add an entry to the ``n`` that a heap of three keys holds."""
    i = n
    while i > 0:
        up = (i - 1) >> 1
        if before(heap, up, first, second, third):
            break
        move(heap, up, i)
        i = up
    heap[i, 0] = first
    heap[i, 1] = second
    heap[i, 2] = third
    heap[i, 3] = load


@kernel
def drop_first(heap, n):
    """Remove the least entry, ``heap[0]``, of the ``n`` that a heap of three keys holds."""
    last = n - 1
    first, second, third, load = heap[last, 0], heap[last, 1], heap[last, 2], heap[last, 3]
    i = 0
    while True:
        down = 2 * i + 1
        if down >= last:
            break
        if down + 1 < last and before(heap, down + 1, heap[down, 0], heap[down, 1], heap[down, 2]):
            down += 1
        if not before(heap, down, first, second, third):
            break
        move(heap, down, i)
        i = down
    heap[i, 0] = first
    heap[i, 1] = second
    heap[i, 2] = third
    heap[i, 3] = load


@kernel
def covered(lists, nodes, number, second, third):
    """Whether a pair is dominated by, or equal to, one of a list.

    A list is in ascending order of the third objective, and so in descending order of the second.
    """
    k = lists[number]
    while k >= 0 and nodes[k, 1] <= third:
        if nodes[k, 0] <= second:
            return True
        k = nodes[k, 2]
    return False


@kernel
def insert(lists, nodes, counts, number, second, third):
    """Add a pair to a list and drop those that it dominates; nothing if the list covers it already."""
    behind = -1
    k = lists[number]
    while k >= 0 and nodes[k, 1] <= third:
        if nodes[k, 0] <= second:
            return
        if nodes[k, 1] == third:
            break
        behind = k
        k = nodes[k, 2]
    while k >= 0 and nodes[k, 0] >= second:
        after = nodes[k, 2]
        nodes[k, 2] = counts[FREE_NODE]
        counts[FREE_NODE] = k
        k = after
    new = counts[FREE_NODE]
    if new >= 0:
        counts[FREE_NODE] = nodes[new, 2]
    else:
        new = counts[N_NODES]
        counts[N_NODES] += 1
    nodes[new, 0] = second
    nodes[new, 1] = third
    nodes[new, 2] = k
    if behind >= 0:
        nodes[behind, 2] = new
    else:
        lists[number] = new


@kernel
def search_three(
    legal,
    offsets,
    step,
    field,
    with_heading,
    direct,
    bounds,
    start,
    goal,
    lists,
    nodes,
    heap,
    closed,
    found,
    counts,
    max_pops,
):
    """Pop labels in lexicographic order until none is left, an array is full, or ``max_pops`` have been popped.

    Parameters
    ----------
    legal, offsets
        See `Moves`.
    step, field, with_heading
        See `Costs`.
    direct : int64, shape (8, 8)
        See `DIRECT`.
    bounds : int64, shape (n_states, 3)
        Lower bounds of the rest.
    start, goal : int
    lists : int32, shape (n_states + 1,)
        First node of the list of pairs (g2, g3) closed at each state, and, last, of (f2, f3) of the paths found; -1: empty.
    nodes : int64, shape (n, 3)
        Pairs and the number of the next node.
    heap : int64, shape (n, 4)
        Open labels: f1, f2, ``2 * f3`` (plus 1 at the goal, which so comes after all that is equal, see `smoothest_paths`) and
        ``(8 * cell + heading) << 32 | parent``.
    closed : int32, shape (n, 2)
        Closed labels: cell and number of the parent.
    found : int64, shape (n, 4)
        Numbers of the closed labels that are non-dominated paths, and their costs.
    counts : int64, shape (6,)
        State of the search, changed in place like all arrays from ``lists`` on.
    max_pops : int
    """
    n, n_closed = counts[N_OPEN], counts[N_CLOSED]
    ends = len(lists) - 1
    status = DONE
    pops = 0
    while n > 0:
        if n + 8 > len(heap):
            status = HEAP_FULL
            break
        if n_closed >= len(closed):
            status = CLOSED_FULL
            break
        if counts[N_FOUND] >= len(found):
            status = FOUND_FULL
            break
        if counts[N_NODES] + 9 > len(nodes):
            status = NODES_FULL
            break
        if pops >= max_pops:
            status = PAUSED
            break
        pops += 1
        f1, f2, f3, load = heap[0, 0], heap[0, 1], heap[0, 2] >> 1, heap[0, 3]
        drop_first(heap, n)
        n -= 1
        heading = (load >> 32) & 7
        cell = load >> 35
        state = load >> 32 if with_heading else cell
        g2 = f2 - bounds[state, 1]
        g3 = f3 - bounds[state, 2]
        if covered(lists, nodes, state, g2, g3) or covered(lists, nodes, ends, f2, f3):
            continue
        closed[n_closed, 0] = cell
        closed[n_closed, 1] = load & 0xFFFFFFFF
        if cell == goal:
            insert(lists, nodes, counts, ends, f2, f3)
            found[counts[N_FOUND], 0] = n_closed
            found[counts[N_FOUND], 1] = f1
            found[counts[N_FOUND], 2] = f2
            found[counts[N_FOUND], 3] = f3
            counts[N_FOUND] += 1
            n_closed += 1
            continue
        if with_heading:
            # Whoever turns on the spot from this heading to another is no worse than who came with that one and more turn.
            for h in range(8):
                insert(lists, nodes, counts, 8 * cell + h, g2, g3 + step[2, heading, h])
        else:
            insert(lists, nodes, counts, cell, g2, g3)
        g1 = f1 - bounds[state, 0]
        from_before = legal[cell - offsets[heading]]
        last = heading if with_heading else 8
        for m in range(8):
            if not (legal[cell] >> m) & 1:
                continue
            straight = direct[heading, m]
            if straight == 8 or (straight >= 0 and (from_before >> straight) & 1):
                continue
            next_cell = cell + offsets[m]
            if next_cell == start:
                continue
            next_state = 8 * next_cell + m if with_heading else next_cell
            next1 = g1 + step[0, last, m] + field[0, next_cell] + bounds[next_state, 0]
            if next1 >= 2**61:
                continue
            next2 = g2 + step[1, last, m] + field[1, next_cell]
            next3 = g3 + step[2, last, m] + field[2, next_cell]
            if covered(lists, nodes, next_state, next2, next3):
                continue
            next_f2 = next2 + bounds[next_state, 1]
            next_f3 = next3 + bounds[next_state, 2]
            if covered(lists, nodes, ends, next_f2, next_f3):
                continue
            push(heap, n, next1, next_f2, 2 * next_f3 + (next_cell == goal), (8 * next_cell + m) << 32 | n_closed)
            n += 1
        n_closed += 1
    counts[N_OPEN], counts[N_CLOSED] = n, n_closed
    counts[N_POPPED] += pops
    return status
