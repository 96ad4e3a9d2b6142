"""Ants and bees: rivals of region of sight on `ShorteningProblem`, beside the particle swarm that pymoo has."""

from __future__ import annotations

import importlib
import logging
from typing import Any

import numpy as np
from pymoo.core.algorithm import Algorithm
from pymoo.core.individual import Individual
from pymoo.core.population import Population
from pymoo.util.display.single import SingleObjectiveOutput
from pymoo.util.optimum import filter_optimum

from pymoo_gridpath import checks
from pymoo_gridpath.checks import shown
from pymoo_gridpath.errors import CapabilityError, GridPathError
from pymoo_gridpath.planners.signature import parameters_of, refuse_unknown
from pymoo_gridpath.problems.shortening import ShorteningProblem

# The pheromone of no edge falls below this share of the most.
_LEAST_PHEROMONE = 1e-3

# NiaPy's bees search at half as many sources as there are bees, and compare each with another one.
_LEAST_BEES = 4


class _Colony(Algorithm):
    """An algorithm of pymoo's kind that refuses what it does not know, and keeps the best that it has ever found.

    Parameters
    ----------
    pop_size : int
    least : int
        The least that it can be.
    """

    # pymoo fills them when the run begins.
    problem: Any
    pop: Any
    off: Any
    random_state: Any

    def __init__(self, pop_size: int, least: int, **kwargs):
        refuse_unknown(type(self).__name__, kwargs, parameters_of(type(self)))
        super().__init__(output=kwargs.pop("output", SingleObjectiveOutput()), **kwargs)
        self.pop_size = checks.whole("pop_size", pop_size, least)

    def _set_optimum(self):
        # The best may be gone from the population.
        self.opt = filter_optimum(self.off if self.opt is None else Population.merge(self.opt, self.off))


