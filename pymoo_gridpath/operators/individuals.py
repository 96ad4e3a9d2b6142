"""Reading and writing individuals directly; pymoo's ``Population.get`` and ``set`` look every key up in three places."""

from __future__ import annotations

import numpy as np


def genes(pop) -> np.ndarray:
    """Return the genes of a population, shape (N, n_var)."""
    return np.array([individual.X for individual in pop.tolist()])


def objectives(pop) -> np.ndarray:
    """Return the objectives of a population, float, shape (N, n_obj)."""
    return np.array([individual.F for individual in pop.tolist()], dtype=float)


def violations(pop) -> np.ndarray:
    """Return the constraint violations of a population, float, shape (N,)."""
    return np.array([individual.CV[0] for individual in pop.tolist()], dtype=float)


def attributes(pop, key: str) -> np.ndarray:
    """Return an attribute that survival or evaluation has set on individuals, shape (N,); None where it is not set."""
    return np.array([individual.data.get(key) for individual in pop.tolist()])


def set_attributes(pop, **values: np.ndarray) -> None:
    """Set attributes of individuals from arrays of shape (N,)."""
    for key, array in values.items():
        for individual, value in zip(pop.tolist(), array, strict=True):
            individual.data[key] = value
