"""The folder of a study."""

from __future__ import annotations

import errno
import functools
import itertools
import json
import os
import subprocess
import sys

import pytest
from small_studies import record, stored

from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.study.running.record import DamagedRecordError, to_bytes
from pymoo_gridpath.study.running.store import Store

KEYS = [f"{k:02x}" + "0" * 30 for k in range(5)]


@pytest.fixture
def store(tmp_path) -> Store:
    """A store of five runs, one of them failed."""
    store = Store(tmp_path / "deep" / "study")
    for k, key in enumerate(KEYS):
        status = {"status": "failed", "message": "boom"} if k == 4 else {}
        store.write(key, to_bytes(record(key=key, seed=k, versions={"pymoo": f"0.6.{k // 3}"}, **status)))
    return store


def test_runs_are_read_back(store):
    assert [store.read(key).seed for key in KEYS] == [0, 1, 2, 3, 4]
    assert sorted(stored(store.folder)) == KEYS


def test_check_tells_what_is_there(store):
    found = store.check([*KEYS, "ff" * 16])
    assert (found.missing, found.failed, found.damaged) == (["ff" * 16], [KEYS[4]], [])
    assert {key: meta["status"] for key, meta in found.meta.items()} == {
        key: "failed" if key == KEYS[4] else "finished" for key in KEYS
    }
    assert dict(found.versions) == {(("pymoo", "0.6.0"),): 3, (("pymoo", "0.6.1"),): 2}


def test_an_empty_folder_has_nothing(tmp_path):
    store = Store(tmp_path / "none")
    assert store.check(KEYS).missing == store.check(key for key in KEYS).missing == KEYS
    with pytest.raises(GridPathError, match=r"none has no run 0000.*, expected one that was stored"):
        store.read(KEYS[0])
    with pytest.raises(GridPathError, match=r"none has no plan\.json, expected the folder of a study that was run"):
        store.read_plan()


def test_damaged_files_are_found_and_set_aside(store):
    whole = store.path(KEYS[0]).read_bytes()
    store.path(KEYS[0]).write_bytes(whole[:-1])
    store.path(KEYS[1]).write_bytes(b"")
    store.path(KEYS[2]).write_bytes(whole)  # another run under its name
    for key in (KEYS[0], KEYS[2]):
        with pytest.raises(DamagedRecordError):
            store.read(key)
    assert store.check(KEYS).damaged == [store.path(key) for key in KEYS[:3]]
    for number in range(1, 3):
        for key in KEYS[:3]:
            store.path(key).write_bytes(b"damaged")
        found = store.check(KEYS, set_aside=True)
        assert found.missing == KEYS[:3]
        suffix = "" if number == 1 else f"-{number}"
        assert [path.name for path in found.damaged] == [f"{key}{suffix}.npz" for key in KEYS[:3]]
        assert all(path.read_bytes() == b"damaged" and path.parent.name == "damaged" for path in found.damaged)
    assert store.check(KEYS).damaged == []


def test_the_plan_comes_back_without_grids(tmp_path, plan):
    store = Store(tmp_path)
    store.write_plan(plan, "name = 'x'\n")
    back = store.read_plan()
    assert back.to_json() == plan.to_json()
    assert (tmp_path / "study.toml").read_text() == "name = 'x'\n"
    (tmp_path / "plan.json").write_text("{}")
    with pytest.raises(GridPathError, match=r"plan.json is not a plan that this version can read"):
        store.read_plan()


def altered(plan, place, value) -> dict:
    """Return a plan as its file holds it, with something else at a place, or without that if it is `DROPPED`."""
    data = json.loads(json.dumps(plan.to_json()))
    *way, last = place
    inner = functools.reduce(lambda inner, key: inner[key], way, data)
    if value is DROPPED:
        del inner[last]
    else:
        inner[last] = value
    return data


DROPPED = object()
SPEC = ("problems", 0, "spec")
GRID = (*SPEC, "grid", "random")
ALGORITHM = ("algorithms", 1, "spec")


