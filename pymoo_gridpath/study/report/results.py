"""What a store holds of a study, measured: a result for each planned run, and a front to measure against for each problem."""

from __future__ import annotations

import contextlib
import json
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.exact import Certificate
from pymoo_gridpath.study.planning.plan import Plan, PlannedRun, has_own_budget, is_deterministic
from pymoo_gridpath.study.report import moving
from pymoo_gridpath.study.report.references import ProblemReference, reference_of
from pymoo_gridpath.study.report.statistics.summaries import first_reaching
from pymoo_gridpath.study.running.record import DamagedRecordError, History, RunRecord
from pymoo_gridpath.study.running.store import Store, readable
from pymoo_gridpath.study.specification.kinds import objective_name


@dataclass(frozen=True, eq=False)
class Curve:
    """How a run converged, one entry a record of its history.

    Attributes
    ----------
    evaluations, ratio, length, legal : numpy.ndarray, shape (T,)
        Evaluations spent; hypervolume ratio; least length over that of the reference front, ``inf`` without a legal path and
        NaN where length is not an objective; share of the population's members that are legal paths.
    """

    evaluations: np.ndarray
    ratio: np.ndarray
    length: np.ndarray
    legal: np.ndarray


@dataclass(eq=False)
class RunResult:
    """A planned run of an algorithm, and its measures if it is finished.

    Attributes
    ----------
    key : str
    problem, algorithm : int
        Indices in the plan.
    seed : int
    status : {"finished", "failed", "missing", "damaged"}
    message : str
        Of failed runs the traceback, of incomplete exact fronts what the search says.
    complete : bool
        Whether the front of an exact run is whole; True for others.
    certified : Certificate or None
        How near an exact search has proven its front to be; None where nothing is proven, as of all other runs.
    F : numpy.ndarray or None, shape (N, n_obj)
        Its legal non-dominated points, kept for the first problem of each group.
    ratio, igd_plus, share : float
        NaN unless finished, as all numbers that follow. Where obstacles move, means over the epochs.
    turn : float
        Mean total turn of the paths of its front in degrees, ``inf`` if there is none.
    n_points, n_members, n_eval, n_gen, seconds : float
    evaluations_to_target, seconds_to_target : float
        ``inf`` if the target was not reached.
    curve : Curve or None
    epochs : EpochMeasures or None
        None where obstacles do not move.
    """

    key: str
    problem: int
    algorithm: int
    seed: int
    status: str = "missing"
    message: str = ""
    complete: bool = True
    certified: Certificate | None = None
    F: np.ndarray | None = None
    ratio: float = math.nan
    igd_plus: float = math.nan
    share: float = math.nan
    turn: float = math.nan
    n_points: float = math.nan
    n_members: float = math.nan
    n_eval: float = math.nan
    n_gen: float = math.nan
    seconds: float = math.nan
    evaluations_to_target: float = math.nan
    seconds_to_target: float = math.nan
    curve: Curve | None = None
    epochs: moving.EpochMeasures | None = None

    @property
    def finished(self) -> bool:
        """Whether the run ended and has measures."""
        return self.status == "finished"

    @property
    def feasible(self) -> bool:
        """Whether it ended with a legal path; where obstacles move, each of its epochs."""
        return self.n_points > 0 and (self.epochs is None or bool((self.epochs.n_points > 0).all()))


