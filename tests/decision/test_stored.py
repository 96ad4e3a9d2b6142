"""Trade-off sets out of their files: the same ones, or a sentence."""

import json

import numpy as np
import pytest
from trade_offs import draw, make_problem

from pymoo_gridpath import GridPathProblem, OccupancyGrid, TradeOffSet
from pymoo_gridpath.decision import load_json
from pymoo_gridpath.decision.export import runs_of
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.objectives import Objective, Vulnerability
from pymoo_gridpath.problems import MovingObstaclesProblem


class Mud(Objective):
    name, label = "mud", "Mud on the way [kg]"

    def field(self, grid):
        return np.add.outer(np.arange(grid.height) % 3, np.arange(grid.width) % 2)


def exact_set(representation="cells", **options):
    occupied = np.zeros((9, 11), dtype=bool)
    occupied[2:7, 4:7] = True
    grid = OccupancyGrid(occupied, 0.05, (1.0, -2.0, 0.3), name="a map \u00fc", corner_cutting=representation != "cells")
    options.setdefault("objectives", ("length", Vulnerability(variance=1.5)))
    problem = GridPathProblem(grid, (0, 3), (10, 5), representation, **options)
    return TradeOffSet.from_genes(problem, problem.pareto_set(max_seconds=60), settings={"note": "here"})


def crossing():
    walled = np.zeros((6, 12), dtype=bool)
    walled[:, 5] = True
    walled[5, 5] = False
    problem = GridPathProblem(OccupancyGrid(walled), (0, 0), (11, 0), "integer")
    return TradeOffSet.from_genes(problem, [[0, 1, -1, *[0] * 8]])


def moving():
    problem = MovingObstaclesProblem(OccupancyGrid(np.zeros((6, 6))), [[(3, 3), (3, 4)]], (0, 0), (5, 5))
    return TradeOffSet.from_genes(problem, problem.pareto_set(max_seconds=60))


def grown():
    grid = exact_set().problem.grid.inflate(footprint=[(0.04, 0.0), (-0.03, 0.02), (0, -0.02)])
    grown = GridPathProblem(grid, (0, 3), (10, 5))
    return TradeOffSet.from_genes(grown, grown.pareto_set(max_seconds=60))


SETS = {
    "grown": grown,
    "cells": exact_set,
    "integer": lambda: exact_set("integer"),
    "binary": lambda: exact_set("binary", axis="x"),
    "absolute": lambda: exact_set("absolute", axis="x"),
    "mixed": lambda: exact_set("mixed", axis="x"),
    "three": lambda: exact_set(objectives=("length", "vulnerability", "turn")),
    "own": lambda: exact_set(objectives=("length", Mud())),
    "constraint": lambda: exact_set(obstacles="constraint"),
    "limit": lambda: exact_set(obstacles="limit", potential_limit=5.0),
    "penalty": lambda: exact_set(penalty=7.5),
    "crossing": crossing,
    "empty": lambda: TradeOffSet.from_genes(
        GridPathProblem(OccupancyGrid(np.zeros((3, 3))), (0, 0), (2, 2), "integer"), [[0, 1]]
    ),
    "bare": lambda: TradeOffSet(make_problem(), draw(make_problem(), 50)),
    "moving": moving,
}


@pytest.fixture(scope="module", params=SETS)
def stored(request, tmp_path_factory):
    found = SETS[request.param]()
    return found, found.to_json(tmp_path_factory.mktemp("set") / "paths.json")


def test_what_was_written_comes_back(stored, tmp_path):
    found, file = stored
    again = load_json(file)
    assert again.to_json(tmp_path / "again.json").read_bytes() == file.read_bytes()
    assert again.to_csv(tmp_path / "a.csv").read_bytes() == found.to_csv(tmp_path / "b.csv").read_bytes()
    assert again.table() == found.table() and again.named == found.named and again.feasible == found.feasible
    mine, other = again.problem.grid, found.problem.grid
    assert mine == other and mine.origin == other.origin and mine.original == other.original
    assert (mine.robot_radius, mine.footprint) == (other.robot_radius, other.footprint)
    np.testing.assert_array_equal(again.X, found.X)
    np.testing.assert_array_equal(again.F, found.F)
    assert [again.measures[name].dtype for name in again.measures] == [found.measures[name].dtype for name in found.measures]
    assert again.problem.representation.name == found.problem.representation.name


