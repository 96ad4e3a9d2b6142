"""SPEA2's survival and tournament with a smoothness tie-break."""

from __future__ import annotations

import math
import warnings

import numpy as np
import pytest
from pymoo.core.population import Population
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import StrengthAndSmoothness, StrengthTournament, make_algorithm
from pymoo_gridpath.algorithms.spea2 import SAME_DISTANCE, ArraySPEA2Survival, _distances, _ends, truncate


def population(F, turn, cv=None):
    cv = np.zeros(len(F)) if cv is None else np.array(cv, float)
    names = np.arange(len(F))
    return Population.new("F", np.array(F, float), "G", cv[:, None], "turn", np.array(turn), "name", names)


def survivors(problem, n_survive, *args):
    return sorted(StrengthAndSmoothness().do(problem, population(*args), n_survive=n_survive).get("name").tolist())


def loop_truncation(F, turn, n_survive):
    """Remove one at a time, looking at every distance anew."""
    ends = {min(range(len(F)), key=lambda i: (F[i][j], sum(F[i]), turn[i])) for j in range(len(F[0]))}
    alive = list(range(len(F)))

    def distances(i):
        return sorted(math.sqrt(sum((a - b) ** 2 for a, b in zip(F[i], F[j], strict=True))) for j in alive if j != i)

    while len(alive) > n_survive:
        removable = [i for i in alive if i not in ends]
        nearest = min(distances(i)[0] for i in removable)
        tied = [i for i in removable if distances(i)[0] <= nearest + 1e-9]
        roughest = max(turn[i] for i in tied)
        alive.remove(min((i for i in tied if turn[i] == roughest), key=lambda i: (distances(i), i)))
    return alive


@pytest.mark.parametrize("seed", range(40))
def test_truncation_matches_a_loop(seed):
    rng = np.random.default_rng(seed)
    n, n_obj = int(rng.integers(4, 30)), int(rng.integers(2, 4))
    F, turn = rng.integers(0, 12, (n, n_obj)), rng.integers(0, 3, n)
    n_survive = int(rng.integers(n_obj, n + 1))
    kept = _ends(F.astype(float), turn)[:n_survive]
    survivors = truncate(_distances(F.astype(float)), n_survive, turn, kept, SAME_DISTANCE)
    assert survivors.tolist() == loop_truncation(F.tolist(), turn.tolist(), n_survive)


def test_of_the_closest_pair_the_smoother_stays(make_problem):
    F = [[0, 10], [4, 6], [5, 5], [10, 0]]
    # Plain SPEA2 would remove the second, whose next neighbours are nearer or as near.
    assert survivors(make_problem(), 3, F, [0, 90, 45, 0]) == [0, 2, 3]
    assert survivors(make_problem(), 3, F, [0, 45, 90, 0]) == [0, 1, 3]


def test_of_equal_objectives_the_smoothest_stays(make_problem):
    F = [[0, 10], [5, 5], [5, 5], [5, 5], [6, 4], [10, 0]]
    assert survivors(make_problem(), 4, F, [0, 90, 45, 135, 900, 0]) == [0, 2, 4, 5]


def test_the_ends_of_the_front_stay_however_rough(make_problem):
    F = [[0, 10], [0.1, 9.9], [5, 5], [9.9, 0.1], [10, 0]]
    assert survivors(make_problem(), 3, F, [900, 0, 0, 0, 900]) == [0, 2, 4]


