"""Which operators go together: the paper's for its codings, those that know paths, and those of lists of cells."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any, Literal

from pymoo.core.duplicate import NoDuplicateElimination
from pymoo.core.repair import NoRepair

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.operators.cells import CellMutation, GreedySampling, SharedCellCrossover, cells_of
from pymoo_gridpath.operators.crossover import DiscreteSBX, MixedCrossover, SinglePointCrossover, TwoPointCrossover
from pymoo_gridpath.operators.duplicates import RowDuplicates
from pymoo_gridpath.operators.mutation import BitwiseMutation, DiscretePolynomialMutation, MixedMutation
from pymoo_gridpath.operators.parameters import CROSSOVER_RATE, ETA_CROSSOVER, ETA_MUTATION
from pymoo_gridpath.operators.path_crossover import SpliceCrossover
from pymoo_gridpath.operators.path_mutation import PathMutation
from pymoo_gridpath.operators.path_repair import PathRepair
from pymoo_gridpath.operators.path_sampling import ReachableSampling, ScalarizedSampling
from pymoo_gridpath.operators.path_terrain import terrain_of
from pymoo_gridpath.operators.path_timed import (
    RandomTimedSampling,
    TimedCrossover,
    TimedMutation,
    TimedRepair,
    TimedSampling,
    timed_terrain_of,
)
from pymoo_gridpath.operators.repair import EdgeFixing
from pymoo_gridpath.operators.roulette import ElitistSurvival, RouletteSelection
from pymoo_gridpath.operators.sampling import RandomSampling
from pymoo_gridpath.representations.base import Representation, representation_of
from pymoo_gridpath.representations.mixed import MixedRepresentation

_VARIATION = ("crossover", "mutation")

#: The samplings that know paths, by the name of the set that they make.
PATH_SAMPLINGS: dict[str, type] = {"scalarized": ScalarizedSampling, "random": ReachableSampling}

_TIMED_SAMPLINGS: dict[str, type] = {"scalarized": TimedSampling, "random": RandomTimedSampling}


def path_classes(sampling: str = "scalarized", timed: bool = False) -> dict[str, type]:
    """Return the classes of `path_operators`, by slot, for paths on a map that stands still or for paths in time."""
    if timed:
        return {
            "sampling": _TIMED_SAMPLINGS[sampling],
            "crossover": TimedCrossover,
            "mutation": TimedMutation,
            "repair": TimedRepair,
            "eliminate_duplicates": RowDuplicates,
        }
    return {
        "sampling": PATH_SAMPLINGS[sampling],
        "crossover": SpliceCrossover,
        "mutation": PathMutation,
        "repair": PathRepair,
        "eliminate_duplicates": RowDuplicates,
    }


#: What a set of operators has an operator for.
MEMBERS = tuple(path_classes())


def paper_classes(representation: type[Representation]) -> dict[str, type]:
    """Return the classes of `paper_operators` for a class of representations, by slot."""
    crossover, mutation = _variation(representation)
    return {
        "sampling": RandomSampling,
        "crossover": crossover,
        "mutation": mutation,
        "repair": EdgeFixing,
        "eliminate_duplicates": RowDuplicates,
    }


def _variation(representation: type[Representation]) -> tuple[type, type]:
    """Return the crossover and the mutation that the paper names for a class of representations."""
    if representation.vtype is bool:
        return TwoPointCrossover, BitwiseMutation
    if issubclass(representation, MixedRepresentation):
        return MixedCrossover, MixedMutation
    return DiscreteSBX, DiscretePolynomialMutation


def default_set(paper: bool) -> Literal["paper", "scalarized"]:
    """Return which operators a representation has by default, by whether it is one of the paper's."""
    return "paper" if paper else "scalarized"


