"""Parameters of operators, which pymoo may hold as variables in order to tune them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from pymoo.core.variable import Variable

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError

#: What the paper gives for its crossovers and mutations, the rate of a mating to cross and distribution indices, section 5.2.
CROSSOVER_RATE, ETA_CROSSOVER, ETA_MUTATION = 0.9, 10.0, 20.0


def number(parameter: Any) -> float:
    """Return the number that a parameter stands for."""
    value: Any = parameter.get() if isinstance(parameter, Variable) else parameter
    return float(value)


def in_range(name: str, value: Any, low: float, high: float, optional: bool = False) -> Any:
    """Return a parameter whose number lies from ``low`` to ``high``; None passes if it is optional.

    Raises
    ------
    GridPathError
        If it does not.
    """
    if value is None and optional:
        return None
    given = value.get() if isinstance(value, Variable) else value
    checks.number(name, given, low, high, expected=f"a number from {low:g} to {high:g}", infinite=high == math.inf)
    return value


def whole(name: str, value: Any, low: int, high: int) -> int:
    """Return a parameter that is a whole number from ``low`` to ``high``.

    Raises
    ------
    GridPathError
        If it is not.
    """
    given: Any = value.get() if isinstance(value, Variable) else value
    expected = f"a whole number from {low:,} to {high:,}"
    if checks.number(name, given, low, high, expected=expected) % 1:
        raise GridPathError(f"{name} is {checks.shown(given)}, expected {expected}")
    return int(given)


def shares_of(ways: Any, known: Mapping[str, float]) -> np.ndarray:
    """Return the shares of the known ways of a mutation, which add up to 1; by default those that are known.

    Raises
    ------
    GridPathError
        If they are no mapping, a way is unknown, or no share is positive.
    """
    if not (ways is None or isinstance(ways, Mapping)):
        raise GridPathError(f"ways is {checks.shown(ways)}, expected a mapping from ways to shares, such as {{'random': 1}}")
    ways = dict(known if ways is None else ways)
    unknown = set(ways) - set(known)
    if unknown:
        raise GridPathError(
            f"there is no way {sorted(map(checks.shown, unknown))[0]} to mutate a path, expected {', '.join(known)}"
        )
    shares = np.array([float(in_range(way, ways.get(way, 0.0), 0, np.inf)) for way in known])
    if not np.isfinite(shares).all() or shares.sum() <= 0:
        raise GridPathError(f"ways is {checks.shown(ways)}, expected shares of which one or more are positive")
    return shares / shares.sum()


def one_or_two(n_offsprings: int) -> int:
    """Return the number of children of a mating if it is 1 or 2.

    Raises
    ------
    GridPathError
        If it is not.
    """
    return checks.whole("n_offsprings", n_offsprings, 1, 2, expected="1 or 2")


def check_whole_rows(operator: str, X: np.ndarray, problem, instead: str) -> None:
    """Refuse rows that are not of whole numbers or bits, and problems that do not bound them.

    Parameters
    ----------
    operator : str
        Who refuses.
    X : numpy.ndarray
        Rows of genes, of any shape.
    problem : pymoo.core.problem.Problem
    instead : str
        What real variables want in its place.

    Raises
    ------
    GridPathError
        Their type decides: real numbers are refused even where they happen to be whole.
    """
    if X.dtype.kind not in "iub":
        raise GridPathError(
            f"{operator} is for whole numbers and the rows are of the type {X.dtype}; expected a sampling that draws whole "
            f"numbers, such as RandomSampling, or for real variables {instead}"
        )
    if problem.xl is None or problem.xu is None:
        raise GridPathError(f"{operator} draws within bounds and the problem has none, expected xl and xu")


def pairs(X: np.ndarray, kinds: str = "biu") -> np.ndarray:
    """Return rows of parents if they are such, shape (2, n_matings, n_var)."""
    what = "whole numbers" if "f" not in kinds else "numbers"
    return checks.array("X", X, (2, None, None), kinds, expected=f"{what} of shape (2, n_matings, n_var)")


def rows(X: np.ndarray) -> np.ndarray:
    """Return rows of whole numbers or bits if they are such, shape (N, n_var)."""
    return checks.array("X", X, (None, None), "biu", expected="whole numbers of shape (N, n_var)")


def bounds_of(n_var: int, xl: np.ndarray, xu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the bounds of so many genes if they are such."""
    expected = f"{n_var} bounds, finite numbers"
    xl, xu = (checks.array(k, v, (n_var,), expected=expected, finite=True) for k, v in (("xl", xl), ("xu", xu)))
    return xl, xu


def generator(random_state: np.random.Generator) -> np.random.Generator:
    """Return a generator of random numbers if it is one."""
    return checks.instance("random_state", random_state, np.random.Generator, " such as numpy.random.default_rng(1)")


def rate_of(rate: float) -> float:
    """Return a probability if it is one."""
    return checks.number("rate", rate, 0.0, 1.0, expected="a probability from 0 to 1")
