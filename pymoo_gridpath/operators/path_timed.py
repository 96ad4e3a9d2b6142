"""Operators of paths in time: what they make is legal among obstacles that move."""

from __future__ import annotations

import weakref
from typing import Any

import numpy as np
from pymoo.core.crossover import Crossover
from pymoo.core.mutation import Mutation
from pymoo.core.repair import Repair
from pymoo.core.sampling import Sampling

from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.operators.parameters import CROSSOVER_RATE, in_range, one_or_two, shares_of, whole
from pymoo_gridpath.operators.path_sampling import (
    LEAST_SEARCHES,
    ROUNDS,
    noise_of,
    random_stretches,
    repeated_rows,
    spread_shares,
)
from pymoo_gridpath.registry import OPERATORS
from pymoo_gridpath.representations.base import representation_of
from pymoo_gridpath.search.terrain import FULL_WEIGHT
from pymoo_gridpath.search.timed import N_TERMS, TimedTerrain, draw_timed, make_timed_terrain, mend_timed
from pymoo_gridpath.search.timed_vary import DELAY, HURRY, REROUTE, TimedChanges, splice_timed, vary_timed

# Cells at ticks that all searches for a first population may go on from together.
SEARCH_STATES = 2_000_000

#: The ways in which `TimedMutation` changes a path, with the default shares.
TIMED_WAYS = {"weighted": 0.5, "random": 0.2, "delay": 0.15, "hurry": 0.15}

# Made once for each problem, and kept apart from it, so that it pickles and compares as before.
_TERRAINS: weakref.WeakKeyDictionary[Any, TimedTerrain] = weakref.WeakKeyDictionary()


def timed_terrain_of(problem) -> TimedTerrain:
    """Return the terrain of a problem of paths in time.

    Raises
    ------
    GridPathError
        If it is none.
    """
    if not representation_of(problem).timed:
        raise GridPathError(
            f"the operators of path_timed are for paths in time, and the problem is of the class {type(problem).__name__}, "
            f"expected a TimedPathProblem"
        )
    if problem not in _TERRAINS:
        _TERRAINS[problem] = make_timed_terrain(problem.representation, problem.potential)
    return _TERRAINS[problem]


def _rows_of(problem, X: np.ndarray) -> np.ndarray:
    """Return legal paths of rows of genes, those that are none mended."""
    return mend_timed(timed_terrain_of(problem), problem.representation.genes(X))


def _whole(shares: np.ndarray) -> np.ndarray:
    """Return weights of shares; every term counts, if only to choose among ways that are equal in the others."""
    return np.maximum(np.rint(FULL_WEIGHT * shares), 1).astype(np.int64)


def _random_weights(n: int, random_state) -> np.ndarray:
    """Return random weights of the terms, uniform over the simplex, int64, shape (n, 3)."""
    draws = random_state.standard_exponential((n, N_TERMS))
    return _whole(draws / draws.sum(axis=1, keepdims=True))


