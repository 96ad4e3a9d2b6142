"""The objectives of the package pass the suite, and faulty ones do not."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from pymoo_gridpath.neighbourhood import HEADING_OF, HEADINGS
from pymoo_gridpath.objectives import LeastClearance, Length, Objective, Turn, Vulnerability
from pymoo_gridpath.testing.objectives import ObjectiveSuite


def heights(grid):
    y, x = np.indices(grid.shape)
    return (3.0 * x + 5.0 * y) % 4


class Climb(Objective):
    """Metres climbed: what a step from one cell to the next rises."""

    name, label = "climb", "Metres climbed"

    def moves(self, grid):
        height = heights(grid)
        cost = np.full((8, *grid.shape), np.nan)
        for m, (dx, dy) in enumerate(HEADINGS):
            for y, x in np.ndindex(grid.shape):
                if 0 <= x - dx < grid.width and 0 <= y - dy < grid.height:
                    cost[m, y, x] = max(height[y, x] - height[y - dy, x - dx], 0.0)
        return cost


class Work(Objective):
    """A bit of each kind of cost."""

    name, label, turn_cost = "work", "Work [J]", 0.75

    def field(self, grid):
        return heights(grid)

    def moves(self, grid):
        return 2.0, 2.0 * math.sqrt(2)


class Highest(Objective):
    name, label, combine = "highest", "Highest cell", "greatest"

    def field(self, grid):
        return heights(grid)


class Lowest(Highest):
    """The best cell decides: a detour to it is worth while, and no front of that is known."""

    name, combine = "lowest", "least"


class Gain(Highest):
    """A sum to be maximised: paths would not end."""

    name, combine, maximise = "gain", "sum", True


class Cells(Objective):
    """A rule of its own, that nothing is known of."""

    name, label = "roughness", "Square of the length"

    def __call__(self, paths, prepared):
        return paths.length**2


class TestLength(ObjectiveSuite):
    objective = Length()


class TestVulnerability(ObjectiveSuite):
    objective = Vulnerability(variance=1.5)


class TestTurn(ObjectiveSuite):
    objective = Turn()


class TestClimb(ObjectiveSuite):
    objective = Climb()


class TestWork(ObjectiveSuite):
    objective = Work()


class TestHighest(ObjectiveSuite):
    objective = Highest()


class TestLowest(ObjectiveSuite):
    objective = Lowest()


class TestGain(ObjectiveSuite):
    objective = Gain()


class TestLeastClearance(ObjectiveSuite):
    objective = LeastClearance()


class TestRuleOfItsOwn(ObjectiveSuite):
    objective = Cells()


# -- faults ---------------------------------------------------------------------------------------------------------------


class Twice(Work):
    def __call__(self, paths, prepared):
        return 2.0 * super().__call__(paths, prepared)


class FromTheCellLeft(Climb):
    """Looks its costs up at the cell that a step leaves."""

    def __call__(self, paths, prepared):
        cells, offsets = paths.sequences
        dx, dy = (np.sign(np.diff(part)) for part in (cells % paths.grid.width, cells // paths.grid.width))
        heading = HEADING_OF[dy + 1, dx + 1]
        total = []
        for begin, end in itertools.pairwise(offsets):
            steps = slice(begin, end - 1)
            total.append(prepared.moves.reshape(8, -1)[heading[steps], cells[steps]].sum())
        return np.array(total)


class NotNegated(LeastClearance):
    """Says that more is better, and scores as if less were."""

    def __call__(self, paths, prepared):
        return -super().__call__(paths, prepared)


class Transposed(Work):
    def field(self, grid):
        return heights(grid).T


class Negative(Work):
    def field(self, grid):
        return heights(grid) - 1.0


class Endless(Work):
    def field(self, grid):
        return np.where(heights(grid) == 2.0, np.inf, 0.0)


class Shifted(Vulnerability):
    """Says of a box what holds for another."""

    @property
    def local(self):
        return True

    def field_in(self, grid, box):
        return np.roll(self.field(grid), 1, axis=1)[box.slices]


class Relative(Work):
    """Scores depend on what else is in the batch."""

    def __call__(self, paths, prepared):
        values = super().__call__(paths, prepared)
        return values - values.min(initial=0.0) + len(values)


class Drawn(Work):
    def field(self, grid):
        return np.random.default_rng().random(grid.shape)


class Unlabelled(Work):
    label = ""


class Local(Work):
    def __init__(self):
        self.scale = lambda values: values


class Loud(Work):
    def __repr__(self):
        return "Loud(\n)"


class OneWay(Climb):
    """Knows no cost of steps to the left."""

    def moves(self, grid):
        cost = super().moves(grid)
        cost[4] = np.nan
        return cost


FAULTS = [
    Twice,
    FromTheCellLeft,
    Transposed,
    Negative,
    Endless,
    Shifted,
    Relative,
    Drawn,
    Unlabelled,
    Local,
    Loud,
    OneWay,
    NotNegated,
]


def is_caught(objective):
    """Return whether an objective fails a test of the suite; those that faults are made of pass all, above."""
    suite = type("Suite", (ObjectiveSuite,), {"objective": objective})()
    for name in (name for name in dir(suite) if name.startswith("test_")):
        try:
            getattr(suite, name)()
        except pytest.skip.Exception:
            pass
        except Exception:
            return True
    return False


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.__name__)
def test_faults_are_caught(fault):
    assert is_caught(fault())
