"""Whether what is certified of fronts is true: random problems with the exact front beside fronts near to it, and cut short.

    python benchmarks/certificates.py --problems 500

Of each problem ten fronts: three factors, three shares of the range, and four budgets of labels, one of them with a factor.
Costs of cells are whole numbers, so that fractions say without rounding how far off a front is; lengths and potentials are
compared with room for the rounding of their sums. Zeros are frequent, maps may be empty, and fronts may be single points.
"""

from __future__ import annotations

import argparse
from fractions import Fraction
from typing import Any

import numpy as np

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.exact import Budget, exact_front
from pymoo_gridpath.objectives import Objective, Vulnerability

# Of scores that are sums of floats.
_ROUNDING = Fraction(1, 10**9)


class Cost(Objective):
    """The sum of given costs of cells."""

    def __init__(self, name: str, values: np.ndarray):
        self.name = self.label = name
        self.values = values

    def field(self, grid):
        return self.values


def missed(F: np.ndarray, front: np.ndarray, rounding: Fraction = _ROUNDING) -> tuple[Fraction | float, Fraction]:
    """Return by which factor, less 1, and by which share of the range points miss a front; infinite where 0 is missed."""
    near, whole = ([[Fraction(value) for value in row] for row in rows.tolist()] for rows in (F, front))
    ranges = [max(column) - min(column) for column in zip(*whole, strict=True)]
    factors, shares = [], []
    for q in whole:
        off = [
            [
                (Fraction(0), Fraction(0))
                if a <= b + rounding * abs(b)
                else ((a - b) / b if b > 0 else float("inf"), (a - b) / extent if extent else float("inf"))
                for a, b, extent in zip(p, q, ranges, strict=True)
            ]
            for p in near
        ]
        factors.append(min(max(factor for factor, _ in one) for one in off))
        shares.append(min(max(share for _, share in one) for one in off))
    return max(factors), max(shares)


def problem_of(seed: int):
    """Return a random problem, and whether its objectives are whole numbers."""
    draw = np.random.default_rng(seed)
    side = int(draw.integers(4, 30))
    occupied = draw.random((side, side)) < draw.choice([0.0, 0.1, 0.3])
    occupied[0] = occupied[:, -1] = False
    costs = [Cost(name, draw.integers(0, int(draw.choice([2, 5, 100, 10**6])), (side, side))) for name in "ab"]
    kinds = [costs, ["length", Vulnerability(variance=0.5)], [Vulnerability(variance=0.5), "turn"], [*costs, "clearance"]]
    kind = int(draw.integers(len(kinds)))
    coding = str(draw.choice(["cells", "integer"])) if kind != 3 else "cells"
    return GridPathProblem(OccupancyGrid(occupied), (0, 0), (side - 1, side - 1), coding, kinds[kind]), kind == 0


def main() -> None:
    """Print how many certificates were true, and stop at the first that is not."""
    parser = argparse.ArgumentParser(description="Whether what is certified of fronts is true.")
    parser.add_argument("--problems", type=int, default=500)
    arguments = parser.parse_args()
    n_certified = n_none = 0
    tight: list[float] = []
    for seed in range(arguments.problems):
        problem, whole_numbers = problem_of(seed)
        exact = exact_front(problem)
        assert exact.complete
        draw = np.random.default_rng([seed, 1])
        budgets = [Budget(max_labels=int(n)) for n in draw.integers(0, exact.n_labels + 50, 4)]
        asked: list[dict[str, Any]] = [{name: value} for name in ("epsilon", "share") for value in (0.001, 0.02, 0.3)]
        asked += [{"budget": budget} for budget in budgets[1:]] + [{"budget": budgets[0], "epsilon": 0.01}]
        for given in asked:
            found = exact_front(problem, **given)
            if found.certified is None:
                assert "budget" in given, (seed, given)
                n_none += 1
                continue
            factor, share = missed(found.F, exact.F, Fraction(0) if whole_numbers else _ROUNDING)
            room = 0 if whole_numbers else _ROUNDING
            proven = found.certified.epsilon, found.certified.share
            assert factor <= proven[0] + room and share <= proven[1] + room, (seed, given, factor, share, proven)
            if "budget" not in given:
                assert found.success and all(getattr(found.certified, name) <= value for name, value in given.items())
                if len(exact.F) > 20 and "epsilon" in given:
                    tight.append(float(factor) / given["epsilon"])
            n_certified += 1
    print(f"{arguments.problems} problems, {n_certified} certificates, all true; {n_none} fronts without one")
    print(f"of the factor that was allowed, {np.median(tight):.0%} was used where fronts have more than 20 points (median)")


if __name__ == "__main__":
    main()