def paper_operators(problem, eta_crossover: float = ETA_CROSSOVER, eta_mutation: float = ETA_MUTATION) -> dict:
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
    made: dict[str, Any] = {slot: cls() for slot, cls in paper_classes(type(representation)).items() if slot not in _VARIATION}
    crossover, mutation = _variation(type(representation))
    # Of bits none have an index.
    etas = ({}, {}) if representation.vtype is bool else ({"eta": eta_crossover}, {"eta": eta_mutation})
    made["crossover"] = crossover(**etas[0], prob=CROSSOVER_RATE)
    made["mutation"] = mutation(**etas[1], prob_var=1.0 / representation.frame.n_columns)
    return {slot: made[slot] for slot in MEMBERS}


def path_operators(problem, sampling: Literal["scalarized", "random"] = "scalarized") -> dict:
    """Return operators that know paths: whatever they make is a legal path, in any representation.

    Those for a `TimedPathProblem` know of time, too.

    pymoo's own constructors take them as they are where the capability table says "Unpacks":
    ``NSGA2(pop_size=100, **path_operators(problem))``. Others, such as MOEA/D, refuse one of them or heed it not;
    ``make_algorithm("MOEA/D", problem, operators=path_operators(problem))`` fits them to every algorithm that takes a
    crossover and a mutation.

    Parameters
    ----------
    problem : GridPathProblem
    sampling : {"scalarized", "random"}, default "scalarized"
        Whether the first population has the cheapest paths for weights of the objectives, `ScalarizedSampling`, or random
        paths, `ReachableSampling`; in time, `TimedSampling` or `RandomTimedSampling`.

    Returns
    -------
    dict
        ``sampling``, ``crossover``, ``mutation``, ``repair`` and ``eliminate_duplicates``.

    Raises
    ------
    GridPathError
        If the sampling is unknown, or the problem has no path representation, or one that does not code every path.
    """
    checks.one_of("sampling", sampling, PATH_SAMPLINGS)
    timed = representation_of(problem).timed
    # So that a problem that has none is refused here.
    (timed_terrain_of if timed else terrain_of)(problem)
    return {slot: cls() for slot, cls in path_classes(sampling, timed).items()}


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
    return paper_operators(problem) if default_set(representation_of(problem).paper) == "paper" else path_operators(problem)


#: Rules of `cell_operators` that can be had as they are printed.
PRINTED = ("start", "roulette", "variation")


def printed_rules(printed: Collection[str], known: Collection[str]) -> set[str]:
    """Return rules that are to be taken as they are printed if they are known."""
    given = checks.items("printed", printed, f"some of {', '.join(known)}")
    return {checks.one_of("a rule of printed", rule, known) for rule in given}


def cell_operators(problem, printed: Collection[str] = ()) -> dict:
    """Return the operators of the variable-length genetic algorithm, of which `variable_length_ga` says where they come from.

    They are for the "cells" representation and one objective, and make paths across obstacles too: ``GA(pop_size=50,
    **cell_operators(problem))``, with ``obstacles="constraint"``.

    Parameters
    ----------
    problem : GridPathProblem
    printed : collection of {"start", "roulette", "variation"}, default ()
        Which rules to take as they are printed.

    Returns
    -------
    dict
        ``sampling``, ``selection``, ``crossover``, ``mutation``, ``survival``, and a ``repair`` and ``eliminate_duplicates``
        that do nothing: the algorithm has neither.

    Raises
    ------
    GridPathError
        If a rule is unknown, or the problem has another representation.
    """
    made = printed_operators(printed)
    cells_of(problem, "cell_operators")
    return made


def printed_operators(printed: Collection[str] = ()) -> dict:
    """Return the operators of `cell_operators`, which are the same for all problems that they are for."""
    rules = printed_rules(printed, PRINTED)
    torn = "variation" in rules
    return {
        "sampling": GreedySampling(greedy="start" in rules),
        "selection": RouletteSelection(literal="roulette" in rules),
        "crossover": SinglePointCrossover() if torn else SharedCellCrossover(),
        "mutation": CellMutation(anywhere=torn),
        "survival": ElitistSurvival(),
        "repair": NoRepair(),
        "eliminate_duplicates": NoDuplicateElimination(),
    }
