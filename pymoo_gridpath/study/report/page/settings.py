"""What a study was asked for: its problems, algorithms, seeds and budget, in words."""

from __future__ import annotations

import inspect
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from pymoo_gridpath.errors import counted
from pymoo_gridpath.neighbourhood import neighbourhood_of, steps_in_words
from pymoo_gridpath.study.planning.canonical import resolve, steps_of
from pymoo_gridpath.study.planning.plan import PlannedAlgorithm, PlannedProblem
from pymoo_gridpath.study.report.page.blocks import Block, Fold, Heading, Listing, Text
from pymoo_gridpath.study.report.references import kind_of
from pymoo_gridpath.study.report.results import Results
from pymoo_gridpath.study.report.statistics.summaries import quartiles
from pymoo_gridpath.study.report.tables.moving import moving_problems
from pymoo_gridpath.study.report.tables.summary import reference_phrase
from pymoo_gridpath.study.report.tables.table import NOTHING, Table, count, significant, spread
from pymoo_gridpath.study.specification import own
from pymoo_gridpath.study.specification.kinds import is_of_paper, operators_of_package
from pymoo_gridpath.study.specification.moving import n_epochs

# Rows of the list of single problems.
_MOST_ROWS = 40

# What the names of sets of operators stand for, and what to add unless they begin otherwise.
_OPERATORS = {
    "paper": ("as in Ahmed and Deb (2013)", ""),
    "scalarized": ("path-aware", ", from scalarized paths"),
    "random": ("path-aware", ", from random paths"),
}


def settings_blocks(results: Results, times: bool) -> Iterator[Block]:
    """Yield what the runs have in common, the tables of problems and algorithms, and the study file if there is one."""
    plan = results.plan
    seeds = sorted({run.seed for run in results.runs if not results.is_deterministic(run.algorithm)})
    yield Heading("Settings")
    words = "".join(f"Budget of each run: {amount} {kind}. " for kind, amount in plan.budget.items())
    if moving_problems(results, range(len(plan.problems))):
        words += "Where obstacles move, runs end after the last epoch. "
    words += f"Seeds: {_ranges(seeds)}. Target: hypervolume ratio {results.target:g}."
    if plan.reference is not None:
        words += f" Search for each exact front: {_other(plan.reference)}."
    yield Text(words)
    yield _groups_table(results)
    if len(plan.problems) > len(results.groups):
        yield Fold("Each problem", (_problems_table(results),))
    yield _references_table(results, times)
    yield _algorithms_table(results)
    if results.study_file is not None:
        yield Fold("The study file", (Listing(results.study_file),))


def _groups_table(results: Results) -> Table:
    header = ["problems", "number", "grid", "query", "objectives", "representation", "obstacles"]
    rows = []
    for group, problems in results.groups.items():
        specs = [results.plan.problems[k].spec for k in problems]
        queries = {_query(spec) for spec in specs}
        query = queries.pop() if len(queries) == 1 else f"{len(queries)} different"
        row = [group, str(len(problems)), _grids([results.plan.problems[k] for k in problems]), query]
        rows.append([*row, ", ".join(map(own.shown, specs[0]["objectives"])), _representation(specs[0]), _obstacles(specs[0])])
    notes = ["A query goes from cell x,y to another, counted from 0,0 at the bottom left."]
    if any("digest" in problem.spec["grid"] for problem in results.plan.problems):
        notes.append(
            "The digest of a map, of which the first digits stand here, is the SHA-256 of its size and cells, with its "
            "obstacles grown by the robot's radius if there is one."
        )
    return Table("problems", "Problems.", header, rows, left=7, notes=notes, for_papers=False)


def _references_table(results: Results, times: bool) -> Table:
    header = ["problems", "measured against", "points of it", *["seconds of the exact search"] * times]
    rows = []
    for group, problems in results.groups.items():
        sizes = np.array([len(results.references[k].front) for k in problems])
        row = [group, reference_phrase(results, problems), spread(quartiles(sizes), count)]
        if times:
            seconds = np.array([results.references[k].seconds for k in problems])
            row.append(spread(quartiles(seconds[~np.isnan(seconds)]), significant))
        rows.append(row)
    what = "Fronts that runs are measured against; of several problems, median [quartiles]."
    if moving_problems(results, range(len(results.plan.problems))):
        what += " Where obstacles move, the points are those of the last epoch, and the seconds those of all."
    return Table("references", what, header, rows, left=2, for_papers=False)


