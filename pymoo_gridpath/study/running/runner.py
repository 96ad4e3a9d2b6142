"""The coordinator of a study: gives the runs that are missing to an executor and stores what comes back."""

from __future__ import annotations

import contextlib
import os
from collections import Counter, deque
from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from dataclasses import dataclass

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.parallel import check_executor
from pymoo_gridpath.study.planning.expand import plan_study
from pymoo_gridpath.study.planning.plan import Plan, PlannedRun
from pymoo_gridpath.study.running.execute import execute, failed_run
from pymoo_gridpath.study.running.executor import WorkerLost, describe
from pymoo_gridpath.study.running.executors import study_executor
from pymoo_gridpath.study.running.progress import StudyProgress
from pymoo_gridpath.study.running.record import read_meta
from pymoo_gridpath.study.running.store import Store, StoredRuns
from pymoo_gridpath.study.specification.study import Study
from pymoo_gridpath.versions import versions

#: How often a run is given out before it is given up, if what carries it out fails.
MAX_ATTEMPTS = 3
# Seconds between two looks at the executor and updates of the progress line while nothing finishes.
_INTERVAL = 1.0


@dataclass(frozen=True)
class Outcome:
    """What came of a study that was run or resumed.

    Attributes
    ----------
    n_planned : int
        Runs of the study.
    n_done_before : int
        Of these, those that were stored already, and so not carried out.
    n_run : int
        Those that were carried out, failed ones among them.
    n_failed : int
        Those that are stored as failed in the end.
    messages : list of str
        What there is to tell, a sentence each: damaged files, other versions, failed runs, an interruption.
    interrupted : bool
        Whether Ctrl-C ended it.
    """

    n_planned: int
    n_done_before: int
    n_run: int
    n_failed: int
    messages: list[str]
    interrupted: bool = False


def run_study(
    plan: Plan | Study,
    folder: str | os.PathLike,
    executor: Executor | None = None,
    retry_failed: bool = False,
    study: str | None = None,
    stream=None,
    tell: Callable[[str], None] | None = None,
) -> Outcome:
    """Carry out every run of a plan that is not stored yet, and store each as soon as it has ended.

    May be killed at any moment and called again: what is stored is whole, and only what is missing is carried out. What a run
    finds depends on its task alone, whatever the executor; but for an exact front that its time does not suffice for.

    Parameters
    ----------
    plan : Plan or Study
    folder : path-like
        Where the runs are stored, see `Store`; made if need be.
    executor : concurrent.futures.Executor, optional
        What carries the runs out; this process by default. `LocalProcesses` and `dask_executor` are two that outlive the
        loss of a worker; any other that can pickle a function by its name will do, such as loky's or mpi4py's. Threads of one
        process take turns, so that they are of little use, and measured times mean less. It is left open, except that an
        interruption or an error ends what it does.
    retry_failed : bool, default False
        Whether runs that are stored as failed are carried out again, and exact fronts that are not whole.
    study : str, optional
        Text of the study file, to be kept beside the plan.
    stream : file, optional
        Where progress is shown if it is a terminal; standard error by default.
    tell : callable, optional
        Called with each sentence of `Outcome.messages` as soon as there is cause for it; what concerns stored runs before any
        is carried out.

    Returns
    -------
    Outcome
        Also after Ctrl-C, with ``interrupted=True`` and what had finished stored. A second Ctrl-C raises KeyboardInterrupt.

    Raises
    ------
    GridPathError
        If another process runs a study in the folder, or it holds another study; if it cannot be written to; if the executor is
        beyond repair, or a run could not be handed to it in `MAX_ATTEMPTS` attempts.
    """
    if isinstance(plan, Study):
        plan = plan_study(plan)
    checks.instance("plan", plan, Plan, " or a Study")
    check_executor(executor)
    retry_failed = checks.flag("retry_failed", retry_failed)
    checks.function("tell", tell, "a function of a sentence", 1, optional=True)
    store = Store(folder)
    messages: list[str] = []

    def say(sentences: Iterable[str]) -> None:
        for sentence in sentences:
            messages.append(sentence)
            if tell is not None:
                tell(sentence)

    with store.lock() as held:
        say(_about_lock(store, held))
        runs = {run.key: run for run in plan.runs}
        say(_about_plan_before(store, plan))
        store.write_plan(plan, study)
        found = store.check(runs, set_aside=True)
        say(_about_stored(found))
        again = [*found.failed, *found.incomplete] if retry_failed else []
        due = set(found.missing).union(again)
        coordinator = _Coordinator(plan, store, [run for key, run in runs.items() if key in due], executor, stream)
        interrupted = coordinator.run()
    failed = {key: found.meta[key]["message"] for key in found.failed} | coordinator.failed
    failed = {key: message for key, message in failed.items() if key not in coordinator.finished}
    say(_about_failed(plan, runs, failed))
    if interrupted:
        n_stored = len(found.meta) + len(coordinator.finished.union(coordinator.failed).difference(found.meta))
        say([f"interrupted: {n_stored} of {len(runs)} runs are stored; running again goes on from there"])
    return Outcome(
        n_planned=len(runs),
        n_done_before=len(runs) - len(due),
        n_run=len(coordinator.finished) + len(coordinator.failed),
        n_failed=len(failed),
        messages=messages,
        interrupted=interrupted,
    )


