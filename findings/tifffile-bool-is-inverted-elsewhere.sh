#!/usr/bin/env bash
# tifffile 2026.3.3: a bool map comes back inverted in Pillow and OpenCV.
#
# Good guess: True is written as 1 (or 255) and read back as something that is true.
# Behaviour: bool is stored in one bit with photometric "min is white", so True means black. tifffile (and imageio through it)
#   reads the bits as they are; Pillow and OpenCV honour the tag and give False or 0 for True. Obstacles become free space.
# So: write uint8 0/255, or pass photometric="minisblack".
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
  tifffile==2026.3.3 pillow==13.0.0 opencv-python-headless==4.11.0.86 numpy==1.26.4
cd "$tmp"
venv/bin/python - <<'PY'
import cv2
import numpy as np
import tifffile
from PIL import Image

occupied = np.array([[True, False, True]])
seen = {}
for name, options in (("plain.tif", {}), ("minisblack.tif", {"photometric": "minisblack"})):
    tifffile.imwrite(name, occupied, **options)
    seen[name] = [
        tifffile.imread(name).astype(bool)[0].tolist(),
        np.asarray(Image.open(name)).astype(bool)[0].tolist(),
        cv2.imread(name, cv2.IMREAD_UNCHANGED).astype(bool)[0].tolist(),
    ]
    print(name, dict(zip(("tifffile", "pillow", "opencv"), seen[name])))
right, inverted = [True, False, True], [False, True, False]
assert seen["plain.tif"] == [right, inverted, inverted]
assert seen["minisblack.tif"] == [right, right, right]
PY
