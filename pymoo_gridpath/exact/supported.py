"""What single-objective searches tell of a front of two objectives: its ends, its convex hull, and bounds between them."""

from __future__ import annotations

import heapq
from typing import NamedTuple

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.exact.costs import Costs
from pymoo_gridpath.search import UNREACHABLE, Moves, backward_costs


class Hull(NamedTuple):
    """Points on the lower left hull of a front, and lower bounds for what lies between them.

    Attributes
    ----------
    bounds : numpy.ndarray of int64, shape (2, n_states)
        Least first and least second cost from each state to the goal.
    points : numpy.ndarray of int64, shape (n, 2)
        Costs of paths, non-dominated, in ascending order of the first; the first and the last are the ends of the front.
    weights : numpy.ndarray of float, shape (n - 1, 2), or (1, 2) for a single point
        Weights of a sum of both costs for each gap between neighbouring points.
    weighted : numpy.ndarray of float, shape (n_states, len(weights))
        Least weighted sum from each state to the goal.
    """

    bounds: np.ndarray
    points: np.ndarray
    weights: np.ndarray
    weighted: np.ndarray


def supported_points(moves: Moves, costs: Costs, start: int, goal: int, n_weights: int) -> Hull:
    """Return ends and hull of a front of two objectives by single-objective searches.

    Parameters
    ----------
    moves : Moves
    costs : Costs
        Of two objectives.
    start, goal : int
    n_weights : int
        How many weighted sums to minimise at most, those first that belong to the widest gaps of the hull.

    References
    ----------
    Y. P. Aneja and K. P. K. Nair, "Bicriteria transportation problem", Management Science 25(1), 1979 (weights normal to the
    gap between two points).
    """
    searches = [backward_costs(moves, *_pair(costs, order), goal, costs.with_heading) for order in ((0, 1), (1, 0))]
    bounds = np.stack([search[0] for search, _ in searches])
    left = _follow(moves, costs, costs.take((0, 1)), searches[0], start, goal)
    right = _follow(moves, costs, costs.take((1, 0)), searches[1], start, goal)
    extent = (max(right[0] - left[0], 1), max(left[1] - right[1], 1))
    points, found = {left, right}, []
    gaps = [(0.0, left, right)] if left != right else []
    while gaps and len(found) < n_weights:
        _, low, high = heapq.heappop(gaps)
        weights = _normal(low, high)
        search, point = _minimise(moves, costs, weights, start, goal)
        found.append((weights, search))
        points.add(point)
        if low[0] < point[0] < high[0] and high[1] < point[1] < low[1]:
            for a, b in ((low, point), (point, high)):
                heapq.heappush(gaps, (-max((b[0] - a[0]) / extent[0], (a[1] - b[1]) / extent[1]), a, b))
    hull = np.array(sorted(points))
    hull = hull[np.minimum.accumulate(hull[:, 1]) == hull[:, 1]]
    hull = hull[np.concatenate([[True], hull[1:, 1] < hull[:-1, 1]])]
    return _with_bounds(bounds, hull, found)


def _pair(costs: Costs, order) -> tuple[np.ndarray, np.ndarray]:
    taken = costs.take(order)
    return taken.step, taken.field


def _follow(moves: Moves, costs: Costs, searched: Costs, found, start: int, goal: int) -> tuple[int, int]:
    """Return the costs of the path from the start that a search in other costs, or another order, has found cheapest."""
    search, ahead = found
    best, first = (UNREACHABLE, UNREACHABLE), -1
    for m in range(8):
        # No heading comes before the first step.
        if moves.legal[start] >> m & 1:
            cell = start + int(moves.offsets[m])
            rest = search[:, 8 * cell + m if costs.with_heading else cell]
            total = tuple(int(searched.step[k, 8, m] + searched.field[k, cell] + rest[k]) for k in range(2))
            if total < best:
                best, first = total, m
    total = np.zeros(2, dtype=np.int64)
    follow(moves.offsets, costs.step, costs.field, costs.with_heading, ahead, start, first, goal, total)
    return int(total[0]), int(total[1])


@kernel
def follow(offsets, step, field, with_heading, ahead, start, first, goal, total):
    """Add up costs along a path that begins with a step along ``first`` and goes on as ``ahead`` says."""
    cell = start
    before = 8
    heading = np.int64(first)
    while True:
        cell += offsets[heading]
        for k in range(2):
            total[k] += step[k, before, heading] + field[k, cell]
        if cell == goal:
            return
        if with_heading:
            before = heading
        heading = np.int64(ahead[8 * cell + heading if with_heading else cell])


def _normal(low, high) -> tuple[float, float]:
    """Return weights, the larger 1, for which two points have the same weighted sum."""
    first, second = low[1] - high[1], high[0] - low[0]
    larger = max(first, second)
    return first / larger, second / larger


def _minimise(moves: Moves, costs: Costs, weights, start: int, goal: int):
    """Return least weighted sums from every state, rounded down step by step, and the point of a path that has them."""
    step = np.stack([_weighted(costs.step, weights), costs.step[0]])
    field = np.stack([_weighted(costs.field, weights), costs.field[0]])
    found = backward_costs(moves, step, field, goal, costs.with_heading)
    point = _follow(moves, costs, Costs(step, field, costs.with_heading, costs.unit), found, start, goal)
    return found[0][0], point


def _weighted(values: np.ndarray, weights) -> np.ndarray:
    return np.floor(weights[0] * values[0] + weights[1] * values[1]).astype(np.int64)


def _with_bounds(bounds: np.ndarray, hull: np.ndarray, found) -> Hull:
    """Give each gap of the hull the weights nearest to its own normal."""
    if not found:
        found = [((1.0, 1.0), bounds.sum(axis=0))]
    angle = np.array([np.arctan2(second, first) for (first, second), _ in found])
    gap = np.diff(hull, axis=0).astype(float) if len(hull) > 1 else np.array([[1.0, -1.0]])
    nearest = np.abs(np.arctan2(gap[:, 0], -gap[:, 1])[:, None] - angle[None, :]).argmin(axis=1)
    weights = np.array([found[k][0] for k in nearest], dtype=float)
    weighted = np.empty((bounds.shape[1], len(nearest)))
    for j, k in enumerate(nearest):
        weighted[:, j] = found[k][1]
    return Hull(bounds, hull, weights, weighted)
