"""Fixtures and independent references that several test files share."""

import os
import sys

import matplotlib

matplotlib.use("Agg")

# References are shared by import, whichever folder a test stands in.
sys.path.insert(0, os.path.dirname(__file__))

from hypothesis import settings

settings.register_profile("default", deadline=None)
settings.load_profile("default")
