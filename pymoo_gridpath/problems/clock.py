"""The clock of searches among moving obstacles, which sees to it that no value of an earlier map is returned."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from pymoo.core.callback import Callback
from pymoo.core.evaluator import Evaluator
from pymoo.core.population import Population
from pymoo.problems.dyn import TimeSimulation

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.problems.members import Members
from pymoo_gridpath.problems.moving import MovingObstaclesProblem

# Where pymoo's algorithms keep the members that they go on from, the children of a generation, and the best members.
_OF_POPULATION = ("pop", "off", "opt")


class Faults(NamedTuple):
    """How many members of a population are not what they pass for, of the map that there is now.

    Attributes
    ----------
    stale : int
        Evaluated on another map.
    wrong : int
        With objectives that are others now.
    illegal : int
        Which pass for legal paths and cross an obstacle.
    """

    stale: int
    wrong: int
    illegal: int


class ObstacleClock(TimeSimulation):
    """A callback that lets time pass in a `MovingObstaclesProblem`, and sees to it that no value of an earlier map is returned.

    After each generation but the last it calls the problem's `tic`. An algorithm that is told of changes has its population
    evaluated anew at once when the map changes. Others look for changes themselves, by a few members: what they have
    missed by the end of the next generation is evaluated anew then. So the values in a Result are those of the map that there
    is at the end of the run. pymoo's own `TimeSimulation` lets time pass only, and a Result may hold what was true before.

    At the end of each epoch, and of the run, it keeps what had been found: the legal non-dominated paths among the members,
    as they are on the map of the epoch, whatever the algorithm takes them for.

    Evaluations are counted with the algorithm's own, but for those that only serve to know what had been found.

    Parameters
    ----------
    told : bool, optional
        Whether the algorithm is told. By default those are that do not look for changes themselves, as D-NSGA-II and KGB do.
    renew : bool, default True
        Whether values of earlier maps are evaluated anew. Without it time passes only, as with `TimeSimulation`, to see what
        comes of an algorithm that nobody tells.
    callback : pymoo.core.callback.Callback, optional
        Another one, called after each generation before time passes.

    Attributes
    ----------
    problem : MovingObstaclesProblem or None
        Whose time it is; None before the run.
    n_missed : int
        Members so far that an algorithm had kept with values of an earlier map over a generation.
    epochs : list of int
        Which epochs have ended, in a run from the beginning 0, 1, and so on; the last one with the run.
    F : list of numpy.ndarray, each of shape (n, n_obj)
        What had been found at the end of each. `mean_hypervolume_ratio` and `mean_igd_plus` measure it.
    X : list of numpy.ndarray, each of shape (n, n_var)
        Its genes.
    evaluations : list of int
        Those made until then.
    missed : list of int
        ``n_missed`` of each epoch.
    faults : list of (int, int, int)
        How many members the algorithm had at the end of each with values of another map (``stale``), with objectives that were
        others then (``wrong``), and that passed for legal paths and crossed an obstacle (``illegal``): none, where values are
        renewed. All members are evaluated on the side to know.

    Raises
    ------
    GridPathError
        If an argument is of another kind, or an algorithm is told by a clock that renews nothing; in the run, if the problem
        does not move, an earlier run has left it at a later time, or values are to be renewed in an algorithm that keeps
        further members beside its population.

    Examples
    --------
    >>> import numpy as np
    >>> from pymoo.optimize import minimize
    >>> from pymoo_gridpath import OccupancyGrid
    >>> from pymoo_gridpath.algorithms import make_algorithm
    >>> from pymoo_gridpath.quality import mean_hypervolume_ratio
    >>> problem = MovingObstaclesProblem(OccupancyGrid(np.zeros((3, 5))), [[(2, 2), (2, 1), (2, 0)]], (0, 1), (4, 1), taut=3)
    >>> clock = ObstacleClock()
    >>> result = minimize(problem, make_algorithm("NSGA2", problem, 10), ("n_gen", 9), seed=1, callback=clock)
    >>> clock.epochs, mean_hypervolume_ratio(clock.F, [still.pareto_front() for still in problem.stills])
    ([0, 1, 2], 1.0)
    """

    def __init__(self, told: bool | None = None, renew: bool = True, callback: Callback | None = None):
        super().__init__()
        self.told = told if told is None else checks.flag("told", told)
        self.renew = checks.flag("renew", renew)
        if self.told and not self.renew:
            raise GridPathError("told is True and renew False, expected one of them: what is told has its values renewed")
        self.callback = checks.instance("callback", callback, Callback, " of pymoo", optional=True)
        self.problem: Any = None
        self.n_missed = 0
        self.epochs: list[int] = []
        self.F: list[np.ndarray] = []
        self.X: list[np.ndarray] = []
        self.evaluations: list[int] = []
        self.missed: list[int] = []
        self.faults: list[Faults] = []

    def initialize(self, algorithm: Any) -> None:
        problem = algorithm.problem
        if not isinstance(problem, MovingObstaclesProblem):
            raise GridPathError(
                f"ObstacleClock is for a MovingObstaclesProblem, and the problem is of the class {type(problem).__name__}"
            )
        self.problem = problem
        if problem.ran:
            raise GridPathError(
                f"the problem is where an earlier run has left it, at generation {problem.tau}, expected problem.restart() or "
                "problem.tau = ... before a run"
            )
        if self.renew and _keeps_more(algorithm):
            raise GridPathError(
                f"{type(algorithm).__name__} keeps members beside its population, whose values ObstacleClock cannot renew when "
                "the obstacles move, expected another algorithm"
            )

    def update(self, algorithm: Any) -> None:
        if not self.is_initialized:
            # pymoo's CallbackCollection calls this method alone.
            self.initialize(algorithm)
            self.is_initialized = True
        problem = algorithm.problem
        if self.renew:
            self.n_missed += _renewed(algorithm)
        if self.callback is not None:
            self.callback(algorithm)
        over = algorithm.termination.has_terminated()
        if over or problem.ends:
            self._keep(algorithm)
        if over:
            return
        problem.tic()
        if self.renew and (_is_told(algorithm) if self.told is None else self.told):
            _renewed(algorithm)

    def _keep(self, algorithm: Any) -> None:
        """Keep what has been found on the map of now."""
        problem, pop = algorithm.problem, algorithm.pop
        # On the side, so that the search goes on as it would.
        now = Evaluator().eval(problem, Population.new("X", pop.get("X")))
        members = Members(algorithm, now)
        front = members.front()
        self.epochs.append(problem.epoch)
        self.F.append(members.F[front])
        self.X.append(members.X(front, problem.n_var))
        self.evaluations.append(int(algorithm.evaluator.n_eval))
        self.missed.append(self.n_missed - sum(self.missed))
        self.faults.append(_faults(problem, pop, now))


def _faults(problem: MovingObstaclesProblem, pop: Population, now: Population) -> Faults:
    """Return what is wrong with a population, given the same members as evaluated on the map of now."""
    passing, crossed = (np.asarray(members.get("interfering_cells")) for members in (pop, now))
    wrong = np.any(pop.get("F") != now.get("F"), axis=1)
    illegal = (passing == 0) & (crossed > 0)
    return Faults(*(int(np.count_nonzero(found)) for found in (problem.is_stale(pop), wrong, illegal)))


def _keeps_more(algorithm: Any) -> bool:
    """Return whether an algorithm goes on from members that are not of its population, as C-TAEA does."""
    return any(isinstance(value, Population) for name, value in vars(algorithm).items() if name not in _OF_POPULATION)


def _is_told(algorithm: Any) -> bool:
    """Return whether an algorithm does not look for changes itself; those of pymoo that do know how many members to try."""
    return not any(name.lower() == "perc_detect_change" for name in vars(algorithm))


def _renewed(algorithm: Any) -> int:
    """Evaluate anew the members that were evaluated on another map; return how many these are."""
    problem, pop = algorithm.problem, algorithm.pop
    stale = problem.is_stale(pop)
    if stale.any():
        algorithm.evaluator.eval(problem, pop[stale], skip_already_evaluated=False, algorithm=algorithm)
        survival = getattr(algorithm, "survival", None)
        if survival is not None:
            # Ranks and the like are of the values before.
            algorithm.pop = survival.do(
                problem, pop, n_survive=len(pop), algorithm=algorithm, random_state=algorithm.random_state
            )
        algorithm._set_optimum()
    return int(stale.sum())
