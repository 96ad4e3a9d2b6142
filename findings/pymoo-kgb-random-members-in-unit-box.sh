#!/usr/bin/env bash
# pymoo 0.6.2: KGB fills its population up with members drawn from [0, 1], whatever the bounds of the problem are.
#
# Good guess: an algorithm for dynamic problems draws new random members between xl and xu, as its first population is drawn;
#   the docstring of random_strategy says "within the problem boundaries".
# Behaviour: they are drawn from the unit box and cut to the bounds. On pymoo's own DF4, whose variables lie in [-2, 2], none is
#   negative, so that a sixteenth of the square of the first two variables is drawn from; with bounds of 10 and 20 all are one
#   member, the lower bounds.
# So: scale the variables of a problem to [0, 1] before KGB is measured on it, or repair what it draws.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check pymoo==0.6.2 numpy==2.4.6 scikit-learn==1.9.1
cd "$tmp"
venv/bin/python - <<'PY'
import numpy as np
from pymoo.algorithms.moo.kgb import KGB
from pymoo.problems.dyn import DynamicTestProblem
from pymoo.problems.dynamic.df import DF4


class Shifted(DynamicTestProblem):
    def __init__(self):
        super().__init__(2, 5, n_var=3, n_obj=2, xl=10.0, xu=20.0)

    def _evaluate(self, x, out, *args, **kwargs):
        out["F"] = np.stack([x[:, 0], 30 - x[:, 0] + (x[:, 1:] - 10 - self.time).sum(axis=1) ** 2], axis=1)


def drawn(problem):
    algorithm = KGB(pop_size=20)
    algorithm.setup(problem, seed=1, termination=("n_gen", 3))
    algorithm.next()
    first = algorithm.pop.get("X")
    random = algorithm.random_strategy(1000)
    name = type(problem).__name__
    print(f"{name}: bounds {problem.xl[0]:g} to {problem.xu[0]:g}; first population {first.min():.2f} to {first.max():.2f};"
          f" random members {random.min():.2f} to {random.max():.2f}, {len(np.unique(random, axis=0))} different of 1000")
    return random


random = drawn(DF4(n_var=5))
assert random.min() >= 0.0 and random.max() <= 1.0
assert (drawn(Shifted()) == 10.0).all()
PY
