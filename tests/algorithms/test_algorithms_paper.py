"""The paper's preset, several runs, the first-legal-path termination, and reproducibility across processes."""

import hashlib

import numpy as np
import pytest
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.core.callback import Callback
from pymoo.optimize import minimize

from pymoo_gridpath.algorithms import FirstLegalPath, ahmed_deb_2013, make_algorithm, minimize_runs
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.operators import RankAndSmoothness, SmoothnessTournament
from pymoo_gridpath.problems import GridPathProblem, random_dense_grid
from pymoo_gridpath.problems.members import are_legal
from pymoo_gridpath.testing.elsewhere import elsewhere

GRID = random_dense_grid(10, 0.3, 1)
QUERY = (0, 0), (9, 9)


def test_preset_carries_the_papers_parameters():
    """Section 5.2, with n = 10 columns."""
    problem, algorithm, termination = ahmed_deb_2013(GRID, *QUERY)
    assert algorithm.pop_size == 500 and termination.n_max_gen == 500
    mating = algorithm.mating
    assert mating.crossover.prob.get() == 0.9 and mating.crossover.eta.get() == 10
    assert mating.mutation.eta.get() == 20 and mating.mutation.prob_var.get() == pytest.approx(1 / 10)
    assert mating.mutation.prob.get() == 1.0
    assert isinstance(algorithm.survival, RankAndSmoothness) and isinstance(mating.selection, SmoothnessTournament)
    assert problem.objective_names == ["length", "vulnerability"] and problem.obstacles == "penalty"
    assert problem.penalty == 1.0  # the count of interfering cells itself, section 4.1
    assert problem.representation.name == "integer"


def test_preset_with_three_objectives_is_the_original_nsga2():
    problem, algorithm, _ = ahmed_deb_2013(GRID, *QUERY, objectives=("length", "vulnerability", "turn"))
    assert problem.n_obj == 3
    assert not isinstance(algorithm.survival, RankAndSmoothness)
    assert not isinstance(algorithm.mating.selection, SmoothnessTournament)


def test_preset_with_one_objective_is_a_genetic_algorithm_with_a_constraint():
    problem, algorithm, termination = ahmed_deb_2013(GRID, *QUERY, objectives="length", pop_size=60, n_gen=40)
    assert isinstance(algorithm, GA) and algorithm.mating.crossover.eta.get() == 2
    assert problem.obstacles == "constraint"
    result = minimize(problem, algorithm, termination, seed=1)
    shortest = GRID.shortest_lengths((0, 0))[9, 9]  # scipy's, over all paths and not only monotone ones
    assert result.F[0] >= shortest - 1e-9
    assert result.F[0] <= 1.2 * shortest


@pytest.mark.parametrize("representation", ["integer", "binary", "mixed", "absolute"])
def test_preset_runs_every_representation(representation):
    setup = ahmed_deb_2013(GRID, *QUERY, representation=representation, pop_size=50, n_gen=30)
    pop = minimize(*setup, seed=1).pop
    assert pop.get("X").dtype == np.dtype(setup.problem.vtype)
    if representation != "absolute":  # which the paper dropped because it rarely finds a legal path
        assert (pop.get("interfering_cells") == 0).any()


@pytest.mark.parametrize("bad", [{"pop_size": 0}, {"n_gen": 0}, {"representation": "x"}, {"objectives": ()}, {"axis": "z"}])
def test_preset_refuses_in_words(bad):
    with pytest.raises(GridPathError):
        ahmed_deb_2013(GRID, *QUERY, **bad)


