"""Sampling, crossover, mutation, repair, selection, survival and duplicate elimination for path problems."""

from __future__ import annotations

from pymoo_gridpath.operators.cells import CellMutation, GreedySampling, SharedCellCrossover
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
from pymoo_gridpath.operators.path_timed import (
    RandomTimedSampling,
    TimedCrossover,
    TimedMutation,
    TimedRepair,
    TimedSampling,
)
from pymoo_gridpath.operators.repair import EdgeFixing
from pymoo_gridpath.operators.roulette import ElitistSurvival, RouletteSelection
from pymoo_gridpath.operators.sampling import RandomSampling
from pymoo_gridpath.operators.selection import SmoothnessTournament
from pymoo_gridpath.operators.sets import cell_operators, default_operators, paper_operators, path_operators
from pymoo_gridpath.operators.survival import RankAndSmoothness
from pymoo_gridpath.registry import OPERATORS

__all__ = [
    "OPERATORS",
    "ArrayMating",
    "BitwiseMutation",
    "CellMutation",
    "DiscretePolynomialMutation",
    "DiscreteSBX",
    "EdgeFixing",
    "ElitistSurvival",
    "GreedySampling",
    "MixedCrossover",
    "MixedMutation",
    "PathMutation",
    "PathRepair",
    "PointCrossover",
    "RandomSampling",
    "RandomTimedSampling",
    "RankAndSmoothness",
    "ReachableSampling",
    "RouletteSelection",
    "RowDuplicates",
    "ScalarizedSampling",
    "SharedCellCrossover",
    "SinglePointCrossover",
    "SmoothnessTournament",
    "SpliceCrossover",
    "TimedCrossover",
    "TimedMutation",
    "TimedRepair",
    "TimedSampling",
    "TwoPointCrossover",
    "cell_operators",
    "default_operators",
    "paper_operators",
    "path_operators",
]
