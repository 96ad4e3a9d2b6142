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
