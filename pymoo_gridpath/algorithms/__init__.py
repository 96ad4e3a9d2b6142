"""pymoo's algorithms made ready for grids: smoothness tie-breaks, what each can do, and a factory."""

from __future__ import annotations

from pymoo_gridpath.algorithms.capabilities import CAPABILITIES, Capability, capability_table
from pymoo_gridpath.algorithms.colonies import AntColony, BeeColony
from pymoo_gridpath.algorithms.factory import make_algorithm, reference_directions
from pymoo_gridpath.algorithms.known import find_algorithm
from pymoo_gridpath.algorithms.moead import SmoothMOEAD
from pymoo_gridpath.algorithms.paper import Setup, ahmed_deb_2013
from pymoo_gridpath.algorithms.runs import minimize_runs
from pymoo_gridpath.algorithms.spea2 import StrengthAndSmoothness, StrengthTournament
from pymoo_gridpath.algorithms.termination import FirstLegalPath
from pymoo_gridpath.algorithms.variable_length import PRINTED_RULES, VariableLengthGA, variable_length_ga
from pymoo_gridpath.planners import (
    AStar,
    BestFirst,
    BreadthFirst,
    CountedPath,
    Dijkstra,
    ExactFront,
    JumpPointSearch,
    OrthogonalJumpPointSearch,
    PathOutput,
    QuadrantPaths,
    QuadrantSelection,
    RegionOfSight,
    SightPaths,
)
from pymoo_gridpath.registry import ALGORITHMS
from pymoo_gridpath.search.waypoints import Waypoints

__all__ = [
    "ALGORITHMS",
    "CAPABILITIES",
    "PRINTED_RULES",
    "AStar",
    "AntColony",
    "BeeColony",
    "BestFirst",
    "BreadthFirst",
    "Capability",
    "CountedPath",
    "Dijkstra",
    "ExactFront",
    "FirstLegalPath",
    "JumpPointSearch",
    "OrthogonalJumpPointSearch",
    "PathOutput",
    "QuadrantPaths",
    "QuadrantSelection",
    "RegionOfSight",
    "Setup",
    "SightPaths",
    "SmoothMOEAD",
    "StrengthAndSmoothness",
    "StrengthTournament",
    "VariableLengthGA",
    "Waypoints",
    "ahmed_deb_2013",
    "capability_table",
    "find_algorithm",
    "make_algorithm",
    "minimize_runs",
    "reference_directions",
    "variable_length_ga",
]
