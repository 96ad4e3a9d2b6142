"""The planner of Ahmed and Deb (2013), with the paper's parameters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from pymoo.core.algorithm import Algorithm
from pymoo.core.termination import Termination
from pymoo.termination.max_gen import MaximumGenerationTermination

from pymoo_gridpath import checks
from pymoo_gridpath.algorithms.factory import make_algorithm
from pymoo_gridpath.fields import PAPER_VARIANCE
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.objectives import Objective, Vulnerability, make_objectives
from pymoo_gridpath.operators import paper_operators
from pymoo_gridpath.problems import GridPathProblem

#: Members of a population, generations of a run, and what an interfering cell adds to every objective, in the paper.
POP_SIZE, N_GEN, PENALTY = 500, 500, 1.0
#: The coding that the paper found best.
REPRESENTATION = "integer"


_VULNERABILITY = Vulnerability(variance=PAPER_VARIANCE)


class Setup(NamedTuple):
    """What `pymoo.optimize.minimize` takes, in its order.

    Attributes
    ----------
    problem : GridPathProblem
    algorithm : pymoo.core.algorithm.Algorithm
    termination : pymoo.core.termination.Termination
    """

    problem: GridPathProblem
    algorithm: Algorithm
    termination: Termination


def ahmed_deb_2013(
    grid: OccupancyGrid,
    start: Sequence[int],
    goal: Sequence[int],
    representation: str = REPRESENTATION,
    objectives: Sequence[str | Objective] | str = ("length", "vulnerability"),
    pop_size: int = POP_SIZE,
    n_gen: int = N_GEN,
    penalty: float | None = None,
    termination: Termination | None = None,
    **problem_options,
) -> Setup:
    """Return a run of the paper, ready for pymoo.

    ``minimize(*ahmed_deb_2013(grid, start, goal), seed=1)`` is one run. The paper merges ten:
    `pymoo_gridpath.algorithms.minimize_runs`.

    Two objectives: the modified NSGA-II, obstacles as penalty, crossover rate 0.9 with index 10, mutation rate 1 / n with
    index 20 (sections 5.1 and 5.2). Three objectives: the same with the original NSGA-II, where crowding alone decides
    within a rank (section 5.6). One objective: a genetic algorithm with obstacles as constraint and crossover index 2
    (section 5.5).

    Parameters
    ----------
    grid : OccupancyGrid
        The paper's grids have ``corner_cutting=True``.
    start, goal : (int, int)
        Cells (x, y); in the paper the bottom-left and the top-right corner.
    representation : {"integer", "binary", "mixed", "absolute", "sugihara-smith"}, default "integer"
        The last is not the paper's, but the one that it improves on (section 2.1).
    objectives : sequence of str or Objective, default ("length", "vulnerability")
        By the name "vulnerability" the paper's is meant, whatever the map: `Vulnerability` with a variance of 0.5 squared
        cells.
    pop_size : int, default 500
        The paper takes 500, and 200 for Table 1.
    n_gen : int, default 500
        Number of generations.
    penalty : float, optional
        What an interfering cell adds to every objective. By default 1, for the paper penalises "the objective(s) with the count
        of interfering cells" (section 4.1) and names no other weight; with another way to treat obstacles, that of
        `GridPathProblem`.
    termination : pymoo termination, optional
        In place of ``n_gen``, such as `FirstLegalPath` for Table 1.
    **problem_options
        Further arguments of `GridPathProblem`, such as ``obstacles`` or ``axis``.

    Returns
    -------
    Setup
        ``(problem, algorithm, termination)``.

    Raises
    ------
    GridPathError
        If an argument is out of its range, see `GridPathProblem`.

    References
    ----------
    F. Ahmed and K. Deb, "Multi-objective optimal path planning using elitist non-dominated sorting genetic algorithms",
    Soft Computing 17(7), 2013.
    """
    for name, value in (("pop_size", pop_size), ("n_gen", n_gen)):
        checks.whole(name, value, 1)
    checks.instance("termination", termination, Termination, " of pymoo", optional=True)
    # Of which nothing is said is the paper's.
    made = [_VULNERABILITY if type(one) is Vulnerability and not vars(one) else one for one in make_objectives(objectives)]
    obstacles, penalty = paper_treatment(len(made), problem_options.pop("obstacles", None), penalty)
    problem = GridPathProblem(grid, start, goal, representation, made, obstacles, penalty, **problem_options)
    if len(made) == 1:
        algorithm = make_algorithm("GA", problem, pop_size, operators=paper_operators(problem, eta_crossover=2.0))
    else:
        algorithm = make_algorithm("NSGA2", problem, pop_size, smoothness=len(made) == 2)
    return Setup(problem, algorithm, termination or MaximumGenerationTermination(n_gen))


def paper_treatment(n_obj: int, obstacles: str | None = None, penalty: float | None = None) -> tuple[Any, float | None]:
    """Return how the paper treats obstacles, and what an interfering cell costs, where neither is given.

    Parameters
    ----------
    n_obj : int
        Number of objectives; with one, obstacles are a constraint (section 5.5), else a penalty (section 4.1).
    obstacles, penalty : optional
        What is given instead.
    """
    obstacles = ("constraint" if n_obj == 1 else "penalty") if obstacles is None else obstacles
    return obstacles, PENALTY if penalty is None and obstacles == "penalty" else penalty
