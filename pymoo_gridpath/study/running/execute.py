"""One run of a study, in whatever process."""

from __future__ import annotations

import json
import math
import os
import platform
import time
import traceback
from collections.abc import Sequence
from datetime import UTC, datetime
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from pymoo.core.callback import Callback

from pymoo_gridpath.compiled import COMPILED, is_ctrl_c
from pymoo_gridpath.memory import is_want_of_memory, want_of_memory
from pymoo_gridpath.problems import MovingObstaclesProblem, ObstacleClock
from pymoo_gridpath.problems.members import Members, Snapshot, snapshot
from pymoo_gridpath.study.planning.build import build_algorithm, build_planner, build_problem, build_termination
from pymoo_gridpath.study.planning.moving import clock_of, quietly
from pymoo_gridpath.study.planning.plan import Task, needed_for
from pymoo_gridpath.study.running.epochs import Epochs
from pymoo_gridpath.study.running.record import History, RunRecord, to_bytes
from pymoo_gridpath.study.specification.kinds import objective_name
from pymoo_gridpath.versions import versions

#: Most records of a history: beyond that, every second one is dropped, and from then on half as many are made.
MAX_RECORDS = 100
# Of a traceback; the end says what happened.
_MAX_MESSAGE = 20_000
# How many times as many generations as a budget of evaluations asks for, and how many more, end a run.
_LONGEST = 5, 20
# Kinds of runs that this process has warmed up for.
_warm: set[tuple] = set()


def execute(task: Task) -> bytes:
    """Carry out one run and return the bytes of its record, see `to_bytes`.

    X, F and the history but for its seconds depend on the task alone. A run that raises gives a record with status "failed" and
    the traceback, or with a sentence if memory ran out.
    """
    started, begin = _now(), time.perf_counter()
    try:
        return to_bytes(_run(task, started))
    except (Exception, SystemExit) as error:
        if is_ctrl_c(error):
            raise KeyboardInterrupt from error
        message = want_of_memory(needed_for(task)) if is_want_of_memory(error) else traceback.format_exc()
    return failed_run(task, message, started, time.perf_counter() - begin)


def failed_run(task: Task, message: str, started: str | None = None, seconds: float = 0.0) -> bytes:
    """Return the bytes of the record of a run that failed."""
    objectives = [objective_name(one) for one in task.problem.get("objectives", [])]
    return to_bytes(
        RunRecord(
            key=task.key,
            seed=task.seed,
            status="failed",
            message=message[-_MAX_MESSAGE:],
            complete=False,
            seconds=seconds,
            n_eval=0,
            n_gen=0,
            started=started or _now(),
            versions=versions(),
            machine=machine(),
            problem=task.problem,
            algorithm=task.algorithm,
            budget=task.budget,
            objectives=objectives,
            X=np.empty((0, 0)),
            F=np.empty((0, len(objectives))),
            turn=np.empty(0),
            n_legal=0,
            n_members=0,
            history=None,
        )
    )


class _Search(NamedTuple):
    """A search that has ended."""

    algorithm: Any
    result: Any
    recorder: Recorder
    clock: ObstacleClock | None


def _run(task: Task, started: str) -> RunRecord:
    problem = build_problem(task.problem, task.grid)
    if COMPILED:
        _warm_up(task, problem)
    moves = isinstance(problem, MovingObstaclesProblem)
    # A planner plans anew on each map.
    searches = [_searched(task, one) for one in (problem.stills if task.budget is None else [problem])]
    algorithm, _, recorder, clock = searches[-1]
    members = Members(algorithm)
    front = members.front()
    return RunRecord(
        key=task.key,
        seed=task.seed,
        status="finished",
        message=_message([search.result for search in searches], moves),
        complete=all(search.result.success is not False for search in searches),
        seconds=sum(search.recorder.seconds[-1] for search in searches),
        n_eval=sum(int(search.algorithm.evaluator.n_eval) for search in searches),
        n_gen=sum(search.algorithm.n_iter - 1 for search in searches),
        started=started,
        versions=versions(),
        machine=machine(),
        problem=task.problem,
        algorithm=task.algorithm,
        budget=task.budget,
        objectives=list(problem.objective_names),
        X=members.X(front, problem.n_var),
        F=members.F[front],
        turn=members.turn[front],
        n_legal=members.n_legal,
        n_members=members.n_members,
        history=recorder.history(),
        epochs=_epochs(searches, clock) if moves else None,
        # Of several maps the front of one alone is the run's.
        certified=getattr(searches[-1].result, "certified", None) if len(searches) == 1 else None,
    )


