"""Study files: TOML, read with the line of everything that may be wrong in it."""

from __future__ import annotations

import os
import re
import tomllib
from importlib import resources
from pathlib import Path

from pymoo_gridpath import checks
from pymoo_gridpath.errors import StudyError
from pymoo_gridpath.study.specification.source import Source
from pymoo_gridpath.study.specification.study import Study

# Of a study of a thousand problems, a tenth.
_MOST_BYTES = 2_000_000
# tomllib takes time that grows with the square of the number of parts of a key.
_PART = r"""(?:[\w-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')"""
_MANY_PARTS = re.compile(rf"""(?<![\\\w."'-])(?:{_PART}[ \t]*+\.[ \t]*+){{50}}""")

#: What a new study file is called.
STARTER_NAME = "study.toml"


def load_study(path: str | os.PathLike[str]) -> Study:
    """Read a study file.

    Parameters
    ----------
    path : str or path-like
        A TOML file; maps that it names are looked for in its folder. `write_starter` writes one with comments.

    Returns
    -------
    Study

    Raises
    ------
    StudyError
        If the file cannot be read, is no TOML, or describes no study; the message names the line. What takes reading the maps
        is checked by `plan_study`.
    """
    path = checks.file_path("path", path, StudyError)
    source = Source(path, _read(path))
    if many := _MANY_PARTS.search(source.text):
        line = source.text.count("\n", 0, many.start()) + 1
        raise StudyError("a key has more than 50 parts, expected a study", path=source.path, line=line)
    try:
        data = tomllib.loads(source.text)
    except tomllib.TOMLDecodeError as error:
        raise _syntax_error(source, str(error)) from None
    except RecursionError:
        raise StudyError("the file nests brackets too deeply, expected a study", path=source.path) from None
    data.setdefault("name", Path(path).stem)
    try:
        return Study.from_dict(data, folder=Path(path).parent, source=source)
    except StudyError as error:
        raise source.error(error.message, error.where) from None


def write_starter(path: str | os.PathLike[str] = STARTER_NAME) -> Path:
    """Write a small study with comments, ready to run and to change.

    Raises
    ------
    StudyError
        If there is such a file already, or it cannot be written.
    """
    text = (resources.files("pymoo_gridpath.study.specification") / "starter.toml").read_text(encoding="utf-8")
    try:
        with open(path, "x", encoding="utf-8") as stream:
            stream.write(text)
    except FileExistsError:
        raise StudyError("the file exists already, expected a new name", path=path) from None
    except OSError as error:
        raise StudyError(f"the file cannot be written ({error.strerror or error})", path=path) from None
    return Path(path)


def _read(path: str | os.PathLike[str]) -> str:
    try:
        with open(path, "rb") as file:
            data = file.read(_MOST_BYTES + 1)
    except FileNotFoundError:
        raise StudyError("there is no such file, expected a study; `pymoo-gridpath study init` writes one", path=path) from None
    except OSError as error:
        raise StudyError(f"the file cannot be read ({error.strerror or error}), expected a study", path=path) from None
    if len(data) > _MOST_BYTES:
        raise StudyError(f"the file is larger than {_MOST_BYTES:,} bytes, expected a study", path=path)
    try:
        # As tomllib does, so that lines are counted alike.
        return data.decode("utf-8").removeprefix("\ufeff").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise StudyError("found bytes that are no UTF-8, expected a TOML file", path=path, line=line) from None


def _syntax_error(source: Source, message: str) -> StudyError:
    """Return tomllib's complaint as one sentence."""
    found = re.fullmatch(r"(.*?)\s*\(at (?:line (\d+), column (\d+)|end of document)\)", message, re.DOTALL)
    what, line, column = found.groups() if found else (message, None, None)
    where = f" at column {column}" if column else " at the end of the file" if found else ""
    number = int(line) if line else source.text.rstrip().count("\n") + 1
    what = what[:1].lower() + what[1:]
    return StudyError(f"{what}{where}; expected a TOML file", path=source.path, line=number)
