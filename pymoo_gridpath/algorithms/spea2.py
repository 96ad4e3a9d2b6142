"""SPEA2's survivals and tournaments, with and without a tie-break by smoothness."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
from pymoo.algorithms.moo.nsga3 import HyperplaneNormalization
from pymoo.algorithms.moo.spea2 import SPEA2Survival
from pymoo.operators.selection.tournament import TournamentSelection
from pymoo.util.misc import vectorized_cdist
from scipy.spatial.distance import cdist

from pymoo_gridpath.operators.selection import compare, decide, draw_as_pymoo, winners
from pymoo_gridpath.operators.survival import ArraySurvival, turns_of
from pymoo_gridpath.registry import OPERATORS

#: Distances in scaled objectives that differ by no more than this are equal.
SAME_DISTANCE = 1e-9


@OPERATORS.register
class StrengthAndSmoothness(ArraySurvival):
    """SPEA2's environmental selection, in which the smoother of two crowding paths survives.

    The raw fitness R of an individual is the sum of the strengths of those that dominate it, a strength being how many an
    individual dominates.

    - If the non-dominated individuals fit, the population is filled up by R, of equal R by total turn, and of equal turns
      by density.
    - If they do not fit, they are removed one by one. As in SPEA2, one with the smallest distance to its nearest neighbour
      goes. At least two always tie in that, for the two of a closest pair are each other's nearest. SPEA2 then looks at the
      distances to the second nearest and so on; here the one with the largest total turn goes, and the further distances
      decide among equal turns. Hence of paths with equal objectives (distance 0) the smoothest stays.
    - For each objective one individual with the best value is never removed (of equal ones that with the smallest sum of the
      others, then the smoothest), lest smoothness cost the ends of the front.

    Distances are Euclidean in objectives scaled to the range of the non-dominated individuals. Sets ``SPEA_F``, the sum of
    ``SPEA_R`` (raw fitness) and ``SPEA_D`` (density, below 1), smaller is better. Infeasible individuals come after all
    feasible ones, in order of their constraint violation.

    Needs `StrengthTournament` as ``selection`` beside it, for pymoo's own compares the fitness, in which turn has no part. And
    a problem that sets ``turn``, such as `GridPathProblem`; without it, it warns, and distances decide alone. The type of the
    genes does not matter.

    References
    ----------
    E. Zitzler, M. Laumanns and L. Thiele, "SPEA2: improving the strength Pareto evolutionary algorithm", TIK report 103, ETH
    Zurich, 2001, sections 3.1 and 3.2. The tie-break follows Ahmed and Deb (2013), section 5.1.
    """

    def __init__(self):
        super().__init__(filter_infeasible=True)

    def _do(self, problem, pop, *args, n_survive=None, random_state=None, **kwargs):
        F, turn = pop.get("F").astype(float), turns_of(pop, type(self).__name__)
        raw, front = _strength(F)
        scaled = _scale(F, F[front])
        density = 1.0 / (_kth_distance(scaled) + 2.0)
        pop.set("SPEA_F", raw + density, "SPEA_R", raw, "SPEA_D", density)
        n_survive = len(pop) if n_survive is None else n_survive
        if len(front) <= n_survive:
            return pop[np.lexsort((density, turn, raw))[:n_survive]]
        kept = _ends(scaled[front], turn[front])[:n_survive]
        return pop[front[truncate(_distances(scaled[front]), n_survive, turn[front], kept, SAME_DISTANCE)]]


class ArraySPEA2Survival(ArraySurvival, SPEA2Survival):
    """The original SPEA2's environmental selection, pymoo's with the same survivors in the same order, and a fast truncation.

    It departs from pymoo's only where an objective is constant: there pymoo divides by an empty range, the fitness of all is no
    number, and the run keeps whom it should lose; here that objective has the range 1.

    Parameters
    ----------
    normalize : bool, default True
        Whether distances are those in objectives scaled as NSGA-III scales them.

    References
    ----------
    E. Zitzler, M. Laumanns and L. Thiele, "SPEA2: improving the strength Pareto evolutionary algorithm", TIK report 103, ETH
    Zurich, 2001, sections 3.1 and 3.2.
    """

    norm: Any

    def __init__(self, normalize: bool = True):
        super().__init__(normalize=normalize)

    def _do(self, problem, pop, *args, n_survive=None, **kwargs):
        F = pop.get("F").astype(float)
        n_survive = len(pop) if n_survive is None else n_survive
        raw, front = _strength(F)
        scaled = self._scaled(F)
        distances = vectorized_cdist(scaled, scaled, fill_diag_with_inf=True)
        k = min(int(np.sqrt(len(pop))), len(pop) - 1)
        density = 1.0 / (np.partition(distances, k, axis=1)[:, k] + 2.0)
        fitness = raw + density
        pop.set("SPEA_F", fitness, "SPEA_R", raw, "SPEA_D", density)
        if self.normalize:
            # The extreme points of the front win every tournament.
            ends = vectorized_cdist(self.norm.extreme_points, F[front]).argmin(axis=1)
            pop[front[ends]].set("SPEA_F", -1.0)
        if len(front) > n_survive:
            return pop[front[truncate(distances[np.ix_(front, front)], n_survive)]]
        rest = np.setdiff1d(np.arange(len(pop)), front)
        return pop[np.concatenate([front, rest[fitness[rest].argsort()][: n_survive - len(front)]])]

    def _scaled(self, F: np.ndarray) -> np.ndarray:
        if not self.normalize:
            return F
        if self.norm is None:
            self.norm = HyperplaneNormalization(F.shape[1])
        # pymoo turns all warnings of the process off in here.
        with warnings.catch_warnings():
            self.norm.update(F)
        span = self.norm.nadir_point - self.norm.ideal_point
        # Over an empty range pymoo's distances are no numbers, and the order of the individuals decides who survives.
        return (F - self.norm.ideal_point) / np.where(span == 0, 1.0, span)


@OPERATORS.register
class StrengthTournament(TournamentSelection):
    """SPEA2's binary tournament with smoothness before density.

    Of two individuals the one with the smaller constraint violation wins; if both are feasible the one with the smaller raw
    fitness, of equal ones that with the smaller total turn, then that in the less dense region; and else either.

    Needs `StrengthAndSmoothness` as survival beside it, and a problem that sets ``turn``, without which that survival warns and
    turns count as equal. The type of the genes does not matter.
    """

    def __init__(self):
        super().__init__(func_comp=by_strength_turn_density)


class FitnessTournament(TournamentSelection):
    """The original SPEA2's binary tournament, pymoo's with the same draws: violation, then fitness; the smaller wins."""

    def __init__(self):
        super().__init__(func_comp=by_fitness)


def by_strength_turn_density(pop, P: np.ndarray, random_state=None, **kwargs) -> np.ndarray:
    """Return the winners of tournaments; see `StrengthTournament`, and `by_rank_turn_crowding` for the arguments."""
    assert random_state is not None
    CV, raw, turn, density = pop.get("CV", "SPEA_R", "turn", "SPEA_D")
    verdict = decide(P, CV[:, 0], compare(P, raw), compare(P, turn), compare(P, density))
    return winners(P, verdict, random_state.random(len(P)) < 0.5)


def by_fitness(pop, P: np.ndarray, random_state=None, **kwargs) -> np.ndarray:
    """Return the winners of tournaments; see `FitnessTournament`, and `by_rank_turn_crowding` for the arguments."""
    CV, fitness = pop.get("CV", "SPEA_F")
    verdict = decide(P, CV[:, 0], compare(P, fitness))
    return winners(P, verdict, draw_as_pymoo(verdict, random_state))


def truncate(
    distances: np.ndarray, n_survive: int, turn: np.ndarray | None = None, kept: Sequence[int] = (), tolerance: float = 0.0
) -> np.ndarray:
    """Return which of mutually non-dominated individuals survive SPEA2's truncation.

    As long as there are too many, one goes whose nearest neighbour is the nearest; of several the one with the largest turn, of
    equal turns the one whose sorted distances to the others are lexicographically the smallest, and else the first.

    Parameters
    ----------
    distances : numpy.ndarray, shape (N, N)
        Between all, infinite on the diagonal.
    n_survive : int
        How many, at least as many as are kept.
    turn : numpy.ndarray, shape (N,), optional
        Total turns; without them distances alone decide, as in SPEA2.
    kept : sequence of int
        Who may not go.
    tolerance : float, default 0
        Nearest distances that differ by no more are equal.

    Returns
    -------
    numpy.ndarray of int, shape (n_survive,)
        Ascending indices.
    """
    # Each row lists everybody by distance; `place` points at the nearest that is still alive and moves on only when it dies,
    # so that a removal costs O(N) rather than a sort of all distances.
    n = len(distances)
    order = np.argsort(distances, axis=1, kind="stable")
    ranked = np.take_along_axis(distances, order, axis=1)
    place, nearest = np.zeros(n, dtype=np.int64), ranked[:, 0].copy()
    alive, removable = np.ones(n, dtype=bool), np.ones(n, dtype=bool)
    removable[list(kept)] = False
    for _ in range(n - n_survive):
        candidates = np.flatnonzero(alive & removable)
        candidates = candidates[nearest[candidates] <= nearest[candidates].min() + tolerance]
        if turn is not None:
            candidates = candidates[turn[candidates] == turn[candidates].max()]
        loser = candidates[0]
        if len(candidates) > 1:
            near = ranked[candidates][alive[order[candidates]]].reshape(len(candidates), -1)
            loser = candidates[_lexicographic_minimum(near)]
        alive[loser] = False
        for i in np.flatnonzero(alive & (order[np.arange(n), place] == loser)):
            place[i] += np.argmax(alive[order[i, place[i] :]])
            nearest[i] = ranked[i, place[i]]
    return np.flatnonzero(alive)


def _lexicographic_minimum(rows: np.ndarray) -> int:
    """Return the index of the first of the lexicographically smallest rows of numbers that are not negative."""
    # The order of such numbers is that of their bytes with the largest place first.
    keys = rows.astype(">f8")
    return min(range(len(keys)), key=lambda k: keys[k].tobytes())


def _strength(F: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the raw fitness R of each individual, shape (N,), and the indices of the non-dominated ones."""
    better = np.zeros((len(F), len(F)), dtype=bool)
    for f in F.T:
        better |= f[:, None] < f
    dominates = better & ~better.T
    return dominates.T @ dominates.sum(axis=1), np.flatnonzero(~dominates.any(axis=0))


def _distances(F: np.ndarray) -> np.ndarray:
    distances = cdist(F, F)
    np.fill_diagonal(distances, np.inf)
    return distances


def _kth_distance(F: np.ndarray) -> np.ndarray:
    """Return each one's distance to its k-th nearest neighbour, k the square root of N."""
    k = max(int(np.sqrt(len(F))), 1)
    return np.partition(_distances(F), k - 1, axis=1)[:, k - 1]


def _scale(F: np.ndarray, front: np.ndarray) -> np.ndarray:
    ideal, nadir = front.min(axis=0), front.max(axis=0)
    return (F - ideal) / np.where(nadir > ideal, nadir - ideal, 1.0)


def _ends(F: np.ndarray, turn: np.ndarray) -> list[int]:
    """Return one individual with the best value of each objective."""
    total = F.sum(axis=1)
    return list(dict.fromkeys(int(np.lexsort((turn, total, f))[0]) for f in F.T))
