#!/usr/bin/env bash
# scgraph 3.6.0: GridGraph adds the walls round its grid to the list of blocks that it was given.
#
# Good guess: a list of blocks is read, and serves as well for the next grid.
# Behaviour: add_exterior_walls, which is the default, appends the border cells to the caller's own list. A larger grid
#   made from the same list has the smaller one's border as walls inside: below cells of a map with one block are not connected.
#   Made twice at one size the list only grows, so that what was blocked by the user cannot be told any more.
# So: give a copy, blocks=list(blocks).
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check scgraph==3.6.0
cd "$tmp"
venv/bin/python - <<'PY'
from scgraph.grid import GridGraph


def length(grid):
    try:
        return grid.get_shortest_path((1, 1), (9, 9))["length"]
    except RuntimeError as error:
        return str(error)


blocks = [(3, 3)]
GridGraph(6, 6, blocks)
print("one block was given; after a grid of 6 x 6 there are", len(blocks))
reused, fresh = length(GridGraph(12, 12, blocks)), length(GridGraph(12, 12, [(3, 3)]))
print("12 x 12 from the same list:", reused)
print("12 x 12 from a new list:   ", fresh)
assert len(blocks) > 1 and reused == "The origin and destination nodes are not connected." and 12 < fresh < 13
PY
