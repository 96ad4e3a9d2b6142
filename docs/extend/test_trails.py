"""What is tested: the suites know how."""

from trails import Boxes, Nudge, Ponds, Stops, WalkingTime, WeightedPaths

from pymoo_gridpath.testing import (
    MapFormatSuite,
    ObjectiveSuite,
    OperatorSuite,
    PlannerSuite,
    RepresentationSuite,
    SuiteSuite,
)


class TestWalkingTime(ObjectiveSuite):
    objective = WalkingTime(summit=1.0)


class TestStops(RepresentationSuite):
    def make(self, grid, start, goal):
        return Stops(grid, start, goal)


class TestNudge(OperatorSuite):
    representation = "stops"

    def make(self):
        return Nudge()


class TestWeightedPaths(PlannerSuite):
    def make(self):
        return WeightedPaths()


class TestBoxes(MapFormatSuite):
    format = Boxes

    def write(self, path, grid):
        boxes = [
            f"{x} {y} 1 1" for x in range(grid.width) for y in range(grid.height) if grid.occupied[y, x]
        ]
        path.write_text("\n".join([f"{grid.width} {grid.height}", *boxes]))


class TestPonds(SuiteSuite):
    suite = Ponds
    arguments = ({"size": 6}, {"size": 6, "seed": 2})
    wrong = ({"size": 2}, {"size": 6, "seed": -1})
