"""MOEA/D that takes constraints and breaks ties by smoothness."""

from __future__ import annotations

from typing import Any

import numpy as np
from moocore import is_nondominated
from pymoo.algorithms.moo.moead import MOEAD, default_decomp
from scipy.spatial.distance import cdist

from pymoo_gridpath.errors import CapabilityError

#: Decomposed values that differ by no more than this share of 1 + their size are a tie.
TIE = 1e-9


class SmoothMOEAD(MOEAD):
    """MOEA/D with constraints, scaled objectives and a smoothness tie-break.

    A child takes the place of a neighbour if, in this order,

    1. its constraint violation is smaller;
    2. of equal violations, its decomposed value in the neighbour's direction is smaller;
    3. of equal values (to `TIE`), it dominates the neighbour, or neither dominates the other and its total turn is smaller.

    The third step is the smoothness tie-break. Paths of the same length and vulnerability tie in every direction, so the
    smoothest of them is kept; and so do paths that differ only in the objective that does not decide a Chebyshev value, where
    dominance goes first lest smoothness cost an objective.

    On a grid few objective vectors exist, and one good child would soon fill all neighbourhoods with copies of itself. Hence a
    child replaces no more than ``n_replace`` neighbours, chosen at random, and none if a neighbour has the same genes.

    Parameters
    ----------
    ref_dirs : numpy.ndarray, shape (n_directions, n_obj)
        Reference directions, two or more; their number is the population size.
    smoothness : bool, default True
        Whether to break ties by ``turn``, which the problem then has to set.
    normalize : bool, default True
        Whether to decompose objectives scaled to the range from the ideal point to the nadir point, since length and
        vulnerability have different ranges. The ideal point is the best value of each objective so far among feasible
        individuals (among all, until one is feasible); the nadir point is the worst value among the non-dominated of them,
        estimated anew each generation.
    n_replace : int, default 5
        Most neighbours that a child may replace; pymoo's MOEA/D has no limit.
    **kwargs
        As for pymoo's `MOEAD`: ``n_neighbors``, ``decomposition``, ``prob_neighbor_mating``, ``sampling``, ``crossover``,
        ``mutation``, ``repair``, ``output`` and others.

    Raises
    ------
    CapabilityError
        If ref_dirs has fewer than two rows, n_replace is not positive, or, when the run begins, ref_dirs has another number of
        columns than the problem objectives.

    Notes
    -----
    Unlike pymoo's own, mating is told the algorithm, so that mutation rates that follow the run do. As there, each mating
    gives one child.

    References
    ----------
    Q. Zhang and H. Li, "MOEA/D: a multiobjective evolutionary algorithm based on decomposition", IEEE Transactions on
    Evolutionary Computation 11(6), 2007; section V.F for the scaling. H. Li and Q. Zhang,
    "Multiobjective optimization problems with complicated Pareto sets, MOEA/D and NSGA-II", IEEE Transactions on Evolutionary
    Computation 13(2), 2009, for the limit on replacements. K. Deb, "An efficient constraint handling method for
    genetic algorithms", Computer Methods in Applied Mechanics and Engineering 186, 2000, for the first step.
    """

    # pymoo fills these when the run begins.
    problem: Any
    pop: Any
    mating: Any
    ref_dirs: Any
    neighbors: Any
    random_state: Any

    def __init__(self, ref_dirs, smoothness: bool = True, normalize: bool = True, n_replace: int = 5, **kwargs):
        ref_dirs = np.asarray(ref_dirs, dtype=float)
        if ref_dirs.ndim != 2 or len(ref_dirs) < 2:
            raise CapabilityError(f"MOEA/D needs two or more reference directions as rows, got shape {ref_dirs.shape}")
        if n_replace < 1:
            raise CapabilityError(f"n_replace is {n_replace}, expected a positive number of neighbours")
        super().__init__(ref_dirs=ref_dirs, **kwargs)
        self.smoothness = smoothness
        self.normalize = normalize
        self.n_replace = n_replace
        self.seen_feasible = False

    def _setup(self, problem, **kwargs):
        if self.ref_dirs.shape[1] != problem.n_obj:
            raise CapabilityError(
                f"the reference directions have {self.ref_dirs.shape[1]} columns, the problem {problem.n_obj} objectives"
            )
        # A neighbourhood includes its own direction.
        self.neighbors = np.argsort(cdist(self.ref_dirs, self.ref_dirs), axis=1, kind="stable")[:, : self.n_neighbors]
        if self.decomposition is None:
            self.decomposition = default_decomp(problem)

    def _initialize_advance(self, infills=None, **kwargs):
        super()._initialize_advance(infills, **kwargs)
        self.ideal = np.full(self.problem.n_obj, np.inf)

    def _next(self):
        self._read_population()
        self._rescale()
        run = {"random_state": self.random_state, "algorithm": self}
        n_parents = self.mating.crossover.n_parents
        for k in self.random_state.permutation(len(self.pop)):
            parents = self.selection.do(self.problem, self.pop, 1, n_parents, neighbors=[self.neighbors[k]], **run)
            off = self.mating.do(self.problem, self.pop, 1, parents=parents, n_max_iterations=1, **run)[0]
            off = yield off
            self._move_ideal(off.F[None], off.CV <= 0.0)
            self._replace(k, off)

    def _read_population(self) -> None:
        # Arrays beside the population: reading 20 neighbours one attribute at a time costs more than comparing them.
        self._X, self._F = self.pop.get("X"), self.pop.get("F").astype(float)
        self._cv = self.pop.get("CV")[:, 0]
        self._turn = self.pop.get("turn").astype(float) if self.smoothness else np.zeros(len(self.pop))

    def _move_ideal(self, F: np.ndarray, feasible: np.ndarray) -> None:
        if feasible.any():
            F = F[feasible]
            if not self.seen_feasible:
                # What only paths through obstacles reach is no ideal.
                self.ideal, self.seen_feasible = F.min(axis=0), True
        elif self.seen_feasible:
            return
        self.ideal = np.minimum(self.ideal, F.min(axis=0))

    def _rescale(self) -> None:
        feasible = self._cv <= 0.0
        self._move_ideal(self._F, feasible)
        self.span = np.ones(self._F.shape[1])
        if self.normalize:
            F = self._F[feasible] if feasible.any() else self._F
            span = F[is_nondominated(F, keep_weakly=True)].max(axis=0) - self.ideal
            self.span[span > 0] = span[span > 0]

    def _replace(self, k, off):
        N = self.neighbors[k]
        if (self._X[N] == off.X).all(axis=1).any():
            return
        F, weights = self._F[N], self.ref_dirs[N]
        both = (np.concatenate([F, np.broadcast_to(off.F, F.shape)]) - self.ideal) / self.span
        value = self.decomposition.do(
            both, weights=np.concatenate([weights, weights]), _type="one_to_one", ideal_point=np.zeros(F.shape[1])
        )
        old, new = value[: len(N)], value[len(N) :]
        cv, turn = off.CV[0], float(off.get("turn")) if self.smoothness else 0.0
        smaller = old - new > TIE * (1.0 + np.abs(old))
        tie = np.abs(old - new) <= TIE * (1.0 + np.abs(old))
        no_worse, no_better = (off.F <= F).all(axis=1), (off.F >= F).all(axis=1)
        wins_tie = tie & ((no_worse & ~no_better) | ((no_worse | ~no_better) & (turn < self._turn[N])))
        better = N[(cv < self._cv[N]) | ((cv == self._cv[N]) & (smaller | wins_tie))]
        if len(better) > self.n_replace:
            better = self.random_state.choice(better, self.n_replace, replace=False)
        self.pop[better] = off
        self._X[better], self._F[better], self._cv[better], self._turn[better] = off.X, off.F, cv, turn
