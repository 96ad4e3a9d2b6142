"""How long a study will take, from the first generations of some of its runs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from pymoo.core.callback import Callback

from pymoo_gridpath.compiled import working_seconds
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.memory import is_want_of_memory, want_of_memory
from pymoo_gridpath.study.planning.build import build_algorithm, build_planner, build_problem, build_termination
from pymoo_gridpath.study.planning.moving import clock_of, quietly
from pymoo_gridpath.study.planning.plan import Plan, PlannedRun, Task, has_own_budget, needed_for

# Share of the time of a measurement that getting ready for it may take: compiled functions are loaded in the first one.
_LEAST_SLICE = 0.2


@dataclass(frozen=True)
class Estimate:
    """The time that some runs of a plan will take.

    Attributes
    ----------
    seconds : float
        Of all of them, one after the other.
    n_measured, n_kinds : int
        How many kinds of runs there are (pairs of a group of problems and an algorithm), and how many of them were tried; the
        others count as the mean of those.
    open_ended : bool
        Whether there are searches for an exact front that were not complete in the time they were given here: they count as all
        of their time budget, or as what they were given if they have none.
    """

    seconds: float
    n_measured: int
    n_kinds: int
    open_ended: bool = False


def estimate(plan: Plan, runs: Iterable[PlannedRun] | None = None, max_seconds: float = 20.0) -> Estimate:
    """Return the time that runs will take, extrapolated from a few generations of one run of each kind.

    Compiling does not count, neither here nor in what is returned: it is done once in a process, and some algorithms, such as
    AGE-MOEA, compile functions as late as in their second generation.

    Parameters
    ----------
    plan : Plan
    runs : iterable of PlannedRun, optional
        All of the plan by default.
    max_seconds : float, default 20
        About how long measuring may take, without compiling; a generation that has begun is ended.

    Raises
    ------
    GridPathError
        If a run that is measured ends with an error.
    """
    kinds: dict[tuple[str, int | None], list[PlannedRun]] = {}
    for run in plan.runs if runs is None else runs:
        kinds.setdefault((plan.problems[run.problem].group, run.algorithm), []).append(run)
    seconds: list[float] = []
    counts: list[int] = []
    open_ended = False
    warm: set[int | None] = set()
    end = working_seconds() + max_seconds
    for k, ((_, algorithm), members) in enumerate(kinds.items()):
        left = end - working_seconds()
        if left <= 0 and seconds:
            break
        task = plan.task(members[0])
        share = max(left / (len(kinds) - k), _LEAST_SLICE)
        try:
            if algorithm not in warm:
                # Compiled functions are loaded and memories filled once in a process, not once a run.
                _measure(task, 0.0)
                warm.add(algorithm)
            found, is_open = _measure(task, share)
        except Exception as error:
            label = "the exact front" if algorithm is None else repr(plan.algorithms[algorithm].label)
            text = f"{type(error).__name__}: {' '.join(str(error).split())}"
            why = want_of_memory(needed_for(task)) if is_want_of_memory(error) else text
            raise GridPathError(f"{label} fails on the problem {plan.problems[members[0].problem].label!r}: {why}") from error
        seconds.append(found)
        counts.append(len(members))
        open_ended |= is_open
    if not seconds:
        return Estimate(0.0, 0, 0)
    mean = sum(s * n for s, n in zip(seconds, counts, strict=True)) / sum(counts)
    others = sum(len(members) for members in kinds.values()) - sum(counts)
    return Estimate(mean * (sum(counts) + others), len(seconds), len(kinds), open_ended)


def _measure(task: Task, max_seconds: float) -> tuple[float, bool]:
    """Return the seconds that a run will take, and whether that is but a bound for an exact front."""
    begin = working_seconds()
    problem = build_problem(task.problem, task.grid)
    if has_own_budget(task.algorithm):
        return _measure_planner(task.algorithm, problem, max_seconds)
    assert task.budget is not None
    algorithm: Any = build_algorithm(task.algorithm, problem)
    termination = build_termination(task.budget, algorithm)
    algorithm.setup(problem, termination=termination, seed=task.seed, callback=clock_of(problem, Callback()))
    wanted = next(iter(task.budget.values()))
    records: list[tuple[float, int]] = []
    while algorithm.has_next() and (not records or records[-1][0] < max_seconds):
        with quietly(problem):
            algorithm.next()
        done = algorithm.evaluator.n_eval if "evaluations" in task.budget else len(records) + 1
        records.append((working_seconds() - begin, done))
    (first, first_done), (last, last_done) = records[0], records[-1]
    if not algorithm.has_next():
        return last, False
    # The first generation is unlike the others.
    rate = (last - first) / (last_done - first_done) if last_done > first_done else last / max(last_done, 1)
    return last + rate * max(wanted - last_done, 0), False


def _measure_planner(algorithm: Mapping[str, Any], problem, max_seconds: float) -> tuple[float, bool]:
    begin = working_seconds()
    # Where obstacles move, it plans anew on each map.
    first, n_maps = problem.stills[0], len(problem.stills)
    search, bounded = build_planner(algorithm, first, max_seconds=max_seconds)
    search.setup(first, seed=1)
    while search.has_next():
        search.next()
    took = working_seconds() - begin
    given = {**algorithm, **algorithm.get("parameters", {})}
    if search.success or not bounded or given.get("max_labels") is not None:
        return n_maps * took, False
    return n_maps * max(took, given.get("max_seconds") or 0.0), True
