"""Studies and their folders, damaged in every way: `study check`, `run` and `report` say a sentence or give a result.

A case is a study file with one to three mutations, read, planned, estimated, and now and then run; or the folder of a study
that was run, with some of its entries damaged, which has to be made whole again to the bit, with what was set aside named.

    python benchmarks/fuzz/studies.py --count 5000 --jobs 2
"""

from __future__ import annotations

import copy
import dataclasses
import functools
import hashlib
import json
import os
import shutil
import sys
import tempfile
from collections.abc import Callable
from contextlib import contextmanager
from pathlib import Path
from random import Random
from typing import Any
from unittest.mock import patch

from harness import main

from pymoo_gridpath.errors import GridPathError, StudyError
from pymoo_gridpath.study.planning.canonical import n_cells
from pymoo_gridpath.study.planning.estimate import estimate
from pymoo_gridpath.study.planning.expand import plan_study
from pymoo_gridpath.study.report import write_report
from pymoo_gridpath.study.report.page import drawing
from pymoo_gridpath.study.report.page.blocks import Drawing
from pymoo_gridpath.study.running import record, store
from pymoo_gridpath.study.running.runner import run_study
from pymoo_gridpath.study.running.store import Store
from pymoo_gridpath.study.specification import study, toml_file, values

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

# A plan is run if it takes less than this.
MOST_RUNS, MOST_CELLS, MOST_MEMBERS, MOST_EVALUATIONS = 40, 300, 30, 100


# -- study files --------------------------------------------------------------------------------------------------------


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


def blow_up(text: str, random: Random) -> str:
    line = random.choice(["[", "{a=", "a.", "x = [[[[", "# " + "c" * 1000 + "\n", "\n", '"'])
    return text + random.choice(["", "z = "]) + line * random.choice([100, 5000, 200_000])


OF_DATA = [change_type, change_number, change_word, nest, flatten, drop, add_key, repeat, swap]
OF_TEXT = [cut, write_over, repeat_line, blow_up]


def a_study(random: Random) -> dict:
    """Return a study of one or two problems and algorithms, which is planned in a tenth of the time of all."""
    data = copy.deepcopy(BASE)
    for key in ("problems", "algorithms"):
        data[key] = random.sample(data[key], random.choice([1, 1, 1, 2]))
    return data


def report(folder: Path, random: Random) -> None:
    """Write a report, mostly without its figures, which take longer than all the rest."""
    if random.random() < 0.02:
        write_report(folder, formats=["svg"])
    else:
        with patch.object(
            drawing, "draw_all", lambda blocks, forms: [item for item in blocks if not isinstance(item, Drawing)]
        ):
            write_report(folder, formats=["svg"])


def study_case(change: Callable, random: Random) -> None:
    data, text = a_study(random), ""
    if change in OF_DATA:
        for _ in range(random.choice([1, 1, 1, 2, 3])):
            change(data, random)
        text = document(data)
    else:
        text = change(document(data), random)
    with tempfile.TemporaryDirectory() as name:
        file = Path(name) / "study.toml"
        file.write_bytes(text.encode("utf-8", "surrogatepass"))
        (Path(name) / "room.txt").write_text(ROOM)
        found = plan_study(toml_file.load_study(file))
        if random.random() < 0.3 and is_small(found):
            estimate(found, found.runs[:2], max_seconds=0.05)
            runs = tuple(random.sample(found.runs, min(3, len(found.runs))))
            run_study(dataclasses.replace(found, runs=runs), Path(name) / "out", study=text)
            if random.random() < 0.3:
                report(Path(name) / "out", random)


def is_small(plan) -> bool:
    """Whether the runs of a plan take but a moment."""
    members = [item.spec.get("pop_size", 1) for item in plan.algorithms]
    budgets = [value for run in plan.runs if (budget := plan.task(run).budget) for value in budget.values()]
    return (
        len(plan.runs) <= MOST_RUNS
        and max((n_cells(item.spec["grid"]) for item in plan.problems), default=0) <= MOST_CELLS
        and max(members, default=0) <= MOST_MEMBERS
        and max(budgets, default=0) <= MOST_EVALUATIONS
    )


# -- folders ------------------------------------------------------------------------------------------------------------


