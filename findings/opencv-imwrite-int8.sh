#!/usr/bin/env bash
# opencv 4.11.0.86: an int8 occupancy array is written as an image in which unknown (-1) has become 0.
#
# Good guess: imwrite() refuses int8 for PGM and PNG, which have no signed samples, as it refuses bool; or it wraps -1 to 255.
# Behaviour: it clips to 0..255, writes a line to the log and returns True. Unknown cells and free cells (0) are the same
#   from then on; read back by map_server's rule, both are black. TIFF keeps int8.
# So: turn occupancy into grey values before writing (254 free, 0 occupied, 205 unknown), and check the dtype.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check opencv-python-headless==4.11.0.86 numpy==1.26.4
cd "$tmp"
venv/bin/python - <<'PY'
import cv2
import numpy as np

occupancy = np.array([[0, -1, 100]], dtype=np.int8)
for name in ("map.pgm", "map.png", "map.tif"):
    returned = cv2.imwrite(name, occupancy)
    back = cv2.imread(name, cv2.IMREAD_UNCHANGED)
    print(name, "imwrite:", returned, "read back:", back.dtype, back.tolist())
    assert returned is True
    assert back.tolist() == ([[0, -1, 100]] if name == "map.tif" else [[0, 0, 100]])
PY
