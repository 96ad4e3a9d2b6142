"""Recording how a run converges."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import moocore
import numpy as np
from pymoo.core.callback import Callback

from pymoo_gridpath import checks
from pymoo_gridpath.checks import shown
from pymoo_gridpath.decision.measures import PathMeasures
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.problems.members import Members, snapshot


class ConvergenceRecorder(Callback):
    """A pymoo callback that records the legal paths of every generation's population.

    Pass it as ``minimize(..., callback=ConvergenceRecorder())`` and find it, filled, as ``result.algorithm.callback``, since
    pymoo copies the algorithm. It can be copied and pickled.

    Parameters
    ----------
    reference_point : sequence of float, optional
        What `hypervolume` is measured against unless told otherwise.

    Raises
    ------
    GridPathError
        If the point is none.

    Attributes
    ----------
    evaluations, generations : list of int
        Number of evaluations and of the generation at each record.
    n_feasible : list of int
        Number of members that are legal paths.
    best_length, best_vulnerability : list of float
        The least among those, ``inf`` if there is none.
    fronts : list of numpy.ndarray, shape (K, n_obj)
        Their non-dominated plain objectives, each point once.
    resolution : float or None
        Metres a cell of the map, if it states them and something was recorded.
    """

    def __init__(self, reference_point: Sequence[float] | np.ndarray | None = None):
        super().__init__()
        self.reference_point = None if reference_point is None else _as_point(reference_point)
        self.evaluations: list[int] = []
        self.generations: list[int] = []
        self.n_feasible: list[int] = []
        self.best_length: list[float] = []
        self.best_vulnerability: list[float] = []
        self.fronts: list[np.ndarray] = []
        self.resolution: float | None = None
        self._measures: PathMeasures | None = None

    def __len__(self) -> int:
        return len(self.evaluations)

    def __getstate__(self) -> dict:
        # The prepared potential is as large as the grid and soon made again.
        return {**self.__dict__, "_measures": None}

    # pymoo's CallbackCollection calls update() only, so this is the hook that works everywhere.
    def _update(self, algorithm: Any) -> None:
        if self._measures is None:
            self._measures = PathMeasures(algorithm.problem)
            self.resolution = algorithm.problem.grid.resolution
        members = Members(algorithm)
        found = snapshot(algorithm, members)
        self.evaluations.append(found.n_eval)
        self.generations.append(int(algorithm.n_iter))
        self.n_feasible.append(found.n_legal)
        best_length, best_vulnerability = found.length, members.least("vulnerability")
        if np.isnan(best_length) or np.isnan(best_vulnerability):
            # Measured, where they are no objectives.
            paths = algorithm.problem.decode(members.X(np.arange(members.n_legal), algorithm.problem.n_var))
            best_length = float(np.min(paths.length, initial=np.inf))
            best_vulnerability = float(np.min(self._measures.vulnerability(paths), initial=np.inf))
        self.best_length.append(best_length)
        self.best_vulnerability.append(best_vulnerability)
        # Late generations often agree; one array then serves them all.
        same = bool(self.fronts) and np.array_equal(self.fronts[-1], found.front)
        self.fronts.append(self.fronts[-1] if same else found.front)

    @property
    def first_feasible(self) -> int | None:
        """Index of the first record with a legal path, None if there is none."""
        found = np.flatnonzero(self.n_feasible)
        return int(found[0]) if len(found) else None

    def hypervolume(self, reference_point: Sequence[float] | np.ndarray | None = None) -> np.ndarray:
        """Return the hypervolume of each recorded front, shape (n_records,); 0 where there is none.

        Parameters
        ----------
        reference_point : sequence of float, optional
            By default the recorder's own, else `common_reference_point` of this recorder alone.

        Raises
        ------
        GridPathError
            If the point does not have one number for each objective, or nothing was recorded.
        """
        given = self.reference_point if reference_point is None else reference_point
        point = common_reference_point([self]) if given is None else _as_point(given)
        if not len(self):
            raise GridPathError("nothing was recorded, expected a recorder that went through a run")
        if point.shape != (self.fronts[0].shape[1],):
            raise GridPathError(f"reference_point is {shown(given)}, expected {self.fronts[0].shape[1]} numbers")
        values, previous = np.zeros(len(self)), None
        for k, front in enumerate(self.fronts):
            if front is previous:
                values[k] = values[k - 1]
            elif len(front):
                values[k] = moocore.hypervolume(front, ref=point)
            previous = front
        return values


def common_reference_point(recorders: Sequence[ConvergenceRecorder], margin: float = 0.1) -> np.ndarray:
    """Return a point beyond the final fronts of all recorders: their nadir plus a part of their range.

    Parameters
    ----------
    recorders : sequence of ConvergenceRecorder
    margin : float, default 0.1
        Part of the range between the least and the largest value that is added; where that range is zero, 1 is added.

    Returns
    -------
    numpy.ndarray, shape (n_obj,)

    Raises
    ------
    GridPathError
        If no recorder ever saw a legal path, or an argument is of another kind.
    """
    margin = checks.number("margin", margin, 0.0, expected="a part of the range, zero or more")
    recorders = checks.items("recorders", recorders, "ConvergenceRecorders")
    for recorder in recorders:
        checks.instance("a recorder", recorder, ConvergenceRecorder)
    fronts = [recorder.fronts[-1] for recorder in recorders if len(recorder) and len(recorder.fronts[-1])]
    if not fronts:
        raise GridPathError("no run ended with a legal path, expected at least one to choose a reference point by")
    if len({front.shape[1] for front in fronts}) > 1:
        raise GridPathError("the runs have different numbers of objectives, expected runs of one problem")
    F = np.concatenate(fronts)
    spread = np.ptp(F, axis=0)
    return F.max(axis=0) + np.where(spread > 0, margin * spread, 1.0)


def _as_point(reference_point) -> np.ndarray:
    """Return a reference point as an array of its own, float, shape (n,)."""
    expected = "a finite number for each objective"
    return checks.array("reference_point", reference_point, (None,), expected=expected, finite=True).astype(float)
