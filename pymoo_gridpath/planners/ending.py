"""When the run of a planner ends."""

from __future__ import annotations

import math
import time
from typing import Any

from pymoo.core.termination import TerminateIfAny, Termination
from pymoo.termination.collection import TerminationCollection
from pymoo.termination.max_time import TimeBasedTermination


class UntilPlanned(Termination):
    """Until a planner has planned.

    Parameters
    ----------
    given : pymoo.core.termination.Termination
        What the run was given. Of this a time alone counts, for planners that heed it, see `seconds_left`.
    """

    def __init__(self, given: Termination):
        super().__init__()
        self.given = given

    def _update(self, algorithm) -> float:
        return 0.0

    def seconds_left(self, algorithm: Any) -> float | None:
        """Return how many seconds of a time that was given are left, None if none was."""
        left = _seconds(self.given) - (time.time() - (algorithm.start_time or time.time()))
        return None if math.isinf(left) else max(left, 0.0)


def _seconds(given: Any) -> float:
    if isinstance(given, TimeBasedTermination):
        return float(given.max_time)
    # What ends with the first of several; pymoo has two such.
    if isinstance(given, TerminateIfAny | TerminationCollection):
        several = given.criteria if isinstance(given, TerminateIfAny) else given.terminations
        return min(map(_seconds, several), default=math.inf)
    return math.inf