def _searched(task: Task, problem) -> _Search:
    """Return a search on a problem once it has ended."""
    algorithm: Any = build_algorithm(task.algorithm, problem)
    recorder = Recorder(problem.objective_names)
    termination = None if task.budget is None else build_termination(task.budget, algorithm)
    clock: Any = clock_of(problem, recorder)
    with quietly(problem):
        result = _search(problem, algorithm, task.seed, termination, recorder, clock)
    return _Search(algorithm, result, recorder, None if clock is recorder else clock)


def _epochs(searches: list[_Search], clock: ObstacleClock | None) -> Epochs:
    """Return what was found in each epoch, by a search with a clock or by one on each map."""
    if clock is not None:
        return Epochs.of(clock.F, clock.evaluations, clock.missed, clock.faults, searches[-1].recorder.epochs)
    members = [Members(search.algorithm) for search in searches]
    evaluations = np.cumsum([search.algorithm.evaluator.n_eval for search in searches]).tolist()
    last = [len(searches) - 1] * len(searches[-1].recorder.epochs)
    return Epochs.of([each.F[each.front()] for each in members], evaluations, of_records=last)


def _message(results: list[Any], moves: bool) -> str:
    """Return what searches say of themselves; with the epoch where there is one on each map, and of those that fell short."""
    if not moves or len(results) == 1:
        return results[0].message or ""
    short = [(epoch, result) for epoch, result in enumerate(results) if result.success is False]
    return "\n".join(f"epoch {epoch}: {result.message}" for epoch, result in short or enumerate(results) if result.message)


def _warm_up(task: Task, problem) -> None:
    """Have this process load or compile what runs of this kind need, so that the first takes no longer than the others."""
    kind = (problem.representation.name, problem.obstacles, *problem.objective_names, json.dumps(task.algorithm))
    if kind in _warm:
        return
    _warm.add(kind)
    try:
        if task.budget is not None:
            termination, algorithm = build_termination({"generations": 2}), build_algorithm(task.algorithm, problem)
        else:
            problem = problem.stills[0]
            termination, (algorithm, short) = None, build_planner(task.algorithm, problem, max_labels=100)
            if not short:
                return
        recorder = Recorder(problem.objective_names)
        # Without its clock, so that no time passes for the run itself.
        _search(problem, algorithm, task.seed, termination, recorder, recorder)
    except Exception as error:  # the run itself will say so
        if is_ctrl_c(error):
            raise KeyboardInterrupt from error


def _search(problem, algorithm, seed: int, termination, recorder: Recorder, callback: Callback):
    options = {} if termination is None else {"termination": termination}
    algorithm.setup(problem, seed=seed, callback=callback, **options)
    most = _most_generations(algorithm)
    while algorithm.has_next() and recorder.generation < most:
        algorithm.next()
    recorder.finish(algorithm)
    result = algorithm.result()
    if algorithm.has_next():
        result.message = f"ended after {most} generations, in which it made but {algorithm.evaluator.n_eval} evaluations"
    return result


