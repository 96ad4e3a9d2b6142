"""What is kept of a run, and the bytes of its file."""

from __future__ import annotations

import hashlib
import io
import json
import math
import struct
import zipfile
import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.exact import Certificate
from pymoo_gridpath.study.running.epochs import Epochs

#: Version of the file's layout; a reader refuses files of a later one.
FORMAT = 1

_META = "meta.json"
_SEAL = b"sha256 "
_SEAL_SIZE = len(_SEAL) + 64
_RECORD = np.dtype(
    [("evaluations", "<i8"), ("seconds", "<f8"), ("n_legal", "<i8"), ("n_members", "<i8"), ("best_length", "<f8")]
)


class DamagedRecordError(GridPathError):
    """The bytes of a run that are not what was written."""


@dataclass(frozen=True, eq=False)
class History:
    """How a run converged: at most about a hundred records, one every so many generations.

    Attributes
    ----------
    evaluations : numpy.ndarray, shape (T,), int64
        Evaluations spent at each record; the first record is of the first generation, the last of the last one.
    seconds : numpy.ndarray, shape (T,)
        Since the run began.
    n_legal, n_members : numpy.ndarray, shape (T,), int64
        Members of the population that are legal paths, and all.
    best_length : numpy.ndarray, shape (T,)
        The least length of a legal path in cells, ``inf`` if there is none, NaN if length is not an objective.
    points : numpy.ndarray, shape (P, n_obj)
        Objectives of the points that were ever in the front at a record.
    first, last : numpy.ndarray, shape (P,), int32
        The records from which to which, inclusive, each point was in it. A point that left and came back is there twice.
    """

    evaluations: np.ndarray
    seconds: np.ndarray
    n_legal: np.ndarray
    n_members: np.ndarray
    best_length: np.ndarray
    points: np.ndarray
    first: np.ndarray
    last: np.ndarray

    def __len__(self) -> int:
        return len(self.evaluations)

    def front(self, k: int) -> np.ndarray:
        """Return the legal non-dominated points of record k, shape (n, n_obj), sorted by the objectives from the first on.

        Parameters
        ----------
        k : int
            Counted from 0; from the last record backwards if it is negative.

        Raises
        ------
        GridPathError
            If there is no such record.
        """
        k = checks.whole("k", k, -len(self), len(self) - 1) % len(self)
        points = self.points[(self.first <= k) & (k <= self.last)]
        return points[np.lexsort(points.T[::-1])]


@dataclass(frozen=True, eq=False)
class RunRecord:
    """One run of a study.

    Attributes
    ----------
    key : str
        The key of its task.
    seed : int
    status : {"finished", "failed"}
    message : str
        The traceback of a failed run; what the exact search says of itself; else empty.
    complete : bool
        Whether an exact front is whole; True for every other finished run, False for a failed one.
    seconds : float
        Wall time of the search.
    n_eval, n_gen : int
        Evaluations and generations spent.
    started : str
        When, in UTC, as ISO 8601.
    versions, machine : dict
        Of the packages that decide about the result, and what it ran on.
    problem, algorithm : dict
        In canonical form.
    budget : dict or None
    objectives : list of str
        Names of the columns of F.
    X : numpy.ndarray, shape (N, n_var)
    F : numpy.ndarray, shape (N, n_obj)
        Legal non-dominated solutions at the end, each point once, sorted by the objectives from the first on. N may be 0.
    turn : numpy.ndarray, shape (N,)
        Total turn of each in degrees; of paths with the same objectives, the one that turns least is there.
    n_legal, n_members : int
        Members of the final population that are legal paths, and all.
    history : History or None
        None for failed runs.
    epochs : Epochs or None
        None where obstacles do not move, and for failed runs.
    certified : Certificate or None
        How near an exact search has proven its front to be; None where nothing is proven, as of all other runs.
    """

    key: str
    seed: int
    status: str
    message: str
    complete: bool
    seconds: float
    n_eval: int
    n_gen: int
    started: str
    versions: dict[str, str]
    machine: dict[str, Any]
    problem: dict[str, Any]
    algorithm: dict[str, Any]
    budget: dict[str, int] | None
    objectives: list[str]
    X: np.ndarray
    F: np.ndarray
    turn: np.ndarray
    n_legal: int
    n_members: int
    history: History | None
    epochs: Epochs | None = None
    certified: Certificate | None = None


# What is not written as it is.
_APART = ("X", "F", "turn", "history", "epochs", "certified")


