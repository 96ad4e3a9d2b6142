"""First populations of legal paths."""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np
from pymoo.core.sampling import Sampling
from pymoo.util.reference_direction import UniformReferenceDirectionFactory

from pymoo_gridpath.operators.duplicates import row_keys
from pymoo_gridpath.operators.parameters import in_range
from pymoo_gridpath.operators.path_terrain import objective_terms, random_weights, terrain_of, whole_weights
from pymoo_gridpath.registry import OPERATORS
from pymoo_gridpath.representations.base import max_cells
from pymoo_gridpath.search.draw import cheapest_paths, paths_through
from pymoo_gridpath.search.terrain import FULL_WEIGHT, steps_through
from pymoo_gridpath.search.vary import REROUTE, Changes, vary

# Cells that all random trees of a population may visit together: more than there are samples on small grids, few on large ones.
TREE_CELLS = 4_000_000

# Cells that all searches for scalarised paths may visit together, and how many searches there may be however large the grid.
SEARCH_CELLS, LEAST_SEARCHES = 8_000_000, 16

# How far around a stretch that is to change, and how long, another way is looked for.
REROUTE_MARGIN, REROUTE_LIMIT = 16, 20_000

# The roughest blocks of equal noise have 2**3 cells a side.
LARGEST_BLOCK = 3

# Rounds of noise in which duplicates may become distinct.
ROUNDS = 4


