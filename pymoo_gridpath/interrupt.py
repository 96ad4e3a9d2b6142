"""Ctrl-C as a wish to end early that keeps what was found."""

from __future__ import annotations

import signal
import threading

from pymoo_gridpath.progress import say


class StopOnCtrlC:
    """While open, the first Ctrl-C asks for an end of what looks at ``requested``, the second raises KeyboardInterrupt.

    Once ``searching`` is False, Ctrl-C only makes a note, so that what was found is written.
    """

    def __init__(self):
        self.requested = False
        self.searching = True

    def __enter__(self) -> StopOnCtrlC:
        self._before = signal.signal(signal.SIGINT, self._request)
        return self

    def __exit__(self, *exception) -> None:
        signal.signal(signal.SIGINT, self._before)

    def _request(self, number, frame) -> None:
        if self.requested and self.searching:
            raise KeyboardInterrupt
        if not self.requested:
            say("stopping, and keeping what was found; Ctrl-C again ends at once and loses it")
        self.requested = True


def ctrl_c_raises() -> bool:
    """Return whether Ctrl-C raises a KeyboardInterrupt here, and nobody else deals with it."""
    main = threading.current_thread() is threading.main_thread()
    return main and signal.getsignal(signal.SIGINT) is signal.default_int_handler
