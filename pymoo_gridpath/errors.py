"""The errors and warnings that this package raises on purpose.

Each message is one sentence that says what was wrong, where, and what was expected, so that the command line
can print it as it is.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable

# Letters of a key that a message shows where it says in which place of a study something is wrong.
_LONGEST_KEY = 64


class GridPathError(ValueError):
    """Base of every error that this package raises about its input."""


class GridError(GridPathError):
    """A grid, a cell or a query (start, goal) that cannot be used."""


class UnreachableError(GridError):
    """No path exists between the start and the goal under the stated rules."""


class MapError(GridPathError):
    """A map file that cannot be read.

    Parameters
    ----------
    path : str or path-like
        The file.
    message : str
        What was wrong and what was expected.
    line : int, optional
        The line of the file, counted from 1.
    """

    def __init__(self, path, message: str, line: int | None = None):
        self.path = str(path)
        self.line = line
        self.message = message
        where = visible(path) if line is None else f"{visible(path)}, line {line}"
        super().__init__(f"{where}: {message}")

    def __reduce__(self):
        return type(self), (self.path, self.message, self.line)


class StudyError(GridPathError):
    """A comparison study that cannot be run as it is described.

    Parameters
    ----------
    message : str
        What was wrong and what was expected.
    where : sequence of str and int
        Where in the study: the keys and indices that lead there, such as ``("problems", 0, "random")``.
    path : str or path-like, optional
        The file of the study.
    line : int, optional
        The line of the file, counted from 1.
    """

    def __init__(self, message: str, where=(), path=None, line: int | None = None):
        self.message = message
        self.where = tuple(where)
        self.path = None if path is None else str(path)
        self.line = line
        if self.path is not None:
            place = visible(path) if line is None else f"{visible(path)}, line {line}"
        else:
            # Keys are the user's, of any length and letters.
            parts = [f"[{part}]" if isinstance(part, int) else f".{visible(part[:_LONGEST_KEY])}" for part in self.where]
            place = "".join(parts).lstrip(".")
        super().__init__(f"{place}: {message}" if place else message)

    def __reduce__(self):
        return type(self), (self.message, self.where, self.path, self.line)


class CapabilityError(GridPathError):
    """An algorithm was asked for something that it cannot do."""


class GridPathWarning(UserWarning):
    """Base of the warnings about input that can be used, but may mean something else than what was wished."""


class MapWarning(GridPathWarning):
    """A map that can be read, but may have been meant otherwise.

    Parameters
    ----------
    path : str or path-like
        The file.
    message : str
        What may be wrong, and what helps.
    """

    def __init__(self, path, message: str):
        self.path = str(path)
        self.message = message
        super().__init__(f"{visible(path)}: {message}")

    def __reduce__(self):
        return type(self), (self.path, self.message)


def visible(text: object) -> str:
    r"""Return a text on one line, with escapes in place of what a terminal would not print but obey.

    Examples
    --------
    >>> print(visible("a\x1b[2Jb\nc"))
    a\x1b[2Jb\nc
    """
    return "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in str(text))


def nearest(name: object, known: Iterable[str], otherwise: str = "expected one of") -> str:
    """Return the part of a message that names the known name nearest to an unknown one, or else all of them."""
    known = list(known)
    near = difflib.get_close_matches(str(name), known, n=1, cutoff=0.5)
    return f"did you mean {near[0]!r}?" if near else f"{otherwise} {', '.join(known)}"


def counted(number: int, noun: str) -> str:
    """Return the part of a message that says how many there are of something: "1 path", "2,000 paths"."""
    return f"{number:,} {noun}{'' if number == 1 else 's'}"
