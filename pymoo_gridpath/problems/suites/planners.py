"""The maps on which the companions' papers compare planners."""

from __future__ import annotations

import functools

from pymoo_gridpath import checks
from pymoo_gridpath.objectives import Length, Vulnerability
from pymoo_gridpath.problems.environments import small_environment
from pymoo_gridpath.problems.scenarios import concave_environment, convex_environment, far_corners, maze_environment
from pymoo_gridpath.problems.suites.base import SUITES, Suite

_KINDS = {"convex": convex_environment, "concave": concave_environment, "maze": maze_environment}


class _Environment(Suite):
    """A map without objectives of its own: length and vulnerability."""

    @functools.cached_property
    def objectives(self):
        return Length(), Vulnerability()


@SUITES.register
class SmallEnvironments(_Environment):
    """One of the six environments of 10 x 10 cells of Rajchandar et al.

    Parameters
    ----------
    environment : {"spiral", "caved", "warehouse-alike", "zigzag", "random", "narrow way"}
        See `small_environment`.
    corner_cutting : bool, default False
        Whether a diagonal step may pass an occupied cell.

    Raises
    ------
    GridError
        If there is no such environment, or an argument is of another kind.

    References
    ----------
    Rajchandar et al. (2021), section 3 and Table 2.
    """

    name = "small-environments"
    follows = (
        "follows the names, the size and the lengths of shortest paths that Rajchandar et al. (2021) print; the layouts are "
        "lost, and these were drawn after them"
    )

    def __init__(self, environment: str, corner_cutting: bool = False):
        self.environment, self.corner_cutting = environment, corner_cutting
        small_environment(environment, corner_cutting)

    @property
    def label(self):
        return self.environment + {True: ", corners cut", "one side": ", corners cut on one side"}.get(self.corner_cutting, "")

    @functools.cached_property
    def query(self):
        return small_environment(self.environment, self.corner_cutting)


@SUITES.register
class RegionOfSightMaps(_Environment):
    """A map of one of the three kinds of Hliwa and Atieh, from corner to corner.

    Parameters
    ----------
    kind : {"convex", "concave", "maze"}
        See `convex_environment`, `concave_environment` and `maze_environment`.
    seed : int, default 1

    Raises
    ------
    GridPathError
        If there is no such kind, or the seed is no whole number.

    References
    ----------
    H. Hliwa and B. Atieh, "Multi objective path planning in static environment using region of sight", section III.
    """

    name = "region-of-sight"
    follows = (
        "follows the kinds and sizes of the three environments of Hliwa and Atieh (region of sight, section III); the maps are "
        "lost, and these are drawn at random"
    )

    def __init__(self, kind: str, seed: int = 1):
        self.kind = checks.known("kind of environment", kind, _KINDS)
        self.seed = checks.whole("seed", seed, 0)

    @property
    def label(self):
        return f"{self.kind}-{self.seed}"

    @functools.cached_property
    def query(self):
        grid = _KINDS[self.kind](self.seed)
        return grid, *far_corners(grid)
