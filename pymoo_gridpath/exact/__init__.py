"""Exact Pareto fronts of objectives that add up along a path."""

from __future__ import annotations

from pymoo_gridpath.exact.budget import Budget
from pymoo_gridpath.exact.front import ExactResult, exact_front
from pymoo_gridpath.exact.many import exact_fronts
from pymoo_gridpath.exact.nearness import Certificate
from pymoo_gridpath.exact.timed import TimedFront, exact_timed_front

__all__ = ["Budget", "Certificate", "ExactResult", "TimedFront", "exact_front", "exact_fronts", "exact_timed_front"]
