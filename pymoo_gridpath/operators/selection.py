"""Tournaments that break ties by smoothness."""

from __future__ import annotations

import numpy as np
from pymoo.operators.selection.tournament import TournamentSelection

from pymoo_gridpath.operators.individuals import attributes, violations


class SmoothnessTournament(TournamentSelection):
    """The modified NSGA-II's binary tournament: rank, then smoothness, then crowding.

    Of two individuals the one with the lower non-domination rank wins; of equal ranks the one with the smaller total
    turn; of equal turns the one with the larger crowding distance; and else either. If one of them is infeasible, the
    one with the smaller constraint violation wins first (Deb's parameter-less rule).

    Needs `RankAndSmoothness` as survival, which sets ``rank`` and ``crowding``, and a problem that sets ``turn``.

    References
    ----------
    Ahmed and Deb (2013), sections 4.1 and 5.1.
    """

    def __init__(self, **kwargs):
        super().__init__(func_comp=by_rank_turn_crowding, **kwargs)


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
    cv, turn = violations(pop), attributes(pop, "turn").astype(float)
    rank, crowding = attributes(pop, "rank"), attributes(pop, "crowding")
    # The infeasible carry no rank of this generation; among them only the violation counts.
    feasible = cv <= 0.0
    rank = np.where(feasible, rank, 0).astype(float)
    crowding = np.where(feasible, crowding, 0.0).astype(float)
    both = feasible[P].all(axis=1)
    return tournament(P, random_state, (cv, None), (rank, both), (turn, both), (-crowding, both))


def tournament(P: np.ndarray, random_state, *keys) -> np.ndarray:
    """Return the winners of tournaments between two by keys in order of importance, smaller wins; a draw goes to either.

    Parameters
    ----------
    P : numpy.ndarray of int, shape (n_tournaments, 2)
    random_state : numpy.random.Generator
    *keys : (numpy.ndarray of shape (N,), numpy.ndarray of bool of shape (n_tournaments,) or None)
        A value of each individual, and the tournaments in which it counts (None: all).

    Returns
    -------
    numpy.ndarray of int, shape (n_tournaments, 1)
    """
    second_wins = random_state.random(len(P)) < 0.5
    for value, counts in reversed(keys):
        a, b = value[P[:, 0]], value[P[:, 1]]
        differ = a != b
        if counts is not None:
            differ &= counts
        second_wins = np.where(differ, b < a, second_wins)
    return np.where(second_wins, P[:, 1], P[:, 0])[:, None]