@dataclass(eq=False)
class Results:
    """A study as measured.

    Attributes
    ----------
    plan : Plan
    target : float
    runs : list of RunResult
        In the order of the plan.
    references : list of ProblemReference
        One a problem.
    machines, versions : collections.Counter
        How many runs were made on which machine and with which versions, as JSON texts.
    reference_states : collections.Counter
        How many runs have which status among those that are but the reference of a problem.
    study_file : str or None
        The text of the study file, if the study was run from one.
    """

    plan: Plan
    target: float
    runs: list[RunResult] = field(default_factory=list)
    references: list[ProblemReference] = field(default_factory=list)
    machines: Counter = field(default_factory=Counter)
    versions: Counter = field(default_factory=Counter)
    reference_states: Counter = field(default_factory=Counter)
    study_file: str | None = None

    def __post_init__(self):
        self._cells: dict[tuple[int, int], list[RunResult]] | None = None

    @property
    def groups(self) -> dict[str, list[int]]:
        """The problems of each group, in the order of the plan."""
        groups: dict[str, list[int]] = {}
        for index, problem in enumerate(self.plan.problems):
            groups.setdefault(problem.group, []).append(index)
        return groups

    @property
    def algorithms(self) -> list[str]:
        """The labels of the algorithms."""
        return [algorithm.label for algorithm in self.plan.algorithms]

    def is_deterministic(self, algorithm: int) -> bool:
        """Whether an algorithm draws no random number, so that it has one run a problem and is not part of the tests."""
        return is_deterministic(self.plan.algorithms[algorithm].spec)

    @property
    def random(self) -> list[int]:
        """The algorithms that draw random numbers, and so have a run for each seed."""
        return [k for k in range(len(self.algorithms)) if not self.is_deterministic(k)]

    def planned(self, algorithm: int, problems: Sequence[int]) -> list[RunResult]:
        """Return the runs of an algorithm on some problems, whatever became of them."""
        if self._cells is None:
            self._cells = {}
            for run in self.runs:
                self._cells.setdefault((run.problem, run.algorithm), []).append(run)
        return [run for problem in problems for run in self._cells.get((problem, algorithm), [])]

    def finished(self, algorithm: int, problems: Sequence[int]) -> list[RunResult]:
        """Return the finished runs of an algorithm on some problems."""
        return [run for run in self.planned(algorithm, problems) if run.finished]

    def values(self, measure: str, algorithm: int, problems: Sequence[int]) -> np.ndarray:
        """Return a measure of the finished runs of an algorithm on some problems."""
        return np.array([getattr(run, measure) for run in self.finished(algorithm, problems)], dtype=float)


def collect(store: Store, target: float | None = None) -> Results:
    """Read and measure the runs of a study.

    Parameters
    ----------
    store : Store
    target : float, optional
        The hypervolume ratio that "to target" asks for; by default the plan's.

    Raises
    ------
    GridPathError
        If there is no plan, or the target is not above 0, or above 1.
    """
    plan = store.read_plan()
    results = Results(plan, plan.target if target is None else target)
    if not (isinstance(results.target, int | float) and 0.0 < results.target <= 1.0):
        raise GridPathError(f"target is {target!r}, expected a hypervolume ratio above 0, at most 1")
    with contextlib.suppress(OSError):
        results.study_file = (store.folder / "study.toml").read_text(encoding="utf-8", errors="replace")
    by_problem: list[list[PlannedRun]] = [[] for _ in plan.problems]
    for run in plan.runs:
        by_problem[run.problem].append(run)
    keep = {problems[0] for problems in results.groups.values()}
    measured: dict[str, RunResult] = {}
    # One problem at a time, so that no more histories are in memory than it has runs.
    for problem, runs in enumerate(by_problem):
        records = {run.key: _read(store, run.key) for run in runs}
        _count_origins(results, [record for record, _ in records.values() if record is not None])
        wanted = plan.problems[problem].reference
        if wanted is not None and wanted not in records:
            records[wanted] = _read(store, wanted)
        _check_objectives(plan, problem, records)
        reference = reference_of(plan, problem, records)
        results.references.append(reference)
        for run in runs:
            record, status = records[run.key]
            if run.algorithm is None:
                results.reference_states[status] += 1
            else:
                result = RunResult(run.key, run.problem, run.algorithm, run.seed, status)
                if record is not None:
                    measure(result, record, reference, results.target, keep_front=problem in keep)
                measured[run.key] = result
    results.runs = [measured[run.key] for run in plan.runs if run.algorithm is not None]
    return results


