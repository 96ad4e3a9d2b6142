"""Populations larger than the search space, and maps of one row or two columns: every algorithm ends."""

import subprocess
import sys

import pytest

PROGRAM = """
import sys
import numpy as np
from pymoo.optimize import minimize
from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import CAPABILITIES, make_algorithm
from pymoo_gridpath.errors import CapabilityError

for name, row in CAPABILITIES.items():
    for width, height in ((3, 3), (4, 1), (2, 5), (4, 4)):
        for obstacles in ("penalty", "constraint"):
            objectives = ("length",) if name == "GA" else ("length", "vulnerability")
            occupied = np.zeros((height, width), dtype=bool)
            problem = GridPathProblem(
                OccupancyGrid(occupied), (0, 0), (width - 1, height - 1), "integer", objectives, obstacles
            )
            given = {"ref_points": [[5.0, 1.0]]} if row.needs == "ref_points" else {}
            try:
                algorithm = make_algorithm(name, problem, pop_size=30, **given)
            except CapabilityError:
                continue
            result = minimize(problem, algorithm, ("n_gen", 3), seed=1)
            assert result.X is not None, (name, width, height, obstacles)
    print(name, flush=True)
"""


def test_every_algorithm_ends_on_tiny_maps():
    try:
        done = subprocess.run([sys.executable, "-W", "ignore", "-c", PROGRAM], capture_output=True, text=True, timeout=900)
    except subprocess.TimeoutExpired as stuck:
        output = stuck.stdout.decode() if isinstance(stuck.stdout, bytes) else stuck.stdout or ""
        pytest.fail(f"did not end; the last to end was {output.split()[-1:]}")
    assert done.returncode == 0, done.stderr[-2000:]


@pytest.mark.parametrize(
    ("name", "given", "least"),
    [("GDE3", {}, 4), ("NSDE", {}, 4), ("NSDE", {"variant": "DE/rand/2/bin"}, 6), ("OmniOptimizer", {}, 1), ("NSGA2", {}, 1)],
)
def test_populations_too_small_to_end_are_refused(name, given, least):
    import numpy as np
    from pymoo.optimize import minimize

    from pymoo_gridpath import GridPathProblem, OccupancyGrid
    from pymoo_gridpath.algorithms import make_algorithm
    from pymoo_gridpath.errors import CapabilityError

    problem = GridPathProblem(OccupancyGrid(np.zeros((6, 6))), (0, 0), (5, 5), "integer")
    with pytest.raises(CapabilityError, match=f"expected a whole number of at least {least} and at most"):
        make_algorithm(name, problem, pop_size=least - 1, **given)
    assert minimize(problem, make_algorithm(name, problem, pop_size=least, **given), ("n_gen", 2), seed=1).pop is not None
