#!/usr/bin/env bash
# opencv 4.11.0.86: the same PGM map has other grey values as text (P2) than as bytes (P5) when its maxval is not 255.
#
# Good guess: imread(IMREAD_UNCHANGED) gives the stored values of both (or scales both, as Pillow does).
# Behaviour: bytes come as stored, text is scaled to 0..255. With maxval 100 (percentages) a cell of 50 is 50 in one
#   file and 127 in the other, so thresholds on grey values give two different maps. Pillow scales both, netpbmfile neither.
# So: read the maxval yourself and divide, or write maps with maxval 255 alone.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check \
  opencv-python-headless==4.11.0.86 numpy==1.26.4 pillow==13.0.0 netpbmfile==2026.1.29
cd "$tmp"
venv/bin/python - <<'PY'
from pathlib import Path

import cv2
import netpbmfile
import numpy as np
from PIL import Image

Path("text.pgm").write_bytes(b"P2\n3 1\n100\n0 50 100\n")
Path("bytes.pgm").write_bytes(b"P5\n3 1\n100\n" + bytes([0, 50, 100]))
seen = {}
for name in ("text.pgm", "bytes.pgm"):
    seen[name] = {
        "opencv": cv2.imread(name, cv2.IMREAD_UNCHANGED)[0].tolist(),
        "pillow": np.asarray(Image.open(name))[0].tolist(),
        "netpbmfile": netpbmfile.imread(name)[0].tolist(),
    }
    print(name, seen[name])
assert seen["text.pgm"] == {"opencv": [0, 127, 255], "pillow": [0, 128, 255], "netpbmfile": [0, 50, 100]}
assert seen["bytes.pgm"] == {"opencv": [0, 50, 100], "pillow": [0, 128, 255], "netpbmfile": [0, 50, 100]}
PY
