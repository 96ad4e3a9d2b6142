"""Populations larger than the search space, and maps of one row or two columns: every algorithm ends."""

import warnings

import numpy as np
import pytest
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import CAPABILITIES, make_algorithm
from pymoo_gridpath.errors import CapabilityError


@pytest.mark.timeout(120)
@pytest.mark.parametrize("name", CAPABILITIES)
def test_every_algorithm_ends_on_tiny_maps(name):
    row = CAPABILITIES[name]
    for obstacles, width, height in (("penalty", 4, 1), ("constraint", 2, 5), ("constraint", 4, 4)):
        objectives = ("length",) if name == "GA" else ("length", "vulnerability")
        occupied = np.zeros((height, width), dtype=bool)
        problem = GridPathProblem(OccupancyGrid(occupied), (0, 0), (width - 1, height - 1), "integer", objectives, obstacles)
        given = {"ref_points": [[5.0, 1.0]]} if row.needs == "ref_points" else {}
        try:
            algorithm = make_algorithm(name, problem, pop_size=30, **given)
        except CapabilityError:
            continue
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            result = minimize(problem, algorithm, ("n_gen", 2), seed=1)
        assert result.X is not None, (width, height, obstacles)


@pytest.mark.parametrize(
    ("name", "given", "least"),
    [("GDE3", {}, 4), ("NSDE", {}, 4), ("NSDE", {"variant": "DE/rand/2/bin"}, 6), ("OmniOptimizer", {}, 1), ("NSGA2", {}, 1)],
)
def test_populations_too_small_to_end_are_refused(name, given, least):
    problem = GridPathProblem(OccupancyGrid(np.zeros((6, 6))), (0, 0), (5, 5), "integer")
    with pytest.raises(CapabilityError, match=f"expected a whole number of at least {least} and at most"):
        make_algorithm(name, problem, pop_size=least - 1, **given)
    assert minimize(problem, make_algorithm(name, problem, pop_size=least, **given), ("n_gen", 2), seed=1).pop is not None
