"""How each measure and test of a report is defined, and with what its runs were made."""

from __future__ import annotations

import json

from pymoo_gridpath.quality import SAME
from pymoo_gridpath.study.report.figures.stretched_axis import SCALE_DEFINITION
from pymoo_gridpath.study.report.page.blocks import Block, Heading, Text
from pymoo_gridpath.study.report.results import Results
from pymoo_gridpath.study.report.tables.moving import moving_problems
from pymoo_gridpath.study.report.tables.table import Table

_MOVING = (
    "Obstacles that move: every so many generations, an epoch, each mover takes its next cell, and paths are rated on the map "
    "as it is then. Hypervolume ratio, IGD+ and front found are means over the epochs, of the legal non-dominated paths in the "
    "population at the end of each, as they are on the map of that epoch, against its exact front. A run is feasible if it has "
    "a legal path at the end of each epoch. It reaches the target if its mean ratio does, and counts with all that it had "
    "spent. Mean turn and all fronts that are drawn are of the end of the last epoch. Planners plan anew on each map.",
)


def definition_blocks(results: Results, times: bool) -> list[Block]:
    """Return how each measure and test is defined."""
    sentences = [
        "Hypervolume ratio: the hypervolume of a run's legal non-dominated points over that of the front it is measured "
        "against. Objectives are normalised by that front's range; the reference point lies a tenth of the range beyond its "
        "nadir. An objective in which the front has no range counts in its own unit. Where the front is a single point, a "
        "run that reaches it has 1 and any other 0. Points beyond the reference point add nothing, so that a run with legal "
        "paths may have 0, as a run without any has.",
        SCALE_DEFINITION,
        "IGD+: the mean distance, in the same normalised objectives, by which points of the front are missed (Ishibuchi and "
        "others, 2015); 0 is best, infinite without a legal path.",
        f"Front found: the share of the front's points that are among the run's, equal within {SAME:g} of the objective's "
        "largest size.",
        "Mean turn: the mean total turn, in degrees, of the paths of the final front, the one that turns least for each of its "
        "points; infinite without a legal path. It tells how smooth paths are where turn is no objective.",
        "Feasible: the share of finished runs that end with a legal path.",
        "Budget: runs end with the generation in which the budget is reached, so that evaluations may exceed it by up to one "
        "generation.",
        "To target: what a run had spent at the first stored record of its history whose ratio is at least "
        f"{results.target:g}. Histories keep up to about a hundred records a run, so that this is late by at most the step "
        "between two. A run that did not reach it counts as infinite in medians and quartiles.",
        "Quartiles are interpolated linearly between the ordered values. Those of a group are over all its finished runs.",
        "One problem: Mann-Whitney U tests over the runs of two algorithms, with the effect size A12 of Vargha and Delaney "
        "(2000). Several problems: Wilcoxon signed-rank tests over the problems' medians, zeros left out, with the "
        "matched-pairs rank-biserial correlation (Kerby, 2014). U counts the pairs of runs of which the first algorithm's is "
        "better, equal ones half; W is the sum of the ranks of the problems on which the first is better. Both are two-sided "
        "and exact for the ties at hand, but for large samples, where the normal approximation serves. p values are corrected "
        "by Holm's method (1979) for all pairs of a table. Values are rounded to nine decimals. The level is 0.05.",
        "Average ranks, of three algorithms or more on several problems: Friedman's test over the problems' medians, and "
        "Nemenyi's critical difference at 0.05 (Demsar, 2006). The p value of Friedman's test is the chi-square "
        "approximation, which is rough for few problems.",
        *_MOVING * bool(moving_problems(results, range(len(results.plan.problems)))),
        "The exact front draws no random number, has one run a problem, and is not part of the tests.",
    ]
    if times:
        sentences.append("Seconds are wall time of single runs, and depend on the machine and on what else it did.")
    return [Heading("Definitions"), *(Text(sentence) for sentence in sentences)]


def origin_blocks(results: Results) -> list[Block]:
    """Return the machines and versions that the runs were made with."""
    blocks: list[Block] = [Heading("Machines and versions")]
    for name, origins in (("machine", results.machines), ("versions", results.versions)):
        rows = [[_listed(json.loads(text)), str(number)] for text, number in sorted(origins.items())]
        caption = f"{'Machines' if name == 'machine' else 'Versions'}, and how many runs were made with each, "
        caption += "those of exact fronts included."
        blocks.append(Table(name, caption, [name, "runs"], rows, for_papers=False))
    return blocks


def _listed(values: dict) -> str:
    """Return values in one line, ``cores 2; system Linux``."""
    return "; ".join(f"{key} {value}" for key, value in values.items())
