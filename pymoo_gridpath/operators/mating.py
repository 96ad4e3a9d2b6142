"""Mating on arrays: the same steps as pymoo's, without reading individuals one by one."""

from __future__ import annotations

import math
from collections.abc import Hashable

import numpy as np
from pymoo.algorithms.moo.moead import NeighborhoodSelection
from pymoo.core.crossover import Crossover
from pymoo.core.duplicate import DuplicateElimination
from pymoo.core.mating import Mating
from pymoo.core.mutation import Mutation
from pymoo.core.operator import Operator
from pymoo.core.repair import Repair

from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.operators.array_population import ArrayPopulation
from pymoo_gridpath.operators.duplicates import row_keys
from pymoo_gridpath.operators.parameters import number

# Rounds of mating that one selection serves. Reading the attributes of a population costs more than its tournaments do.
ROUNDS_PER_SELECTION = 4


class ArrayMating(Mating):
    """Selection, crossover, mutation, repair and duplicate elimination on one array of genes.

    Pass it as ``mating=`` to any algorithm derived from pymoo's ``GeneticAlgorithm``. Operators are called by the hook
    that every pymoo operator has (``_do``, on arrays), and their probabilities mean what they mean in pymoo; as there,
    children of a crossover have the type of their parents. Children equal to a member of the population or to one another are
    always left out; mating goes on until there are enough. `mates_on_arrays` says of which operators that is all they do.

    Parameters
    ----------
    selection : pymoo.core.selection.Selection
    crossover : pymoo.core.crossover.Crossover
    mutation : pymoo.core.mutation.Mutation
    repair : pymoo.core.repair.Repair
    n_max_iterations : int, default 100
        Rounds after which fewer children than wanted are returned.
    """

    def __init__(self, selection, crossover, mutation, repair, n_max_iterations: int = 100):
        super().__init__(selection, crossover, mutation, repair=repair, n_max_iterations=n_max_iterations)

    def do(self, problem, pop, n_offsprings, random_state=None, n_max_iterations=None, **kwargs):
        assert random_state is not None
        X = pop.get("X")
        seen = set(row_keys(X))
        offspring: list[np.ndarray] = []
        missing = n_offsprings
        parents = np.empty((0, self.crossover.n_parents), dtype=int)
        for _ in range(n_max_iterations or self.n_max_iterations):
            n_matings = math.ceil(missing / self.crossover.n_offsprings)
            if len(parents) < n_matings:
                n_select = ROUNDS_PER_SELECTION * n_matings
                parents = self.selection.do(
                    problem,
                    pop,
                    n_select,
                    self.crossover.n_parents,
                    to_pop=False,
                    random_state=random_state,
                    **kwargs,
                )
            children = self._cross(problem, X[parents[:n_matings].T], random_state, kwargs)
            parents = parents[n_matings:]
            children = self._mutated_and_repaired(problem, children, random_state, kwargs)
            offspring.append(_unseen(children, seen)[:missing])
            missing -= len(offspring[-1])
            if missing == 0:
                break
        return ArrayPopulation.in_table(np.concatenate(offspring))

    def _cross(self, problem, X, random_state, kwargs):
        """Return the children of pairs of parents, shape (2, n_matings, n_var), as rows."""
        n = self.crossover.n_offsprings
        crossed = random_state.random(X.shape[1]) < number(self.crossover.prob)
        children = self.crossover._do(problem, X, random_state=random_state, **kwargs).astype(X.dtype, copy=False)
        alike = np.flatnonzero(~crossed)
        children[:, alike] = X[(np.arange(n) % len(X))[:, None], alike]
        return children.reshape(-1, X.shape[-1])

    def _mutated_and_repaired(self, problem, X, random_state, kwargs):
        mutated = random_state.random(len(X)) <= number(self.mutation.prob)
        # Some mutate the array that they are given.
        before = X if mutated.all() else X.copy()
        children = self.mutation._do(problem, X, random_state=random_state, **kwargs)
        if not mutated.all():
            children = np.where(mutated[:, None], children, before)
        elif makes_legal(self.mutation) and getattr(self.repair, "keeps_legal", False):
            return children
        return self.repair._do(problem, children, random_state=random_state, **kwargs)


