#!/usr/bin/env bash
# scikit-image 0.26.0: a route that starts inside a wall is found, and the wall makes it cheaper.
#
# Good guess: negative costs are impassable (MCP's documentation), so a start on such a cell raises ValueError, as an end does.
# Behaviour: only entering a cell is checked. The route leaves the wall; half of the wall's negative cost goes into
#   the first step of the geometric cost, and all of it into the plain one. With walls of -1000 the short route below
#   costs -498.5.
# So: check start and end yourself, or mark walls with inf (then a start in a wall raises).
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
  scikit-image==0.26.0 scipy==1.17.1 numpy==2.4.6
cd "$tmp"
venv/bin/python - <<'PY'
import numpy as np
from skimage.graph import route_through_array

costs = np.array([[-1000.0, 1.0, 1.0]])
path, cost = route_through_array(costs, (0, 0), (0, 2))
print("out of the wall:", [tuple(map(int, p)) for p in path], float(cost))
assert float(cost) == (-1000 + 1) / 2 + 1
path, cost = route_through_array(costs, (0, 0), (0, 2), geometric=False)
print("not geometric  :", float(cost))
assert float(cost) == -998.0
try:
    route_through_array(costs, (0, 2), (0, 0))
except ValueError as error:
    print("into the wall  :", error)
else:
    raise SystemExit("a route into the wall was found")
PY