def test_the_problem_that_comes_back_scores_as_the_one_before(stored):
    found, file = stored
    problem = load_json(file).problem
    if "mud" in problem.objective_names:
        with pytest.raises(GridPathError, match="does not hold what the objective 'mud' costs"):
            problem.evaluate(found.X)
        assert problem.objectives[1].label == Mud.label
    else:
        np.testing.assert_array_equal(
            problem.evaluate(found.X, return_values_of=["F"]), found.problem.evaluate(found.X, return_values_of=["F"])
        )


def test_the_problem_itself_may_be_given(tmp_path):
    found = SETS["own"]()
    file = found.to_json(tmp_path / "paths.json")
    again = load_json(file, found.problem)
    assert again.problem is found.problem and np.array_equal(again.F, found.problem.score(again.paths))
    other = GridPathProblem(found.problem.grid, (0, 4), (10, 5), objectives=("length", Mud()))
    with pytest.raises(GridPathError, match="the problem has another map or query than the file"):
        load_json(file, other)
    with pytest.raises(GridPathError, match="the problem has the objectives length, turn, expected those of the file"):
        load_json(file, GridPathProblem(found.problem.grid, (0, 3), (10, 5), "cells", ("length", "turn")))
    with pytest.raises(GridPathError, match="problem is 3, expected a GridPathProblem"):
        load_json(file, 3)


@pytest.mark.parametrize("occupied", [[[0]], [[1]], [[0, 1], [1, 1]], [[1, 1], [0, 1]], np.eye(5)])
def test_runs_alternate_from_free_cells_on(occupied):
    cells = np.array(occupied, dtype=bool)
    runs = runs_of(cells)
    flat = [k % 2 for k, run in enumerate(runs) for _ in range(run)]
    assert flat == cells.ravel().astype(int).tolist() and 0 not in runs[1:]


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("{", "not JSON"),
        ("[" * 10**5, "nested too deep"),
        ("[]", "no trade-off set"),
        ('{"format": "pymoo_gridpath trade-off set", "format_version": 99}', "format_version"),
        ('{"format": "pymoo_gridpath trade-off set", "format_version": 3, "paths": []}', "paths"),
        ('{"format": "pymoo_gridpath trade-off set", "format_version": 3, "paths": [{"cells": []}]}', "path 0 has no 'names'"),
    ],
)
def test_a_file_that_is_no_set_is_refused(text, word, tmp_path):
    path = tmp_path / "bad.json"
    path.write_text(text)
    with pytest.raises(GridPathError, match=word):
        load_json(path)
    with pytest.raises(GridPathError, match="cannot be read"):
        load_json(tmp_path / "none.json")


DAMAGE = {
    "map is missing": lambda c: c.pop("map"),
    "the checksum": lambda c: c["occupied_runs"].__setitem__(
        slice(1, 3), [c["occupied_runs"][1] + 1, c["occupied_runs"][2] - 1]
    ),
    "another size": lambda c: c["occupied_runs"].append(10**12),
    "occupied_runs is": lambda c: c.update(occupied_runs="many"),
    "expected at most 268,435,456": lambda c: c.update(occupied_runs=[10**12]) or c["map"].update(width=10**6, height=10**6),
    "height is": lambda c: c["map"].update(height=-1),
    "start is": lambda c: c["query"].update(start="here"),
    "not those of its genes": lambda c: c["paths"][0]["cells"].pop(),
    "genes": lambda c: c["paths"][0].update(genes=[1]),
    "a measure is": lambda c: c["paths"][0].update(length="long"),
    "there is no representation": lambda c: c["settings"].update(representation="words"),
    "cannot be made again": lambda c: c["settings"].pop("representation"),
    "the objectives": lambda c: c.update(objectives=["length"]),
    "feasible is": lambda c: c.update(feasible="yes"),
    "lies on an obstacle": lambda c: c["query"].update(start=[4, 3]),
}


@pytest.mark.parametrize("word", DAMAGE)
def test_a_damaged_file_is_refused_in_a_sentence(word, tmp_path):
    file = exact_set().to_json(tmp_path / "paths.json")
    content = json.loads(file.read_text())
    DAMAGE[word](content)
    file.write_text(json.dumps(content))
    with pytest.raises(GridPathError, match=word) as said:
        load_json(file)
    assert str(said.value).startswith(f"{file}: ") and "\n" not in str(said.value)
