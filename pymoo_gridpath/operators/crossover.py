"""Crossover operators on whole numbers and bits."""

from __future__ import annotations

import numpy as np
from pymoo.core.crossover import Crossover
from pymoo.core.variable import Real

from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.operators.parameters import (
    CROSSOVER_RATE,
    ETA_CROSSOVER,
    bounds_of,
    check_whole_rows,
    generator,
    in_range,
    number,
    one_or_two,
    pairs,
    whole,
)
from pymoo_gridpath.registry import OPERATORS
from pymoo_gridpath.representations.base import representation_of
from pymoo_gridpath.representations.mixed import MixedRepresentation


@OPERATORS.register
class DiscreteSBX(Crossover):
    """Simulated binary crossover on whole numbers.

    Each gene in which the parents differ takes part with probability ``prob_var``. Its two children are drawn from the
    distribution of bounded simulated binary crossover, whose probability over each unit cell falls to the whole number
    in it, and they change places with probability one half, as in pymoo.

    Needs whole-number genes: a sampling that draws them, such as `RandomSampling`, and bounds ``xl`` and ``xu``; pymoo's
    ``SBX`` is for real variables. Children keep to the bounds, but a gene of the paper's codings is a step from the cell
    before, so that a child may leave the grid: on a path problem give the algorithm `EdgeFixing` as ``repair``, as
    `paper_operators` does.

    Parameters
    ----------
    eta : float, default 10
        Distribution index; the paper uses 10, and 2 for single-objective runs.
    prob_var : float, default 0.5
        Probability of a gene to take part.
    prob : float, default 0.9
        Probability of a mating to cross at all.
    n_offsprings : {1, 2}, default 2
        Children kept of each mating; algorithms that use one, such as C-TAEA, need 1.

    Raises
    ------
    GridPathError
        If a parameter is out of its range, or, when it crosses, rows are not whole numbers or the problem has no bounds.

    References
    ----------
    K. Deb and R. B. Agrawal, "Simulated binary crossover for continuous search space", Complex Systems 9, 1995.
    K. Deb and M. Goyal, "A robust optimization procedure for mechanical component design based on genetic adaptive
    search", Journal of Mechanical Design 120, 1998 (discrete variables).
    """

    def __init__(
        self,
        eta: float = ETA_CROSSOVER,
        prob_var: float = 0.5,
        prob: float = CROSSOVER_RATE,
        n_offsprings: int = 2,
        **kwargs,
    ):
        super().__init__(2, one_or_two(n_offsprings), prob=in_range("prob", prob, 0, 1), **kwargs)
        in_range("eta", eta, 0, 1000)
        in_range("prob_var", prob_var, 0, 1)
        self.eta = Real(eta, bounds=(3.0, 30.0), strict=(0.0, None))
        self.prob_var = Real(prob_var, bounds=(0.1, 0.9), strict=(0.0, 1.0))

    def _do(self, problem, X, *args, random_state=None, **kwargs):
        check_whole_rows("DiscreteSBX", X, problem, "pymoo's SBX")
        return _keep(self.cross(X, problem.xl, problem.xu, random_state), self.n_offsprings, random_state)

    def cross(self, X: np.ndarray, xl: np.ndarray, xu: np.ndarray, random_state) -> np.ndarray:
        """Return two children of each pair of parents.

        Parameters
        ----------
        X : numpy.ndarray of int, shape (2, n_matings, n_var)
        xl, xu : numpy.ndarray, shape (n_var,)
        random_state : numpy.random.Generator

        Returns
        -------
        numpy.ndarray of int, shape (2, n_matings, n_var)
        """
        X, random_state = pairs(X), generator(random_state)
        xl, xu = bounds_of(X.shape[2], xl, xu)
        taking_part = (random_state.random(X.shape[1:]) < number(self.prob_var)) & (X[0] != X[1])
        mating, gene = np.nonzero(taking_part)
        a, b = X[0, mating, gene], X[1, mating, gene]
        low, high = np.minimum(a, b).astype(float), np.maximum(a, b).astype(float)
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        draw = random_state.random(len(a))
        exponent = 1.0 / (number(self.eta) + 1.0)
        first = middle - half * _spread(1.0 + (low - xl[gene]) / half, draw, exponent)
        second = middle + half * _spread(1.0 + (xu[gene] - high) / half, draw, exponent)
        first = np.clip(np.rint(first), xl[gene], xu[gene])
        second = np.clip(np.rint(second), xl[gene], xu[gene])
        swap = random_state.random(len(a)) < 0.5
        children = X.copy()
        children[0, mating, gene] = np.where(swap, second, first)
        children[1, mating, gene] = np.where(swap, first, second)
        return children


def _spread(bound: np.ndarray, draw: np.ndarray, exponent: float) -> np.ndarray:
    """Return SBX's spread factor for a uniform draw, with the distribution cut off at ``bound`` (1 or more)."""
    alpha = 2.0 - bound ** (-1.0 / exponent)
    scaled = draw * alpha
    # The second branch is evaluated everywhere but used only where scaled > 1, and 2 - scaled > 0 always.
    return np.where(scaled <= 1.0, scaled, 1.0 / (2.0 - scaled)) ** exponent


