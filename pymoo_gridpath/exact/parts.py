"""What a search for a front finds: all at once, or in several parts where costs have to be rounded."""

from __future__ import annotations

import dataclasses
from typing import NamedTuple

import numpy as np

from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.exact.budget import Meter
from pymoo_gridpath.exact.costs import DIRECT, Costs, integer_costs
from pymoo_gridpath.exact.labels import Front
from pymoo_gridpath.exact.nearness import WHOLE, Allowance, Certificate
from pymoo_gridpath.exact.one import front_of_one
from pymoo_gridpath.exact.steps import Steps, last, mapped
from pymoo_gridpath.exact.three import front_of_three, fronts_of_three
from pymoo_gridpath.exact.two import fronts_of_two
from pymoo_gridpath.objectives import Objective
from pymoo_gridpath.search import UNREACHABLE, Moves

# Rounded costs of paths below so many units are counted anew in a finer one.
_FINE = 2**42

# A finer unit is worth a search if it is at most this share of the one before.
_FINER = 1 / 16


class Part(NamedTuple):
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

    def up_to(self, most: int) -> Part:
        """Return what was found of paths that visit at most so many cells."""
        keep = [k for k, path in enumerate(self.paths) if len(path) <= most]
        return Part([self.paths[k] for k in keep], self.F[keep], self.off[keep], self.rounded, None)


def parts_of(
    problem,
    objectives: list[Objective],
    moves: Moves,
    usable: np.ndarray,
    meter: Meter,
    allowance: Allowance,
    searched: set[bytes],
    most: int | None = None,
) -> Steps[list[Part], list[Part]]:
    """Find paths over usable cells, bool, shape (n_cells,), among which is the front of those that visit at most ``most``.

    Where costs have to be rounded, the cheapest paths may lose most of theirs. These visit no cell that costs more than they
    do: a search among the cells that are left has a finer unit, and so on. Sets of cells that were searched are not again. On
    the way the first search hands over what it has found.
    """
    costs = integer_costs(objectives, problem.grid, moves, usable)
    check_detours(problem, objectives, costs)
    if costs.rounded.any():
        name = objectives[int(np.flatnonzero(costs.rounded)[0])].name
        refuse(allowance, f"the objective {name!r}, whose costs have to be rounded")
    start, goal = moves.index(problem.start), moves.index(problem.goal)
    order = costs.order

    def part_of(front: Front) -> Part:
        points = front.points[:, np.argsort(order)] + costs.field[:, start]
        lengths = np.array([len(path) for path in front.paths]).reshape(-1, 1)
        certified = None if costs.rounded.any() else front.certified
        return Part(front.paths, costs.values(points), lengths * costs.unit * costs.off, costs.rounded, certified)

    if most is not None:
        front = _front_of_short_paths(moves, costs.take(order), start, goal, most - 1, meter)
    elif len(objectives) == 3:
        steps = fronts_of_three(moves, costs.take(order), start, goal, meter)
        front = yield from mapped(steps, lambda front: [part_of(front)])
    elif len(objectives) == 1 and not costs.with_heading:
        front = front_of_one(moves, costs, start, goal, meter)
    else:
        # A single objective that depends on headings is searched as two equal ones.
        steps = fronts_of_two(moves, costs.take((order * 2)[:2]), start, goal, meter, allowance)
        front = yield from mapped(steps, lambda front: [part_of(front)])
    parts = [part_of(front)]
    points = front.points[:, np.argsort(order)] + costs.field[:, start]
    finer = [_cheap_part(points[:, k], costs, k, moves, usable, start) for k in np.flatnonzero(costs.rounded).tolist()]
    del front
    for part in finer:
        if part is not None and not meter.message:
            cheap, within = part
            key = cheap.legal.tobytes() + within.tobytes()
            if key not in searched:
                searched.add(key)
                parts += last(parts_of(problem, objectives, cheap, within, meter, allowance, searched, most))
    return parts


def check_detours(problem, objectives: list[Objective], costs: Costs) -> None:
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
    points = np.array([costs.of_path(path, moves) for path in paths], dtype=np.int64).reshape(-1, n_obj)
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


def refuse(allowance: Allowance, what: str) -> None:
    """Refuse to search for paths near the front where nothing would be proven."""
    if allowance.name:
        raise CapabilityError(f"{allowance.name} is not for {what}, of which no front is certified to be near; expected none")
