"""What carries out the runs of a study, beside `LocalProcesses`: this process, a Dask cluster, any other executor."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Executor, Future
from typing import Any

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.study.running.executor import StudyExecutor, describe

# Tasks kept in flight with an executor that does not say how many workers it has.
_UNKNOWN_CAPACITY = 64


class InProcess(StudyExecutor):
    """Carries out every task in this process when it is submitted."""

    def submit(self, fn: Callable, /, *args, **kwargs) -> Future:
        future: Future = Future()
        future.set_running_or_notify_cancel()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


class _Foreign(StudyExecutor):
    """An executor from elsewhere, used as it is; what it returns may be a job that is but asked, as those of submitit are."""

    def __init__(self, executor: Executor):
        self._executor = executor
        self._jobs: dict[Future, Any] = {}
        workers = getattr(executor, "_max_workers", None)
        self.capacity = 2 * workers if isinstance(workers, int) else _UNKNOWN_CAPACITY

    def submit(self, fn: Callable, /, *args, **kwargs) -> Future:
        job: Any = self._executor.submit(fn, *args, **kwargs)
        if isinstance(job, Future):
            return job
        future: Future = Future()
        self._jobs[future] = job
        return future

    def check(self) -> None:
        for future, job in list(self._jobs.items()):
            if job.done():
                del self._jobs[future]
                try:
                    future.set_result(job.result())
                except Exception as error:
                    future.set_exception(error)

    def recover(self, error: BaseException) -> None:
        if isinstance(error, BrokenExecutor):
            raise GridPathError(
                f"the executor broke ({describe(error)}), as when a worker was killed, expected one that works; what is stored "
                "is whole, and running again with a new executor goes on from there"
            ) from error


def dask_executor(address: str, timeout: float = 30.0) -> StudyExecutor:
    """Return an executor on an existing Dask cluster, once its workers have been checked.

    Parameters
    ----------
    address : str
        Of the scheduler: ``tcp://HOST:PORT``.
    timeout : float, default 30
        Seconds to wait for the scheduler, for a first worker, and for the answers of the workers. A study that has no
        worker for so long is given up.

    Returns
    -------
    StudyExecutor
        For the ``executor`` of `run_study`.

    Raises
    ------
    GridPathError
        If the package distributed is not installed here; if the scheduler does not answer or has no worker in time; if a worker
        cannot import this package, or has other versions of what decides about the results than this process.
    """
    checks.text("address", address)
    timeout = checks.number("timeout", timeout, 0.0, expected="seconds, zero or more")
    try:
        importlib.import_module("distributed")
    except ImportError as error:
        raise GridPathError(
            f"a Dask cluster needs the package distributed, which cannot be imported ({error}); "
            "pip install 'pymoo_gridpath[cluster]'"
        ) from None
    from pymoo_gridpath.study.running.dask_cluster import DaskExecutor

    return DaskExecutor(address, timeout)


def study_executor(executor: Executor | None) -> StudyExecutor:
    """Return an executor that a study can use for any that `run_study` is given."""
    if executor is None:
        return InProcess()
    return executor if isinstance(executor, StudyExecutor) else _Foreign(executor)
