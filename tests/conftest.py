"""Fixtures and independent references that several test files share."""

import gc
import os
import sys

import matplotlib
import pytest

matplotlib.use("Agg")

# References are shared by import, whichever folder a test stands in.
sys.path.insert(0, os.path.dirname(__file__))

from hypothesis import settings

# Where a change is judged the examples are the same each time; at home each run looks at others.
settings.register_profile("default", deadline=None, derandomize=bool(os.environ.get("CI")))
settings.load_profile("default")

# What is collected stays until the end: looking through it for garbage would take a third of the time of collecting tests, and
# a twentieth of that of running them.
gc.disable()


def pytest_collection_finish():
    gc.freeze()
    gc.enable()


@pytest.fixture
def undrawn(monkeypatch):
    """Figures are made, and stay empty where they are saved: for tests that do not look at them, but at what is beside them."""
    monkeypatch.setattr("matplotlib.figure.Figure.savefig", lambda figure, *args, **kwargs: None)
