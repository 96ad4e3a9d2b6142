"""What a path is scored by: each objective maps a batch of paths to an array of N numbers to be minimised."""

from __future__ import annotations

from pymoo_gridpath.objectives.base import (
    OBJECTIVES,
    Length,
    MoveCosts,
    Objective,
    Prepared,
    Turn,
    avoiding_costs,
    axis_of,
    boxed_field_of,
    field_of,
    levels_of,
    make_objectives,
    moves_of,
    prepared,
    visiting_costs,
)
from pymoo_gridpath.objectives.clearance import LeastClearance
from pymoo_gridpath.objectives.ground import Climb, GroundCost
from pymoo_gridpath.objectives.risk import Inflation, Risk, Vulnerability
from pymoo_gridpath.objectives.suites import Ascent, Delay, Exposure, IntegerLength, RandomCost, TravelTime

__all__ = [
    "OBJECTIVES",
    "Ascent",
    "Climb",
    "Delay",
    "Exposure",
    "GroundCost",
    "Inflation",
    "IntegerLength",
    "LeastClearance",
    "Length",
    "MoveCosts",
    "Objective",
    "Prepared",
    "RandomCost",
    "Risk",
    "TravelTime",
    "Turn",
    "Vulnerability",
    "avoiding_costs",
    "axis_of",
    "boxed_field_of",
    "field_of",
    "levels_of",
    "make_objectives",
    "moves_of",
    "prepared",
    "visiting_costs",
]
