#!/usr/bin/env bash
# tcod 21.2.2: path2d with one start and one end pays for the cells that it leaves, Pathfinder for those that it enters.
#
# Good guess: both return the cheapest path by the rule of the package, under which a step costs the cost of the node that it
#   leads to times cardinal or diagonal.
# Behaviour: path2d searches from the end to the start and turns the path round, so that each step costs the node where it
#   begins, and the start counts 1. With costs that differ its path is another one: below it costs 1060 where that of
#   Pathfinder costs 688. Asked for the way back, path2d finds that of 688. Two in five random maps of 3 x 4 are like that.
# So: Pathfinder.add_root(start) and path_to(end) for costs of terrain, or path2d from the end to the start.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check tcod==21.2.2 numpy==2.4.6
cd "$tmp"
venv/bin/python - <<'PY'
import numpy as np
import tcod.path

cost = np.array([[7, 7, 9, 2], [7, 9, 1, 2], [7, 7, 6, 1]])
start, end = (0, 0), (2, 3)


def entering(path):
    return sum((99 if a[0] != b[0] and a[1] != b[1] else 70) * int(cost[tuple(b)]) for a, b in zip(path, path[1:]))


finder = tcod.path.Pathfinder(tcod.path.SimpleGraph(cost=cost, cardinal=70, diagonal=99))
finder.add_root(start)
paths = {
    "Pathfinder.path_to": finder.path_to(end).tolist(),
    "path2d": tcod.path.path2d(cost, start_points=[start], end_points=[end], cardinal=70, diagonal=99).tolist(),
    "path2d, back": tcod.path.path2d(cost, start_points=[end], end_points=[start], cardinal=70, diagonal=99).tolist()[::-1],
}
for name, path in paths.items():
    print(f"{name:18}", path, "costs", entering(path))
print("distance of Pathfinder at the end:", finder.distance[end])
assert finder.distance[end] == entering(paths["Pathfinder.path_to"]) == entering(paths["path2d, back"]) == 688
assert entering(paths["path2d"]) == 1060
PY
