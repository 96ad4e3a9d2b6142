"""The genetic algorithm of section 5.5 on arrays, several times as fast as pymoo's and by the same rules."""

from __future__ import annotations

from typing import Any

import numpy as np
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.operators.selection.tournament import TournamentSelection

from pymoo_gridpath.algorithms.evaluator import ArrayEvaluator
from pymoo_gridpath.operators import paper_operators
from pymoo_gridpath.operators.mating import ArrayMating
from pymoo_gridpath.operators.selection import compare, decide, winners
from pymoo_gridpath.operators.survival import ArraySurvival

#: Distribution index of SBX with one objective.
ETA_CROSSOVER = 2.0


class BestSurvive(ArraySurvival):
    """The best of parents and children: feasible ones first, then by violation, then by the objective."""

    def __init__(self) -> None:
        super().__init__(filter_infeasible=False)

    def _do(self, problem, pop, *args, n_survive=None, **kwargs):
        F, CV = pop.get("F", "CV")
        return pop[np.lexsort((F[:, 0], CV[:, 0]))[:n_survive]]


def by_violation_and_value(pop, P, random_state=None, **kwargs) -> np.ndarray:
    """Return the winners of tournaments between two; of equals, either at random."""
    assert random_state is not None
    F, CV = pop.get("F", "CV")
    return winners(P, decide(P, CV[:, 0], compare(P, F[:, 0])), random_state.random(len(P)) < 0.5)


def genetic_algorithm(problem, pop_size: int) -> GA:
    """Return the genetic algorithm of `ahmed_deb_2013` for one objective, with its operators."""
    operators = paper_operators(problem, eta_crossover=ETA_CROSSOVER)
    selection = TournamentSelection(func_comp=by_violation_and_value)
    mating = ArrayMating(selection, operators["crossover"], operators["mutation"], operators["repair"])
    survival: Any = BestSurvive()
    return GA(pop_size, selection=selection, survival=survival, mating=mating, evaluator=ArrayEvaluator(), **operators)