@OPERATORS.register
class ReachableSampling(Sampling):
    """Draw random legal paths: through a random cell, along cheapest routes under random costs.

    Each path leads from the start to a random cell, and from there to the goal, by branches of two random trees of cheapest
    routes. On small grids each path has trees of its own; on large ones paths share a few, so that a population costs no
    more than some searches of the whole grid. No path meets an obstacle, however narrow the way. Paths that equal another
    or are too long for the representation are drawn again a few times, ever closer to shortest ones.

    Parameters
    ----------
    roughness : float, default 4
        The cost of each step is multiplied by a random number from 1 to 1 plus this, 0 to 8.
    detour : float, default 1
        The shortest path through the random cell is at most so much longer, relative to the shortest path of all, 0 or more.
    """

    def __init__(self, roughness: float = 4.0, detour: float = 1.0):
        super().__init__()
        self.roughness = in_range("roughness", roughness, 0, 8)
        self.detour = in_range("detour", detour, 0, np.inf)

    def _do(self, problem, n_samples, *args, random_state=None, **kwargs):
        assert random_state is not None
        points = self._points(problem)
        X = self._draw(problem, points, n_samples, 0, random_state)
        for k in range(1, ROUNDS + 1):
            # Those that were too long have all become the shortest path.
            again = repeated_rows(X)
            if len(again) == 0:
                break
            X[again] = self._draw(problem, points, len(again), k, random_state)
            if k > 1 and len(repeated_rows(X)) == len(again):
                break
        return X

    def _points(self, problem) -> np.ndarray:
        """Return the cells through which a path may be drawn."""
        terrain, moves, most = terrain_of(problem), problem.representation.moves, max_cells(problem)
        bounds = terrain.bounds[:, 0] + terrain.bounds[:, 1]
        fit = terrain.useful & (bounds <= (1.0 + self.detour) * bounds[terrain.start])
        if most < moves.n_cells:
            close = fit & (steps_through(moves, terrain.start, terrain.goal) < most)
            fit = close if close.any() else fit
        return np.flatnonzero(fit)

    def _draw(self, problem, points: np.ndarray, n: int, k: int, random_state) -> np.ndarray:
        """Return the genes of n paths, the nearer to shortest ones the greater k."""
        terrain = terrain_of(problem)
        n_trees = int(np.clip(TREE_CELLS // (2 * len(terrain.legal)), 4, n))
        weights = random_weights(problem, n_trees, random_state)
        if k > 1:
            weights[:, 0], weights[:, 1:] = FULL_WEIGHT, 1
        paths = paths_through(
            terrain,
            problem.representation.moves,
            points=random_state.choice(points, n),
            trees=random_state.integers(0, n_trees, (n, 2)),
            weights=weights,
            noise=noise_of(self.roughness / 4**k, n_trees, random_state),
            max_cells=max_cells(problem),
        )
        return problem.representation.from_sequences(paths)


@OPERATORS.register
class ScalarizedSampling(Sampling):
    """Take the cheapest paths for weights that are spread evenly over the objectives, each scaled by its range.

    The objectives that can be weighted so are those that add up along a path: the length and all that have a field. Where
    different weights have the same cheapest path, further ones are replaced by cheapest paths under random costs. On large
    grids there are fewer weights, and the further paths differ from cheapest ones in a stretch only, so that a population
    costs no more than some searches of the whole grid.

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
        terrain, moves, most = terrain_of(problem), problem.representation.moves, max_cells(problem)
        searches = max(SEARCH_CELLS // len(terrain.legal), LEAST_SEARCHES)
        spread = spread_weights(problem, min(n_samples, searches), random_state)
        distinct, which = np.unique(spread, axis=0, return_inverse=True)
        cheapest = cheapest_paths(terrain, moves, distinct, np.zeros((len(distinct), 3), dtype=np.int64), most)
        searches -= len(distinct)
        rows = np.arange(n_samples) % len(spread)
        weights, X = spread[rows], problem.representation.from_sequences(cheapest)[which.ravel()[rows]]
        for k in range(ROUNDS):
            again = repeated_rows(X)
            if self.noise == 0 or len(again) == 0:
                break
            noise = noise_of(self.noise * (1 + k / 2), len(again), random_state)
            n = min(searches, len(again))
            searches -= n
            anew, changed = again[:n], again[n:]
            X[anew] = problem.representation.from_sequences(cheapest_paths(terrain, moves, weights[anew], noise[:n], most))
            if len(changed):
                # The weights of other paths mix two cheapest paths; noise only where that brings nothing new.
                noise[:, 0] *= k > 0
                X[changed] = _rerouted(problem, X[changed], random_state.permutation(weights)[changed], noise[n:], random_state)
        return X


def _rerouted(problem, X: np.ndarray, weights: np.ndarray, noise: np.ndarray, random_state) -> np.ndarray:
    """Return the genes of paths with a random stretch replaced by the cheapest route under random costs."""
    paths = problem.representation.to_sequences(X)
    begin, end = random_stretches(paths.lengths, random_state)
    way = np.full(len(X), REROUTE)
    changes = Changes(way, begin, end, way, weights, noise)
    changed = vary(terrain_of(problem), paths, changes, REROUTE_MARGIN, REROUTE_LIMIT, max_cells(problem))
    return problem.representation.from_sequences(changed)


def random_stretches(lengths: np.ndarray, random_state, most: float = np.inf) -> tuple[np.ndarray, np.ndarray]:
    """Return the positions of the two ends of a stretch of each path.

    The logarithm of the number of steps is uniform, up to all of them or ``most``.
    """
    n = len(lengths)
    longest = np.minimum(lengths, most + 1)
    stretch = np.minimum(np.exp(random_state.random(n) * np.log(longest)).astype(np.int64), lengths - 1)
    begin = (random_state.random(n) * (lengths - stretch)).astype(np.int64)
    return begin, begin + stretch


def spread_weights(problem, n: int, random_state) -> np.ndarray:
    """Return weights of the terms of a problem's terrain, spread evenly over the simplex, int64, shape (n, K).

    Where no lattice has that many points, the rest is random.
    """
    n_terms = len(objective_terms(problem))
    if n_terms == 1:
        return whole_weights(problem, np.ones((n, 1)))
    lattice = spread_shares(n_terms, n)
    return np.concatenate([whole_weights(problem, lattice), random_weights(problem, n - len(lattice), random_state)])


def spread_shares(n_terms: int, n: int) -> np.ndarray:
    """Return shares of two terms or more that are spread evenly over the simplex, the largest lattice of at most n points."""
    n_partitions = 1
    while _lattice_size(n_terms, n_partitions + 1) <= n:
        n_partitions += 1
    return UniformReferenceDirectionFactory(n_terms, n_partitions=n_partitions).do()[:n]


def _lattice_size(n_dim: int, n_partitions: int) -> int:
    size = 1
    for k in range(1, n_dim):
        size = size * (n_partitions + k) // k
    return size


def noise_of(roughness: float, n: int, random_state) -> np.ndarray:
    """Return noise for n searches as `find_route` takes it, int64, shape (n, 3): blocks of random size and seed."""
    blocks, seeds = random_state.integers(0, LARGEST_BLOCK + 1, n), random_state.integers(0, 2**31, n)
    return np.stack([np.full(n, round(1024 * roughness)), blocks, seeds], axis=1)


def repeated_rows(X: np.ndarray) -> np.ndarray:
    """Return the numbers of the rows that equal an earlier one."""
    seen: set[Hashable] = set()
    repeated = []
    for k, key in enumerate(row_keys(X)):
        if key in seen:
            repeated.append(k)
        seen.add(key)
    return np.array(repeated, dtype=int)
