"""Conformance suites: pytest classes that whoever adds something of their own inherits from.

Inherit one in a test file of your own, say what is to be tested, and run pytest. `pymoo_gridpath.testing.reference` has the
slow ways to measure that suites check against.
"""

import pytest

# Before they are imported, so that their assertions say what the values were.
pytest.register_assert_rewrite("pymoo_gridpath.testing.maps", "pymoo_gridpath.testing.representations")

from pymoo_gridpath.testing.maps import MapFormatSuite  # noqa: E402
from pymoo_gridpath.testing.representations import RepresentationSuite  # noqa: E402

__all__ = ["MapFormatSuite", "RepresentationSuite"]
