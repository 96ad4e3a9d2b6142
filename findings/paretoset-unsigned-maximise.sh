#!/usr/bin/env bash
# paretoset 1.2.5: maximising columns of unsigned integers gives the wrong set.
#
# Good guess: sense="max" works for any numeric dtype (grey values of a map are uint8).
# Behaviour: the column is negated in its own dtype. In uint8 -1 is 255, -2 is 254 and so on, but -0 is still 0, so a row of
#   zeros, the worst there is, beats everything. int8 has the same trap at -128. No warning.
# So: convert to float before asking.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check paretoset==1.2.5 numpy==2.4.6
cd "$tmp"
venv/bin/python - <<'PY'
import numpy as np
from paretoset import paretoset

values = np.array([[0, 3], [1, 2], [2, 1], [0, 0]], dtype=np.uint8)
unsigned = paretoset(values, sense=["max", "max"]).tolist()
floats = paretoset(values.astype(float), sense=["max", "max"]).tolist()
print("rows ", values.tolist())
print("uint8", unsigned)
print("float", floats)
assert floats == [True, True, True, False]
assert unsigned == [False, False, False, True]
PY
