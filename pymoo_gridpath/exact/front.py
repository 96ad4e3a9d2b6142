"""The exact Pareto front of a path problem."""

from __future__ import annotations

from dataclasses import dataclass

import moocore
import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.compiled import working_seconds
from pymoo_gridpath.errors import CapabilityError, GridPathError, counted
from pymoo_gridpath.exact.budget import Budget, Meter
from pymoo_gridpath.exact.costs import check_adds_up, integer_costs
from pymoo_gridpath.exact.levels import Known, cell_levels, over_levels
from pymoo_gridpath.exact.nearness import WHOLE, Allowance, Certificate, together
from pymoo_gridpath.exact.parts import Part, check_detours, parts_of, refuse
from pymoo_gridpath.exact.steps import Steps, last, mapped
from pymoo_gridpath.exact.timed import exact_timed_front
from pymoo_gridpath.objectives import Length, Objective
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.representations import CellSequence
from pymoo_gridpath.representations.base import max_cells, representation_of

# Lengths of paths that visit more cells could overflow.
_MOST_CELLS = 2**24

# By which share of the largest a score may differ from the sum that was minimised.
_SAME = 1e-9

# Of objectives whose costs had to be rounded, values that differ by no more than this share of themselves are equal.
_EQUAL = 1e-12


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
    return last(better_fronts(problem, budget, epsilon=epsilon, share=share))


def check_front_is_known(problem) -> None:
    """Raise a CapabilityError if no search finds the exact front of a problem, whatever its budget."""
    _check_kinds(problem)
    coding = problem.representation
    if coding.codes_detours or coding.timed:
        return
    summed = [problem.objectives[k] for k in _kinds(problem)[0]]
    if summed:
        check_detours(problem, summed, integer_costs(summed, problem.grid, coding.moves))


def _check_kinds(problem) -> None:
    """Raise a CapabilityError where coding, objectives and size alone say so; a search looks at detours by its own costs."""
    coding = representation_of(problem)
    if not coding.codes_all:
        raise CapabilityError(
            f"the {coding.name} representation does not code every path, expected one that does for an exact front, such as "
            f"'integer' or 'cells'"
        )
    if coding.timed:
        return
    numbers, worst = _kinds(problem)
    if len(numbers) > 3:
        besides = " besides those of which the worst cell decides" if worst else ""
        raise CapabilityError(f"the problem has {len(numbers)} objectives{besides}, expected at most 3 for an exact front")
    moves = coding.moves
    if moves.n_cells > _MOST_CELLS:
        n_cells = np.count_nonzero(moves.legal)
        if n_cells > _MOST_CELLS:
            raise CapabilityError(f"paths may visit {n_cells:,} cells, expected at most {_MOST_CELLS:,} for an exact front")
    for k in numbers:
        check_adds_up(problem.objectives[k])


def better_fronts(
    problem, budget: Budget | None = None, *, epsilon: float | None = None, share: float | None = None
) -> Steps[ExactResult, ExactResult]:
    """Search as `exact_front` does, and hand over better and better results: what is known so far, and what is proven of it.

    Of two objectives that add up, these are the ends of the front, points of its hull, and more; of three, larger and larger
    parts of the front. Nothing is handed over of one, of paths in time, nor where the worst cell decides, since that takes many
    searches. A result on the way is no ``success``, and paths that do not fit into a row are left out.
    """
    checks.instance("budget", budget, Budget, optional=True)
    allowance = Allowance(epsilon, share)
    _check_kinds(problem)
    if problem.representation.timed:
        refuse(allowance, "obstacles that move")
        return _front_in_time(problem, budget)
    moves, (summed, worst) = problem.representation.moves, _kinds(problem)
    if len(summed) == 3:
        refuse(allowance, "three objectives that add up")
    if problem.obstacles == "limit":
        # A path within it may be near to none but such that exceed it.
        refuse(allowance, "a potential limit")
    meter = Meter(budget or Budget())
    usable, most = ~problem.grid.occupied[moves.box.slices].ravel(), max_cells(problem)
    objectives: list[Objective] = [Known(problem, k, moves.box) for k in summed]
    levels = [cell_levels(problem.objectives[k], problem.grid, moves.box) for k in worst]
    if levels:
        # Of paths that are equal in all, the shortest will do.
        objectives = objectives or [Length()]

    def search(moves, usable, most=None):
        return parts_of(problem, objectives, moves, usable, meter, allowance, set(), most)

    def searched(most=None):
        ends = moves.index(problem.start), moves.index(problem.goal)

        def part(moves, usable):
            return last(search(moves, usable, most))

        return over_levels(levels, moves, usable, ends, not summed and most is None, meter, part)

    if levels:
        parts = searched()
    else:
        parts = yield from mapped(search(moves, usable), lambda parts: _so_far(problem, parts, most, meter, allowance))
    certified = _proven(parts)
    paths, F, X = _merged(problem, parts, early=bool(meter.message or allowance.name))
    longest = max(map(len, paths), default=0)
    if longest > most:
        whole = F
        # What does not fit into a row may hide what does.
        within = [part.up_to(most) for part in parts]
        if not meter.message:
            parts = searched(most)
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
    near = _said(certified, allowance)
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


def _so_far(problem, parts: list[Part], most: int, meter: Meter, allowance: Allowance) -> ExactResult:
    """Return what is known of a front while it is being searched for."""
    within = [part.up_to(most) for part in parts]
    certified = _proven(parts)
    if problem.obstacles == "limit" or any(len(part.paths) > len(less.paths) for part, less in zip(parts, within, strict=True)):
        certified = None
    _, F, X = _merged(problem, within, early=True)
    assert X is not None
    message = f"{counted(len(F), 'path')} found{_said(certified, allowance)}"
    return ExactResult(X, F, False, False, certified, message, meter.n_labels, meter.n_bytes, meter.elapsed)


def _said(certified: Certificate | None, allowance: Allowance) -> str:
    return "" if certified is None else f", {certified.said(allowance.name) if allowance.share else certified}"


def _proven(parts: list[Part]) -> Certificate | None:
    """Return what is proven of all parts together: of each, as a part has no larger ranges than the whole."""
    return together([part.certified for part in parts])


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


def _merged(problem, parts: list[Part], early: bool) -> tuple[list[np.ndarray], np.ndarray, np.ndarray | None]:
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
