#!/usr/bin/env bash
# pyoctomap 1.2.2: updateNode(point, numpy.False_) records no miss, and the cell then counts as occupied.
#
# Good guess: numpy's True and False, which indexing a bool map gives, mean hit and miss like Python's.
# Behaviour: only Python's bool is taken for hit or miss; numpy's is taken for a number, a change of the log-odds by 1.0 or
#   0.0. A hit weighs 0.731 in place of 0.7, and a miss creates a node at 0.5, which isNodeOccupied() calls occupied, however
#   often it is repeated. A map copied cell by cell from an array is occupied everywhere.
# So: pass bool(value).
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check pyoctomap==1.2.2 numpy==1.26.4
cd "$tmp"
venv/bin/python - <<'PY'
import numpy as np
import pyoctomap

free_map = np.zeros(1, dtype=bool)
seen = {}
for name, miss in (("Python's False", False), ("numpy's False", free_map[0])):
    tree = pyoctomap.OcTree(0.1)
    point = np.array([1.05, 1.05, 0.05])
    for _ in range(5):
        tree.updateNode(point, miss)
    node = tree.search(point)
    seen[name] = (round(node.getOccupancy(), 3), bool(tree.isNodeOccupied(node)))
    print(f"five misses with {name}: probability {seen[name][0]}, occupied: {seen[name][1]}")
assert seen == {"Python's False": (0.119, False), "numpy's False": (0.5, True)}
PY
