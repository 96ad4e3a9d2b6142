"""Tests and effect sizes for the comparison of algorithms.

The tests of two samples are exact whatever ties there are: the distribution of the rank sum is counted out over all ways in
which the observed ranks can fall. `scipy.stats` does so for samples without ties only, and its normal approximation may call
three runs against three significant, which no arrangement of six ranks supports. Large samples go to that approximation.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from scipy import stats

#: What a corrected p value must stay below for a difference to be called significant.
ALPHA = 0.05

# From this product of the sizes of two samples on, the normal approximation serves.
_MOST_PAIRS = 900

# From this number of differences on, the normal approximation serves.
_MOST_DIFFERENCES = 400


class TestResult(NamedTuple):
    """Statistic and two-sided p value of a test."""

    # Pytest takes it for tests by its name.
    __test__ = False

    statistic: float
    p: float


class Friedman(NamedTuple):
    """Outcome of Friedman's test.

    Attributes
    ----------
    ranks : numpy.ndarray, shape (k,)
        Average rank of each algorithm, 1 the best.
    statistic : float
    p : float
    critical_difference : float
        How far apart two average ranks must be to differ significantly, after Nemenyi.
    """

    ranks: np.ndarray
    statistic: float
    p: float
    critical_difference: float


def mann_whitney(x: np.ndarray, y: np.ndarray) -> TestResult:
    """Test whether one of two independent samples tends to larger values (Mann-Whitney U, two-sided).

    Parameters
    ----------
    x, y : numpy.ndarray, shape (n,) and (m,)
        Without NaN; ``inf`` ranks last.

    Returns
    -------
    TestResult
        With U of the first sample: the number of pairs in which it is larger, ties counting half.
    """
    n, m = len(x), len(y)
    ranks = stats.rankdata(np.concatenate([x, y]))
    u = float(ranks[:n].sum() - n * (n + 1) / 2)
    if np.all(ranks == ranks[0]):
        return TestResult(u, 1.0)
    if n * m > _MOST_PAIRS:
        return TestResult(u, float(stats.mannwhitneyu(x, y, method="asymptotic").pvalue))
    # Twice the ranks are integers, ties or not. ways[j, s]: in how many ways j of them have the sum s. Of the smaller sample,
    # which has the same p value and fewer ways.
    doubled = np.rint(2 * ranks).astype(int)
    smaller = doubled[:n] if n <= m else doubled[n:]
    few = len(smaller)
    size = int(np.sort(doubled)[-few:].sum()) + 1
    ways = np.zeros((few + 1, size))
    ways[0, 0] = 1.0
    for rank in doubled:
        ways[1:, rank:] += ways[:-1, : size - rank].copy()
    return TestResult(u, _two_sided(ways[few] / math.comb(n + m, few), int(smaller.sum())))


def wilcoxon(differences: np.ndarray) -> TestResult:
    """Test whether paired differences lie about zero (Wilcoxon signed-rank, two-sided, zeros left out).

    Parameters
    ----------
    differences : numpy.ndarray, shape (n,)

    Returns
    -------
    TestResult
        With the sum of the ranks of the positive differences.
    """
    d = differences[differences != 0]
    if not len(d):
        return TestResult(0.0, 1.0)
    ranks = stats.rankdata(np.abs(d))
    positive = float(ranks[d > 0].sum())
    if len(d) > _MOST_DIFFERENCES:
        outcome: Any = stats.wilcoxon(d)
        return TestResult(positive, float(outcome.pvalue))
    # Twice the ranks are integers, ties or not. chance[s]: that the ranks of random signs have the positive sum s.
    doubled = np.rint(2 * ranks).astype(int)
    chance = np.zeros(int(doubled.sum()) + 1)
    chance[0] = 1.0
    for rank in doubled:
        chance[rank:] += chance[: len(chance) - rank].copy()
        chance /= 2.0
    return TestResult(positive, _two_sided(chance, round(2 * positive)))


def _two_sided(chance: np.ndarray, observed: int) -> float:
    """Return twice the chance of the tail that a value lies in, itself included."""
    return float(min(1.0, 2.0 * min(chance[: observed + 1].sum(), chance[observed:].sum())))


def least_p_mann_whitney(n: int, m: int) -> float:
    """Return the least p value that samples of these sizes can have: that of two samples that do not overlap."""
    return min(1.0, 2.0 / math.comb(n + m, n))


def least_p_wilcoxon(n: int) -> float:
    """Return the least p value that this number of differences can have: that of equal signs."""
    return min(1.0, 2.0 / 2.0**n)


def least_p_friedman(k: int, n: int) -> float:
    """Return the least p value that Friedman's test can have: that of k algorithms in one order on all n problems."""
    return float(stats.chi2.sf(n * (k - 1), k - 1))


