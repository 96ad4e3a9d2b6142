"""What stands in a report and in which order."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from functools import partial

from pymoo_gridpath.study.report.figures.fronts import plot_attainment, plot_fronts
from pymoo_gridpath.study.report.figures.moving import plot_epochs
from pymoo_gridpath.study.report.figures.plots import plot_convergence, plot_ranks, plot_ratios
from pymoo_gridpath.study.report.figures.stretched_axis import scale_sentence
from pymoo_gridpath.study.report.figures.style import AlgorithmStyle, algorithm_styles
from pymoo_gridpath.study.report.page import definitions, settings, state
from pymoo_gridpath.study.report.page.blocks import Block, Caution, Drawing, Fold, Heading, Text
from pymoo_gridpath.study.report.page.explorers import Rows, linked_pages
from pymoo_gridpath.study.report.results import Results
from pymoo_gridpath.study.report.statistics.comparisons import TESTED, Comparison, compare, compare_each, could_tell
from pymoo_gridpath.study.report.tables import moving, summary
from pymoo_gridpath.study.report.tables.csv_files import Family

# Beyond these numbers, tables and figures of single problems or groups would bury the page.
_MOST_PROBLEMS = 40
_MOST_GROUPS = 8
_GROUPS_A_FIGURE = 12


class Contents:
    """The blocks of a report, and the tests among them.

    Parameters
    ----------
    results : Results
    times : bool
        Whether seconds, machines and versions are part of it.
    rows : callable, optional
        See `Rows`; without it the report links no pages to choose a path from.

    Attributes
    ----------
    families : list of Family
        All tests.
    """

    def __init__(self, results: Results, times: bool, rows: Rows | None = None):
        self.results, self.rows = results, rows
        self.times = times
        labels = results.algorithms
        self.styles: list[AlgorithmStyle] = algorithm_styles(labels, [results.is_deterministic(k) for k in range(len(labels))])
        self.families: list[Family] = []

    def blocks(self) -> Iterator[Block]:
        """Yield the blocks; drawings are drawn one at a time by whoever takes them."""
        results = self.results
        yield Heading(f"Study {results.plan.name}", 1)
        if not any(run.finished for run in results.runs):
            sentence = state.state_sentence(results)
            yield Caution((f"No run of this study is finished, so that there is nothing to report: {sentence}",))
            yield from state.unfinished_blocks(results)
            return
        yield Text(state.state_sentence(results))
        cautions = state.general_cautions(results)
        if cautions:
            yield Caution(tuple(cautions))
        yield from settings.settings_blocks(results, self.times)
        yield from self._overview()
        # The tests across all problems are called "all".
        names = slugs(["all", *results.groups])
        for group, problems in results.groups.items():
            yield from self._group(group, names[group], problems)
        yield from state.unfinished_blocks(results)
        yield from definitions.definition_blocks(results, self.times)
        if self.times:
            yield from definitions.origin_blocks(results)

    def _overview(self) -> Iterator[Block]:
        """Yield what covers all groups: their final ratios and, of several, the comparison across all problems."""
        results, groups = self.results, self.results.groups
        yield Heading("Overview")
        everything = list(range(len(results.plan.problems)))
        against = summary.reference_phrase(results, everything)
        if len(groups) > 1:
            what = f"Median hypervolume ratio over the finished runs on each group of problems. Ratios are to {against}."
            yield summary.matrix_table(results, groups, "overview", what, "group")
        names = list(groups)
        for begin in range(0, len(names), _GROUPS_A_FIGURE):
            shown = {name: groups[name] for name in names[begin : begin + _GROUPS_A_FIGURE]}
            number = "" if len(names) <= _GROUPS_A_FIGURE else f"-{begin // _GROUPS_A_FIGURE + 1}"
            problems = [problem for members in shown.values() for problem in members]
            caption = (
                f"Hypervolume ratio of the final front to {summary.reference_phrase(results, problems)}: every "
                "finished run is a point; the box reaches from the lower to the upper quartile, the thick line is the median. "
                + scale_sentence(results, list(shown.values()))
            )
            yield Drawing(f"ratios{number}", caption, partial(plot_ratios, results, shown, self.styles), "")
        if len(groups) > 1:
            yield from self._tests("study", "all problems", "all", "across all problems", everything)[1]

    def _group(self, group: str, name: str, problems: list[int]) -> Iterator[Block]:
        results, place = self.results, f"on {group}"
        comparison, tests = self._tests("group", group, name, place, problems)
        yield Heading(group)
        yield summary.quality_table(results, problems, name, place, comparison)
        yield summary.effort_table(results, problems, name, place, self.times)
        moves = bool(moving.moving_problems(results, problems))
        if moves:
            yield moving.epochs_table(results, problems, name, place)
        if 1 < len(problems) <= _MOST_PROBLEMS:
            against = summary.reference_phrase(results, problems)
            rows = {results.plan.problems[k].label: [k] for k in problems}
            what = f"Median hypervolume ratio on each problem of {group}. Ratios are to {against}."
            yield Fold("Each problem", (summary.matrix_table(results, rows, f"{name}-problems", what, "problem"),))
        elif len(problems) > 1:
            yield Text("The numbers of each problem stand in summary.csv.")
        if list(results.groups).index(group) < _MOST_GROUPS:
            if moves:
                yield self._epochs_drawing(group, name, problems)
            yield from self._drawings(group, name, problems)
        else:
            yield Text(f"Figures are drawn for the first {_MOST_GROUPS} groups.")
        yield from tests

    def _epochs_drawing(self, group: str, name: str, problems: list[int]) -> Drawing:
        caption = (
            f"The epochs on {group}: median (line) and quartiles (band) over the finished runs of algorithms that draw random "
            "numbers, of what had been found at the end of each epoch. Ratios and IGD+ are to "
            f"{summary.reference_phrase(self.results, problems)} of its own map. {scale_sentence(self.results, [problems])}"
        )
        draw = partial(plot_epochs, self.results, problems, self.styles)
        return Drawing(f"epochs-{name}", caption, draw, f"No run on {group} has finished.")

    def _drawings(self, group: str, name: str, problems: list[int]) -> Iterator[Block]:
        results, label = self.results, self.results.plan.problems[problems[0]].label
        over = "runs" if len(problems) == 1 else f"runs on all {len(problems)} problems"
        moves = bool(moving.moving_problems(results, problems))
        moved = " Each record is measured against the front of the map that there was; obstacles moved in between." * moves
        caption = (
            f"Convergence on {group}: median (line) and quartiles (band) over the finished {over}. Ratios are to "
            f"{summary.reference_phrase(results, problems)}; lengths are over the least length on that front; legal members "
            f"are those of the population that are legal paths.{moved} What is far off in the first tenth is cut, and there is "
            f"no line where half of the runs have no legal path to measure. {scale_sentence(results, [problems])}"
        )
        draw = partial(plot_convergence, results, problems, self.styles)
        yield Drawing(f"convergence-{name}", caption, draw, f"No run on {group} has a history to draw.")
        first = label if len(problems) == 1 else f"{label}, the first of the {len(problems)} problems of {group}"
        first += " at the end of the last epoch" * moves
        against = summary.reference_phrase(results, problems[:1])
        caption = (
            f"Empirical attainment surfaces on {first}: the border of what any run, half of the runs and all runs attain; the "
            f"band lies between a quarter and three quarters of them. Lines that coincide are drawn over one another. In grey "
            f"{against}. Runs without a legal path attain nothing; where there are some, titles count the others."
        )
        n_obj = len(results.plan.problems[problems[0]].spec["objectives"])
        random = any(results.finished(k, problems[:1]) for k in results.random)
        nobody = "no run has a legal path" if random else "only exact fronts have finished runs"
        why = nobody if n_obj == 2 else f"they are drawn for two objectives, and it has {n_obj}"
        draw = partial(plot_attainment, results, problems[0], self.styles)
        yield Drawing(f"attainment-{name}", caption, draw, f"No attainment surfaces on {first}: {why}.")
        caption = (
            f"Merged fronts of all runs of each algorithm on {first}. In grey {against}; titles say how many of its points are "
            "among those found."
        )
        if n_obj > 2:
            caption += f" Of {n_obj} objectives the first two are shown."
        why = nobody if n_obj > 1 else "it has one objective"
        draw = partial(plot_fronts, results, problems[0], self.styles)
        yield Drawing(f"fronts-{name}", caption, draw, f"No merged fronts on {first}: {why}.")
        if self.rows is not None:
            yield linked_pages(results, problems[0], name, slugs(results.algorithms), self.rows)

    def _tests(self, level: str, scope: str, name: str, place: str, problems: Sequence[int]) -> tuple[Comparison, list[Block]]:
        """Return the comparison of hypervolume ratios on some problems, and the tests of all measures; keep them."""
        comparisons, parts = [], []
        for measure in TESTED:
            comparison = compare(self.results, problems, measure)
            self.families.append(Family(level, [(scope, comparison)]))
            comparisons.append(comparison)
            parts.append(list(self._tests_of(comparison, name, place)))
            if level == "group" and len(problems) > 1:
                parts[-1] += self._each(problems, measure, name, place)
        main, *others = parts
        cautions = comparisons[0].warnings
        if cautions:
            main.insert(0, Caution(tuple(f"Tests {place}: {caution}" for caution in cautions)))
        for measure, other in zip(list(TESTED)[1:], others, strict=True):
            if other:
                main.append(Fold(f"The same tests of the {TESTED[measure][0]} {place}", tuple(other)))
        return comparisons[0], [Heading(f"Tests {place}", 3), *main] if main else []

    def _tests_of(self, comparison: Comparison, name: str, place: str) -> Iterator[Block]:
        if comparison.friedman is not None:
            yield summary.ranks_table(self.results, comparison, name, place)
            if comparison.measure == "ratio":
                yield self._ranks_drawing(comparison, name, place)
        if comparison.pairs:
            yield summary.pairs_table(self.results, comparison, name, place)

    def _ranks_drawing(self, comparison: Comparison, name: str, place: str) -> Drawing:
        assert comparison.friedman is not None
        labels = [self.results.algorithms[k] for k in comparison.algorithms]
        caption = (
            f"Average ranks {place} by the median hypervolume ratio of each of {comparison.n_blocks} problems, 1 the best. "
            "A bar joins algorithms whose ranks do not differ significantly. " + summary.friedman_sentence(comparison)
        )
        return Drawing(f"ranks-{name}", caption, partial(plot_ranks, comparison.friedman, labels), "")

    def _each(self, problems: Sequence[int], measure: str, name: str, place: str) -> list[Block]:
        """Return the tests of single problems, if any could tell algorithms apart; keep them."""
        each = compare_each(self.results, problems, measure)
        labels = [self.results.plan.problems[k].label for k in problems]
        self.families.append(Family("problem", list(zip(labels, each, strict=True))))
        if could_tell(each):
            return [summary.each_table(self.results, each, name, place)]
        count = sum(len(comparison.pairs) for comparison in each)
        if measure != "ratio" or not count:
            return []
        words = f"with so few seeds, none of {count} tests could be significant after Holm's correction"
        return [Caution((f"Tests of single problems {place}: {words}.",))]


def slugs(names: Sequence[str] | dict) -> dict[str, str]:
    """Return for each name one that serves in file names and LaTeX labels, all different whatever the case of letters."""
    return dict(zip(names, unique_slugs(names), strict=True))


def unique_slugs(names: Iterable[str]) -> list[str]:
    """Return what `slugs` does in the order of the names, which may be equal."""
    found: list[str] = []
    taken: set[str] = set()
    for name in names:
        base = re.sub(r"[^A-Za-z0-9.-]+", "-", name).strip("-.")[:60] or "group"
        slug, number = base, 1
        while slug.lower() in taken:
            number += 1
            slug = f"{base}-{number}"
        taken.add(slug.lower())
        found.append(slug)
    return found
