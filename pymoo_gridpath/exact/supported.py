"""What single-objective searches tell of a front of two objectives: its ends, its convex hull, and bounds between them."""

from __future__ import annotations

import heapq
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np

from pymoo_gridpath.compiled import COMPILED, kernel
from pymoo_gridpath.exact.budget import Meter
from pymoo_gridpath.exact.costs import Costs
from pymoo_gridpath.exact.labels import Front
from pymoo_gridpath.exact.nearness import Allowance, Certificate, Lines, certificate
from pymoo_gridpath.exact.staircase import Staircase
from pymoo_gridpath.exact.steps import Pace, Steps
from pymoo_gridpath.exact.ways import WAY, WAY_KEPT, Ways, undominated
from pymoo_gridpath.neighbourhood import OPPOSITE
from pymoo_gridpath.search import UNREACHABLE, Moves
from pymoo_gridpath.search.shortest import Backward

# Searches that are made side by side, whatever the machine, so that results are the same; in threads, which compiled kernels
# let run, where a search takes long enough.
_SIDE_BY_SIDE, _CELLS_WORTH_THREADS = 2, 2**16

#: Weighted sums that are minimised in any case, as far as there are gaps to divide.
LEAST_WEIGHTS = 12

# And more where the front has many points, about as many as the staircase has steps: so many for each of them.
_STEPS_PER_WEIGHT = 8

_NO_LINES = Lines(np.empty((0, 2)), np.empty(0))

# Bytes of a state of the label search.
_STATE = 64

# Of smaller grids a part saves less than it takes to find.
_CELLS_WORTH_A_PART = 2**10


class Hull(NamedTuple):
    """Points on the lower left hull of a front, and lower bounds for what lies between them.

    Cells are those of the part of the grid in which the paths of the front lie.

    Attributes
    ----------
    moves : Moves
        Of that part.
    costs : Costs
    start, goal : int
    bounds : numpy.ndarray of int64, shape (2, n_states)
        Least first and least second cost from each state to the goal.
    points : numpy.ndarray of int64, shape (n, 2)
        Costs of paths, none dominated by another, in ascending order of the first; the first and the last are the ends of the
        front. Those between may lie off it, since weighted sums are rounded step by step.
    paths : list of numpy.ndarray
        The cells of a path for each point.
    weights : numpy.ndarray of float, shape (n_gaps, 2)
        Weights of a sum of both costs for each gap between neighbouring points; one row if there is a single point.
    ways : Ways
        The cheapest ways on by each weighted sum that was minimised, and the staircase of all paths that are known.
    column : numpy.ndarray of int64, shape (n_gaps,)
        Column of ``ways.rows`` for each gap.
    lines : Lines
        The weighted sums that were minimised.
    """

    moves: Moves
    costs: Costs
    start: int
    goal: int
    bounds: np.ndarray
    points: np.ndarray
    paths: list[np.ndarray]
    weights: np.ndarray
    ways: Ways
    column: np.ndarray
    lines: Lines

    @property
    def begin(self) -> np.ndarray:
        """What the start costs, which ``points`` are without, int64, shape (2,)."""
        return self.costs.field[:, self.start]

    def certificate(self, known: np.ndarray, searched: int | None = None) -> Certificate | None:
        """Return how near known points are proven to come to the front, see `certificate`; None if no point is known."""
        return certificate(known, self.lines, self.begin, searched) if len(known) else None


def supported_points(
    moves: Moves, costs: Costs, start: int, goal: int, n_weights: int, meter: Meter, allowance: Allowance, pace: Pace
) -> Steps[Front, Hull]:
    """Find ends and hull of a front of two objectives by single-objective searches, and hand over what is found on the way.

    Parameters
    ----------
    moves : Moves
    costs : Costs
        Of two objectives.
    start, goal : int
    n_weights : int
        How many weighted sums to minimise at most, those first that belong to the widest gaps of the hull; fewer where few
        points are known.
    meter : Meter
        Once a budget is used up, no more of them are minimised. The two ends are found in any case, unless the time does not
        suffice for the searches that they take: then there is no point.
    allowance : Allowance
        Nor are more minimised once the points are proven to come that near to the front.
    pace : Pace
        When to hand over the points that are known.

    References
    ----------
    Y. P. Aneja and K. P. K. Nair, "Bicriteria transportation problem", Management Science 25(1), 1979 (weights normal to the
    gap between two points).
    """
    if not COMPILED or moves.n_cells < _CELLS_WORTH_THREADS:
        return (yield from _supported_points(moves, costs, start, goal, n_weights, meter, allowance, pace, map))
    with ThreadPoolExecutor(_SIDE_BY_SIDE) as threads:
        try:
            return (yield from _supported_points(moves, costs, start, goal, n_weights, meter, allowance, pace, threads.map))
        except BaseException as error:
            # Such as Ctrl-C: the searches under way have to end, too.
            meter.message = meter.message or f"ended by {type(error).__name__}"
            raise


