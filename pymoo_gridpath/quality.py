"""How near a set of points comes to a front, such as the exact one of a problem.

The functions measure one set of points; `ReferenceFront` measures many against one front. All objectives are minimised, and
only points of legal paths should be given, as `TradeOffSet` holds them.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import moocore
import numpy as np
from scipy.spatial import KDTree

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError, counted

#: By which share of an objective's largest size two values may differ and still be equal.
SAME = 1e-9

# The reference point lies this share of the front's range beyond its nadir.
_MARGIN = 0.1

# Decimals of a ratio, beyond which there is only the rounding of sums.
_DECIMALS = 12


class ReferenceFront:
    """The front of a problem that runs are measured against: the exact one, or the best that is known.

    Parameters
    ----------
    points : numpy.ndarray, shape (K, n_obj)
        Mutually non-dominated; K may be 0 if no legal path is known.
    exact : bool, default True
        Whether this is the whole Pareto front of the problem.

    Attributes
    ----------
    points : numpy.ndarray, shape (K, n_obj)
        In lexicographic order, no point twice.
    exact : bool
    low, span : numpy.ndarray, shape (n_obj,)
        Ideal point of the front, and its range, by which objectives are normalised. An objective without a range, such as
        those of a single point, counts in its own unit.
    """

    def __init__(self, points: np.ndarray, exact: bool = True):
        self.points = merge_fronts([np.asarray(points, dtype=float)])
        self.exact = exact
        if not len(self.points):
            return
        self.low = self.points.min(axis=0)
        sizes = np.abs(self.points).max(axis=0)
        # Of an objective that is 0 throughout, in its own unit.
        self.scale = np.where(sizes > 0.0, sizes, 1.0)
        ranges = np.ptp(self.points, axis=0)
        self.span = np.where(ranges > SAME * self.scale, ranges, 1.0)
        self._corner = np.full(len(self.low), 1.0 + _MARGIN)
        self._normalised = self.normalise(self.points)

    def __len__(self) -> int:
        return len(self.points)

    @cached_property
    def _volume(self) -> Any:
        return moocore.hypervolume(self._normalised, ref=self._corner)

    @cached_property
    def _tree(self) -> KDTree:
        return KDTree(self.points / self.scale)

    def normalise(self, F: np.ndarray) -> np.ndarray:
        """Return points with the front's ideal point at 0 and, where the front has a range, its nadir at 1."""
        return (np.asarray(F, dtype=float) - self.low) / self.span

    def hypervolume_ratio(self, F: np.ndarray) -> float:
        """Return the hypervolume of points over that of the front.

        The reference point lies a tenth of the front's range beyond its nadir in each objective. Where the front is a single
        point, points that reach it have 1 and any other 0. Without points the ratio is 0.

        Parameters
        ----------
        F : numpy.ndarray, shape (N, n_obj)
        """
        if not len(F) or not len(self):
            return 0.0
        if len(self) == 1:
            return float(self._reach_point(F).any())
        volume: Any = moocore.hypervolume(self.normalise(F), ref=self._corner)
        return round(volume / self._volume, _DECIMALS)

    def hypervolume_ratios(self, points: np.ndarray, first: np.ndarray, last: np.ndarray, n_records: int) -> np.ndarray:
        """Return the ratio at each record of a history.

        Parameters
        ----------
        points : numpy.ndarray, shape (P, n_obj)
        first, last : numpy.ndarray of int, shape (P,)
            From which to which record, inclusive, a point stood in the front. The points of one record are mutually
            non-dominated.
        n_records : int

        Returns
        -------
        numpy.ndarray, shape (n_records,)
        """
        if not len(points) or not len(self):
            return np.zeros(n_records)
        if len(self) == 1:
            reaching = np.flatnonzero(self._reach_point(points))
            changes = np.zeros(n_records + 1)
            np.add.at(changes, first[reaching], 1.0)
            np.add.at(changes, last[reaching] + 1, -1.0)
            return np.minimum(np.cumsum(changes)[:n_records], 1.0)
        F = self.normalise(points)
        if F.shape[1] == 2:
            volumes = _areas(F, first, last, n_records, self._corner)
        else:
            volumes = _volumes(F, first, last, n_records, self._corner)
        return np.round(volumes / self._volume, _DECIMALS)

    def igd_plus(self, F: np.ndarray) -> float:
        """Return the mean distance, in normalised objectives, by which points of the front are missed; ``inf`` without points.

        References
        ----------
        Ishibuchi, Masuda, Tanigaki and Nojima (2015), Modified distance calculation in generational distance and inverted
        generational distance.
        """
        if not len(F) or not len(self):
            return np.inf
        return float(moocore.igd_plus(self.normalise(F), ref=self._normalised))

    def share_found(self, F: np.ndarray) -> float:
        """Return the share of the front's points that are among the points, up to `SAME` of each objective's size."""
        if not len(F) or not len(self):
            return 0.0
        nearest: Any = self._tree.query(np.asarray(F, dtype=float) / self.scale, p=np.inf, distance_upper_bound=SAME)
        distances, indices = nearest
        return len(np.unique(indices[np.isfinite(distances)])) / len(self)

    def exceeded_by(self, F: np.ndarray) -> bool:
        """Whether some point dominates one of the front, or lies where no point of the front does."""
        if not len(F) or not len(self):
            return False
        both = merge_fronts([self.points, np.asarray(F, dtype=float)])
        distances, _ = self._tree.query(both / self.scale, p=np.inf, distance_upper_bound=2 * SAME)
        return not np.isfinite(distances).all()

    def _reach_point(self, F: np.ndarray) -> np.ndarray:
        """Return which points are as good as the single point of the front in every objective."""
        return (np.asarray(F) <= self.points[0] + SAME * self.scale).all(axis=1)


