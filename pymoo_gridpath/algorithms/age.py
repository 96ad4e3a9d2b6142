"""The survivals of AGE-MOEA and AGE-MOEA-II, finite where an objective has no range; like them, they need numba."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
from pymoo.algorithms.moo.age import AGEMOEASurvival, find_corner_solutions, point_2_line_distance
from pymoo.algorithms.moo.age2 import AGEMOEA2Survival, project_on_manifold

# pymoo compiles these anew in every process, for five seconds; numba keeps them where it has a folder to do so.
for _compiled in (
    find_corner_solutions,
    point_2_line_distance,
    project_on_manifold,
    AGEMOEASurvival.minkowski_distances,
    AGEMOEA2Survival.pairwise_distances,
):
    with suppress(RuntimeError):
        _compiled.enable_caching()  # pyright: ignore[reportFunctionMemberAccess]

#: Decimals to which pymoo rounds a front before it shifts it to the ideal point, which it does not round.
_DECIMALS = 12


class _EmptyRanges(AGEMOEASurvival):
    """What both share: an objective that is constant over the first front lies at the ideal point and has the range 1.

    Where an objective is constant, pymoo's shift leaves what rounding took from it, of either sign, or it divides by nought
    when it scales the further fronts. Where none is, the bits are pymoo's.
    """

    def survival_score(self, front, ideal_point):
        rounded = np.round(front, _DECIMALS)
        least = rounded.min(axis=0)
        constant = rounded.max(axis=0) == least
        crowding, p, normalization = super().survival_score(front, np.where(constant, least, ideal_point))
        return crowding, p, np.where(normalization == 0, 1.0, normalization)


class FiniteAGEMOEASurvival(_EmptyRanges):
    """AGE-MOEA's survival, pymoo's but for constant objectives.

    References
    ----------
    A. Panichella, "An adaptive evolutionary algorithm based on non-Euclidean geometry for many-objective optimization",
    Genetic and Evolutionary Computation Conference (GECCO), 2019.
    """


class FiniteAGEMOEA2Survival(_EmptyRanges, AGEMOEA2Survival):
    """AGE-MOEA-II's survival, pymoo's but for constant objectives and fronts of one point, where that divides by nought.

    References
    ----------
    A. Panichella, "An improved Pareto front modeling algorithm for large-scale many-objective optimization", Genetic and
    Evolutionary Computation Conference (GECCO), 2022.
    """

    @staticmethod
    def pairwise_distances(front, p):
        if not front.any():
            # All lie at the ideal point, which pymoo cannot project onto the front's shape.
            return np.zeros((len(front), len(front)))
        return AGEMOEA2Survival.pairwise_distances(front, p)
