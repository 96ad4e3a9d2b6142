"""Processes on this computer as an executor of studies, each with a pipe of its own."""

from __future__ import annotations

import atexit
import contextlib
import importlib
import multiprocessing
import os
import pickle
import queue
import signal
import threading
import traceback
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from multiprocessing.connection import Connection, wait
from typing import Any

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.study.running.executor import StudyExecutor, WorkerLost

# What numpy's and scipy's libraries and numba read when they are loaded.
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS", "NUMBA_NUM_THREADS")
# How often a process is started that ends before it has done anything.
_STARTS = 3
# No computer has use for more.
_MOST_PROCESSES = 4096
# Seconds that a process that was told to end, or has ended, is waited for.
_PATIENCE = 5.0
# Processes inherit the environment: one thread at a time changes it.
_starting = threading.Lock()


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

    Each process has a pipe of its own, and nothing is shared by two of them: the pools of Python and loky, which have one
    queue of results for all, wait for ever if a process is killed while it writes to it.
    """

    def __init__(self, n_processes: int):
        self.n_processes = n_processes = checks.whole("the number of processes", n_processes, 1, _MOST_PROCESSES)
        # One more each, so that none waits for the coordinator.
        self.capacity = 2 * n_processes
        self._crew: _Crew | None = None

    def submit(self, fn: Callable, /, *args, **kwargs) -> Future:
        """Have a function called in one of the processes, and return the future of what it returns.

        The future raises `WorkerLost` if the process ends meanwhile; other tasks do not suffer.
        """
        if self._crew is None:
            self._crew = _Crew(self.n_processes)
            # Python waits at its end for processes that nobody has ended.
            atexit.register(self.abort)
        return self._crew.submit((fn, args, kwargs))

    def recover(self, error: BaseException) -> None:
        checks.instance("error", error, BaseException)
        if isinstance(error, GridPathError):
            raise error
        if not isinstance(error, WorkerLost):
            super().recover(error)

    def abort(self) -> None:
        if (crew := self._dismissed()) is not None:
            crew.abort()

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the processes, by default once they have done what was submitted."""
        if (crew := self._dismissed()) is not None:
            crew.shutdown(wait, cancel_futures)

    def _dismissed(self) -> _Crew | None:
        atexit.unregister(self.abort)
        crew, self._crew = self._crew, None
        return crew


class _Crew:
    """Processes that take tasks from one queue of this process, by a thread each."""

    def __init__(self, n_processes: int):
        self._tasks: queue.SimpleQueue = queue.SimpleQueue()
        self._ended = False
        self._has_worked = False
        self._workers: list[_Worker | None] = [None] * n_processes
        try:
            begun = [_begin() for _ in range(n_processes)]
            for number, worker in enumerate(begun):
                self._workers[number] = worker
            for number in range(n_processes):
                self._ensure(number)
        except BaseException:  # such as Ctrl-C
            self.abort()
            raise
        self._threads = [threading.Thread(target=self._serve, args=(number,), daemon=True) for number in range(n_processes)]
        for thread in self._threads:
            thread.start()

    def submit(self, call: tuple) -> Future:
        future: Future = Future()
        self._tasks.put((future, call))
        return future

    def abort(self) -> None:
        self._ended = True
        self._cancel()
        for worker in self._workers:
            if worker is not None:
                worker.process.kill()
        self._dismiss()

    def shutdown(self, wait: bool, cancel_futures: bool) -> None:
        if cancel_futures:
            self._cancel()
        self._dismiss()
        if wait:
            for thread in self._threads:
                thread.join()

    def _cancel(self) -> None:
        with contextlib.suppress(queue.Empty):
            while True:
                task = self._tasks.get_nowait()
                if task is not None:
                    task[0].cancel()

    def _dismiss(self) -> None:
        for _ in self._workers:
            self._tasks.put(None)

    def _serve(self, number: int) -> None:
        """Hand tasks to a process until there are none to come."""
        while (task := self._tasks.get()) is not None:
            future, call = task
            if not future.set_running_or_notify_cancel():
                continue
            try:
                message = pickle.dumps(call, pickle.HIGHEST_PROTOCOL)
                succeeded, result = self._ensure(number).ask(message)
            except BaseException as error:
                future.set_exception(error)
                continue
            if succeeded:
                future.set_result(result)
            else:
                future.set_exception(result)
        worker = self._workers[number]
        if worker is not None:
            worker.end()

    def _ensure(self, number: int) -> _Worker:
        """Return a process that works, or raise a GridPathError if none can be started."""
        ends: set[str] = set()
        for _ in range(_STARTS):
            worker = self._workers[number]
            if self._ended:
                break
            if worker is None:
                worker = self._workers[number] = _begin()
            if worker is not None and worker.is_ready():
                self._has_worked = True
                return worker
            self._workers[number] = None
            if worker is None:
                continue
            # Python itself ends a process with this code if the script has no guard; one that is killed has another.
            if worker.exit_code() == 1 and not self._has_worked:
                raise GridPathError(
                    "the local processes ended as soon as they were started; a script that runs a study in processes needs "
                    "if __name__ == '__main__': around what it does"
                )
            ends.add(worker.end_of_it())
        raise GridPathError(
            f"the local processes ended as soon as they were started, {_STARTS} times (by "
            f"{', '.join(sorted(ends)) or 'no code'}), as when memory runs out or something kills them; what is stored is "
            "whole, and running again goes on from there"
        )


