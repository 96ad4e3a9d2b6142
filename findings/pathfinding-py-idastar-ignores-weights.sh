#!/usr/bin/env bash
# pathfinding 1.0.23 (PyPI): IDAStarFinder ignores the weights of the cells.
#
# Good guess: like AStarFinder and DijkstraFinder of the same package it returns the cheapest path of a weighted grid.
# Behaviour: a step costs 1 or sqrt 2 whatever the cell; weights only decide what is blocked. Below it pays 10 where A* pays 4.
# So: IDAStarFinder for grids of 0 and 1 alone.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check pathfinding==1.0.23
cd "$tmp"
venv/bin/python - <<'PY'
from pathfinding.core.diagonal_movement import DiagonalMovement
from pathfinding.core.grid import Grid
from pathfinding.finder.a_star import AStarFinder
from pathfinding.finder.ida_star import IDAStarFinder

rows = [[1, 9, 1], [1, 1, 1]]
cost = {}
for finder in (AStarFinder, IDAStarFinder):
    grid = Grid(matrix=rows)
    nodes, _ = finder(diagonal_movement=DiagonalMovement.never).find_path(grid.node(0, 0), grid.node(2, 0), grid)
    path = [(node.x, node.y) for node in nodes]
    cost[finder.__name__] = sum(rows[y][x] for x, y in path[1:])
    print(finder.__name__, path, "cost", cost[finder.__name__])
assert cost == {"AStarFinder": 4, "IDAStarFinder": 10}
PY
