"""The cheapest ways to the goal by weighted sums of two costs: bounds of what is left, and ends for paths that have begun."""

from __future__ import annotations

from typing import Any

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.exact.costs import Costs
from pymoo_gridpath.exact.labels import Front
from pymoo_gridpath.exact.staircase import Staircase, lower
from pymoo_gridpath.search import UNREACHABLE, Moves
from pymoo_gridpath.search.arrays import grown
from pymoo_gridpath.search.shortest import Backward

# Factors by which a number becomes no larger, or no smaller, in single precision, which rounds by half as much at most.
_DOWN, _UP = 1.0 - 2.0**-23, 1.0 + 2.0**-23

# What a weighted sum and the two costs of a way are, in the rows.
SUM, FIRST, SECOND = range(3)

#: Bytes of a state that ways take, and that are kept of them until it is known whether more is needed.
WAY, WAY_KEPT = 3 * 4 + 1, 4 + 1


class Ways:
    """For each weighted sum that has been minimised the cheapest way to the goal from each state.

    A path that has come to a state can go on along any of them, and its costs then lower the staircase: a path joined so is
    known, if not on the front, then near it.

    Parameters
    ----------
    moves : Moves
    costs : Costs
        Of two objectives.
    goal : int
    n_weights : int
        Most weighted sums.
    staircase : Staircase
    at_once : bool
        Whether a label search is sure to come, so that all that it needs is kept from the first.

    Attributes
    ----------
    rows : numpy.ndarray of float32, shape (n_weights, n_states, 3)
        For each state the weighted sum of what is left, or a little less, and both costs of the way that has it, or a little
        more: single precision takes half the room. The sum is huge, and the costs infinite, where no path below the staircase
        can lead. Empty until `complete` has been called, if not kept at once.
    ahead : list of numpy.ndarray of int8
        Heading of the first step of each of these ways, see `Backward`.
    """

    def __init__(self, moves: Moves, costs: Costs, goal: int, n_weights: int, staircase: Staircase, at_once: bool):
        self.moves, self.costs, self.goal, self.staircase = moves, costs, goal, staircase
        self._arrays = moves.offsets, costs.step, costs.field, costs.enter, costs.with_heading
        self._n_states = moves.n_cells * (8 if costs.with_heading else 1)
        self.rows = np.empty((n_weights, self._n_states if at_once else 0, 3), dtype=np.float32)
        self._at_once, self._sums = at_once, []
        self.ahead: list[np.ndarray] = []
        # Of all paths together: the state in each cell but the goal, and what has been spent by then.
        self._paths: list[np.ndarray] = []
        self._states, self._spent = np.empty(0, dtype=np.int64), np.empty((0, 2), dtype=np.int64)
        self._joined = [np.empty((0, 4), dtype=np.int64)]

    @property
    def n_bytes_more(self) -> int:
        """Bytes that `complete` will take."""
        return 0 if self._at_once else self._n_states * len(self.ahead) * (WAY - 1)

    def of(self, found: Backward, number: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the ways of a weighted sum that has been minimised, as a column of ``rows``, and their headings.

        The costs that the search has found are written over.
        """
        column = self.rows[number] if self._at_once else np.empty((self._n_states, 3), dtype=np.float32)
        self._follow(found.ahead, found.cost, column)
        return column, found.ahead

    def _follow(self, ahead: np.ndarray, scratch: np.ndarray, column: np.ndarray) -> None:
        follow_all(*self._arrays, ahead, self.goal, scratch, column)

    def add(self, column: np.ndarray, ahead: np.ndarray) -> None:
        """Add ways, and let all paths that are known go on along them."""
        self.ahead.append(ahead)
        if not self._at_once:
            self._sums.append(column[:, SUM].copy())
        self._join(column[None], len(self.ahead) - 1)

    def begin(self, path: np.ndarray) -> None:
        """Add a path whose beginnings may go on otherwise."""
        states, spent = spent_along(*self._arrays, path)
        self._paths.append(path)
        self._states, self._spent = np.concatenate([self._states, states]), np.concatenate([self._spent, spent])

    def bound(self, sums: np.ndarray) -> None:
        """Take sums for bounds where none has been minimised, int64, shape (n_states,)."""
        self.rows = np.full((1, len(sums), 3), np.inf, dtype=np.float32)
        self.rows[0, :, SUM] = sums * _DOWN

    def complete(self) -> None:
        """Make the rows ready for a label search, and let all beginnings of known paths go on along all ways."""
        if not self._at_once:
            self.rows = np.empty((len(self.ahead), self._n_states, 3), dtype=np.float32)
            scratch = np.empty((2, self._n_states), dtype=np.int64)
            for k, (sums, ahead) in enumerate(zip(self._sums, self.ahead, strict=True)):
                scratch[0] = sums
                self._follow(ahead, scratch, self.rows[k])
            self._sums.clear()
        self._join(self.rows[: len(self.ahead)], 0)

    def _join(self, rows: np.ndarray, column: int) -> None:
        stairs = self.staircase.least, self.staircase.low, self.staircase.shift
        joined: Any = join(self._states, self._spent, rows, *stairs)
        joined[:, 1] += column
        self._joined.append(joined)

    @property
    def points(self) -> np.ndarray:
        """The costs of the paths that have been joined so, or a little more, int64, shape (n, 2)."""
        return np.concatenate(self._joined)[:, 2:]

    def joined(self) -> Front:
        """Return what is non-dominated of these paths."""
        joined = np.concatenate(self._joined)
        ends = np.cumsum([len(path) - 1 for path in self._paths])
        paths = []
        for place, column in joined[undominated(joined[:, 2:]), :2].tolist():
            number = int(np.searchsorted(ends, place, side="right"))
            path = self._paths[number][: place - int(ends[number]) + len(self._paths[number])]
            paths.append(self.ended(path, int(self._states[place]), column))
        return self.front(paths)

    def ended(self, path: np.ndarray, state: int, column: int) -> np.ndarray:
        """Return a path that has come to a state and goes on along a way, its cells but once each."""
        rest = way(self.moves.offsets, self.costs.with_heading, self.ahead[column], state, self.goal)
        return without_loops(np.concatenate([path, rest]))

    def front(self, paths: list[np.ndarray]) -> Front:
        """Return what is non-dominated of some paths."""
        points = np.array([self.costs.of_path(path, self.moves) for path in paths], dtype=np.int64).reshape(-1, 2)
        keep = undominated(points)
        return Front([paths[k] for k in keep], points[keep])


def undominated(points: np.ndarray) -> np.ndarray:
    """Return the places of the non-dominated of points, shape (n, 2), each once and in ascending order of the first cost."""
    order = np.lexsort((points[:, 1], points[:, 0]))
    best_before = np.concatenate([[UNREACHABLE], np.minimum.accumulate(points[order, 1])])[: len(order)]
    return order[points[order, 1] < best_before]


def without_loops(path: np.ndarray) -> np.ndarray:
    """Return a path without what it does between two visits of the same cell."""
    last = dict(zip(path.tolist(), range(len(path)), strict=True))
    if len(last) == len(path):
        return path
    kept, k = [], 0
    while k < len(path):
        kept.append(path[k])
        k = last[int(path[k])] + 1
    return np.array(kept, dtype=path.dtype)


@kernel
def follow_all(offsets, step, field, enter, with_heading, ahead, goal, cost, column):
    """Fill in a column of `Ways`: the sum of the way ahead from each state, and both its costs.

    ``cost``, int64, shape (2, n_states), holds the sums first, and is written over.
    """
    n = len(ahead)
    waiting = np.empty(n, dtype=np.int32)
    for state in range(n):
        column[state, SUM] = np.float32(cost[0, state] * _DOWN)
        cost[0, state] = -1
    for state in range(n):
        if ahead[state] < 0:
            at_goal = (state >> 3 if with_heading else state) == goal
            cost[0, state] = 0 if at_goal else UNREACHABLE
            cost[1, state] = cost[0, state]
            column[state, FIRST] = np.float32(0.0 if at_goal else np.inf)
            column[state, SECOND] = column[state, FIRST]
            continue
        at = state
        n_waiting = 0
        while cost[0, at] < 0 and ahead[at] >= 0:
            waiting[n_waiting] = at
            n_waiting += 1
            m = np.int64(ahead[at])
            cell = (at >> 3 if with_heading else at) + offsets[m]
            at = 8 * cell + m if with_heading else cell
        if cost[0, at] < 0:
            # The goal.
            cost[0, at] = 0
            cost[1, at] = 0
        while n_waiting > 0:
            n_waiting -= 1
            before = np.int64(waiting[n_waiting])
            cell = at >> 3 if with_heading else at
            m = np.int64(ahead[before])
            for k in range(2):
                cost[k, before] = cost[k, at] + step[k, before & 7 if with_heading else 8, m] + field[k, cell]
                if enter is not None:
                    cost[k, before] += enter[k, cell, m]
            at = before
        column[state, FIRST] = np.float32(cost[0, state] * _UP)
        column[state, SECOND] = np.float32(cost[1, state] * _UP)


@kernel
def spent_along(offsets, step, field, enter, with_heading, path):
    """Return the state in each cell of a path but the goal, and what has been spent by then, both int64."""
    n = len(path) - 1
    states = np.empty(n, dtype=np.int64)
    spent = np.zeros((n, 2), dtype=np.int64)
    # No way leads on from the start with a heading; without one it may.
    states[0] = -1 if with_heading else path[0]
    heading = 8
    for i in range(1, n):
        m = 0
        while offsets[m] != path[i] - path[i - 1]:
            m += 1
        for k in range(2):
            spent[i, k] = spent[i - 1, k] + step[k, heading, m] + field[k, path[i]]
            if enter is not None:
                spent[i, k] += enter[k, path[i], m]
        states[i] = 8 * path[i] + m if with_heading else path[i]
        if with_heading:
            heading = m
    return states, spent


@kernel
def join(states, spent, rows, least, low, shift):
    """Let paths go on along all ways, and return those that lower the staircase.

    Returns
    -------
    joined : int64, shape (n, 4)
        Number of the state where a path goes on, of the way, and both costs of the whole, or a little more.
    """
    # Each path may go on along as many.
    joined = np.empty((16 + len(rows), 4), dtype=np.int64)
    n = 0
    i = 0
    while i < len(states):
        i, n = _join(states, spent, rows, least, low, shift, i, joined, n)
        if i < len(states):
            joined = grown(joined)
    return joined[:n].copy()


@kernel
def _join(states, spent, rows, least, low, shift, i, joined, n):
    """Let paths from number ``i`` on go on, as far as there is room; return the first that did not, and how many are joined."""
    while i < len(states) and n + len(rows) <= len(joined):
        state = states[i]
        for j in range(len(rows) if state >= 0 else 0):
            if rows[j, state, FIRST] == np.inf:
                continue
            first = spent[i, 0] + np.int64(rows[j, state, FIRST])
            second = spent[i, 1] + np.int64(rows[j, state, SECOND])
            if lower(least, low, shift, first, second):
                joined[n, 0] = i
                joined[n, 1] = j
                joined[n, 2] = first
                joined[n, 3] = second
                n += 1
        i += 1
    return i, n


@kernel
def way(offsets, with_heading, ahead, state, goal):
    """Return the cells of the way ahead from a state, without its own."""
    n = 0
    at = state
    while ahead[at] >= 0 and (at >> 3 if with_heading else at) != goal:
        m = np.int64(ahead[at])
        cell = (at >> 3 if with_heading else at) + offsets[m]
        at = 8 * cell + m if with_heading else cell
        n += 1
    cells = np.empty(n, dtype=np.int64)
    at = state
    for k in range(n):
        m = np.int64(ahead[at])
        cells[k] = (at >> 3 if with_heading else at) + offsets[m]
        at = 8 * cells[k] + m if with_heading else cells[k]
    return cells
