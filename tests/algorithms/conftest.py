"""A small problem, and what algorithms need besides it."""

from __future__ import annotations

import types

import numpy as np
import pytest
from pymoo.algorithms.moo.pinsga2 import AutomatedDM

from pymoo_gridpath import GridPathProblem
from pymoo_gridpath.problems.scenarios import random_dense_grid

OBJECTIVES = ("length", "vulnerability", "turn")


class PrefersShort(AutomatedDM):
    """A decision maker who takes the smaller first objective."""

    def makeDecision(self, F):
        return "a" if F[0][0] < F[1][0] else "b"


@pytest.fixture(scope="session")
def make_problem():
    """Return a maker of problems on an 8 x 8 grid; its front for two objectives has 12 members."""
    grids = {p0: random_dense_grid(8, p0, seed) for p0, seed in ((0.0, 0), (0.1, 11), (0.3, 3))}

    def make(n_obj=2, obstacles="penalty", representation="integer", p0=0.1):
        return GridPathProblem(grids[p0], (0, 0), (7, 7), representation, OBJECTIVES[:n_obj], obstacles)

    return make


@pytest.fixture(scope="session")
def arguments():
    """Return what the caller of make_algorithm has to give, by `Capability.needs`."""

    def make(row, n_obj):
        if row.needs == "ref_points":
            return {"ref_points": np.array([[10.0, 2.0, 200.0], [14.0, 0.2, 400.0]])[:, :n_obj]}
        if row.needs == "automated_dm":
            return {"automated_dm": PrefersShort(), "tau": 4}
        return {}

    return make


@pytest.fixture(scope="session")
def fingerprint():
    """Return a function from an object to plain data that changes when anything reachable from it does."""
    return _fingerprint


def _fingerprint(thing, seen=None):
    seen = {} if seen is None else seen
    if thing is None or isinstance(thing, bool | int | float | str | bytes):
        return thing
    if isinstance(thing, types.FunctionType | types.BuiltinFunctionType | types.MethodType | type):
        return thing.__qualname__
    if id(thing) in seen:
        return ("seen", seen[id(thing)])
    seen[id(thing)] = len(seen)
    if isinstance(thing, np.ndarray) and thing.dtype != object:
        return (thing.shape, thing.dtype.str, thing.tobytes())
    if isinstance(thing, dict):
        return [(_fingerprint(key, seen), _fingerprint(value, seen)) for key, value in thing.items()]
    if isinstance(thing, list | tuple | np.ndarray):
        return [_fingerprint(item, seen) for item in thing]
    return (type(thing).__qualname__, _fingerprint(getattr(thing, "__dict__", None), seen))
