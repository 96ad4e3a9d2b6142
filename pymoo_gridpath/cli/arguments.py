"""What several commands take on the command line: each turns a text into its value, or says what is wrong."""

from __future__ import annotations

import argparse
from pathlib import Path


def positive(text: str) -> int:
    """Return the whole number, one or more, that a text says."""
    if not text.isdecimal() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number, one or more")
    return int(text)


def folder(text: str) -> Path:
    """Return the path of a folder; an empty one, such as an unset variable of the shell gives, is none."""
    if not text:
        raise argparse.ArgumentTypeError("'' is not a folder; expected its path, '.' for the current one")
    return Path(text)
