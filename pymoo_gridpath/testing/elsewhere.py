"""Another process, with hashes of another seed, in which tests call things a second time."""

from __future__ import annotations

import atexit
import functools
import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from typing import Any

# It reads functions and arguments and writes what comes of them, until nobody is there to ask. What they print goes to its
# standard error.
_SERVE = """
import os, pickle, sys, traceback
answers = os.fdopen(os.dup(1), "wb")
os.dup2(2, 1)
while True:
    try:
        function, arguments = pickle.load(sys.stdin.buffer)
    except EOFError:
        break
    except Exception:
        answer = False, traceback.format_exc()
    else:
        try:
            answer = True, function(*arguments)
        except Exception:
            answer = False, traceback.format_exc()
    pickle.dump(answer, answers)
    answers.flush()
"""


def elsewhere(function: Callable, *arguments: Any) -> Any:
    """Return what a function returns in another process, one for all calls of this one.

    Raises
    ------
    RuntimeError
        With the traceback, if it raises there, or cannot be had there; and if it ends that process.
    """
    process = _process(tuple(filter(None, sys.path)))
    assert process.stdin is not None and process.stdout is not None
    # As one piece: half of what cannot be pickled would be no end of a request.
    request = pickle.dumps((function, arguments))
    try:
        process.stdin.write(request)
        process.stdin.flush()
        done, answer = pickle.load(process.stdout)
    except (OSError, EOFError) as error:
        _process.cache_clear()
        raise RuntimeError(f"another process ended while it called {function!r}") from error
    if not done:
        raise RuntimeError(f"in another process:\n{answer}")
    return answer


@functools.lru_cache(maxsize=1)
def _process(path: tuple[str, ...]) -> subprocess.Popen:
    """Return the process; another one once modules are looked for in other places."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(path), "PYTHONHASHSEED": "77"}
    command = [sys.executable, "-c", _SERVE]
    process = subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=environment
    )
    # It ends once its input does.
    atexit.register(process.communicate)
    return process
