"""Representations: how a path becomes a row of decision variables, and back."""

from pymoo_gridpath.representations.absolute import AbsoluteRepresentation
from pymoo_gridpath.representations.base import REPRESENTATIONS, Representation
from pymoo_gridpath.representations.binary import BinaryRepresentation
from pymoo_gridpath.representations.cell_sequence import CellSequence
from pymoo_gridpath.representations.factory import default_representation, make_representation
from pymoo_gridpath.representations.integer import IntegerRepresentation
from pymoo_gridpath.representations.mixed import MixedRepresentation
from pymoo_gridpath.representations.monotone import MonotoneRepresentation
from pymoo_gridpath.representations.sugihara_smith import SugiharaSmithRepresentation
from pymoo_gridpath.representations.timed_paths import TimedPaths
from pymoo_gridpath.search.moves import Moves

__all__ = [
    "REPRESENTATIONS",
    "AbsoluteRepresentation",
    "BinaryRepresentation",
    "CellSequence",
    "IntegerRepresentation",
    "MixedRepresentation",
    "MonotoneRepresentation",
    "Moves",
    "Representation",
    "SugiharaSmithRepresentation",
    "TimedPaths",
    "default_representation",
    "make_representation",
]
