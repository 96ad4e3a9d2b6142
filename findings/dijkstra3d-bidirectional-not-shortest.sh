#!/usr/bin/env bash
# dijkstra3d 1.15.2: bidirectional=True finds costlier paths than the plain search.
#
# Good guess: it is the same search from both ends, faster and as exact (its documentation promises speed for memory).
# Behaviour: in about 7 % of random 9 x 9 fields of costs 1 to 19 the path is costlier, never cheaper; below on 3 x 3. The
#   option compass=True keeps the optimum.
# So: use the plain search or the compass where a length is a reference.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check dijkstra3d==1.15.2 numpy==2.4.6
cd "$tmp"
venv/bin/python - <<'PY'
import dijkstra3d
import numpy as np

field = np.array([[8, 7, 7], [8, 9, 6], [5, 4, 5]], dtype=np.float32)
cost = {}
for name, options in (("plain", {}), ("compass", {"compass": True}), ("bidirectional", {"bidirectional": True})):
    path = [tuple(map(int, cell)) for cell in dijkstra3d.dijkstra(field, (0, 0), (2, 2), **options)]
    cost[name] = sum(float(field[cell]) for cell in path[1:])  # a step costs the cell that it enters
    print(f"{name:14} cost {cost[name]:g}  {path}")
assert cost == {"plain": 14, "compass": 14, "bidirectional": 17}
PY
