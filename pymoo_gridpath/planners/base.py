"""What every planner is that is no evolutionary search: a pymoo algorithm that plans once, or better and better."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, NamedTuple

import numpy as np
from pymoo.core.algorithm import Algorithm
from pymoo.core.population import Population

from pymoo_gridpath import checks
from pymoo_gridpath.errors import CapabilityError, GridPathError, counted
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.planners.display import PathOutput
from pymoo_gridpath.planners.ending import UntilPlanned
from pymoo_gridpath.planners.signature import parameters_of, refuse_unknown
from pymoo_gridpath.problems.members import are_legal
from pymoo_gridpath.registry import Registry, key_of
from pymoo_gridpath.representations.base import representation_of


class Plan(NamedTuple):
    """What a planner has found.

    Attributes
    ----------
    paths : Sequences or numpy.ndarray
        Legal paths, none or any number: the cells that they visit, or rows of genes of shape (N, n_var).
    success : bool
        Whether the planner has done what it promises; it may be that there is no path to be found.
    message : str
        How the search went, a few words without an end mark, such as "all 2 points found".
    final : bool
        Whether no better one follows, see `Planner.plans`.
    """

    paths: Sequences | np.ndarray
    success: bool = True
    message: str = ""
    final: bool = True


class Planner(Algorithm, ABC):
    """Base of the planners that are no evolutionary searches.

    A planner of one's own has a method `plan`, and arguments of its constructor that are keywords, of which it hands on those
    that it does not know. All else is here: it is called once, its paths are checked, coded, and evaluated by the problem like
    those of any other algorithm, and the Result says how it went, ``result.success`` and ``result.message``. One that finds
    better and better paths may hand them over on the way, by `plans`. Seeds count where it draws from ``self.random_state``,
    terminations do not, but for ``algorithm.termination.terminate()`` between two plans. One that is registered, see
    `pymoo_gridpath.registry.register`, is known by its name to `make_algorithm`, studies and the command line.

    Parameters
    ----------
    **kwargs
        What every pymoo algorithm takes, such as ``callback``.

    Attributes
    ----------
    name : str
        Class attribute: what it is called by name; by default the name of the class.
    deterministic : bool
        Class attribute: whether it draws no random number, so that a study needs one run of it. Default True.
    reference : bool
        Class attribute: whether a Result with ``success`` is the whole front, which others are measured against. Default False.
    loosening : tuple of str
        Class attribute: the arguments of its constructor by which, if one is given, it is content with less than the whole
        front, so that it is no reference. Default none.
    turns_back : bool
        Class attribute: whether its paths may turn back along every axis, so that it refuses codings of paths that never do.
        Default False.
    goes_diagonally : bool
        Class attribute: whether it plans by diagonal steps, so that it refuses grids without any. Default False.
    takes_operators, takes_pop_size : bool
        Class attributes: whether its constructor takes ``operators`` and ``pop_size``, as `make_algorithm` does. Default False.
    in_time : bool
        Class attribute: whether it plans paths in time, too, among obstacles that move. Default False.
    takes_generations : bool
        Class attribute: False, since it plans once.
    success, message
        As in the `Plan`, once it has run.

    Raises
    ------
    CapabilityError
        If an argument is unknown; when the run begins, if the paths may turn back and the coding knows none that do, if it
        plans by diagonal steps and the grid has none, or if obstacles move of which the planner knows nothing.
    GridPathError
        When the run begins, if the problem is no path problem; when the paths are there, if one is not legal.

    Examples
    --------
    >>> from pymoo.optimize import minimize
    >>> from pymoo_gridpath import GridPathProblem, OccupancyGrid
    >>> import numpy as np
    >>> class Straight(Planner):
    ...     def plan(self, problem):
    ...         n = problem.goal[0] + 1
    ...         row = problem.start[1] * problem.grid.width
    ...         return Plan(Sequences(np.arange(row, row + n), np.array([0, n])), message="went straight on")
    >>> problem = GridPathProblem(OccupancyGrid([[0, 0, 0], [0, 1, 0], [0, 0, 0]]), (0, 0), (2, 0))
    >>> result = minimize(problem, Straight())
    >>> result.F.round(2).tolist(), result.message
    ([[2.0, 0.64]], 'went straight on')
    """

    deterministic: ClassVar[bool] = True
    reference: ClassVar[bool] = False
    loosening: ClassVar[tuple[str, ...]] = ()
    turns_back: ClassVar[bool] = False
    goes_diagonally: ClassVar[bool] = False
    takes_operators: ClassVar[bool] = False
    takes_pop_size: ClassVar[bool] = False
    takes_generations: ClassVar[bool] = False
    in_time: ClassVar[bool] = False

    # pymoo fills it when the run begins.
    termination: Any

    def __init__(self, **kwargs):
        refuse_unknown(type(self).__name__, kwargs, self.parameters())
        # It finds its paths at once: there is no way to show.
        super().__init__(output=kwargs.pop("output", PathOutput(distance=False)), **kwargs)
        # The plans to come, while it is at work.
        self._plans: Iterator[Plan] | None = None

    @classmethod
    def parameters(cls) -> dict[str, Any]:
        """Return what the constructor takes, with the defaults, for whoever knows the planner by its name alone."""
        return parameters_of(cls)

    @classmethod
    def refuse(cls, problem) -> None:
        """Raise a CapabilityError if the planner cannot plan for a problem."""
        coding = representation_of(problem)
        if coding.timed and not cls.in_time:
            raise CapabilityError(
                f"{cls.__name__} plans paths on a map that stands still, and obstacles of a {type(problem).__name__} move; "
                f"expected a planner that knows of time, such as {reference_planner()!r}, or a search with "
                f"path_operators(problem)"
            )
        if cls.goes_diagonally and not coding.grid.neighbourhood.diagonal:
            raise CapabilityError(
                f"{cls.__name__} plans by diagonal steps, and the grid {checks.shown(coding.grid.name)} has none; give it "
                f"moves=8"
            )
        if cls.turns_back and coding.monotone:
            raise CapabilityError(
                f"{cls.__name__} plans paths that may turn back, which the {problem.representation.name} representation cannot "
                f"code; give the problem representation='cells'"
            )

    @abstractmethod
    def plan(self, problem) -> Plan:
        """Return paths for a problem.

        Parameters
        ----------
        problem : GridPathProblem
            With its ``grid``, ``start``, ``goal``, ``objectives`` and ``representation``, whose ``moves`` are the legal steps.

        Returns
        -------
        Plan
            Legal paths: from the start to the goal, by legal steps and, with ``obstacles="limit"``, within the potential limit.
        """

    def plans(self, problem) -> Iterator[Plan]:
        """Yield plans for a problem, better and better ones, the last of which is ``final``: by default the one of `plan`.

        Each is an iteration of the run. A copy, or what was pickled, on the way begins anew when it goes on.
        """
        yield self.plan(problem)

    def _setup(self, problem, **kwargs):
        self.termination = UntilPlanned(self.termination)

    def __getstate__(self):
        # A search under way cannot be copied.
        return self.__dict__ | {"_plans": None}

    def _initialize_infill(self):
        self.refuse(self.problem)
        return self._infill()

    def _infill(self):
        representation = representation_of(self.problem)
        if self._plans is None:
            self._plans = self.plans(self.problem)
        plan = next(self._plans, None)
        if not isinstance(plan, Plan):
            # As it does, too, where the last was not final.
            raise GridPathError(f"the planner {self._name} returned {checks.shown(plan)}, expected a Plan")
        self.success = checks.flag(f"the success of the planner {self._name}", plan.success)
        self.message = checks.text(f"the message of the planner {self._name}", plan.message)
        if checks.flag(f"whether the plan of the planner {self._name} is final", plan.final):
            self.termination.terminate()
            self._plans = None
        X = plan.paths
        if isinstance(X, Sequences):
            try:
                X = representation.from_sequences(X)
            except GridPathError as error:
                raise GridPathError(f"the planner {self._name} returned what is no path of the problem: {error}") from error
        expected = f"Sequences, or rows of {representation.n_var} genes"
        X = checks.array(f"what the planner {self._name} returned", X, (None, representation.n_var), expected=expected)
        return Population.new("X", X)

    def _initialize_advance(self, infills=None, **kwargs):
        self._advance(infills)

    def _advance(self, infills=None, **kwargs):
        self._refuse_illegal(infills)
        self.pop = infills

    def _refuse_illegal(self, pop) -> None:
        if not len(pop):
            return
        crossed, violation = np.asarray(pop.get("interfering_cells")), np.asarray(pop.get("CV"), dtype=float)
        illegal = np.flatnonzero(~are_legal(crossed, violation.reshape(len(pop), -1).max(axis=1)))
        if len(illegal):
            number = illegal[0]
            what = "crosses an obstacle or makes a step that is not legal" if crossed[number] else "exceeds the limit"
            raise GridPathError(
                f"the planner {self._name} returned {counted(len(pop), 'path')} of which number {number} {what}, "
                f"expected legal paths"
            )

    def _set_optimum(self):
        # All of them: a planner returns what it stands for, and pymoo's filter would compare every path with every other.
        self.opt = self.pop

    def result(self):
        result: Any = super().result()
        result.success, result.message = self.success, self.message
        return result

    @property
    def _name(self) -> str:
        return type(self).__name__


def settled(problem, sequences: Sequences, message: str) -> Plan:
    """Return the plan of those of some paths that have a code and keep the limit of a problem, with a message that says so.

    For planners that look at neither.

    Parameters
    ----------
    problem : GridPathProblem
    sequences : Sequences
        N legal paths, by the indices of cells that the representation's ``moves`` has.
    message : str

    Returns
    -------
    Plan
        A success if a path is left.
    """
    representation, n = problem.representation, len(sequences.lengths)
    fits = representation.fits(sequences)
    if not fits.all():
        longest = sequences.lengths.max()
        message += (
            f"; {n - fits.sum()} of {counted(n, 'path')} left out, the longest visits {longest} cells, a row has room for "
            f"{representation.max_cells}"
        )
    X = representation.from_sequences(sequences.take(fits))
    if problem.obstacles == "limit" and len(X):
        keeps = problem.evaluate(X, return_values_of=["G"])[:, 0] <= 0
        if not keeps.all():
            message += f"; {len(X) - keeps.sum()} of {counted(n, 'path')} left out, over the potential limit"
        X = X[keeps]
    return Plan(X, len(X) > 0, message)


#: The planners that are known by name, see `pymoo_gridpath.registry`; spelling and the name of the class are as good.
PLANNERS: Registry[type[Planner]] = Registry("planner", "pymoo_gridpath.planners", Planner, error=CapabilityError, key=key_of)


def is_reference(cls: type, arguments: Mapping[str, Any]) -> bool:
    """Whether a success of an algorithm or planner that is given some arguments is the whole front.

    Its ``capability``, if it has one, says what its class does not.
    """
    says = getattr(cls, "capability", cls)
    loose = any(arguments.get(name) is not None for name in getattr(says, "loosening", ()))
    return bool(getattr(says, "reference", False)) and not loose


def reference_planner() -> str:
    """Return the name of the planner whose results others are measured against."""
    return next(name for name in PLANNERS if PLANNERS[name].reference)
