"""Which algorithms differ: the tests of a study's results, and warnings where no test could tell."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from pymoo_gridpath.study.report.results import Results
from pymoo_gridpath.study.report.statistics import significance
from pymoo_gridpath.study.report.statistics.significance import ALPHA

#: The measures that are tested, with what tables call them and whether larger is better.
TESTED = {"ratio": ("hypervolume ratio", True), "igd_plus": ("IGD+", False), "turn": ("mean turn", False)}

# To which values, medians and their differences are rounded: sums in another order would otherwise break ties.
_DECIMALS = 9


@dataclass(frozen=True)
class Pair:
    """Two algorithms compared.

    Attributes
    ----------
    first, second : int
        Indices of the algorithms.
    n_first, n_second : int
        Runs of each, or problems that both have.
    better, equal, worse : int
        On how many problems the first has the better median, an equal one or a worse one; 0 for runs.
    statistic, p, p_holm : float
    effect : float
        A12 of independent runs, the rank-biserial correlation of problems; larger speaks for the first.
    """

    first: int
    second: int
    n_first: int
    n_second: int
    better: int
    equal: int
    worse: int
    statistic: float
    p: float
    p_holm: float
    effect: float

    @property
    def significant(self) -> bool:
        """Whether the corrected p value is below `significance.ALPHA`."""
        return self.p_holm < ALPHA


@dataclass
class Comparison:
    """The tests of one measure on some problems.

    Attributes
    ----------
    measure : str
    over : {"seeds", "problems"}
        What the values that are compared differ by.
    pairs : list of Pair
    algorithms : list of int
        Those that are compared.
    n_blocks : int
        Problems that all of these have; of a comparison over seeds 1.
    friedman : Friedman or None
        Of three algorithms or more on two problems or more.
    warnings : list of str
        Sentences.
    """

    measure: str
    over: str
    algorithms: list[int]
    pairs: list[Pair] = field(default_factory=list)
    n_blocks: int = 1
    friedman: significance.Friedman | None = None
    warnings: list[str] = field(default_factory=list)

    def beaten_by(self, algorithm: int) -> list[int]:
        """Return the algorithms that one is significantly better than."""
        neutral = 0.5 if self.over == "seeds" else 0.0
        beaten = [pair.second for pair in self.pairs if pair.significant and pair.first == algorithm and pair.effect > neutral]
        beaten += [pair.first for pair in self.pairs if pair.significant and pair.second == algorithm and pair.effect < neutral]
        return sorted(beaten)

    @property
    def could_tell(self) -> bool:
        """Whether some corrected p value could have been below `significance.ALPHA`, whatever the results."""
        return could_tell([self])

    def least_p(self, pair: Pair) -> float:
        """Return the least p value that the test of a pair could have had."""
        if self.over == "seeds":
            return significance.least_p_mann_whitney(pair.n_first, pair.n_second)
        return significance.least_p_wilcoxon(pair.n_first)

    def warn_if_too_few(self) -> None:
        """Add a warning if no result whatever could be significant."""
        if not self.pairs or self.could_tell:
            return
        least = significance.holm(np.array([self.least_p(pair) for pair in self.pairs])).min()
        count = len(self.pairs)
        if self.over == "seeds":
            sizes = sorted({size for pair in self.pairs for size in (pair.n_first, pair.n_second)})
            needed = _needed(lambda n: count * significance.least_p_mann_whitney(n, n))
            what = f"{_counted(sizes, 'run')} an algorithm"
        else:
            sizes = sorted({pair.n_first for pair in self.pairs})
            needed = _needed(lambda n: count * significance.least_p_wilcoxon(n))
            what = _counted(sizes, "problem")
        self.warnings.append(
            f"Too few {'seeds' if self.over == 'seeds' else 'problems'}: with {what} and {count} pair{'s' * (count > 1)} of "
            f"algorithms, the least corrected p value of the {TESTED[self.measure][0]} that any results could have is "
            f"{least:.3g}, so that no pair can be called different at {ALPHA:g}; at least {needed} are needed."
        )


def compare(results: Results, problems: Sequence[int], measure: str) -> Comparison:
    """Compare the algorithms on one problem by their runs, on several by the medians of the problems.

    The exact front, which draws no random number, is not compared.

    Parameters
    ----------
    results : Results
    problems : sequence of int
    measure : {"ratio", "igd_plus", "turn"}
    """
    random = results.random
    compared = [k for k in random if results.finished(k, problems)]
    comparison = Comparison(measure, "seeds" if len(problems) == 1 else "problems", compared)
    left_out = [results.algorithms[k] for k in random if k not in compared]
    if left_out:
        comparison.warnings.append(f"Not compared, for want of finished runs: {', '.join(left_out)}.")
    if len(compared) < 2:
        comparison.warnings.append("Fewer than two algorithms that draw random numbers have finished runs: nothing to test.")
        return comparison
    if len(problems) == 1:
        _compare_runs(comparison, results, problems[0])
    else:
        _compare_medians(comparison, results, problems)
    comparison.warn_if_too_few()
    return comparison


def compare_each(results: Results, problems: Sequence[int], measure: str) -> list[Comparison]:
    """Compare the algorithms on each of several problems by their runs, with one correction for all problems and pairs."""
    each = []
    for problem in problems:
        compared = [k for k in results.random if results.finished(k, [problem])]
        each.append(Comparison(measure, "seeds", compared))
        if len(compared) > 1:
            _compare_runs(each[-1], results, problem)
    together = iter(_corrected([pair for comparison in each for pair in comparison.pairs]))
    for comparison in each:
        comparison.pairs = [next(together) for _ in comparison.pairs]
    return each


def could_tell(comparisons: Sequence[Comparison]) -> bool:
    """Whether some p value, corrected for all pairs of all comparisons, could have been below `ALPHA`, whatever the results."""
    least = [comparison.least_p(pair) for comparison in comparisons for pair in comparison.pairs]
    return bool(least) and bool(significance.holm(np.array(least)).min() < ALPHA)


def _compare_runs(comparison: Comparison, results: Results, problem: int) -> None:
    samples = {k: _oriented(results, comparison.measure, k, [problem]) for k in comparison.algorithms}
    drafts = []
    for first, second in itertools.combinations(comparison.algorithms, 2):
        x, y = samples[first], samples[second]
        outcome = significance.mann_whitney(x, y)
        drafts.append(Pair(first, second, len(x), len(y), 0, 0, 0, *outcome, math.nan, significance.vargha_delaney(x, y)))
    comparison.pairs = _corrected(drafts)
    if len({len(sample) for sample in samples.values()}) > 1:
        sizes = ", ".join(f"{results.algorithms[k]} {len(samples[k])}" for k in comparison.algorithms)
        comparison.warnings.append(f"Algorithms have different numbers of finished runs ({sizes}); all are used.")


def _compare_medians(comparison: Comparison, results: Results, problems: Sequence[int]) -> None:
    medians = np.full((len(problems), len(comparison.algorithms)), np.nan)
    uneven = 0
    for row, problem in enumerate(problems):
        sizes = set()
        for column, k in enumerate(comparison.algorithms):
            values = _oriented(results, comparison.measure, k, [problem])
            sizes.add(len(values))
            if len(values):
                medians[row, column] = np.round(np.median(values), _DECIMALS)
        uneven += len(sizes) > 1
    drafts = []
    for i, j in itertools.combinations(range(len(comparison.algorithms)), 2):
        both = ~np.isnan(medians[:, [i, j]]).any(axis=1)
        d = np.round(significance.paired_differences(medians[both, i], medians[both, j]), _DECIMALS)
        counts = len(d), len(d), int((d > 0).sum()), int((d == 0).sum()), int((d < 0).sum())
        pair = comparison.algorithms[i], comparison.algorithms[j]
        drafts.append(Pair(*pair, *counts, *significance.wilcoxon(d), math.nan, significance.rank_biserial(d)))
    comparison.pairs = _corrected(drafts)
    complete = medians[~np.isnan(medians).any(axis=1)]
    comparison.n_blocks = len(complete)
    if uneven:
        comparison.warnings.append(
            f"On {uneven} of {len(problems)} problems not all algorithms have the same number of finished runs; "
            "medians are over those that exist."
        )
    # Of two algorithms, the test of the pair says all there is to say.
    ranked = len(comparison.algorithms) > 2
    if len(complete) < len(problems):
        comparison.warnings.append(
            f"{len(problems) - len(complete)} of {len(problems)} problems lack finished runs of some algorithm: "
            f"{'average ranks leave them out, and ' * ranked}pairs of algorithms use the problems that both have."
        )
    if ranked and len(complete) >= 2:
        _rank(comparison, complete)


def _rank(comparison: Comparison, medians: np.ndarray) -> None:
    comparison.friedman = significance.friedman(medians)
    n, k = medians.shape
    least = significance.least_p_friedman(k, n)
    if least >= ALPHA:
        comparison.warnings.append(
            f"Too few problems: Friedman's test of {k} algorithms on {n} problems cannot have a p value below "
            f"{least:.3g}, so that the average ranks cannot be called different."
        )


def _oriented(results: Results, measure: str, algorithm: int, problems: Sequence[int]) -> np.ndarray:
    """Return the values of finished runs, larger being better, without differences that are but rounding."""
    values = np.round(results.values(measure, algorithm, problems), _DECIMALS)
    return values if TESTED[measure][1] else -values


def _corrected(pairs: list[Pair]) -> list[Pair]:
    corrected = significance.holm(np.array([pair.p for pair in pairs]))
    return [Pair(**{**vars(pair), "p_holm": float(p)}) for pair, p in zip(pairs, corrected, strict=True)]


def _needed(least: Callable[[int], float]) -> int:
    return next(n for n in itertools.count(2) if least(n) < ALPHA)


def _counted(sizes: list[int], what: str) -> str:
    text = str(sizes[0]) if len(sizes) == 1 else f"{sizes[0]} to {sizes[-1]}"
    return f"{text} {what}{'s' * (sizes != [1])}"
