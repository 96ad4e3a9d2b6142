"""Planners that are no evolutionary searches, as algorithms of pymoo."""

from __future__ import annotations

from pymoo_gridpath.planners.base import PLANNERS, Plan, Planner, reference_planner
from pymoo_gridpath.planners.display import PathOutput
from pymoo_gridpath.planners.exact import ExactFront

__all__ = ["PLANNERS", "ExactFront", "PathOutput", "Plan", "Planner", "reference_planner"]
