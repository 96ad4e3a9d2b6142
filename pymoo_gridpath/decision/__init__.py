"""From Results to a decision: the trade-off set of paths, its named members, and its export to tables and files."""

from pymoo_gridpath.decision.knee import knee_point
from pymoo_gridpath.decision.stored import load_json
from pymoo_gridpath.decision.trade_off import NAMES, PathRecord, TradeOffSet

__all__ = ["NAMES", "PathRecord", "TradeOffSet", "knee_point", "load_json"]
