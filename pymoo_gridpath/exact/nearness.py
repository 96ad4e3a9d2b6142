"""How near to a front what is known of it has to come, and what is proven of that."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.errors import GridPathError

# Parts of 1 in which a factor is counted: whole numbers, since floats err in costs beyond 2**53.
_PARTS = 2**30

# Proofs in floats leave room for more than their rounding.
_ROUNDING = 1e-12


@dataclass(frozen=True)
class Certificate:
    """How near a set of paths is proven to come to the whole front.

    For every point q of the front there is a path with objectives p such that p <= (1 + ``epsilon``) q in each of them, and one
    such that p <= q + ``share`` * (its range over the front) in each. Both are 0 for the whole front.

    Attributes
    ----------
    epsilon : float
        Infinite where an objective may be 0 on the front and is not among the paths.
    share : float

    Notes
    -----
    Additive and multiplicative approximations of fronts, and that there are small ones: C. H. Papadimitriou and M. Yannakakis,
    "On the approximability of trade-offs and optimal access of web sources", FOCS 2000.

    Examples
    --------
    >>> print(Certificate(0.0123, 0.2))
    within 1.23 % of the front
    """

    epsilon: float
    share: float

    def __str__(self):
        return self.said(self._telling)

    @property
    def short(self) -> str:
        """The same in few words: "1.23 %", or "3.4 % of range"."""
        return _percent(getattr(self, self._telling)) + (" of range" if self._telling == "share" else "")

    @property
    def _telling(self) -> str:
        # A factor of two and more says little.
        return "epsilon" if self.epsilon <= 1.0 or self.epsilon <= self.share else "share"

    def said(self, name: str) -> str:
        """Return one of the two in words."""
        of = {"epsilon": "the front", "share": "the front's range"}
        name = checks.one_of("name", name, tuple(of))
        return f"within {_percent(getattr(self, name))} of {of[name]}"


#: Of the whole front.
WHOLE = Certificate(0.0, 0.0)


def together(certificates: Sequence[Certificate | None]) -> Certificate | None:
    """Return what is certified of all of several, None if nothing is of one of them."""
    if None in certificates:
        return None
    worst = (max((getattr(one, name) for one in certificates), default=0.0) for name in ("epsilon", "share"))
    return Certificate(*worst)


def _percent(share: float) -> str:
    """Return a share in per cent, three digits of it, rounded up."""
    if share == 0.0:
        return "0 %"
    unit = 10.0 ** (math.floor(math.log10(share)) - 2)
    return f"{math.ceil(share / unit * (1 - 1e-9)) * unit * 100:.3g} %"


@dataclass(frozen=True)
class Allowance:
    """By how much a set of paths may miss a front.

    Attributes
    ----------
    epsilon, share : float, optional
        What a `Certificate` is to say at most, above 0 up to 1; one of them, or none for the whole front.

    Raises
    ------
    GridPathError
        If one is out of its range, or both are given.
    """

    epsilon: float | None = None
    share: float | None = None

    def __post_init__(self):
        for name in ("epsilon", "share"):
            value = getattr(self, name)
            if value is not None:
                expected = "a number above 0, at most 1: 0.02 for 2 %"
                # As a plain number, whatever it was given as.
                object.__setattr__(self, name, checks.number(name, value, 0.0, 1.0, above=True, expected=expected))
        if self.epsilon is not None and self.share is not None:
            raise GridPathError("epsilon and share are given, expected one of them")

    @property
    def name(self) -> str:
        """Which of the two is given; empty for the whole front."""
        return "epsilon" if self.epsilon is not None else "share" if self.share is not None else ""

    def allows(self, certificate: Certificate | None) -> bool:
        """Whether a certificate says enough; of the whole front none does before it is found."""
        return bool(self.name) and certificate is not None and getattr(certificate, self.name) <= getattr(self, self.name)

    def counted(self, begin: np.ndarray, extent: np.ndarray) -> np.ndarray:
        """Return what `lowered` takes besides the cost for each of two costs, int64, shape (2, 3).

        Parameters
        ----------
        begin : numpy.ndarray of int64, shape (2,)
            What every path costs besides.
        extent : numpy.ndarray of int64, shape (2,)
            The ranges over the front.
        """
        parts = 0 if self.epsilon is None else math.floor(Fraction(self.epsilon) * _PARTS)
        share = Fraction(0 if self.share is None else self.share)
        return np.array([(int(b), parts, math.floor(share * int(e))) for b, e in zip(begin, extent, strict=True)])


@kernel
def lowered(cost, begin, parts, less):
    """Return the least cost by which a path of a given cost may be missed: what costs that or more is near enough."""
    whole = _PARTS + parts
    quotient = (cost + begin) // whole
    return cost - less - (quotient * parts + (cost + begin - quotient * whole) * parts // whole)


class Lines(NamedTuple):
    """Lower bounds of weighted sums of two costs over all paths, which a front lies above.

    Attributes
    ----------
    weights : numpy.ndarray of float, shape (n, 2)
    least : numpy.ndarray of float, shape (n,)
    """

    weights: np.ndarray
    least: np.ndarray


def certificate(known: np.ndarray, lines: Lines, begin: np.ndarray, searched: int | None = None) -> Certificate:
    """Return how near known points are proven to come to a front.

    What they do not come near lies below a corner of their staircase by some factor, or share of the range, in both costs, and
    on or above all lines. The line that is the first to be crossed on the way down says how far below it can be.

    Parameters
    ----------
    known : numpy.ndarray of int64, shape (n, 2)
        Costs of paths, non-dominated, in ascending order of the first; the first and the last are the ends of the front.
    lines : Lines
    begin : numpy.ndarray of int64, shape (2,)
        What every path costs besides.
    searched : int, optional
        Only what lies off by this first cost or more counts: what is before is known to be near enough.
    """
    extent = (known[-1, 0] - known[0, 0], known[0, 1] - known[-1, 1])
    if not min(extent):
        return WHOLE
    first = known[0, 0] if searched is None else max(known[0, 0], searched)
    weights = np.concatenate([lines.weights, np.eye(2)])
    least = np.concatenate([lines.least, [float(first), float(known[-1, 1])]])
    corners = np.stack([known[1:, 0], known[:-1, 1]], axis=1).astype(float)
    above = (corners @ weights.T) * (1 + _ROUNDING) - least * (1 - _ROUNDING)
    above = np.maximum(above, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        factor = above / ((least + weights @ begin.astype(float)) * (1 - _ROUNDING))
        share = above / (weights @ np.array(extent, dtype=float) * (1 - _ROUNDING))
    worst = [np.where(above > 0.0, value, 0.0).min(axis=1).max() for value in (factor, share)]
    # An end of the front is never farther off than the range.
    return Certificate(float(worst[0]), min(float(worst[1]), 1.0))
