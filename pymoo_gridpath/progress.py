"""What is said on the terminal while work goes on."""

from __future__ import annotations

import contextlib
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from typing import Any

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError, visible

#: What `say_that_it_compiles` says.
COMPILING = "compiling the search for this machine, about 20 s the first time"


def say_that_it_compiles() -> None:
    """Say why nothing happens yet."""
    _line(COMPILING)


def say(message: object) -> None:
    """Say something about the work on standard error, in one line that names the program."""
    _line(f"pymoo-gridpath: {visible(message)}")


@contextlib.contextmanager
def warnings_as_lines() -> Iterator[None]:
    """While open, show warnings about what the user gave as one line each, in place of Python's two with a line of code."""

    def show(message, category, filename, lineno, file=None, line=None):
        if issubclass(category, UserWarning):
            say(f"warning: {message}")
        else:
            shown(message, category, filename, lineno, file, line)

    with warnings.catch_warnings():
        shown, warnings.showwarning = warnings.showwarning, show
        yield


def _line(text: str) -> None:
    """Write a line on standard error, in the place of a progress line if one is shown."""
    # Programs without a console have none, and whoever reads it may have gone.
    if sys.stderr is not None:
        with contextlib.suppress(OSError):
            print(("\r\x1b[K" if sys.stderr.isatty() else "") + text, file=sys.stderr, flush=True)


class Progress:
    """One line on standard error that shows how far the runs have come; silent where that is no terminal.

    Parameters
    ----------
    n_runs, n_gen : int
        Number of runs, and of generations in each.
    stream : file, optional
        Standard error by default.
    interval : float, default 0.1
        Least seconds between two updates.
    """

    def __init__(self, n_runs: int, n_gen: int, stream=None, interval: float = 0.1):
        self.n_runs = checks.whole("n_runs", n_runs, 0)
        self.n_gen = checks.whole("n_gen", n_gen, 1)
        self.stream = sys.stderr if stream is None else stream
        if not all(hasattr(self.stream, method) for method in ("write", "flush", "isatty")):
            raise GridPathError(f"stream is {checks.shown(stream)}, expected a file to write text to")
        self.interval = checks.number("interval", interval, 0.0, infinite=True, expected="seconds, zero or more")
        self.shown = self.stream.isatty()
        self._start = self._last = time.monotonic()

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, *exception) -> None:
        if self.shown:
            self.stream.write("\r\x1b[K")
            self.stream.flush()

    def update(self, run: int, algorithm, n_legal: Callable[[Any], int]) -> None:
        """Show the state of run ``run`` (from 0) after a generation of its algorithm, with how many legal paths it has."""
        if not self._due():
            return
        now = time.monotonic()
        # A loop-wise algorithm reports more than once a generation; its termination knows how far it is.
        share = min(max(algorithm.termination.perc, 1e-9), 1.0)
        done = (run + share) / self.n_runs
        left = (now - self._start) * (1 - done) / done
        runs = f"run {run + 1}/{self.n_runs}, " if self.n_runs > 1 else ""
        generation = min(round(share * self.n_gen), self.n_gen)
        text = f"{runs}generation {generation}/{self.n_gen}, {n_legal(algorithm)} legal paths, about {left:.0f} s left"
        self._write(text)

    def note(self, text: str) -> None:
        """Show how a search stands that has no generations."""
        if self._due():
            self._write(text)

    def _due(self) -> bool:
        now = time.monotonic()
        if not self.shown or now - self._last < self.interval:
            return False
        self._last = now
        return True

    def _write(self, text: str) -> None:
        self.stream.write(f"\r\x1b[K{text}")
        self.stream.flush()
