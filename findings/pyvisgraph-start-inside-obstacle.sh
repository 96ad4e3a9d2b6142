#!/usr/bin/env bash
# pyvisgraph 0.2.1: a start inside an obstacle gets a path, and not the straight one.
#
# Good guess: no path, or an exception, or the straight line out.
# Behaviour: from the middle of a square the path runs through the obstacle to a corner and on from there. It looks like any
#   other path and is longer than the straight line, so neither a look at the result nor a length check gives it away.
# So: ask point_in_polygon() for start and goal first.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check pyvisgraph==0.2.1 tqdm==4.70.1
cd "$tmp"
venv/bin/python - <<'PY'
import pyvisgraph as vg

square = [vg.Point(4, 4), vg.Point(6, 4), vg.Point(6, 6), vg.Point(4, 6)]
graph = vg.VisGraph()
graph.build([square], status=False)
for start, goal in (((5, 5), (9, 5)), ((1, 5), (5, 5))):
    path = [(p.x, p.y) for p in graph.shortest_path(vg.Point(*start), vg.Point(*goal))]
    print(start, "->", goal, ":", path)
    assert len(path) == 3 and path[1] in {(4, 4), (6, 4), (6, 6), (4, 6)}
assert graph.point_in_polygon(vg.Point(5, 5)) == 0 and graph.point_in_polygon(vg.Point(1, 5)) == -1
PY
