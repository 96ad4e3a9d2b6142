"""The exact Pareto front of a path problem."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import NamedTuple

import moocore
import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.compiled import working_seconds
from pymoo_gridpath.errors import CapabilityError, GridPathError, counted
from pymoo_gridpath.exact.budget import Budget, Meter
from pymoo_gridpath.exact.costs import DIRECT, Costs, integer_costs
from pymoo_gridpath.exact.labels import Front
from pymoo_gridpath.exact.levels import Known, cell_levels, over_levels
from pymoo_gridpath.exact.nearness import WHOLE, Allowance, Certificate
from pymoo_gridpath.exact.one import front_of_one
from pymoo_gridpath.exact.three import front_of_three
from pymoo_gridpath.exact.timed import exact_timed_front
from pymoo_gridpath.exact.two import front_of_two
from pymoo_gridpath.neighbourhood import HEADING_OF
from pymoo_gridpath.objectives import Length, Objective
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.representations import CellSequence
from pymoo_gridpath.representations.base import max_cells, representation_of
from pymoo_gridpath.search import UNREACHABLE, Moves

# Lengths of paths across more cells could overflow.
_MOST_CELLS = 2**24

# By which share of the largest a score may differ from the sum that was minimised.
_SAME = 1e-9

# Of objectives whose costs had to be rounded, values that differ by no more than this share of themselves are equal.
_EQUAL = 1e-12

# Rounded costs of paths below so many units are counted anew in a finer one.
_FINE = 2**42

# A finer unit is worth a search if it is at most this share of the one before.
_FINER = 1 / 16


@dataclass(frozen=True)
class ExactResult:
    """The Pareto front of a problem, or what a budget allowed.

    Attributes
    ----------
    X : numpy.ndarray, shape (N, n_var)
        A path for each point, as genes.
    F : numpy.ndarray of float, shape (N, n_obj)
        The front, in ascending order of the first objective, no point twice. If it is not complete, points that are mutually
        non-dominated: of two objectives the two ends of the front, as far as the unit tells that costs had to be rounded to and
        unless the time was too short even for these, and the best paths between them that were found, which may lie off the
        front; of three a part of the front. Where rows are too short for some paths of the front, any paths that fit.
    complete : bool
        Whether this is the whole front. If not, a budget was used up, or paths near it were all that was asked for.
    success : bool
        Whether this is what was asked for.
    certified : Certificate or None
        How near to the whole front this is proven to be. None where nothing is proven: where a budget ended a search for three
        objectives, within a potential limit, in rows that are too short for some of the paths, or before all levels of a worst
        cell were searched, or was too short for the ends of the front; and where costs had to be rounded to whole numbers.
    message : str
        How the search ended, and whether the representation is too short for some paths of the front of all paths.
    n_labels, n_bytes : int
        The most labels at a time, and the bytes that they took, besides those of arrays of the size of the grid.
    seconds : float
        Time that the search took.
    """

    X: np.ndarray
    F: np.ndarray
    complete: bool
    success: bool
    certified: Certificate | None
    message: str
    n_labels: int
    n_bytes: int
    seconds: float


def exact_front(
    problem, budget: Budget | None = None, *, epsilon: float | None = None, share: float | None = None
) -> ExactResult:
    """Return the Pareto front of the legal paths of a problem, or paths that are proven to come near to it.

    Legal paths cross no occupied cell and, with ``obstacles="limit"``, keep the potential limit. Those of a monotone
    representation never turn back along its axis. Those of `CellSequence` visit no more than its ``max_cells`` cells. Of a
    `TimedPathProblem` it is the front that `exact_timed_front` finds.

    Parameters
    ----------
    problem : GridPathProblem
        With one to three objectives that add up along a path: length, turn, and sums of costs of cells, moves and turns; or
        some of which the worst cell of a path decides, such as the least clearance, and at most three others.
    budget : Budget, optional
        What the search may use; by default 70 % of the free memory, and as long as it takes.
    epsilon : float, optional
        How near is near enough, above 0 up to 1: for every point q of the front there has to be a path with objectives
        p <= (1 + epsilon) q, such as 0.02 for 2 %. By default the front is exact. With one or two objectives that add up, whose
        costs are whole numbers of a unit; by others, of which the worst cell decides, p is no worse than q.
    share : float, optional
        The same for p <= q + share * (the range of the objective over the front), for objectives that come near 0.

    Returns
    -------
    ExactResult

    Raises
    ------
    CapabilityError
        If there are more than three objectives besides those of which the worst cell decides, one of these does not add up, see
        `integer_costs`, or by one of them a detour may be the better way and the representation codes none; or if it does not
        code every path. With ``epsilon`` or
        ``share``, if there are three, a potential limit, obstacles that move, or costs that have to be rounded.
    GridPathError
        If the problem is no path problem, a score is not the sum of what its objective says, or ``epsilon`` and ``share`` are
        out of their range or both given.

    Examples
    --------
    >>> from pymoo_gridpath import GridPathProblem, OccupancyGrid
    >>> grid = OccupancyGrid([[0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]])
    >>> found = exact_front(GridPathProblem(grid, (0, 0), (3, 3)))
    >>> found.complete, found.F.round(2).tolist()
    (True, [[5.41, 0.66]])
    """
    moves = representation_of(problem).moves
    checks.instance("budget", budget, Budget, optional=True)
    allowance = Allowance(epsilon, share)
    if not problem.representation.codes_all:
        raise CapabilityError(
            f"the {problem.representation.name} representation does not code every path, expected one that does for an exact "
            f"front, such as 'integer' or 'cells'"
        )
    if problem.representation.timed:
        _refuse(allowance, "obstacles that move")
        return _front_in_time(problem, budget)
    summed, worst = _kinds(problem)
    if len(summed) > 3:
        besides = " besides those of which the worst cell decides" if worst else ""
        raise CapabilityError(f"the problem has {len(summed)} objectives{besides}, expected at most 3 for an exact front")
    if moves.n_cells >= _MOST_CELLS:
        raise CapabilityError(
            f"{moves.n_cells:,} cells of the grid are to be searched, expected fewer than {_MOST_CELLS:,} for an exact front"
        )
    if len(summed) == 3:
        _refuse(allowance, "three objectives that add up")
    if problem.obstacles == "limit":
        # A path within it may be near to none but such that exceed it.
        _refuse(allowance, "a potential limit")
    meter = Meter(budget or Budget())
    usable, most = ~problem.grid.occupied[moves.box.slices].ravel(), max_cells(problem)
    objectives: list[Objective] = [problem.objectives[k] for k in summed]
    levels = [cell_levels(problem.objectives[k], problem.grid, moves.box) for k in worst]
    if levels:
        # What else is to be minimised is searched many times; of paths that are equal in all, the shortest will do.
        objectives = [Known(one, problem.grid, moves.box) if one.additive else one for one in objectives or [Length()]]

    def search(most=None):
        def part(moves, usable):
            return _search(problem, objectives, moves, usable, meter, allowance, set(), most)

        ends = moves.index(problem.start), moves.index(problem.goal)
        return over_levels(levels, moves, usable, ends, not summed and most is None, meter, part)

    parts = search()
    certified = _proven(parts)
    paths, F, X = _merged(problem, parts, early=bool(meter.message or allowance.name))
    longest = max(map(len, paths), default=0)
    if longest > most:
        whole = F
        # What does not fit into a row may hide what does.
        within = [part.up_to(most) for part in parts]
        if not meter.message:
            parts = search(most)
            certified = _proven(parts)
            within = within + parts if meter.message else parts
        paths, F, X = _merged(problem, within, early=bool(meter.message))
        # Other paths may have the same costs.
        if whole.shape == F.shape and np.allclose(whole, F, rtol=_EQUAL, atol=0.0):
            longest = max(map(len, paths))
    short = f" with at most {most} cells, the max_cells of the representation" if longest > most else ""
    if meter.message and (worst or short or problem.obstacles == "limit"):
        # What was left out, or not searched, may be far from what was found.
        certified = None
    complete = not meter.message and (not allowance.name or certified == WHOLE)
    near = "" if certified is None else f", {certified.said(allowance.name) if allowance.share else certified}"
    if meter.message:
        message = f"ended early, {meter.message}; {counted(len(F), 'path')} found{short}{near}"
    elif not complete:
        message = f"{counted(len(F), 'path')} found{near}"
    elif len(F) and short:
        # Paths near the front may be longer than its own.
        more = "" if allowance.name else f"; without that limit the front has paths of up to {longest}"
        message = f"all {counted(len(F), 'point')} found of paths{short}{more}"
    elif len(F):
        message = f"all {counted(len(F), 'point')} found"
    elif short:
        message = (
            f"no legal path{short}, keeps the potential limit of {problem.potential_limit:g}; paths of up to {longest} cells do"
        )
    else:
        message = f"no legal path keeps the potential limit of {problem.potential_limit:g}"
    if X is None:
        X = problem.representation.from_sequences(_sequences(paths))
    success = complete or allowance.allows(certified)
    return ExactResult(X, F, complete, success, certified, message, meter.n_labels, meter.n_bytes, seconds=meter.elapsed)


def _refuse(allowance: Allowance, what: str) -> None:
    """Refuse to search for paths near the front where nothing would be proven."""
    if allowance.name:
        raise CapabilityError(f"{allowance.name} is not for {what}, of which no front is certified to be near; expected none")


def _proven(parts: list[_Part]) -> Certificate | None:
    """Return what is proven of all parts together: of each, as a part has no larger ranges than the whole."""
    each = [part.certified for part in parts]
    if None in each:
        return None
    return Certificate(*(max((getattr(one, name) for one in each), default=0.0) for name in ("epsilon", "share")))


def _kinds(problem) -> tuple[list[int], list[int]]:
    """Return the numbers of the objectives that are to add up, and of those of which the worst cell of a path decides."""
    kinds: tuple[list[int], list[int]] = [], []
    for k, objective in enumerate(problem.objectives):
        kinds[objective.bottleneck].append(k)
    return kinds


def _front_in_time(problem, budget: Budget | None) -> ExactResult:
    """Return the front of a problem of paths in time."""
    coding, begin = problem.representation, working_seconds()
    found = exact_timed_front(
        problem.grid, problem.start, problem.goal, coding.movers, coding.horizon, problem.variance, budget
    )
    X = coding.from_sequences(_sequences([path @ (1, problem.grid.width) for path in found.paths]))
    certified = WHOLE if found.complete else None
    rest = found.message, found.n_labels, found.n_bytes, working_seconds() - begin
    return ExactResult(X, found.F, found.complete, found.complete, certified, *rest)


class _Part(NamedTuple):
    """What a search found.

    Attributes
    ----------
    paths : list of numpy.ndarray
    F : numpy.ndarray, shape (N, k)
        What the search says of the objectives that add up, or of the length if none does.
    off : numpy.ndarray, shape (N, k)
        By how much that may be off, where costs had to be rounded.
    rounded : numpy.ndarray of bool, shape (k,)
        Whether they had to be.
    certified : Certificate or None
        How near they are proven to come to the front of what was searched.
    """

    paths: list[np.ndarray]
    F: np.ndarray
    off: np.ndarray
    rounded: np.ndarray
    certified: Certificate | None

    def up_to(self, most: int) -> _Part:
        """Return what was found of paths that visit at most so many cells."""
        keep = [k for k, path in enumerate(self.paths) if len(path) <= most]
        return _Part([self.paths[k] for k in keep], self.F[keep], self.off[keep], self.rounded, None)


def _search(
    problem,
    objectives: list[Objective],
    moves: Moves,
    usable: np.ndarray,
    meter: Meter,
    allowance: Allowance,
    searched: set[bytes],
    most: int | None = None,
) -> list[_Part]:
    """Return paths over usable cells, bool, shape (n_cells,), among which is the front of those that visit at most ``most``.

    Where costs have to be rounded, the cheapest paths may lose most of theirs. These visit no cell that costs more than they
    do: a search among the cells that are left has a finer unit, and so on. Sets of cells that were searched are not again.
    """
    costs = integer_costs(objectives, problem.grid, moves, usable)
    _check_detours(problem, objectives, costs)
    if costs.rounded.any():
        name = objectives[int(np.flatnonzero(costs.rounded)[0])].name
        _refuse(allowance, f"the objective {name!r}, whose costs have to be rounded")
    start, goal = moves.index(problem.start), moves.index(problem.goal)
    order = costs.order
    if most is not None:
        front = _front_of_short_paths(moves, costs.take(order), start, goal, most - 1, meter)
    elif len(objectives) == 3:
        front = front_of_three(moves, costs.take(order), start, goal, meter)
    elif len(objectives) == 1 and not costs.with_heading:
        front = front_of_one(moves, costs, start, goal, meter)
    else:
        # A single objective that depends on headings is searched as two equal ones.
        front = front_of_two(moves, costs.take((order * 2)[:2]), start, goal, meter, allowance)
    points = front.points[:, np.argsort(order)] + costs.field[:, start]
    lengths = np.array([len(path) for path in front.paths]).reshape(-1, 1)
    certified = None if costs.rounded.any() else front.certified
    parts = [_Part(front.paths, costs.values(points), lengths * costs.unit * costs.off, costs.rounded, certified)]
    finer = [_cheap_part(points[:, k], costs, k, moves, usable, start) for k in np.flatnonzero(costs.rounded).tolist()]
    del costs, front
    for part in finer:
        if part is not None and not meter.message:
            cheap, within = part
            key = cheap.legal.tobytes() + within.tobytes()
            if key not in searched:
                searched.add(key)
                parts += _search(problem, objectives, cheap, within, meter, allowance, searched, most)
    return parts


def _check_detours(problem, objectives: list[Objective], costs: Costs) -> None:
    """Refuse costs by which a detour may be the better way, if the representation codes none."""
    if problem.representation.codes_detours or np.array_equal(costs.direct, DIRECT):
        return
    k = next(k for k in range(len(objectives)) if not np.array_equal(costs.take([k]).direct, DIRECT))
    raise CapabilityError(
        f"by the objective {objectives[k].name!r} two steps may cost less than the one that leads to the same "
        f"cell, and the {problem.representation.name} representation codes that one alone; "
        f"expected the representation 'cells' for an exact front"
    )


def _front_of_short_paths(moves: Moves, costs: Costs, start: int, goal: int, most_steps: int, meter: Meter) -> Front:
    """Return the front of the paths that take at most ``most_steps`` steps, or any such paths if a budget ends the search."""
    n_obj = len(costs.step)
    # Each objective alone is quick, so that there is something to keep if a budget ends the search for all.
    paths: list[np.ndarray] = []
    for objectives in [*([k] for k in range(n_obj)), range(n_obj)]:
        if not meter.message:
            found = front_of_three(moves, _three(costs.take(objectives)), start, goal, meter, most_steps).paths
            paths = paths + found if len(objectives) < n_obj or meter.message else found
    points = np.array([_costs_of(path, moves, costs) for path in paths], dtype=np.int64).reshape(-1, n_obj)
    return Front(paths, points, None if meter.message else WHOLE)


def _three(costs: Costs) -> Costs:
    """Return one to three costs as three, with some that are nothing before the last, since turns come last."""
    place = [len(costs.step) - 1] * (3 - len(costs.step))
    return dataclasses.replace(
        costs,
        step=np.insert(costs.step, place, 0, axis=0),
        field=np.insert(costs.field, place, 0, axis=0),
        unit=np.insert(costs.unit, place, 1.0),
        off=np.insert(costs.off, place, 0),
        enter=None if costs.enter is None else np.insert(costs.enter, place, 0, axis=0),
    )


def _costs_of(path: np.ndarray, moves: Moves, costs: Costs) -> np.ndarray:
    """Return the costs of a path, int64, shape (k,), without that of the start cell."""
    dx, dy = np.diff(moves.cells(path), axis=0).T
    heading = HEADING_OF[dy + 1, dx + 1]
    before = np.concatenate([[8], heading[:-1]])
    total = costs.step[:, before, heading].sum(axis=1) + costs.field[:, path[1:]].sum(axis=1)
    return total if costs.enter is None else total + costs.enter[:, path[1:], heading].sum(axis=1)


def _cheap_part(
    points: np.ndarray, costs: Costs, k: int, moves: Moves, usable: np.ndarray, start: int
) -> tuple[Moves, np.ndarray] | None:
    """Return the moves and the usable cells that paths of low cost can take, or None if they have no finer unit.

    There is none, either, if no path has a low cost.
    """
    # The rounding of each cell may have hidden a path that costs a little more.
    dearest = points + costs.off[k] * np.count_nonzero(usable)
    field = costs.field[k]
    if costs.enter is not None:
        into = np.where(moves.entered, field + costs.enter[k].T, UNREACHABLE)
        # No cell can be visited for less, and the start is not entered.
        field = np.where(np.arange(moves.n_cells) == start, field, into.min(axis=0))
        usable = usable & (field < UNREACHABLE)
    values = np.sort(field[usable])
    left = np.cumsum(values)[np.searchsorted(values, dearest, side="right") - 1]
    cheap = (points < _FINE) & (left <= _FINER * values.sum())
    if not cheap.any():
        return None
    most = dearest[cheap].max()
    within = usable & (field <= most)
    if costs.enter is not None:
        moves = moves.without(into > most)
    return moves.within(within), within


def _merged(problem, parts: list[_Part], early: bool) -> tuple[list[np.ndarray], np.ndarray, np.ndarray | None]:
    """Return paths, objectives and genes of what is non-dominated and keeps a potential limit, by the first objective.

    There are no genes if one of the given paths was too long for a row.

    What was found ``early``, before the search was over, may have detours, which a monotone representation codes as the better
    direct way.
    """
    paths = [path for part in parts for path in part.paths]
    summed, worst = _kinds(problem)
    sums, off = (np.concatenate([getattr(part, name)[:, : len(summed)] for part in parts]) for name in ("F", "off"))
    coding, longest = problem.representation, max(map(len, paths), default=0)
    if longest > max_cells(problem):
        coding = CellSequence(problem.grid, problem.start, problem.goal, longest)
    X = coding.from_sequences(_sequences(paths))
    F = problem.score(coding.decode(X)).reshape(-1, problem.n_obj)
    rounding = _SAME * np.abs(sums).max(axis=0, initial=0.0) + off
    close = np.abs(F[:, summed] - sums) <= rounding
    if early and not close.all():
        better = (sums + rounding >= F[:, summed]).all(axis=1) & ~close.all(axis=1)
        sums[better], close[better] = F[better][:, summed], True
    if not close.all():
        wrong = problem.objective_names[summed[np.flatnonzero(~close.all(axis=0))[0]]]
        raise GridPathError(
            f"the objective {wrong!r} scores a path otherwise than by the sum of what it says of cells, moves and turns, "
            f"expected no field, moves and turn_cost then"
        )
    keep = np.lexsort(F.T[::-1])
    rounded = np.any([part.rounded[: len(summed)] for part in parts], axis=0)
    if len(F) and (early or rounded.any() or worst):
        # Of what was found in several parts, or before the search was over. Scores may differ by the order of their sum.
        compared = F[keep]
        compared[:, summed] = sums[keep]
        for k in np.array(summed)[rounded]:
            compared[:, k] = _ranks(F[keep, k])
        keep = keep[moocore.is_nondominated(compared)]
    if problem.obstacles == "limit":
        k = problem.objective_names.index("vulnerability")
        keep = keep[problem.over_limit(F[keep, k]) <= 0]
    return [paths[k] for k in keep], F[keep], X[keep] if coding is problem.representation else None


def _sequences(paths: list[np.ndarray]) -> Sequences:
    return Sequences(np.concatenate(paths or [np.empty(0, dtype=np.int64)]), np.cumsum([0, *map(len, paths)]))


def _ranks(values: np.ndarray) -> np.ndarray:
    """Return the ranks of values, the same for those that rounding alone may have made different."""
    order = np.argsort(values)
    apart = np.diff(values[order]) > _EQUAL * values[order[1:]]
    ranks = np.empty(len(values))
    ranks[order] = np.concatenate([[0], np.cumsum(apart)])
    return ranks
