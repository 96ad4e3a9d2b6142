"""Survivals that break ties by smoothness."""

from __future__ import annotations

import numpy as np
from pymoo.core.survival import Survival
from pymoo.operators.survival.rank_and_crowding.metrics import get_crowding_function
from pymoo.util.nds.non_dominated_sorting import NonDominatedSorting


class RankAndSmoothness(Survival):
    """The modified NSGA-II's survival: whole fronts first, and of the last one the smoothest paths.

    Within the front that does not fit as a whole, individuals with a smaller total turn survive; of equal turns those
    with the larger crowding distance, which is that of the whole front. Sets ``rank`` and ``crowding``. Infeasible
    individuals come after all feasible ones, in order of their constraint violation.

    References
    ----------
    Ahmed and Deb (2013), section 5.1.
    """

    def __init__(self):
        super().__init__(filter_infeasible=True)
        self.nds = NonDominatedSorting()
        self.crowding = get_crowding_function("cd")

    def _do(self, problem, pop, *args, n_survive=None, random_state=None, **kwargs):
        F, turn = pop.get("F").astype(float, copy=False), pop.get("turn").astype(float)
        survivors: list[np.ndarray] = []
        n_missing = len(pop) if n_survive is None else n_survive
        for rank, front in enumerate(self.nds.do(F, n_stop_if_ranked=n_missing)):
            crowding = self.crowding.do(F[front], n_remove=0)
            pop[front].set("rank", np.full(len(front), rank), "crowding", crowding)
            if len(front) > n_missing:
                order = np.lexsort((-crowding, turn[front]))
                front = np.asarray(front)[order[:n_missing]]
            survivors.append(front)
            n_missing -= len(front)
            if n_missing <= 0:
                break
        return pop[np.concatenate(survivors)]
