"""Our own suites of problems pass the suite for suites, and it catches what is planted in one."""

from __future__ import annotations

import functools
import os
from typing import ClassVar

import numpy as np
import pytest

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.objectives import LeastClearance, Length, Objective, Turn
from pymoo_gridpath.problems import (
    SUITES,
    Asletismac,
    GridPathProblem,
    GuardsGrid,
    RandomCostGrid,
    RegionOfSightMaps,
    SmallEnvironments,
    Suite,
)
from pymoo_gridpath.representations import CellSequence
from pymoo_gridpath.testing import SuiteSuite


class TestAsletismac(SuiteSuite):
    suite = Asletismac
    arguments: ClassVar = [
        {"instance": "ASLETISMAC_CH_X4_Y4_PM_K3_BF"},
        {"instance": "ASLETISMAC_CH_X4_Y4_PM_K3_BT"},
        {"instance": "ASLETISMAC_LA_X7_Y7_P2_K2_BF"},
    ]
    pathless: ClassVar = [{"instance": "ASLETISMAC_LA_X3_Y3_P1_K2_BF"}]
    wrong: ClassVar = [{"instance": "ASLETISMAC_CH_X4_Y5_PM_K3_BF"}, {"instance": "asletismac_ch_x4_y4_pm_k3_bf"}]


class TestRandomCostGrid(SuiteSuite):
    suite = RandomCostGrid
    arguments: ClassVar = [
        {"width": 3, "height": 3},
        {"width": 3, "height": 3, "seed": 2},
        {"width": 4, "height": 3, "n_obj": 4},
        {"width": 3, "height": 3, "n_obj": 3},
    ]
    wrong: ClassVar = [{"width": 1, "height": 3}, {"width": 3, "height": 3, "seed": -1}, {"width": 3, "height": "3"}]


class TestGuardsGrid(SuiteSuite):
    suite = GuardsGrid
    arguments: ClassVar = [
        {"map": "paper16", "guards": [[0, 1]], "start": [0, 0], "goal": [9, 0]},
        {"map": "warehouse", "guards": [[20, 20], [44, 12]]},
    ]
    wrong: ClassVar = [
        {"map": "ware house", "guards": [[20, 20]]},
        {"map": "warehouse", "guards": []},
        {"map": "warehouse", "guards": [[24, 1]]},
    ]


class TestSmallEnvironments(SuiteSuite):
    suite = SmallEnvironments
    arguments: ClassVar = [
        {"environment": "spiral"},
        {"environment": "narrow way"},
        {"environment": "narrow way", "corner_cutting": True},
    ]
    wrong: ClassVar = [{"environment": "zig-zag"}, {"environment": "zigzag", "corner_cutting": "sometimes"}]


class TestRegionOfSightMaps(SuiteSuite):
    suite = RegionOfSightMaps
    arguments: ClassVar = [{"kind": "maze"}, {"kind": "maze", "seed": 2}]
    wrong: ClassVar = [{"kind": "mazes"}, {"kind": "maze", "seed": 0.5}]


def test_all_suites_are_tested():
    tested = {suite.suite for suite in SuiteSuite.__subclasses__() if suite.__module__ == __name__ and hasattr(suite, "suite")}
    assert set(SUITES.registered().values()) == {*tested, Rooms}


# -- a suite of someone else's --------------------------------------------------------------------------------------------


class Mud(Objective):
    name, label = "mud", "Mud"

    def __init__(self, depth=2.0):
        self.depth = depth

    def field(self, grid):
        return self.depth * (np.indices(grid.shape).sum(axis=0) % 3)


class Rooms(Suite):
    """Two rooms with a pillar that stands where the seed says; the way from one to the other goes up and down again."""

    name, follows = "rooms", "follows nobody's definitions"

    def __init__(self, kind: str, seed: int = 1):
        self.kind = checks.one_of("kind", kind, ("open", "closed"))
        self.seed = checks.whole("seed", seed, 0)

    @property
    def label(self):
        return f"{self.kind}-{self.seed}"

    @functools.cached_property
    def query(self):
        occupied = np.zeros((5, 7), dtype=bool)
        occupied[: 5 if self.kind == "closed" else 4, 4] = True
        occupied[1 + self.seed % 3, 1] = True
        return OccupancyGrid(occupied), (0, 0), (6, 2)

    @functools.cached_property
    def objectives(self):
        return Length(), Mud(), LeastClearance(), Turn()