class AntColony(_Colony):
    """An ant colony on the visibility graph of the road of a `ShorteningProblem`.

    Cells of the road are the nodes, and an edge leads from each to all further on that it sees. An ant walks from the start
    along edges, each drawn with a probability in proportion to its pheromone, times a power of what it promises: one cell and
    what the line saves of the road. After as many edges as the problem has genes it follows the road, or the line if it sees
    the goal; nowhere else does it follow the road out of sight. Pheromone evaporates, and the best ant so far renews it along
    its edges; none falls below a thousandth of the most, so that no edge is ever out of the question.

    All ants of an iteration walk at once. The pairs of cells that see one another are found beforehand, by as many tests as
    there are pairs, which are no evaluations: with them, dynamic programming has the optimum at once, see `ShorteningProblem`.

    Parameters
    ----------
    pop_size : int, default 25
        Ants of an iteration.
    evaporation : float, default 0.1
        The share of the pheromone that goes in an iteration, above 0, at most 1.
    beta : float, default 2
        The power of what an edge promises, 0 or more.
    **kwargs
        What every pymoo algorithm takes, such as ``callback``.

    Raises
    ------
    CapabilityError
        If an argument is unknown; when the run begins, if the problem is another one.
    GridPathError
        If an argument is of another kind or out of its range.

    References
    ----------
    M. Dorigo, V. Maniezzo and A. Colorni, "Ant system: optimization by a colony of cooperating agents", *IEEE Transactions on
    Systems, Man, and Cybernetics B* 26(1):29-41, 1996, for the walk. T. Stützle and H. H. Hoos, "MAX-MIN ant system", *Future
    Generation Computer Systems* 16(8):889-914, 2000, for the best ant and the floor. C. Blum and M. Dorigo, "The hyper-cube
    framework for ant colony optimization", *IEEE Transactions on Systems, Man, and Cybernetics B* 34(2):1161-1172, 2004, for
    pheromone from 0 to 1.

    Examples
    --------
    >>> from pymoo.optimize import minimize
    >>> from pymoo_gridpath import OccupancyGrid
    >>> occupied = np.zeros((8, 9))
    >>> occupied[:4, 4] = 1
    >>> road = [(1, y) for y in range(1, 7)] + [(x, 6) for x in range(2, 8)] + [(7, y) for y in range(5, 1, -1)]
    >>> problem = ShorteningProblem(OccupancyGrid(occupied), road, n_points=2)
    >>> result = minimize(problem, AntColony(), ("n_gen", 10), seed=1)
    >>> result.F.round(3).tolist(), result.algorithm.evaluator.n_eval
    ([10.831], 250)
    """

    def __init__(self, pop_size: int = 25, evaporation: float = 0.1, beta: float = 2.0, **kwargs):
        super().__init__(pop_size, 1, **kwargs)
        expected = "a number above 0 and at most 1"
        self.evaporation = checks.number("evaporation", evaporation, 0.0, 1.0, above=True, expected=expected)
        self.beta = checks.number("beta", beta, 0.0, expected="a number, zero or more")

    def _setup(self, problem, **kwargs):
        if not isinstance(problem, ShorteningProblem):
            raise CapabilityError(f"AntColony walks on the road of a ShorteningProblem, the problem is {shown(problem)}")
        cells, along = problem.moves.cells(problem.road), problem.travelled
        straight = np.hypot(*np.moveaxis(cells[None] - cells[:, None], -1, 0))
        promise = np.where(problem.sight, 1.0 + np.maximum(along[None] - along[:, None] - straight, 0.0), 0.0)
        # As shares of the most, lest large powers be beyond all numbers.
        powers = np.maximum((promise / promise.max()) ** self.beta, np.finfo(float).tiny)
        self._promise = np.where(problem.sight, powers, 0.0)
        # Who has arrived stays.
        self._promise[-1, -1] = 1.0
        self._pheromone = np.ones_like(self._promise)

    def _initialize_infill(self):
        return self._infill()

    def _infill(self):
        problem = self.problem
        places = np.zeros((self.pop_size, problem.n_var + 2), dtype=np.int64)
        places[:, -1] = len(problem.road) - 1
        for k in range(problem.n_var):
            at = places[:, k]
            weight = np.cumsum(self._pheromone[at] * self._promise[at], axis=1)
            drawn = self.random_state.random((self.pop_size, 1)) * weight[:, -1:]
            # Rounding might draw what lies beyond the goal.
            places[:, k + 1] = np.minimum((weight <= drawn).sum(axis=1), places[:, -1])
        return Population.new("X", problem.encode(places))

    def _initialize_advance(self, infills: Any = None, **kwargs):
        self._best = infills[np.argmin(infills.get("F")[:, 0])]
        self._advance(infills)

    def _advance(self, infills: Any = None, **kwargs):
        self.pop = infills
        best: Individual = infills[np.argmin(infills.get("F")[:, 0])]
        if best.F[0] < self._best.F[0]:
            self._best = best
        problem = self.problem
        (places,) = problem.decode(self._best.X[None])
        self._pheromone *= 1.0 - self.evaporation
        self._pheromone[places[:-1], places[1:]] += self.evaporation
        np.maximum(self._pheromone, _LEAST_PHEROMONE, out=self._pheromone)


