"""The errors that this package raises on purpose.

Each message is one sentence that says what was wrong, where, and what was expected, so that the command line
can print it as it is.
"""

from __future__ import annotations


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
        where = self.path if line is None else f"{self.path}, line {line}"
        super().__init__(f"{where}: {message}")

    def __reduce__(self):
        return type(self), (self.path, self.message, self.line)


class CapabilityError(GridPathError):
    """An algorithm was asked for something that it cannot do."""
