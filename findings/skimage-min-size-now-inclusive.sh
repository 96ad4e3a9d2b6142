#!/usr/bin/env bash
# scikit-image 0.26.0: remove_small_objects(map, min_size=4) now removes objects of 4 cells too.
#
# Good guess: min_size is deprecated but still keeps its meaning (smaller than min_size goes, min_size stays).
# Behaviour: it acts like the new max_size, which includes the bound. A FutureWarning says that the new parameter is
#   inclusive, not that the old one has become so. Obstacles of just that size vanish from cleaned maps, and maps
#   differ between versions of the library with the same call.
# So: write max_size=n - 1.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
for version in 0.25.2 0.26.0; do
  python3 -m venv "$tmp/$version"
  "$tmp/$version/bin/pip" install --quiet --no-compile --disable-pip-version-check \
    "scikit-image==$version" scipy==1.17.1 numpy==2.4.6
done
cd "$tmp"
for version in 0.25.2 0.26.0; do
  "$version/bin/python" -W ignore - <<'PY'
import numpy as np
import skimage
from skimage.morphology import remove_small_objects

obstacles = np.zeros((3, 6), dtype=bool)
obstacles[0, :5] = True  # five cells
obstacles[2, :4] = True  # four cells
left = {size: int(remove_small_objects(obstacles, min_size=size).sum()) for size in (3, 4, 5)}
print(skimage.__version__, "cells left by min_size:", left)
assert left == ({3: 9, 4: 9, 5: 5} if skimage.__version__ == "0.25.2" else {3: 9, 4: 5, 5: 0})
PY
done