def _supported_points(
    moves: Moves, costs: Costs, start: int, goal: int, n_weights: int, meter: Meter, allowance: Allowance, pace: Pace, map_
) -> Steps[Front, Hull]:
    whole = moves
    bounds, ends = _ends(moves, costs, start, goal, meter, map_)
    if meter.message:
        ways = Ways(moves, costs, goal, 0, Staircase((0, 0), (0, 0), 1), at_once=False)
        return _without_weights(moves, costs, start, goal, bounds, np.empty((0, 2), dtype=np.int64), [], ways)
    (left, first), (right, last) = ends
    found = {left: first, right: last}
    # Both ends took up to three searches of the whole.
    if pace.due(3 * bounds.shape[1], len(found), len(first)):
        ends_alone = np.array(sorted(found))
        certified = certificate(ends_alone, _NO_LINES, costs.field[:, start])
        yield lambda: Front([found[point] for point in sorted(found)], ends_alone, certified)
    # Where costs depend on headings, which of equal paths is found hangs on all labels, those that lead nowhere too.
    most = (UNREACHABLE, UNREACHABLE) if costs.with_heading else (right[0], left[1])
    # First the cells from where the goal is no farther than for the front, then those that lie on ways no longer than for it.
    parted = not costs.with_heading and moves.n_cells >= _CELLS_WORTH_A_PART
    if parted:
        near = (bounds[0] <= most[0]) & (bounds[1] <= most[1])
        moves, costs, start, goal, (bounds,) = _around(near, moves, costs, start, goal, [bounds])
    backward = moves.backward()
    # Where both ends are the same point there are no weights to come, and either cost tells which cells its paths visit.
    needed = range(2 if left != right else 1)
    spent = np.stack([_spent(moves, backward, costs, k, start, bounds, most[k], meter) for k in needed])
    if parted:
        near = np.all([spent[k] + bounds[k] <= most[k] for k in needed], axis=0)
        moves, costs, start, goal, (bounds, spent) = _around(near, moves, costs, start, goal, [bounds, spent])

    def minimise(gap_and_column):
        (_, low, high, _), column = gap_and_column
        weights = _normal(low, high)
        # What labels stay below; and one more for rounding.
        limit = int(staircase.ceiling(low, high, weights)) + 2
        return _minimise(moves, costs, weights, start, goal, spent, limit, ways, column, meter)

    # Cells of the part of the grid that is left.
    found = {point: moves.from_grid(whole.to_grid(path)) for point, path in found.items()}
    used, sums_of = [], []
    n_weights = _affordable(n_weights, bounds, costs, meter, allowance)
    staircase = Staircase(left, right, bounds.shape[1])
    ways = Ways(moves, costs, goal, n_weights, staircase, at_once=not allowance.name)
    for path in found.values():
        ways.begin(path)

    def proven() -> Certificate:
        points = np.concatenate([np.array(list(found)), ways.points])
        lines = Lines(np.array(used).reshape(-1, 2), np.array(sums_of, dtype=float))
        return certificate(points[undominated(points)], lines, costs.field[:, start])

    def so_far() -> Front:
        front = merged([Front(list(found.values()), np.array(list(found))), ways.joined()])
        return Front([whole.from_grid(moves.to_grid(path)) for path in front.paths], front.points, proven())

    extent = (max(right[0] - left[0], 1), max(left[1] - right[1], 1))
    # A gap that is not divided has the weights of the one that it is a part of, which bound its points, too.
    gaps, narrow = [(0.0, left, right, 0)] if left != right else [], []
    while gaps and len(used) < n_weights:
        meter.check()
        if meter.message or (allowance.name and allowance.allows(proven())):
            break
        if not allowance.name and len(used) >= LEAST_WEIGHTS and len(used) * _STEPS_PER_WEIGHT >= staircase.steps:
            break
        # After the last two searches.
        if used and pace.due(2 * bounds.shape[1], staircase.steps, len(first)):
            yield so_far
        widest = [heapq.heappop(gaps) for _ in range(min(_SIDE_BY_SIDE, len(gaps), n_weights - len(used)))]
        columns = range(len(used), len(used) + len(widest))
        results = list(map_(minimise, zip(widest, columns, strict=True)))
        if None in results:
            gaps += widest
            break
        for gap, column, (total, point, path, found_ways) in zip(widest, columns, results, strict=True):
            _, low, high, _ = gap
            used.append(_normal(low, high))
            sums_of.append(total)
            ways.add(*found_ways)
            if low[0] < point[0] < high[0] and high[1] < point[1] < low[1]:
                found[point] = path
                ways.begin(path)
                for a, b in ((low, point), (point, high)):
                    heapq.heappush(gaps, (-max((b[0] - a[0]) / extent[0], (a[1] - b[1]) / extent[1]), a, b, column))
            else:
                narrow.append((low, column))
    narrow += [(low, column) for _, low, _, column in gaps]
    points = sorted(found)
    paths = [found[point] for point in points]
    given = moves, costs, start, goal, bounds, np.array(points), paths
    if not used:
        return _without_weights(*given, ways)
    column = np.array([column for _, column in sorted(narrow)])
    near = allowance.name and allowance.allows(proven())
    if not near and not meter.message:
        meter.check(n_bytes=ways.n_bytes_more + _STATE * bounds.shape[1])
    # Nothing is searched for otherwise, and no bound asked for.
    if not near and not meter.message:
        ways.complete()
    return Hull(*given, np.array(used)[column], ways, column, Lines(np.array(used), np.array(sums_of, dtype=float)))


