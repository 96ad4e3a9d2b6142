#!/usr/bin/env bash
# pymoo 0.6.2: once NSGA-III has run, Python's warnings are off for the rest of the process.
#
# Good guess: a library that wants no warning from a division wraps it in warnings.catch_warnings(), so that the filters are
#   afterwards what they were.
# Behaviour: get_nadir_point in nsga3.py calls warnings.simplefilter("ignore") and never takes it back. Every later warning of
#   the process is lost, of whatever package, numpy's overflows and a user's own included.
# So: put a run of NSGA-III (and of what uses its normalisation) inside warnings.catch_warnings().
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check pymoo==0.6.2 numpy==2.4.6
cd "$tmp"
venv/bin/python - 2>stderr.txt <<'PY'
import sys
import warnings

from pymoo.algorithms.moo.nsga3 import NSGA3
from pymoo.optimize import minimize
from pymoo.problems import get_problem
from pymoo.util.ref_dirs import get_reference_directions

before = list(warnings.filters)
warnings.warn("before the run")
directions = get_reference_directions("das-dennis", 3, n_partitions=4)
minimize(get_problem("dtlz2"), NSGA3(directions), ("n_gen", 3), seed=1)
warnings.warn("after the run")
print("first filter before", before[0][:3])
print("first filter after ", warnings.filters[0][:3])
assert warnings.filters[0][:2] == ("ignore", None) and before[0] != warnings.filters[0]
PY
grep -q "before the run" stderr.txt
if grep -q "after the run" stderr.txt; then
  echo "the second warning is shown now"
  exit 1
fi
echo "the second warning was not shown"