class _Worker:
    """A process, and this end of its pipe."""

    def __init__(self):
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        # No daemon, since that could not start processes of its own.
        self.process = context.Process(target=_work, args=(theirs,))
        self._ready = False
        try:
            with _environment_of_workers():
                self._start()
        except BaseException:
            self._pipe.close()
            raise
        finally:
            # Theirs is now open in the process alone: that it ends is seen here, whatever it was doing.
            theirs.close()

    def _start(self) -> None:
        self.process.start()

    def is_ready(self) -> bool:
        """Wait until it has started, and return whether it lives; one that once worked is asked when it is given a task."""
        if not self._ready:
            try:
                self._pipe.recv_bytes()
            except (EOFError, OSError):
                return False
            self._ready = True
        return self.process.is_alive()

    def ask(self, message: bytes) -> tuple[bool, Any]:
        """Return whether the call that a message holds succeeded, and its result or what it raised."""
        try:
            self._pipe.send_bytes(message)
            answer = self._pipe.recv_bytes()
        except (EOFError, OSError):
            raise WorkerLost(f"a local process ended by {self.end_of_it()}") from None
        return pickle.loads(answer)

    def end(self) -> None:
        self._pipe.close()
        if self.exit_code() is None:
            self.process.kill()

    def exit_code(self) -> int | None:
        self.process.join(_PATIENCE)
        return self.process.exitcode

    def end_of_it(self) -> str:
        code = self.exit_code()
        if code is None:  # it closed its pipe and goes on
            self.process.kill()
            return "no code"
        return f"signal {-code}" if code < 0 else f"code {code}"


def _begin() -> _Worker | None:
    """Start a process and do not wait for it; None if it ended while it was handed what it needs, or cannot be started."""
    try:
        return _Worker()
    except OSError:
        return None


@contextlib.contextmanager
def _environment_of_workers() -> Iterator[None]:
    """While open, processes that are started inherit one thread for linear algebra, and no ear for Ctrl-C."""
    with _starting:
        added = [name for name in _THREADS if name not in os.environ]
        os.environ.update(dict.fromkeys(added, "1"))
        mask: Any = getattr(signal, "pthread_sigmask", None)  # Windows has none
        before = mask(signal.SIG_BLOCK, {signal.SIGINT}) if mask else None
        try:
            yield
        finally:
            if mask:
                mask(signal.SIG_SETMASK, before)
            for name in added:
                os.environ.pop(name, None)


# -- in the process -----------------------------------------------------------------------------------------------------


def _work(pipe: Connection) -> None:
    """Answer calls until the other end of the pipe is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    # What every run needs, so that the first takes no longer than others.
    importlib.import_module("pymoo_gridpath.study.running.execute")
    with contextlib.suppress(EOFError, OSError):
        pipe.send_bytes(b"ready")
        while True:
            pipe.send_bytes(_answer(pipe.recv_bytes()))


def _answer(message: bytes) -> bytes:
    try:
        fn, args, kwargs = pickle.loads(message)
        return pickle.dumps((True, fn(*args, **kwargs)), pickle.HIGHEST_PROTOCOL)
    except Exception as error:
        error.add_note(f"in a local process:\n{traceback.format_exc()}")
        return _picklable(error)


def _picklable(error: Exception) -> bytes:
    try:
        answer = pickle.dumps((False, error), pickle.HIGHEST_PROTOCOL)
        pickle.loads(answer)
        return answer
    except Exception:
        return pickle.dumps((False, RuntimeError(f"{type(error).__name__}: {error}")), pickle.HIGHEST_PROTOCOL)


def _end_with_parent() -> None:
    """End this process when the one that started it is gone: killed, it cannot say so."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)