@pytest.mark.parametrize(
    ("place", "value", "message"),
    [
        (("name",), 3, "name: name is 3, expected a text"),
        (("name",), DROPPED, "the plan has no name"),
        (("more",), 1, "the plan has no key 'more'"),
        (("budget",), {"generations": "9"}, "budget.generations: generations is '9', expected a whole number"),
        (("target",), 1.5, "target: target is 1.5, expected a number, above 0, at most 1"),
        (("reference",), {"algorithm": "NSGA2"}, "reference.algorithm: algorithm is 'NSGA2', expected a planner"),
        (("reference",), {"algorithm": "exact", "max_seconds": "x"}, "max_seconds is 'x', expected a number"),
        (("problems",), {}, "problems: problems is {}, expected a list"),
        (("problems", 0), 5, "problems[0]: problems is 5, expected a table"),
        (("problems", 0, "label"), [1], "problems[0].label: label is [1], expected a text"),
        (("problems", 0, "reference"), "../x", "reference is '../x', expected the key of a run"),
        (SPEC, [], "spec is [], expected a table"),
        ((*SPEC, "axis"), DROPPED, "the problem has no axis"),
        ((*SPEC, "goal"), 5, "problems[0].spec.goal: goal is 5, expected a cell"),
        ((*SPEC, "goal"), [900, 0], "goal is [900, 0], expected a cell of"),
        ((*SPEC, "objectives"), ["length", "size"], "there is no objective 'size'"),
        ((*SPEC, "objectives"), "length", "objectives is 'length', expected a list"),
        ((*SPEC, "representation"), "cell", "representation is 'cell'"),
        ((*SPEC, "representation"), None, "representation is None, expected what the problem is solved with"),
        ((*SPEC, "penalty"), None, "penalty is None, expected what the problem is solved with"),
        ((*SPEC, "penalty"), "2", "penalty is '2', expected a number"),
        ((*SPEC, "obstacles"), "limit", "needs potential_limit"),
        ((*SPEC, "grid"), {"width": 3}, "the grid has no digest"),
        ((*GRID, "size"), 1e9, "size is 1000000000.0, expected a whole number"),
        ((*GRID, "seed"), -1, "seed is -1, expected a whole number"),
        ((*ALGORITHM, "algorithm"), "nsga2", "algorithm is 'nsga2', expected its full name, NSGA2"),
        ((*ALGORITHM, "algorithm"), ["NSGA2"], "algorithm is ['NSGA2'], expected a text"),
        ((*ALGORITHM, "operators"), "paper", "operators is 'paper', expected a table"),
        ((*ALGORITHM, "operators"), {"base": "paper", "sampling": "x"}, "sampling is 'x', expected a table"),
        ((*ALGORITHM, "pop_size"), None, "pop_size is None, expected a whole number"),
        ((*ALGORITHM, "parameters"), None, "parameters is None, expected a table"),
        ((*ALGORITHM, "parameters"), {"rate": 1}, "takes no parameter 'rate'"),
        (("algorithms", 0, "overrides"), {"start": [0, 0]}, "overrides has no key 'start'"),
        (("algorithms", 0, "overrides"), {"obstacles": "limit"}, "needs potential_limit beside it"),
        (("algorithms", 0, "overrides"), {"axis": None}, "axis is none"),
        (("runs",), 3, "runs: runs is 3, expected a list"),
        (("runs", 0), ["a", 0, 0], "a run is ['a', 0, 0], expected its key, problem, algorithm and seed"),
        (("runs", 0, 0), "../a", "expected its key, problem, algorithm and seed"),
        (("runs", 0, 1), 99, "problem is 99, expected a whole number, 0 to"),
        (("runs", 0, 2), "0", "algorithm is '0', expected a whole number"),
        (("runs", 0, 3), 1.5, "seed is 1.5, expected a whole number"),
    ],
)
def test_a_plan_that_somebody_changed_is_refused_in_words(tmp_path, plan, place, value, message):
    (tmp_path / "plan.json").write_text(json.dumps(altered(plan, place, value)))
    with pytest.raises(GridPathError) as error:
        Store(tmp_path).read_plan()
    assert message in str(error.value) and str(error.value).endswith("`study run` writes it anew")