def test_filling_up_goes_by_raw_fitness_then_turn(make_problem):
    # 0 dominates 1 to 4, 1 dominates 3 and 4: R = 0, 4, 4, 6, 6.
    F = [[0, 0], [1, 2], [2, 1], [2, 3], [3, 2.5]]
    pop = population(F, [500, 90, 45, 45, 0])
    StrengthAndSmoothness().do(make_problem(), pop, n_survive=5)
    strength = [sum(all(a <= b for a, b in zip(f, g, strict=True)) and f != g for g in F) for f in F]
    raw = [
        sum(s for g, s in zip(F, strength, strict=True) if all(a <= b for a, b in zip(g, f, strict=True)) and f != g) for f in F
    ]
    assert pop.get("SPEA_R").tolist() == raw
    assert np.allclose(pop.get("SPEA_F"), np.array(raw) + pop.get("SPEA_D"))
    assert (pop.get("SPEA_D") > 0).all() and (pop.get("SPEA_D") < 1).all()
    best = sorted(range(5), key=lambda i: (raw[i], [500, 90, 45, 45, 0][i]))
    for n in range(1, 6):
        assert survivors(make_problem(), n, F, [500, 90, 45, 45, 0]) == sorted(best[:n])


def test_density_is_that_of_the_kth_neighbour(make_problem):
    F = [[0, 4], [1, 3], [2, 2], [4, 0]]
    pop = population(F, [0, 0, 0, 0])
    StrengthAndSmoothness().do(make_problem(), pop, n_survive=4)
    # k = 2; objectives scaled by 4.
    assert np.allclose(pop.get("SPEA_D"), [1 / (math.hypot(d, d) / 4 + 2) for d in (2, 1, 2, 3)])


def test_the_infeasible_come_last(make_problem):
    F = [[5, 5], [0, 0], [1, 1], [6, 6]]
    assert survivors(make_problem(2, "constraint"), 3, F, [0, 0, 0, 0], [0, 3, 1, 0]) == [0, 2, 3]


def test_tournament():
    pop = population([[0, 0]] * 6, [0, 90, 45, 45, 0, 0], [0, 0, 0, 0, 1, 2])
    pop[:4].set("SPEA_R", np.array([3, 0, 0, 0]), "SPEA_D", np.array([0.1, 0.1, 0.4, 0.2]))
    pairs = [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5)]
    winners = [1, 2, 3, 3, 4]
    for swap in (False, True):
        P = np.array([pair[::-1] if swap else pair for pair in pairs])
        tournament = StrengthTournament()
        assert tournament.func_comp(pop, P, random_state=np.random.default_rng(1))[:, 0].tolist() == winners


def test_tournament_draws_fairly():
    pop = population([[0, 0]] * 2, [45, 45])
    pop.set("SPEA_R", np.zeros(2), "SPEA_D", np.full(2, 0.3))
    P = np.tile([0, 1], (4000, 1))
    wins = StrengthTournament().func_comp(pop, P, random_state=np.random.default_rng(1)).mean()
    assert abs(wins - 0.5) < 5 * 0.5 / math.sqrt(4000)


@pytest.mark.parametrize("representation", ["integer", "binary", "mixed", "absolute"])
@pytest.mark.parametrize("name", ["NSGA2", "SPEA2", "MOEAD"])
def test_all_representations(name, representation, make_problem):
    problem = make_problem(2, "constraint", representation)
    result = minimize(problem, make_algorithm(name, problem, 24), ("n_gen", 15), seed=1)
    assert result.pop.get("X").dtype == (bool if representation == "binary" else np.int64)
    assert (result.pop.get("X") >= problem.xl).all() and (result.pop.get("X") <= problem.xu).all()
    assert result.X is not None and (problem.decode(result.X).interfering_cells == 0).all()
    # No path is shorter than the diagonal of seven steps.
    assert (result.F[:, 0] >= 7 * math.sqrt(2) - 1e-9).all()


def test_survival_leaves_the_filters_of_warnings_as_they_were():
    problem = GridPathProblem(OccupancyGrid(np.zeros((6, 6))), (0, 0), (5, 5))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        before = list(warnings.filters)
        ArraySPEA2Survival(normalize=True).do(problem, population([[1, 2], [2, 1], [3, 3]], [0, 0, 0]), n_survive=2)
        assert warnings.filters == before
