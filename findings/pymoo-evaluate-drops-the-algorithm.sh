#!/usr/bin/env bash
# pymoo 0.6.2: a problem does not get the algorithm=... that the evaluator passes on for it.
#
# Good guess: Evaluator.eval(problem, pop, algorithm=...) hands its keyword arguments to Problem.evaluate, and that to
#   _evaluate(x, out, *args, **kwargs), whose signature is there to take them.
# Behaviour: Problem.evaluate calls _evaluate(X, out) without them unless the problem was made with requires_kwargs=True, an
#   argument that the documentation of problems does not name. The dictionary is empty, and nothing is said.
# So: a problem that wants to know the generation (a penalty that rises, say) needs super().__init__(requires_kwargs=True).
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check pymoo==0.6.2 numpy==2.4.6
cd "$tmp"
venv/bin/python - <<'PY'
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.core.problem import Problem
from pymoo.optimize import minimize


class Sphere(Problem):
    def __init__(self, **options):
        super().__init__(n_var=2, n_obj=1, xl=-1.0, xu=1.0, **options)
        self.seen = set()

    def _evaluate(self, x, out, *args, **kwargs):
        self.seen |= set(kwargs)
        out["F"] = (x**2).sum(axis=1)


plain, asking = Sphere(), Sphere(requires_kwargs=True)
for problem in (plain, asking):
    minimize(problem, GA(pop_size=10), ("n_gen", 2), seed=1, copy_algorithm=False)
print("keywords in _evaluate:", plain.seen or "none", "| with requires_kwargs=True:", asking.seen)
assert plain.seen == set()
assert "algorithm" in asking.seen
PY
