"""The recipe of the documentation for going on exactly: by pickle, with every algorithm that can be pickled."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import CAPABILITIES, make_algorithm

# Others want points of the user's, or solve no problem on a grid.
ABLE = [name for name, row in CAPABILITIES.items() if not row.unfit and row.needs in ("", "ref_dirs")]


def begun(name):
    objectives = ["length", "vulnerability"][: CAPABILITIES[name].max_objectives]
    problem = GridPathProblem(OccupancyGrid(np.zeros((6, 6))), (0, 0), (5, 5), objectives=objectives)
    return make_algorithm(name, problem, pop_size=10).setup(problem, termination=("n_gen", 5), seed=1)


def gone_on(algorithm, generations):
    for _ in range(generations):
        algorithm.next()
    return algorithm


@pytest.mark.parametrize("name", [name for name in ABLE if CAPABILITIES[name].pickles])
def test_what_was_pickled_goes_on_as_if_it_had_not_stopped(name):
    continued = gone_on(pickle.loads(pickle.dumps(gone_on(begun(name), 2))), 3)
    at_once = gone_on(begun(name), 5)
    for what in ("X", "F"):
        np.testing.assert_array_equal(continued.pop.get(what), at_once.pop.get(what))


@pytest.mark.parametrize("name", [name for name in ABLE if not CAPABILITIES[name].pickles])
def test_the_others_say_so(name):
    with pytest.raises(Exception, match="pickle"):
        pickle.dumps(gone_on(begun(name), 2))
