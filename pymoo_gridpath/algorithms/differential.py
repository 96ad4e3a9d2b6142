"""Differential evolution on whole numbers."""

from __future__ import annotations

from pymoo.algorithms.moo.nsde import VariantDE
from pymoo.core.population import Population


class WholeNumberDE(VariantDE):
    """Mating by differential evolution between parents whose genes are whole numbers or bits.

    pymoo writes the real-valued mutant into an array of the parents' type, which cuts off its fraction and so drifts
    towards zero, and it cannot subtract bits. Here the parents are handed over as real numbers, and the repair,
    `EdgeFixing`, rounds the children to the nearest whole number.

    Parameters
    ----------
    **kwargs
        As for pymoo's `VariantDE`: ``variant``, ``CR``, ``F``, ``gamma``, ``de_repair``, ``mutation``, and ``repair``.
    """

    def _do(self, problem, pop, n_offsprings, random_state=None, **kwargs):
        real = Population.new("X", pop.get("X").astype(float), "rank", pop.get("rank"))
        return super()._do(problem, real, n_offsprings, random_state=random_state, **kwargs)
