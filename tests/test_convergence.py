"""What a run leaves behind of how it converged."""

import copy
import pickle

import numpy as np
import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.callback import CallbackCollection
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem
from pymoo_gridpath.convergence import ConvergenceRecorder, common_reference_point
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.operators import paper_operators
from pymoo_gridpath.problems import random_dense_grid
from pymoo_gridpath.testing import reference


def make_problem(size, seed):
    grid = random_dense_grid(size, 0.25, seed).replace(corner_cutting=True)
    return GridPathProblem(grid, (0, 0), (size - 1, size - 1))


def run(problem, generations=25, **options):
    return minimize(problem, NSGA2(60, **paper_operators(problem)), ("n_gen", generations), seed=1, **options)


def test_the_recorder_sees_the_legal_paths_of_every_generation():
    problem = make_problem(10, 3)
    result = run(problem, generations=12, callback=ConvergenceRecorder(), save_history=True)
    recorder = result.algorithm.callback
    assert recorder.generations == list(range(1, 13))
    assert recorder.evaluations == [60 * k for k in range(1, 13)]
    for k, past in enumerate(result.history):
        expected = reference.legal_front(problem, past.pop.get("X"))
        legal = past.pop.get("interfering_cells") == 0
        assert recorder.n_feasible[k] == legal.sum()
        assert {tuple(row) for row in recorder.fronts[k].tolist()} == set(expected)
        assert recorder.best_length[k] == min((point[0] for point in expected), default=np.inf)
        assert recorder.best_vulnerability[k] == min((point[1] for point in expected), default=np.inf)
    first = next(k for k, n in enumerate(recorder.n_feasible) if n)
    assert recorder.first_feasible == first


def test_the_recorder_is_copied_pickled_and_collected():
    problem = make_problem(12, 3)
    recorder = run(problem, callback=ConvergenceRecorder()).algorithm.callback
    for again in (pickle.loads(pickle.dumps(recorder)), copy.deepcopy(recorder)):
        assert again.evaluations == recorder.evaluations
        assert np.array_equal(again.hypervolume(), recorder.hypervolume())
    result = run(problem, generations=3, callback=CallbackCollection(ConvergenceRecorder()))
    assert len(result.algorithm.callback.callbacks[0]) == 3


def test_hypervolume_by_hand():
    recorder = ConvergenceRecorder()
    recorder.evaluations, recorder.generations, recorder.n_feasible = [1, 2, 3], [1, 2, 3], [0, 1, 2]
    recorder.fronts = [np.empty((0, 2)), np.array([[2.0, 2.0]]), np.array([[1.0, 3.0], [2.0, 2.0]])]
    assert recorder.hypervolume([4, 4]).tolist() == [0.0, 4.0, 5.0]
    assert common_reference_point([recorder]).tolist() == pytest.approx([2.1, 3.1])
    with pytest.raises(GridPathError, match="2 numbers"):
        recorder.hypervolume([4, 4, 4])
    with pytest.raises(GridPathError, match="no run"):
        common_reference_point([ConvergenceRecorder()])
