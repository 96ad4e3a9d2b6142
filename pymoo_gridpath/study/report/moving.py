"""Runs among obstacles that move, measured: each epoch against the front of its own map."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pymoo_gridpath.quality import ReferenceFront, merge_fronts
from pymoo_gridpath.study.running.epochs import Epochs
from pymoo_gridpath.study.running.record import History


@dataclass(frozen=True, eq=False)
class EpochMeasures:
    """The measures of a run at the end of each epoch, each of shape (n_epochs,).

    Attributes
    ----------
    ratio, igd_plus, share : numpy.ndarray
        Of what had been found, against the front of the epoch.
    n_points, evaluations : numpy.ndarray of int
    missed, stale, wrong, illegal : numpy.ndarray of int
        See `pymoo_gridpath.study.running.epochs.Epochs`.
    """

    ratio: np.ndarray
    igd_plus: np.ndarray
    share: np.ndarray
    n_points: np.ndarray
    evaluations: np.ndarray
    missed: np.ndarray
    stale: np.ndarray
    wrong: np.ndarray
    illegal: np.ndarray


def measured(epochs: Epochs, fronts: Sequence[ReferenceFront]) -> EpochMeasures:
    """Return the measures of a run at the end of each epoch."""
    pairs = list(zip(fronts, epochs.fronts(), strict=True))
    return EpochMeasures(
        ratio=np.array([front.hypervolume_ratio(F) for front, F in pairs]),
        igd_plus=np.array([front.igd_plus(F) for front, F in pairs]),
        share=np.array([front.share_found(F) for front, F in pairs]),
        n_points=np.array([len(F) for _, F in pairs]),
        evaluations=epochs.evaluations,
        **{name: getattr(epochs, name) for name in ("missed", "stale", "wrong", "illegal")},
    )


def ratios(history: History, of_records: np.ndarray, fronts: Sequence[ReferenceFront]) -> np.ndarray:
    """Return the hypervolume ratio at each record of a history, to the front of the epoch that the record is of."""
    found = np.zeros(len(history))
    for epoch in np.unique(of_records):
        records = np.flatnonzero(of_records == epoch)
        begin, end = records[0], records[-1]
        standing = (history.first <= end) & (history.last >= begin)
        first, last = (np.clip(ends[standing], begin, end) - begin for ends in (history.first, history.last))
        found[records] = fronts[epoch].hypervolume_ratios(history.points[standing], first, last, len(records))
    return found


def exceeded(epochs: Sequence[Epochs], fronts: Sequence[ReferenceFront]) -> bool:
    """Whether runs found points beyond the front of some epoch."""
    by_epoch = zip(*(each.fronts() for each in epochs), strict=True)
    return any(front.exceeded_by(np.concatenate(found)) for front, found in zip(fronts, by_epoch, strict=True))


def merged(epochs: Sequence[Epochs], n_obj: int) -> tuple[ReferenceFront, ...]:
    """Return the merged front of runs in each epoch, which takes the place of the exact one."""
    by_epoch = zip(*(each.fronts() for each in epochs), strict=True)
    return tuple(ReferenceFront(merge_fronts([np.empty((0, n_obj)), *fronts]), exact=False) for fronts in by_epoch)
