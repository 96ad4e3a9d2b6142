"""One valid call of every public name of the suites of problems, and of what their paths are scored by."""

from __future__ import annotations

from typing import Any

import numpy as np
from world import Call, World

from pymoo_gridpath import OccupancyGrid, objectives, problems, study
from pymoo_gridpath.representations import CellSequence


def _suites(w: World) -> dict[str, Call]:
    made: dict[str, dict[str, Any]] = {
        "Asletismac": {"instance": "ASLETISMAC_NO_X4_Y4_PM_K3_BF"},
        "RandomCostGrid": {"width": 4, "height": 3, "n_obj": 2, "seed": 5},
        "GuardsGrid": {"map": w.grid, "guards": [(1, 1)], **w.query},
        "SmallEnvironments": {"environment": "caved", "corner_cutting": True},
        "RegionOfSightMaps": {"kind": "maze", "seed": 2},
    }
    found: dict[str, Call] = {
        "make_suite": (problems.make_suite, {"suite": "random-cost", "width": 4, "height": 3}),
        "Asletismac.instances": (problems.Asletismac.instances, {"backtracking": True}),
        "ProblemSpec.made_suite": (
            study.ProblemSpec(suite=problems.RandomCostGrid(4, 3)).made_suite,
            {"folder": str(w.folder)},
        ),
    }
    for name, arguments in made.items():
        cls = getattr(problems, name)
        suite = cls(**arguments)
        found |= {
            name: (cls, arguments),
            f"{name}.chosen": (suite.chosen, {"objectives": ["length", "turn"]}),
            f"{name}.problem": (suite.problem, {"objectives": ["turn"], "obstacles": "constraint"}),
        }
    return found


def _objectives(w: World) -> dict[str, Call]:
    square = OccupancyGrid(np.zeros((4, 4)))
    coding = CellSequence(square, (0, 0), (3, 3))
    made: dict[str, dict[str, Any]] = {
        "Ascent": {"hills": "P2"},
        "Delay": {},
        "TravelTime": {},
        "RandomCost": {"number": 2, "seed": 3},
        "IntegerLength": {},
        "Exposure": {"guards": [(1, 1), (2, 3)]},
    }
    found: dict[str, Call] = {}
    for name, arguments in made.items():
        cls = getattr(objectives, name)
        one = cls(**arguments)
        found[name] = cls, arguments
        for method, given in (
            ("field", {"grid": square}),
            ("field_in", {"grid": square, "box": square.whole}),
            ("moves", {"grid": square}),
            ("on", {"grid": square}),
            ("prepare", {"representation": coding, "grid": square}),
        ):
            found[f"{name}.{method}"] = getattr(one, method), given
    found["Exposure.seen"] = objectives.Exposure([(1, 1)]).seen, {"grid": square}
    return found


CALLS = (_suites, _objectives)