class BeeColony(_Colony):
    """The artificial bee colony of NiaPy, as a pymoo algorithm for one objective of real variables: a `ShorteningProblem`, say.

    An iteration is one of NiaPy's: half of the bees each change a source of food in one variable, the other half choose among
    the sources by 1 / (F + 0.01) and do the same, and a source that was tried in vain too often is left for a random one. Every
    bee is evaluated by pymoo's evaluator, alone, when NiaPy asks for it, so that evaluations are counted as for all others.
    NiaPy itself knows of no budget: once that is used up it would take every objective for infinite, and its onlookers might
    search for ever. Terminations are pymoo's, and heeded after whole iterations.

    Needs NiaPy, the ``swarm`` extra. Importing it sets up logging for the whole process, which is undone.

    Parameters
    ----------
    pop_size : int, default 24
        Bees, 4 or more. NiaPy evaluates as many random sources in the first iteration, and goes on from the first half of them.
    limit : int, default 100
        How many times in a row a source is tried in vain before it is left.
    **kwargs
        What every pymoo algorithm takes, such as ``callback``.

    Raises
    ------
    CapabilityError
        If an argument is unknown; when the run begins, if NiaPy cannot be imported, or the problem has constraints, several
        objectives, no bounds, or variables that are no real numbers.
    GridPathError
        If an argument is of another kind or out of its range; when an objective is negative or not finite, since onlookers
        could not choose.

    References
    ----------
    D. Karaboga and B. Basturk, "A powerful and efficient algorithm for numerical function optimization: artificial bee colony
    (ABC) algorithm", *Journal of Global Optimization* 39(3):459-471, 2007. G. Vrbančič et al., "NiaPy: Python microframework
    for building nature-inspired algorithms", *Journal of Open Source Software* 3(23):613, 2018.
    """

    def __init__(self, pop_size: int = 24, limit: int = 100, **kwargs):
        super().__init__(pop_size, _LEAST_BEES, **kwargs)
        self.limit = checks.whole("limit", limit, 1)

    def _setup(self, problem, **kwargs):
        real = problem.vtype in (None, float)
        if problem.n_obj != 1 or problem.has_constraints() or not problem.has_bounds() or not real:
            raise CapabilityError(
                f"BeeColony is for one objective of real variables with bounds and no constraints, the problem is "
                f"{shown(problem)}"
            )
        colony = _niapy().algorithms.basic.ArtificialBeeColonyAlgorithm
        # A generator is taken as it is: all draws are from pymoo's.
        self._bees = colony(population_size=self.pop_size, limit=self.limit, seed=self.random_state)
        # All sources that may still be held, by their variables.
        self._known: dict[bytes, Individual] = {}

    def _initialize_infill(self):
        task, tried = _task(self)
        sources, values, more = self._bees.init_population(task)
        self._state = (sources, values, *self._bees.get_best(sources, values), more)
        return Population.create(*tried)

    def _infill(self):
        task, tried = _task(self)
        *state, more = self._state
        self._state = self._bees.run_iteration(task, *state, **more)
        return Population.create(*tried)

    def _initialize_advance(self, infills: Any = None, **kwargs):
        self._advance(infills)

    def _advance(self, infills: Any = None, **kwargs):
        known = self._known | {one.X.tobytes(): one for one in infills}
        held = [source.x.tobytes() for source in self._state[0][: self._bees.food_number]]
        self._known = {key: known[key] for key in held}
        self.pop = Population.create(*(known[key] for key in held))


def _task(algorithm: BeeColony) -> tuple[Any, list[Individual]]:
    """Return what NiaPy evaluates bees by, without a budget, and the list that those are put on.

    It is made anew for each iteration and not kept, since pickle cannot name a class that is derived here.
    """
    niapy = _niapy()
    problem = algorithm.problem
    tried: list[Individual] = []

    class Rated(niapy.problems.Problem):
        def _evaluate(self, x):
            one = Individual(X=x.copy())
            algorithm.evaluator.eval(problem, Population.create(one), algorithm=algorithm)
            tried.append(one)
            value = float(one.F[0])
            if not 0 <= value < np.inf:
                raise GridPathError(f"the objective of a bee is {value:g}, expected a finite number, zero or more")
            return value

    return niapy.task.Task(Rated(problem.n_var, *problem.bounds())), tried


def _niapy() -> Any:
    """Return NiaPy."""
    root, before = logging.getLogger(), logging.getLogger().handlers[:]
    try:
        # The rest of the package does without it.
        importlib.import_module("niapy.algorithms.basic")
        return importlib.import_module("niapy")
    except ImportError as error:
        raise CapabilityError(
            f"BeeColony needs the package NiaPy, which cannot be imported ({error}); pip install 'pymoo_gridpath[swarm]'"
        ) from None
    finally:
        # Every file of NiaPy has the process write what is logged to standard error. Whether it does is for its owner to say.
        for handler in root.handlers[:]:
            if handler not in before:
                root.removeHandler(handler)