@OPERATORS.register
class PointCrossover(Crossover):
    """Exchange the genes between cut points; the cuts of each mating are distinct and uniformly random.

    Draws the same distribution as pymoo's operator of that name, without its loop over matings. Genes change places and keep
    their values, so that it suits whole numbers, bits and real variables alike. On a path problem a child may leave the grid or
    cross obstacles: give the algorithm a repair beside it, `EdgeFixing` for the paper's codings and `PathRepair` for any.

    Parameters
    ----------
    n_points : int
        Number of cuts. Where there are fewer places between genes, every one is a cut.
    prob : float, default 0.9
        Probability of a mating to cross at all.
    n_offsprings : {1, 2}, default 2
        Children kept of each mating.
    """

    def __init__(self, n_points: int, prob: float = CROSSOVER_RATE, n_offsprings: int = 2, **kwargs):
        super().__init__(2, one_or_two(n_offsprings), prob=in_range("prob", prob, 0, 1), **kwargs)
        self.n_points = whole("n_points", n_points, 1, 10**9)

    def _do(self, problem, X, *args, random_state=None, **kwargs):
        return _keep(self.cross(X, random_state), self.n_offsprings, random_state)

    def cross(self, X: np.ndarray, random_state) -> np.ndarray:
        """Return two children of each pair of parents, shape (2, n_matings, n_var)."""
        X, random_state = pairs(X, "biuf"), generator(random_state)
        _, n_matings, n_var = X.shape
        n_points = min(self.n_points, n_var - 1)
        if n_points < 1:
            return X.copy()
        places = random_state.random((n_matings, n_var - 1))
        cut = np.zeros((n_matings, n_var), dtype=np.int8)
        chosen = np.argpartition(places, n_points - 1, axis=1)[:, :n_points]
        np.put_along_axis(cut, chosen + 1, 1, axis=1)
        exchanged = np.cumsum(cut, axis=1) % 2 == 1
        return np.stack([np.where(exchanged, X[1], X[0]), np.where(exchanged, X[0], X[1])])


@OPERATORS.register
class TwoPointCrossover(PointCrossover):
    """Two-point crossover, the paper's for the binary coding (section 2.1).

    See `PointCrossover` for what it needs beside it.
    """

    def __init__(self, prob: float = CROSSOVER_RATE, **kwargs):
        super().__init__(2, prob=prob, **kwargs)


@OPERATORS.register
class SinglePointCrossover(PointCrossover):
    """Single-point crossover, the paper's for the bits of the mixed coding (section 2.2).

    See `PointCrossover` for what it needs beside it.
    """

    def __init__(self, prob: float = CROSSOVER_RATE, **kwargs):
        super().__init__(1, prob=prob, **kwargs)


@OPERATORS.register
class MixedCrossover(Crossover):
    """Single-point crossover on the bits and discrete SBX on the integers of the mixed coding.

    Needs a problem of the mixed coding, and `EdgeFixing` as repair beside it.

    Parameters
    ----------
    eta, prob_var
        See `DiscreteSBX`.
    prob : float, default 0.9
        Probability of a mating to cross at all; both parts cross together.
    n_offsprings : {1, 2}, default 2
        Children kept of each mating.

    References
    ----------
    Ahmed and Deb (2013), section 2.2.
    """

    def __init__(
        self,
        eta: float = ETA_CROSSOVER,
        prob_var: float = 0.5,
        prob: float = CROSSOVER_RATE,
        n_offsprings: int = 2,
        **kwargs,
    ):
        super().__init__(2, one_or_two(n_offsprings), prob=in_range("prob", prob, 0, 1), **kwargs)
        self.bits = SinglePointCrossover()
        self.integers = DiscreteSBX(eta, prob_var)

    def _do(self, problem, X, *args, random_state=None, **kwargs):
        n = bits_of(problem)
        check_whole_rows("MixedCrossover", X, problem, "pymoo's SBX")
        bits = self.bits.cross(X[:, :, :n], random_state)
        integers = self.integers.cross(X[:, :, n:], problem.xl[n:], problem.xu[n:], random_state)
        return _keep(np.concatenate([bits, integers], axis=2), self.n_offsprings, random_state)


def bits_of(problem) -> int:
    """Return the number of bits at the head of a row of the mixed coding."""
    representation = representation_of(problem)
    if not isinstance(representation, MixedRepresentation):
        raise GridPathError(f"the mixed operators need the mixed representation, the problem has {representation.name}")
    return representation.n_bits


def _keep(children: np.ndarray, n_offsprings: int, random_state) -> np.ndarray:
    """Return both children of each mating, or a random one of them."""
    if n_offsprings == 2:
        return children
    pick = random_state.integers(0, 2, size=children.shape[1])
    return children[pick, np.arange(children.shape[1])][None]
