"""Mutation operators on whole numbers and bits: a gene that is chosen to change, changes."""

from __future__ import annotations

import numpy as np
from pymoo.core.mutation import Mutation
from pymoo.core.variable import Real

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.operators.crossover import bits_of
from pymoo_gridpath.operators.parameters import (
    ETA_MUTATION,
    bounds_of,
    check_whole_rows,
    generator,
    in_range,
    number,
    rate_of,
    rows,
)
from pymoo_gridpath.registry import OPERATORS


@OPERATORS.register
class DiscretePolynomialMutation(Mutation):
    """Polynomial mutation on whole numbers.

    A chosen gene moves by a whole number of steps, never zero. The direction is up or down with equal probability
    (towards the room where it lies on a bound); the step z has the probability that the polynomial distribution (1 - z
    / range)**eta has over the unit cell around z, cut off at the bound. Rounding the continuous operator instead would
    leave most genes as they were.

    Needs whole-number genes: a sampling that draws them, such as `RandomSampling`, and bounds ``xl`` and ``xu``; pymoo's ``PM``
    is for real variables. On a path problem a mutated path may leave the grid: give the algorithm `EdgeFixing` as ``repair``.

    Parameters
    ----------
    eta : float, default 20
        Distribution index; the paper's is 20. Larger values make smaller steps.
    prob_var : float, optional
        Probability of each gene to change; 1 / n_var by default, the paper's rate.
    prob : float, default 1.0
        Probability of an individual to be mutated at all.

    Raises
    ------
    GridPathError
        If a parameter is out of its range, or, when it mutates, rows are not whole numbers or the problem has no bounds.

    References
    ----------
    K. Deb, *Multi-objective optimization using evolutionary algorithms*, Wiley, 2001. Ahmed and Deb (2013), sections
    2.2 and 5.2.
    """

    def __init__(self, eta: float = ETA_MUTATION, prob_var: float | None = None, prob: float = 1.0, **kwargs):
        super().__init__(
            prob=in_range("prob", prob, 0, 1), prob_var=in_range("prob_var", prob_var, 0, 1, optional=True), **kwargs
        )
        in_range("eta", eta, 0, 1000)
        self.eta = Real(eta, bounds=(3.0, 30.0), strict=(0.0, 1000.0))

    def _do(self, problem, X, *args, random_state=None, **kwargs):
        check_whole_rows("DiscretePolynomialMutation", X, problem, "pymoo's PM")
        return self.mutate(X, problem.xl, problem.xu, number(self.get_prob_var(problem)), random_state)

    def mutate(self, X: np.ndarray, xl: np.ndarray, xu: np.ndarray, rate: float, random_state) -> np.ndarray:
        """Return a mutated copy.

        Parameters
        ----------
        X : numpy.ndarray of int, shape (N, n_var)
        xl, xu : numpy.ndarray, shape (n_var,)
        rate : float
            Probability of each gene to change.
        random_state : numpy.random.Generator

        Returns
        -------
        numpy.ndarray of int, shape (N, n_var)
        """
        X, random_state, rate = rows(X), generator(random_state), rate_of(rate)
        xl, xu = bounds_of(X.shape[1], xl, xu)
        row, gene = np.nonzero((random_state.random(X.shape) < rate) & (xl < xu))
        value = X[row, gene]
        down, up = value - xl[gene], xu[gene] - value
        rising = np.where((down > 0) & (up > 0), random_state.random(len(row)) < 0.5, up > 0)
        room = np.where(rising, up, down)
        # Inverse of the survival function of the polynomial distribution between steps 1/2 and room + 1/2.
        span = xu[gene] - xl[gene] + 0.5
        power = number(self.eta) + 1.0
        near, far = (1.0 - 0.5 / span) ** power, (1.0 - np.minimum(room + 0.5, span) / span) ** power
        draw = far + (near - far) * random_state.random(len(row))
        step = np.clip(np.rint(span * (1.0 - draw ** (1.0 / power))), 1, room)
        mutated = X.copy()
        mutated[row, gene] = np.where(rising, value + step, value - step)
        return mutated


