"""What to try where a trade-off set leaves nothing to choose from, or its paths are long."""

from __future__ import annotations

from collections.abc import Sequence

from pymoo.core.algorithm import Algorithm

from pymoo_gridpath.algorithms.known import find_algorithm
from pymoo_gridpath.decision.measures import risk_of

# By which share the shortest path found may be longer than the shortest of all before that is remarked on.
_MUCH_LONGER = 0.05


def advice_on(trade_off, algorithms: Sequence[type[Algorithm]]) -> str:
    """Return what to try, see `TradeOffSet.advice`; ``algorithms`` are those that found the paths, as far as is known."""
    if trade_off.problem.start == trade_off.problem.goal:
        return ""
    return "; ".join(filter(None, (_on_one_point(trade_off), _on_long_paths(trade_off, algorithms))))


def _on_one_point(trade_off) -> str:
    if len(trade_off) > 1 or not trade_off.feasible or len(trade_off.objective_names) == 1:
        return ""
    risk = risk_of(trade_off.problem)
    ways = [*filter(None, [risk and risk.wider]), "a further objective, such as turn,"]
    return f"the front found is one point, a path that is best by every objective; {' or '.join(ways)} may give a choice"


def _on_long_paths(trade_off, algorithms: Sequence[type[Algorithm]]) -> str:
    problem = trade_off.problem
    others = problem.potential_limit is not None or problem.representation.timed
    if trade_off.least_length is None or not trade_off.feasible or others:
        return ""
    excess = float(trade_off.measures["length"].min()) / trade_off.least_length - 1.0
    if excess <= _MUCH_LONGER:
        return ""
    attempts = _attempts(problem.representation.monotone, algorithms)
    return f"the shortest path found is {excess:.0%} longer than the shortest of all; try {attempts}"


def _attempts(monotone: bool, algorithms: Sequence[type[Algorithm]]) -> str:
    """Return what may find a shorter path, in words, as far as those that found these can do it."""
    # Of genes of any origin it is not known what they came from.
    able = [find_algorithm(cls) for cls in algorithms]
    attempts = {
        "the representation 'cells', which codes every path": monotone,
        "path-aware operators": not able or any(one.takes_operators for one in able),
        "more generations": not able or any(one.takes_generations for one in able),
        "a larger budget": not monotone and any(one.reference for one in able),
        "the exact front": not monotone and not any(one.reference for one in able),
    }
    *others, last = (attempt for attempt, helps in attempts.items() if helps)
    return f"{', '.join(others)} or {last}" if others else last