def _read(store: Store, key: str) -> tuple[RunRecord | None, str]:
    """Return a record, if there is one, without its genes, and its status."""
    with readable(store.folder):
        if not store.path(key).exists():
            return None, "missing"
    try:
        record = store.read(key, genes=False)
    except DamagedRecordError:
        return None, "damaged"
    return record, record.status


def _check_objectives(plan: Plan, problem: int, records: dict[str, tuple[RunRecord | None, str]]) -> None:
    """Refuse a plan that somebody changed, so that its runs are of other problems."""
    planned = plan.problems[problem]
    for key, (record, _) in records.items():
        if record is not None and record.objectives != [objective_name(one) for one in planned.spec["objectives"]]:
            raise GridPathError(
                f"the run {key} has the objectives {', '.join(record.objectives)}, expected those of the problem "
                f"{checks.shown(planned.label)} in plan.json; `study run` writes it anew"
            )


def _count_origins(results: Results, records: list[RunRecord]) -> None:
    for record in records:
        results.machines[json.dumps(record.machine, sort_keys=True)] += 1
        results.versions[json.dumps(record.versions, sort_keys=True)] += 1


def measure(result: RunResult, record: RunRecord, reference: ProblemReference, target: float, keep_front: bool) -> None:
    """Enter what a record says, and its measures if it is finished."""
    front = reference.front
    result.message, result.complete, result.certified = record.message, record.complete, record.certified
    if record.status != "finished":
        return
    result.F = record.F if keep_front else None
    result.ratio = front.hypervolume_ratio(record.F)
    result.igd_plus = front.igd_plus(record.F)
    result.share = front.share_found(record.F)
    if record.epochs is not None and reference.epochs:
        result.epochs = moving.measured(record.epochs, reference.epochs)
        for name in ("ratio", "igd_plus", "share"):
            setattr(result, name, float(getattr(result.epochs, name).mean()))
    result.turn = float(record.turn.mean()) if len(record.turn) else math.inf
    result.n_points, result.seconds = len(record.F), record.seconds
    reached = result.ratio >= target
    result.seconds_to_target = record.seconds if reached else math.inf
    if has_own_budget(record.algorithm):
        return  # it makes no evaluations
    result.n_eval, result.n_gen, result.n_members = record.n_eval, record.n_gen, record.n_members
    result.evaluations_to_target = record.n_eval if reached else math.inf
    if record.history is not None and len(record.history):
        result.curve = _curve(record, record.history, reference)
        # One map's ratio says nothing of the next one's.
        first = None if reference.epochs else first_reaching(result.curve.ratio, target)
        if first is not None:
            result.evaluations_to_target = float(record.history.evaluations[first])
            result.seconds_to_target = float(record.history.seconds[first])


def _curve(record: RunRecord, history: History, reference: ProblemReference) -> Curve:
    of_records = np.zeros(len(history), dtype=int)
    if record.epochs is not None and reference.epochs:
        of_records = record.epochs.of_records
        ratio = moving.ratios(history, of_records, reference.epochs)
    else:
        ratio = reference.front.hypervolume_ratios(history.points, history.first, history.last, len(history))
    fronts = reference.epochs or (reference.front,)
    shortest = np.full(len(fronts), math.nan)
    if "length" in record.objectives:
        column = record.objectives.index("length")
        shortest = np.array([front.points[:, column].min(initial=math.inf) for front in fronts])
    shortest = shortest[of_records]
    # Without a length to compare with, there is no legal path (inf) or no such objective (NaN).
    comparable = np.isfinite(shortest) & (shortest > 0)
    length = np.where(shortest == 0, math.nan, shortest)
    length[comparable] = history.best_length[comparable] / shortest[comparable]
    legal = history.n_legal / np.maximum(history.n_members, 1)
    return Curve(history.evaluations.astype(float), ratio, length, legal)
