"""Studies and their folders, damaged in every way: `study check`, `run` and `report` say a sentence or give a result.

A case is a study file with one to three mutations, read, planned, estimated, and now and then run; or the folder of a study
that was run, with some of its entries damaged, which has to be made whole again to the bit, with what was set aside named.

    python benchmarks/fuzz/studies.py --count 5000 --jobs 2
"""

from __future__ import annotations

import copy
import dataclasses
import functools
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
from study_damage import NAMED, OF_FOLDERS, OF_RUNS, part_folder
from study_mutations import BASE, OF_DATA, OF_TEXT, ROOM, document

from pymoo_gridpath.errors import GridPathError, StudyError
from pymoo_gridpath.study.planning.canonical import n_cells
from pymoo_gridpath.study.planning.estimate import estimate
from pymoo_gridpath.study.planning.expand import plan_study
from pymoo_gridpath.study.report import write_report, writing
from pymoo_gridpath.study.report.page.blocks import Drawing
from pymoo_gridpath.study.running import store
from pymoo_gridpath.study.running.runner import run_study
from pymoo_gridpath.study.running.store import Store
from pymoo_gridpath.study.specification import study, toml_file, values

# A plan is run if it takes less than this.
MOST_RUNS, MOST_CELLS, MOST_MEMBERS, MOST_EVALUATIONS = 40, 300, 30, 100


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
            writing, "draw_all", lambda blocks, forms: [item for item in blocks if not isinstance(item, Drawing)]
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
