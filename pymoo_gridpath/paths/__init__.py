"""Batches of decoded paths and their measures."""

from pymoo_gridpath.neighbourhood import TURN_UNIT
from pymoo_gridpath.paths.base import Paths, SequencePaths, check_paths
from pymoo_gridpath.paths.cell import CellPaths
from pymoo_gridpath.paths.column import ColumnPaths
from pymoo_gridpath.paths.frame import MonotoneFrame
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.paths.trajectories import Trajectories

__all__ = [
    "TURN_UNIT",
    "CellPaths",
    "ColumnPaths",
    "MonotoneFrame",
    "Paths",
    "SequencePaths",
    "Sequences",
    "Trajectories",
    "check_paths",
]