def hypervolume_ratio(F: Any, front: Any) -> float:
    """Return the hypervolume of points over that of a front.

    Both are normalised by the front's range; the reference point lies a tenth of that range beyond the front's nadir in each
    objective, so that points far off count 0. Where the front is a single point, points that reach it have 1 and any other 0.

    Parameters
    ----------
    F : array_like, shape (N, n_obj), or None
        The points, such as ``F`` of a `TradeOffSet`; None, as pymoo has it, for none.
    front : array_like, shape (K, n_obj)
        What they are measured against, such as ``problem.pareto_front()``.

    Returns
    -------
    float
        0 to 1 if the front is the whole Pareto front; 0 without points.

    Raises
    ------
    GridPathError
        If the arrays are not rows of as many finite numbers, or the front has no points.

    See Also
    --------
    ReferenceFront : Measures many sets of points against one front.

    Examples
    --------
    >>> front = [[10, 5], [11, 3], [14, 1]]
    >>> hypervolume_ratio(front, front)
    1.0
    >>> round(hypervolume_ratio([[11, 3]], front), 3)
    0.872
    """
    points, reference = _pair(F, front)
    return reference.hypervolume_ratio(points)


def igd_plus(F: Any, front: Any) -> float:
    """Return the mean distance by which points of a front are missed, in objectives that are normalised by its range.

    See `hypervolume_ratio` for the arguments, and what is raised.

    Returns
    -------
    float
        0 where every point of the front is reached; ``inf`` without points, where pymoo and moocore say 0.

    References
    ----------
    Ishibuchi, Masuda, Tanigaki and Nojima (2015), Modified distance calculation in generational distance and inverted
    generational distance.

    Examples
    --------
    >>> round(igd_plus([[11, 3]], [[10, 5], [11, 3], [14, 1]]), 3)
    0.25
    """
    points, reference = _pair(F, front)
    return reference.igd_plus(points)


def share_found(F: Any, front: Any) -> float:
    """Return the share of a front's points that are among the points, but for rounding (`SAME` of each objective's size).

    See `hypervolume_ratio` for the arguments, and what is raised.

    Returns
    -------
    float
        0 to 1.

    Examples
    --------
    >>> share_found([[10, 5], [12, 3]], [[10, 5], [11, 3]])
    0.5
    """
    points, reference = _pair(F, front)
    return reference.share_found(points)


def mean_hypervolume_ratio(F: Any, fronts: Any) -> float:
    """Return the mean of `hypervolume_ratio` over the epochs of a problem that changes, each against its own front.

    Parameters
    ----------
    F : sequence of array_like, each of shape (N, n_obj), or None
        What had been found at the end of each epoch, such as ``F`` of an `ObstacleClock`.
    fronts : sequence of array_like, each of shape (K, n_obj)
        The front of each epoch, such as ``[still.pareto_front() for still in problem.stills]``.

    Returns
    -------
    float
        1 where every front is reached.

    Raises
    ------
    GridPathError
        If there are not as many of one as of the other, at least one each, or as `hypervolume_ratio`.

    Examples
    --------
    >>> mean_hypervolume_ratio([[[10, 5]], []], [[[10, 5]], [[12, 3]]])
    0.5
    """
    return float(np.mean([reference.hypervolume_ratio(points) for points, reference in _epochs(F, fronts)]))


