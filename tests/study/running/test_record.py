"""The bytes of a run."""

from __future__ import annotations

import dataclasses
import hashlib
import io
import json
import struct
import zipfile

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from small_studies import history, record

from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.exact import Certificate
from pymoo_gridpath.study.running.record import DamagedRecordError, History, RunRecord, from_bytes, read_meta, to_bytes


def assert_same(a: RunRecord, b: RunRecord) -> None:
    for item in dataclasses.fields(RunRecord):
        x, y = getattr(a, item.name), getattr(b, item.name)
        if isinstance(x, np.ndarray):
            assert (x.dtype, x.shape, x.tobytes()) == (y.dtype, y.shape, y.tobytes()), item.name
        elif item.name == "history" and x is not None:
            for part in dataclasses.fields(History):
                one, other = getattr(x, part.name), getattr(y, part.name)
                assert (one.dtype, one.tobytes()) == (other.dtype, other.tobytes()), part.name
        else:
            assert x == y, item.name


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {
            "history": None,
            "status": "failed",
            "message": "Traceback\n  \u2026 \ud800",
            "X": np.empty((0, 0)),
            "F": np.empty((0, 2)),
        },
        {"X": np.array([[True, False], [False, True]])},
        {"X": np.array([[0.1, np.pi]]), "F": np.array([[-0.0, 1e-300]])},
        {"X": np.array([[2**40, -(2**40)]])},
        {"X": np.empty((0, 7), dtype=int), "F": np.empty((0, 2))},
        {"budget": None, "seed": 0, "certified": Certificate(0.0, 0.0)},
        {"complete": False, "certified": Certificate(np.inf, 0.25)},
    ],
)
def test_what_is_read_is_what_was_written(changes):
    assert_same(record(**changes), from_bytes(to_bytes(record(**changes))))


@example(np.array([[-1, 2**53 + 1]]))
@given(arrays.arrays(st.sampled_from(["i1", "u1", "i8", "u8", "i4"]), st.tuples(st.integers(0, 3), st.integers(0, 3))))
def test_whole_numbers_of_any_size_come_back(X):
    back = from_bytes(to_bytes(record(X=X))).X
    assert (back.dtype, back.shape, back.tolist()) == (X.dtype, X.shape, X.tolist())


def test_numpy_and_zip_open_the_file():
    data = to_bytes(record())
    with np.load(io.BytesIO(data)) as file:
        assert file["X"].tolist() == record().X.tolist()
        assert file["F"].tolist() == record().F.tolist()
        assert file["records"]["evaluations"].tolist() == [20, 40, 60]
        assert file["span"].tolist() == [[1, 2], [1, 1], [2, 2]]
        assert json.loads(file["meta.json"])["seed"] == 3
    assert zipfile.ZipFile(io.BytesIO(data)).testzip() is None


def test_meta_is_what_the_archive_says():
    data = to_bytes(record())
    meta = read_meta(data)
    assert meta == json.loads(zipfile.ZipFile(io.BytesIO(data)).read("meta.json"))
    assert (meta["status"], meta["versions"]["pymoo"], meta["problem"]["penalty"]) == ("finished", "0.6.2", None)


def test_every_changed_byte_is_noticed():
    data = to_bytes(record())
    for k in range(len(data)):
        damaged = bytearray(data)
        damaged[k] ^= 1 << k % 8
        with pytest.raises(DamagedRecordError):
            read_meta(bytes(damaged))


def test_every_missing_end_is_noticed():
    data = to_bytes(record())
    for damaged in [*(data[:k] for k in range(len(data))), data + b"\0", data[1:], bytes(len(data))]:
        with pytest.raises(DamagedRecordError):
            from_bytes(damaged)


def seal(data: bytes) -> bytes:
    return data + b"sha256 " + hashlib.sha256(data).hexdigest().encode()


def archive(**members) -> bytes:
    """Return a zip archive that begins with the description of a run."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as made:
        made.writestr("meta.json", zipfile.ZipFile(io.BytesIO(to_bytes(record()))).read("meta.json"))
        for name, data in members.items():
            made.writestr(f"{name}.npy", data)
    return file.getvalue()


def test_what_is_no_run_is_damaged_although_its_checksum_is_right():
    whole = to_bytes(record())[:-71]
    assert from_bytes(seal(whole[:-2] + struct.pack("<H", 71))).key == record().key
    headless = [b"", b"PK", bytes(30) + b"{}", bytes(26) + b"\2\0\0\0{}", b"x" * 100]
    # The description stands first, and what follows is no archive, or one without the arrays.
    armless = [whole[: whole.index(b"PK", 4)], archive(), archive(X=b"", F=b"", turn=b""), archive(F=b"\x93NUMPY\1\0")]
    for data in headless:
        with pytest.raises(DamagedRecordError, match="the run "):
            read_meta(seal(data))
    for data in [*headless, *armless]:
        for genes in (True, False):
            with pytest.raises(DamagedRecordError, match="the run "):
                from_bytes(seal(data), genes)


def test_a_later_format_is_refused(monkeypatch):
    monkeypatch.setattr("pymoo_gridpath.study.running.record.FORMAT", 2)
    data = to_bytes(record())
    monkeypatch.undo()
    with pytest.raises(GridPathError, match="has format 2, expected at most 1; a later pymoo_gridpath wrote it") as error:
        from_bytes(data)
    assert not isinstance(error.value, DamagedRecordError)


def test_front_of_a_record():
    run = history()
    assert [run.front(k).tolist() for k in range(3)] == [[], [[2, 2], [3, 1]], [[2, 1.5], [3, 1]]]
    assert run.front(-1).tolist() == run.front(2).tolist()
    for k in (3, -4, 1.0, True, "1"):
        with pytest.raises(GridPathError, match=rf"k is {k!r}, expected a whole number of at least -3 and at most 2"):
            run.front(k)


def test_a_run_of_a_few_dozen_points_takes_a_few_kilobytes():
    rng = np.random.default_rng(1)
    points = rng.random((200, 2))
    first = np.sort(rng.integers(0, 100, 200)).astype(np.int32)
    past = dataclasses.replace(history(100), points=points, first=first, last=np.minimum(first + 10, 99).astype(np.int32))
    data = to_bytes(record(X=rng.integers(0, 8, (40, 63)), F=rng.random((40, 2)), history=past))
    assert len(data) < 12_000
