#!/usr/bin/env bash
# jMetalPy 1.9.0, Platypus 1.4.1: IGD and GD are not both means, and each library has them the other way round.
#
# Good guess: GD and IGD are the mean of the distances to the nearest point, as pymoo has them ("measures the average
#   distance" in jMetalPy's own words), so that a denser reference front changes IGD little.
# Behaviour: jMetalPy's GD is the mean, but its IGD is sqrt(sum d^2) / N. The same solutions against the same front sampled
#   16 times as densely have a quarter of the IGD. In Platypus IGD is the mean and GD is sqrt(sum d^2) / N (after it has
#   normalised by the reference front). Figures from two studies compare only if library and front size are the same.
# So: compute the mean of the nearest distances yourself, or name the formula beside the figure.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
  Platypus-Opt==1.4.1 moocore==0.3.2 scipy==1.17.1 numpy==2.4.6
"$tmp/venv/bin/pip" install --quiet --no-compile --no-deps --disable-pip-version-check \
  jmetalpy==1.9.0  # indicators need no more
cd "$tmp"
venv/bin/python - <<'PY'
import math

import numpy as np
from jmetal.core.quality_indicator import GenerationalDistance, InvertedGenerationalDistance
from platypus import GenerationalDistance as PlatypusGD
from platypus import InvertedGenerationalDistance as PlatypusIGD
from platypus import Problem, Solution


def line(n, lift=0.0):
    t = np.linspace(0, 1, n)
    return np.column_stack([t, 1 - t]) + lift


def solutions(points):
    problem, made = Problem(1, 2), []
    for point in points:
        solution = Solution(problem)
        solution.objectives[:] = point.tolist()
        solution.evaluated, solution.feasible = True, True
        made.append(solution)
    return made


front, dense = line(10, lift=0.1), line(160)
for n in (10, 160):
    reference = line(n)
    nearest = np.sqrt(((reference[:, None] - front) ** 2).sum(2)).min(1)
    igd = InvertedGenerationalDistance(reference).compute(front)
    print(f"reference of {n:3}: mean {nearest.mean():.4f}  jMetalPy IGD {igd:.4f}")
    assert math.isclose(igd, math.sqrt((nearest**2).sum()) / n)
    if n == 10:
        first, first_mean = igd, nearest.mean()
assert 3.5 < first / igd < 4.5 and 0.7 < first_mean / nearest.mean() < 1.3

nearest = np.sqrt(((front[:, None] - dense) ** 2).sum(2)).min(1)
gd = GenerationalDistance(dense).compute(front)
print(f"GD: mean {nearest.mean():.4f}  jMetalPy {gd:.4f}", end="  ")
platypus_gd = PlatypusGD(reference_set=solutions(dense)).calculate(solutions(front))
print(f"Platypus {platypus_gd:.4f}")
assert math.isclose(gd, nearest.mean())
assert math.isclose(platypus_gd, math.sqrt((nearest**2).sum()) / len(front))
inverted = np.sqrt(((dense[:, None] - front) ** 2).sum(2)).min(1).mean()
platypus_igd = PlatypusIGD(reference_set=solutions(dense)).calculate(solutions(front))
print(f"IGD: mean {inverted:.4f}  Platypus {platypus_igd:.4f}")
assert math.isclose(platypus_igd, inverted)
PY
