"""What a trade-off set records, and its files."""

import copy
import csv
import importlib
import json
import os
import pickle
import re
import subprocess
import sys

import numpy as np
import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.population import Population
from pymoo.core.result import Result
from pymoo.optimize import minimize
from trade_offs import draw, make_problem

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms.variable_length import VariableLengthGA
from pymoo_gridpath.decision import NAMES, TradeOffSet
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.planners import Plan, Planner

MEASURES = ["length", "vulnerability", "turn", "interfering_cells", "clearance"]


def test_the_record_says_what_made_it(results):
    trade_off = TradeOffSet.from_results(results[0], settings={"command": "plan"})
    grid, meta = trade_off.problem.grid, trade_off.meta
    assert meta["map"]["occupied_cells"] == grid.n_occupied
    assert meta["query"] == {"start": [0, 0], "goal": [11, 11]}
    assert meta["seed"] == 1
    settings = meta["settings"]
    assert settings["representation"] == "integer" and settings["command"] == "plan"
    assert settings["objectives"][1] == {"name": "vulnerability", "variance": 0.5, "nearest": False, "cutoff": 0.0}
    entry = settings["runs"][0]
    assert (entry["algorithm"], entry["pop_size"], entry["generations"], entry["evaluations"]) == ("NSGA2", 60, 25, 1500)
    assert entry["operators"]["crossover"]["name"] == "DiscreteSBX"
    assert set(meta["versions"]) == {"python", "pymoo_gridpath", "pymoo", "numpy", "scipy", "moocore", "numba"}


def test_the_digest_tells_maps_apart():
    grid = make_problem().grid
    occupied = grid.occupied.copy()
    occupied[3, 3] ^= True
    digests = {TradeOffSet.from_genes(p, draw(p, 300)).meta["map"]["sha256"] for p in _problems(grid, occupied)}
    assert len(digests) == 2


def _problems(grid, occupied):
    return [GridPathProblem(g, (0, 0), (7, 7)) for g in (grid, grid.replace(name="other"), grid.replace(occupied=occupied))]


def strict(text):
    def refuse(word):
        raise AssertionError(f"{word} is not JSON")

    return json.loads(text, parse_constant=refuse)


def test_json_holds_every_path_and_what_made_it(trade_off, tmp_path):
    content = strict(trade_off.to_json(tmp_path / "front.json").read_text())
    assert {"map", "query", "settings", "seed", "versions", "feasible", "objectives", "paths"} <= set(content)
    assert len(content["paths"]) == len(trade_off)
    for record, stored in zip(trade_off, content["paths"], strict=True):
        assert stored["cells"] == record.cells.tolist()
        assert stored["points"] is None and stored["length_m"] is None, "a map in cells"
        assert stored["names"] == list(record.names)
        for name in MEASURES:
            assert stored[name] == getattr(record, name)


def test_json_has_null_where_a_number_is_not_finite(tmp_path):
    problem = GridPathProblem(OccupancyGrid(np.zeros((5, 5))), (0, 0), (4, 4), "integer")
    path = TradeOffSet.from_genes(problem, [[0, 1, 1, 1]]).to_json(tmp_path / "front.json")
    assert strict(path.read_text())["paths"][0]["clearance"] is None