def _problems_table(results: Results) -> Table:
    rows = []
    for problem, reference in zip(results.plan.problems[:_MOST_ROWS], results.references, strict=False):
        spec, front = problem.spec, reference.front
        rows.append([problem.label, _one_grid(problem), _query(spec), kind_of(front), str(len(front))])
    header = ["problem", "grid", "query", "front", "front points"]
    left = len(results.plan.problems) - len(rows)
    notes = [f"{left} more stand in problems.csv."] if left else []
    return Table("each-problem", "Each problem.", header, rows, left=4, notes=notes, for_papers=False)


def _algorithms_table(results: Results) -> Table:
    header = ["#", "algorithm", "method", "population", "operators", "ties by turn", "other settings", "changes in problems"]
    rows = []
    firsts = [results.plan.problems[problems[0]].spec for problems in results.groups.values()]
    for k, algorithm in enumerate(results.plan.algorithms):
        spec = algorithm.spec
        in_groups = zip(*(_in_problem(problem, algorithm) for problem in firsts), strict=True)
        operators, ties, changes = (_by_group(list(results.groups), texts) for texts in in_groups)
        method = own.shown(spec["algorithm"]) if "algorithm" in spec else f"{spec['preset']} (preset)"
        rows.append([str(k + 1), algorithm.label, method, _population(results, k), operators, ties, _other(spec), changes])
    notes = [
        "Ties by turn: whether paths that are otherwise equal are told apart by their total turn. Parameters that are not "
        "named, also those of operators, have their defaults."
    ]
    return Table("algorithms", "Algorithms.", header, rows, left=8, notes=notes, for_papers=False)


def _population(results: Results, algorithm: int) -> str:
    """Return how many members a population has; some algorithms make it of another size than was given."""
    given = results.plan.algorithms[algorithm].spec.get("pop_size")
    if given is None:
        return NOTHING
    found = set(results.values("n_members", algorithm, range(len(results.plan.problems))).tolist())
    return str(given) if len(found) != 1 or given in found else f"{found.pop():.0f} (given: {given})"


def _in_problem(problem: dict[str, Any], algorithm: PlannedAlgorithm) -> tuple[str, str, str]:
    """Return the operators of an algorithm on a problem, whether it breaks ties by turn, and what it changes in it."""
    changed, settled = resolve(problem, algorithm.spec, algorithm.overrides)
    changes = _changes(problem, changed)
    if "preset" in settled:
        # As `ahmed_deb_2013` has it.
        return _OPERATORS["paper"][0], "yes" if len(problem["objectives"]) == 2 else "no", changes
    if "operators" not in settled:
        return NOTHING, NOTHING, changes
    base = algorithm.spec["operators"]["base"]
    _, plain = resolve(problem, {**algorithm.spec, "operators": {"base": base}}, algorithm.overrides)
    if base == "default":
        base = "paper" if is_of_paper(changed["representation"]) else "scalarized"
    words = _operators(base, plain["operators"], settled["operators"])
    return words, "yes" if settled.get("smoothness") else "no", changes


def _operators(base: str, plain: Mapping[str, Any], settled: Mapping[str, Any]) -> str:
    """Return a set of operators in words, and the single ones that differ from it."""
    own = {slot: single for slot, single in settled.items() if single != plain.get(slot)}
    words, beginning = _OPERATORS[base]
    if "sampling" not in own:
        words += beginning
    singles = [_operator(slot, single) for slot, single in own.items()]
    if "crossover" not in plain:
        # The algorithm makes its children itself, and takes these alone.
        kept = " and ".join(slot for slot in plain if slot not in own)
        return ", ".join([*[f"{kept} {words}"] * bool(kept), *singles])
    if not singles:
        return words
    return f"{words}, but with {', '.join(singles[:-1])}{' and ' * (len(singles) > 1)}{singles[-1]}"


def _operator(slot: str, single: Mapping[str, Any]) -> str:
    """Return a single operator with the arguments that are not its class's defaults."""
    kind = "duplicates" if slot == "eliminate_duplicates" else slot
    if own.is_path(single["class"]):
        return f"{kind} {own.shown(single)}"
    parameters = inspect.signature(operators_of_package()[single["class"]]).parameters
    arguments = {key: value for key, value in single.items() if key != "class" and value != parameters[key].default}
    return f"{kind} {single['class']}{f' ({_listed(arguments)})' if arguments else ''}"


