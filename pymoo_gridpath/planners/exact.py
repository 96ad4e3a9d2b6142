"""The exact front as a pymoo algorithm."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

from pymoo_gridpath.exact import Budget, exact_front
from pymoo_gridpath.exact.budget import Meter
from pymoo_gridpath.exact.nearness import Allowance
from pymoo_gridpath.planners.base import Plan, Planner
from pymoo_gridpath.registry import register


@register
class ExactFront(Planner):
    """Find the whole Pareto front of a path problem in one step, or paths that are proven to come near to it.

    ``minimize(problem, ExactFront())`` returns a Result that holds every point of the front of the legal paths, each once,
    with a path for it, or, with ``epsilon`` or ``share``, paths near to it. Its ``certified`` is a `Certificate`: how near they
    are proven to be, 0 for the whole front; None where nothing is proven. No random number is drawn, and ``seed`` and
    termination do not matter. The paths are evaluated by the problem like those of any other algorithm, so ``n_eval`` is their
    number.

    Parameters
    ----------
    max_seconds : float, optional
    max_labels : int, optional
    max_memory : int, optional
    watch : callable, optional
        Budgets, see `Budget`. When one is used up, the Result holds the best paths found by then, ``result.success`` is
        False, and ``result.message`` says which budget it was. The algorithm lets go of ``watch`` when the search has ended,
        so that a Result can be pickled whatever it was.
    epsilon, share : float, optional
        How near is near enough, see `exact_front`. ``result.success`` is True once that is reached.
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
        three, or nothing near the front can be certified, see `exact_front`.
    GridPathError
        If a number is out of its range, or ``epsilon`` and ``share`` are both given.

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
    >>> near = minimize(GridPathProblem(grid, (0, 0), (3, 3)), ExactFront(epsilon=0.5))
    >>> near.message, near.success
    ('2 paths found, within 12.2 % of the front', True)
    """

    name = "exact"
    reference = True
    in_time = True
    loosening = ("epsilon", "share")

    def __init__(
        self,
        max_seconds: float | None = None,
        max_labels: int | None = None,
        max_memory: int | None = None,
        watch: Callable[[Meter], bool] | None = None,
        epsilon: float | None = None,
        share: float | None = None,
        **kwargs,
    ):
        super().__init__(**kwargs)
        self.budget = Budget(max_seconds, max_labels, max_memory, watch)
        self.allowance = Allowance(epsilon, share)

    def plan(self, problem) -> Plan:
        self.found = exact_front(problem, self.budget, epsilon=self.allowance.epsilon, share=self.allowance.share)
        self.budget = dataclasses.replace(self.budget, watch=None)
        return Plan(self.found.X, self.found.success, self.found.message)

    def result(self):
        result = super().result()
        result.certified = self.found.certified
        return result