def test_csv_gives_every_measure_back(trade_off, tmp_path):
    with open(trade_off.to_csv(tmp_path / "front.csv"), newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["path", "names", *MEASURES]
    for name, values in trade_off.measures.items():
        assert [float(row[name]) for row in rows] == values.tolist()
    assert [tuple(filter(None, row["names"].split(";"))) for row in rows] == [record.names for record in trade_off]


def test_pandas_gets_what_the_csv_file_holds(trade_off, tmp_path):
    pandas = pytest.importorskip("pandas", reason="pandas is not installed")
    frame = trade_off.to_pandas()
    read = pandas.read_csv(trade_off.to_csv(tmp_path / "front.csv"), keep_default_na=False)
    pandas.testing.assert_frame_equal(frame, read, check_dtype=False)
    assert frame["turn"].dtype.kind == "i" and frame["names"].tolist() == [";".join(record.names) for record in trade_off]


def test_without_pandas_a_sentence_names_the_extra(trade_off, monkeypatch):
    def missing(name):
        raise ModuleNotFoundError(name)

    monkeypatch.setattr(importlib, "import_module", missing)
    with pytest.raises(GridPathError, match=r"pip install 'pymoo_gridpath\[pandas\]'"):
        trade_off.to_pandas()


def test_a_crash_leaves_the_old_file_and_no_other(trade_off, tmp_path, monkeypatch):
    path = tmp_path / "front.json"
    path.write_text("old")

    def crash(*args):
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "replace", crash)
    with pytest.raises(KeyboardInterrupt):
        trade_off.to_json(path)
    assert path.read_text() == "old"
    assert [file.name for file in tmp_path.iterdir()] == ["front.json"]


