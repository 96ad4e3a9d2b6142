"""Sampling: the first population."""

from __future__ import annotations

import numpy as np
from pymoo.core.sampling import Sampling

from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.registry import OPERATORS


@OPERATORS.register
class RandomSampling(Sampling):
    """Draw every gene uniformly from its bounds, as whole numbers or bits.

    The problem's ``vtype`` is int or bool, and it has bounds; pymoo's ``FloatRandomSampling`` is for real variables.

    The paper initialises its population randomly (section 5); `EdgeFixing` then brings paths that leave the grid back to it.
    """

    # Of the codings of the paper every row is a path, legal or not.
    knows_paths = True

    def _do(self, problem, n_samples, *args, random_state=None, **kwargs):
        assert random_state is not None
        if problem.vtype is None or np.dtype(problem.vtype).kind not in "iub" or problem.xl is None or problem.xu is None:
            raise GridPathError(
                f"RandomSampling draws whole numbers within bounds and the problem has the vtype {problem.vtype}, expected int "
                f"or bool with xl and xu; pymoo's FloatRandomSampling is for real variables"
            )
        low, high = problem.xl.astype(np.int64), problem.xu.astype(np.int64)
        X = random_state.integers(low, high, size=(n_samples, problem.n_var), endpoint=True)
        return X.astype(problem.vtype)


class GivenRows(Sampling):
    """Rows of genes to begin with, as many as the population has; of a larger one the others are sampled.

    Parameters
    ----------
    X : numpy.ndarray, shape (N, n_var)
    others : pymoo.core.sampling.Sampling
    """

    knows_paths = True

    def __init__(self, X: np.ndarray, others: Sampling):
        super().__init__()
        self.X, self.others = X, others

    def _do(self, problem, n_samples, *args, random_state=None, **kwargs):
        missing = n_samples - len(self.X)
        if missing <= 0:
            return self.X[:n_samples].copy()
        others = self.others.do(problem, missing, random_state=random_state, **kwargs).get("X")
        return np.concatenate([self.X, others.astype(self.X.dtype)])
