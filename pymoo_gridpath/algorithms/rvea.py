"""RVEA's survival, finite where an objective has no range."""

from __future__ import annotations

from typing import Any

import numpy as np
from pymoo.algorithms.moo.rvea import APDSurvival, calc_V

from pymoo_gridpath.operators.survival import ArraySurvival


class FiniteAPDSurvival(ArraySurvival, APDSurvival):
    """The original RVEA's survival, pymoo's with the same survivors in the same order, but without values that are no numbers.

    It departs from pymoo's only where that divides by nought or takes the angle of a cosine above 1. pymoo's directions are no
    numbers from their first adaptation on if an objective is constant over the survivors, and then the run stands still; here
    such an objective has the range 1. A path that lies on its direction has the angle 0, where pymoo's rounding may give none,
    and keep that path however long it is.

    Parameters
    ----------
    ref_dirs : numpy.ndarray, shape (n_directions, n_obj)
    alpha : float, default 2.0
        Exponent of the progress of the run in the penalty of an angle.

    References
    ----------
    R. Cheng, Y. Jin, M. Olhofer and B. Sendhoff, "A reference vector guided evolutionary algorithm for many-objective
    optimization", IEEE Transactions on Evolutionary Computation 20(5), 2016.
    """

    # pymoo fills these as the run goes.
    V: Any
    gamma: Any
    nadir: Any
    niches: Any

    def __init__(self, ref_dirs: np.ndarray, alpha: float = 2.0):
        super().__init__(ref_dirs, alpha=alpha)
        self.gamma = _least_angles(self.V)

    def adapt(self) -> None:
        """Scale the directions by the ranges of the objectives over the survivors."""
        if self.nadir is None:
            return
        span = self.nadir - self.ideal
        self.V = calc_V(calc_V(self.ref_dirs) * np.where(span > 0, span, 1.0))
        self.gamma = _least_angles(self.V)

    def _do(self, problem, pop, *args, n_survive=None, algorithm: Any = None, n_gen=None, n_max_gen=None, **kwargs):
        n_gen = algorithm.n_gen - 1 if n_gen is None else n_gen
        n_max_gen = algorithm.termination.n_max_gen if n_max_gen is None else n_max_gen
        # pymoo counts a budget of evaluations that the first population uses up as one of no generation.
        progress = n_gen / n_max_gen if n_max_gen > 0 else 1.0
        F = pop.get("F").astype(float)
        self.ideal = np.minimum(F.min(axis=0), self.ideal)
        shifted = F - self.ideal
        distance = np.maximum(np.linalg.norm(shifted, axis=1), 1e-64)
        angles = np.arccos(np.minimum((shifted / distance[:, None]) @ self.V.T, 1.0))
        niche = angles.argmin(axis=1)
        theta = angles[np.arange(len(pop)), niche]
        weight = problem.n_obj if problem.n_obj > 2 else 1.0
        apd = distance * (1 + weight * progress**self.alpha * (theta / self.gamma[niche]))
        # By niche, then by value; the sort is stable, so that of equal ones the first survives.
        order = np.lexsort((apd, niche))
        survivors = order[np.unique(niche[order], return_index=True)[1]]
        best = np.zeros(len(pop), dtype=bool)
        best[survivors] = True
        pop.set("theta", theta, "apd", apd, "niche", niche, "opt", best)
        self.niches = [np.flatnonzero(niche == k).tolist() for k in range(len(self.V))]
        self.nadir = F[survivors].max(axis=0)
        return pop[survivors]


def _least_angles(V: np.ndarray) -> np.ndarray:
    """Return the angle between each direction and its nearest neighbour, never nought."""
    return np.maximum(np.arccos(np.minimum(-np.sort(-1 * V @ V.T)[:, 1], 1.0)), 1e-64)
