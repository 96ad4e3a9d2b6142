"""A study file, and the ways to damage one: its data, and its text."""

from __future__ import annotations

import copy
import functools
import json
from random import Random
from typing import Any

BASE: dict[str, Any] = {
    "name": "fuzzed",
    "seeds": 2,
    "budget": {"evaluations": 40},
    "reference": {"max_seconds": 5},
    "target": 0.95,
    "problems": [
        {
            "name": "random",
            "random": {"size": 6, "p0": 0.2, "seeds": 2},
            "objectives": ["length", "vulnerability"],
            "representation": "integer",
            "obstacles": "penalty",
            "penalty": 2.0,
            "axis": "auto",
        },
        {"map": "paper16", "start": [0, 0], "goal": [15, 15], "radius": 0.0, "representation": "cells"},
        {"map": "room.txt", "objectives": ["length", "turn"], "obstacles": "constraint"},
        {
            "name": "moving",
            "random": {"size": 6, "p0": 0.1},
            "moving": {"movers": [[[3, 3], [3, 4]], [[1, 4]]], "every": 1, "epochs": 2},
        },
    ],
    "algorithms": [
        {"name": "paper", "preset": "ahmed-deb-2013", "pop_size": 10},
        {"name": "nsga2", "algorithm": "NSGA2", "pop_size": 10, "smoothness": False, "operators": "scalarized"},
        {"name": "moead", "algorithm": "MOEAD", "pop_size": 10, "parameters": {"n_neighbors": 4}},
        {
            "name": "own",
            "algorithm": "SPEA2",
            "pop_size": 10,
            "operators": {"base": "random", "mutation": {"class": "PathMutation", "margin": 8}},
            "representation": "cells",
        },
    ],
}
ROOM = "name: room\nstart: 0,0\ngoal: 5,2\n\n......\n..##..\n......\n"

OTHERS = [True, False, 0, 1, -1, 2.5, "", "length", [], [1, 2], {}, {"a": 1}, [[0]], ["length", 3], "inf"]
NUMBERS = [
    0,
    -1,
    1,
    2,
    3,
    10**6,
    2**31,
    2**63,
    -(2**63) - 1,
    10**30,
    0.0,
    -0.0,
    1e-320,
    1e308,
    float("inf"),
    float("nan"),
    0.5,
    5.0,
]
WORDS = [
    "",
    " ",
    "x",
    "NSGA",
    "nsga-2",
    "cell",
    "Length",
    "../..",
    "/",
    "\x1b[31m",
    "a\nb",
    "é\u202e",
    "\U0001f600",
    "a" * 5000,
    "{0}",
    "%s",
    "None",
]
KEYS = ["", "sede", "Seeds", "pop size", "é", "\x1b[0m", "a" * 3000, "__class__", "max_seconds", "random", "map", "parameters"]
LETTERS = [
    "\x00",
    "\t",
    "[",
    "]",
    "{",
    "}",
    '"',
    "'''",
    "=",
    ".",
    ",",
    "#",
    "\\",
    "\u2028",
    "\ufeff",
    "é",
    "9",
    "\r",
    "[[problems]]\n",
]


def toml(value: Any) -> str:
    """Return a value as TOML."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=True) if all(ord(c) < 0x10000 for c in value) else f"'{value}'"
    if isinstance(value, list):
        return f"[{', '.join(map(toml, value))}]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)} = {toml(item)}" for key, item in value.items()) + "}"
    return repr(value)


def document(data: dict) -> str:
    """Return a study as the text of a file, one key a line, and one table a problem and an algorithm."""
    lines, tables = [], []
    for key, value in data.items():
        if key in ("problems", "algorithms") and isinstance(value, list) and value and all(isinstance(v, dict) for v in value):
            for item in value:
                tables.append(f"[[{key}]]")
                tables += [f"{json.dumps(k)} = {toml(v)}" for k, v in item.items()]
        else:
            lines.append(f"{json.dumps(key)} = {toml(value)}")
    return "\n".join([*lines, *tables]) + "\n"


def places(value: Any, path: tuple = ()) -> list[tuple]:
    """Return the paths to everything in nested lists and dicts."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [place for key, item in items for place in [(*path, key), *places(item, (*path, key))]]


def at(data: Any, path: tuple) -> Any:
    return functools.reduce(lambda value, key: value[key], path, data)


def replaced(data: dict, path: tuple, value: Any) -> None:
    at(data, path[:-1])[path[-1]] = value


def a_place(data: dict, random: Random, kind: Any = object) -> tuple:
    found = [
        path for path in places(data) if isinstance(at(data, path), kind) and not (kind is not bool and at(data, path) is True)
    ]
    return random.choice(found or places(data))


def change_type(data: dict, random: Random) -> None:
    replaced(data, a_place(data, random), copy.deepcopy(random.choice(OTHERS)))


def change_number(data: dict, random: Random) -> None:
    replaced(data, a_place(data, random, int | float), random.choice(NUMBERS))


def change_word(data: dict, random: Random) -> None:
    replaced(data, a_place(data, random, str), random.choice(WORDS))


def nest(data: dict, random: Random) -> None:
    path = a_place(data, random)
    value = at(data, path)
    for _ in range(random.choice([1, 1, 2, 20, 90])):
        value = random.choice([[value], {"first": value}])
    replaced(data, path, value)


def flatten(data: dict, random: Random) -> None:
    path = a_place(data, random, dict | list)
    value = at(data, path)
    inner = list(value.values()) if isinstance(value, dict) else value
    replaced(data, path, random.choice(inner) if inner else 0)


def drop(data: dict, random: Random) -> None:
    path = a_place(data, random)
    del at(data, path[:-1])[path[-1]]


def add_key(data: dict, random: Random) -> None:
    tables = [data, *(at(data, path) for path in places(data) if isinstance(at(data, path), dict))]
    random.choice(tables)[random.choice(KEYS)] = copy.deepcopy(random.choice(OTHERS))


def repeat(data: dict, random: Random) -> None:
    value = at(data, a_place(data, random, list))
    if isinstance(value, list) and value:
        value += [copy.deepcopy(random.choice(value)) for _ in range(random.choice([1, 1, 30, 300]))]


def swap(data: dict, random: Random) -> None:
    one, other = a_place(data, random), a_place(data, random)
    value = copy.deepcopy(at(data, other))
    replaced(data, one, value)


def cut(text: str, random: Random) -> str:
    return text[: random.randrange(len(text))]


def write_over(text: str, random: Random) -> str:
    for _ in range(random.choice([1, 1, 3, 20])):
        k = random.randrange(len(text))
        text = text[:k] + random.choice(LETTERS) + text[k + random.randrange(3) :]
    return text


def repeat_line(text: str, random: Random) -> str:
    lines = text.splitlines(keepends=True)
    lines.insert(random.randrange(len(lines)), random.choice(lines))
    return "".join(lines)


TABLE = "[[x]]\n"


def blow_up(text: str, random: Random) -> str:
    # Five million tables are more than a gigabyte on any machine, unless the size of the file is looked at first.
    line = random.choice(["[", "{a=", "a.", "x = [[[[", "# " + "c" * 1000 + "\n", "\n", '"', TABLE])
    return text + random.choice(["", "z = "]) + line * (5_000_000 if line is TABLE else random.choice([100, 5000, 200_000]))


OF_DATA = [change_type, change_number, change_word, nest, flatten, drop, add_key, repeat, swap]
OF_TEXT = [cut, write_over, repeat_line, blow_up]
