"""The fronts that the runs of a study are measured against."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pymoo_gridpath.quality import ReferenceFront, merge_fronts
from pymoo_gridpath.study.planning.canonical import resolve
from pymoo_gridpath.study.planning.plan import Plan, is_truth
from pymoo_gridpath.study.report import moving
from pymoo_gridpath.study.running.record import RunRecord
from pymoo_gridpath.study.specification.moving import n_epochs


@dataclass(frozen=True, eq=False)
class ProblemReference:
    """The front of a problem, and why it is not the exact one if so.

    Attributes
    ----------
    front : ReferenceFront
        Where obstacles move, that of the last epoch.
    reason : str
        Empty if the front is exact.
    seconds : float
        What the exact front took; NaN if there was no such run.
    exceeded : bool
        Whether runs found legal points beyond the front, which overridden representations or obstacle rules allow.
    epochs : tuple of ReferenceFront
        That of each epoch where obstacles move; empty where they do not.
    """

    front: ReferenceFront
    reason: str
    seconds: float
    exceeded: bool
    epochs: tuple[ReferenceFront, ...] = ()


def reference_of(plan: Plan, problem: int, records: dict[str, tuple[RunRecord | None, str]]) -> ProblemReference:
    """Return the exact front of a problem, or the merged front of all runs and why."""
    planned = plan.problems[problem]
    exact, status = records.get(planned.reference or "", (None, "missing"))
    finished = [record for record, status in records.values() if record is not None and status == "finished"]
    fronts = [record.F for record in finished if len(record.F)]
    whole = [record for record in finished if record.complete and is_truth(record.algorithm)]
    if exact not in whole:
        # An exact front among the algorithms serves as well, unless it is that of a problem with overrides.
        same = (record for record in whole if record.problem == resolve(planned.spec, record.algorithm, {})[0])
        exact = next(same, exact)
    seconds = exact.seconds if exact is not None else math.nan
    if exact is not None and exact in whole:
        if exact.epochs is not None:
            return _exact_epochs(exact, finished)
        front = ReferenceFront(exact.F, exact=True)
        return ProblemReference(front, "", seconds, bool(fronts) and front.exceeded_by(np.concatenate(fronts)))
    if planned.reference is None:
        reason = planned.no_reference or "the study asks for no exact front of this problem"
    elif exact is None:
        reason = f"the run of the exact front is {status}"
    elif status == "failed":
        reason = f"the run of the exact front failed: {gist(exact.message)}"
    else:
        reason = f"the exact front is not complete: {gist(exact.message)}"
    n_obj = len(planned.spec["objectives"])
    if "moving" in planned.spec:
        none = ReferenceFront(np.empty((0, n_obj)), exact=False)
        epochs = moving.merged([record.epochs for record in finished if record.epochs is not None], n_obj)
        epochs = epochs or (none,) * n_epochs(planned.spec["moving"])
        return ProblemReference(epochs[-1], reason, seconds, False, epochs)
    empty = np.empty((0, n_obj))
    return ProblemReference(ReferenceFront(merge_fronts([empty, *fronts]), exact=False), reason, seconds, False)


def _exact_epochs(exact: RunRecord, finished: list[RunRecord]) -> ProblemReference:
    """Return the exact front of each epoch."""
    assert exact.epochs is not None
    epochs = tuple(ReferenceFront(F, exact=True) for F in exact.epochs.fronts())
    exceeded = moving.exceeded([record.epochs for record in finished if record.epochs is not None], epochs)
    return ProblemReference(epochs[-1], "", exact.seconds, exceeded, epochs)


def gist(message: str) -> str:
    """Return the line of a message that says most: the first, or of a traceback the last, which names the error."""
    lines = [line.strip() for line in message.splitlines() if line.strip()] or [""]
    return lines[-1] if lines[0].startswith("Traceback") else lines[0]


def kind_of(front: ReferenceFront) -> str:
    """Return what results are measured against, in a word: "exact", the whole truth, or "merged", the best of all runs."""
    return "exact" if front.exact else "merged"