@OPERATORS.register
class TimedSampling(Sampling):
    """Take the cheapest paths in time for weights that are spread evenly over arrival, length and vulnerability.

    The terms are scaled by their ranges. Where different weights have the same cheapest path, further ones are replaced by
    cheapest paths under random costs, and on large maps or far horizons, where searches are dear, by changed ones.

    Parameters
    ----------
    noise : float, default 0.5
        The random cost of a step is its cost times a number from 1 to 1 plus this, and more in further rounds if paths
        are still the same; 0 to 4. With 0, duplicates are left for the algorithm to eliminate.
    """

    def __init__(self, noise: float = 0.5):
        super().__init__()
        self.noise = in_range("noise", noise, 0, 4)

    def _do(self, problem, n_samples, *args, random_state=None, **kwargs):
        assert random_state is not None
        terrain = timed_terrain_of(problem)
        searches = max(SEARCH_STATES // terrain.legal.size, LEAST_SEARCHES)
        spread = _whole(spread_shares(N_TERMS, min(n_samples, searches)))
        cheapest = draw_timed(terrain, spread, np.zeros((len(spread), 3), dtype=np.int64))
        searches -= len(spread)
        chosen = np.arange(n_samples) % len(spread)
        weights, X = spread[chosen], cheapest[chosen]
        for k in range(ROUNDS):
            again = repeated_rows(X)
            if self.noise == 0 or len(again) == 0:
                break
            noise = noise_of(self.noise * (1 + k / 2), len(again), random_state)
            n = min(searches, len(again))
            searches -= n
            anew, changed = again[:n], again[n:]
            X[anew] = draw_timed(terrain, weights[anew], noise[:n])
            if len(changed):
                X[changed] = TimedMutation()._do(problem, X[changed], random_state=random_state)
        return X


@OPERATORS.register
class RandomTimedSampling(Sampling):
    """Draw random legal paths in time: through a random cell at a random tick, by cheapest ways under random costs.

    Parameters
    ----------
    roughness : float, default 4
        The cost of each step is multiplied by a random number from 1 to 1 plus this, 0 to 8.
    detour : float, default 1
        The random tick is at most so much later than the first possible arrival, relative to it, 0 or more.
    """

    def __init__(self, roughness: float = 4.0, detour: float = 1.0):
        super().__init__()
        self.roughness = in_range("roughness", roughness, 0, 8)
        self.detour = in_range("detour", detour, 0, np.inf)

    def _do(self, problem, n_samples, *args, random_state=None, **kwargs):
        assert random_state is not None
        terrain = timed_terrain_of(problem)
        soonest = draw_timed(terrain, np.array([[FULL_WEIGHT, 1, 1]]), np.zeros((1, 3), dtype=np.int64))
        latest = 1 + problem.decode(soonest).arrival[0] * (1 + self.detour)
        # All that are on a path.
        ticks, cells = np.nonzero(terrain.legal[: int(min(latest, len(terrain.legal)))])
        # As many of each tick, however many cells can be reached at it.
        tick = random_state.integers(0, ticks[-1] + 1, n_samples)
        begin, end = np.searchsorted(ticks, tick), np.searchsorted(ticks, tick, side="right")
        via = np.stack([cells[begin + (random_state.random(n_samples) * (end - begin)).astype(np.int64)], tick], axis=1)
        noise = noise_of(self.roughness, n_samples, random_state)
        return draw_timed(terrain, _random_weights(n_samples, random_state), noise, via)


@OPERATORS.register
class TimedCrossover(Crossover):
    """Follow one path up to a cell that the other visits too, and then the other.

    Where both are there at the same tick, that is all. Where they are not, the child waits for the tick of the other, or goes
    on at once, earlier or later than the other path; it waits on the way where an obstacle is in the way. Where no cell that
    both visit will do, a cheapest way for random weights of the objectives leads from one path to the other. The second child
    is made in the same way, the parents having changed places. Children are legal.

    Parameters
    ----------
    reach : int, default 16
        How many ticks the way from one path to the other may take; 0 to 1000.
    prob : float, default 0.9
        Probability of a mating to cross at all.
    n_offsprings : {1, 2}, default 2
        Children of each mating; algorithms that use one, such as C-TAEA, need 1.
    """

    makes_legal = True

    def __init__(self, reach: int = 16, prob: float = CROSSOVER_RATE, n_offsprings: int = 2, **kwargs):
        super().__init__(2, one_or_two(n_offsprings), prob=in_range("prob", prob, 0, 1), **kwargs)
        self.reach = whole("reach", reach, 0, 1000)

    def _do(self, problem, X, *args, random_state=None, **kwargs):
        assert random_state is not None
        n_matings, n = X.shape[1], self.n_offsprings * X.shape[1]
        first = np.arange(n)
        children = splice_timed(
            timed_terrain_of(problem),
            _rows_of(problem, X.reshape(-1, X.shape[2])),
            first,
            (first + n_matings) % (2 * n_matings),
            draws=random_state.random((n, 2)),
            weights=_random_weights(n, random_state),
            reach=self.reach,
        )
        return children.reshape(self.n_offsprings, n_matings, -1)


@OPERATORS.register
class TimedMutation(Mutation):
    """Take another way for a while, insert a wait, or drop one.

    For each path one of these ways is drawn:

    - "weighted": the cheapest way between two cells of the path, for random weights of the objectives, up to ``shift`` ticks
      earlier or later than before at the second; where that is the goal, at whatever tick is best.
    - "random": the same under random costs besides, three times as rough at most.
    - "delay": a wait of up to ``shift`` ticks.
    - "hurry": the next wait dropped.

    What comes after keeps its cells, earlier or later, and waits where an obstacle bars the next step. Where that does not lead
    to the goal in time, the path stays as it was.

    Parameters
    ----------
    ways : mapping, optional
        Share of each of the ways above, zero where left out; by default `TIMED_WAYS`.
    shift : int, default 3
        Ticks, 1 to 1000.
    max_expansions : int, default 50000
        Cells at ticks to go on from in search of a way before giving up.
    prob : float, default 1.0
        Probability of an individual to be mutated at all.
    """

    def __init__(self, ways=None, shift: int = 3, max_expansions: int = 50_000, prob: float = 1.0, **kwargs):
        super().__init__(prob=in_range("prob", prob, 0, 1), **kwargs)
        self.shares = shares_of(ways, TIMED_WAYS)
        self.shift = whole("shift", shift, 1, 1000)
        self.max_expansions = whole("max_expansions", max_expansions, 1, 10**9)

    def _do(self, problem, X, *args, random_state=None, **kwargs):
        assert random_state is not None
        rows = _rows_of(problem, X)
        n = len(rows)
        way = np.searchsorted(np.cumsum(self.shares)[:-1], random_state.random(n), side="right")
        begin, end = random_stretches(problem.decode(rows).arrival + 1, random_state)
        noise = noise_of(1.0, n, random_state)
        noise[:, 0] = np.where(way == _RANDOM, noise[:, 0] * random_state.integers(1, 4, n), 0)
        later = random_state.integers(-self.shift, self.shift + 1, n)
        wait = random_state.integers(1, self.shift + 1, n)
        changes = TimedChanges(
            way=np.select([way == _DELAY, way == _HURRY], [DELAY, HURRY], REROUTE),
            begin=begin,
            end=end,
            shift=np.where(way == _DELAY, wait, later),
            weights=_random_weights(n, random_state),
            noise=noise,
        )
        return vary_timed(timed_terrain_of(problem), rows, changes, self.max_expansions)


@OPERATORS.register
class TimedRepair(Repair):
    """Make legal paths in time of rows that are none, see `TimedPaths.repair`."""

    # Whoever has such a repair need not be told that other operators know nothing of paths.
    knows_paths = True

    def _do(self, problem, X, random_state=None, **kwargs):
        assert random_state is not None
        timed_terrain_of(problem)
        return problem.representation.repair(X, random_state)


_RANDOM, _DELAY, _HURRY = (list(TIMED_WAYS).index(way) for way in ("random", "delay", "hurry"))
