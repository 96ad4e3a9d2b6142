"""Medians and quartiles of a study's measures, and its tests, as tables to read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pymoo_gridpath.exact.nearness import WHOLE, together
from pymoo_gridpath.study.report.results import Results
from pymoo_gridpath.study.report.statistics.comparisons import TESTED, Comparison
from pymoo_gridpath.study.report.statistics.significance import ALPHA
from pymoo_gridpath.study.report.statistics.summaries import quartiles
from pymoo_gridpath.study.report.tables.table import (
    NOTHING,
    Table,
    count,
    percent,
    probability,
    ratio,
    signed,
    significant,
    spread,
)


def reference_phrase(results: Results, problems: Sequence[int]) -> str:
    """Return what runs on some problems are measured against, as part of a sentence."""
    fronts = [results.references[problem].front for problem in problems]
    merged = sum(not front.exact for front in fronts)
    if not merged:
        return "the exact front"
    if not any(len(front) for front in fronts):
        return "no front, since no run found a legal path"
    if merged == len(fronts):
        return "the merged front of all runs, since no exact front is at hand"
    return f"the exact front, but on {merged} of {len(fronts)} problems the merged front of all runs"


def quality_table(results: Results, problems: Sequence[int], name: str, place: str, comparison: Comparison) -> Table:
    """Return how good the final fronts of each algorithm are, and than which others its ratio is significantly better."""
    header = ["#", "algorithm", "finished", "feasible", "hypervolume ratio", "IGD+", "front found", "mean turn (degrees)"]
    finished = [results.finished(k, problems) for k in range(len(results.algorithms))]
    certified = [together([run.certified for run in runs]) if runs else None for runs in finished]
    # Where all that were certified are whole, the note on what is not complete says as much.
    shown = any(one not in (None, WHOLE) for one in certified)
    header += ["certified"] * shown + ["better than"]
    rows = []
    for k, label in enumerate(results.algorithms):
        runs = results.finished(k, problems)
        n = f"{len(runs)} of {len(results.planned(k, problems))}"
        cells = [str(k + 1), label, n, _feasible(runs)]
        for measure, show in (("ratio", ratio), ("igd_plus", significant), ("share", percent), ("turn", count)):
            cells.append(spread(quartiles(results.values(measure, k, problems)), show))
        if shown:
            one = certified[k]
            cells.append(NOTHING if one is None else one.short)
        rows.append([*cells, _better_than(comparison, k)])
    what = f"Final fronts {place}, measured against {reference_phrase(results, problems)}."
    if results.references[problems[0]].epochs:
        what = f"Fronts at the end of each epoch {place}, means over the epochs, each measured against "
        what += f"{reference_phrase(results, problems)} of its own map; the turn is that of the last."
    notes = [f"Median [quartiles] over all finished runs. {_explain_better(comparison)}", *_incomplete(results, problems)]
    if shown:
        notes.insert(1, "Certified: how near to the exact front, by a factor or a share of range, the worst is proven to be.")
    return Table(f"{name}-quality", what, header, rows, left=2, notes=notes)


def effort_table(results: Results, problems: Sequence[int], name: str, place: str, times: bool) -> Table:
    """Return how soon the runs of each algorithm reach the target."""
    header = ["#", "algorithm", "reached", "evaluations to target", "evaluations"]
    columns = [("evaluations_to_target", count), ("n_eval", count)]
    if times:
        header[4:] = ["seconds to target", "evaluations", "seconds"]
        columns[1:] = [("seconds_to_target", significant), ("n_eval", count), ("seconds", significant)]
    rows = []
    for k, label in enumerate(results.algorithms):
        reached = n_reached(results, k, problems)
        cells = [str(k + 1), label, f"{reached} of {len(results.finished(k, problems))}"]
        cells += [spread(quartiles(results.values(measure, k, problems)), show) for measure, show in columns]
        rows.append(cells)
    against = reference_phrase(results, problems)
    what = f"Effort {place} until the hypervolume ratio first reaches {results.target:g}, the target. Ratios are to {against}."
    note = (
        "Median [quartiles] over all finished runs; one that did not reach the target counts as infinite (∞). "
        "The evaluations to the target are those of the first stored record that reaches it."
    )
    return Table(f"{name}-effort", what, header, rows, left=2, notes=[note])


def pairs_table(results: Results, comparison: Comparison, name: str, place: str) -> Table:
    """Return the tests of all pairs of algorithms."""
    labels = results.algorithms
    measure = TESTED[comparison.measure][0]
    rows = []
    over_seeds = comparison.over == "seeds"
    for pair in comparison.pairs:
        cells = [labels[pair.first], labels[pair.second]]
        if over_seeds:
            cells += [str(pair.n_first), str(pair.n_second)]
        else:
            cells += [str(pair.n_first), f"{pair.better} / {pair.equal} / {pair.worse}"]
        cells += [f"{pair.statistic:g}", probability(pair.p), probability(pair.p_holm), signed(pair.effect)]
        rows.append([*cells, "yes" if pair.significant else "no"])
    if over_seeds:
        header = ["first", "second", "runs of first", "runs of second", "U", "p", "p (Holm)", "A12", "significant"]
        what = f"Mann-Whitney U tests of the {measure} {place}, over runs."
        note = "A12 is the chance that a run of the first algorithm is better than one of the second; 0.5 is no difference."
    else:
        header = ["first", "second", "problems", "better / equal / worse", "W", "p", "p (Holm)", "effect", "significant"]
        what = f"Wilcoxon signed-rank tests of the {measure} {place}, over the medians of problems."
        note = "The effect is the matched-pairs rank-biserial correlation: 1 if the first is better wherever they differ."
    if not comparison.could_tell:
        header = header[:-1]
        rows = [row[:-1] for row in rows]
    return Table(f"{name}-tests-{comparison.measure.replace('_', '-')}", what, header, rows, left=2, notes=[note])


def each_table(results: Results, each: Sequence[Comparison], name: str, place: str) -> Table:
    """Return on how many problems the runs of one algorithm are significantly better than those of another."""
    labels, measure = results.algorithms, TESTED[each[0].measure][0]
    found: dict[tuple[int, int], list[int]] = {}
    for pair in (pair for comparison in each for pair in comparison.pairs):
        counts = found.setdefault((pair.first, pair.second), [0, 0, 0])
        counts[0] += 1
        counts[1] += pair.significant and pair.effect > 0.5
        counts[2] += pair.significant and pair.effect < 0.5
    header = ["first", "second", "problems", "first better on", "second better on"]
    rows = [[labels[i], labels[j], *map(str, found[i, j])] for i, j in sorted(found)]
    what = f"Tests of single problems {place}: on how many one algorithm's {measure} is significantly better."
    note = "Mann-Whitney U tests over the runs of each problem, with one correction by Holm for all problems and pairs; "
    note += "single p values and effect sizes stand in tests.csv."
    return Table(f"{name}-each-{each[0].measure.replace('_', '-')}", what, header, rows, left=2, notes=[note])


def ranks_table(results: Results, comparison: Comparison, name: str, place: str) -> Table:
    """Return the average ranks of the algorithms, best first."""
    assert comparison.friedman is not None
    ranks = comparison.friedman.ranks
    rows = [[results.algorithms[comparison.algorithms[k]], f"{ranks[k]:.3f}"] for k in np.argsort(ranks, kind="stable")]
    measure = TESTED[comparison.measure][0]
    what = f"Average ranks {place} by the median {measure} of each of {comparison.n_blocks} problems, 1 the best."
    return Table(
        f"{name}-ranks-{comparison.measure.replace('_', '-')}",
        what,
        ["algorithm", "average rank"],
        rows,
        notes=[friedman_sentence(comparison)],
    )


def friedman_sentence(comparison: Comparison) -> str:
    """Return what Friedman's test says."""
    assert comparison.friedman is not None
    outcome, k = comparison.friedman, len(comparison.algorithms)
    difference = f"Nemenyi's critical difference at 0.05 is {outcome.critical_difference:.3f}."
    p = probability(outcome.p)
    p = f"p < {p[1:]}" if p.startswith("<") else f"p = {p}"
    verdict = "" if outcome.p < ALPHA else " The ranks do not differ significantly."
    return f"Friedman's test: chi-square {outcome.statistic:.3f} with {k - 1} degrees of freedom, {p}.{verdict} {difference}"


