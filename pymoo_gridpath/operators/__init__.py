"""Sampling, crossover, mutation, repair, selection, survival and duplicate elimination for path problems."""

from __future__ import annotations

from pymoo_gridpath.operators.crossover import (
    DiscreteSBX,
    MixedCrossover,
    PointCrossover,
    SinglePointCrossover,
    TwoPointCrossover,
)
from pymoo_gridpath.operators.duplicates import RowDuplicates
from pymoo_gridpath.operators.mating import ArrayMating
from pymoo_gridpath.operators.mutation import BitwiseMutation, DiscretePolynomialMutation, MixedMutation
from pymoo_gridpath.operators.repair import EdgeFixing
from pymoo_gridpath.operators.sampling import RandomSampling
from pymoo_gridpath.operators.selection import SmoothnessTournament
from pymoo_gridpath.operators.survival import RankAndSmoothness

__all__ = [
    "ArrayMating",
    "BitwiseMutation",
    "DiscretePolynomialMutation",
    "DiscreteSBX",
    "EdgeFixing",
    "MixedCrossover",
    "MixedMutation",
    "PointCrossover",
    "RandomSampling",
    "RankAndSmoothness",
    "RowDuplicates",
    "SinglePointCrossover",
    "SmoothnessTournament",
    "TwoPointCrossover",
    "paper_operators",
]


def paper_operators(problem, eta_crossover: float = 10.0, eta_mutation: float = 20.0) -> dict:
    """Return the operators that the paper names for the problem's representation.

    They fit any pymoo algorithm that takes operators: ``NSGA2(pop_size=100, **paper_operators(problem))``.

    Parameters
    ----------
    problem : GridPathProblem
    eta_crossover : float, default 10
        Distribution index of discrete SBX (10; 2 in the paper's single-objective runs).
    eta_mutation : float, default 20
        Distribution index of discrete polynomial mutation.

    Returns
    -------
    dict
        ``sampling``, ``crossover``, ``mutation``, ``repair`` and ``eliminate_duplicates``. Rates are the paper's:
        crossover 0.9, mutation 1 / n for each gene or bit, n the number of columns; that is about one gene a path in
        the integer coding, and about 2 + ceil(log2 n) bits in the binary one.

    References
    ----------
    Ahmed and Deb (2013), sections 2.1 to 2.3 and 5.2.
    """
    representation = problem.representation
    rate = 1.0 / representation.frame.n_columns
    if representation.name == "binary":
        crossover, mutation = TwoPointCrossover(prob=0.9), BitwiseMutation(prob_var=rate)
    elif representation.name == "mixed":
        crossover, mutation = MixedCrossover(eta_crossover, prob=0.9), MixedMutation(eta_mutation, prob_var=rate)
    else:
        crossover, mutation = DiscreteSBX(eta_crossover, prob=0.9), DiscretePolynomialMutation(eta_mutation, prob_var=rate)
    return {
        "sampling": RandomSampling(),
        "crossover": crossover,
        "mutation": mutation,
        "repair": EdgeFixing(),
        "eliminate_duplicates": RowDuplicates(),
    }
