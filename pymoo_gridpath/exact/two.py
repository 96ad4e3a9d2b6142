"""The exact front of two objectives: a label-setting search in the line of BOA*, with bounds from the hull of the front.

The search is BOA* (labels popped in ascending order of f1, so that one number a state, the least g2 so far, tells whether a
label is dominated), with additions that leave the result as it is:

- A label must be able to end below the staircase of paths that are known already. Between two neighbouring points of the
  hull, its cheapest weighted completion has to stay below the furthest corner of the staircase there (the second phase of the
  two-phase method).
- Each label that is closed, like each cell of the paths on the hull before, is joined to the cheapest way on by the weighted
  sum of its gap. What costs little is near the front, and lowers the staircase long before the search gets there.
- A step is skipped if the cell before led straight to its end and no cost speaks against it: the detour is dominated. And so
  is one that is no better than the label that was opened last for the same state.

Where paths near the front will do, the staircase, and what the last path found cost, are lowered by what may be missed: the
known paths stand in for what lies no farther below them. Among labels at a cell dominance stays exact, since errors there
would add up along the path.
"""

from __future__ import annotations

import dataclasses
import functools
from typing import ClassVar

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.exact.budget import Meter
from pymoo_gridpath.exact.costs import Costs
from pymoo_gridpath.exact.labels import (
    DONE,
    JOINED_FULL,
    N_CLOSED,
    N_FOUND,
    N_OPEN,
    N_POPPED,
    PAUSED,
    Front,
    LabelSearch,
    close,
    full,
    is_detour,
    load_of,
)
from pymoo_gridpath.exact.nearness import WHOLE, Allowance, Certificate, lowered
from pymoo_gridpath.exact.staircase import lower, lower_marks
from pymoo_gridpath.exact.steps import Pace, Steps, last
from pymoo_gridpath.exact.supported import LEAST_WEIGHTS, Hull, merged, supported_points
from pymoo_gridpath.exact.tie_break import traced_paths
from pymoo_gridpath.exact.ways import FIRST, SECOND, SUM, undominated
from pymoo_gridpath.search import UNREACHABLE, Moves
from pymoo_gridpath.search.heap import drop_first, push

# Places in the array of counts, besides those that every label search has.
BEST2, N_JOINED = range(4, 6)

# Columns of the array of states.
LEAST2, BOUND1, BOUND2, FIELD1, FIELD2, OPEN1, OPEN2 = range(7)

# What labels must stay below is lowered after so many bins, and after so many labels if anything has lowered the staircase.
_BINS_TO_LOOK, _POPS_TO_LOOK = 16, 2**13

# Weighted sums that are minimised for bounds: each takes a search of the grid, which pays the more the larger it is.
_CELLS_PER_WEIGHT, _MOST_WEIGHTS = 2**12, 64


def front_of_two(moves: Moves, costs: Costs, start: int, goal: int, meter: Meter, allowance: Allowance | None = None) -> Front:
    """Return the exact front of two objectives, or paths that are proven to come near to it, see `fronts_of_two`."""
    return last(fronts_of_two(moves, costs, start, goal, meter, allowance))