class RoomsSuite(SuiteSuite):
    arguments: ClassVar = [{"kind": "open"}, {"kind": "open", "seed": 2}]
    pathless: ClassVar = [{"kind": "closed"}]
    wrong: ClassVar = [{"kind": "opne"}, {"kind": "open", "seed": -2}]


@pytest.fixture(autouse=True)
def registered(monkeypatch):
    """Return what makes a suite known by a name for the time of a test; the one of this file is."""

    def make_known(cls, name="rooms"):
        monkeypatch.setitem(SUITES._known, name, cls)
        monkeypatch.setitem(SUITES._names, name, name)

    make_known(Rooms)
    return make_known


class TestRooms(RoomsSuite):
    suite = Rooms


# -- planted faults -------------------------------------------------------------------------------------------------------


class Unnamed(Rooms):
    """Is known by another name than it says."""

    name = "chambers"


class Silent(Rooms):
    follows = " "


class Mislabelled(Rooms):
    label = "room"


class Forgetful(Rooms):
    """Keeps another seed than it was given."""

    def __init__(self, kind: str, seed: int = 1):
        super().__init__(kind, seed)
        self._query, self.seed = Rooms(kind, seed).query, 0

    @property
    def query(self):
        return self._query


class Deaf(Rooms):
    """Takes a seed, and makes nothing of it."""

    @property
    def query(self):
        return Rooms(self.kind, 1).query


class Restless(Rooms):
    """Is another problem each time that it is asked."""

    @property
    def objectives(self):
        return Length(), Mud(float(np.random.default_rng().random()))


class Drawing(Rooms):
    """Draws what it does not need from the generator that all share."""

    @property
    def query(self):
        np.random.random()  # noqa: NPY002
        return super().query


class Hashed(Rooms):
    """Depends on how this process hashes texts."""

    @property
    def objectives(self):
        return Length(), Mud(float(hash(self.kind) % 1000))


class Here(Rooms):
    """Depends on the process."""

    @property
    def query(self):
        grid, start, goal = Rooms(self.kind, self.seed).query
        return grid.replace(resolution=float(os.getpid())), start, goal


class Unpicklable(Rooms):
    def __init__(self, kind: str, seed: int = 1):
        super().__init__(kind, seed)
        self.kept = lambda: 0


class Lost(Rooms):
    """Forgets in a file what it was."""

    def __getstate__(self):
        return {"kind": self.kind, "seed": 0}


class Immured(Rooms):
    """Begins within the pillar."""

    @functools.cached_property
    def query(self):
        grid, _, goal = super().query
        y, x = np.argwhere(grid.occupied)[0].tolist()
        return grid, (x, y), goal


class Listed(Rooms):
    """Says cells as lists."""

    @functools.cached_property
    def query(self):
        grid, start, goal = super().query
        return grid, list(start), list(goal)


class Outside(Rooms):
    @functools.cached_property
    def query(self):
        return super().query[0], (0, 0), (7, 2)


class Closed(Rooms):
    """Every room is without a door."""

    @functools.cached_property
    def query(self):
        return Rooms("closed", self.seed).query


class Cramped(Rooms):
    """Codes shortest paths, and no detours."""

    coding: ClassVar = {"max_cells": 10}

    def problem(self, objectives=None, **options):
        grid, start, goal = self.query
        coding = CellSequence(grid, start, goal, **self.coding)
        return GridPathProblem(grid, start, goal, coding, self.chosen(objectives), **options)


class OneWay(Rooms):
    """Says that paths backtrack, and codes none that do."""

    coding: ClassVar = {"backtracking": False}
    problem = Cramped.problem


class Helpful(Rooms):
    """Opens what is closed by definition."""

    @functools.cached_property
    def query(self):
        return Rooms("open", self.seed).query


class Twins(Rooms):
    @functools.cached_property
    def objectives(self):
        return Mud(), Mud(3.0)


class Prizes(Rooms):
    """Has a cost that is none."""

    @functools.cached_property
    def objectives(self):
        return Length(), Mud(-1.0)


class Misread(Mud):
    """Scores paths by other costs than it names."""

    def __call__(self, paths, prepared):
        return paths.total(prepared.field) + paths.turn


class Misled(Rooms):
    @functools.cached_property
    def objectives(self):
        return Length(), Misread()


