"""Mutation of paths: a stretch takes another way."""

from __future__ import annotations

import numpy as np
from pymoo.core.mutation import Mutation

from pymoo_gridpath.operators.parameters import in_range, shares_of, whole
from pymoo_gridpath.operators.path_sampling import noise_of, random_stretches
from pymoo_gridpath.operators.path_terrain import paths_of, random_weights, terrain_of
from pymoo_gridpath.registry import OPERATORS
from pymoo_gridpath.representations.base import max_cells
from pymoo_gridpath.search.terrain import FULL_WEIGHT
from pymoo_gridpath.search.vary import REROUTE, SHIFT, STRAIGHTEN, Changes, vary

#: The ways in which `PathMutation` changes a stretch, with the default shares.
WAYS = {"weighted": 0.5, "random": 0.2, "shortcut": 0.1, "straighten": 0.1, "shift": 0.1}

# A search expands several cells for each step of the stretch; where it may not so many, it is mostly given up. On maps of rooms
# of 512 cells a side a run with 14 takes less than three quarters of the time, but finds a little less.
EXPANSIONS_PER_STEP = 8


@OPERATORS.register
class PathMutation(Mutation):
    """Replace a random stretch between two cells of a path.

    The stretch has between one step and all of them, as likely 10 to 20 as 100 to 200, but no more than most searches can
    bridge: an eighth of ``max_expansions``. For each path one of these ways is drawn:

    - "weighted": the cheapest route for random weights of the objectives that add up along a path.
    - "random": the cheapest route under random costs besides, three times as rough at most.
    - "shortcut": the shortest route.
    - "straighten": the way with a single turn, a diagonal and a straight run.
    - "shift": the same cells moved one cell to a side.

    Obstacles are never entered and loops are cut, so paths stay legal. Where a search is given up, the stretch ends at the last
    of its cells to which the cheapest route is known. Where there is none, or the way is barred, the path stays as it was.

    Parameters
    ----------
    ways : mapping, optional
        Share of each of the ways above, zero where left out; by default `WAYS`.
    margin : int, default 16
        New routes keep to the bounding box of the two cells, grown by so many cells on each side.
    max_expansions : int, default 5000
        Cells to expand in search of a route before giving up, which bounds the time that a mutation takes on large maps.
    prob : float, default 1.0
        Probability of an individual to be mutated at all.
    """

    # No child needs repair.
    makes_legal = True

    def __init__(self, ways=None, margin: int = 16, max_expansions: int = 5000, prob: float = 1.0, **kwargs):
        super().__init__(prob=in_range("prob", prob, 0, 1), **kwargs)
        self.shares = shares_of(ways, WAYS)
        self.margin = whole("margin", margin, 0, 10**6)
        self.max_expansions = whole("max_expansions", max_expansions, 1, 10**9)

    def _do(self, problem, X, *args, random_state=None, **kwargs):
        assert random_state is not None
        paths = paths_of(problem, X)
        changes = self._draw(problem, paths.lengths, random_state)
        changed = vary(terrain_of(problem), paths, changes, self.margin, self.max_expansions, max_cells(problem))
        return problem.representation.from_sequences(changed)

    def _draw(self, problem, lengths: np.ndarray, random_state) -> Changes:
        n = len(lengths)
        way = np.searchsorted(np.cumsum(self.shares)[:-1], random_state.random(n), side="right")
        begin, end = random_stretches(lengths, random_state, max(self.max_expansions // EXPANSIONS_PER_STEP, 1))
        weights = random_weights(problem, n, random_state)
        weights[way == _SHORTCUT] = 1
        weights[way == _SHORTCUT, 0] = FULL_WEIGHT
        noise = noise_of(1.0, n, random_state)
        noise[:, 0] = np.where(way == _RANDOM, noise[:, 0] * random_state.integers(1, 4, n), 0)
        kind = np.select([way == _STRAIGHTEN, way == _SHIFT], [STRAIGHTEN, SHIFT], REROUTE)
        return Changes(kind, begin, end, random_state.integers(0, 8, n), weights, noise)


_RANDOM, _SHORTCUT, _STRAIGHTEN, _SHIFT = (list(WAYS).index(way) for way in ("random", "shortcut", "straighten", "shift"))
