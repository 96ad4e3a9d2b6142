"""The exact front as a pymoo algorithm."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from typing import Any

import numpy as np
from pymoo.core.population import Population

from pymoo_gridpath.compiled import is_ctrl_c
from pymoo_gridpath.exact import Budget, ExactResult
from pymoo_gridpath.exact.budget import Meter
from pymoo_gridpath.exact.front import better_fronts, check_front_is_known
from pymoo_gridpath.exact.nearness import Allowance
from pymoo_gridpath.exact.steps import handed_over
from pymoo_gridpath.interrupt import StopOnCtrlC, ctrl_c_raises
from pymoo_gridpath.planners.base import Plan, Planner
from pymoo_gridpath.planners.display import FrontOutput
from pymoo_gridpath.planners.ending import UntilPlanned
from pymoo_gridpath.registry import register


@register
class ExactFront(Planner):
    """Find the whole Pareto front of a path problem, or paths that are proven to come near to it.

    ``minimize(problem, ExactFront())`` returns a Result that holds every point of the front of the legal paths, each once,
    with a path for it, or, with ``epsilon`` or ``share``, paths near to it. Its ``certified`` is a `Certificate`: how near they
    are proven to be, 0 for the whole front; None where nothing is proven. No random number is drawn, and ``seed`` does not
    matter.

    A search of more than a few dozen milliseconds hands over what it has found on the way, in an iteration each: ``opt`` and
    ``found`` are better and better for a callback, and ``verbose=True`` prints how many points there are, how near they are
    certified to be, the labels of the search and its seconds. Of two objectives these are the ends of the front, points of its
    hull, and more; of three, larger and larger parts of the front; of one, of paths in time, and where the worst cell of a path
    decides, the front comes at once. The paths are evaluated by the problem like those of any other algorithm.

    Ctrl-C in ``minimize`` ends the search with what it has found, and ``result.message`` says so; a second one is not caught.
    So does a KeyboardInterrupt that a callback raises. Of terminations a time counts, like ``max_seconds``, and
    ``algorithm.termination.terminate()``; numbers of generations or evaluations do not. Step by step, by ``next()``, Ctrl-C
    raises as ever.

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
        The front and how the search went, once it has run; on the way what is known so far.

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
        super().__init__(output=kwargs.pop("output", FrontOutput()), **kwargs)
        self.budget = Budget(max_seconds, max_labels, max_memory, watch)
        self.allowance = Allowance(epsilon, share)
        self._ctrl_c: StopOnCtrlC | None = None

    @classmethod
    def refuse(cls, problem) -> None:
        super().refuse(problem)
        check_front_is_known(problem)

    def plan(self, problem) -> Plan:
        *_, plan = self.plans(problem)
        return plan

    def plans(self, problem) -> Iterator[Plan]:
        budget = dataclasses.replace(self.budget, watch=self._watched(self.budget.watch))
        # Whatever it was, it does not go into a Result, nor into a history.
        self.budget = dataclasses.replace(self.budget, watch=None)
        if isinstance(self.termination, UntilPlanned):
            left = self.termination.seconds_left(self)
            if left is not None and left < (np.inf if budget.max_seconds is None else budget.max_seconds):
                budget = dataclasses.replace(budget, max_seconds=round(left, 3))
        for found, final in handed_over(better_fronts(problem, budget, **vars(self.allowance))):
            self.found = found
            yield Plan(found.X, found.success, found.message, final)

    def _watched(self, watch: Callable[[Meter], bool] | None) -> Callable[[Meter], bool]:
        """Return what watches a search: who was given with the budget, Ctrl-C, and the termination."""

        def watched(meter: Meter) -> bool:
            if self._ctrl_c is not None and self._ctrl_c.requested:
                meter.message = "stopped by Ctrl-C"
            elif self.termination is not None and self.termination.force_termination:
                meter.message = "stopped by its termination"
            return bool(meter.message) or (watch is not None and watch(meter))

        return watched

    def run(self):
        with StopOnCtrlC() if ctrl_c_raises() else nullcontext() as self._ctrl_c:
            try:
                return super().run()
            except BaseException as error:
                twice = self._ctrl_c is not None and self._ctrl_c.requested
                if not is_ctrl_c(error) or twice or self.start_time is None:
                    raise
                self._keep()
                return self.result()
            finally:
                self._ctrl_c = None

    def _keep(self) -> None:
        """End the run, whatever it was at, with what was handed over last."""
        problem: Any = self.problem
        found = getattr(self, "found", None)
        if found is None:
            X, F = np.empty((0, problem.n_var)), np.empty((0, problem.n_obj))
            found = ExactResult(X, F, False, False, None, "0 paths found", 0, 0, 0.0)
        message = found.message if found.complete else f"ended early, stopped by Ctrl-C; {found.message}"
        self.found, self.success, self.message = dataclasses.replace(found, message=message), found.success, message
        if self.pop is None or not np.array_equal(np.asarray(self.pop.get("X")), found.X):
            self.pop = self.evaluator.eval(problem, Population.new("X", found.X), algorithm=self)
        self._set_optimum()
        self._plans = None
        self.termination.terminate()
        self.termination.update(self)
        self.finalize()

    def result(self):
        result = super().result()
        result.certified = self.found.certified
        return result
