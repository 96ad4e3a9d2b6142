"""What a study was asked for, what is missing of it, and where it ran: the parts of a report around its results."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from pymoo_gridpath.study.plan import PlannedAlgorithm
from pymoo_gridpath.study.report.blocks import Block, Heading, Text
from pymoo_gridpath.study.report.measures import SAME, quartiles
from pymoo_gridpath.study.report.results import Results, gist
from pymoo_gridpath.study.report.summary import reference_phrase
from pymoo_gridpath.study.report.tables import Table, count, significant, spread
from pymoo_gridpath.study.specification.canonical import resolve

# Rows of lists of single runs or problems.
_MOST_ROWS = 40


def state_sentence(results: Results) -> str:
    """Return how many of the planned runs are finished, and what became of the others."""
    states = Counter(run.status for run in results.runs)
    parts = [f"{states['finished']} of {len(results.runs)} planned runs are finished"]
    parts += [f"{states[state]} {state}" for state in ("failed", "missing", "damaged") if states[state]]
    return ", ".join(parts) + "."


def general_cautions(results: Results) -> list[str]:
    """Return sentences on what a reader of any number in the report should know."""
    cautions = []
    everything = range(len(results.references))
    lost = [run for run in results.runs if not run.finished]
    if lost:
        cautions.append(f"{state_sentence(results)} Every number is over the finished runs; the others are listed below.")
    merged = [k for k in everything if not results.references[k].front.exact]
    if merged:
        cautions.append(
            f"No exact front is at hand for {len(merged)} of {len(everything)} problems. There the merged non-dominated "
            "front of all runs takes its place: ratios, IGD+ and shares found are then relative to the best that these runs "
            "found together, which may be short of the optimum, and they change when runs are added."
        )
    exceeded = sum(reference.exceeded for reference in results.references)
    if exceeded:
        cautions.append(
            f"On {exceeded} of {len(everything)} problems runs found points beyond the exact front, which is that of the "
            "problem without what algorithms override of it (such as the representation); ratios above 1 come from this."
        )
    none = [k for k in everything if not len(results.references[k].front)]
    if none:
        cautions.append(f"On {len(none)} of {len(everything)} problems no legal path is known; all ratios are 0 there.")
    if len(results.versions) > 1:
        cautions.append("The runs were made with different versions of packages, see below.")
    return cautions


def settings_blocks(results: Results, times: bool) -> list[Block]:
    """Return the tables of problems and algorithms."""
    plan = results.plan
    (kind, amount), *_ = plan.budget.items()
    seeds = sorted({run.seed for run in results.runs if not results.is_exact(run.algorithm)})
    words = f"Budget of each run: {amount} {kind}. Seeds: {_seeds(seeds)}. Target: hypervolume ratio {results.target:g}."
    rows = []
    for group, problems in results.groups.items():
        spec = plan.problems[problems[0]].spec
        row = [group, _grid(spec["grid"]), ", ".join(spec["objectives"]), _rules(spec), reference_phrase(results, problems)]
        sizes = np.array([len(results.references[k].front) for k in problems])
        row += [str(len(problems)), spread(quartiles(sizes), count)]
        if times:
            seconds = np.array([results.references[k].seconds for k in problems])
            row.append(spread(quartiles(seconds[~np.isnan(seconds)]), significant))
        rows.append(row)
    header = ["group", "grid", "objectives", "representation and obstacles", "measured against", "problems", "front points"]
    header += ["seconds of the exact search"] if times else []
    problems_table = Table("problems", "Problems; medians [quartiles].", header, rows, left=5, for_papers=False)
    rows = [
        [str(k + 1), algorithm.label, _described(algorithm.spec), _changes(results, algorithm)]
        for k, algorithm in enumerate(plan.algorithms)
    ]
    header = ["#", "algorithm", "what it is", "what it changes in problems"]
    algorithms_table = Table("algorithms", "Algorithms.", header, rows, left=4, for_papers=False)
    return [Heading("Settings"), Text(words), problems_table, algorithms_table]


def unfinished_blocks(results: Results) -> list[Block]:
    """Return lists of the runs that are not finished and of the problems without an exact front."""
    blocks: list[Block] = []
    lost = [run for run in results.runs if not run.finished]
    if lost:
        # Failed runs first, of which there is something to say.
        lost.sort(key=lambda run: run.status != "failed")
        rows = []
        for run in lost[:_MOST_ROWS]:
            names = [results.plan.problems[run.problem].label, results.algorithms[run.algorithm]]
            rows.append([*names, str(run.seed), run.status, _cut(gist(run.message))])
        header = ["problem", "algorithm", "seed", "state", "message"]
        notes = [f"{len(lost) - len(rows)} more stand in runs.csv."] if len(lost) > len(rows) else []
        caption = "Runs that are not finished."
        blocks += [Heading("Unfinished runs"), Text(state_sentence(results))]
        blocks.append(Table("unfinished", caption, header, rows, left=5, notes=notes, for_papers=False))
    merged = [k for k, reference in enumerate(results.references) if not reference.front.exact]
    if merged:
        rows = [[results.plan.problems[k].label, _cut(results.references[k].reason)] for k in merged[:_MOST_ROWS]]
        notes = [f"{len(merged) - len(rows)} more stand in problems.csv."] if len(merged) > len(rows) else []
        caption = "Problems whose runs are measured against the merged front of all runs."
        blocks.append(Heading("Problems without an exact front"))
        blocks.append(Table("merged", caption, ["problem", "why"], rows, left=2, notes=notes, for_papers=False))
    return blocks


def definition_blocks(results: Results, times: bool) -> list[Block]:
    """Return how each measure and test is defined."""
    sentences = [
        "Hypervolume ratio: the hypervolume of a run's legal non-dominated points over that of the front it is measured "
        "against. Objectives are normalised by that front's range; the reference point lies a tenth of the range beyond its "
        "nadir. An objective in which the front has no range counts in its own unit. Where the front is a single point, a "
        "run that reaches it has 1 and any other 0. Without a legal path the ratio is 0.",
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
        "matched-pairs rank-biserial correlation (Kerby, 2014). Both are two-sided and exact for the ties at hand, but for "
        "large samples, where the normal approximation serves. p values are corrected by Holm's method (1979) for all pairs "
        "of a table. Values are rounded to nine decimals. The level is 0.05.",
        "Average ranks, of three algorithms or more on several problems: Friedman's test over the problems' medians, and "
        "Nemenyi's critical difference at 0.05 (Demsar, 2006). The p value of Friedman's test is the chi-square "
        "approximation, which is rough for few problems.",
        "The exact front draws no random number, has one run a problem, and is not part of the tests.",
    ]
    if times:
        sentences.append("Seconds are wall time of single runs, and depend on the machine and on what else it did.")
    return [Heading("Definitions"), *(Text(sentence) for sentence in sentences)]


def origin_blocks(results: Results) -> list[Block]:
    """Return the machines and versions that the runs were made with."""
    blocks: list[Block] = [Heading("Machines and versions")]
    for name, origins in (("machine", results.machines), ("versions", results.versions)):
        rows = [[_described(json.loads(text)), str(number)] for text, number in sorted(origins.items())]
        caption = f"{'Machines' if name == 'machine' else 'Versions'}, and how many runs were made with each."
        blocks.append(Table(name, caption, [name, "runs"], rows, for_papers=False))
    return blocks


def _seeds(seeds: Sequence[int]) -> str:
    """Return whole numbers as ranges, ``1 to 11, 15``."""
    parts: list[list[int]] = []
    for seed in seeds:
        if parts and seed == parts[-1][-1] + 1:
            parts[-1].append(seed)
        else:
            parts.append([seed])
    return ", ".join(str(part[0]) if len(part) == 1 else f"{part[0]} to {part[-1]}" for part in parts) or "none"


def _grid(spec: dict[str, Any]) -> str:
    if "random" in spec:
        grid = spec["random"]
        cutting = grid["corner_cutting"]
        text = f"random, {grid['size']} x {grid['size']} cells, {grid['p0']:g} occupied"
    else:
        cutting = spec["corner_cutting"]
        text = f"map, {spec['width']} x {spec['height']} cells"
    return text if cutting else f"{text}, no corner cutting"


def _rules(spec: dict[str, Any]) -> str:
    text = f"{spec['representation']}, {spec['obstacles']}"
    if spec["obstacles"] == "penalty" and spec.get("penalty") is not None:
        text += f" {spec['penalty']:g}"
    if spec["obstacles"] == "limit" and spec.get("potential_limit") is not None:
        text += f" {spec['potential_limit']:g}"
    return text


def _changes(results: Results, algorithm: PlannedAlgorithm) -> str:
    """Return what an algorithm changes in the problems that it solves, and in which groups if not in all."""
    found: dict[str, list[str]] = {}
    for group, problems in results.groups.items():
        spec = results.plan.problems[problems[0]].spec
        changed, _ = resolve(spec, algorithm.spec, algorithm.overrides)
        text = _described({key: value for key, value in changed.items() if value != spec.get(key)}) or "nothing"
        found.setdefault(text, []).append(group)
    if len(found) == 1:
        return next(iter(found))
    return "; ".join(f"{text} on {', '.join(groups)}" for text, groups in found.items())


def _described(spec: dict[str, Any]) -> str:
    """Return settings in one line, ``algorithm NSGA2; pop_size 200``."""
    parts = []
    for key, value in spec.items():
        if value is None or value == {}:
            continue
        parts.append(f"{key} {value if isinstance(value, str) else json.dumps(value, sort_keys=True)}")
    return "; ".join(parts)


def _cut(text: str, most: int = 200) -> str:
    return text if len(text) <= most else f"{text[: most - 1]}…"
