"""The modified NSGA-II's tournament and survival against plain Python."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymoo.core.population import Population
from pymoo.operators.survival.rank_and_crowding.metrics import get_crowding_function
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem
from pymoo_gridpath.algorithms import make_algorithm
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.operators import RankAndSmoothness, SmoothnessTournament, path_operators
from pymoo_gridpath.operators.selection import by_rank_turn_crowding
from pymoo_gridpath.operators.survival import crowding_distances
from pymoo_gridpath.problems import random_dense_grid


class Unconstrained:
    def has_constraints(self):
        return False


class Constrained:
    def has_constraints(self):
        return True


def population(rng, n=30, n_obj=2, infeasible=0.0):
    violated = rng.random(n) < infeasible
    pop = Population.new("X", np.arange(n)[:, None])
    pop.set("F", rng.integers(0, 5, size=(n, n_obj)).astype(float))
    pop.set("G", (violated * rng.integers(1, 4, n))[:, None].astype(float), "H", np.zeros((n, 0)))
    pop.set("turn", 45 * rng.integers(0, 4, n))
    return pop


def better(a, b):
    """-1 if individual a wins, 1 if b wins, 0 if the draw decides: the rule of sections 4.1 and 5.1 in words."""
    if a.CV[0] > 0 or b.CV[0] > 0:
        return int(np.sign(a.CV[0] - b.CV[0]))
    for key, sign in (("rank", 1), ("turn", 1), ("crowding", -1)):
        if a.get(key) != b.get(key):
            return int(np.sign(sign * (a.get(key) - b.get(key))))
    return 0


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.4]))
def test_tournament_follows_rank_then_turn_then_crowding(seed, infeasible):
    rng = np.random.default_rng(seed)
    pop = population(rng, infeasible=infeasible)
    rank, crowding = rng.integers(0, 3, 30), rng.choice([1.0, 2.0, np.inf], 30)
    for i, ind in enumerate(pop):
        if ind.CV[0] <= 0:  # pymoo sets no rank on the infeasible
            ind.set("rank", rank[i])
            ind.set("crowding", crowding[i])
    P = rng.integers(0, 30, size=(200, 2))
    winners = by_rank_turn_crowding(pop, P, random_state=rng)[:, 0]
    for (a, b), winner in zip(P, winners, strict=True):
        verdict = better(pop[a], pop[b])
        assert winner == (a if verdict < 0 else b) or (verdict == 0 and winner in (a, b))


def test_draws_are_fair():
    pop = population(np.random.default_rng(0), 2)
    pop.set("turn", 0, "rank", 0, "crowding", 1.0, "G", np.zeros((2, 1)))
    winners = by_rank_turn_crowding(pop, np.tile([0, 1], (4000, 1)), random_state=np.random.default_rng(1))
    assert 0.45 < winners.mean() < 0.55


def plain_fronts(F):
    """Non-dominated fronts by comparing all pairs."""
    left, fronts = list(range(len(F))), []
    while left:
        front = [i for i in left if not any((F[j] <= F[i]).all() and (F[j] < F[i]).any() for j in left)]
        fronts.append(front)
        left = [i for i in left if i not in front]
    return fronts


@given(st.integers(0, 2**32 - 1), st.integers(1, 30), st.sampled_from([1, 2, 3]))
def test_survival_takes_whole_fronts_and_the_smoothest_of_the_last(seed, n_survive, n_obj):
    rng = np.random.default_rng(seed)
    pop = population(rng, n_obj=n_obj)
    F, turn = pop.get("F"), pop.get("turn")
    survivors = RankAndSmoothness().do(Unconstrained(), pop, n_survive=n_survive, random_state=rng)
    chosen = survivors.get("X")[:, 0].tolist()
    assert len(set(chosen)) == n_survive
    missing = n_survive
    for rank, front in enumerate(plain_fronts(F)):
        kept = [i for i in front if i in chosen]
        assert len(kept) == min(missing, len(front))
        assert all(pop[i].get("rank") == rank for i in kept)
        if len(kept) < len(front):
            crowding = dict(zip(front, crowding_distances(F[front], np.zeros(len(front), dtype=int)), strict=True))
            worst_kept = max(((turn[i], -crowding[i]) for i in kept), default=(-1, 0))
            best_left = min((turn[i], -crowding[i]) for i in front if i not in kept)
            assert worst_kept <= best_left
        missing -= len(kept)


def test_survival_puts_the_infeasible_last_in_order_of_violation():
    rng = np.random.default_rng(5)
    pop = population(rng, infeasible=0.5)
    feasible = int((pop.get("CV")[:, 0] <= 0).sum())
    survivors = RankAndSmoothness().do(Constrained(), pop, n_survive=feasible + 3, random_state=rng)
    cv = survivors.get("CV")[:, 0]
    assert (cv[:feasible] <= 0).all()
    assert sorted(pop.get("CV")[:, 0][pop.get("CV")[:, 0] > 0])[:3] == cv[feasible:].tolist()


@given(st.integers(0, 2**32 - 1), st.integers(1, 40), st.integers(1, 3))
def test_crowding_of_all_fronts_equals_pymoo_front_by_front(seed, n, n_obj):
    rng = np.random.default_rng(seed)
    # Distinct values, since among equal ones pymoo's order is one of several.
    F = rng.permuted(np.tile(np.arange(n, dtype=float), (n_obj, 1)), axis=1).T * rng.random(n_obj)
    rank = rng.integers(0, 3, n)
    ours, to_the_bit = crowding_distances(F, rank), crowding_distances(F, rank, as_pymoo=True)
    for k in np.unique(rank):
        pymoos = get_crowding_function("cd").do(F[rank == k])
        assert ours[rank == k] == pytest.approx(pymoos)
        assert np.array_equal(to_the_bit[rank == k], pymoos)


def test_crowding_ignores_an_objective_that_is_constant():
    F = np.array([[0.0, 1.0], [1.0, 1.0], [3.0, 1.0]])
    assert crowding_distances(F, np.zeros(3, dtype=int)).tolist() == [np.inf, 0.5, np.inf]


def test_selection_returns_indices_of_the_population():
    pop = population(np.random.default_rng(0))
    pop.set("rank", 0, "crowding", 1.0)
    chosen = SmoothnessTournament().do(None, pop, 10, 2, to_pop=False, random_state=np.random.default_rng(0))
    assert chosen.shape == (10, 2) and chosen.min() >= 0 and chosen.max() < 30


@given(st.integers(0, 2**32 - 1), st.integers(5, 30))
def test_distinct_points_survive_before_further_paths_to_the_same(seed, n_survive):
    rng = np.random.default_rng(seed)
    pop = population(rng)
    F, turn = pop.get("F"), pop.get("turn")
    front = [k for k in range(30) if not any((F[j] <= F[k]).all() and (F[j] < F[k]).any() for j in range(30))]
    points = {tuple(F[k]) for k in front}
    survivors = RankAndSmoothness(distinct=True).do(Unconstrained(), pop, n_survive=n_survive, random_state=rng)
    kept = [tuple(f) for f in survivors.get("F")]
    # The ends of the front come first, and points before repetitions of points.
    ends = {min(points), min(points, key=lambda f: f[::-1])}
    assert ends <= set(kept)
    n_first = len([f for f in kept if f in points])
    assert len(points & set(kept)) == min(len(points), n_first)
    # Of paths to one point the smoothest is among them.
    for point in points & set(kept):
        here = [individual.get("turn") for individual in survivors if tuple(individual.F) == point]
        assert min(here) == min(turn[k] for k in front if tuple(F[k]) == point)


def plain_ranks(F, turn, band):
    """Ranks where the smoothest of a box dominates the rest of it, by comparing all pairs."""
    front = F[plain_fronts(F)[0]]
    low, span = front.min(axis=0), np.ptp(front, axis=0)
    span[span == 0] = 1
    scaled = (F - low) / span
    box = [tuple(int(np.floor(x / (band * width))) for x, width in zip(f - low, span, strict=True)) for f in F]

    def beats(i, j):
        if box[i] == box[j]:
            return (turn[i], scaled[i].sum(), i) < (turn[j], scaled[j].sum(), j)
        return all(a <= b for a, b in zip(box[i], box[j], strict=True))

    left, rank = set(range(len(F))), {}
    for k in range(len(F)):
        first = {i for i in left if not any(beats(j, i) for j in left)}
        rank |= dict.fromkeys(first, k)
        left -= first
    return rank


@given(st.integers(0, 2**32 - 1), st.integers(1, 30), st.sampled_from([0.05, 0.3]), st.sampled_from([1, 2, 3]))
def test_with_a_band_the_smoothest_of_a_box_stands_for_it(seed, n_survive, band, n_obj):
    rng = np.random.default_rng(seed)
    pop = population(rng, n_obj=n_obj)
    pop.set("F", pop.get("F") + rng.choice([0.0, 0.1, 0.2], size=(30, n_obj)))
    rank = plain_ranks(pop.get("F"), pop.get("turn"), band)
    survivors = RankAndSmoothness(band=band).do(Unconstrained(), pop, n_survive=n_survive, random_state=rng)
    chosen = survivors.get("X")[:, 0].tolist()
    assert len(set(chosen)) == n_survive
    assert [rank[i] for i in chosen] == sorted(rank.values())[:n_survive] == survivors.get("rank").tolist()
    last = [i for i in range(30) if rank[i] == rank[chosen[-1]]]
    most = max(pop[i].get("turn") for i in last if i in chosen)
    assert all(pop[i].get("turn") >= most for i in last if i not in chosen)


def test_a_band_and_distinct_points_exclude_one_another():
    with pytest.raises(GridPathError, match=r"distinct is True and band is 0.1, expected one of the two"):
        RankAndSmoothness(distinct=True, band=0.1)


def test_a_band_smooths_the_result():
    problem = GridPathProblem(random_dense_grid(16, 0.15, 2), (0, 0), (15, 15), "integer")
    turns = []
    for survival in (RankAndSmoothness(distinct=True), RankAndSmoothness(band=0.05)):
        given = {**path_operators(problem), "selection": SmoothnessTournament(), "survival": survival}
        algorithm = make_algorithm("NSGA2", problem, 50, operators=given)
        turns.append(np.mean(minimize(problem, algorithm, ("n_gen", 30), seed=1).opt.get("turn")))
    assert turns[1] < turns[0]


def test_path_aware_operators_come_with_distinct_points():
    problem = GridPathProblem(random_dense_grid(8, 0.2, 1), (0, 0), (7, 7))
    assert not make_algorithm("NSGA2", problem).survival.distinct
    assert make_algorithm("NSGA2", problem, operators=path_operators(problem)).survival.distinct
    own = RankAndSmoothness()
    assert make_algorithm("NSGA2", problem, operators=path_operators(problem), survival=own).survival.distinct is False
