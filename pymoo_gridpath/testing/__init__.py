"""Conformance suites: pytest classes that whoever adds something of their own inherits from.

Inherit one in a test file of your own, say what is to be tested, and run pytest. `pymoo_gridpath.testing.reference` has the
slow ways to measure that suites check against.
"""

import pytest

# Before they are imported, so that their assertions say what the values were.
pytest.register_assert_rewrite(
    *(
        f"pymoo_gridpath.testing.{name}"
        for name in ("algorithms", "maps", "objectives", "operators", "planners", "representations", "suites")
    )
)

from pymoo_gridpath.testing.algorithms import AlgorithmSuite  # noqa: E402
from pymoo_gridpath.testing.maps import MapFormatSuite  # noqa: E402
from pymoo_gridpath.testing.objectives import ObjectiveSuite  # noqa: E402
from pymoo_gridpath.testing.operators import OperatorSuite  # noqa: E402
from pymoo_gridpath.testing.planners import PlannerSuite  # noqa: E402
from pymoo_gridpath.testing.representations import RepresentationSuite  # noqa: E402
from pymoo_gridpath.testing.suites import SuiteSuite  # noqa: E402

__all__ = [
    "AlgorithmSuite",
    "MapFormatSuite",
    "ObjectiveSuite",
    "OperatorSuite",
    "PlannerSuite",
    "RepresentationSuite",
    "SuiteSuite",
]
