#!/usr/bin/env bash
# xarray-spatial 0.5.3: a_star_search() takes start and goal in coordinates but counts the way in cells.
#
# Good guess: like cost_distance() and proximity() of the same package it measures in the units of the raster's coordinates.
# Behaviour: on a raster of 0.5 m cells the way to the far corner is 7.66 where cost_distance() says 3.83. The two
#   agree only on rasters whose cells are 1, which is what examples use. Where cells are not square, no factor helps.
# So: multiply by the cell size, or read the cells off the result and measure them.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
  xarray-spatial==0.5.3 xarray==2026.9.0 numpy==2.4.6
cd "$tmp"
venv/bin/python -W ignore - <<'PY'
import numpy as np
import xarray as xr
from xrspatial import a_star_search, cost_distance, proximity

coordinates = {"y": np.arange(5)[::-1] * 0.5, "x": np.arange(7) * 0.5}
ground = xr.DataArray(np.ones((5, 7)), dims=["y", "x"], coords=coordinates)
source = ground * 0
source[4, 0] = 1
star = float(a_star_search(ground, (0.0, 0.0), (2.0, 3.0))[0, -1])
cost = float(cost_distance(source, ground)[0, -1])
line = float(proximity(source)[0, -1])
print(f"a_star_search {star:.2f}  cost_distance {cost:.2f}  proximity {line:.2f}")
assert abs(star - (2 + 4 * 2**0.5)) < 1e-6
assert abs(cost - star / 2) < 1e-5 and abs(line - 13**0.5) < 1e-5
PY
