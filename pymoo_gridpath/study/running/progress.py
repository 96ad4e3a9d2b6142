"""A progress line across the runs of a study."""

from __future__ import annotations

import math
import time
from collections import defaultdict
from collections.abc import Hashable, Iterable, Mapping

from pymoo_gridpath.progress import Progress


class StudyProgress(Progress):
    """One line on standard error: how many runs are done and how long the rest will take; silent where that is no terminal.

    Parameters
    ----------
    left : iterable of hashable
        The kind of each run that is still to be done. Runs of one kind are expected to take equally long.
    stream : file, optional
        Standard error by default.
    """

    def __init__(self, left: Iterable[Hashable], stream=None):
        self._left: dict[Hashable, int] = defaultdict(int)
        for kind in left:
            self._left[kind] += 1
        self._seconds: dict[Hashable, list[float]] = defaultdict(list)
        self._n_failed = 0
        super().__init__(sum(self._left.values()), 1, stream)

    def done(self, kind: Hashable, seconds: float, failed: bool = False) -> None:
        """Count a run that has ended after so many seconds of its own."""
        self._left[kind] -= 1
        self._n_failed += failed
        if not failed:
            self._seconds[kind].append(seconds)
        self.show()

    def show(self) -> None:
        """Show how far the study is."""
        if not self._due():
            return
        n_left = sum(self._left.values())
        failed = f", {self._n_failed} failed" if self._n_failed else ""
        seconds = remaining_seconds(self._seconds, self._left, time.monotonic() - self._start)
        left = "" if seconds is None else f", about {duration(seconds)} left"
        self._write(f"run {self.n_runs - n_left}/{self.n_runs}{failed}{left}")


def remaining_seconds(spent: Mapping[Hashable, list[float]], left: Mapping[Hashable, int], elapsed: float) -> float | None:
    """Return how long the rest will take if it goes on like this, or None if nothing is done yet.

    A run is expected to take as long as those of its kind did on average, or as all did. How many are carried out at once, and
    what else takes time, shows in how many seconds of runs were done in the time elapsed.
    """
    every = [seconds for some in spent.values() for seconds in some]
    done = sum(every)
    if not done:
        return None
    overall = done / len(every)
    rest = sum(n * (sum(spent[kind]) / len(spent[kind]) if spent.get(kind) else overall) for kind, n in left.items())
    return elapsed * rest / done


def duration(seconds: float) -> str:
    """Return a time in words: whole seconds, minutes or hours, no less than it is, or days."""
    for limit, unit, name in ((100, 1, "s"), (100 * 60, 60, "min"), (48 * 3600, 3600, "h")):
        if seconds < limit:
            return f"{max(1, math.ceil(seconds / unit))} {name}"
    return f"{seconds / 86400:.1f} days"
