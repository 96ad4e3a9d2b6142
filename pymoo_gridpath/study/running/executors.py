"""What carries out the runs of a study: this process, local processes, a Dask cluster, or any `concurrent.futures` executor."""

from __future__ import annotations

import contextlib
import importlib
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor
from multiprocessing.connection import wait as wait_for_any
from typing import Any

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.study.running.executor import StudyExecutor, describe

# What numpy's and scipy's libraries and numba read when they are loaded.
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS", "NUMBA_NUM_THREADS")
# How often processes are started that end before they have done anything.
_STARTS = 3
# Tasks kept in flight with an executor that does not say how many workers it has.
_UNKNOWN_CAPACITY = 64

# No computer has use for more.
_MOST_PROCESSES = 61 if os.name == "nt" else 4096  # Windows waits for no more than 63 things at once


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


class LocalProcesses(StudyExecutor):
    """Processes on this computer, started with the first task.

    They are started anew when one of them dies, end by themselves when this process does, leave Ctrl-C to it, and use one
    thread each for linear algebra, unless the environment says otherwise.

    Parameters
    ----------
    n_processes : int

    Raises
    ------
    GridPathError
        If n_processes is less than one; on submission, if the processes cannot be started.

    Notes
    -----
    Processes are spawned, so a script that uses them needs ``if __name__ == "__main__":`` around what it does.
    """

    def __init__(self, n_processes: int):
        self.n_processes = n_processes = checks.whole("the number of processes", n_processes, 1, _MOST_PROCESSES)
        # One more each, so that none waits for the coordinator.
        self.capacity = 2 * n_processes
        self._pool: ProcessPoolExecutor | None = None
        self._workers: list = []
        self._has_worked = False

    def submit(self, fn: Callable, /, *args, **kwargs) -> Future:
        """Have a function called in one of the processes, and return the future of what it returns."""
        if self._pool is None:
            self._pool = self._started()
        return self._pool.submit(fn, *args, **kwargs)

    def recover(self, error: BaseException) -> None:
        checks.instance("error", error, BaseException)
        if not isinstance(error, BrokenExecutor):
            super().recover(error)
        self.abort()

    def abort(self) -> None:
        pool, self._pool = self._pool, None
        for worker in self._workers:
            worker.kill()
        if pool is not None:
            pool.shutdown(wait=False, cancel_futures=True)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the processes, by default once they have done what was submitted."""
        if self._pool is not None:
            self._pool.shutdown(wait, cancel_futures=cancel_futures)

    def _started(self) -> ProcessPoolExecutor:
        for _ in range(_STARTS):
            pool, codes = self._start()
            if pool is not None:
                self._has_worked = True
                return pool
            # Python itself ends a process with this code if the script has no guard; one that is killed has another.
            if 1 in codes and not self._has_worked:
                raise GridPathError(
                    "the local processes ended as soon as they were started; a script that runs a study in processes needs "
                    "if __name__ == '__main__': around what it does"
                )
        ends = ", ".join(sorted({f"signal {-code}" if code < 0 else f"code {code}" for code in codes})) or "no code"
        raise GridPathError(
            f"the local processes ended as soon as they were started, {_STARTS} times (by {ends}), as when memory runs out or "
            "something kills them; what is stored is whole, and running again goes on from there"
        )

    def _start(self) -> tuple[ProcessPoolExecutor | None, list[int]]:
        """Return processes that work, or None and the exit codes of those that have ended at once."""
        pool = ProcessPoolExecutor(self.n_processes, multiprocessing.get_context("spawn"), _begin_worker)
        others = set(multiprocessing.active_children())
        self._workers = []
        try:
            with _environment_of_workers():
                try:
                    # A process is started with each of them.
                    probes = [pool.submit(os.getpid) for _ in range(self.n_processes)]
                finally:
                    self._workers = [child for child in multiprocessing.active_children() if child not in others]
            for probe in probes:
                probe.result()
        except BrokenExecutor:
            # It ends the others, and waits for all.
            pool.shutdown(wait=True)
            return None, [worker.exitcode for worker in self._workers if worker.exitcode is not None]
        except BaseException:  # such as Ctrl-C
            for worker in self._workers:
                worker.kill()
            pool.shutdown(wait=False)
            raise
        return pool, []


@contextlib.contextmanager
def _environment_of_workers() -> Iterator[None]:
    """While open, processes that are started inherit one thread for linear algebra, and no ear for Ctrl-C."""
    added = [name for name in _THREADS if name not in os.environ]
    os.environ.update(dict.fromkeys(added, "1"))
    main = threading.current_thread() is threading.main_thread()
    handler = signal.signal(signal.SIGINT, signal.SIG_IGN) if main else None
    try:
        yield
    finally:
        if main:
            signal.signal(signal.SIGINT, handler or signal.default_int_handler)
        for name in added:
            os.environ.pop(name, None)


def _begin_worker() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    # What every run needs, so that the first takes no longer than others.
    importlib.import_module("pymoo_gridpath.study.running.execute")


def _end_with_parent() -> None:
    """End this process when the one that started it is gone: killed, it cannot say so, and this one would wait for ever."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait_for_any([parent.sentinel])
        os._exit(1)


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
