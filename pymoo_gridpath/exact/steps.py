"""Searches that hand over what they have found on the way: generators of functions that return it, which few call.

What is handed over costs time only when it is asked for, and a search that nobody asks goes on as if it were one function.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from typing import TypeAlias, TypeVar

S = TypeVar("S")
T = TypeVar("T")

# Work is counted in cells that searches of the grid pass and labels that they take, each a fraction of a microsecond. What is
# handed over is worth this much, and so much a path and a cell of it: it is worth it after so many times as much work.
_WHOLE, _PATH, _CELL = 4000, 100, 0.5
_TIMES = 40

# And by which share all work has to have grown.
_GROWTH = 0.25

#: A search that yields functions, each to be called before it goes on, that return what it has found by then, and that
#: returns what it has found at last.
Steps: TypeAlias = Generator[Callable[[], T], None, S]


def last(steps: Steps[T, S]) -> S:
    """Carry a search out and return what it has found at last."""
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value


def mapped(steps: Steps[S, S], function: Callable[[S], T]) -> Steps[T, S]:
    """Hand over what a function makes of what a search does, and return what that has found at last."""
    while True:
        try:
            step = next(steps)
        except StopIteration as end:
            return end.value
        yield lambda step=step: function(step())


def handed_over(steps: Steps[T, T]) -> Iterator[tuple[T, bool]]:
    """Yield all that a search hands over, each with whether it is the last."""
    while True:
        try:
            step = next(steps)
        except StopIteration as end:
            yield end.value, True
            return
        yield step(), False


class Pace:
    """When to hand over, by the work that has been done: whatever the machine, so that the same search does it the same way.

    It takes no more than a few hundredths of the time.
    """

    def __init__(self):
        self._work = self._before = 0

    def due(self, work: int, n_paths: int, n_cells: int) -> bool:
        """Count so much work more, and return whether it is time to hand over so many paths of about so many cells."""
        self._work += work
        least = max(_TIMES * (_WHOLE + n_paths * (_PATH + _CELL * n_cells)), _GROWTH * self._before)
        if self._work - self._before < least:
            return False
        self._before = self._work
        return True