def _without_weights(moves: Moves, costs: Costs, start: int, goal: int, bounds, points, paths, ways: Ways) -> Hull:
    """Return what is known where no weighted sum was minimised: that of both bounds will do."""
    ways.bound(bounds.sum(axis=0))
    column = np.zeros(1, dtype=np.int64)
    return Hull(moves, costs, start, goal, bounds, points, paths, np.ones((1, 2)), ways, column, _NO_LINES)


def merged(fronts: list[Front]) -> Front:
    """Return what is non-dominated of several fronts."""
    points = np.concatenate([front.points for front in fronts])
    paths = [path for front in fronts for path in front.paths]
    keep = undominated(points)
    return Front([paths[k] for k in keep], points[keep])


def _ends(moves: Moves, costs: Costs, start: int, goal: int, meter: Meter, map_):
    """Return lower bounds of both costs, int64, shape (2, n_states), and both ends of the front: their costs and their cells.

    Where no cost depends on headings, bounds that are beyond an end are not worked out: they are too low, but beyond it.
    """
    orders = costs, costs.take((1, 0))
    one, two = (Backward(moves, each.step, each.field, goal, costs.with_heading, enter=each.enter) for each in orders)
    if costs.with_heading:
        list(map_(lambda search: search.run(meter.stop), (one, two)))
    else:
        one.run(meter.stop, until=start)
    ends = []
    for search in (one, two):
        if search is two and not meter.message and not costs.with_heading:
            two.run(meter.stop, beyond=ends[0][0][1] + 1)
        if not meter.message:
            ends.append(_follow(moves, costs, search, start, goal))
    if not meter.message and not costs.with_heading:
        one.run(meter.stop, beyond=ends[1][0][0] + 1)
    return np.stack([one.cost[0], two.cost[0]]), ends


def _around(near: np.ndarray, moves: Moves, costs: Costs, start: int, goal: int, arrays: list[np.ndarray]):
    """Return moves, costs, start, goal, and arrays of shape (k, n_states), of the part of the grid around some cells."""
    part = moves.around(near)
    if part is moves:
        return moves, costs, start, goal, arrays
    ends = part.from_grid(moves.to_grid(np.array([start, goal])))
    return part, costs.within(moves, part), int(ends[0]), int(ends[1]), [moves.part_of(array, part) for array in arrays]