@OPERATORS.register
class BitwiseMutation(Mutation):
    """Flip each bit with a rate that falls linearly over the run.

    Needs genes that are bits, of the type bool or whole numbers from 0 to 1; `DiscretePolynomialMutation` is for other whole
    numbers, pymoo's ``PM`` for real variables. On a path problem a mutated path may leave the grid: give the algorithm
    `EdgeFixing` as ``repair``.

    Parameters
    ----------
    prob_var : float, optional
        Rate at the start of the run; 1 / n_var by default.
    final : float, default 0.2
        Share of that rate left at the end of the run: a fifth, in the paper.
    prob : float, default 1.0
        Probability of an individual to be mutated at all.

    Notes
    -----
    How far the run has come is what its termination says (``algorithm.termination.perc``), so the rate falls with generations,
    evaluations or time, whichever ends the run. Where mating does not pass the algorithm on, as in pymoo's own MOEA/D, the rate
    does not fall.

    References
    ----------
    Ahmed and Deb (2013), section 2.1.
    """

    def __init__(self, prob_var: float | None = None, final: float = 0.2, prob: float = 1.0, **kwargs):
        super().__init__(
            prob=in_range("prob", prob, 0, 1), prob_var=in_range("prob_var", prob_var, 0, 1, optional=True), **kwargs
        )
        self.final = in_range("final", final, 0, 1)

    def _do(self, problem, X, *args, random_state=None, algorithm=None, **kwargs):
        check_whole_rows("BitwiseMutation", X, problem, "pymoo's PM")
        if np.max(problem.xu) > 1 or np.min(problem.xl) < 0:
            raise GridPathError(
                f"BitwiseMutation flips bits and genes go from {np.min(problem.xl):g} to {np.max(problem.xu):g}, expected "
                f"bounds of 0 and 1; DiscretePolynomialMutation is for whole numbers"
            )
        return self.flip(X, number(self.get_prob_var(problem)) * self.decay(algorithm), random_state)

    def decay(self, algorithm) -> float:
        """Return the share of the initial rate that is left."""
        if not (algorithm is None or hasattr(algorithm, "termination")):
            raise GridPathError(f"algorithm is {checks.shown(algorithm)}, expected an Algorithm of pymoo")
        done = 0.0 if algorithm is None or algorithm.termination is None else algorithm.termination.perc
        return 1.0 - (1.0 - self.final) * float(np.clip(done, 0.0, 1.0))

    def flip(self, X: np.ndarray, rate: float, random_state) -> np.ndarray:
        """Return a copy of bits (bool, or integers 0 and 1) with each flipped with probability ``rate``."""
        X, random_state, rate = rows(X), generator(random_state), rate_of(rate)
        return X ^ (random_state.random(X.shape) < rate).astype(X.dtype)


@OPERATORS.register
class MixedMutation(Mutation):
    """Bitwise mutation on the bits and discrete polynomial mutation on the integers of the mixed coding.

    Needs a problem of the mixed coding, and `EdgeFixing` as repair beside it.

    Parameters
    ----------
    eta : float, default 20
        See `DiscretePolynomialMutation`.
    prob_var : float, optional
        Probability of each bit and of each integer to change; by default one over the number of either.
    final : float, default 0.2
        See `BitwiseMutation`.
    prob : float, default 1.0
        Probability of an individual to be mutated at all.

    References
    ----------
    Ahmed and Deb (2013), section 2.2.
    """

    def __init__(
        self, eta: float = ETA_MUTATION, prob_var: float | None = None, final: float = 0.2, prob: float = 1.0, **kwargs
    ):
        super().__init__(
            prob=in_range("prob", prob, 0, 1), prob_var=in_range("prob_var", prob_var, 0, 1, optional=True), **kwargs
        )
        self.bits = BitwiseMutation(final=final)
        self.integers = DiscretePolynomialMutation(eta)

    def _do(self, problem, X, *args, random_state=None, algorithm=None, **kwargs):
        n = bits_of(problem)
        check_whole_rows("MixedMutation", X, problem, "pymoo's PM")
        rate = 1.0 / n if self.prob_var is None else number(self.prob_var)
        bits = self.bits.flip(X[:, :n], rate * self.bits.decay(algorithm), random_state)
        integers = self.integers.mutate(X[:, n:], problem.xl[n:], problem.xu[n:], rate, random_state)
        return np.concatenate([bits, integers], axis=1)
