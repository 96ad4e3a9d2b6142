"""The experiments of Ahmed and Deb (2013): each section runs and prints its table, here at a toy size."""

import sys
from pathlib import Path

import numpy as np
import pytest
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import FirstLegalPath

BENCHMARKS = Path(__file__).resolve().parents[1] / "benchmarks"
TOY = ["--runs", "2", "--members", "8", "--generations", "2", "--largest", "8", "--jobs", "1"]

# Of each section what its tables have to hold, and its figures.
SECTIONS = {
    "2.1": (["sugihara-smith", "binary", "mixed", "integer"], []),
    "4.1": (["sparse", "dense", "penalty", "constraint", "limit", "fails"], []),
    "5.3": (["integer", "mixed", "binary", "published", "8 x 8, 11 obstacles"], ["figure-3"]),
    "5.4": (["paper16", "knee"], []),
    "5.5": (["least of 2 runs", "two objectives, penalty", "80 %", "length, constraint", "p ="], []),
    "5.6": (["length, vulnerability, turn", "kept", "lost"], []),
    "6": ([" 8 x 8   0.1 |", "80 %", "one path", "path-aware, random start"], []),
}


@pytest.fixture(scope="module", autouse=True)
def benchmarks():
    if not BENCHMARKS.is_dir():
        pytest.skip("the benchmarks are not beside the tests")
    sys.path.insert(0, str(BENCHMARKS))
    yield
    sys.path.remove(str(BENCHMARKS))


@pytest.mark.parametrize("section", SECTIONS)
def test_a_section_prints_published_beside_ours(section, tmp_path, capsys):
    import paper

    tables, figures = SECTIONS[section]
    paper.main(["--section", section, *TOY, *(["--output", str(tmp_path)] if figures else [])])
    said = capsys.readouterr().out
    assert said.startswith(f"Section {section}\n")
    for text in tables:
        assert text in said
    drawn = [path.name for path in tmp_path.iterdir()]
    assert all(any(name in file for file in drawn) for name in figures)


def test_a_scenario_has_exactly_its_obstacles_and_a_path():
    from paper_sections.base import Settings

    settings = Settings(None)
    for seed in range(1, 4):
        grid = settings.scattered(64, 791, seed)
        assert grid.n_occupied == 791 and grid.shape == (64, 64) and grid.corner_cutting is True
        GridPathProblem(grid, (0, 0), (63, 63), "integer")
        assert Settings(None, largest=32).scattered(64, 791, seed).n_occupied == 198


def test_intervals_are_those_of_the_tables():
    from paper_sections.base import against, median, share

    # Wilson's for 8 of 10; the ranks of a median of 10 are 2 and 9, and of five there are none.
    assert share(8, 10) == "80 % [49, 94]"
    assert median(range(1, 11)) == "5.5000 [2.0000, 9.0000]"
    assert median(range(5), 0) == "2" and median([]) == "-"
    first, second = np.array([1] * 6 + [0] * 4, dtype=bool), np.array([0] * 5 + [1] + [0] * 4, dtype=bool)
    assert against(first, second) == "5 : 0, p = 0.062"


@pytest.mark.parametrize("obstacles", ["penalty", "constraint"])
def test_the_genetic_algorithm_finds_the_shortest_path(obstacles):
    from paper_sections.genetic import genetic_algorithm

    occupied = np.zeros((6, 6))
    occupied[2, :4] = 1
    grid = OccupancyGrid(occupied, corner_cutting=True)
    problem = GridPathProblem(grid, (0, 0), (5, 5), "integer", ["length"], obstacles)
    result = minimize(problem, genetic_algorithm(problem, 40), ("n_gen", 25), seed=1)
    assert result.F[0] == pytest.approx(problem.pareto_front()[0, 0])
    F, CV = result.pop.get("F", "CV")
    first = minimize(problem, genetic_algorithm(problem, 40), FirstLegalPath(25), seed=1).pop
    assert CV.max() == 0 and np.sort(F[:, 0])[0] <= first.get("F").min()
    again = minimize(problem, genetic_algorithm(problem, 40), ("n_gen", 25), seed=1)
    assert np.array_equal(again.pop.get("X"), result.pop.get("X"))
