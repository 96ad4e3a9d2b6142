"""SPEA2's survival and tournament with a smoothness tie-break."""

from __future__ import annotations

import numpy as np
from pymoo.core.survival import Survival
from pymoo.operators.selection.tournament import TournamentSelection
from scipy.spatial.distance import cdist

from pymoo_gridpath.operators.selection import tournament

#: Distances in scaled objectives that differ by no more than this are equal.
SAME_DISTANCE = 1e-9


class StrengthAndSmoothness(Survival):
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

    References
    ----------
    E. Zitzler, M. Laumanns and L. Thiele, "SPEA2: improving the strength Pareto evolutionary algorithm", TIK report 103, ETH
    Zurich, 2001, sections 3.1 and 3.2. The tie-break follows Ahmed and Deb (2013), section 5.1.
    """

    def __init__(self):
        super().__init__(filter_infeasible=True)

    def _do(self, problem, pop, *args, n_survive=None, random_state=None, **kwargs):
        F, turn = pop.get("F").astype(float), pop.get("turn").astype(float)
        no_worse = (F[:, None] <= F[None]).all(axis=2)
        dominates = no_worse & ~no_worse.T
        raw = dominates.T @ dominates.sum(axis=1)
        front = np.flatnonzero(~dominates.any(axis=0))
        scaled = _scale(F, F[front])
        density = 1.0 / (_kth_distance(scaled) + 2.0)
        pop.set("SPEA_F", raw + density, "SPEA_R", raw, "SPEA_D", density)
        n_survive = len(pop) if n_survive is None else n_survive
        if len(front) <= n_survive:
            return pop[np.lexsort((density, turn, raw))[:n_survive]]
        return pop[front[truncate(scaled[front], turn[front], n_survive)]]


class StrengthTournament(TournamentSelection):
    """SPEA2's binary tournament with smoothness before density.

    Of two individuals the one with the smaller constraint violation wins; if both are feasible the one with the smaller raw
    fitness, of equal ones that with the smaller total turn, then that in the less dense region; and else either.

    Needs `StrengthAndSmoothness` as survival, and a problem that sets ``turn``.
    """

    def __init__(self, **kwargs):
        super().__init__(func_comp=by_strength_turn_density, **kwargs)


def by_strength_turn_density(pop, P: np.ndarray, random_state=None, **kwargs) -> np.ndarray:
    """Return the winners of tournaments between two; see `StrengthTournament`.

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
    cv, turn = pop.get("CV")[:, 0], pop.get("turn").astype(float)
    feasible = cv <= 0.0
    # The infeasible carry no fitness of this generation; among them only the violation counts.
    raw, density = np.zeros(len(pop)), np.zeros(len(pop))
    raw[feasible], density[feasible] = pop[feasible].get("SPEA_R"), pop[feasible].get("SPEA_D")
    both = feasible[P].all(axis=1)
    return tournament(P, random_state, (cv, None), (raw, both), (turn, both), (density, both))


def truncate(F: np.ndarray, turn: np.ndarray, n_survive: int) -> np.ndarray:
    """Return which of mutually non-dominated individuals survive SPEA2's truncation; see `StrengthAndSmoothness`.

    Parameters
    ----------
    F : numpy.ndarray, shape (N, n_obj)
        Scaled objectives.
    turn : numpy.ndarray, shape (N,)
        Total turns.
    n_survive : int
        How many, at least n_obj.

    Returns
    -------
    numpy.ndarray of int, shape (n_survive,)
        Ascending indices.
    """
    distances = _distances(F)
    # Each row lists everybody by distance; `place` points at the nearest that is still alive and moves on only when it dies,
    # so that a removal costs O(N) rather than a sort of all distances.
    order = np.argsort(distances, axis=1, kind="stable")
    place = np.zeros(len(F), dtype=np.int64)
    nearest = np.take_along_axis(distances, order[:, :1], axis=1)[:, 0]
    alive = np.ones(len(F), dtype=bool)
    removable = np.ones(len(F), dtype=bool)
    removable[_ends(F, turn)[:n_survive]] = False
    for _ in range(len(F) - n_survive):
        candidates = np.flatnonzero(alive & removable)
        candidates = candidates[nearest[candidates] <= nearest[candidates].min() + SAME_DISTANCE]
        candidates = candidates[turn[candidates] == turn[candidates].max()]
        loser = candidates[0] if len(candidates) == 1 else _most_crowded(distances, candidates, alive)
        alive[loser] = False
        for i in np.flatnonzero(alive & (order[np.arange(len(F)), place] == loser)):
            place[i] += np.argmax(alive[order[i, place[i] :]])
            nearest[i] = distances[i, order[i, place[i]]]
    return np.flatnonzero(alive)


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


def _most_crowded(distances: np.ndarray, candidates: np.ndarray, alive: np.ndarray) -> int:
    """Return the candidate whose sorted distances to those alive are lexicographically the smallest."""
    near = np.sort(distances[np.ix_(candidates, np.flatnonzero(alive))], axis=1)
    return int(candidates[np.lexsort(near.T[::-1])[0]])
