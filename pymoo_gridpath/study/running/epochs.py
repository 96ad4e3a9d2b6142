"""What is kept of a run among obstacles that move: the front at the end of each epoch, and what was wrong with its members."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pymoo_gridpath import checks

_RECORD = np.dtype([(name, "<i8") for name in ("evaluations", "missed", "stale", "wrong", "illegal")])
_NAMES = {"epochs", "epoch_points", "epoch_of_points", "epoch_of_records"}


@dataclass(frozen=True, eq=False)
class Epochs:
    """What a run had found at the end of each epoch, on the map of that epoch.

    Attributes
    ----------
    evaluations : numpy.ndarray, shape (n_epochs,), int64
        Spent until then.
    missed : numpy.ndarray, shape (n_epochs,), int64
        Members that the algorithm had kept with values of an earlier map over a generation, and that the clock renewed.
    stale, wrong, illegal : numpy.ndarray, shape (n_epochs,), int64
        Members at the end with values of another map, with objectives that were others, and that passed for legal paths and
        were none; see `ObstacleClock`.
    points : numpy.ndarray, shape (P, n_obj)
        Objectives of the legal non-dominated solutions at the end of each.
    of_points : numpy.ndarray, shape (P,), int32
        The epoch of each point.
    of_records : numpy.ndarray, shape (T,), int32
        The epoch of each record of the run's history.
    """

    evaluations: np.ndarray
    missed: np.ndarray
    stale: np.ndarray
    wrong: np.ndarray
    illegal: np.ndarray
    points: np.ndarray
    of_points: np.ndarray
    of_records: np.ndarray

    @classmethod
    def of(
        cls,
        fronts: Sequence[np.ndarray],
        evaluations: Sequence[int],
        missed: Sequence[int] | None = None,
        faults: Sequence[tuple[int, int, int]] | None = None,
        of_records: Sequence[int] = (),
    ) -> Epochs:
        """Return what an `ObstacleClock` has kept, or what planners have found that planned anew on each map."""
        n_epochs = len(fronts)
        stale, wrong, illegal = np.array(faults or [(0, 0, 0)] * n_epochs, dtype=np.int64).reshape(-1, 3).T
        return cls(
            evaluations=np.array(evaluations, dtype=np.int64),
            missed=np.array(missed or [0] * n_epochs, dtype=np.int64),
            stale=stale,
            wrong=wrong,
            illegal=illegal,
            points=np.concatenate([np.asarray(front, dtype=float) for front in fronts]),
            of_points=np.repeat(np.arange(n_epochs, dtype=np.int32), [len(front) for front in fronts]),
            of_records=np.array(of_records, dtype=np.int32),
        )

    def __len__(self) -> int:
        return len(self.evaluations)

    def front(self, epoch: int) -> np.ndarray:
        """Return the points at the end of an epoch, shape (n, n_obj)."""
        return self.points[self.of_points == checks.whole("epoch", epoch, 0, len(self) - 1)]

    def fronts(self) -> list[np.ndarray]:
        """Return the points at the end of each epoch."""
        return [self.front(epoch) for epoch in range(len(self))]

    def packed(self) -> dict[str, np.ndarray]:
        """Return the arrays of a file."""
        records = np.empty(len(self), dtype=_RECORD)
        for name in _RECORD.names or ():
            records[name] = getattr(self, name)
        return {
            "epochs": records,
            "epoch_points": self.points,
            "epoch_of_points": self.of_points,
            "epoch_of_records": self.of_records,
        }

    @classmethod
    def unpacked(cls, arrays: dict[str, np.ndarray]) -> Epochs | None:
        """Return what `packed` wrote; None for runs on problems that stand still."""
        if not arrays.keys() >= _NAMES:
            return None
        columns = {name: np.ascontiguousarray(arrays["epochs"][name]) for name in _RECORD.names or ()}
        points, of_points, of_records = (arrays[f"epoch_{name}"] for name in ("points", "of_points", "of_records"))
        return cls(**columns, points=points, of_points=of_points, of_records=of_records)
