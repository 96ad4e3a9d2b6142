"""Sampling, crossover, mutation, repair, selection, survival and duplicate elimination for path problems."""

from __future__ import annotations

from typing import Any, Literal

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
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
from pymoo_gridpath.operators.path_crossover import SpliceCrossover
from pymoo_gridpath.operators.path_mutation import PathMutation
from pymoo_gridpath.operators.path_repair import PathRepair
from pymoo_gridpath.operators.path_sampling import ReachableSampling, ScalarizedSampling
from pymoo_gridpath.operators.path_terrain import terrain_of
from pymoo_gridpath.operators.repair import EdgeFixing
from pymoo_gridpath.operators.sampling import RandomSampling
from pymoo_gridpath.operators.selection import SmoothnessTournament
from pymoo_gridpath.operators.survival import RankAndSmoothness
from pymoo_gridpath.representations.base import representation_of
from pymoo_gridpath.representations.mixed import MixedRepresentation

__all__ = [
    "ArrayMating",
    "BitwiseMutation",
    "DiscretePolynomialMutation",
    "DiscreteSBX",
    "EdgeFixing",
    "MixedCrossover",
    "MixedMutation",
    "PathMutation",
    "PathRepair",
    "PointCrossover",
    "RandomSampling",
    "RankAndSmoothness",
    "ReachableSampling",
    "RowDuplicates",
    "ScalarizedSampling",
    "SinglePointCrossover",
    "SmoothnessTournament",
    "SpliceCrossover",
    "TwoPointCrossover",
    "default_operators",
    "paper_operators",
    "path_operators",
]


def paper_operators(problem, eta_crossover: float = 10.0, eta_mutation: float = 20.0) -> dict:
    """Return the operators that the paper names for the problem's representation.

    pymoo's own constructors take them as they are where the capability table says "Unpacks":
    ``NSGA2(pop_size=100, **paper_operators(problem))``. Others, such as MOEA/D, refuse one of them or heed it not;
    ``make_algorithm("MOEA/D", problem, operators=paper_operators(problem))`` fits them to every algorithm that takes a
    crossover and a mutation.

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

    Raises
    ------
    GridPathError
        If the representation is not one of the paper's, or the problem has none.

    References
    ----------
    Ahmed and Deb (2013), sections 2.1 to 2.3 and 5.2.
    """
    representation: Any = representation_of(problem)
    if not representation.paper:
        raise GridPathError(
            f"the paper names no operators for the {representation.name} representation, expected one of its own codings; "
            f"path_operators fit every representation"
        )
    rate = 1.0 / representation.frame.n_columns
    if representation.vtype is bool:
        crossover, mutation = TwoPointCrossover(prob=0.9), BitwiseMutation(prob_var=rate)
    elif isinstance(representation, MixedRepresentation):
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


def path_operators(problem, sampling: Literal["scalarized", "random"] = "scalarized") -> dict:
    """Return operators that know paths: whatever they make is a legal path, in any representation.

    pymoo's own constructors take them as they are where the capability table says "Unpacks":
    ``NSGA2(pop_size=100, **path_operators(problem))``. Others, such as MOEA/D, refuse one of them or heed it not;
    ``make_algorithm("MOEA/D", problem, operators=path_operators(problem))`` fits them to every algorithm that takes a
    crossover and a mutation.

    Parameters
    ----------
    problem : GridPathProblem
    sampling : {"scalarized", "random"}, default "scalarized"
        Whether the first population has the cheapest paths for weights of the objectives, `ScalarizedSampling`, or random
        paths, `ReachableSampling`.

    Returns
    -------
    dict
        ``sampling``, ``crossover``, ``mutation``, ``repair`` and ``eliminate_duplicates``.

    Raises
    ------
    GridPathError
        If the sampling is unknown, or the problem has no path representation.
    """
    checks.one_of("sampling", sampling, ("scalarized", "random"))
    terrain_of(problem)
    return {
        "sampling": ScalarizedSampling() if sampling == "scalarized" else ReachableSampling(),
        "crossover": SpliceCrossover(),
        "mutation": PathMutation(),
        "repair": PathRepair(),
        "eliminate_duplicates": RowDuplicates(),
    }


def default_operators(problem) -> dict:
    """Return `paper_operators` for the paper's representations, and `path_operators` for any other, such as "cells".

    See either for which of pymoo's algorithms take them as they are.

    Parameters
    ----------
    problem : GridPathProblem

    Returns
    -------
    dict
        ``sampling``, ``crossover``, ``mutation``, ``repair`` and ``eliminate_duplicates``.

    Raises
    ------
    GridPathError
        If the problem has no path representation.
    """
    return paper_operators(problem) if representation_of(problem).paper else path_operators(problem)