class _Coordinator:
    """Gives out runs and stores their records; alone in writing files."""

    def __init__(self, plan: Plan, store: Store, runs: list[PlannedRun], executor: Executor | None, stream):
        self.finished: set[str] = set()
        self.failed: dict[str, str] = {}
        self._plan, self._store = plan, store
        self._executor = study_executor(executor)
        self._waiting = deque(runs)
        # Runs whose workers died: each is tried once more without others beside it, which may have taken the memory.
        self._suspects: deque[PlannedRun] = deque()
        self._in_flight: dict[Future, PlannedRun] = {}
        self._attempts: Counter[str] = Counter()
        self._progress = StudyProgress(map(self._kind, runs), stream)

    def run(self) -> bool:
        """Carry out the runs, and return whether Ctrl-C ended it."""
        try:
            with self._progress:
                while self._waiting or self._suspects or self._in_flight:
                    self._submit()
                    done, _ = wait(self._in_flight, _INTERVAL, FIRST_COMPLETED)
                    for future in done:
                        self._take(future)
                    self._executor.check()
                    self._progress.show()
        except KeyboardInterrupt:
            self._keep_finished()
            return True
        except BaseException:
            with contextlib.suppress(GridPathError):
                self._keep_finished()
            raise
        finally:
            if self._in_flight:
                for future in self._in_flight:
                    future.cancel()
                self._executor.abort()
        return False

    def _submit(self) -> None:
        if self._suspects:
            if not self._in_flight:
                self._give_out(self._suspects)
            return
        while self._waiting and len(self._in_flight) < self._executor.capacity:
            if not self._give_out(self._waiting):
                return

    def _give_out(self, runs: deque[PlannedRun]) -> bool:
        """Submit the first of some runs, and return whether the executor took it."""
        try:
            future = self._executor.submit(execute, self._plan.task(runs[0]))
        except BrokenExecutor as error:
            # Those in flight say so themselves.
            if not self._in_flight:
                self._executor.recover(error)
            return False
        self._in_flight[future] = runs.popleft()
        return True

    def _take(self, future: Future) -> None:
        """Store what a future returned, or see to it that its run is given out again."""
        error = _error_of(future)
        if error is None:
            error = self._store_result(future)
        if error is None:
            return
        run = self._in_flight.pop(future)
        if isinstance(error, self._executor.hopeless):
            self._give_up(run, f"the workers that carried it out were lost: {describe(error)}")
            return
        self._executor.recover(error)
        self._again(run, error)

    def _again(self, run: PlannedRun, error: BaseException) -> None:
        self._attempts[run.key] += 1
        lost = isinstance(error, WorkerLost)
        if self._attempts[run.key] < MAX_ATTEMPTS - 1:
            self._waiting.appendleft(run)
        elif self._attempts[run.key] < MAX_ATTEMPTS:
            (self._suspects if lost else self._waiting).appendleft(run)
        elif lost:
            self._give_up(
                run,
                f"the process that carried it out ended without an answer {MAX_ATTEMPTS} times, the last time with no other "
                f"run beside it, as when memory runs out or compiled code crashes ({describe(error)})",
            )
        else:
            raise GridPathError(
                f"{_name(self._plan, run)} could not be carried out in {MAX_ATTEMPTS} attempts, for no fault of its own: "
                f"{describe(error)}"
            )

    def _give_up(self, run: PlannedRun, message: str) -> None:
        self._write(run, failed_run(self._plan.task(run), message))

    def _store_result(self, future: Future) -> BaseException | None:
        """Store what a future returned, or return what is wrong with it."""
        run, data = self._in_flight[future], future.result()
        try:
            key = read_meta(data)["key"]
        except (GridPathError, TypeError) as error:
            return error
        if key != run.key:
            return GridPathError(f"the executor returned run {key}, expected {run.key}")
        self._write(run, data)
        del self._in_flight[future]
        return None

    def _write(self, run: PlannedRun, data: bytes) -> None:
        meta = read_meta(data)
        self._store.write(run.key, data)
        failed = meta["status"] == "failed"
        if failed:
            self.failed[run.key] = meta["message"]
        else:
            self.finished.add(run.key)
        self._progress.done(self._kind(run), meta["seconds"], failed)

    def _keep_finished(self) -> None:
        """Store those in flight that have a result."""
        for future in list(self._in_flight):
            if future.done() and _error_of(future) is None:
                self._store_result(future)

    def _kind(self, run: PlannedRun) -> tuple:
        return self._plan.problems[run.problem].group, run.algorithm