def mean_igd_plus(F: Any, fronts: Any) -> float:
    """Return the mean of `igd_plus` over the epochs of a problem that changes, each against its own front.

    See `mean_hypervolume_ratio` for the arguments, and what is raised.

    Returns
    -------
    float
        0 where every point of every front is reached; ``inf`` if an epoch has no points.

    References
    ----------
    Zhou, Jin and Zhang (2014), A population prediction strategy for evolutionary dynamic multiobjective optimization: the mean
    of the inverted generational distance over time.

    Examples
    --------
    >>> mean_igd_plus([[[10, 5]], [[12, 4]]], [[[10, 5]], [[12, 3]]])
    0.5
    """
    return float(np.mean([reference.igd_plus(points) for points, reference in _epochs(F, fronts)]))


def _epochs(F: Any, fronts: Any) -> list[tuple[np.ndarray, ReferenceFront]]:
    """Return points and front of each epoch, checked."""
    points = checks.items("F", F, "rows of numbers for each epoch")
    references = checks.items("fronts", fronts, "a front for each epoch")
    if not references or len(points) != len(references):
        raise GridPathError(
            f"F is of {counted(len(points), 'epoch')} and fronts of {len(references)}, expected as many of one as of the "
            "other, at least one"
        )
    return [_pair(one, front) for one, front in zip(points, references, strict=True)]


def _pair(F: Any, front: Any) -> tuple[np.ndarray, ReferenceFront]:
    """Return points and the front that they are measured against, checked."""
    expected = "rows of finite numbers, one an objective"
    points = checks.array("front", front, (None, None), expected=expected, finite=True).astype(float)
    if not points.size:
        raise GridPathError(f"front has shape {points.shape}, expected one point or more to measure against")
    if F is None:
        return np.empty((0, points.shape[1])), ReferenceFront(points)
    given = checks.array("F", F, expected=expected, finite=True).astype(float)
    # pymoo returns the objectives of a single solution as one row.
    given = given.reshape(1, -1) if given.ndim == 1 and given.size else given
    if not given.size:
        given = given.reshape(0, points.shape[1])
    if given.ndim != 2 or given.shape[1] != points.shape[1]:
        raise GridPathError(f"F has shape {given.shape}, expected rows of {points.shape[1]} numbers, as the front has")
    return given, ReferenceFront(points)


def merge_fronts(fronts: list[np.ndarray]) -> np.ndarray:
    """Return the non-dominated points of several fronts, each once, in lexicographic order.

    Values of an objective that differ by no more than `SAME` of its largest size count as equal: sums of the same cells
    in another order would otherwise make false points.

    Parameters
    ----------
    fronts : list of numpy.ndarray, each of shape (n, n_obj)
        At least one, which may be empty.

    Returns
    -------
    numpy.ndarray, shape (K, n_obj)
    """
    F = np.concatenate(fronts)
    if not len(F):
        return F
    equal = np.column_stack([_snap(column) for column in F.T])
    _, kept = np.unique(equal, axis=0, return_index=True)
    return F[kept[moocore.is_nondominated(equal[kept])]]


def _snap(values: np.ndarray) -> np.ndarray:
    """Return values of which those that follow one another closely are made equal to the least of them."""
    order = np.argsort(values, kind="stable")
    ascending = values[order]
    begins = np.diff(ascending, prepend=-np.inf) > SAME * np.abs(values).max()
    snapped = np.empty_like(values)
    snapped[order] = ascending[begins][np.cumsum(begins) - 1]
    return snapped


def _areas(F: np.ndarray, first: np.ndarray, last: np.ndarray, n_records: int, corner: np.ndarray) -> np.ndarray:
    """Return the areas dominated by the records' fronts of two objectives, all at once."""
    F = np.minimum(F, corner)
    order = np.argsort(F[:, 0], kind="stable")
    stays = last[order] - first[order] + 1
    point = np.repeat(order, stays)
    record = first[point] + np.arange(len(point)) - np.repeat(np.cumsum(stays) - stays, stays)
    # By record, and within each by the first objective: a front's second objective then falls from point to point.
    by_record = np.argsort(record, kind="stable")
    point, record = point[by_record], record[by_record]
    right = np.append(F[point[1:], 0], corner[0])
    right[np.append(record[1:] != record[:-1], True)] = corner[0]
    strips = (right - F[point, 0]) * (corner[1] - F[point, 1])
    return np.bincount(record, weights=strips, minlength=n_records)


def _volumes(F: np.ndarray, first: np.ndarray, last: np.ndarray, n_records: int, corner: np.ndarray) -> np.ndarray:
    """Return the hypervolumes dominated by the records' fronts; those that do not change are computed once."""
    changed = np.zeros(n_records + 1, dtype=bool)
    changed[0] = changed[first] = changed[last + 1] = True
    begins = np.flatnonzero(changed[:n_records])
    values = np.zeros(len(begins))
    for i, k in enumerate(begins):
        front = F[(first <= k) & (k <= last)]
        if len(front):
            values[i] = moocore.hypervolume(front, ref=corner)
    return np.repeat(values, np.diff(np.append(begins, n_records)))
