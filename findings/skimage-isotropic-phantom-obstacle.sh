#!/usr/bin/env bash
# scikit-image 0.26.0: inflating an empty map with isotropic_dilation() makes an obstacle in the corner (0, 0).
#
# Good guess: no obstacle in, no obstacle out; and isotropic_erosion() of a wholly true mask leaves it alone.
# Behaviour: both threshold a distance transform, which without any background measures from a cell outside the array, one
#   above row 0 in column 0. Inflating an empty map by 3 cells occupies 7 cells at that corner; eroding a free map
#   takes them away. One obstacle anywhere, and the corner is right again, so it shows on open maps and tiles alone.
# So: use binary_dilation with a disk, or return early when nothing is occupied.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check scikit-image==0.26.0 scipy==1.17.1 numpy==2.4.6
cd "$tmp"
venv/bin/python - <<'PY'
import numpy as np
from skimage.morphology import dilation, disk, isotropic_dilation, isotropic_erosion

empty = np.zeros((5, 5), dtype=bool)
inflated = isotropic_dilation(empty, 3)
eroded = isotropic_erosion(~empty, 3)
print("empty map, inflated by 3:\n", inflated.astype(int))
assert inflated.sum() == 7 and inflated[0, 0] and inflated[2, 0]
assert (~eroded).sum() == 7 and not eroded[0, 0]
assert not dilation(empty, disk(3)).any()
with_one = empty.copy()
with_one[4, 4] = True
assert not isotropic_dilation(with_one, 3)[0, 0]
PY
