#!/usr/bin/env bash
# mealpy 3.0.3: with IntegerVar the objective is called with fractions and with values outside the bounds.
#
# Good guess: IntegerVar(lb=0, ub=8) hands integers from 0 to 8 to the objective and returns such a solution.
# Behaviour: that holds for its genetic algorithm. PSO, DE and GWO call an objective given as a dictionary's "obj_func" with the
#   raw vector: nearly every call has fractions, some are below 0 or above 8 (bounds -0.5 to 8.4999), and the solution
#   returned is not integer either. Indexing a grid with int(x) then drops -0.4 to 0 and prefers lower values.
# So: derive from Problem and call self.decode_solution(x) first; decode the result too.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
  numpy==1.26.0 scipy==1.16.3 pandas==3.0.6 matplotlib==3.11.2
"$tmp/venv/bin/pip" install --quiet --no-compile --no-deps --disable-pip-version-check mealpy==3.0.3  # the solvers need no more
cd "$tmp"
venv/bin/python -W ignore - <<'PY'
import numpy as np
from mealpy import DE, GA, GWO, PSO, IntegerVar


def run(algorithm):
    seen = []

    def objective(x):
        seen.append(np.array(x, dtype=float))
        return float(((seen[-1] - 4) ** 2).sum())

    problem = {"obj_func": objective, "bounds": IntegerVar(lb=(0,) * 5, ub=(8,) * 5), "minmax": "min", "log_to": None}
    best = algorithm(epoch=20, pop_size=20).solve(problem, seed=1)
    calls = np.array(seen)
    fractions = int((calls != np.rint(calls)).any(axis=1).sum())
    outside = int(((calls < 0) | (calls > 8)).any(axis=1).sum())
    counts = f"{len(calls)} calls, {fractions} with fractions, {outside} outside 0..8"
    print(f"{algorithm.__name__:12} {counts}, best {best.solution}")
    return fractions, outside, best.solution


for algorithm in (PSO.OriginalPSO, DE.OriginalDE, GWO.OriginalGWO):
    fractions, outside, solution = run(algorithm)
    assert fractions > 300 and outside > 0 and (solution != np.rint(solution)).any()
fractions, outside, solution = run(GA.BaseGA)
assert fractions == 0 and outside == 0
PY
