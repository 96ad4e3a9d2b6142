"""The lines of a TOML file on which its tables and keys stand, which `tomllib` does not tell."""

from __future__ import annotations

import re
import tomllib

from pymoo_gridpath.study.specification.values import Where

_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_KEY_PART = re.compile(r"""[ \t]*("(?:[^"\\\n]|\\.)*"|'[^'\n]*'|[A-Za-z0-9_-]+)[ \t]*""")
# What a value holds that may hide a line's end: strings, of which the longer kinds come first, and comments.
_TOKEN = re.compile(
    r'"""(?:[^\\]|\\.)*?"{3,5}'  # an end of quotes may have two more that belong to the text
    r"|'''.*?'{3,5}"
    r'|"(?:[^"\\\n]|\\.)*"'
    r"|'[^'\n]*'"
    r"|#[^\n]*"
    r"|[\[\]{}\n]",
    re.DOTALL,
)


class KeyLines:
    """Where the tables and keys of a TOML file begin.

    Parameters
    ----------
    text : str
        The file, which `tomllib` has read without an error.

    Notes
    -----
    What stands within an inline table or array has the line on which the statement begins.
    """

    def __init__(self, text: str):
        self._lines: dict[Where, int] = {}
        self._counts: dict[Where, int] = {}
        self._text = text
        table: Where = ()
        position, counted, line = _skip(text, 0), 0, 1
        while position < len(text):
            line += text.count("\n", counted, position)
            counted = position
            if text[position] == "[":
                array = text.startswith("[[", position)
                parts, position = _read_key(text, position + 1 + array)
                table = self._enter(parts, array)
                self._add(table, line)
                position += 1 + array
            else:
                parts, position = _read_key(text, position)
                self._add((*table, *parts), line, len(table))
                position = _end_of_value(text, position)
            position = _skip(text, position)

    def line(self, where: Where) -> int | None:
        """Return the line, from 1, of the innermost statement that holds a place; None if there is none."""
        for n in range(len(where), 0, -1):
            if where[:n] in self._lines:
                return self._lines[where[:n]]
        return None

    def _enter(self, parts: list[str], array: bool) -> Where:
        """Return the place of the table that a header opens; an array on the way means its last table."""
        path: Where = ()
        for k, part in enumerate(parts):
            path = (*path, part)
            if array and k == len(parts) - 1:
                self._counts[path] = self._counts.get(path, 0) + 1
            if path in self._counts:
                path = (*path, self._counts[path] - 1)
        return path

    def _add(self, path: Where, line: int, known: int = 0) -> None:
        """Keep the line of a place, and of those around it that no statement has named before."""
        for n in range(known + 1, len(path) + 1):
            self._lines.setdefault(path[:n], line)


def _skip(text: str, position: int) -> int:
    """Return the position after blanks, line ends and comments."""
    found = _BLANK.match(text, position)
    return found.end() if found else position


def _read_key(text: str, position: int) -> tuple[list[str], int]:
    """Return the parts of a dotted key, and the position after it."""
    parts = []
    while True:
        found = _KEY_PART.match(text, position)
        assert found, "tomllib has read this file"
        part = found[1]
        parts.append(next(iter(tomllib.loads(f"{part} = 0"))) if part[0] in "\"'" else part)
        position = found.end()
        if text[position : position + 1] != ".":
            return parts, position
        position += 1


def _end_of_value(text: str, position: int) -> int:
    """Return the position of the line end that ends a value, or of the file's."""
    depth = 0
    for found in _TOKEN.finditer(text, position):
        token = found[0]
        if token in "[{":
            depth += 1
        elif token in "]}":
            depth -= 1
        elif token == "\n" and depth == 0:
            return found.start()
    return len(text)
