"""What the searches for two and for three objectives share: their labels, in arrays that grow, and the paths that these hold.

A label is a path from the start to a cell. A kernel takes open labels from a heap, in ascending order of the costs that their
whole path will have at least, closes those that are not dominated, and opens what one step more makes of them. It returns when
none is left, an array is full, or the budget is to be looked at.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import ClassVar, NamedTuple

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.exact.budget import Meter
from pymoo_gridpath.exact.costs import Costs
from pymoo_gridpath.exact.nearness import Certificate
from pymoo_gridpath.exact.tie_break import smoothest_paths, traced_paths
from pymoo_gridpath.search import Moves

# Why a kernel returned.
DONE, HEAP_FULL, CLOSED_FULL, FOUND_FULL, LISTS_FULL, JOINED_FULL, PAUSED = range(7)

# Places in the array of counts; a search may have more of its own.
N_OPEN, N_CLOSED, N_FOUND, N_POPPED = range(4)

# By how much arrays grow that are larger than so many bytes.
_GROWTH, _LARGE = 1.25, 2**22


class Front(NamedTuple):
    """Non-dominated paths in ascending order of the first objective.

    Attributes
    ----------
    paths : list of numpy.ndarray
        Indices of the cells of each, from the start to the goal.
    points : numpy.ndarray of int64, shape (N, k)
        Their costs, without that of the start cell.
    certified : Certificate, optional
        How near they are proven to come to the front.
    """

    paths: list[np.ndarray]
    points: np.ndarray
    certified: Certificate | None = None


class LabelSearch(ABC):
    """The labels of one search, in arrays that grow between calls of its kernel.

    Attributes
    ----------
    heap : numpy.ndarray of int64, shape (n, n_keys + 1)
        Open labels: keys, and what `load_of` returns.
    closed : numpy.ndarray of int32, shape (n, 2)
        Closed labels: cell and number of the parent, -1 for the first, the start.
    found : numpy.ndarray of int64, shape (n, 1 + k)
        Numbers of the closed labels that are non-dominated paths, and their costs.
    counts : numpy.ndarray of int64, shape (n_counts,)
    growing : dict of int to str
        The array that grows when the kernel returns the number.
    pops_at_a_time : int
        How many labels are taken from the heap between two looks at the budget.
    """

    growing: ClassVar[dict[int, str]] = {HEAP_FULL: "heap", CLOSED_FULL: "closed", FOUND_FULL: "found"}
    pops_at_a_time: int

    def __init__(self, moves: Moves, costs: Costs, start: int, goal: int, n_keys: int, n_counts: int = 4):
        self.moves, self.costs, self.start, self.goal = moves, costs, start, goal
        self.heap = np.empty((1024, n_keys + 1), dtype=np.int64)
        self.closed = np.empty((1024, 2), dtype=np.int32)
        self.found = np.empty((64, 1 + len(costs.step)), dtype=np.int64)
        self.counts = np.zeros(n_counts, dtype=np.int64)

    def begin(self) -> None:
        """Close the start and open the labels of the first steps."""
        self.closed[0] = (self.start, -1)
        self.counts[N_CLOSED] = 1
        for m in range(8):
            if self.moves.legal[self.start] >> m & 1:
                cell = self.start + int(self.moves.offsets[m])
                self.counts[N_OPEN] += self.open_first(cell, m, 8 * cell + m if self.costs.with_heading else cell)

    @abstractmethod
    def open_first(self, cell: int, heading: int, state: int) -> bool:
        """Open the label of a first step to a cell, and return True, or False if the goal cannot be reached from there."""

    @abstractmethod
    def search(self, max_pops: int) -> int:
        """Call the kernel and return why it returned."""

    def run(self, meter: Meter) -> None:
        """Search until no label is left or a budget is used up."""
        for _ in self.steps(meter):
            pass

    def steps(self, meter: Meter) -> Iterator[int]:
        """Search as `run` does, and yield now and then how many labels have been taken from the heap since the last time."""
        status, before = PAUSED, 0
        while status != DONE:
            meter.check(self.n_labels, self.nbytes)
            if meter.message:
                return
            status = self.search(meter.pops(self.n_labels, self.pops_at_a_time))
            meter.note(self.n_labels, self.nbytes)
            if status in self.growing:
                _grow(getattr(self, self.growing[status]))
            popped = int(self.counts[N_POPPED])
            yield popped - before
            before = popped

    @property
    def n_labels(self) -> int:
        """Labels open and closed."""
        return int(self.counts[N_OPEN] + self.counts[N_CLOSED])

    @property
    def nbytes(self) -> int:
        """Bytes of the arrays that grow with the labels."""
        return sum(getattr(self, name).nbytes for name in self.growing.values())

    def points(self) -> np.ndarray:
        """Return the costs of the paths found, int64, shape (N, k)."""
        return self.found[: self.counts[N_FOUND], 1:].copy()

    def paths(self) -> list[np.ndarray]:
        """Return the cells of the paths found."""
        return traced_paths(self.closed, self.found[: self.counts[N_FOUND], 0])

    def smoothest_paths(self, meter: Meter) -> list[np.ndarray]:
        """Return the cells of the paths found, or of better ones with the same costs."""
        for name in self.growing.values():
            if name not in ("closed", "found"):
                # What the search alone needed has served.
                setattr(self, name, getattr(self, name)[:0].copy())
        closed, ends = self.closed[: self.counts[N_CLOSED]], self.found[: self.counts[N_FOUND], 0]
        return smoothest_paths(self.moves, self.costs, closed, ends, meter)


def _grow(array: np.ndarray) -> None:
    """Give an array twice as many rows, or a quarter more if it is large, without a copy beside it where the system can."""
    rows = 2 * len(array) if array.nbytes < _LARGE else int(len(array) * _GROWTH)
    array.resize((rows, *array.shape[1:]), refcheck=False)


@kernel
def full(n, n_closed, n_found, heap, closed, found):
    """Return which array has no room for what one label more may bring, or `DONE` if all have."""
    if n + 8 > len(heap):
        return HEAP_FULL
    if n_closed >= len(closed):
        return CLOSED_FULL
    if n_found >= len(found):
        return FOUND_FULL
    return DONE


@kernel
def load_of(cell, heading, parent):
    """Return what the heap keeps of a label besides its keys: its cell, the heading that it came along, and its parent."""
    return (8 * cell + heading) << 32 | parent


@kernel
def close(closed, n_closed, load):
    """Write the cell and the parent of a label to the closed ones."""
    closed[n_closed, 0] = load >> 35
    closed[n_closed, 1] = load & 0xFFFFFFFF


@kernel
def is_detour(direct, heading, m, from_before):
    """Whether a step along m, after one along a heading, leads where the cell before leads straight at no higher cost.

    ``direct`` is that of `Costs`, and ``from_before`` holds the legal steps from the cell before.
    """
    straight = direct[heading, m]
    return straight == 8 or (straight >= 0 and ((from_before >> straight) & 1) != 0)
