"""What is missing of a study, and what a reader of any of its numbers should know."""

from __future__ import annotations

from collections import Counter

from pymoo_gridpath.study.report.page.blocks import Block, Heading, Text
from pymoo_gridpath.study.report.references import gist
from pymoo_gridpath.study.report.results import Results
from pymoo_gridpath.study.report.tables.table import Table

# Rows of lists of single runs or problems.
_MOST_ROWS = 40


def state_sentence(results: Results) -> str:
    """Return how many of the planned runs are finished, and what became of the others."""
    sentence = _counted(Counter(run.status for run in results.runs), "planned runs of algorithms")
    if results.reference_states:
        sentence += " " + _counted(results.reference_states, "reference runs (exact fronts)")
    return sentence


def _counted(states: Counter, what: str) -> str:
    parts = [f"{states['finished']} of {states.total()} {what} are finished"]
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


def _cut(text: str, most: int = 200) -> str:
    return text if len(text) <= most else f"{text[: most - 1]}…"
