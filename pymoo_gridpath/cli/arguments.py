"""What the commands share: exit codes, the parser, and types that turn a text into its value or say what is wrong."""

from __future__ import annotations

import argparse
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pymoo_gridpath.errors import GridPathError, visible

EXIT_OK, EXIT_FAILED, EXIT_BAD_INPUT, EXIT_INTERRUPTED = 0, 1, 2, 130
"""Done; no legal path was found, or runs of a study failed; bad input; ended by Ctrl-C."""


class Parser(argparse.ArgumentParser):
    """A parser whose errors are one line."""

    def error(self, message):
        """Say what was wrong in one line."""
        self.exit(EXIT_BAD_INPUT, f"{self.prog}: {visible(message)} (see {self.prog} --help)\n")


# Their values may begin with a minus, by which argparse takes them for other options.
_PLACES = ("--start", "--goal", "--start-m", "--goal-m", "--footprint")


def join_places(argv: Sequence[str]) -> list[str]:
    """Return arguments in which a place such as -1,0 is joined to its option, which argparse would take for another option."""
    joined: list[str] = []
    for text in argv:
        if joined and joined[-1] in _PLACES and re.match(r"-[\d.].*,", text):
            joined[-1] += f"={text}"
        else:
            joined.append(text)
    return joined


def positive(text: str) -> int:
    """Return the whole number, one or more, that a text says."""
    if not text.isdecimal() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number, one or more")
    return int(text)


def natural(text: str) -> int:
    """Return the whole number, zero or more, that a text says."""
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number, zero or more")
    return int(text)


def above_zero(text: str) -> float:
    """Return the number above 0 that a text says."""
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not 0.0 < number < math.inf:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number above 0")
    return number


def share(text: str) -> float:
    """Return the number above 0, at most 1, that a text such as "0.02" or "2%" says."""
    try:
        number = float(text[:-1]) / 100 if text.endswith("%") else float(text)
    except ValueError:
        number = math.nan
    if not 0.0 < number <= 1.0:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number above 0, at most 1, or per cent such as 2%")
    return number


def cell(text: str) -> tuple[int, int]:
    """Return the cell that a text such as "12,40" says."""
    try:
        x, y = (int(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a cell, expected X,Y such as 12,40") from None
    return x, y


def point(text: str) -> tuple[float, float]:
    """Return the point that a text such as "-1.5,2" says."""
    try:
        x, y = (float(part) for part in text.split(","))
    except ValueError:
        x = y = math.nan
    if not (math.isfinite(x) and math.isfinite(y)):
        raise argparse.ArgumentTypeError(f"{text!r} is not a point in metres, expected X,Y such as -1.5,2")
    return x, y


def outline(text: str) -> list[tuple[float, float]]:
    """Return the corners that a text such as "0.3,0.2 -0.3,0.2 0,-0.2" says, or one such as "[[0.3, 0.2], ...]"."""
    pairs = re.sub(r"\s*,\s*", ",", text.replace("],", "] ").replace("[", " ").replace("]", " ")).split()
    try:
        return [point(pair.strip(",")) for pair in pairs]
    except argparse.ArgumentTypeError:
        raise argparse.ArgumentTypeError(
            f"{text!r} is no outline of a robot, expected corners in metres such as '0.3,0.2 -0.3,0.2 -0.3,-0.2 0.3,-0.2'"
        ) from None


def operators(text: str) -> dict[str, str]:
    """Return the names of operators by what they are for that a text such as "crossover=A,mutation=B" says."""
    pairs = [part.split("=") for part in text.split(",")]
    if not all(len(pair) == 2 and all(pair) for pair in pairs) or len(dict(pairs)) < len(pairs):
        raise argparse.ArgumentTypeError(f"{text!r} names no operators, expected some such as crossover=A,mutation=B")
    return dict(pairs)


def folder(text: str) -> Path:
    """Return the path of a folder; an empty one, such as an unset variable of the shell gives, is none."""
    if not text:
        raise argparse.ArgumentTypeError("'' is not a folder; expected its path, '.' for the current one")
    return Path(text)


def html_file(text: str) -> Path:
    """Return the path of a file to write, in a folder that there is."""
    path = Path(text)
    if not text or path.is_dir() or not path.parent.is_dir():
        raise argparse.ArgumentTypeError(f"{text!r} is not a file in a folder that exists, expected one such as front.html")
    return path


def options_besides(parser: argparse.ArgumentParser, heeded: Sequence[str]) -> dict[str, tuple[str, Any]]:
    """Return how the options that a parser has so far are written, and their defaults, but for some of them."""
    written = {action.dest: (action.option_strings or [action.metavar])[-1] for action in reversed(parser._actions)}
    return {dest: (str(name), parser.get_default(dest)) for dest, name in written.items() if dest not in (*heeded, "help")}


def refuse_given(arguments, options: dict[str, tuple[str, Any]], other: str) -> None:
    """Refuse options that are given beside another one that has them without effect.

    Raises
    ------
    GridPathError
    """
    for dest, (name, default) in options.items():
        if getattr(arguments, dest) != default:
            raise GridPathError(f"{name} is not for {other}")
