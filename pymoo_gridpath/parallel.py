"""Work carried out by an executor of ``concurrent.futures``, with the results in the order of the tasks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor
from typing import Any

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError


def check_executor(executor: Any) -> None:
    """Refuse what is no executor; None is carried out here."""
    if executor is not None:
        checks.function("executor", getattr(executor, "submit", executor), "an Executor of concurrent.futures", 2)


def carried_out(executor: Any, what: str, function: Callable, tasks: Sequence[tuple]) -> Iterator[Any]:
    """Yield what a function returns for each task, its arguments, in their order.

    Parameters
    ----------
    executor : concurrent.futures.Executor
        It is left open. If one task fails, or whoever iterates stops, those that have not begun are cancelled.
    what : str
        What a task is called in messages.
    function : callable
        A function of a module, so that other processes find it by its name.
    tasks : sequence of tuple

    Raises
    ------
    GridPathError
        If a task or its result cannot be sent to another process, or the executor has broken down.
    """
    futures = [executor.submit(function, *task) for task in tasks]
    try:
        for k, future in enumerate(futures):
            try:
                yield future.result()
            except BrokenExecutor as error:
                raise GridPathError(f"{what} {k} came to no end, since the executor broke down: {error}") from None
            except Exception as error:
                # Which class it has depends on what it is that cannot be pickled.
                if "pickle" not in str(error):
                    raise
                raise GridPathError(
                    f"{what} {k} could not be sent to another process, or its result not back: {error}; expected what can be "
                    f"pickled, or an executor of threads"
                ) from None
    finally:
        for future in futures:
            future.cancel()
