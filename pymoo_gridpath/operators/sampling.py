"""Sampling: the first population."""

from __future__ import annotations

import numpy as np
from pymoo.core.sampling import Sampling


class RandomSampling(Sampling):
    """Draw every gene uniformly from its bounds, as whole numbers or bits.

    The paper initialises its population randomly (section 5); `EdgeFixing` then brings paths that leave the grid back to it.
    """

    def _do(self, problem, n_samples, *args, random_state=None, **kwargs):
        assert random_state is not None
        low, high = problem.xl.astype(np.int64), problem.xu.astype(np.int64)
        X = random_state.integers(low, high, size=(n_samples, problem.n_var), endpoint=True)
        return X.astype(problem.vtype)
