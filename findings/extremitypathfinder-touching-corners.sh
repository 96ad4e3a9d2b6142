#!/usr/bin/env bash
# extremitypathfinder 2.7.2: two grid cells that touch at a corner are a door on one diagonal and an error on the other.
#
# Good guess: obstacles that share a corner point close the gap between them; in any case a map and its mirror image
#   behave alike (store_grid_world() is made for grid maps, where such cells are common).
# Behaviour: with blocked cells (4, 4) and (5, 3) the path runs exactly through the shared corner. With (4, 4) and (5, 5)
#   store_grid_world() raises LinAlgError (a singular matrix).
# So: fill or open such corners before handing a grid over.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check extremitypathfinder==2.7.2 numpy==1.26.4
cd "$tmp"
venv/bin/python - <<'PY'
from extremitypathfinder import PolygonEnvironment


def plan(blocked, start, goal):
    environment = PolygonEnvironment()
    environment.store_grid_world(10, 10, blocked, simplify=False, validate=True)
    return environment.find_shortest_path(start, goal)


path, length = plan([(4, 4), (5, 3)], (4.5, 3.5), (5.5, 4.5))
print("falling diagonal:", path, round(length, 4))
assert abs(length - 2**0.5) < 1e-9  # straight through the corner that both cells share
try:
    plan([(4, 4), (5, 5)], (4.5, 5.5), (5.5, 4.5))
except ValueError as error:
    print("rising diagonal :", type(error).__name__, error)
    assert type(error).__name__ == "LinAlgError"
else:
    raise SystemExit("the rising diagonal has a path now")
PY
