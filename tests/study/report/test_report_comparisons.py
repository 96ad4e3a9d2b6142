"""Which algorithms a report calls different, and where it says that no test could tell."""

import csv
import io

import pytest
import synthetic_study as made
from synthetic_study import rows, texts

from pymoo_gridpath.study.report import write_report
from pymoo_gridpath.study.report.results import collect
from pymoo_gridpath.study.report.statistics.comparisons import compare, compare_each
from pymoo_gridpath.study.report.statistics.significance import critical_difference
from pymoo_gridpath.study.report.tables.csv_files import Family, csv_files


def results_of(tmp_path, n_problems, n_algorithms, n_seeds):
    plan = made.make_plan({"g": n_problems}, [f"a{k}" for k in range(n_algorithms)], n_seeds)
    return collect(made.fill(tmp_path, plan, n_records=4, n_points=6))


@pytest.mark.parametrize(("n_algorithms", "n_seeds", "tells"), [(2, 3, False), (2, 4, True), (3, 4, False), (3, 5, True)])
def test_nothing_is_significant_where_nothing_could_be(tmp_path, n_algorithms, n_seeds, tells):
    results = results_of(tmp_path, 1, n_algorithms, n_seeds)
    comparison = compare(results, [0], "ratio")
    assert comparison.could_tell is tells
    assert any("Too few seeds" in warning for warning in comparison.warnings) is not tells
    # Whatever the values: those of the greatest difference.
    for run in results.runs:
        run.ratio = run.algorithm + 0.001 * run.seed
    assert any(pair.significant for pair in compare(results, [0], "ratio").pairs) is tells


@pytest.mark.parametrize(("n_problems", "tells"), [(5, False), (6, True)])
def test_problems_are_the_samples_of_several_problems(tmp_path, n_problems, tells):
    results = results_of(tmp_path, n_problems, 2, 2)
    for run in results.runs:
        run.ratio = 0.5 + 0.1 * run.algorithm + 0.001 * run.problem
    comparison = compare(results, range(n_problems), "ratio")
    assert (comparison.could_tell, comparison.pairs[0].significant) == (tells, tells)
    assert comparison.beaten_by(1) == ([0] if tells else []) and comparison.beaten_by(0) == []
    assert (comparison.pairs[0].better, comparison.pairs[0].worse) == (0, n_problems)
    assert "at least 6 are needed" in " ".join(comparison.warnings) or tells


def test_less_is_better_for_igd_plus(tmp_path):
    results = results_of(tmp_path, 1, 2, 4)
    for run in results.runs:
        run.igd_plus = 1.0 + run.algorithm + 0.01 * run.seed
    comparison = compare(results, [0], "igd_plus")
    assert comparison.pairs[0].effect == 1.0 and comparison.beaten_by(0) == [1]


def test_rounding_breaks_no_ties(tmp_path):
    results = results_of(tmp_path, 1, 2, 6)
    for run in results.runs:
        run.ratio = 0.9 + 1e-13 * run.algorithm
    assert (compare(results, [0], "ratio").pairs[0].p, compare(results, [0], "ratio").pairs[0].effect) == (1.0, 0.5)


def test_differences_of_medians_that_rounding_parts_are_equal(tmp_path):
    results = results_of(tmp_path, 4, 3, 2)
    medians = [[0.9, 0.3, 0.7, 0.5], [0.8, 0.4, 0.6, 0.4], [0.0] * 4]
    assert 0.4 - 0.3 != 0.5 - 0.4
    for run in results.runs:
        run.ratio = medians[run.algorithm][run.problem]
    pair = compare(results, range(4), "ratio").pairs[0]
    assert (pair.statistic, pair.p, pair.effect) == (7.5, pytest.approx(0.625), 0.5)
    # The median of two values that are rounded is not.
    for run in results.runs:
        run.ratio = (0.1, 0.2)[run.seed - 1] if run.algorithm == 0 else 0.15
    assert compare(results, range(4), "ratio").friedman.ranks.tolist() == [2.0, 2.0, 2.0]


def test_two_algorithms_have_no_average_ranks(tmp_path):
    # Seven orders of eight would part them after Nemenyi, but not by the Wilcoxon test if the eighth is the clearest.
    results = results_of(tmp_path, 8, 2, 2)
    for run in results.runs:
        run.ratio = (0.9, 0.5)[run.algorithm] if run.problem == 7 else (0.5, 0.6)[run.algorithm]
    comparison = compare(results, range(8), "ratio")
    assert critical_difference(2, 8) < 7 / 8 - 1 / 8 and comparison.pairs[0].p == pytest.approx(2 * 30 / 2**8)
    assert comparison.friedman is None
    files = write_report(tmp_path, output=tmp_path / "out", formats="svg")
    assert not [path for path in files if path.name.startswith("ranks")]
    assert "Average ranks by" not in texts(tmp_path / "out")[1]
    assert "friedman" not in {row["test"] for row in rows(tmp_path / "out" / "tests.csv")}


def test_problems_that_lack_an_algorithm_are_left_out_of_its_pairs(tmp_path):
    results = results_of(tmp_path, 7, 3, 2)
    for run in results.runs:
        if run.algorithm == 2 and run.problem < 3:
            run.status = "missing"
    comparison = compare(results, range(7), "ratio")
    assert [pair.n_first for pair in comparison.pairs] == [7, 4, 4]
    assert comparison.n_blocks == 4
    assert any("3 of 7 problems lack finished runs" in warning for warning in comparison.warnings)


def test_tests_of_single_problems_are_corrected_together(tmp_path):
    results = results_of(tmp_path, 3, 2, 5)
    each = compare_each(results, range(3), "ratio")
    p = sorted(pair.p for comparison in each for pair in comparison.pairs)
    assert min(pair.p_holm for comparison in each for pair in comparison.pairs) == pytest.approx(min(1.0, 3 * p[0]))


def test_csv_says_where_no_test_could_tell(tmp_path):
    results = results_of(tmp_path, 1, 3, 3)
    files = csv_files(results, [Family("group", [("g", compare(results, [0], "ratio"))])], times=True)
    found = list(csv.DictReader(io.StringIO(files["tests.csv"])))
    assert {row["significant"] for row in found} == {"too few values"}