def holm(p_values: np.ndarray) -> np.ndarray:
    """Return p values corrected for their number by the step-down method of Holm.

    Those below a level may be called significant together, with at most that chance of any false call.

    Parameters
    ----------
    p_values : numpy.ndarray, shape (n,)

    References
    ----------
    Holm (1979), A simple sequentially rejective multiple test procedure.
    """
    p = np.asarray(p_values, dtype=float)
    order = np.argsort(p, kind="stable")
    corrected = np.empty(len(p))
    corrected[order] = np.minimum(np.maximum.accumulate(p[order] * np.arange(len(p), 0, -1)), 1.0)
    return corrected


def vargha_delaney(x: np.ndarray, y: np.ndarray) -> float:
    """Return A12: the chance that a value of the first sample is larger than one of the second, ties counting half.

    References
    ----------
    Vargha and Delaney (2000), A critique and improvement of the CL common language effect size statistics.
    """
    ranks = stats.rankdata(np.concatenate([x, y]))
    n, m = len(x), len(y)
    return float((ranks[:n].sum() - n * (n + 1) / 2) / (n * m))


def rank_biserial(differences: np.ndarray) -> float:
    """Return the matched-pairs rank-biserial correlation: by how much the ranks of positive differences outweigh the others.

    1 if all differences that are not zero are positive, -1 if all are negative, 0 if there are none.

    References
    ----------
    Kerby (2014), The simple difference formula.
    """
    d = differences[differences != 0]
    if not len(d):
        return 0.0
    ranks = stats.rankdata(np.abs(d))
    return float((ranks[d > 0].sum() - ranks[d < 0].sum()) / ranks.sum())


def friedman(values: np.ndarray) -> Friedman:
    """Test whether algorithms rank alike across problems, and how far apart average ranks must be.

    Parameters
    ----------
    values : numpy.ndarray, shape (n, k)
        One row a problem, one column an algorithm, larger being better; at least two problems and three algorithms.

    Returns
    -------
    Friedman
        Its p value is the chi-square approximation, which is rough for few problems.

    References
    ----------
    Demsar (2006), Statistical comparisons of classifiers over multiple data sets.
    """
    n, k = values.shape
    ranks = stats.rankdata(-values, axis=1)
    average = ranks.mean(axis=0)
    difference = critical_difference(k, n)
    if np.all(ranks == ranks[:, :1]):
        return Friedman(average, 0.0, 1.0, difference)
    # Of ranks, whose ties scipy sees as well as those of the values, and which have no infinite ones.
    outcome = stats.friedmanchisquare(*ranks.T)
    return Friedman(average, float(outcome.statistic), float(outcome.pvalue), difference)


def critical_difference(k: int, n: int, alpha: float = ALPHA) -> float:
    """Return the difference of average ranks of k algorithms on n problems beyond which two differ, after Nemenyi.

    References
    ----------
    Demsar (2006), section 3.2.2.
    """
    q = stats.studentized_range.ppf(1.0 - alpha, k, np.inf) / math.sqrt(2.0)
    return float(q * math.sqrt(k * (k + 1) / (6.0 * n)))


def cliques(ranks: np.ndarray, difference: float) -> list[tuple[int, int]]:
    """Return the largest stretches of ascending ranks, of two or more, that do not differ, as pairs of first and last place."""
    found: list[tuple[int, int]] = []
    for i in range(len(ranks)):
        last = int(np.searchsorted(ranks, ranks[i] + difference, side="right")) - 1
        if last > i and (not found or last > found[-1][1]):
            found.append((i, last))
    return found


def paired_differences(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return ``x - y``, 0 where both are infinite."""
    with np.errstate(invalid="ignore"):
        return np.where(x == y, 0.0, x - y)
