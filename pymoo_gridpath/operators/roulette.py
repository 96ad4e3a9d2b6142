"""Selection and survival of the plain genetic algorithm with one fitness: a roulette wheel, and the best string kept."""

from __future__ import annotations

import math

import numpy as np
from pymoo.core.selection import Selection

from pymoo_gridpath import checks
from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.operators.parameters import in_range, number
from pymoo_gridpath.operators.survival import ArraySurvival
from pymoo_gridpath.registry import OPERATORS

#: What an interfering cell adds to the fitness of a path, in its objective's own unit; the damping coefficient of an obstacle.
DAMPING = 300.0


@OPERATORS.register
class RouletteSelection(Selection):
    """Draw parents with probabilities in proportion to their weights, again and again.

    The fitness is the objective and ``damping`` times the constraint violation, and less is better: the weight is 1 / (1 +
    fitness). Fitnesses below 0 are raised, all by as much.

    For problems of one objective. The type of the genes does not matter.

    Parameters
    ----------
    literal : bool, default False
        Whether the weight is the fitness itself, which is the printed rule. Fitness is to be small, so that the worst are drawn
        most.
    damping : float, default 300
        Zero or more.

    References
    ----------
    The variable-length genetic algorithm, see `variable_length_ga`, section 5.4.
    """

    def __init__(self, literal: bool = False, damping: float = DAMPING, **kwargs):
        super().__init__(**kwargs)
        self.literal = checks.flag("literal", literal)
        self.damping = in_range("damping", damping, 0, math.inf)

    def _do(self, problem, pop, n_select, n_parents, *args, random_state=None, **kwargs):
        assert random_state is not None
        fitness = fitness_of(pop, number(self.damping), "RouletteSelection")
        fitness = fitness - min(fitness.min(), 0.0)
        weights = fitness if self.literal and fitness.any() else 1.0 / (1.0 + fitness)
        wheel = np.cumsum(weights)
        drawn = np.searchsorted(wheel, wheel[-1] * random_state.random((n_select, n_parents)), side="right")
        # A product may round up to the end of the wheel.
        return np.minimum(drawn, len(pop) - 1)


@OPERATORS.register
class ElitistSurvival(ArraySurvival):
    """The children replace their parents; the best of these replaces the worst child if it is better than all children.

    The fitness is that of `RouletteSelection`. Where there are fewer children than members, the best parents fill up; where
    there are more, the best children survive.

    For problems of one objective, and algorithms that merge parents and children before they select, as pymoo's ``GA``. The
    type of the genes does not matter.

    Parameters
    ----------
    damping : float, default 300
        See `RouletteSelection`.

    References
    ----------
    The variable-length genetic algorithm, see `variable_length_ga`, section 5.5.
    """

    def __init__(self, damping: float = DAMPING):
        super().__init__(filter_infeasible=False)
        self.damping = in_range("damping", damping, 0, math.inf)

    def _do(self, problem, pop, *args, n_survive=None, **kwargs):
        fitness = fitness_of(pop, number(self.damping), "ElitistSurvival")
        n_survive = len(pop) if n_survive is None else n_survive
        born = np.array([-1 if one is None else one for one in pop.get("n_gen", to_numpy=False)])
        children, parents = np.flatnonzero(born == born.max()), np.flatnonzero(born < born.max())
        parents = parents[np.argsort(fitness[parents], kind="stable")]
        if len(children) > n_survive:
            children = children[np.argsort(fitness[children], kind="stable")[:n_survive]]
        if len(children) < n_survive:
            return pop[np.concatenate([children, parents[: n_survive - len(children)]])]
        if len(parents) and fitness[parents[0]] < fitness[children].min():
            children[np.argmax(fitness[children])] = parents[0]
        return pop[children]


def fitness_of(pop, damping: float, owner: str) -> np.ndarray:
    """Return the objective and ``damping`` times the constraint violation of individuals, float, shape (N,).

    Raises
    ------
    CapabilityError
        If there are several objectives.
    """
    F, CV = pop.get("F", "CV")
    if F.shape[1] != 1:
        raise CapabilityError(f"{owner} is for one objective, the problem has {F.shape[1]}")
    return F[:, 0].astype(float) + damping * CV[:, 0].astype(float)
