"""Crossover of paths at cells that they share."""

from __future__ import annotations

import numpy as np
from pymoo.core.crossover import Crossover

from pymoo_gridpath.operators.parameters import CROSSOVER_RATE, in_range, one_or_two, whole
from pymoo_gridpath.operators.path_terrain import paths_of, random_weights, terrain_of
from pymoo_gridpath.registry import OPERATORS
from pymoo_gridpath.representations.base import max_cells
from pymoo_gridpath.search.splice import splice


@OPERATORS.register
class SpliceCrossover(Crossover):
    """Exchange stretches of two paths where they share a cell, or come near one another.

    Two paths part and meet again any number of times. A child is one parent with one or more of the stretches between, one
    after another, taken from the other parent, but never all of them. Where the parents share no cell but their common head and
    tail, a child follows one parent up to a random cell that the other comes near, and then the other, the two joined by a
    cheapest route for random weights of the objectives. The second child is made in the same way, the parents having changed
    places. Children are legal paths without loops; genes are not mixed.

    Parameters
    ----------
    reach : int, default 4
        How many cells away, in the larger of x and y, is near; 0 to 64.
    prob : float, default 0.9
        Probability of a mating to cross at all.
    n_offsprings : {1, 2}, default 2
        Children of each mating; algorithms that use one, such as C-TAEA, need 1.
    """

    # So that many soon have equal objectives.
    makes_legal = True

    def __init__(self, reach: int = 4, prob: float = CROSSOVER_RATE, n_offsprings: int = 2, **kwargs):
        super().__init__(2, one_or_two(n_offsprings), prob=in_range("prob", prob, 0, 1), **kwargs)
        self.reach = whole("reach", reach, 0, 64)

    def _do(self, problem, X, *args, random_state=None, **kwargs):
        assert random_state is not None
        n_matings, n = X.shape[1], self.n_offsprings * X.shape[1]
        first = np.arange(n)
        children = splice(
            terrain_of(problem),
            paths_of(problem, X.reshape(-1, X.shape[2])),
            first,
            (first + n_matings) % (2 * n_matings),
            draws=random_state.random((n, 2)),
            weights=random_weights(problem, n, random_state),
            reach=self.reach,
            max_cells=max_cells(problem),
        )
        return problem.representation.from_sequences(children).reshape(self.n_offsprings, n_matings, -1)
