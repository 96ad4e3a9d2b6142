"""When a run ends."""

from __future__ import annotations

from typing import Any

from pymoo.core.termination import Termination
from pymoo.termination.max_gen import MaximumGenerationTermination

from pymoo_gridpath.algorithms.paper import N_GEN
from pymoo_gridpath.problems.members import Members


class FirstLegalPath(Termination):
    """End a run as soon as the population holds a legal path, or after ``n_max_gen`` generations.

    Parameters
    ----------
    n_max_gen : int, default 500
        Generations after which the run ends without one; the paper's number.

    Attributes
    ----------
    found : bool
        Whether a legal path ended the run.

    References
    ----------
    Ahmed and Deb (2013), section 6.
    """

    def __init__(self, n_max_gen: int = N_GEN):
        super().__init__()
        self.budget = MaximumGenerationTermination(n_max_gen)
        self.found = False

    def _update(self, algorithm: Any) -> float:
        self.found = Members(algorithm).n_legal > 0
        return 1.0 if self.found else self.budget.update(algorithm)
