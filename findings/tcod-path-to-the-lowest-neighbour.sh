#!/usr/bin/env bash
# tcod 21.2.2: a path of Dijkstra or hillclimb2d costs more than the distance map that it was read from says.
#
# Good guess: tcod.path.Dijkstra, with its default diagonal of 1.41, returns a path of the least cost, and hillclimb2d down a
#   map of dijkstra2d one whose cost is the value at its start.
# Behaviour: the maps are right. Paths are read from them by stepping to the neighbour of the lowest value, whatever the step
#   costs: below a diagonal of 99 to a value lower by 82 is taken where a straight step of 70 led down by 70. The path
#   costs 396 where the map says 379. With a diagonal of 3, dearer than going round by two straight steps of 1, Dijkstra walks it
#   all the same. On random maps with 30 % of cells blocked one path in sixty or so is too long.
# So: Pathfinder, or path2d, which follow the steps by which costs were found.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check tcod==21.2.2 numpy==2.4.6
cd "$tmp"
venv/bin/python - <<'PY'
import numpy as np
import tcod.path

free = np.array([[1, 1, 1, 1, 1], [0, 1, 1, 0, 1], [1, 0, 1, 0, 1], [1, 1, 0, 1, 1]], dtype=np.int8)
start, goal = (0, 0), (2, 4)


def cost(path, straight, diagonal):
    steps = np.abs(np.diff(np.array(path), axis=0)).sum(axis=1)
    return straight * int((steps == 1).sum()) + diagonal * int((steps == 2).sum())


distance = tcod.path.maxarray(free.shape)
distance[start] = 0
tcod.path.dijkstra2d(distance, free, 70, 99, out=distance)
climbed = tcod.path.hillclimb2d(distance, goal, True, True).tolist()
true = tcod.path.path2d(free, start_points=[start], end_points=[goal], cardinal=70, diagonal=99).tolist()
print("map says   ", distance[goal])
print("hillclimb2d", cost(climbed, 70, 99), climbed[::-1])
print("path2d     ", cost(true, 70, 99), true)

search = tcod.path.Dijkstra(free)
search.set_goal(*start)
found = [start, *search.get_path(*goal)]
other = [start, *tcod.path.AStar(free).get_path(*start, *goal)]
print("Dijkstra   ", cost(found, 1, 1.41), found)
print("AStar      ", cost(other, 1, 1.41), other)

dear = tcod.path.Dijkstra(np.ones((2, 2), dtype=np.int8), diagonal=3.0)
dear.set_goal(0, 0)
corner = dear.get_path(1, 1)
print("diagonal=3 ", corner)

assert distance[goal] == cost(true, 70, 99) == 379 and cost(climbed, 70, 99) == 396
assert np.isclose(cost(found, 1, 1.41), 5.64) and np.isclose(cost(other, 1, 1.41), 5.41)
assert corner == [(1, 1)]
PY