def _most_generations(algorithm: Any) -> float:
    """Return after how many generations to end a run whose budget is one of evaluations.

    Where there are but few paths, some algorithms find next to no new one in a generation and would go on for hours, or for
    ever.
    """
    most = getattr(algorithm.termination, "n_max_evals", None)
    if most is None:
        return math.inf
    a_generation = getattr(algorithm, "n_offsprings", None) or getattr(algorithm, "pop_size", None) or 1
    return _LONGEST[0] * math.ceil(most / a_generation) + _LONGEST[1]


class Recorder(Callback):
    """A pymoo callback that makes the `History` of a run.

    Parameters
    ----------
    objectives : sequence of str
        Names of the columns of F.

    Attributes
    ----------
    seconds : list of float
        Of each record, since the recorder was made.
    epochs : list of int
        Of each record, the epoch where obstacles move, or 0.
    generation : int
        Of the last one, from 1 on.
    """

    def __init__(self, objectives):
        super().__init__()
        self.seconds: list[float] = []
        self.epochs: list[int] = []
        self._snapshots: list[Snapshot] = []
        self._n_obj = len(objectives)
        self.generation = 0
        self._recorded = 0
        self._step = 1
        self._begin = time.perf_counter()

    # pymoo's CallbackCollection calls update() only, so this is the hook that works everywhere.
    def _update(self, algorithm: Any) -> None:
        self.generation += 1
        if (self.generation - 1) % self._step:
            return
        if len(self.seconds) == MAX_RECORDS:
            for records in self._lists:
                del records[1::2]
            self._step *= 2
            if (self.generation - 1) % self._step:
                return
        self._record(algorithm)

    @property
    def _lists(self) -> tuple[list, ...]:
        """All lists of one entry a record."""
        return self.seconds, self.epochs, self._snapshots

    def finish(self, algorithm: Any) -> None:
        """Make sure that the last generation is on record."""
        if self._recorded == self.generation:
            return
        if len(self.seconds) == MAX_RECORDS:
            for records in self._lists:
                records.pop()
        self._record(algorithm)

    def _record(self, algorithm: Any) -> None:
        self.seconds.append(time.perf_counter() - self._begin)
        self.epochs.append(getattr(algorithm.problem, "epoch", 0))
        self._snapshots.append(snapshot(algorithm, Members(algorithm)))
        self._recorded = self.generation

    def history(self) -> History:
        """Return the records."""
        evaluations, n_legal, n_members, best, fronts = zip(*self._snapshots, strict=True)
        points, first, last = _spans(fronts)
        return History(
            evaluations=np.array(evaluations, dtype=np.int64),
            seconds=np.array(self.seconds),
            n_legal=np.array(n_legal, dtype=np.int64),
            n_members=np.array(n_members, dtype=np.int64),
            best_length=np.array(best, dtype=float),
            points=np.array(points, dtype=float).reshape(-1, self._n_obj),
            first=np.array(first, dtype=np.int32),
            last=np.array(last, dtype=np.int32),
        )


def _spans(fronts: Sequence[np.ndarray]) -> tuple[list[np.ndarray], list[int], list[int]]:
    """Return each point that is in successive fronts once, with the first and the last of these."""
    points: list[np.ndarray] = []
    first: list[int] = []
    last: list[int] = []
    standing: dict[bytes, int] = {}
    for k, front in enumerate(fronts):
        still = {}
        for point in front:
            name = point.tobytes()
            index = standing.get(name)
            if index is None:
                index = len(points)
                points.append(point)
                first.append(k)
                last.append(k)
            last[index] = k
            still[name] = index
        standing = still
    return points, first, last


@lru_cache(maxsize=1)
def machine() -> dict[str, Any]:
    """Return what this process runs on: system, processor and number of cores."""
    return {"system": f"{platform.system()} {platform.machine()}", "processor": _processor(), "cores": os.cpu_count()}


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            names = [line.split(":", 1)[1].strip() for line in file if line.startswith("model name")]
    except OSError:
        names = []
    return names[0] if names else platform.processor() or "unknown"


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds")
