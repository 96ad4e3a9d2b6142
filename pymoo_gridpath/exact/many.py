"""The exact fronts of many problems at once."""

from __future__ import annotations

import functools
from collections.abc import Iterable
from concurrent.futures import Executor

from pymoo_gridpath import checks
from pymoo_gridpath.exact.budget import Budget
from pymoo_gridpath.exact.front import ExactResult, exact_front
from pymoo_gridpath.parallel import carried_out, check_executor
from pymoo_gridpath.representations.base import representation_of


def exact_fronts(
    problems: Iterable,
    budget: Budget | None = None,
    executor: Executor | None = None,
    *,
    epsilon: float | None = None,
    share: float | None = None,
) -> list[ExactResult]:
    """Return the Pareto front of the legal paths of each of many problems.

    Each is that of `exact_front`, bit for bit, whatever carries it out; only a budget of time may end elsewhere.

    Parameters
    ----------
    problems : iterable of GridPathProblem
    budget : Budget, optional
        What each search may use, see `exact_front`. Searches at the same time share the memory of a machine: give each a
        ``max_memory`` where it is scarce. A budget that watches can be sent to threads alone.
    executor : concurrent.futures.Executor, optional
        What carries the searches out, such as a ``ProcessPoolExecutor``; this process by default. Threads are at work at the
        same time only in compiled kernels, the extra ``fast``. It is left open.
    epsilon, share : float, optional
        How far from its front each may be, see `exact_front`.

    Returns
    -------
    list of ExactResult
        In the order of the problems.

    Raises
    ------
    CapabilityError
        As `exact_front`.
    GridPathError
        If one is no path problem; if the executor is none or has broken down, or a problem cannot be sent to a process.

    Examples
    --------
    >>> from concurrent.futures import ThreadPoolExecutor
    >>> from pymoo_gridpath import GridPathProblem, OccupancyGrid
    >>> grid = OccupancyGrid([[0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]])
    >>> problems = [GridPathProblem(grid, (0, 0), goal) for goal in [(3, 3), (3, 1)]]
    >>> with ThreadPoolExecutor(2) as executor:
    ...     [found.F.round(2).tolist() for found in exact_fronts(problems, executor=executor)]
    [[[5.41, 0.66]], [[3.41, 0.66]]]
    """
    problems = checks.items("problems", problems, "path problems")
    for problem in problems:
        representation_of(problem)
    checks.instance("budget", budget, Budget, optional=True)
    check_executor(executor)
    one = functools.partial(exact_front, epsilon=epsilon, share=share)
    if executor is None:
        return [one(problem, budget) for problem in problems]
    return list(carried_out(executor, "the front of problem", one, [(problem, budget) for problem in problems]))
