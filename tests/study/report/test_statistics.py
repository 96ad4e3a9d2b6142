"""Tests and effect sizes against scipy, enumeration, and published examples."""

import itertools
import math
import time
import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from pymoo_gridpath.study.report.statistics import significance

# Few different values, so that ties abound.
TIED = st.integers(0, 3).map(float)
# Areas under the curve of four classifiers on fourteen data sets, from table 6 of Demsar (2006).
DEMSAR = np.array(
    [
        [0.763, 0.768, 0.771, 0.798],
        [0.599, 0.591, 0.590, 0.569],
        [0.954, 0.971, 0.968, 0.967],
        [0.628, 0.661, 0.654, 0.657],
        [0.882, 0.888, 0.886, 0.898],
        [0.936, 0.931, 0.916, 0.931],
        [0.661, 0.668, 0.609, 0.685],
        [0.583, 0.583, 0.563, 0.625],
        [0.775, 0.838, 0.866, 0.875],
        [1.000, 1.000, 1.000, 1.000],
        [0.940, 0.962, 0.965, 0.962],
        [0.619, 0.666, 0.614, 0.669],
        [0.972, 0.981, 0.975, 0.9749],  # printed as equal, but with the ranks 2 and 3
        [0.957, 0.978, 0.946, 0.970],
    ]
)


@pytest.fixture(autouse=True)
def no_warnings():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


def two_sided(values, observed):
    """Return twice the smaller tail of equally likely values."""
    values = np.asarray(values)
    return min(1.0, 2 * min(np.mean(values <= observed + 1e-9), np.mean(values >= observed - 1e-9)))


@settings(max_examples=60)
@given(st.lists(TIED, min_size=1, max_size=5), st.lists(TIED, min_size=1, max_size=5))
def test_mann_whitney_counts_all_ways_to_share_out_ranks(x, y):
    ranks = stats.rankdata(x + y)
    sums = [sum(ranks[list(chosen)]) for chosen in itertools.combinations(range(len(ranks)), len(x))]
    outcome = significance.mann_whitney(np.array(x), np.array(y))
    assert outcome.p == pytest.approx(two_sided(sums, sum(ranks[: len(x)])), abs=1e-12)
    assert outcome.statistic == sum((a > b) + 0.5 * (a == b) for a in x for b in y)


@pytest.mark.parametrize(("n", "m"), [(1, 1), (3, 7), (11, 11), (20, 5), (30, 30)])
def test_mann_whitney_without_ties_is_that_of_scipy(n, m):
    rng = np.random.default_rng(n)
    x, y = rng.random(n), rng.random(m) + 0.2
    expected = stats.mannwhitneyu(x, y, method="exact")
    assert significance.mann_whitney(x, y) == pytest.approx((expected.statistic, expected.pvalue), rel=1e-9)


def test_mann_whitney_of_large_samples_is_near_the_exact_one():
    rng = np.random.default_rng(0)
    x, y = rng.random(60), rng.random(60) + 0.12
    exact = stats.mannwhitneyu(x, y, method="exact").pvalue
    assert significance.mann_whitney(x, y).p == pytest.approx(exact, rel=0.15)


@pytest.mark.parametrize(("n", "m"), [(8, 300), (8, 100), (3, 300), (1, 900), (2, 5)])
def test_mann_whitney_is_the_same_and_soon_done_whichever_sample_is_larger(n, m):
    rng = np.random.default_rng(m)
    x, y = rng.integers(0, 40, n) + 9.0, rng.integers(0, 40, m).astype(float)
    start = time.process_time()
    one, other = significance.mann_whitney(x, y), significance.mann_whitney(y, x)
    assert time.process_time() - start < 5.0
    assert (one.p, one.statistic) == (pytest.approx(other.p, rel=1e-12), n * m - other.statistic)


def test_three_runs_against_three_are_never_significant():
    # The normal approximation with its correction for ties says 0.047.
    assert stats.mannwhitneyu([1, 1, 1], [0, 0, 0], method="asymptotic").pvalue < 0.05
    assert significance.mann_whitney(np.ones(3), np.zeros(3)).p == pytest.approx(0.1)


@settings(max_examples=60)
@given(st.lists(st.integers(-3, 3).map(float), min_size=1, max_size=8))
def test_wilcoxon_counts_all_signs(differences):
    d = [value for value in differences if value]
    ranks = stats.rankdata(np.abs(d)) if d else np.empty(0)
    sums = [sum(ranks[np.array(signs)]) for signs in itertools.product((False, True), repeat=len(d))] if d else [0.0]
    observed = sum(rank for rank, value in zip(ranks, d, strict=True) if value > 0)
    outcome = significance.wilcoxon(np.array(differences))
    assert outcome.p == pytest.approx(two_sided(sums, observed), abs=1e-12)


@pytest.mark.parametrize("n", [1, 6, 25, 50])
def test_wilcoxon_without_ties_is_that_of_scipy(n):
    d = np.random.default_rng(n).normal(0.3, 1.0, n)
    expected = stats.wilcoxon(d, alternative="greater", method="exact").statistic, stats.wilcoxon(d, method="exact").pvalue
    assert significance.wilcoxon(d) == pytest.approx(expected, rel=1e-9)


def test_wilcoxon_of_very_many_differences_is_near_the_exact_one(monkeypatch):
    d = np.random.default_rng(3).normal(0.12, 1.0, 401)
    approximate = significance.wilcoxon(d).p
    monkeypatch.setattr(significance, "_MOST_DIFFERENCES", 1000)
    assert significance.wilcoxon(d).p == pytest.approx(approximate, rel=0.04)


