"""The YAML file of a ROS map by the rules of yaml-cpp 0.7, with which the map server reads it."""

from __future__ import annotations

import itertools
import math
import os
import re
from pathlib import Path

import yaml

from pymoo_gridpath.errors import MapError
from pymoo_gridpath.maps._files import read_string, shorten

MAX_BYTES = 64 * 1024
"""The largest YAML file of a map; real ones have some hundred bytes."""

# Files of a folder that are looked through for one that names an image.
_MAX_FILES = 1000

# Of a stream of C++, which knows neither ".inf" nor letters of other scripts nor blanks in front.
_FLOAT = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*", re.ASCII)
# A number of more than ten digits is beyond every limit, and Python converts no more than 4,300.
_INT = re.compile(r"([-+]?)(?:0[xX]([\da-fA-F]+)|(0[0-7]*)|([1-9]\d{0,9}))\s*", re.ASCII)
_MAX_INT = 2**31 - 1

_BOOLS = {"y": True, "yes": True, "true": True, "on": True, "n": False, "no": False, "false": False, "off": False}
_NULLS = ("", "~", "null", "Null", "NULL")


class _Loader(yaml.SafeLoader):
    """PyYAML with tabs between what belongs to one line, as YAML allows them."""

    def scan_to_next_token(self):
        super().scan_to_next_token()
        while self.peek() == "\t":
            # A tab is no indentation: no key of a block may follow.
            if not self.flow_level:
                self.allow_simple_key = False
            self.forward()
            super().scan_to_next_token()


class Keys:
    """The keys of the first document of a YAML file, with their values and lines.

    Values are read from the text that stands in the file: yaml-cpp knows no types of plain words.
    """

    def __init__(self, path: str | os.PathLike[str]):
        self.path = path
        self._text = read_string(path, MAX_BYTES)
        try:
            loader = _Loader(self._text)
            node = loader.get_node() if loader.check_node() else None
        except yaml.MarkedYAMLError as error:
            line = None if error.problem_mark is None else error.problem_mark.line + 1
            raise MapError(path, f"the YAML is broken ({error.problem}), expected lines of 'key: value'", line) from None
        except Exception:
            # PyYAML lets errors of other kinds escape, for instance from letters that YAML forbids or from deep nesting.
            raise MapError(path, "the YAML cannot be read, expected lines of 'key: value'") from None
        if not isinstance(node, yaml.MappingNode):
            found = "nothing" if node is None else shorten(self._source(node))
            raise MapError(path, f"the YAML holds {found}, expected a mapping with the key 'image' and others")
        self._nodes: dict[str, yaml.Node] = {}
        self._lines: dict[str, int] = {}
        for key, value in node.value:
            if isinstance(key, yaml.ScalarNode):
                self._add(key.value, value, key.start_mark.line + 1)

    def _add(self, key: str, value: yaml.Node, line: int) -> None:
        if key in self._nodes:
            first = self._lines[key]
            raise MapError(
                self.path,
                f"the key {shorten(key)} stands in line {first} as {shorten(self._source(self._nodes[key]))} and again in line "
                f"{line} as {shorten(self._source(value))}, expected it once",
                line,
            )
        self._nodes[key], self._lines[key] = value, line

    def text(self, key: str, expected: str) -> str:
        """Return a single word or text, quoted or not."""
        text = _scalar(self._node(key))
        if text is None:
            raise self.error(key, expected)
        return text

    def number(self, key: str, expected: str) -> float:
        """Return a finite number."""
        number = _number(self._node(key))
        if not math.isfinite(number):
            raise self.error(key, expected)
        return number

    def numbers(self, key: str, n: int, expected: str) -> tuple[float, ...]:
        """Return a list of finite numbers."""
        node = self._node(key)
        numbers = tuple(map(_number, node.value)) if isinstance(node, yaml.SequenceNode) else ()
        if len(numbers) != n or not all(map(math.isfinite, numbers)):
            raise self.error(key, expected)
        return numbers

    def flag(self, key: str, expected: str) -> bool:
        """Return a whole number, which is true unless 0, or a word for yes or no."""
        text = _scalar(self._node(key))
        if text is not None and (match := _INT.fullmatch(text)) is not None:
            sign, hexadecimal, octal, decimal = match.groups()
            number = int(hexadecimal, 16) if hexadecimal else int(octal, 8) if octal else int(decimal)
            if number <= _MAX_INT + (sign == "-"):
                return number != 0
        elif text is not None and text in (text.lower(), text.upper(), text.capitalize()) and text.lower() in _BOOLS:
            return _BOOLS[text.lower()]
        raise self.error(key, expected)

    def __contains__(self, key: str) -> bool:
        return key in self._nodes

    def error(self, key: str, expected: str) -> MapError:
        """Return the error of a key whose value is not what was expected."""
        found = shorten(self._source(self._nodes[key]))
        return MapError(self.path, f"{key} is {found}, expected {expected}", self._lines[key])

    def _node(self, key: str) -> yaml.Node:
        if key not in self._nodes:
            raise MapError(self.path, f"the key {key!r} is missing, expected it in the YAML file of a ROS map")
        return self._nodes[key]

    def _source(self, node: yaml.Node) -> str:
        """Return what stands in the file."""
        return self._text[node.start_mark.index : node.end_mark.index].rstrip()


def _scalar(node: yaml.Node) -> str | None:
    """Return the text of a scalar, or None for a null, a list and a mapping."""
    if not isinstance(node, yaml.ScalarNode) or (not node.style and node.value in _NULLS):
        return None
    return node.value


def _number(node: yaml.Node) -> float:
    """Return a number, or nan for anything else."""
    text = _scalar(node)
    return float(text) if text is not None and _FLOAT.fullmatch(text) else math.nan


def yaml_of_image(image: str | os.PathLike[str]) -> Path | None:
    """Return a YAML file beside an image that names it, as that of a ROS map does, or None."""
    image = Path(image)
    names = [image.with_suffix(suffix).name for suffix in (".yaml", ".yml")]
    try:
        with os.scandir(image.parent) as entries:
            names += sorted(entry.name for entry in itertools.islice(entries, _MAX_FILES))
    except OSError:
        return None
    for name in names:
        beside = image.parent / name
        if beside.suffix.lower() in (".yaml", ".yml") and os.path.isfile(beside) and _names(beside, image):
            return beside
    return None


def _names(path: Path, image: Path) -> bool:
    try:
        # Most are about other things, and parsing takes time.
        if path.stat().st_size > MAX_BYTES or os.fsencode(image.name) not in path.read_bytes():
            return False
        keys = Keys(path)
        named = path.parent / keys.text("image", "a name") if "image" in keys else None
        return named is not None and os.path.isfile(named) and named.samefile(image)
    except (MapError, OSError, ValueError):
        return False