def to_bytes(record: RunRecord) -> bytes:
    """Return a run as the bytes of an ``.npz`` file that `numpy.load` opens.

    Its members are ``meta.json`` (everything that is no array), ``X``, ``F``, ``turn``, and of the history ``records``
    (structured, of shape (T,)), ``points`` and ``span`` (first and last record of each point); where obstacles move also
    ``epochs`` (structured, of shape (n_epochs,)), ``epoch_points``, ``epoch_of_points`` and ``epoch_of_records``. The comment
    of the archive is the SHA-256 of all that stands before it.
    """
    meta = {"format": FORMAT} | {key: value for key, value in vars(record).items() if key not in _APART}
    if record.certified is not None:
        # JSON has no infinity.
        meta["certified"] = {name: value if math.isfinite(value) else None for name, value in vars(record.certified).items()}
    # Whole numbers go into the smallest type that holds them; this is what they were.
    meta["dtype"] = record.X.dtype.str
    arrays = {"X": _narrowed(record.X), "F": record.F, "turn": record.turn}
    if record.history is not None:
        arrays |= _packed(record.history)
    if record.epochs is not None:
        arrays |= record.epochs.packed()
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        # First and not compressed, so that it can be read without unpacking.
        archive.writestr(zipfile.ZipInfo(_META), json.dumps(meta, allow_nan=False, separators=(",", ":")))
        for name, array in arrays.items():
            member = io.BytesIO()
            np.lib.format.write_array(member, np.ascontiguousarray(array), allow_pickle=False)
            info = zipfile.ZipInfo(f"{name}.npy")
            archive.writestr(info, member.getvalue(), zipfile.ZIP_DEFLATED, compresslevel=2)
        archive.comment = bytes(_SEAL_SIZE)
    data = file.getvalue()[:-_SEAL_SIZE]
    return data + _SEAL + hashlib.sha256(data).hexdigest().encode()


def from_bytes(data: bytes, genes: bool = True) -> RunRecord:
    """Return the run that `to_bytes` wrote; without genes if these are not wanted.

    Raises
    ------
    DamagedRecordError
        If the bytes are not what was written.
    """
    meta = read_meta(data)
    del meta["format"]
    try:
        kind = np.dtype(meta.pop("dtype"))
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            arrays = {
                name.removesuffix(".npy"): np.lib.format.read_array(io.BytesIO(archive.read(name)), allow_pickle=False)
                for name in archive.namelist()
                if name != _META and (genes or name != "X.npy")
            }
        history = _unpacked(arrays) if "records" in arrays else None
        X = arrays["X"].astype(kind, copy=False) if genes else np.empty((len(arrays["F"]), 0), dtype=kind)
        epochs = Epochs.unpacked(arrays)
        if meta.get("certified") is not None:
            given = {name: math.inf if value is None else float(value) for name, value in meta["certified"].items()}
            meta["certified"] = Certificate(**given)
        return RunRecord(**meta, X=X, F=arrays["F"], turn=arrays["turn"], history=history, epochs=epochs)
    except (zipfile.BadZipFile, zlib.error, AttributeError, KeyError, ValueError, TypeError):
        raise DamagedRecordError("the run has a checksum and no arrays, expected what a study writes") from None


def read_meta(data: bytes) -> dict[str, Any]:
    """Return what is no array in the bytes of a run: one hash and no unpacking.

    Raises
    ------
    DamagedRecordError
        If the bytes are not what was written.
    """
    size = len(data) - _SEAL_SIZE
    if size < 0 or data[size : size + len(_SEAL)] != _SEAL:
        raise DamagedRecordError("the run does not end with its checksum, expected a file that was written to its end")
    if hashlib.sha256(memoryview(data)[:size]).hexdigest().encode() != data[size + len(_SEAL) :]:
        raise DamagedRecordError("the run does not match its checksum, expected the bytes that were written")
    try:
        # The header of the first member of a zip archive, section 4.3.7 of its specification.
        *_, length, name, extra = struct.unpack_from("<4s5H3L2H", data)
        begin = 30 + name + extra
        meta = json.loads(data[begin : begin + length])
        missing = {"format", "key", "status", "message", "complete", "versions", "dtype"} - set(meta)
        later = not missing and meta["format"] > FORMAT
    except (struct.error, ValueError, TypeError):
        raise DamagedRecordError("the run has a checksum and no description, expected what a study writes") from None
    if missing:
        raise DamagedRecordError(f"the run does not say its {sorted(missing)[0]}, expected what a study writes")
    if later:
        raise GridPathError(
            f"the run {meta['key']} has format {meta['format']}, expected at most {FORMAT}; a later pymoo_gridpath wrote it"
        )
    return meta


def _narrowed(X: np.ndarray) -> np.ndarray:
    """Return whole numbers in the smallest type that holds them all."""
    if X.dtype.kind not in "iu" or not X.size:
        return X
    least, most = int(X.min()), int(X.max())
    kinds = (np.int8, np.int16, np.int32, np.int64) if least < 0 else (np.uint8, np.uint16, np.uint32, np.uint64)
    return X.astype(next(kind for kind in kinds if np.iinfo(kind).min <= least and most <= np.iinfo(kind).max))


def _packed(history: History) -> dict[str, np.ndarray]:
    records = np.empty(len(history), dtype=_RECORD)
    for name in _RECORD.names or ():
        records[name] = getattr(history, name)
    return {"records": records, "points": history.points, "span": np.column_stack([history.first, history.last])}


def _unpacked(arrays: dict[str, np.ndarray]) -> History:
    records, span = arrays["records"], arrays["span"]
    columns = {name: np.ascontiguousarray(records[name]) for name in _RECORD.names or ()}
    return History(**columns, points=arrays["points"], first=span[:, 0].copy(), last=span[:, 1].copy())
