"""The exact front of two objectives: a label-setting search in the line of BOA*, with bounds from the hull of the front.

The search is BOA* (labels popped in ascending order of f1, so that one number a state, the least g2 so far, tells whether a
label is dominated), with three additions that leave the result as it is:

- A label must be able to end below the staircase of paths that are known already. Between two neighbouring points of the
  hull, its cheapest weighted completion has to stay below the furthest corner of the staircase there (the second phase of the
  two-phase method).
- Passes with a tolerance find paths near the front first, which make the staircase fine.
- A step is skipped if the cell before led straight to its end and no cost speaks against it: the detour is dominated.

Where paths near the front will do, the staircase, and what the last path found cost, are lowered by what may be missed: the
known paths stand in for what lies no farther below them. Among labels at a cell dominance stays exact, since errors there
would add up along the path.
"""

from __future__ import annotations

import dataclasses
import functools

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.exact.budget import Meter
from pymoo_gridpath.exact.costs import Costs
from pymoo_gridpath.exact.labels import (
    DONE,
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
from pymoo_gridpath.exact.steps import Pace, Steps, last
from pymoo_gridpath.exact.supported import Hull, non_dominated, supported_points
from pymoo_gridpath.search import UNREACHABLE, Moves
from pymoo_gridpath.search.heap import drop_first, push

# Places in the array of counts, besides those that every label search has.
BEST2, NEXT_CORNER, GAP = range(4, 7)

# Columns of the array of states.
LEAST2, BOUND1, BOUND2, FIELD1, FIELD2 = range(5)

# Weighted sums are floats: a label is dropped only if it misses its mark by more than their rounding.
_ROUNDING = 1e-12

# The passes before the last one ask a label to be better by this share of what the second objective has left to fall.
# They ask the less the later they come; several pay only on large grids, and none on small ones, nor on medium ones where the
# hull is as near to the front as that.
_TOLERANCES, _TOLERANCES_ON_LARGE = (0.01,), (0.02, 0.006, 0.002)
_SMALL, _MEDIUM, _LARGE = 2**14, 2**16, 2**17
_NEAR = Allowance(epsilon=0.02)

# Weighted sums that are minimised for bounds: each takes a search of the grid, which pays the more the larger it is.
_CELLS_PER_WEIGHT, _LEAST_WEIGHTS, _MOST_WEIGHTS = 2**12, 12, 48


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
    n_weights = min(max(moves.n_cells // _CELLS_PER_WEIGHT, _LEAST_WEIGHTS), _MOST_WEIGHTS)
    pace = Pace()
    hull = yield from supported_points(moves, costs, start, goal, n_weights, meter, allowance, pace)
    known, found = hull.points, [Front(hull.paths, hull.points)]
    # What is proven takes time to work out, and matters where less than the front will do, or has to.
    proven = hull.certificate(known) if meter.message or allowance.name else None
    goes_on = not meter.message and not allowance.allows(proven)
    if goes_on and pace.due(2 * hull.bounds.shape[1], len(known), len(hull.paths[0])):
        yield lambda: _on_the_whole(moves, hull, found[0], hull.certificate(hull.points))
    for tolerance in (*_tolerances(hull), 0.0):
        if meter.message or allowance.allows(proven):
            break
        search = _Search(hull, known, tolerance, allowance)
        for popped in search.steps(meter):
            n_paths = len(known) + int(search.counts[N_FOUND])
            # After the last pass the front itself comes next.
            on_the_way = tolerance > 0.0 or search.counts[N_OPEN] > 0
            if on_the_way and not meter.message and pace.due(popped, n_paths, len(hull.paths[0])):
                yield functools.partial(_so_far, moves, hull, found, search)
        found.append(Front(search.paths(), search.points()))
        known = non_dominated(np.concatenate([known, found[-1].points]))
        if tolerance == 0.0 or meter.message or allowance.name:
            proven = search.certificate(known)
    early = meter.message or allowance.name
    front = merged(found) if early else Front(search.smoothest_paths(meter), search.points())
    return _on_the_whole(moves, hull, front, proven)


def _on_the_whole(moves: Moves, hull: Hull, front: Front, proven: Certificate | None) -> Front:
    """Return a front that was found on a part of the grid as one of the whole, with what is proven of it."""
    return Front([moves.from_grid(hull.moves.to_grid(path)) for path in front.paths], front.points, proven)


def _tolerances(hull: Hull) -> tuple[float, ...]:
    """Return the tolerances of the passes before the last one."""
    n_cells = hull.moves.n_cells
    few = len(hull.points) == 1 or n_cells <= _SMALL or (n_cells <= _MEDIUM and _NEAR.allows(hull.certificate(hull.points)))
    # Which of equal paths is found hangs on all labels where costs depend on headings, those of the passes too.
    if few and not hull.costs.with_heading:
        return ()
    return _TOLERANCES_ON_LARGE if n_cells > _LARGE else _TOLERANCES


def _so_far(moves: Moves, hull: Hull, found: list[Front], search: _Search) -> Front:
    """Return what was found before a search, and by it, with what is proven while it is under way."""
    front = merged([*found, Front(search.paths(), search.points())])
    return _on_the_whole(moves, hull, front, search.certificate(front.points))


def merged(fronts: list[Front]) -> Front:
    """Return what is non-dominated of several fronts."""
    points = np.concatenate([front.points for front in fronts])
    paths = [path for front in fronts for path in front.paths]
    order = np.lexsort((points[:, 1], points[:, 0]))
    best_before = np.concatenate([[UNREACHABLE], np.minimum.accumulate(points[order, 1])])[: len(order)]
    keep = order[points[order, 1] < best_before]
    return Front([paths[k] for k in keep], points[keep])


class _Search(LabelSearch):
    """One pass of the search."""

    pops_at_a_time = 2**18

    def __init__(self, hull: Hull, known: np.ndarray, tolerance: float, allowance: Allowance):
        moves, costs, start = hull.moves, hull.costs, hull.start
        super().__init__(moves, costs, start, hull.goal, n_keys=2, n_counts=7)
        self.hull, self.tolerance, self.allowance = hull, tolerance, allowance
        n_states = hull.bounds.shape[1]
        self.states = np.empty((n_states, 5), dtype=np.int64)
        self.states[:, LEAST2] = UNREACHABLE
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
        self.allowed = allowance.counted(hull.begin, abs(known[-1] - known[0]))
        self.corners, self.ceilings, self.marks = _corners(hull, known, self.allowed if allowance.name else None)
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
            self.hull.weighted,
            self.hull.column,
            self.corners,
            self.ceilings,
            self.marks,
            self.heap,
            self.closed,
            self.found,
            self.counts,
            self.hull.points[0, 1],
            self.hull.points[-1, 1],
            self.tolerance,
            self.allowed,
            max_pops,
        )

    def certificate(self, known: np.ndarray) -> Certificate:
        """Return how near the points known when it has ended, its own among them, are proven to come to the front."""
        if self.tolerance == 0.0 and not self.counts[N_OPEN] and not self.allowance.name:
            return WHOLE
        proven = self.hull.certificate(known)
        assert proven is not None
        if self.tolerance > 0.0:
            return proven
        # Labels come in ascending order of the first cost: what is before that of the next has been dealt with.
        behind = self.hull.certificate(known, int(self.heap[0, 0])) if self.counts[N_OPEN] else WHOLE
        limits = {name: max(getattr(behind, name), getattr(self.allowance, name) or 0.0) for name in ("epsilon", "share")}
        if self.allowance.name:
            # What was allowed by the one may be any number by the other.
            limits = {self.allowance.name: limits[self.allowance.name]}
        limits = {name: min(limit, getattr(proven, name)) for name, limit in limits.items()}
        return dataclasses.replace(proven, **limits)


def _corners(hull: Hull, known: np.ndarray, allowed: np.ndarray | None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the corners of the staircase of known points, and what labels must stay below in each gap of the hull.

    Returns
    -------
    corners : numpy.ndarray of int64, shape (n, 3)
        f1 and f2 that a new point stays below, and the gap that the corner lies in, ascending. A corner lies one unit beyond
        the known points, which have to be found again; where points may be missed, by what is allowed below them.
    ceilings : numpy.ndarray of float, shape (n_gaps,)
        Least upper bound of the weighted sum over the corners of each gap; the kernel lowers it, and the next.
    marks : numpy.ndarray of int64, shape (n_gaps, 2)
        Least upper bounds of f1 over the corners of each gap, and of f2 over those of this gap and the ones behind.
    """
    n_gaps = len(hull.weights)
    beyond, above = (known[1:, 0], known[:-1, 1]) if len(known) > 1 else (known[:, 0], known[:, 1])
    corners = np.empty((len(beyond), 3), dtype=np.int64)
    if allowed is None:
        corners[:, 0], corners[:, 1] = beyond + 1, above + 1
    else:
        corners[:, 0], corners[:, 1] = beyond, above
        lower_corners(corners, allowed)
    corners[:, 2] = np.minimum(np.searchsorted(hull.points[1:, 0], beyond), n_gaps - 1)
    ceilings, marks = np.full(n_gaps, -1.0), np.full((n_gaps, 2), -1)
    for j in reversed(range(n_gaps)):
        mine = corners[corners[:, 2] == j, :2]
        if len(mine):
            ceilings[j] = (mine @ hull.weights[j]).max() * (1 + _ROUNDING)
            marks[j] = mine.max(axis=0)
        elif j + 1 < n_gaps:
            # Known points dominate an end of this gap; those behind it may still have corners.
            marks[j, 1] = marks[j + 1, 1]
    return corners, ceilings, marks


@kernel
def lower_corners(corners, allowed):
    """Lower the corners by what is allowed, see `Allowance.counted`; the gap of each stays that of the known points."""
    for k in range(len(corners)):
        for j in range(2):
            corners[k, j] = lowered(corners[k, j], allowed[j, 0], allowed[j, 1], allowed[j, 2])


@kernel
def first_promising(f1, f2, g1, g2, state, weighted, column, weights, ceilings, marks, gap):
    """Return the first gap, from ``gap`` on, in which a label can end below the staircase of known points, or -1.

    What is reached from it can end in none before that.
    """
    for j in range(gap, len(weights)):
        if f2 >= marks[j, 1]:
            # Nor does it stay below the corners of the gaps behind, which lie lower.
            return -1
        if f1 < marks[j, 0] and weights[j, 0] * g1 + weights[j, 1] * g2 + weighted[state, column[j]] < ceilings[j]:
            return j
    return -1


@kernel
def lower_marks(corners, weights, ceilings, marks, counts, f1):
    """Leave behind the corners that labels from ``f1`` on cannot reach, and lower the marks of the gap where f1 lies."""
    first = counts[NEXT_CORNER]
    while first < len(corners) and corners[first, 0] <= f1:
        first += 1
    counts[NEXT_CORNER] = first
    if first == len(corners):
        counts[GAP] = len(marks)
        return
    gap = corners[first, 2]
    counts[GAP] = gap
    ceilings[gap] = -1.0
    marks[gap, 1] = -1
    for k in range(first, len(corners)):
        if corners[k, 2] != gap:
            break
        second = min(corners[k, 1], counts[BEST2])
        total = (weights[gap, 0] * corners[k, 0] + weights[gap, 1] * second) * (1.0 + 1e-12)
        ceilings[gap] = max(ceilings[gap], total)
        marks[gap, 1] = max(marks[gap, 1], second)


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
    weighted,
    column,
    corners,
    ceilings,
    marks,
    heap,
    closed,
    found,
    counts,
    most_f2,
    least_f2,
    tolerance,
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
    states : int64, shape (n_cells, 5), or (8 * n_cells, 5) with headings
        Least g2 of the closed labels, lower bounds of the rest in both objectives, costs of the cell in both.
    goal : int
        The goal cell.
    weights, weighted, column, corners, ceilings, marks
        See `Hull` and `_corners`.
    heap, closed, found
        See `LabelSearch`; keys are f1 and ``2 * f2`` (plus 1 at the goal, which so comes after all that is equal, see
        `smoothest_paths`).
    counts : int64, shape (7,)
        State of the search, changed in place like all arrays from ``ceilings`` on, and ``states``.
    most_f2, least_f2 : int
        Second objective of the ends of the front.
    tolerance : float
        A label must improve on the least g2 of its state by more than this share of what the second objective of the last
        path found is above ``least_f2``; 0 for the exact front.
    allowed : int64, shape (2, 3)
        By how much points may be missed, see `Allowance.counted`.
    max_pops : int
    """
    n, n_closed = counts[N_OPEN], counts[N_CLOSED]
    best2, gap = counts[BEST2], counts[GAP]
    slack = np.int64(tolerance * (min(counts[BEST2], most_f2) - least_f2))
    status = DONE
    pops = 0
    while n > 0:
        status = full(n, n_closed, counts[N_FOUND], heap, closed, found)
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
        if f2 >= best2:
            continue
        heading = (load >> 32) & 7
        cell = load >> 35
        state = load >> 32 if with_heading else cell
        g2 = f2 - states[state, BOUND2]
        if g2 >= states[state, LEAST2] - slack:
            continue
        g1 = f1 - states[state, BOUND1]
        if counts[NEXT_CORNER] < len(corners) and corners[counts[NEXT_CORNER], 0] <= f1:
            lower_marks(corners, weights, ceilings, marks, counts, f1)
            gap = counts[GAP]
        from_gap = first_promising(f1, f2, g1, g2, state, weighted, column, weights, ceilings, marks, gap)
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
            slack = np.int64(tolerance * (g2 - least_f2))
            found[counts[N_FOUND], 0] = n_closed
            found[counts[N_FOUND], 1] = f1
            found[counts[N_FOUND], 2] = f2
            counts[N_FOUND] += 1
            n_closed += 1
            lower_marks(corners, weights, ceilings, marks, counts, f1)
            gap = counts[GAP]
            continue
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
            if next2 >= states[next_state, LEAST2] - slack:
                continue
            next_f2 = next2 + states[next_state, BOUND2]
            if next_f2 >= best2:
                continue
            next1 = g1 + step[0, before, m] + states[next_state, FIELD1]
            if enter is not None:
                next1 += enter[0, next_cell, m]
            next_f1 = next1 + states[next_state, BOUND1]
            if next_f1 >= 2**61:
                continue
            next_gap = first_promising(
                next_f1, next_f2, next1, next2, next_state, weighted, column, weights, ceilings, marks, from_gap
            )
            if next_gap >= 0:
                push(heap, n, next_f1, 2 * next_f2 + (next_cell == goal), load_of(next_cell, m, n_closed))
                n += 1
        n_closed += 1
    counts[N_OPEN], counts[N_CLOSED] = n, n_closed
    counts[N_POPPED] += pops
    return status
