"""Survivals on arrays, with and without a tie-break by smoothness."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from moocore import is_nondominated
from pymoo.core.survival import Survival
from pymoo.operators.survival.rank_and_crowding import RankAndCrowding
from pymoo.operators.survival.rank_and_crowding.metrics import FunctionalDiversity, calc_crowding_distance
from pymoo.util.nds.non_dominated_sorting import NonDominatedSorting
from pymoo.util.randomized_argsort import randomized_argsort

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.operators.array_population import ArrayPopulation
from pymoo_gridpath.operators.bands import band_of, boxes, range_of_front
from pymoo_gridpath.registry import OPERATORS


class ArraySurvival(Survival):
    """A survival whose populations are read and written as arrays; derive from it, first."""

    def do(self, problem, pop, *args, **kwargs):
        pop = pop.view(ArrayPopulation)
        survivors = super().do(problem, pop, *args, **kwargs)
        return survivors if isinstance(survivors, list) else survivors.view(ArrayPopulation).settled(pop)


def turns_of(pop, owner: str) -> np.ndarray:
    """Return the total turns of individuals; where the problem gave none, warn and return noughts, so that all are equal.

    Parameters
    ----------
    pop : pymoo.core.population.Population
    owner : str
        Who breaks ties by them.

    Returns
    -------
    numpy.ndarray of float, shape (N,)
    """
    turn = pop.get("turn")
    if turn.dtype == object:
        # Python's filter shows it once in a run.
        warnings.warn(
            f"{owner} breaks ties by total turn and the problem gives none, so that it breaks none; expected one that sets "
            f"'turn' in each evaluation, such as GridPathProblem",
            stacklevel=1,
        )
        return np.zeros(len(turn))
    return turn.astype(float)


@OPERATORS.register
class RankAndSmoothness(ArraySurvival):
    """The modified NSGA-II's survival: whole fronts first, and of the last one the smoothest paths.

    Within the front that does not fit as a whole, individuals with a smaller total turn survive; of equal turns those
    with the larger crowding distance, which is that of the whole front. Sets ``rank`` and ``crowding``. Infeasible
    individuals come after all feasible ones, in order of their constraint violation.

    Needs `SmoothnessTournament` as ``selection`` beside it, for pymoo's own tournament compares dominance and crowding, so that
    turn would never reach mating: ``NSGA2(selection=SmoothnessTournament(), survival=RankAndSmoothness(), ...)``. And a problem
    that sets ``turn``, such as `GridPathProblem`; without it, it warns, and crowding decides alone. The type of the genes
    does not matter.

    Parameters
    ----------
    distinct : bool, default False
        Whether turn decides only between paths of equal objectives. Operators that make legal paths only, such as
        `path_operators`, soon fill the population with non-dominated paths, and those that turn little would push out the
        others, ends of the front included. If True, of paths with equal objectives all but the smoothest come after all other
        paths of their front, with a crowding distance of 0, and among the others the crowding distance decides before turn.
    band : float, default 0
        From which difference on objectives are not the same, as a share of their range on the front of each generation, at most
        0.5. On a map with obstacles hardly two paths have the same objectives, so that the rank decides on nearly all, and turn
        on none. With a band, objectives count in steps of that width: paths in one box of steps are one point, which the
        smoothest of them stands for. It is ranked by its box; the others as if it dominated them. The result then has one path
        a box, and its objectives are up to one step worse than the best that were found. 0.01 is a good first choice; 0 is the
        paper's rule.

    Raises
    ------
    GridPathError
        If an argument is out of its range, or both distinct and a band are given: with a band, points are distinct.

    References
    ----------
    Ahmed and Deb (2013), section 5.1. The boxes are those of M. Laumanns, L. Thiele, K. Deb and E. Zitzler, "Combining
    convergence and diversity in evolutionary multiobjective optimization", Evolutionary Computation 10(3), 2002.
    """

    def __init__(self, distinct: bool = False, band: float = 0.0):
        super().__init__(filter_infeasible=True)
        self.nds = NonDominatedSorting()
        self.distinct, self.band = checks.flag("distinct", distinct), band_of(band)
        if self.distinct and self.band:
            raise GridPathError(
                f"distinct is True and band is {band}, expected one of the two: with a band, points are distinct"
            )

    def _do(self, problem, pop, *args, n_survive=None, random_state=None, **kwargs):
        F, turn = pop.get("F").astype(float), turns_of(pop, type(self).__name__)
        n_survive = len(pop) if n_survive is None else n_survive
        rank = self._rank(F, turn, n_survive)
        # Whole fronts come first, so only in the last one that is needed do the further keys decide who survives.
        if self.distinct:
            repeat = repeats(F, turn)
            crowding = np.zeros(len(pop))
            crowding[~repeat] = crowding_distances(F[~repeat], rank[~repeat])
            survivors = np.lexsort((turn, -crowding, repeat, rank))[:n_survive]
        else:
            crowding = crowding_distances(F, rank)
            survivors = np.lexsort((-crowding, turn, rank))[:n_survive]
        pop = pop[survivors]
        pop.set(rank=rank[survivors], crowding=crowding[survivors])
        return pop

    def _rank(self, F: np.ndarray, turn: np.ndarray, n_survive: int) -> np.ndarray:
        """Return the rank of each individual, front after front until enough are ranked; those that are not have rank N."""
        rank = np.full(len(F), len(F))
        if not self.band:
            for k, front in enumerate(self.nds.do(F, n_stop_if_ranked=n_survive)):
                rank[front] = k
            return rank
        low, span = range_of_front(F)
        box, total = boxes(F, low, span, self.band), ((F - low) / span).sum(axis=1)
        left, k = np.arange(len(F)), 0
        while len(F) - len(left) < n_survive:
            first = left[~repeats(box[left], turn[left], total[left])]
            rank[first[is_nondominated(box[first], keep_weakly=True)]] = k
            left, k = left[rank[left] == len(F)], k + 1
        return rank


class ArrayRankAndCrowding(ArraySurvival, RankAndCrowding):
    """The original NSGA-II's survival, pymoo's with the same survivors, draws and order.

    See `pymoo.operators.survival.rank_and_crowding.RankAndCrowding` for the parameters.
    """

    def _do(self, problem, pop, *args, random_state=None, n_survive=None, **kwargs):
        F, n_survive = pop.get("F").astype(float), len(pop) if n_survive is None else n_survive
        fronts = self.nds.do(F, n_stop_if_ranked=n_survive)
        # A sorting of the caller's own may rank more fronts than are needed.
        fronts = fronts[: np.searchsorted(np.cumsum([len(front) for front in fronts]), n_survive) + 1]
        ranked = np.concatenate(fronts)
        rank = np.repeat(np.arange(len(fronts)), [len(front) for front in fronts])
        n_remove = max(len(ranked) - n_survive, 0)
        crowding = self._crowding(F[ranked], rank, n_remove)
        pop[ranked].set(rank=rank, crowding=crowding)
        if n_remove:
            n_last = len(fronts[-1])
            order = randomized_argsort(crowding[-n_last:], order="descending", method="numpy", random_state=random_state)
            ranked = np.concatenate([ranked[:-n_last], fronts[-1][order[:-n_remove]]])
        return pop[ranked]

    def _crowding(self, F, rank, n_remove):
        """Return what the crowding function says of each front; points lie front after front."""
        function: Any = self.crowding_func
        plain = type(function) is FunctionalDiversity and not function.filter_out_duplicates
        if plain and function.function is calc_crowding_distance:
            return crowding_distances(F, rank, as_pymoo=True)
        fronts = np.split(F, np.flatnonzero(np.diff(rank)) + 1)
        parts: list[Any] = [*map(function.do, fronts[:-1]), function.do(fronts[-1], n_remove=n_remove)]
        return np.concatenate(parts)


def repeats(F: np.ndarray, *keys: np.ndarray) -> np.ndarray:
    """Return who has the row of F of another whose keys are smaller, or as large and who comes earlier; bool, shape (N,)."""
    order = np.lexsort((*keys[::-1], *F.T))
    repeat = np.zeros(len(F), dtype=bool)
    repeat[order[1:]] = (F[order[1:]] == F[order[:-1]]).all(axis=1)
    return repeat


def crowding_distances(F: np.ndarray, rank: np.ndarray, as_pymoo: bool = False) -> np.ndarray:
    """Return the crowding distance of each point within its front, for all fronts at once.

    Parameters
    ----------
    F : numpy.ndarray, shape (N, n_obj)
        Objectives.
    rank : numpy.ndarray of int, shape (N,)
        The front of each point.
    as_pymoo : bool, default False
        Whether to round as pymoo does, which adds the distances to both neighbours after division by the range.

    Returns
    -------
    numpy.ndarray, shape (N,)
        The mean over objectives of the distance between a point's two neighbours over the range of its front; ``inf``
        at the ends of a front, and in fronts of one or two points. An objective that is constant over a front counts
        as 0 there.

    References
    ----------
    K. Deb, A. Pratap, S. Agarwal and T. Meyarivan, "A fast and elitist multiobjective genetic algorithm: NSGA-II", IEEE
    Transactions on Evolutionary Computation 6(2), 2002, section III.B.
    """
    distance = np.empty(F.shape)
    for k, values in enumerate(F.T):
        order = np.lexsort((values, rank))
        value, front = values[order], rank[order]
        first = np.concatenate([[True], front[1:] != front[:-1]])
        last = np.concatenate([first[1:], [True]])
        # Position of the front's first and last point, for every point.
        group = np.cumsum(first) - 1
        spread = value[last][group] - value[first][group]
        spread[spread == 0] = np.nan
        if as_pymoo:
            step = np.diff(value, prepend=-np.inf, append=np.inf)
            gaps = np.array([step[:-1], step[1:]])
            gaps[0, first] = gaps[1, last] = np.inf
        else:
            gaps = np.full((1, len(F)), np.inf)
            gaps[0, 1:-1] = value[2:] - value[:-2]
            gaps[0, first | last] = np.inf
        shares = gaps / spread
        shares[np.isnan(shares)] = 0.0
        distance[order, k] = shares.sum(axis=0)
    size = np.bincount(rank)[rank]
    return np.where(size <= 2, np.inf, distance.sum(axis=1) / F.shape[1])
