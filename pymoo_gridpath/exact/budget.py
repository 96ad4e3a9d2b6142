"""How much an exact search may use, and what is used."""

from __future__ import annotations

import functools
import math
import os
import threading
from collections.abc import Callable
from dataclasses import dataclass

import psutil

from pymoo_gridpath import checks
from pymoo_gridpath.compiled import working_seconds

# Share of the free memory that a search may take by default; the rest is for its end, and for others.
_SHARE = 0.7

# Files that say what a container may have and has, and what of that it would give up; of cgroups v2 and v1.
_CGROUPS = (
    ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current", "/sys/fs/cgroup/memory.stat", b"inactive_file"),
    (
        "/sys/fs/cgroup/memory/memory.limit_in_bytes",
        "/sys/fs/cgroup/memory/memory.usage_in_bytes",
        "/sys/fs/cgroup/memory/memory.stat",
        b"total_inactive_file",
    ),
)

# So many are there, or nothing would run: to ask how many are free takes a good part of the time of a small search.
_FEW_BYTES = 2**23

# No machine has more bytes.
_MOST_MEMORY = 2**62

# Labels are numbered in 32 bits.
_MOST_LABELS = 2**31 - 2**20


def free_memory() -> int:
    """Return how many bytes can be taken without driving others out: what the machine, and its container, has left."""
    free = psutil.virtual_memory().available
    for limit, used, table, reclaimable in _CGROUPS:
        try:
            left = int(_read(limit)) - int(_read(used))
            # What files have left in memory counts as used, but is given up when it is needed.
            left += int(dict(line.split() for line in _read(table).splitlines())[reclaimable])
        except (OSError, ValueError, KeyError):  # not there, or "max"
            continue
        free = min(free, left)
    return max(int(free), 0)


def _read(path: str) -> bytes:
    # A small front takes a millisecond or two, of which opening files in more comfort is a part that shows.
    handle = os.open(path, os.O_RDONLY)
    try:
        return os.read(handle, 2**16)
    finally:
        os.close(handle)


@dataclass(frozen=True)
class Budget:
    """What an exact search may use before it ends with the part found.

    Attributes
    ----------
    max_seconds : float, optional
        Of wall time, without that of compiling kernels at their first use. Asked many times a second if kernels are compiled,
        else about once a second.
    max_labels : int, optional
        Labels open and closed at a time.
    max_memory : int, optional
        Bytes of the arrays of the search; by default 70 % of what the machine has free when it begins.
    watch : callable, optional
        Called now and then with the `Meter`, not always from the same thread; if it returns True, the search ends. It may give
        its reason as the meter's ``message``.

    Raises
    ------
    GridPathError
        If one of the numbers is none, or negative, or ``watch`` cannot be called.
    """

    max_seconds: float | None = None
    max_labels: int | None = None
    max_memory: int | None = None
    watch: Callable[[Meter], bool] | None = None

    def __post_init__(self):
        for name in ("max_seconds", "max_labels", "max_memory"):
            value = getattr(self, name)
            # A whole number larger than a float holds is a budget that is never used up.
            if value is not None and not (isinstance(value, int) and not isinstance(value, bool) and value > 2**63):
                checks.number(name, value, 0.0, infinite=True, expected="a number, zero or more")
        checks.function("watch", self.watch, "a function of one argument, the Meter", 1, optional=True)


class Meter:
    """Watch over a budget.

    Parameters
    ----------
    budget : Budget

    Attributes
    ----------
    message : str
        Which budget has been used up, in words; empty while there is some left.
    n_fixed : int
        Bytes of the arrays whose size is that of the grid; whoever makes them keeps it up to date.
    n_labels, n_bytes : int
        The most labels, and bytes for them, so far.
    """

    def __init__(self, budget: Budget):
        self.begin = working_seconds()
        self.seconds = math.inf if budget.max_seconds is None else budget.max_seconds
        self.labels = _MOST_LABELS if budget.max_labels is None else min(budget.max_labels, _MOST_LABELS)
        self._most_memory = budget.max_memory
        self.watch = budget.watch
        self.message = ""
        self.n_fixed = self.n_labels = self.n_bytes = 0
        self._asking = threading.RLock()

    @property
    def elapsed(self) -> float:
        """Seconds since the search began, without those of compiling."""
        return working_seconds() - self.begin

    @functools.cached_property
    def memory(self) -> float:
        """Bytes of all arrays of the search at most."""
        return _SHARE * free_memory() if self._most_memory is None else min(self._most_memory, _MOST_MEMORY)

    def has_room(self, n_bytes: float) -> bool:
        """Whether the search may take so many bytes, those of ``n_fixed`` among them."""
        return (self._most_memory is None and n_bytes < _FEW_BYTES) or n_bytes < self.memory

    def pops(self, n_labels: int, at_most: int) -> int:
        """Return how many labels may be popped before the next check; each opens up to eight others."""
        return int(max(1, min(at_most, (self.labels - n_labels) / 8)))

    def note(self, n_labels: int, n_bytes: int) -> None:
        """Keep the largest numbers of labels and bytes."""
        self.n_labels, self.n_bytes = max(self.n_labels, int(n_labels)), max(self.n_bytes, int(n_bytes))

    def check(self, n_labels: int = 0, n_bytes: int = 0) -> None:
        """Set `message` if a budget is used up."""
        self.note(n_labels, n_bytes)
        if self.stop():
            return
        if n_labels >= self.labels:
            self.message = f"the budget of {self.labels:,} labels is used up"
        elif not self.has_room(self.n_fixed + n_bytes):
            self.message = f"the memory budget of {self.memory / 2**20:.3g} MiB is used up"

    def stop(self) -> bool:
        """Set `message` if the time is used up or who watches wants an end; return whether it is set."""
        # Searches that go on side by side ask in turn.
        with self._asking:
            if self.message:
                return True
            if self.elapsed >= self.seconds:
                self.message = f"the time budget of {self.seconds:g} s is used up"
            elif self.watch is not None and self.watch(self):
                self.message = self.message or "stopped by who watched it"
        return bool(self.message)
