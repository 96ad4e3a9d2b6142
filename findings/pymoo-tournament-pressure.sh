#!/usr/bin/env bash
# pymoo 0.6.2: NSGA-III's tournament with a pressure of four is one of two.
#
# Good guess: TournamentSelection(func_comp=comp_by_cv_then_random, pressure=4) returns the best of four, or refuses the four,
#   as NSGA-II's binary_tournament does with a ValueError.
# Behaviour: the comparison takes the first two of each row and never looks at the others. Neither it nor the selection says so:
#   the only feasible one of four loses whenever it stands third or fourth.
# So: leave pressure at 2 with pymoo's comparisons, and write one's own for P.shape[1] contestants.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check pymoo==0.6.2 numpy==2.4.6
cd "$tmp"
venv/bin/python - <<'PY'
import numpy as np
from pymoo.algorithms.moo.nsga2 import binary_tournament
from pymoo.algorithms.moo.nsga3 import comp_by_cv_then_random
from pymoo.core.population import Population
from pymoo.core.problem import Problem
from pymoo.operators.selection.tournament import TournamentSelection

pop = Population.new("X", np.arange(8.0)[:, None])
for k, individual in enumerate(pop):
    individual.set("CV", np.array([0.0 if k == 3 else 1.0 + k]))
rows = np.array([[3, 1, 2, 0], [0, 3, 1, 2], [0, 1, 3, 2], [0, 1, 2, 3]])
won = comp_by_cv_then_random(pop, rows, random_state=np.random.default_rng(1)).ravel().tolist()
print("3 alone is feasible; rows", rows.tolist(), "are won by", won)
assert won == [3, 3, 0, 0]

selection = TournamentSelection(func_comp=comp_by_cv_then_random, pressure=4)
problem = Problem(n_var=1)
picked = selection.do(problem, pop, 250, 4, to_pop=False, random_state=np.random.default_rng(1))
share = (picked == 3).mean()
print(f"the feasible one of eight wins {share:.2f} of the tournaments of four; {4 / 8:.2f} if all four took part")
assert abs(share - 2 / 8) < 0.03

try:
    binary_tournament(pop, rows, algorithm=None)
except ValueError as error:
    print("NSGA-II's comparison refuses them:", error)
else:
    raise AssertionError("NSGA-II's comparison takes four now")
PY