@functools.cache
def finished() -> tuple[Any, Path]:
    """Return a plan and the folder that holds all its runs, made once in a process."""
    folder = Path(tempfile.mkdtemp(prefix="studies-"))
    small: dict[str, Any] = copy.deepcopy(BASE) | {"seeds": 1}
    small["algorithms"] = small["algorithms"][1:3]
    (folder / "study.toml").write_text(document(small))
    (folder / "room.txt").write_text(ROOM)
    plan = plan_study(toml_file.load_study(folder / "study.toml"))
    run_study(plan, folder / "done")
    return plan, folder / "done"


def make_folder(path: Path, random: Random) -> None:
    path.unlink()
    path.mkdir()
    (path / "inside").write_text("mine")


def dangling(path: Path, random: Random) -> None:
    path.unlink()
    path.symlink_to("nowhere")


def circular(path: Path, random: Random) -> None:
    path.unlink()
    path.symlink_to(path.name)


def cut_short(path: Path, random: Random) -> None:
    data = path.read_bytes()
    path.write_bytes(data[: random.choice([0, 1, len(data) // 2, len(data) - 1])])


def flip(path: Path, random: Random) -> None:
    data = bytearray(path.read_bytes())
    data[random.randrange(len(data))] ^= 1 << random.randrange(8)
    path.write_bytes(data)


def another(path: Path, random: Random) -> None:
    path.write_bytes(random.choice(sorted(set(path.parents[1].glob("*/*.npz")) - {path})).read_bytes())


def sealed(path: Path, random: Random) -> None:
    """Seal what is no run as one."""
    data = random.choice([b"", b"PK", b"x" * 100, b"\0" * 30 + b"{}", b"\0" * 26 + b"\2\0\0\0{}"])
    path.write_bytes(data + record._SEAL + hashlib.sha256(data).hexdigest().encode())


def part_folder(path: Path, random: Random) -> None:
    folder = random.choice([path.parent, path.parents[2]]) / f".{path.name}.0123abcd.part"
    folder.mkdir()
    (folder / "inside").write_text("mine")


def part_file(path: Path, random: Random) -> None:
    (random.choice([path.parent, path.parents[2]]) / f".{path.name}.0123abcd.part").write_bytes(b"half")


def foreign(path: Path, random: Random) -> None:
    name = random.choice(["notes.txt", "x.npz", "é\x1b.npz", ".hidden", "a" * 200, "ff"])
    target = random.choice([path.parent, path.parents[1], path.parents[2]]) / name
    target.mkdir() if random.random() < 0.5 else target.write_bytes(b"mine")


def no_part(path: Path, random: Random) -> None:
    shutil.rmtree(path.parent)
    path.parent.write_bytes(b"mine") if random.random() < 0.5 else path.parent.symlink_to("nowhere")


def no_runs(path: Path, random: Random) -> None:
    shutil.rmtree(path.parents[1])
    path.parents[1].write_bytes(b"mine") if random.random() < 0.5 else path.parents[1].symlink_to("nowhere")


OF_RUNS = [make_folder, dangling, circular, cut_short, flip, another, sealed, part_folder, part_file, foreign, no_part, no_runs]
NAMED = [make_folder, dangling, circular, cut_short, another, part_folder]


def runs_case(damage: Callable, random: Random) -> None:
    """Damage a stored run; that the study cannot go on, in however fine a sentence, is a fault."""
    try:
        _repair(damage, random)
    except GridPathError as error:
        raise AssertionError(f"did not go on: {error}") from error


def _repair(damage: Callable, random: Random) -> None:
    plan, done = finished()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "copy"
        shutil.copytree(done, folder)
        path = random.choice(sorted(folder.glob("runs/*/*.npz")))
        damage(path, random)
        outcome = run_study(plan, folder)
        assert outcome.n_failed == 0 and not Store(folder).check([run.key for run in plan.runs]).missing, outcome.messages
        for run in plan.runs:
            a, b = Store(folder).read(run.key), Store(done).read(run.key)
            assert (a.X.tobytes(), a.F.tobytes()) == (b.X.tobytes(), b.F.tobytes()), f"run {run.key} has other bits"
        if damage in NAMED:
            stem = path.stem if damage is not part_folder else f".{path.name}.0123abcd"
            assert any(stem in message for message in outcome.messages), outcome.messages
        assert not (damage is part_folder and list(folder.rglob("*.part")) == []), "a folder of the user is gone"
        if random.random() < 0.3:
            report(folder, random)


def damaged_plan(folder: Path, random: Random) -> None:
    path = folder / "plan.json"
    data = json.loads(path.read_text())
    random.choice([change_type, change_number, change_word, nest, flatten, drop, repeat])(data, random)
    path.write_text(json.dumps(data))


def odd_entry(folder: Path, random: Random) -> None:
    path = folder / random.choice(["plan.json", "study.toml", "lock", "damaged", "report"])
    if path.is_file():
        path.unlink()
    random.choice([path.mkdir, lambda: path.symlink_to("nowhere"), lambda: path.write_bytes(b"\xff\x00")])()


def broken_plan(folder: Path, random: Random) -> None:
    path = folder / "plan.json"
    path.write_text(write_over(path.read_text(), random))


OF_FOLDERS = [damaged_plan, odd_entry, broken_plan]


def folder_case(damage: Callable, random: Random) -> None:
    plan, done = finished()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "copy"
        shutil.copytree(done, folder)
        damage(folder, random)
        if random.random() < 0.8:
            report(folder, random)
        else:
            run_study(plan, folder, study=random.choice([None, "name = 'x'"]))


# -- the fuzzer ---------------------------------------------------------------------------------------------------------

KINDS = [
    *(("study file: ", change, study_case) for change in [*OF_DATA, *OF_TEXT] * 4),
    *(("stored runs: ", damage, runs_case) for damage in OF_RUNS),
    *(("study folder: ", damage, folder_case) for damage in OF_FOLDERS * 4),
]


def make(seed: int) -> tuple[str, Callable[[], object]]:
    """Damage study files and the folders of studies."""
    finished()
    random = Random(seed)
    prefix, change, case = KINDS[seed % len(KINDS)]
    return prefix + change.__name__.replace("_", " "), functools.partial(case, change, random)


@contextmanager
def changed(owner: Any, name: str, new: Any):
    """Have something of the product be another thing."""
    with patch.object(owner, name, new):
        yield


def _burn(function):
    def slow(*arguments, **options):
        return [function(*arguments, **options), sum(range(700_000_000))][0]

    return slow


def _hoard(function):
    def large(*arguments, **options):
        kept = bytearray(1_500_000_000)
        kept[::4096] = bytes(len(kept[::4096]))
        return function(*arguments, **options)

    return large


def _without_limit(path) -> str:
    return Path(path).read_bytes().decode("utf-8")


def _unchecked(data: bytes) -> dict:
    begin = data.find(b"{")
    depth = json.JSONDecoder().raw_decode(data[begin : data.find(b"PK", begin + 1)].decode())
    return depth[0]


def _as_it_was(self, key: str) -> bytes:
    try:
        return self.path(key).read_bytes()
    except OSError as error:
        raise GridPathError(f"{self.path(key)} cannot be read: {error.strerror}") from None


def _unlink_all(self) -> None:
    for folder in (self.folder, *self._parts()):
        for entry in os.scandir(folder):
            if store._is_unfinished(entry):
                os.unlink(entry.path)


def _delete(self, path: Path) -> Path:
    shutil.rmtree(path) if path.is_dir() else path.unlink()
    return self.folder / "damaged" / "something"


PLANTED = {
    "a budget is not checked": lambda: changed(study, "_budget", dict),
    "files of any size are read": lambda: changed(toml_file, "_read", _without_limit),
    "values are shown whole and raw": lambda: changed(values, "show", str),
    "an unknown key takes seconds": lambda: changed(StudyError, "__init__", _burn(StudyError.__init__)),
    "a plan takes memory": lambda: changed(sys.modules[__name__], "plan_study", _hoard(plan_study)),
    "deep nesting is a RecursionError": lambda: changed(toml_file, "RecursionError", KeyError),
    "checksums are not looked at": lambda: changed(store, "read_meta", _unchecked),
    "a folder for a run stops the study": lambda: changed(Store, "_read", _as_it_was),
    "folders are unlinked like files": lambda: changed(Store, "_remove_unfinished", _unlink_all),
    "what is damaged is deleted and not named": lambda: changed(Store, "_set_aside", _delete),
}

if __name__ == "__main__":
    # Made before the workers are forked. What is tested is not whether the disk keeps it.
    os.fsync = lambda descriptor: None
    finished()
    sys.exit(main(make, PLANTED, count=5000))
