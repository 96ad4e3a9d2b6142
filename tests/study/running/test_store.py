"""The folder of a study."""

from __future__ import annotations

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
    assert store.check(KEYS).missing == KEYS
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