def _changes(problem: Mapping[str, Any], changed: Mapping[str, Any]) -> str:
    """Return what an algorithm changes in a problem."""
    words = []
    if _representation(changed) != _representation(problem):
        words.append(f"representation {_representation(changed)}")
    obstacles = _obstacles(changed)
    if obstacles != _obstacles(problem):
        words.append(f"obstacles {obstacles}" if obstacles == "constraint" else obstacles)
    return ", ".join(words) or NOTHING


def _other(spec: Mapping[str, Any]) -> str:
    """Return the settings of an algorithm that have no column of their own."""
    limits = [(spec.get("max_seconds"), "seconds"), (spec.get("max_labels"), "labels")]
    words = [f"at most {most:g} {unit}" for most, unit in limits if most is not None]
    return "; ".join([*words, *filter(None, [_listed(spec.get("parameters", {}))])]) or NOTHING


def _by_group(groups: Sequence[str], texts: Sequence[str]) -> str:
    """Return a text that may differ between groups, after the groups' names where it does."""
    found: dict[str, list[str]] = {}
    for group, text in zip(groups, texts, strict=True):
        found.setdefault(text, []).append(group)
    if len(found) == 1:
        return texts[0]
    return "; ".join(f"on {', '.join(names)}: {'nothing' if text == NOTHING else text}" for text, names in found.items())


def _grids(problems: Sequence[PlannedProblem]) -> str:
    """Return what the grids of a group are; they are of one random family, or one map."""
    first = problems[0]
    if "random" not in first.spec["grid"]:
        return _one_grid(first)
    seeds = _ranges(sorted(problem.spec["grid"]["random"]["seed"] for problem in problems))
    return f"{_one_grid(first).rsplit(', seed', 1)[0]}, seed{'s' * (len(problems) > 1)} {seeds}"


def _one_grid(problem: PlannedProblem) -> str:
    grid = problem.spec["grid"]
    steps = steps_of(grid)
    rule = "" if not neighbourhood_of(**steps).restricts else f", {steps_in_words(**steps)}"
    if "random" in grid:
        family = grid["random"]
        size, p0 = family["size"], family["p0"]
        return f"random, {size} x {size} cells, p0 = {p0:g}{rule}, seed {family['seed']}"
    return f"{problem.source or 'map'}, {grid['width']} x {grid['height']} cells{rule}, digest {grid['digest'][:8]}"


def _representation(spec: Mapping[str, Any]) -> str:
    name = own.shown(spec["representation"])
    return name if spec["axis"] == "auto" else f"{name} along {spec['axis']}"


def _obstacles(spec: Mapping[str, Any]) -> str:
    """Return how obstacles are treated, with the numbers that belong to it."""
    if spec["obstacles"] == "constraint":
        return "constraint"
    penalty = f"penalty of {spec['penalty']:g} a cell"
    if "moving" in spec:
        moving = spec["moving"]
        n_movers, every = len(moving["movers"]), moving["every"]
        movers, generations = counted(n_movers, "mover"), "generation" if every == 1 else f"{every} generations"
        penalty += f"; {movers}, a move every {generations}, {counted(n_epochs(moving), 'epoch')}"
    return penalty if spec["obstacles"] == "penalty" else f"vulnerability at most {spec['potential_limit']:g}, {penalty}"


def _query(spec: Mapping[str, Any]) -> str:
    (x, y), (u, v) = spec["start"], spec["goal"]
    return f"{x},{y} to {u},{v}"


def _ranges(numbers: Sequence[int]) -> str:
    """Return ascending whole numbers as ranges, ``1 to 11, 15``."""
    parts: list[list[int]] = []
    for number in numbers:
        if parts and number == parts[-1][-1] + 1:
            parts[-1].append(number)
        else:
            parts.append([number])
    return ", ".join(str(part[0]) if len(part) == 1 else f"{part[0]} to {part[-1]}" for part in parts) or "none"


def _listed(settings: Mapping[str, Any]) -> str:
    """Return settings in one line, ``rate 0.5, n_neighbors 7``."""
    parts = []
    for key, value in settings.items():
        shown = f"{value:g}" if isinstance(value, float) else "none" if value is None else str(value)
        parts.append(f"{key} {shown}")
    return ", ".join(parts)
