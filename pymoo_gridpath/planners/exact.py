"""The exact front as a pymoo algorithm."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

from pymoo_gridpath.exact import Budget, exact_front
from pymoo_gridpath.exact.budget import Meter
from pymoo_gridpath.planners.base import Plan, Planner
from pymoo_gridpath.registry import register


@register
class ExactFront(Planner):
    """Find the whole Pareto front of a path problem in one step.

    ``minimize(problem, ExactFront())`` returns a Result that holds every point of the front of the legal paths, each once,
    with a path for it. No random number is drawn, and ``seed`` and termination do not matter. The paths are evaluated by the
    problem like those of any other algorithm, so ``n_eval`` is their number.

    Parameters
    ----------
    max_seconds : float, optional
    max_labels : int, optional
    max_memory : int, optional
    watch : callable, optional
        Budgets, see `Budget`. When one is used up, the Result holds the best paths found by then, ``result.success`` is
        False, and ``result.message`` says which budget it was. The algorithm lets go of ``watch`` when the search has ended,
        so that a Result can be pickled whatever it was.
    **kwargs
        What every pymoo algorithm takes, such as ``callback``.

    Attributes
    ----------
    found : ExactResult
        The front and how the search went, once it has run.

    Raises
    ------
    CapabilityError
        If an argument is unknown; when the run begins, if an objective does not add up along a path or there are more than
        three, see `exact_front`.

    References
    ----------
    See `front_of_two` and `front_of_three`.

    Examples
    --------
    >>> from pymoo.optimize import minimize
    >>> from pymoo_gridpath import GridPathProblem, OccupancyGrid
    >>> grid = OccupancyGrid([[0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]], corner_cutting=True)
    >>> result = minimize(GridPathProblem(grid, (0, 0), (3, 3)), ExactFront())
    >>> result.F.round(2).tolist(), result.message
    ([[4.83, 0.88], [5.41, 0.66]], 'all 2 points found')
    """

    name = "exact"
    reference = True
    in_time = True

    def __init__(
        self,
        max_seconds: float | None = None,
        max_labels: int | None = None,
        max_memory: int | None = None,
        watch: Callable[[Meter], bool] | None = None,
        **kwargs,
    ):
        super().__init__(**kwargs)
        self.budget = Budget(max_seconds, max_labels, max_memory, watch)

    def plan(self, problem) -> Plan:
        self.found = exact_front(problem, self.budget)
        self.budget = dataclasses.replace(self.budget, watch=None)
        return Plan(self.found.X, self.found.complete, self.found.message)
