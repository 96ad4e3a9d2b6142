"""Planners that are no evolutionary searches, as algorithms of pymoo."""

from __future__ import annotations

from pymoo_gridpath.planners.base import PLANNERS, Plan, Planner, reference_planner, settled
from pymoo_gridpath.planners.counted import (
    AStar,
    BestFirst,
    BreadthFirst,
    CountedPath,
    CountedSearch,
    Dijkstra,
    JumpPointSearch,
    OrthogonalJumpPointSearch,
)
from pymoo_gridpath.planners.display import PathOutput
from pymoo_gridpath.planners.exact import ExactFront
from pymoo_gridpath.planners.quadrant import QuadrantPaths, QuadrantSelection
from pymoo_gridpath.planners.region_of_sight import RegionOfSight, SightPaths

__all__ = [
    "PLANNERS",
    "AStar",
    "BestFirst",
    "BreadthFirst",
    "CountedPath",
    "CountedSearch",
    "Dijkstra",
    "ExactFront",
    "JumpPointSearch",
    "OrthogonalJumpPointSearch",
    "PathOutput",
    "Plan",
    "Planner",
    "QuadrantPaths",
    "QuadrantSelection",
    "RegionOfSight",
    "SightPaths",
    "reference_planner",
    "settled",
]