def _affordable(n_weights: int, bounds: np.ndarray, costs: Costs, meter: Meter, allowance: Allowance) -> int:
    """Return how many weighted sums there is memory for, and note what arrays of the size of the grid take.

    Half of it is for labels, of which there may be none where something is allowed.
    """
    n_states = bounds.shape[1]
    # Bounds, the searches under way with their costs, and the states of the label search.
    base = n_states * (bounds.itemsize * 2 + (17 + 32 + 4) * _SIDE_BY_SIDE + (0 if allowance.name else _STATE))
    base += 0 if costs.enter is None else costs.enter.nbytes * (1 + _SIDE_BY_SIDE)
    share = 0.9 if allowance.name else 0.5
    # Before it is known that a label search will come, sums and headings alone are kept.
    each = n_states * (WAY_KEPT if allowance.name else WAY)
    if not meter.has_room((base + each * n_weights) / share):
        n_weights = max(0, min(n_weights, int((share * meter.memory - base) // each)))
    meter.n_fixed = base + each * max(n_weights, 1)
    return n_weights


def _follow(moves: Moves, costs: Costs, found: Backward, start: int, goal: int):
    """Return costs and cells of the path from the start that a search, in whatever costs, found cheapest."""
    total = np.zeros(2, dtype=np.int64)
    path = np.empty(moves.n_cells + 1, dtype=np.int64)
    arrays = costs.step, costs.field, costs.enter, costs.with_heading, found.ahead
    n = follow(moves.offsets, *arrays, start, found.first_step(start)[1], goal, total, path)
    return (int(total[0]), int(total[1])), path[:n].copy()


@kernel
def follow(offsets, step, field, enter, with_heading, ahead, start, first, goal, total, path):
    """Add up costs along a path that begins along ``first`` and goes on as ``ahead`` says; return how many cells it has."""
    cell = start
    path[0] = start
    n = 1
    before = 8
    heading = np.int64(first)
    while True:
        cell += offsets[heading]
        path[n] = cell
        n += 1
        for k in range(2):
            total[k] += step[k, before, heading] + field[k, cell]
            if enter is not None:
                total[k] += enter[k, cell, heading]
        if cell == goal:
            return n
        if with_heading:
            before = heading
        heading = np.int64(ahead[8 * cell + heading if with_heading else cell])


def _normal(low, high) -> tuple[float, float]:
    """Return weights, the larger 1, for which two points have the same weighted sum."""
    first, second = low[1] - high[1], high[0] - low[0]
    larger = max(first, second)
    return first / larger, second / larger


def _minimise(moves: Moves, costs: Costs, weights, start: int, goal: int, spent, limit: int, ways: Ways, number: int, meter):
    """Return the least weighted sum from the start, its point and its path, and the ways from every state.

    None if a budget is used up before. From states through which no path has a sum below the limit there is none.
    """
    found = Backward(moves, costs.step, costs.field, goal, costs.with_heading, spent, limit, costs.enter, weights)
    found.run(meter.stop)
    if meter.message:
        return None
    total = found.first_step(start)[0]
    point, path = _follow(moves, costs, found, start, goal)
    return total, point, path, ways.of(found, number)


def _spent(
    moves: Moves, backward: Moves, costs: Costs, k: int, start: int, bounds: np.ndarray, most: int, meter: Meter
) -> np.ndarray:
    """Return lower bounds of one of the costs from the start to each cell, by the moves taken backwards, shape (n_cells,).

    Cells are left out, as if they could not be reached, through which no path costs ``most`` or less.
    """
    step = np.broadcast_to(costs.step[k].min(axis=0), (2, *costs.step.shape[1:])).copy()
    enter = None
    if costs.enter is not None:
        # A step taken backwards costs what it costs to enter, going forth, the cell that it leaves.
        enter = np.zeros_like(costs.enter[[k, k]])
        for m in range(8):
            leads = np.flatnonzero(moves.legal >> np.uint8(m) & 1)
            enter[:, leads, OPPOSITE[m]] = costs.enter[k, leads + moves.offsets[m], m]
    # The search enters the start instead of the cell that it set out from.
    field = np.stack([costs.field[k]] * 2)
    other = costs.field[k] - costs.field[k, start]
    rest = None if most == UNREACHABLE else bounds[k] + other
    found = Backward(backward, step, field, start, spent=rest, limit=min(most + 1, UNREACHABLE), enter=enter)
    found.run(meter.stop)
    spent = np.minimum(found.cost[0] + other, UNREACHABLE)
    spent[start] = 0
    return spent
