"""Published suites of problems, by name; each says whose definitions it follows."""

from pymoo_gridpath.problems.suites.asletismac import Asletismac
from pymoo_gridpath.problems.suites.base import SUITES, Suite, make_suite
from pymoo_gridpath.problems.suites.planners import RegionOfSightMaps, SmallEnvironments
from pymoo_gridpath.problems.suites.search_benchmark import GuardsGrid, RandomCostGrid

__all__ = [
    "SUITES",
    "Asletismac",
    "GuardsGrid",
    "RandomCostGrid",
    "RegionOfSightMaps",
    "SmallEnvironments",
    "Suite",
    "make_suite",
]
