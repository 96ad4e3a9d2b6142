"""Which members of a population are legal paths, and the front of these."""

from __future__ import annotations

from typing import NamedTuple

import moocore
import numpy as np
from pymoo.core.individual import Individual
from pymoo.core.population import Population


class Members:
    """The members of an algorithm's population that are legal paths.

    Legal is what crosses no obstacle and, where the problem has constraints, violates none: the rule for all that records or
    shows how a search gets on.

    Parameters
    ----------
    algorithm : pymoo.core.algorithm.Algorithm
        With an evaluated population of a `GridPathProblem`.
    pop : pymoo.core.population.Population, optional
        Other members, by default the algorithm's population.

    Attributes
    ----------
    F : numpy.ndarray, shape (n_legal, n_obj)
        Of those that are legal paths, and so without penalties.
    turn : numpy.ndarray, shape (n_legal,)
        Theirs, in degrees.
    n_legal, n_members : int
    """

    def __init__(self, algorithm, pop=None):
        pop = algorithm.pop if pop is None else pop
        self._names = algorithm.problem.objective_names
        violation = _values(pop, "CV").ravel() if algorithm.problem.has_constraints() else None
        self._legal = pop[are_legal(_values(pop, "interfering_cells"), violation)]
        self.n_members, self.n_legal = len(pop), len(self._legal)
        self.F = _values(self._legal, "F").astype(float).reshape(-1, algorithm.problem.n_obj)
        self.turn = _values(self._legal, "turn").astype(float)

    def front(self) -> np.ndarray:
        """Return the indices of the non-dominated ones, each point of F once, sorted by the objectives from the first on.

        Of those with the same objectives, it is the one that turns least.
        """
        order = np.lexsort((self.turn, *self.F.T[::-1]))
        F = self.F[order]
        kept = np.ones(len(F), dtype=bool)
        if F.shape[1] == 2:
            # Each has to be better in the second than all before it, which are no worse in the first.
            kept[1:] = F[1:, 1] < np.minimum.accumulate(F[:-1, 1])
            return order[kept]
        kept[1:] = (F[1:] != F[:-1]).any(axis=1)
        order = order[kept]
        return order[moocore.is_nondominated(F[kept])] if len(order) else order

    def least(self, objective: str) -> float:
        """Return the least value of an objective among the legal ones, ``inf`` without any, NaN if the problem has no such."""
        if objective not in self._names:
            return np.nan
        return float(self.F[:, self._names.index(objective)].min(initial=np.inf))

    def X(self, indices: np.ndarray, n_var: int) -> np.ndarray:
        """Return the genes of some of the legal ones."""
        if not len(indices):
            return np.empty((0, n_var))
        return _values(self._legal[indices], "X")


def _values(pop: Population, key: str) -> np.ndarray:
    """Return the values of a key, from each individual itself unless the population has a quicker way than pymoo's."""
    if type(pop).get is not Population.get:
        return np.asarray(pop.get(key))
    is_attribute = hasattr(Individual, key)
    return np.array([getattr(one, key) if is_attribute else one.data[key] for one in pop.tolist()])


def are_legal(interfering_cells, violation=None) -> np.ndarray:
    """Return which paths are legal: those that cross no obstacle and violate no constraint, if there is one.

    Parameters
    ----------
    interfering_cells : array_like, shape (N,)
        Numbers of occupied cells that they cross.
    violation : array_like, shape (N,), optional
        What constraints say of them, such as how far they are over the potential limit; zero or less where they are kept.
    """
    legal = np.asarray(interfering_cells) == 0
    return legal if violation is None else legal & (np.asarray(violation) <= 0)


class Snapshot(NamedTuple):
    """How far a search has come, as all that records it does so.

    Attributes
    ----------
    n_eval : int
        Evaluations so far.
    n_legal, n_members : int
        Members of the population that are legal paths, and all.
    length : float
        Of the shortest of the legal ones, ``inf`` without any; NaN if the problem has no such objective.
    front : numpy.ndarray, shape (K, n_obj)
        Their non-dominated objectives, each point once.
    """

    n_eval: int
    n_legal: int
    n_members: int
    length: float
    front: np.ndarray


def snapshot(algorithm, members: Members) -> Snapshot:
    """Return how far an algorithm has come with these members."""
    n_eval, front = int(algorithm.evaluator.n_eval), members.F[members.front()]
    return Snapshot(n_eval, members.n_legal, members.n_members, members.least("length"), front)