def test_a_place_that_cannot_be_written_is_an_error_in_words(trade_off, tmp_path):
    with pytest.raises(GridPathError, match="cannot be written"):
        trade_off.to_csv(tmp_path / "no" / "folder.csv")
    with pytest.raises(GridPathError, match="cannot be written"):
        trade_off.to_json(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_the_table_lines_up_and_shows_the_named_paths(trade_off):
    lines = trade_off.table().splitlines()
    # A heading above the table, and below it how long the shortest path is, with what to try for it if need be.
    assert len(lines) == 3 + len(trade_off) + bool(trade_off.advice) and str(trade_off) == trade_off.table()
    lines = lines[: 2 + len(trade_off)]
    ends = [[match.end() for match in re.finditer(r"\S+(?: \S+)*", line)][:6] for line in lines[1:]]
    assert all(row == ends[0] for row in ends[1:])
    short = trade_off.table(max_rows=0)
    assert all(name in short for name in NAMES)
    assert len(trade_off) == 1 or "more" in short or len(set(trade_off.named.values())) == len(trade_off)


def test_sets_can_be_pickled_and_copied(trade_off):
    for again in (pickle.loads(pickle.dumps(trade_off)), copy.deepcopy(trade_off)):
        assert again.table() == trade_off.table()


def test_deciding_does_not_import_pyplot():
    code = "import sys, pymoo_gridpath.decision, pymoo_gridpath.convergence; sys.exit('matplotlib.pyplot' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


def test_the_table_ends_with_the_shortest_of_all_paths():
    grid = OccupancyGrid(np.zeros((4, 8)), corner_cutting=True, resolution=0.5)
    lines = {}
    for objectives in (("length", "vulnerability"), ("vulnerability", "turn")):
        problem = GridPathProblem(grid, (0, 0), (7, 3), "integer", objectives)
        found = TradeOffSet.from_genes(problem, [[0, 1, 1, 1, 0, 0, 0]])
        lines[objectives[0]] = found.table().splitlines()
    # Three diagonal steps and four straight ones.
    said = f"for comparison, the shortest of all paths on this grid has length {2 + 1.5 * 2**0.5:.3f} m"
    assert lines["length"][3] == said
    in_cells = GridPathProblem(grid.replace(resolution=None), (0, 0), (7, 3), "integer")
    in_cells = TradeOffSet.from_genes(in_cells, [[0, 1, 1, 1, 0, 0, 0]]).table().splitlines()
    assert in_cells[3] == f"for comparison, the shortest of all paths on this grid has length {4 + 3 * 2**0.5:.3f}"
    # Of what there is in cells and in metres, the table of a map in metres has the metres.
    heads = [lines["length"][1].split("  "), in_cells[1].split("  ")]
    assert [{"length", "length [m]", "clearance", "clearance [m]"} & {word.strip() for word in head} for head in heads] == [
        {"length [m]", "clearance [m]"},
        {"length", "clearance"},
    ]
    assert not any("for comparison" in line for line in lines["vulnerability"])


def test_paths_that_are_much_too_long_are_remarked_on_with_what_to_try():
    grid = OccupancyGrid(np.zeros((6, 12)))
    problem = GridPathProblem(grid, (0, 0), (11, 0))
    straight = [[x, 0] for x in range(12)]

    def genes(cells):
        row = [y * 12 + x for x, y in cells]
        return [(row + row[-1:] * problem.n_var)[: problem.n_var]]

    bump = [[0, 0], [0, 1], *([x, 1] for x in range(1, 12)), [11, 0]]
    found = TradeOffSet.from_genes(problem, genes(bump))
    assert found.advice.endswith(
        "; the shortest path found is 18% longer than the shortest of all; try path-aware operators, more generations or the "
        "exact front"
    )
    assert found.table().splitlines()[-1] == f"NOTE: {found.advice}"
    assert "longer" not in TradeOffSet.from_genes(problem, genes(straight)).advice
    # 2 (sqrt 2 - 1) in 11 is 7.5 %, in 59 it is 1.4 %.
    wide = GridPathProblem(OccupancyGrid(np.zeros((3, 60))), (0, 0), (59, 0), "integer")
    assert "longer" not in TradeOffSet.from_genes(wide, [[0, 1, -1, *[0] * 56]]).advice
    short = GridPathProblem(grid, (0, 0), (11, 0), "integer")
    advice = TradeOffSet.from_genes(short, [[0, 1, -1, *[0] * 8]]).advice
    assert "8% longer" in advice and "try the representation 'cells'" in advice


def row_of(problem):
    """Return a path from (0, 0) to (11, 0) with a step up at first."""
    detour = {"cells": [0, *range(12, 24), 11], "integer": [0, 1, -1, *[0] * 8]}[problem.representation.name]
    return np.pad(detour, (0, problem.n_var - len(detour)), mode="edge")[None]


class Detour(Planner):
    def plan(self, problem):
        return Plan(row_of(problem), success=not self.reference)


class Refined(Detour):
    takes_operators = True


class Truth(Detour):
    reference = True


@pytest.mark.parametrize(
    ("coding", "algorithm", "attempts"),
    [
        ("cells", Detour, "the exact front"),
        ("cells", Refined, "path-aware operators or the exact front"),
        ("cells", Truth, "a larger budget"),
        ("cells", VariableLengthGA, "more generations or the exact front"),
        ("cells", NSGA2, "path-aware operators, more generations or the exact front"),
        ("integer", Detour, "the representation 'cells', which codes every path"),
        ("integer", NSGA2, "the representation 'cells', which codes every path, path-aware operators or more generations"),
    ],
)
def test_what_to_try_is_what_the_algorithm_can_do(coding, algorithm, attempts):
    problem = GridPathProblem(OccupancyGrid(np.zeros((6, 12))), (0, 0), (11, 0), coding)
    run = Result()
    run.problem, run.algorithm, run.pop = problem, algorithm(), Population.new("X", row_of(problem))
    assert TradeOffSet.from_results(run).advice.endswith(f"longer than the shortest of all; try {attempts}")
    # Of several runs, what any can do.
    planned = minimize(problem, Refined())
    assert "path-aware operators" in TradeOffSet.from_results([run, planned]).advice


def test_nothing_is_remarked_on_where_it_cannot_be_known():
    grid = OccupancyGrid(np.zeros((6, 12)))
    rows = [[0, 1, -1, *[0] * 8]]
    for options in ({"objectives": ("vulnerability", "turn")}, {"obstacles": "limit", "potential_limit": 1.0}):
        found = TradeOffSet.from_genes(GridPathProblem(grid, (0, 0), (11, 0), "integer", **options), rows)
        assert "longer" not in found.advice
    walled = np.zeros((6, 12), dtype=bool)
    walled[:5, 5] = True
    crossing = TradeOffSet.from_genes(GridPathProblem(OccupancyGrid(walled), (0, 0), (11, 0), "integer"), rows)
    assert not crossing.feasible and crossing.advice == "" and "NOTE" not in crossing.table()