class Crashing(Rooms):
    """Lets Python say what is wrong."""

    def __init__(self, kind: str, seed: int = 1):
        super().__init__({"open": "open", "closed": "closed"}[kind], seed)


class Trusting(Rooms):
    """Takes what is none of its kinds."""

    def __init__(self, kind: str, seed: int = 1):
        self.kind, self.seed = kind, checks.whole("seed", seed, 0)


class Talkative(Rooms):
    def __init__(self, kind: str, seed: int = 1):
        if kind not in ("open", "closed"):
            raise GridPathError(f"kind is {kind!r}\nexpected open or closed")
        super().__init__(kind, seed)


class Vague(Rooms):
    def __init__(self, kind: str, seed: int = 1):
        if kind not in ("open", "closed"):
            raise GridPathError("expected something else")
        super().__init__(kind, seed)


class Swallowing(Rooms):
    """Takes any argument, and forgets it."""

    def __init__(self, kind: str, seed: int = 1, **more):
        super().__init__(kind, seed)


class Unchecked(Rooms):
    """Takes anything for a seed, and fails over it later."""

    def __init__(self, kind: str, seed: int = 1):
        super().__init__(kind, 1)
        self.seed = seed


class Sealed(Mud):
    """Cannot be made of what it keeps."""

    def __init__(self, depth=2.0):
        self.deep = depth

    @property
    def depth(self):
        return self.deep + 1.0


class Unwritable(Rooms):
    @functools.cached_property
    def objectives(self):
        return Length(), Sealed(4.0)


FAULTS = [
    (Unnamed, "test_it_is_known_by_its_name"),
    (Silent, "test_it_says_whose_definitions_it_follows"),
    (Mislabelled, "test_each_problem_has_a_label_of_its_own"),
    (Forgetful, "test_it_keeps_its_arguments"),
    (Deaf, "test_problems_of_different_arguments_differ"),
    (Restless, "test_the_same_arguments_give_the_same_bits"),
    (Drawing, "test_the_same_arguments_give_the_same_bits"),
    (Hashed, "test_the_same_bits_in_another_process"),
    (Here, "test_the_same_bits_in_another_process"),
    (Unpicklable, "test_it_pickles"),
    (Lost, "test_it_pickles"),
    (Immured, "test_it_leads_from_a_free_cell_to_another"),
    (Listed, "test_it_leads_from_a_free_cell_to_another"),
    (Outside, "test_it_leads_from_a_free_cell_to_another"),
    (Closed, "test_paths_are_there_and_are_coded"),
    (Cramped, "test_exact_fronts_are_those_of_a_plain_search"),
    (OneWay, "test_paths_are_there_and_are_coded"),
    (Helpful, "test_what_has_no_path_is_refused"),
    (Twins, "test_objectives_go_by_their_names"),
    (Prizes, "test_costs_are_costs"),
    (Misled, "test_exact_fronts_are_those_of_a_plain_search"),
    (Misled, "test_a_search_scores_paths_as_the_objectives_say"),
    (Crashing, "test_what_is_no_problem_is_refused_in_a_sentence"),
    (Trusting, "test_what_is_no_problem_is_refused_in_a_sentence"),
    (Talkative, "test_what_is_no_problem_is_refused_in_a_sentence"),
    (Vague, "test_what_is_no_problem_is_refused_in_a_sentence"),
    (Swallowing, "test_arguments_that_it_does_not_take_are_refused"),
    (Unchecked, "test_nonsense_is_refused_in_a_sentence_or_taken"),
    (Unwritable, "test_a_study_means_the_same_problem_and_runs_it"),
    (Trusting, "test_a_study_refuses_what_is_no_problem"),
]


@pytest.mark.filterwarnings("ignore:no Pareto front")
@pytest.mark.parametrize(("fault", "test"), FAULTS, ids=lambda one: getattr(one, "__name__", ""))
def test_planted_faults_are_caught(registered, fault, test):
    suite = type("Suite", (RoomsSuite,), {"suite": fault})()
    registered(fault)
    with pytest.raises((Exception, pytest.fail.Exception)) as info:
        getattr(suite, test)()
    assert not isinstance(info.value, pytest.skip.Exception)


def test_each_test_of_the_suite_catches_something():
    assert {test for _, test in FAULTS} == {name for name in dir(SuiteSuite) if name.startswith("test_")}