@pytest.mark.parametrize("n", range(1, 6))
def test_least_p_values_are_those_of_the_best_arrangement(n):
    m = 4
    values = np.arange(n + m, dtype=float)
    arrangements = itertools.combinations(range(n + m), n)
    least = min(significance.mann_whitney(values[list(a)], np.delete(values, a)).p for a in arrangements)
    assert significance.least_p_mann_whitney(n, m) == pytest.approx(least)
    signs = itertools.product((-1.0, 1.0), repeat=n)
    assert significance.least_p_wilcoxon(n) == pytest.approx(min(significance.wilcoxon(values[1 : n + 1] * s).p for s in signs))


def test_least_p_of_friedman_is_that_of_equal_orders():
    values = np.tile([3.0, 2.0, 1.0, 0.0], (5, 1))
    assert significance.least_p_friedman(4, 5) == pytest.approx(significance.friedman(values).p)


def test_no_differences_have_p_one():
    same = np.full(5, 0.25)
    assert significance.mann_whitney(same, same) == (12.5, 1.0)
    assert significance.wilcoxon(np.zeros(5)) == (0.0, 1.0)
    assert significance.vargha_delaney(same, same) == 0.5
    assert significance.rank_biserial(np.zeros(5)) == 0.0
    outcome = significance.friedman(np.ones((6, 3)))
    assert outcome.p == 1.0 and outcome.ranks.tolist() == [2.0, 2.0, 2.0]


def test_infinite_values_rank_last():
    x, y = np.array([-np.inf, -np.inf, 3.0]), np.array([4.0, 5.0, 6.0])
    as_ranked = significance.mann_whitney(np.array([0.0, 0.0, 3.0]), y)
    assert significance.mann_whitney(x, y) == as_ranked
    d = significance.paired_differences(x, np.array([-np.inf, 1.0, 2.0]))
    assert d.tolist() == [0.0, -np.inf, 1.0]
    assert significance.rank_biserial(d) == pytest.approx((1 - 2) / 3)


@pytest.mark.parametrize(
    ("p", "corrected"),
    [
        # Worked by hand: 4 x 0.005, 3 x 0.01, 2 x 0.03, and no less than that for the last.
        ([0.01, 0.04, 0.03, 0.005], [0.03, 0.06, 0.06, 0.02]),
        ([0.01, 0.02, 0.03, 0.04, 0.05], [0.05, 0.08, 0.09, 0.09, 0.09]),
        ([0.6, 0.7], [1.0, 1.0]),
        ([0.02], [0.02]),
    ],
)
def test_holm_of_worked_examples(p, corrected):
    assert significance.holm(np.array(p)) == pytest.approx(corrected)


@given(st.lists(st.floats(0.0, 0.2), min_size=1, max_size=8), st.sampled_from([0.01, 0.05, 0.1]))
def test_holm_rejects_what_stepping_down_rejects(p, alpha):
    rejected = np.zeros(len(p), dtype=bool)
    for step, k in enumerate(sorted(range(len(p)), key=p.__getitem__)):
        if not p[k] * (len(p) - step) < alpha:
            break
        rejected[k] = True
    assert (significance.holm(np.array(p)) < alpha).tolist() == rejected.tolist()


@given(st.lists(TIED, min_size=1, max_size=6), st.lists(TIED, min_size=1, max_size=6))
def test_vargha_delaney_counts_pairs(x, y):
    expected = np.mean([(a > b) + 0.5 * (a == b) for a in x for b in y])
    assert significance.vargha_delaney(np.array(x), np.array(y)) == pytest.approx(expected)


def test_rank_biserial_of_a_worked_example():
    # Ranks 1 (positive), 2.5 (positive), 2.5 (negative), 4 (positive) of ten in all.
    assert significance.rank_biserial(np.array([1.0, 2.0, -2.0, 3.0, 0.0])) == pytest.approx((7.5 - 2.5) / 10)


def test_friedman_of_the_published_example():
    outcome = significance.friedman(DEMSAR)
    assert outcome.ranks == pytest.approx([3.143, 2.000, 2.893, 1.964], abs=5e-4)
    expected = stats.friedmanchisquare(*DEMSAR.T)
    assert (outcome.statistic, outcome.p) == pytest.approx((expected.statistic, expected.pvalue))
    # The paper's statistic has no correction for ties.
    uncorrected = 12 * 14 / (4 * 5) * (np.sum(outcome.ranks**2) - 4 * 5**2 / 4)
    assert uncorrected == pytest.approx(9.28, abs=0.01)
    assert outcome.critical_difference == pytest.approx(1.25, abs=0.005)


@pytest.mark.parametrize(("k", "q"), list(enumerate([1.960, 2.343, 2.569, 2.728, 2.850, 2.949, 3.031, 3.102, 3.164], start=2)))
def test_critical_values_are_those_of_the_published_table(k, q):
    # Table 5 of Demsar (2006), which has three decimals.
    assert significance.critical_difference(k, 1) / math.sqrt(k * (k + 1) / 6) == pytest.approx(q, abs=0.0015)


def test_cliques_are_the_largest_stretches():
    ranks = np.array([1.0, 1.5, 2.4, 4.0, 4.1])
    assert significance.cliques(ranks, 1.0) == [(0, 1), (1, 2), (3, 4)]
    assert significance.cliques(ranks, 9.0) == [(0, 4)]
    assert significance.cliques(ranks, 0.05) == []
