"""An existing Dask cluster as an executor of studies."""

from __future__ import annotations

import contextlib
import json
import logging
import pickle
import re
import socket
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.study.running.executor import StudyExecutor, describe
from pymoo_gridpath.versions import versions

# Both are expressions for `eval`, so that neither scheduler nor workers need this package to read them: a scheduler never does,
# and a worker that lacks it can say so.
_CALL = "(lambda call: call[0](*call[1]))(__import__('pickle').loads(payload))"
_REPORT = """
import importlib.metadata, json
def version(package):
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "none"
try:
    import pymoo_gridpath.study.running.execute
    trouble = None
except Exception as error:
    trouble = f"{type(error).__name__}: {error}"
found = json.dumps({"trouble": trouble, "versions": {package: version(package) for package in packages}})
"""
# Seconds between two looks at how many workers there are.
_INTERVAL = 2.0


class DaskExecutor(StudyExecutor):
    """The workers of an existing Dask cluster; see `pymoo_gridpath.study.running.executors.dask_executor`."""

    def __init__(self, address: str, timeout: float = 30.0):
        from distributed import KilledWorker

        self.hopeless = (KilledWorker,)
        self.address = address
        self.timeout = timeout
        # Its tracebacks of lost connections say no more than the sentences here.
        self._loggers = {logger: logger.level for logger in map(logging.getLogger, ("distributed.client", "distributed.core"))}
        for logger in self._loggers:
            logger.setLevel(logging.CRITICAL)
        try:
            self._client = self._connected()
        except BaseException:
            self._restore_loggers()
            raise
        try:
            self._await_worker()
            self.check_workers()
        except BaseException:
            self.shutdown(wait=False)
            raise
        self._executor = self._client.get_executor(pure=False)

    def submit(self, fn: Callable, /, *args, **kwargs) -> Future:
        payload = pickle.dumps((fn, args))
        return self._executor.submit(eval, _CALL, {"payload": payload}, **kwargs)

    def check(self) -> None:
        if self._client.status != "running":
            raise GridPathError(f"the connection to the Dask scheduler at {self.address} was lost, expected it to stay")
        now = time.monotonic()
        if now - self._looked < _INTERVAL:
            return
        self._looked = now
        threads = self._ask(self._client.nthreads)
        if threads.keys() - self._checked:
            # Some have joined since.
            self.check_workers()
        if threads:
            self.capacity, self._last_worker = 2 * sum(threads.values()), now
        elif now - self._last_worker > self.timeout:
            raise GridPathError(
                f"the Dask cluster at {self.address} has had no worker for {self.timeout:g} s, expected at least one; "
                f"start one with: dask worker {self.address} --nthreads 1"
            )

    def recover(self, error: BaseException) -> None:
        self._looked = 0.0
        self.check()
        self.check_workers()

    def abort(self) -> None:
        self.shutdown(wait=False)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        with contextlib.suppress(Exception):
            self._client.close(timeout=5 if wait else 1)
        self._restore_loggers()

    def check_workers(self) -> None:
        """Raise a GridPathError that names a worker which cannot import this package, or how its versions differ."""
        packages = [package for package in versions() if package != "python"]
        report = f"(lambda names: (exec({_REPORT!r}, names), names['found'])[1])({{'packages': {packages!r}}})"
        answers = self._ask(self._client.run, eval, report, on_error="return")
        self._checked = set(answers)
        for worker, answer in answers.items():
            if isinstance(answer, OSError):
                # The connection: it ended while it was asked, and what it worked on goes to others.
                continue
            if isinstance(answer, BaseException):
                raise GridPathError(f"the Dask worker {worker} cannot say what it has installed: {describe(answer)}")
            found = json.loads(answer)
            if found["trouble"]:
                raise GridPathError(
                    f"the Dask worker {worker} cannot import pymoo_gridpath ({found['trouble']}); install it there, in the "
                    f"version {versions()['pymoo_gridpath']}"
                )
            for package in packages:
                here, there = versions()[package], found["versions"][package]
                # Compiled or not, kernels give the same bits, but not in the same time; which numba it is matters little.
                if (here == "none") != (there == "none") if package == "numba" else here != there:
                    raise GridPathError(f"the Dask worker {worker} has {package} {there}, expected {here}, as in this process")

    # -- parts ------------------------------------------------------------------------------------------------------------

    def _connected(self) -> Any:
        from distributed import Client

        trouble = f"no Dask scheduler answers at {self.address} within {self.timeout:g} s"
        address = re.fullmatch(r"(tcp|tls|ucx|wss?)://(\[[^]]+\]|[^/:]+):(\d+)/?", self.address)
        if address is None:
            raise GridPathError(f"{checks.shown(self.address)} is no address of a Dask scheduler, expected tcp://HOST:PORT")
        try:
            if address[1] == "tcp":
                # A client that finds nobody goes on trying, and ends with a traceback when it is cleared away.
                socket.create_connection((address[2].strip("[]"), int(address[3])), self.timeout).close()
            return self._within(lambda: Client(self.address, timeout=self.timeout, set_as_default=False))
        except TimeoutError:
            raise GridPathError(f"{trouble}, expected tcp://HOST:PORT of one that runs") from None
        except Exception as error:
            raise GridPathError(f"{trouble} ({describe(error)}), expected tcp://HOST:PORT of one that runs") from None

    def _await_worker(self) -> None:
        self._looked, self._last_worker = 0.0, time.monotonic()
        while True:
            threads = sum(self._ask(self._client.nthreads).values())
            if threads:
                self.capacity, self._last_worker = 2 * threads, time.monotonic()
                return
            if time.monotonic() - self._last_worker > self.timeout:
                raise GridPathError(
                    f"the Dask scheduler at {self.address} has no worker after {self.timeout:g} s, expected at least one; "
                    f"start one with: dask worker {self.address} --nthreads 1"
                )
            time.sleep(0.1)

    def _ask(self, question: Callable, *args, **kwargs):
        """Return what the cluster answers, or raise a GridPathError."""
        try:
            return self._within(lambda: question(*args, **kwargs))
        except Exception as error:
            raise GridPathError(
                f"the Dask cluster at {self.address} did not answer within {self.timeout:g} s ({describe(error)})"
            ) from None

    def _within(self, function: Callable):
        """Call a function that might wait for ever, for a little longer than the time it should take."""
        future: Future = Future()

        def call():
            try:
                future.set_result(function())
            except BaseException as error:
                future.set_exception(error)

        # A daemon, so that it does not keep the process from ending.
        threading.Thread(target=call, daemon=True).start()
        return future.result(self.timeout + 5)

    def _restore_loggers(self) -> None:
        for logger, level in self._loggers.items():
            logger.setLevel(level)
