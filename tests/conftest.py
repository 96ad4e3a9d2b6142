"""Fixtures and independent references that several test files share."""

import os
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

# References are shared by import, whichever folder a test stands in.
sys.path.insert(0, os.path.dirname(__file__))

from hypothesis import settings

settings.register_profile("default", deadline=None)
settings.load_profile("default")

SHARED_DATA = Path(__file__).resolve().parents[2] / "shared" / "data"
