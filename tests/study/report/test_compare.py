"""The report of plain Results of pymoo."""

from __future__ import annotations

import numpy as np
import pytest
from pymoo.optimize import minimize
from scipy.stats import mannwhitneyu

from pymoo_gridpath import GridPathProblem
from pymoo_gridpath.algorithms import ExactFront, make_algorithm
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.problems import random_dense_grid
from pymoo_gridpath.quality import hypervolume_ratio, igd_plus, share_found
from pymoo_gridpath.study import compare


@pytest.fixture(scope="module")
def runs():
    found = {}
    for size in (8, 10):
        problem = GridPathProblem(random_dense_grid(size, 0.2, 1), (0, 0), (size - 1, size - 1))
        for name in ("NSGA2", "SPEA2"):
            found[f"dense {size}", name] = [
                minimize(problem, make_algorithm(name, problem, pop_size=20), ("n_gen", 6), seed=seed) for seed in range(3, 8)
            ]
    return found


def test_numbers_are_those_of_the_results(runs):
    tables = compare(runs)
    assert {name: len(rows) > 0 for name, rows in tables.items()} == dict.fromkeys(
        ("runs", "problems", "summary", "tests"), True
    )
    rows = {(row["problem"], row["algorithm"], int(row["seed"])): row for row in tables["runs"]}
    assert len(rows) == 20
    for (problem, algorithm), results in runs.items():
        front = results[0].problem.pareto_front()
        for seed, result in zip(range(3, 8), results, strict=True):
            row = rows[problem, algorithm, seed]
            legal = result.pop.get("F")[result.pop.get("interfering_cells") == 0]
            assert row["reference"] == "exact" and int(row["reference_points"]) == len(front)
            assert float(row["ratio"]) == pytest.approx(hypervolume_ratio(legal, front))
            assert float(row["igd_plus"]) == pytest.approx(igd_plus(legal, front))
            assert float(row["share"]) == pytest.approx(share_found(legal, front))
            assert int(row["n_eval"]) == result.algorithm.evaluator.n_eval
    x, y = ([float(rows["dense 8", name, seed]["ratio"]) for seed in range(3, 8)] for name in ("NSGA2", "SPEA2"))
    test = next(row for row in tables["tests"] if (row["level"], row["scope"], row["measure"]) == ("group", "dense 8", "ratio"))
    if len(set(x + y)) == 10:
        assert float(test["p"]) == pytest.approx(mannwhitneyu(x, y).pvalue)


def test_rows_are_as_good_and_files_are_written(runs, tmp_path):
    rows = [(*key, result) for key, results in runs.items() for result in results]
    assert compare(rows, tmp_path, name="my runs", formats=["svg"]) == compare(runs)
    names = {file.name for file in tmp_path.iterdir()}
    tables = {"runs.csv", "problems.csv", "summary.csv", "tests.csv", "tables.tex"}
    assert names == {"index.html", "report.md", "figures", "explorer", *tables}
    made = sorted(file.name for file in (tmp_path / "explorer").iterdir())
    assert made[-2:] == ["front-dense-8-NSGA2.html", "front-dense-8-SPEA2.html"]
    text = (tmp_path / "report.md").read_text()
    assert text.startswith("# Study my runs") and "integer" in text
    assert (tmp_path / "figures" / "fronts-dense-8.svg").exists()


def test_without_an_exact_front_the_merged_one_serves(runs, monkeypatch):
    monkeypatch.setattr(GridPathProblem, "pareto_front", lambda self: None)
    tables = compare({key: results[:2] for key, results in runs.items() if key[0] == "dense 8"})
    assert {row["reference"] for row in tables["runs"]} == {"merged"}
    assert max(float(row["ratio"]) for row in tables["runs"]) <= 1.0


def test_the_exact_front_is_a_run_like_others(runs):
    problem = runs["dense 8", "NSGA2"][0].problem
    exact = minimize(problem, ExactFront())
    tables = compare({("dense 8", "NSGA2"): runs["dense 8", "NSGA2"], ("dense 8", "truth"): exact})
    row = next(row for row in tables["runs"] if row["algorithm"] == "truth")
    assert (float(row["ratio"]), float(row["share"])) == (1.0, 1.0)


def test_what_is_none_is_refused(runs):
    one = runs["dense 8", "NSGA2"][0]
    other = runs["dense 10", "NSGA2"][0]
    for given, message in (
        ({}, "holds no runs"),
        ({"NSGA2": [one]}, "has the key 'NSGA2'"),
        ({("a", "b"): [np.zeros(3)]}, "expected a Result of a GridPathProblem"),
        ({("a", "b"): [one, other]}, "differ in grid, start, goal or objectives"),
        ([("a", one)], "expected Results by problem and algorithm"),
        (one, "results is"),
    ):
        with pytest.raises(GridPathError, match=message):
            compare(given)
    with pytest.raises(GridPathError, match="format 'jpg'"):
        compare({("a", "b"): one}, formats="jpg")
    with pytest.raises(GridPathError, match="target is 2"):
        compare({("a", "b"): one}, target=2)
