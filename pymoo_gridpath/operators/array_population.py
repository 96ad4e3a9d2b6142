"""Populations that are read and written as arrays; pymoo's look every value up in three places, one individual at a time."""

from __future__ import annotations

from operator import attrgetter

import numpy as np
from pymoo.core.individual import Individual, default_config
from pymoo.core.population import Population, interleaving_args

_EMPTY = np.array([])
_EMPTY.flags.writeable = False


class LightIndividual(Individual):
    """A pymoo individual that shares what a constructor would set to the same for all: empty values until they are set."""

    _F = _G = _H = _dF = _dG = _dH = _ddF = _ddG = _ddH = _EMPTY
    _CV = None


class ArrayPopulation(Population):
    """A pymoo population whose `get` and `set` mean the same and cost about a fifth.

    Individuals remain the only place where values are kept, so it can be mixed with pymoo's own populations at will:
    ``pop.view(ArrayPopulation)`` is the same population. All its individuals are to be of one class.
    """

    @classmethod
    def of(cls, X: np.ndarray) -> ArrayPopulation:
        """Return a population of new individuals with the genes X, shape (N, n_var)."""
        config = default_config()
        individuals = np.empty(len(X), dtype=object)
        for k, genes in enumerate(X):
            individuals[k] = individual = LightIndividual.__new__(LightIndividual)
            individual._X, individual.evaluated, individual.data, individual.config = genes.copy(), set(), {}, config
        return individuals.view(cls)

    def get(self, *args, to_numpy: bool = True, **kwargs):
        """Return the values of one or more keys, as `pymoo.core.population.Population.get`."""
        if self.ndim != 1:
            return super().get(*args, to_numpy=to_numpy, **kwargs)
        individuals = self.tolist()
        values = [_read(individuals, key) for key in args]
        if to_numpy:
            values = [np.array(value) for value in values]
        return values[0] if len(values) == 1 else tuple(values)

    def set(self, *args, **kwargs):
        """Set values by key, from arrays of one row an individual, as `pymoo.core.population.Population.set`."""
        if self.ndim != 1:
            return super().set(*args, **kwargs)
        individuals = self.tolist()
        if not individuals:
            return None
        for key, values in interleaving_args(*args, kwargs=kwargs).items():
            values = _one_each(values, len(individuals))
            if hasattr(type(individuals[0]), key):
                for individual, value in zip(individuals, values, strict=True):
                    setattr(individual, key, value)
            else:
                for individual, value in zip(individuals, values, strict=True):
                    own = individual.__dict__
                    (own if key in own else individual.data)[key] = value
        return self


def _read(individuals: list, key: str) -> list:
    if key == "FEAS":
        # Asked for every generation, and slow one by one.
        limits = [individual.config.get("cv_eps", 0.0) for individual in individuals]
        return list(np.array(_read(individuals, "CV")).reshape(-1, 1) <= np.array(limits)[:, None])
    if individuals and hasattr(type(individuals[0]), key):
        return list(map(attrgetter(key), individuals))
    # What others have set on an individual itself goes before what survival and evaluation keep in its data.
    return [own[key] if key in (own := individual.__dict__) else individual.data.get(key) for individual in individuals]


def _one_each(values, n: int) -> list:
    """Return one value for each of n individuals; none is a view, which would keep the array of a whole generation alive."""
    if isinstance(values, str) or not hasattr(values, "__len__"):
        return [values] * n
    if len(values) != n:
        raise ValueError(f"got {len(values)} values for a population of {n}")
    if isinstance(values, np.ndarray):
        if values.ndim == 1:
            return list(values)
        if values.size == 0:
            return [values[0].copy()] * n  # such as G of a problem without constraints
        return [row.copy() for row in values]
    return [value.copy() if isinstance(value, np.ndarray) and value.base is not None else value for value in values]
