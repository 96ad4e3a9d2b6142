"""Evaluation of a generation with few look-ups an individual."""

from __future__ import annotations

import itertools

import numpy as np
from pymoo.core.evaluator import Evaluator

from pymoo_gridpath.operators.array_population import ArrayPopulation

_NO_VIOLATION = np.zeros(1)
_NO_VIOLATION.flags.writeable = False


class ArrayEvaluator(Evaluator):
    """pymoo's evaluator, which also sets the constraint violation where there are no constraints.

    pymoo works that out for one individual at a time, when first asked, and asks each whether it is evaluated already.
    """

    def eval(self, problem, pop, skip_already_evaluated=None, **kwargs):
        if isinstance(pop, ArrayPopulation) and pop.not_evaluated():
            skip_already_evaluated = False
        return super().eval(problem, pop, skip_already_evaluated, **kwargs)

    def _eval(self, problem, pop, evaluate_values_of, **kwargs):
        if isinstance(pop, ArrayPopulation):
            out = problem.evaluate(pop.get("X"), return_values_of=evaluate_values_of, return_as_dictionary=True, **kwargs)
            found = out if problem.has_constraints() else out | {"CV": np.zeros((len(pop), 1))}
            pop.set(*itertools.chain.from_iterable(found.items()))
            pop.mark_evaluated(out.keys())
            return
        super()._eval(problem, pop, evaluate_values_of, **kwargs)
        if not problem.has_constraints():
            pop.set("CV", [_NO_VIOLATION] * len(pop))
