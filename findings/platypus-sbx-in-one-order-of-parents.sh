#!/usr/bin/env bash
# Platypus 1.4.1 (platypus-opt): SBX crosses a gene only if the second parent's is the larger one.
#
# Good guess: each gene is crossed with probability one half, whichever parent has the larger value.
# Behaviour: the difference x2 - x1 is compared with a small number, not its size. Of the parents (2, 8) half of the genes are
#   crossed, of (8, 2) none at all: SBX acts on a quarter of genes where it should on half of them, and a pair's order decides. The
#   code has a branch for the larger first value that nothing reaches.
# So: give SBX parents in both orders, or double what you expect of it.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check platypus-opt==1.4.1
cd "$tmp"
venv/bin/python - <<'PY'
import random

from platypus import SBX, Problem, Real, Solution

random.seed(1)
problem = Problem(1000, 1)
problem.types[:] = Real(0, 10)


def parent(value):
    solution = Solution(problem)
    solution.variables[:] = [value] * 1000
    return solution


share = {}
for first, second in ((2.0, 8.0), (8.0, 2.0)):
    children = SBX(1.0).evolve([parent(first), parent(second)])
    changed = sum(a not in (2.0, 8.0) for a in children[0].variables)
    share[first, second] = changed / 1000
    print(f"parents {first:g} and {second:g}: {changed} of 1000 genes are neither parent's")
assert 0.45 < share[2.0, 8.0] < 0.55 and share[8.0, 2.0] == 0.0
PY
