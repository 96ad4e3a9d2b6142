"""First populations of legal paths."""

from __future__ import annotations

import numpy as np
from pymoo.core.sampling import Sampling
from pymoo.util.reference_direction import UniformReferenceDirectionFactory

from pymoo_gridpath.operators.duplicates import row_keys
from pymoo_gridpath.operators.parameters import in_range
from pymoo_gridpath.operators.terrain import max_cells, objective_terms, random_weights, terrain_of, whole_weights
from pymoo_gridpath.search.sampling import cheapest_paths, paths_through

# Cells that all random trees of a population may visit together: more than there are samples on small grids, few on large ones.
TREE_CELLS = 4_000_000

# The roughest blocks of equal noise have 2**3 cells a side.
LARGEST_BLOCK = 3

# Rounds of noise in which duplicates may become distinct.
ROUNDS = 4


class ReachableSampling(Sampling):
    """Draw random legal paths: through a random cell, along cheapest routes under random costs.

    Each path leads from the start to a random cell, and from there to the goal, by branches of two random trees of cheapest
    routes. On small grids each path has trees of its own; on large ones paths share a few, so that a population costs no
    more than some searches of the whole grid. No path meets an obstacle, however narrow the way.

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
        terrain = terrain_of(problem)
        bounds = terrain.bounds[:, 0] + terrain.bounds[:, 1]
        points = np.flatnonzero(terrain.useful & (bounds <= (1.0 + self.detour) * bounds[terrain.start]))
        n_trees = int(np.clip(TREE_CELLS // (2 * len(terrain.legal)), 4, n_samples))
        paths = paths_through(
            terrain,
            points=random_state.choice(points, n_samples),
            trees=random_state.integers(0, n_trees, (n_samples, 2)),
            weights=random_weights(problem, n_trees, random_state),
            noise=noise_of(self.roughness, n_trees, random_state),
            max_cells=max_cells(problem),
        )
        return problem.representation.from_sequences(paths)


class ScalarizedSampling(Sampling):
    """Take the cheapest paths for weights that are spread evenly over the objectives, each scaled by its range.

    The objectives that can be weighted so are those that add up along a path: the length and all that have a field. Where
    different weights have the same cheapest path, further ones are replaced by cheapest paths under random costs.

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
        terrain, most = terrain_of(problem), max_cells(problem)
        weights = spread_weights(problem, n_samples, random_state)
        encode = problem.representation.from_sequences
        X = encode(cheapest_paths(terrain, weights, np.zeros((n_samples, 3), dtype=np.int64), most))
        for k in range(ROUNDS):
            again = _repeated(X)
            if self.noise == 0 or len(again) == 0:
                break
            noise = noise_of(self.noise * (1 + k / 2), len(again), random_state)
            X[again] = encode(cheapest_paths(terrain, weights[again], noise, most))
        return X


def spread_weights(problem, n: int, random_state) -> np.ndarray:
    """Return weights of the terms of a problem's terrain, spread evenly over the simplex, int64, shape (n, K).

    Where no lattice has that many points, the rest is random.
    """
    n_terms = len(objective_terms(problem))
    if n_terms == 1:
        return whole_weights(problem, np.ones((n, 1)))
    n_partitions = 1
    while _lattice_size(n_terms, n_partitions + 1) <= n:
        n_partitions += 1
    lattice = UniformReferenceDirectionFactory(n_terms, n_partitions=n_partitions).do()[:n]
    return np.concatenate([whole_weights(problem, lattice), random_weights(problem, n - len(lattice), random_state)])


def _lattice_size(n_dim: int, n_partitions: int) -> int:
    size = 1
    for k in range(1, n_dim):
        size = size * (n_partitions + k) // k
    return size


def noise_of(roughness: float, n: int, random_state) -> np.ndarray:
    """Return noise for n searches as `find_route` takes it, int64, shape (n, 3): blocks of random size and seed."""
    blocks, seeds = random_state.integers(0, LARGEST_BLOCK + 1, n), random_state.integers(0, 2**31, n)
    return np.stack([np.full(n, round(1024 * roughness)), blocks, seeds], axis=1)


def _repeated(X: np.ndarray) -> np.ndarray:
    """Return the numbers of the rows that equal an earlier one."""
    seen: set[bytes] = set()
    repeated = []
    for k, key in enumerate(row_keys(X)):
        if key in seen:
            repeated.append(k)
        seen.add(key)
    return np.array(repeated, dtype=int)