def test_first_legal_path_ends_the_run_in_its_generation():
    class Legal(Callback):
        def __init__(self):
            super().__init__()
            self.seen = []

        def _update(self, algorithm):
            self.seen.append(bool((algorithm.pop.get("interfering_cells") == 0).any()))

    setup = ahmed_deb_2013(GRID, *QUERY, pop_size=20, termination=FirstLegalPath(200))
    result = minimize(*setup, seed=3, callback=Legal())
    seen = result.algorithm.callback.seen
    assert seen == [False] * (len(seen) - 1) + [True]
    assert result.algorithm.termination.found
    wall = OccupancyGrid(np.eye(6)[::-1], corner_cutting=True)  # the only way out is to cut a corner: hard for 2 individuals
    setup = ahmed_deb_2013(wall, (0, 0), (5, 5), pop_size=2, termination=FirstLegalPath(4))
    result = minimize(*setup, seed=1)
    assert result.algorithm.n_gen - 1 <= 4
    assert result.algorithm.termination.found == bool((result.pop.get("interfering_cells") == 0).any())


def test_a_path_over_the_limit_is_no_legal_path():
    setup = ahmed_deb_2013(GRID, *QUERY, pop_size=60, termination=FirstLegalPath(12), obstacles="limit", potential_limit=1e-9)
    result = minimize(*setup, seed=3)
    pop = result.pop
    assert ((pop.get("interfering_cells") == 0) & (pop.get("CV")[:, 0] > 0)).any()
    assert not result.algorithm.termination.found and result.algorithm.n_gen - 1 == 12


def test_legal_is_what_crosses_nothing_and_violates_nothing():
    assert are_legal([0, 1, 0, 2]).tolist() == [True, False, True, False]
    assert are_legal([0, 1, 0, 0], [0.0, 0.0, 0.1, -3.0]).tolist() == [True, False, False, True]
    assert are_legal([]).shape == (0,)


def test_runs_are_those_of_minimize_one_by_one():
    setup = ahmed_deb_2013(GRID, *QUERY, pop_size=20, n_gen=5)
    seen = []
    results = minimize_runs(*setup, n_runs=3, seed=7, observe=lambda k, algorithm: seen.append((k, algorithm.n_gen - 1)))
    assert seen == [(k, g) for k in range(3) for g in range(1, 6)]
    for k, result in enumerate(results):
        alone = minimize(*setup, seed=7 + k)
        assert np.array_equal(result.pop.get("X"), alone.pop.get("X"))
        assert np.array_equal(result.F, alone.F)


def test_runs_end_where_the_observer_says_and_keep_what_was_found():
    setup = ahmed_deb_2013(GRID, *QUERY, pop_size=20, n_gen=50)
    results = minimize_runs(*setup, n_runs=3, seed=1, observe=lambda k, algorithm: k == 1 and algorithm.n_gen > 3)
    assert len(results) == 2 and results[1].F is not None
    with pytest.raises(GridPathError, match="n_runs is 0"):
        minimize_runs(*setup, n_runs=0)


@pytest.mark.parametrize("observe", [lambda: True, lambda k: True, 3, int])
def test_observers_that_cannot_be_called_so_are_refused_before_the_search(observe):
    setup = ahmed_deb_2013(GRID, *QUERY, pop_size=20, n_gen=5)
    with pytest.raises(GridPathError, match=r"observe is .*, expected a function of the number"):
        minimize_runs(*setup, n_runs=1, observe=observe)


def digest_of_a_run(name, representation):
    """Return what tells the final population of a run from others."""
    problem = GridPathProblem(random_dense_grid(10, 0.3, 1), (0, 0), (9, 9), representation)
    pop = minimize(problem, make_algorithm(name, problem, pop_size=30), ("n_gen", 10), seed=5).pop
    return hashlib.sha256(pop.get("X").tobytes() + pop.get("F").tobytes()).hexdigest()


@pytest.mark.parametrize(
    ("name", "representation"), [("NSGA2", "integer"), ("NSGA2", "mixed"), ("SPEA2", "binary"), ("MOEAD", "integer")]
)
def test_same_seed_same_bits_in_another_process(name, representation):
    assert elsewhere(digest_of_a_run, name, representation) == digest_of_a_run(name, representation)