def fronts_of_two(
    moves: Moves, costs: Costs, start: int, goal: int, meter: Meter, allowance: Allowance | None = None
) -> Steps[Front, Front]:
    """Search for the exact front of two objectives, or paths that are proven to come near to it, and hand over better ones.

    Of paths with the same costs the last holds the one that `smoothest_paths` chooses, as long as memory lasts; any one if a
    cost depends on headings. Those before hold any, with what is proven of them.

    Parameters
    ----------
    moves : Moves
    costs : Costs
        Of two objectives; if only one depends on headings, it comes faster as the second.
    start, goal : int
    meter : Meter
        Ends the search when a budget is used up; the best paths found by then are returned, with what is proven of them.
    allowance : Allowance, optional
        How far the paths may be off; by default the front is exact.

    References
    ----------
    C. Hernandez Ulloa, W. Yeoh, J. A. Baier, H. Zhang, L. Suazo and S. Koenig, "A simple and fast bi-objective search
    algorithm", ICAPS 2020 (BOA*). E. L. Ulungu and J. Teghem, "The two phases method", Foundations of Computing and
    Decision Sciences 20(2), 1995.
    """
    allowance = allowance or Allowance()
    n_weights = min(max(moves.n_cells // _CELLS_PER_WEIGHT, LEAST_WEIGHTS), _MOST_WEIGHTS)
    pace = Pace()
    hull = yield from supported_points(moves, costs, start, goal, n_weights, meter, allowance, pace)

    def early(search: _Search | None = None) -> Front:
        front = merged([Front(hull.paths, hull.points), hull.ways.joined(), *(search.fronts() if search else ())])
        # What is proven takes time to work out, and matters where less than the front will do, or has to.
        proven = hull.certificate(front.points) if search is None else search.certificate(front.points)
        return Front([moves.from_grid(hull.moves.to_grid(path)) for path in front.paths], front.points, proven)

    front = early() if meter.message or allowance.name else None
    if front is not None and (meter.message or allowance.allows(front.certified)):
        return front
    n_cells = len(hull.paths[0])
    if pace.due(2 * hull.bounds.shape[1], hull.ways.staircase.steps, n_cells):
        yield early
    search = _Search(hull, allowance)
    for popped in search.steps(meter):
        # After the last of it the front itself comes next.
        if search.counts[N_OPEN] and not meter.message and pace.due(popped, hull.ways.staircase.steps, n_cells):
            yield functools.partial(early, search)
    if meter.message or allowance.name:
        return early(search)
    paths = [moves.from_grid(hull.moves.to_grid(path)) for path in search.smoothest_paths(meter)]
    return Front(paths, search.points(), WHOLE)


class _Search(LabelSearch):
    """The labels of two objectives.

    Besides those of every label search it has the paths joined, int64, shape (n, 4): numbers of closed labels that lower the
    staircase when they go on along a way, the column of this, and both costs of the path, or a little more.
    """

    growing: ClassVar[dict[int, str]] = LabelSearch.growing | {JOINED_FULL: "joined"}
    pops_at_a_time = 2**18

    def __init__(self, hull: Hull, allowance: Allowance):
        moves, costs, start = hull.moves, hull.costs, hull.start
        super().__init__(moves, costs, start, hull.goal, n_keys=2, n_counts=6)
        self.hull, self.allowance = hull, allowance
        self.joined = np.empty((64, 4), dtype=np.int64)
        n_states = hull.bounds.shape[1]
        self.states = np.empty((n_states, 8), dtype=np.int64)
        self.states[:, [LEAST2, OPEN1, OPEN2]] = UNREACHABLE
        self.states[:, BOUND1], self.states[:, BOUND2] = hull.bounds
        repeat = n_states // moves.n_cells
        self.states[:, FIELD1], self.states[:, FIELD2] = np.repeat(costs.field, repeat, axis=1)
        # Where a state has a heading, what entering it costs is known.
        self.enter = costs.enter
        if costs.enter is not None and repeat == 8:
            self.states[:, FIELD1 : FIELD2 + 1] += costs.enter.reshape(2, n_states).T
            self.enter = None
        if not costs.with_heading:
            self.states[start, LEAST2] = 0
        self.allowed = allowance.counted(hull.begin, abs(hull.points[-1] - hull.points[0]))
        self.gaps = hull.ways.staircase.gaps(hull.points)
        self.ceilings, self.marks = np.empty(len(hull.weights)), np.empty((len(hull.weights), 2), dtype=np.int64)
        self.counts[BEST2] = UNREACHABLE
        self.begin()

    def open_first(self, cell: int, heading: int, state: int) -> bool:
        first = self.costs.step[:, 8, heading] + (0 if self.enter is None else self.enter[:, cell, heading])
        f1, f2 = first + self.states[state, FIELD1 : FIELD2 + 1] + self.states[state, BOUND1 : BOUND2 + 1]
        if f1 >= UNREACHABLE:
            return False
        push(self.heap, self.counts[N_OPEN], f1, 2 * f2 + (cell == self.goal), load_of(cell, heading, 0))
        return True

    def search(self, max_pops: int) -> int:
        staircase = self.hull.ways.staircase
        return search_two(
            self.moves.legal,
            self.moves.offsets,
            self.costs.step,
            self.enter,
            self.costs.with_heading,
            self.costs.on_the_spot,
            self.costs.direct,
            self.states,
            self.goal,
            self.hull.weights,
            self.hull.ways.rows,
            self.hull.column,
            staircase.least,
            staircase.low,
            staircase.shift,
            self.gaps,
            self.ceilings,
            self.marks,
            self.heap,
            self.closed,
            self.found,
            self.joined,
            self.counts,
            self.allowed,
            max_pops,
        )

    def fronts(self) -> list[Front]:
        """Return what has been found, and what is non-dominated of the paths that have been joined."""
        joined, ways, paths = self.joined[: self.counts[N_JOINED]], self.hull.ways, []
        joined = joined[undominated(joined[:, 2:])]
        for path, column in zip(traced_paths(self.closed, joined[:, 0]), joined[:, 1].tolist(), strict=True):
            state = int(path[-1])
            if self.costs.with_heading:
                state = 8 * state + self.moves.offsets.tolist().index(state - int(path[-2]))
            paths.append(ways.ended(path, state, column))
        return [Front(self.paths(), self.points()), ways.front(paths)]

    def certificate(self, known: np.ndarray) -> Certificate:
        """Return how near the points known when it has ended, its own among them, are proven to come to the front."""
        if not self.counts[N_OPEN] and not self.allowance.name:
            return WHOLE
        proven = self.hull.certificate(known)
        assert proven is not None
        # Labels come in ascending order of the first cost: what is before that of the next has been dealt with.
        behind = self.hull.certificate(known, int(self.heap[0, 0])) if self.counts[N_OPEN] else WHOLE
        limits = {name: max(getattr(behind, name), getattr(self.allowance, name) or 0.0) for name in ("epsilon", "share")}
        if self.allowance.name:
            # What was allowed by the one may be any number by the other.
            limits = {self.allowance.name: limits[self.allowance.name]}
        limits = {name: min(limit, getattr(proven, name)) for name, limit in limits.items()}
        return dataclasses.replace(proven, **limits)


@kernel
def first_promising(f1, f2, g1, g2, state, rows, column, weights, ceilings, marks, gap):
    """Return the first gap, from ``gap`` on, in which a label can end below the staircase of known points, or -1.

    What is reached from it can end in none before that.
    """
    for j in range(gap, len(weights)):
        if f2 >= marks[j, 1]:
            # Nor does it stay below the corners of the gaps behind, which lie lower.
            return -1
        if f1 < marks[j, 0] and weights[j, 0] * g1 + weights[j, 1] * g2 + rows[column[j], state, SUM] < ceilings[j]:
            return j
    return -1


@kernel
def search_two(
    legal,
    offsets,
    step,
    enter,
    with_heading,
    on_the_spot,
    direct,
    states,
    goal,
    weights,
    rows,
    column,
    least,
    low,
    shift,
    gaps,
    ceilings,
    marks,
    heap,
    closed,
    found,
    joined,
    counts,
    allowed,
    max_pops,
):
    """Pop labels in ascending order of (f1, f2) until none is left, an array is full, or ``max_pops`` have been popped.

    f of a label is its cost g so far plus the lower bound of the rest.

    Parameters
    ----------
    legal, offsets
        See `Moves`.
    step : int64, shape (2, 9, 8)
    enter : int64, shape (2, n_cells, 8), or None
        See `Costs`; with headings it is part of ``states``.
    with_heading : bool
    on_the_spot : int64, shape (2, 8, 8)
    direct : int64, shape (8, 8)
        See `Costs`.
    states : int64, shape (n_cells, 8), or (8 * n_cells, 8) with headings
        Least g2 of the closed labels, lower bounds of the rest in both objectives, costs of the cell in both, and g1 and g2 of
        the label that was opened last; a row fills a line of a processor's cache.
    goal : int
        The goal cell.
    weights, rows, column
        See `Hull` and `Ways`.
    least, low, shift, gaps
        See `Staircase`; it is lowered by what is found.
    ceilings, marks
        See `lower_marks`, which fills them in.
    heap, closed, found, joined
        See `LabelSearch` and `_Search`; keys are f1 and ``2 * f2`` (plus 1 at the goal, which so comes after all that is equal,
        see `smoothest_paths`).
    counts : int64, shape (6,)
        State of the search, changed in place.
    allowed : int64, shape (2, 3)
        By how much points may be missed, see `Allowance.counted`.
    max_pops : int
    """
    n, n_closed = counts[N_OPEN], counts[N_CLOSED]
    best2 = counts[BEST2]
    status = DONE
    pops = 0
    gap = 0
    looked, next_look, is_lower = np.int64(-1), 0, True
    while n > 0:
        status = full(n, n_closed, counts[N_FOUND], heap, closed, found)
        if status == DONE and counts[N_JOINED] == len(joined):
            status = JOINED_FULL
        if status != DONE:
            break
        if pops >= max_pops:
            status = PAUSED
            break
        pops += 1
        f1 = heap[0, 0]
        f2 = heap[0, 1] >> 1
        load = heap[0, 2]
        drop_first(heap, n)
        n -= 1
        here = (f1 - low) >> shift
        if here >= len(least) or f2 >= best2 or f2 > least[here]:
            continue
        heading = (load >> 32) & 7
        cell = load >> 35
        state = load >> 32 if with_heading else cell
        g2 = f2 - states[state, BOUND2]
        if g2 >= states[state, LEAST2]:
            continue
        g1 = f1 - states[state, BOUND1]
        if here > looked or pops >= next_look:
            all_gaps = is_lower and pops >= next_look
            gap = lower_marks(least, low, shift, gaps, weights, allowed, here, all_gaps, ceilings, marks)
            looked = here + _BINS_TO_LOOK
            if pops >= next_look:
                next_look = pops + _POPS_TO_LOOK
                is_lower = False
        from_gap = first_promising(f1, f2, g1, g2, state, rows, column, weights, ceilings, marks, max(gap, gaps[here]))
        if from_gap < 0:
            continue
        if with_heading:
            # Whoever turns on the spot from this heading to another is no worse than who came with that one and higher costs;
            # those who come later have no lower first cost if turning costs nothing in it.
            for h in range(8):
                turned = g2 + on_the_spot[1, heading, h]
                if turned < states[8 * cell + h, LEAST2] and on_the_spot[0, heading, h] == 0:
                    states[8 * cell + h, LEAST2] = turned
        states[state, LEAST2] = g2
        close(closed, n_closed, load)
        if cell == goal:
            best2 = lowered(g2, allowed[1, 0], allowed[1, 1], allowed[1, 2])
            counts[BEST2] = best2
            found[counts[N_FOUND], 0] = n_closed
            found[counts[N_FOUND], 1] = f1
            found[counts[N_FOUND], 2] = f2
            counts[N_FOUND] += 1
            n_closed += 1
            is_lower |= lower(least, low, shift, f1, f2)
            continue
        if rows[column[from_gap], state, FIRST] < np.inf:
            first = g1 + np.int64(rows[column[from_gap], state, FIRST])
            second = g2 + np.int64(rows[column[from_gap], state, SECOND])
            if lower(least, low, shift, first, second):
                is_lower = True
                joined[counts[N_JOINED], 0] = n_closed
                joined[counts[N_JOINED], 1] = column[from_gap]
                joined[counts[N_JOINED], 2] = first
                joined[counts[N_JOINED], 3] = second
                counts[N_JOINED] += 1
        from_before = legal[cell - offsets[heading]]
        before = heading if with_heading else 8
        steps = legal[cell]
        for m in range(8):
            if not (steps >> m) & 1:
                continue
            if is_detour(direct, heading, m, from_before):
                continue
            next_cell = cell + offsets[m]
            next_state = 8 * next_cell + m if with_heading else next_cell
            next2 = g2 + step[1, before, m] + states[next_state, FIELD2]
            if enter is not None:
                next2 += enter[1, next_cell, m]
            if next2 >= states[next_state, LEAST2]:
                continue
            next_f2 = next2 + states[next_state, BOUND2]
            if next_f2 >= best2:
                continue
            next1 = g1 + step[0, before, m] + states[next_state, FIELD1]
            if enter is not None:
                next1 += enter[0, next_cell, m]
            if next1 >= states[next_state, OPEN1] and next2 >= states[next_state, OPEN2]:
                continue
            next_f1 = next1 + states[next_state, BOUND1]
            place = (next_f1 - low) >> shift
            if place >= len(least) or next_f2 > least[place]:
                continue
            next_gap = first_promising(
                next_f1, next_f2, next1, next2, next_state, rows, column, weights, ceilings, marks, max(from_gap, gaps[place])
            )
            if next_gap >= 0:
                states[next_state, OPEN1] = next1
                states[next_state, OPEN2] = next2
                push(heap, n, next_f1, 2 * next_f2 + (next_cell == goal), load_of(next_cell, m, n_closed))
                n += 1
        n_closed += 1
    counts[N_OPEN], counts[N_CLOSED] = n, n_closed
    counts[N_POPPED] += pops
    return status
