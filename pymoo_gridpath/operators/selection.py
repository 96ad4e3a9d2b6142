"""Tournaments decided on arrays, with and without a tie-break by smoothness."""

from __future__ import annotations

import numpy as np
from pymoo.algorithms.moo.omni import NeighborBasedTournamentSelection
from pymoo.operators.selection.tournament import TournamentSelection

from pymoo_gridpath.registry import OPERATORS


@OPERATORS.register
class SmoothnessTournament(TournamentSelection):
    """The modified NSGA-II's binary tournament: rank, then smoothness, then crowding.

    Of two individuals the one with the lower non-domination rank wins; of equal ranks the one with the smaller total
    turn; of equal turns the one with the larger crowding distance; and else either. If one of them is infeasible, the
    one with the smaller constraint violation wins first (Deb's parameter-less rule).

    Needs `RankAndSmoothness` as survival beside it, which sets ``rank`` and ``crowding``, and a problem that sets ``turn``,
    without which that survival warns and turns count as equal. The type of the genes does not matter.

    References
    ----------
    Ahmed and Deb (2013), sections 4.1 and 5.1.
    """

    def __init__(self):
        super().__init__(func_comp=by_rank_turn_crowding)


class CrowdingTournament(TournamentSelection):
    """The original NSGA-II's binary tournament, pymoo's with the same draws: dominance, then crowding.

    Of two individuals the one that dominates wins, else the one with the larger crowding distance, and else either. If one of
    them is infeasible, the one with the smaller constraint violation wins. Where the algorithm's ``tournament_type`` is
    "comp_by_rank_and_crowding", ranks are compared in place of dominance.

    References
    ----------
    K. Deb, A. Pratap, S. Agarwal and T. Meyarivan, "A fast and elitist multiobjective genetic algorithm: NSGA-II", IEEE
    Transactions on Evolutionary Computation 6(2), 2002.
    """

    def __init__(self):
        super().__init__(func_comp=by_dominance_and_crowding)


class NeighborTournament(NeighborBasedTournamentSelection):
    """The Omni-Optimizer's tournament between neighbours, pymoo's with the same draws.

    pymoo's looks for a second individual for ever where there is but one; here that one is every parent.

    References
    ----------
    K. Deb and S. Tiwari, "Omni-optimizer: A generic evolutionary algorithm for single and multi-objective optimization",
    European Journal of Operational Research 185(3), 2008.
    """

    def _do(self, problem, pop, n_select, n_parents, **kwargs):
        if len(pop) == 1:
            return np.zeros((n_select, n_parents), dtype=int)
        return super()._do(problem, pop, n_select, n_parents, **kwargs)


def by_rank_turn_crowding(pop, P: np.ndarray, random_state=None, **kwargs) -> np.ndarray:
    """Return the winners of tournaments between two; see `SmoothnessTournament`.

    Parameters
    ----------
    pop : pymoo.core.population.Population
    P : numpy.ndarray of int, shape (n_tournaments, 2)
        Who meets whom.
    random_state : numpy.random.Generator

    Returns
    -------
    numpy.ndarray of int, shape (n_tournaments, 1)
    """
    assert random_state is not None
    CV, rank, turn, crowding = pop.get("CV", "rank", "turn", "crowding")
    verdict = decide(P, CV[:, 0], compare(P, rank), compare(P, turn), -compare(P, crowding))
    return winners(P, verdict, random_state.random(len(P)) < 0.5)


def by_dominance_and_crowding(pop, P: np.ndarray, algorithm, **kwargs) -> np.ndarray:
    """Return the winners of tournaments between two; see `CrowdingTournament`.

    Parameters
    ----------
    pop : pymoo.core.population.Population
    P : numpy.ndarray of int, shape (n_tournaments, 2)
        Who meets whom.
    algorithm : pymoo.algorithms.moo.nsga2.NSGA2

    Returns
    -------
    numpy.ndarray of int, shape (n_tournaments, 1)
    """
    CV, F, rank, crowding = pop.get("CV", "F", "rank", "crowding")
    by_rank = algorithm.tournament_type == "comp_by_rank_and_crowding"
    better = compare(P, rank) if by_rank else dominance(F[P[:, 0]], F[P[:, 1]])
    verdict = decide(P, CV[:, 0], better, -compare(P, crowding))
    return winners(P, verdict, draw_as_pymoo(verdict, algorithm.random_state))


def compare(P: np.ndarray, value: np.ndarray) -> np.ndarray:
    """Return for each tournament -1 if the first has the smaller value, 1 if the second has, else 0; None is 0.

    Parameters
    ----------
    P : numpy.ndarray of int, shape (n_tournaments, 2)
    value : numpy.ndarray, shape (N,)
        One an individual.

    Returns
    -------
    numpy.ndarray of int, shape (n_tournaments,)
    """
    if value.dtype == object:
        # The infeasible carry no rank of this generation, and `decide` does not ask for it.
        value = np.array([0 if one is None else one for one in value], dtype=float)
    a, b = value[P[:, 0]], value[P[:, 1]]
    return (a > b).astype(int) - (a < b)


def dominance(F: np.ndarray, G: np.ndarray) -> np.ndarray:
    """Return row by row -1 if the objectives F dominate G, 1 if G dominates F, else 0; both of shape (N, n_obj)."""
    return (F > G).any(axis=1).astype(int) - (F < G).any(axis=1)


def decide(P: np.ndarray, cv: np.ndarray, *verdicts: np.ndarray) -> np.ndarray:
    """Return who wins: if one of the two is infeasible the smaller violation, else the first verdict that is not 0.

    Parameters
    ----------
    P : numpy.ndarray of int, shape (n_tournaments, 2)
    cv : numpy.ndarray, shape (N,)
        Constraint violation of each individual.
    *verdicts : numpy.ndarray of int, shape (n_tournaments,)
        As `compare` returns them, the most important first.

    Returns
    -------
    numpy.ndarray of int, shape (n_tournaments,)
        -1 for the first, 1 for the second, 0 for a draw.
    """
    verdict = verdicts[0]
    for further in verdicts[1:]:
        verdict = np.where(verdict == 0, further, verdict)
    return np.where((cv[P] > 0.0).any(axis=1), compare(P, cv), verdict)


def winners(P: np.ndarray, verdict: np.ndarray, second_wins_draw: np.ndarray) -> np.ndarray:
    """Return the winners of tournaments, shape (n_tournaments, 1), by verdicts and by who wins where these are 0."""
    return np.where(np.where(verdict == 0, second_wins_draw, verdict > 0), P[:, 1], P[:, 0])[:, None]


def draw_as_pymoo(verdict: np.ndarray, random_state) -> np.ndarray:
    """Return whether the second wins a draw, from the numbers that pymoo would draw: one for each draw, in their order."""
    second = np.zeros(len(verdict), dtype=bool)
    draws = np.flatnonzero(verdict == 0)
    second[draws] = random_state.integers(0, 2, size=len(draws)) == 1
    return second
