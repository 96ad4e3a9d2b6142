#!/usr/bin/env bash
# arcade 3.3.3: astar_calculate_path says that there is no path once it has looked at 500 cells, on an open field too.
#
# Good guess: None means what the documentation says, that no path is found because there is none.
# Behaviour: the search ends after 500 cells without a word. Its estimate, the larger of what is left in x and in y, is weak,
#   so that 500 cells are soon used up: on an empty field of 100 x 100 cells the goal 40 cells to the right and 20 up has no path,
#   with diagonals and without; the one 40 cells straight ahead has. A wall in the way makes it far worse: below, a goal 12 cells
#   off, behind a wall of 29, is not found.
# So: treat None as not known, and search grids of more than some 20 cells a side with something else.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check arcade==3.3.3
cd "$tmp"
venv/bin/python - <<'PY'
from collections import deque

import arcade

CELL, SIDE = 10, 100
mover = arcade.SpriteSolidColor(CELL - 2, CELL - 2)


def field(walls):
    sprites = arcade.SpriteList(lazy=True)
    # One at least, outside the field.
    for x, y in [(-50, -50), *walls]:
        sprites.append(arcade.SpriteSolidColor(CELL - 2, CELL - 2, center_x=CELL * x, center_y=CELL * y))
    return arcade.AStarBarrierList(mover, sprites, CELL, 0, CELL * (SIDE - 1), 0, CELL * (SIDE - 1))


def steps(barriers, start, goal):
    """Return the fewest straight steps between two cells, by breadth-first search among the library's own barriers."""
    blocked, found, queue = set(barriers.barrier_list), {start: 0}, deque([start])
    while queue:
        x, y = queue.popleft()
        for cell in ((x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)):
            if cell not in found and cell not in blocked and 0 <= cell[0] < SIDE and 0 <= cell[1] < SIDE:
                found[cell] = found[x, y] + 1
                queue.append(cell)
    return found[goal]


empty, walled = field([]), field([(20, y) for y in range(29)])
answers = {}
for name, barriers, start, goal in (
    ("empty", empty, (0, 0), (40, 0)),
    ("empty", empty, (0, 0), (30, 15)),
    ("empty", empty, (0, 0), (40, 20)),
    ("walled", walled, (14, 5), (26, 5)),
):
    for diagonal in (False, True):
        pixels = [(CELL * x, CELL * y) for x, y in (start, goal)]
        path = arcade.astar_calculate_path(*pixels, barriers, diagonal_movement=diagonal)
        answers[name, goal, diagonal] = path is not None
        says = f"a path of {len(path)} cells" if path else "None"
        print(f"{name} field, {start} to {goal}, diagonal={diagonal}: {says}; straight steps: {steps(barriers, start, goal)}")
assert all(found == (goal in ((40, 0), (30, 15))) for (_, goal, _), found in answers.items())
PY