def test_plans_that_do_not_hang_together_are_refused(tmp_path, plan):
    data = plan.to_json()
    twice = {**data, "runs": [*data["runs"], data["runs"][0]]}
    without = {**data, "reference": None, "runs": [[*data["runs"][0][:2], None, 0]]}
    mixed = json.loads(json.dumps(data))
    mixed["problems"].append({**mixed["problems"][0], "label": "other", "spec": {**mixed["problems"][0]["spec"], "axis": "x"}})
    for changed, message in [(twice, "stands twice"), (without, "the plan no reference"), (mixed, "the others of its group")]:
        (tmp_path / "plan.json").write_text(json.dumps(changed))
        with pytest.raises(GridPathError, match=message):
            Store(tmp_path).read_plan()
    (tmp_path / "plan.json").write_text("[" * 100_000)
    with pytest.raises(GridPathError, match="nested too deeply"):
        Store(tmp_path).read_plan()


def test_folders_that_cannot_be_listed_are_named(store, monkeypatch):
    def scandir(path):
        raise PermissionError(errno.EACCES, "Permission denied", os.fspath(path))

    monkeypatch.setattr(os, "scandir", scandir)
    with pytest.raises(GridPathError, match=f"{store.folder.name}.* cannot be read: Permission denied"):
        store.check(KEYS)
    # The folders of the runs alone, once what is odd has been looked for.
    monkeypatch.setattr(Store, "_odd", lambda self: iter(()))
    with pytest.raises(GridPathError, match=r"runs.0\d cannot be read: Permission denied"):
        store.check(KEYS)
    with pytest.raises(GridPathError, match=f"{store.folder.name}.* cannot be .*: Permission denied"), store.lock():
        pass


def test_the_lock_is_for_one(store):
    with store.lock():
        with pytest.raises(GridPathError, match=r"study is in use by another run of a study"), Store(store.folder).lock():
            pass
        code = f"from pymoo_gridpath.study.running.store import Store\nwith Store({str(store.folder)!r}).lock(): print('mine')"
        answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
        assert "in use by another" in answer.stderr and not answer.stdout
    with store.lock():
        pass


def test_an_error_under_the_lock_is_its_own(store):
    with pytest.raises(BlockingIOError, match="mine"), store.lock():
        raise BlockingIOError("mine")
    with store.lock():
        pass


def test_leftovers_of_a_killed_coordinator_are_removed(store):
    leftovers = [store.path(KEYS[0]).with_name(".x.npz.0123abcd.part"), store.folder / ".plan.json.00000000.part"]
    for path in leftovers:
        path.write_bytes(b"half")
    with store.lock():
        assert not any(path.exists() for path in leftovers)
    assert sorted(stored(store.folder)) == KEYS


_FULL = """
import resource, sys
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.study.running.store import Store
resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
store = Store(sys.argv[1])
store.write("00" + "1" * 30, bytes(4000))
try:
    store.write(sys.argv[2], bytes(10000))
except GridPathError as error:
    print(error)
"""


@pytest.mark.skipif(os.name == "nt", reason="Windows has no limit on the size of files")
def test_a_full_disk_leaves_the_old_file_whole_and_no_new_one(store):
    before = store.path(KEYS[0]).read_bytes()
    answer = subprocess.run([sys.executable, "-c", _FULL, str(store.folder), KEYS[0]], capture_output=True, text=True)
    assert answer.stdout.startswith(f"{store.path(KEYS[0])} cannot be written: File too large; what is stored is whole"), answer
    assert store.path(KEYS[0]).read_bytes() == before
    assert [file.name for file in store.path(KEYS[0]).parent.iterdir() if file.name != f"{KEYS[0]}.npz"] == [
        "00" + "1" * 30 + ".npz"
    ]


def test_a_folder_that_cannot_be_made(tmp_path):
    (tmp_path / "file").write_text("")
    with (
        pytest.raises(GridPathError, match=r"file/study cannot be written to: (File exists|Not a directory)"),
        Store(tmp_path / "file/study").lock(),
    ):
        pass


def test_keys_without_an_end_are_refused(tmp_path):
    with pytest.raises(GridPathError, match="keys has no end, expected at most 1,000,000"):
        Store(tmp_path / "study").check(itertools.repeat("a"))
