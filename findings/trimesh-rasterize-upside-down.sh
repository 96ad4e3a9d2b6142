#!/usr/bin/env bash
# trimesh 5.2.0: Path2D.rasterize() returns an image whose row 0 is the lowest y.
#
# Good guess: what comes back is a PIL image, so row 0 is the top, as in every image and as map_server wants it.
# Behaviour: row 0 holds the lowest y. Saved as a map's image the floor plan is upside down. Shapes are also one cell too
#   large on the upper side: a strip 2 cells high fills 3 rows, for cells on the outline are filled.
# So: flip before saving (np.flipud), keep it as it is for OccupancyGrid's row order, and mind the extra cell.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
  trimesh==5.2.0 shapely==2.2.0 networkx==3.6.1 scipy==1.17.1 pillow==13.0.0 numpy==2.4.6
cd "$tmp"
venv/bin/python - <<'PY'
import numpy as np
import trimesh
from shapely.geometry import Polygon

# an L: a strip along y = 0 .. 1, four wide, and a post at x = 0 .. 1 up to y = 3
outline = trimesh.load_path(Polygon([(0, 0), (4, 0), (4, 1), (1, 1), (1, 3), (0, 3)]))
image = outline.rasterize(pitch=0.5, origin=(0, 0), resolution=(8, 6))
cells = np.asarray(image).astype(int)
print(type(image).__name__, image.size)
print(cells)
assert cells[0].all() and cells[-1].sum() == 3  # the strip at the lowest y is row 0
assert cells.all(axis=1).sum() == 3  # three rows for a height of 1.0 at pitch 0.5
PY