class NeighborSelection(NeighborhoodSelection):
    """MOEA/D's choice of different parents, from neighbourhoods or from all, with the draws for all matings at once.

    Parameters
    ----------
    prob : float, default 1.0
        Probability of a mating to be among neighbours.
    """

    def _do(self, problem, pop, n_select, n_parents, neighbors=None, random_state=None, **kwargs):
        assert neighbors is not None and random_state is not None
        among_near = random_state.random(n_select) < number(self.prob)
        near, P = neighbors[among_near], np.empty((n_select, n_parents), dtype=int)
        P[among_near] = np.take_along_axis(near, _different(len(near), n_parents, near.shape[1], random_state), axis=1)
        P[~among_near] = _different(n_select - len(near), n_parents, len(pop), random_state)
        return P


def _different(n_rows: int, n: int, below: int, random_state) -> np.ndarray:
    """Return rows of n different random numbers, 0 to ``below`` - 1, shape (n_rows, n)."""
    if n_rows and n > below:
        raise GridPathError(f"{n} different parents cannot be chosen among {below}")
    return random_state.random((n_rows, below)).argsort(axis=1)[:, :n]


class FirstChildMating(ArrayMating):
    """Crossover, mutation and repair of given parents on one array of genes, with the first child of each mating.

    Unlike in `ArrayMating`, children may equal one another and members of the population: each mating gives one.
    """

    def do(self, problem, pop, n_offsprings, random_state=None, n_max_iterations=None, parents=None, **kwargs):
        """Return children of parents, a population of shape (n_offsprings, crossover.n_parents)."""
        assert parents is not None and random_state is not None
        X = np.array([individual.X for individual in parents.T.ravel()]).reshape(*parents.T.shape, -1)
        children = self._cross(problem, X, random_state, kwargs)[:n_offsprings]
        return ArrayPopulation.of(self._mutated_and_repaired(problem, children, random_state, kwargs))


# Whose ``do`` mating on arrays stands in for.
_CALLED_AS_ARRAYS = (Crossover, Mutation, Repair)

# What mating on arrays does without: where a class has its own, an operator does more than its array hook says.
_HOOKS = {DuplicateElimination: ("do", "_do"), Operator: ("do", "__call__")}


def mates_on_arrays(operator) -> bool:
    """Return whether mating on arrays gives what pymoo's mating of individuals would give with an operator.

    An operator can say so by a class attribute ``arrays``, True or False, which holds for classes derived from it until one
    overrides what mating on arrays leaves out. Without it, operators mate on arrays unless they override pymoo's ``do``, and
    so do most of pymoo's own; `DuplicateElimination` does not, since mating on arrays compares rows. One that was given a
    repair or type of genes of its own does not either: pymoo heeds them outside of the array hook ``_do``.
    """
    kind, hooks = next(((kind, hooks) for kind, hooks in _HOOKS.items() if isinstance(operator, kind)), (None, ()))
    if kind is None or getattr(operator, "repair", None) is not None or getattr(operator, "vtype", None) is not None:
        return False
    for cls in type(operator).__mro__:
        if "arrays" in vars(cls):
            return bool(vars(cls)["arrays"])
        if any(hook in vars(cls) for hook in hooks):
            return cls in _CALLED_AS_ARRAYS
    return False


def makes_legal(operator) -> bool:
    """Return whether all that an operator makes are legal paths, as its representation writes them.

    Its class says so by an attribute ``makes_legal``, which does not hold for classes derived from it that have their own way.
    """
    for cls in type(operator).__mro__:
        if "makes_legal" in vars(cls):
            return bool(vars(cls)["makes_legal"])
        if "_do" in vars(cls):
            return False
    return False


def _unseen(X: np.ndarray, seen: set[Hashable]) -> np.ndarray:
    """Return the rows of X that are not in ``seen``, each once, and add them to it."""
    new = []
    for k, key in enumerate(row_keys(X)):
        if key not in seen:
            seen.add(key)
            new.append(k)
    return X[new]