def _error_of(future: Future) -> BaseException | None:
    """Return what a future that is done raises, or None if it has a result."""
    try:
        return future.exception()
    except Exception as error:  # it was cancelled
        return error


def _about_lock(store: Store, held: bool) -> Iterable[str]:
    if not held:
        yield f"the file system of {store.folder} knows no locks; see to it that no other run of a study uses the folder"


def _about_plan_before(store: Store, plan: Plan) -> Iterable[str]:
    """Say what the folder's plan so far had that this one has not, or refuse a folder that holds another study."""
    if not (store.folder / "plan.json").exists():
        return
    try:
        # References are shared by studies that differ in all else.
        before = {run.key for run in store.read_plan().runs if run.algorithm is not None}
    except GridPathError:
        return  # a plan that this version cannot read is written anew
    dropped = before.difference(run.key for run in plan.runs)
    if dropped and len(dropped) == len(before):
        raise GridPathError(
            f"{store.folder} holds another study, none of whose runs this one asks for; choose another folder (--output)"
        )
    if dropped:
        yield f"{_count(len(dropped), 'run')} part of the study before and no longer; what is stored of them stays"


def _about_stored(found: StoredRuns) -> Iterable[str]:
    if found.damaged:
        yield (
            f"{_count(len(found.damaged), 'stored run')} found damaged, set aside in {found.damaged[0].parent} (such as "
            f"{found.damaged[0].name}) and carried out again"
        )
    for path in found.odd:
        yield f"{path.name} is nothing that a study writes where it stood, and was set aside in {path.parent}"
    here = versions()
    differences: Counter[str] = Counter()
    n_other = 0
    for made_with, number in found.versions.items():
        others = [f"{package} {version}, not {here.get(package, 'none')}" for package, version in made_with]
        others = [text for text, (package, version) in zip(others, made_with, strict=True) if here.get(package) != version]
        n_other += number if others else 0
        differences.update(others)
    if differences:
        yield (
            f"{_count(n_other, 'stored run')} made with other versions than are installed here ({'; '.join(differences)}) and "
            "kept as they are"
        )


def _about_failed(plan: Plan, runs: dict[str, PlannedRun], failed: dict[str, str]) -> Iterable[str]:
    if failed:
        key, message = next(iter(failed.items()))
        last = message.strip().splitlines()[-1]
        yield (
            f"{_count(len(failed), 'run')} stored as failed, such as {_name(plan, runs[key])}: {last}; --retry-failed "
            "(retry_failed=True) tries again"
        )


def _count(number: int, noun: str) -> str:
    return f"1 {noun} was" if number == 1 else f"{number} {noun}s were"


def _name(plan: Plan, run: PlannedRun) -> str:
    algorithm = "the reference" if run.algorithm is None else plan.algorithms[run.algorithm].label
    return f"{algorithm} on {plan.problems[run.problem].label} with seed {run.seed}"
