"""The file that a study was read from, for messages that name its lines."""

from __future__ import annotations

from dataclasses import dataclass

from pymoo_gridpath.errors import StudyError
from pymoo_gridpath.study.specification.toml_lines import KeyLines
from pymoo_gridpath.study.specification.values import Where


@dataclass(frozen=True)
class Source:
    """The file that a study was read from, for messages.

    Attributes
    ----------
    path : str
        As it was given.
    text : str
        All of it.
    """

    path: str
    text: str

    def line(self, where: Where) -> int | None:
        """Return the line of a place in the study, None if no statement holds it."""
        return KeyLines(self.text).line(where)

    def error(self, message: str, where: Where) -> StudyError:
        """Return an error with file and line."""
        return StudyError(message, where, self.path, self.line(where))
