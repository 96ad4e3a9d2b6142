"""How much an exact search may use, and what is used."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import psutil

# Share of the free memory that a search may take by default; the rest is for its end, and for others.
_SHARE = 0.7


def free_memory() -> int:
    """Return how many bytes can be taken without driving others out: what the machine, and its container, has left."""
    free = psutil.virtual_memory().available
    root = Path("/sys/fs/cgroup")
    for limit, used in (("memory.max", "memory.current"), ("memory/memory.limit_in_bytes", "memory/memory.usage_in_bytes")):
        try:
            free = min(free, int((root / limit).read_text()) - int((root / used).read_text()))
        except (OSError, ValueError):  # not there, or "max"
            continue
    return max(int(free), 0)


@dataclass(frozen=True)
class Budget:
    """What an exact search may use before it ends with the part found.

    Attributes
    ----------
    seconds : float, optional
    labels : int, optional
        Labels open and closed at a time.
    memory : int, optional
        Bytes that labels take; by default 70 % of what the machine has free when the search begins.
    watch : callable, optional
        Called now and then with the `Meter`; if it returns True, the search ends.
    """

    seconds: float | None = None
    labels: int | None = None
    memory: int | None = None
    watch: Callable[[Meter], bool] | None = None


class Meter:
    """Watch over a budget.

    Parameters
    ----------
    budget : Budget

    Attributes
    ----------
    message : str
        Which budget has been used up, in words; empty while there is some left.
    n_labels, n_bytes : int
        The most labels, and bytes for them, so far.
    """

    def __init__(self, budget: Budget):
        self.begin = time.perf_counter()
        self.seconds = math.inf if budget.seconds is None else budget.seconds
        self.labels = math.inf if budget.labels is None else budget.labels
        self.memory = _SHARE * free_memory() if budget.memory is None else budget.memory
        self.watch = budget.watch
        self.message = ""
        self.n_labels = self.n_bytes = 0

    @property
    def elapsed(self) -> float:
        """Seconds since the search began."""
        return time.perf_counter() - self.begin

    def pops(self, n_labels: int, at_most: int) -> int:
        """Return how many labels may be popped before the next check; each opens up to eight others."""
        return int(max(1, min(at_most, (self.labels - n_labels) / 8)))

    def note(self, n_labels: int, n_bytes: int) -> None:
        """Keep the largest numbers of labels and bytes."""
        self.n_labels, self.n_bytes = max(self.n_labels, int(n_labels)), max(self.n_bytes, int(n_bytes))

    def check(self, n_labels: int, n_bytes: int) -> None:
        """Set `message` if a budget is used up."""
        self.note(n_labels, n_bytes)
        if self.elapsed >= self.seconds:
            self.message = f"the time budget of {self.seconds:g} s is used up"
        elif n_labels >= self.labels:
            self.message = f"the budget of {self.labels:,} labels is used up"
        elif n_bytes >= self.memory:
            self.message = f"the memory budget of {self.memory / 2**20:.3g} MiB is used up"
        elif self.watch is not None and self.watch(self):
            self.message = "stopped by who watched it"
