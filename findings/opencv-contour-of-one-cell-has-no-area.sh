#!/usr/bin/env bash
# opencv 4.11.0.86: obstacles taken from a grid with findContours() are half a cell too small all round; lone cells have area 0.
#
# Good guess: the contour of a block of 3 x 3 occupied cells has the area 9.
# Behaviour: contours join the centres of the outermost cells, so its area is 4. A lone cell and a wall one cell thick have
#   area 0, and the usual filter "drop contours with a small area" removes whole walls. Polygons handed to a planner
#   leave out half of each border cell.
# So: count cells (connectedComponentsWithStats), or buffer the polygon by half a cell.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
  opencv-python-headless==4.11.0.86 numpy==1.26.4
cd "$tmp"
venv/bin/python - <<'PY'
import cv2
import numpy as np

areas = {}
shapes = {"block of 3 x 3": (slice(2, 5), slice(2, 5)), "lone cell": (3, 3), "wall of 1 x 20": (3, slice(1, 21))}
for name, cells in shapes.items():
    grid = np.zeros((7, 22), dtype=np.uint8)
    grid[cells] = 1
    contours, _ = cv2.findContours(grid, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    counted = cv2.connectedComponentsWithStats(grid)[2][1, cv2.CC_STAT_AREA]
    areas[name] = [cv2.contourArea(contour) for contour in contours]
    print(f"{name:14} cells {counted:2}  contourArea {areas[name]}")
assert areas == {"block of 3 x 3": [4.0], "lone cell": [0.0], "wall of 1 x 20": [0.0]}
PY