def matrix_table(results: Results, rows: Mapping[str, Sequence[int]], name: str, what: str, first: str) -> Table:
    """Return the median hypervolume ratio of each algorithm (columns) on each named set of problems (rows)."""
    cells = [
        [label, *(ratio(quartiles(results.values("ratio", k, problems))[1]) for k in range(len(results.algorithms)))]
        for label, problems in rows.items()
    ]
    return Table(name, what, [first, *results.algorithms], cells)


def n_reached(results: Results, algorithm: int, problems: Sequence[int]) -> int:
    """Return how many finished runs reached the target; the exact front counts no evaluations, but seconds."""
    runs = results.finished(algorithm, problems)
    return sum(run.seconds_to_target < float("inf") for run in runs)


def _feasible(runs) -> str:
    return percent(float(np.mean([run.feasible for run in runs]))) if runs else NOTHING


def _better_than(comparison: Comparison, algorithm: int) -> str:
    if algorithm not in comparison.algorithms:
        return NOTHING
    if not comparison.could_tell:
        return "no test"
    return ", ".join(str(k + 1) for k in comparison.beaten_by(algorithm)) or "none"


def _explain_better(comparison: Comparison) -> str:
    if not comparison.pairs:
        return "There are no two algorithms with finished runs to compare."
    if not comparison.could_tell:
        if comparison.over == "problems":
            return "With so few problems, no test of the medians of two algorithms could be significant; see below."
        return "With so few runs, no test of two algorithms could be significant; see below."
    test = "Mann-Whitney, over runs" if comparison.over == "seeds" else "Wilcoxon signed-rank, over the medians of problems"
    return f"The last column gives the numbers (#) of the algorithms with a significantly lower ratio ({test}, Holm, 0.05)."


def _incomplete(results: Results, problems: Sequence[int]) -> list[str]:
    """Return a sentence on the exact algorithms whose fronts are not whole."""
    sentences = []
    for k, label in enumerate(results.algorithms):
        runs = results.finished(k, problems)
        partial = sum(not run.complete for run in runs)
        if partial:
            sentences.append(f"The front of {label} is not complete in {partial} of {len(runs)} runs.")
    return sentences
