"""What a study asks of whatever carries out its runs."""

from __future__ import annotations

from concurrent.futures import Executor

from pymoo_gridpath.errors import GridPathError


class WorkerLost(RuntimeError):
    """What a future raises whose worker ended without an answer; what others do goes on."""


class StudyExecutor(Executor):
    """An executor that a study can ask how it is.

    Attributes
    ----------
    capacity : int
        Tasks worth keeping in flight.
    hopeless : tuple of exception types
        Errors of a future that mean that its task killed workers, so that it is not to be submitted again.
    """

    capacity: int = 1
    hopeless: tuple[type[BaseException], ...] = ()

    def check(self) -> None:
        """Raise a GridPathError if nothing in flight can finish any more. Called every few seconds."""

    def recover(self, error: BaseException) -> None:
        """Get ready to be given tasks again after an error that was none of the run's own, or raise a GridPathError."""
        raise GridPathError(f"the executor failed with {describe(error)}, expected the bytes of a run") from error

    def abort(self) -> None:
        """Give up what is in flight, without waiting."""


def describe(error: BaseException) -> str:
    """Return an error's type and message on one line."""
    text = " ".join(str(error).split())
    return f"{type(error).__name__}: {text}" if text else type(error).__name__
