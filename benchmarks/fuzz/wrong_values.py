"""Wrong values of every kind, and valid ones in another guise."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np


class Huge:
    """Its text is ten million letters long."""

    def __repr__(self):
        return "x" * 10**7


class Failing:
    """Whatever it is asked, it fails."""

    def __repr__(self):
        raise RuntimeError("no text")

    def __len__(self):
        raise RuntimeError("no length")

    def __iter__(self):
        raise RuntimeError("no items")

    def __float__(self):
        raise RuntimeError("no number")

    def __array__(self, dtype=None, copy=None):
        raise RuntimeError("no array")

    def __fspath__(self):
        raise RuntimeError("no path")


class Subclassed(np.ndarray):
    """An array of a class of its own."""


def _cyclic_list() -> list:
    ring: list = []
    ring.append(ring)
    return ring


def _cyclic_dict() -> dict:
    ring: dict = {}
    ring["ring"] = ring
    return ring


def _deep() -> list:
    nested: list = []
    for _ in range(5000):
        nested = [nested]
    return nested


def _masked(values) -> np.ndarray:
    return np.ma.masked_array(values, mask=np.ones(np.shape(values), dtype=bool))


#: Each makes a value that has nothing to do with the valid one.
PLAIN: dict[str, Callable[[], Any]] = {
    "None": lambda: None,
    "NaN": lambda: float("nan"),
    "inf": lambda: float("inf"),
    "-inf": lambda: float("-inf"),
    "-1": lambda: -1,
    "0": lambda: 0,
    "0.5": lambda: 0.5,
    "-1e308": lambda: -1e308,
    "1e308": lambda: 1e308,
    "5e-324": lambda: 5e-324,
    "10**9": lambda: 10**9,
    "2**63": lambda: 2**63,
    "-2**63 - 1": lambda: -(2**63) - 1,
    "10**400": lambda: 10**400,
    "10**5000": lambda: 10**5000,
    "True": lambda: True,
    "complex": lambda: 1j,
    "Fraction": lambda: Fraction(1, 3),
    "Decimal NaN": lambda: Decimal("sNaN"),
    "empty text": lambda: "",
    "text": lambda: "nonsense",
    "control characters": lambda: "a\x1b[31mb\n\tc\0",
    "lone surrogate": lambda: "a\ud800b",
    "long text": lambda: "long " * 10**5,
    "bytes": lambda: b"\xff\x00",
    "long bytes": lambda: b"\xff" * 10**6,
    "empty list": list,
    "empty tuple": tuple,
    "empty dict": dict,
    "dict": lambda: {"a": 1, 2: "b"},
    "set": lambda: {1, 2},
    "range": lambda: range(5),
    "list of texts": lambda: ["a", "b"],
    "ragged list": lambda: [[1], [1, 2]],
    "list of NaN": lambda: [float("nan")] * 2,
    "list of huge": lambda: [10**400, 10**400],
    "list of objects": lambda: [Huge(), Huge()],
    "list of failing": lambda: [Failing(), Failing()],
    "cyclic list": _cyclic_list,
    "cyclic dict": _cyclic_dict,
    "deep list": _deep,
    "generator": lambda: (k for k in range(3)),
    "endless generator": lambda: itertools.count(),
    "object": object,
    "huge repr": Huge,
    "failing": Failing,
    "class": lambda: int,
    "function": lambda: lambda: None,
    "module": lambda: itertools,
    "ellipsis": lambda: ...,
    "NotImplemented": lambda: NotImplemented,
    "path": lambda: Path("nowhere"),
    "int8": lambda: np.int8(-3),
    "uint64": lambda: np.uint64(2**64 - 1),
    "float16": lambda: np.float16("inf"),
    "float32": lambda: np.float32("nan"),
    "numpy bool": lambda: np.True_,
    "complex128": lambda: np.complex128(1j),
    "datetime64": lambda: np.datetime64("2020-01-01"),
    "numpy text": lambda: np.str_("a"),
    "0-d array": lambda: np.array(-2.5),
    "0-d array of an object": lambda: np.array(None),
    "0-d array of text": lambda: np.array("text"),
    "masked": lambda: np.ma.masked,
    "masked array": lambda: _masked([[1, 2], [3, 4]]),
    "array without values": lambda: np.zeros((0, 0)),
    "array of NaN": lambda: np.full((3, 3), np.nan),
    "array of objects": lambda: np.array([[None, 1], [2, "a"]], dtype=object),
    "array of texts": lambda: np.array(["a", "b"]),
    "array of dates": lambda: np.array(["2020-01-01"], dtype="datetime64[D]"),
    "structured array": lambda: np.zeros(2, dtype=[("a", int), ("b", float)]),
    "complex array": lambda: np.ones((2, 2), dtype=complex),
    "array of 4 dimensions": lambda: np.zeros((1, 2, 3, 4)),
    "large array": lambda: np.zeros(10**6),
    "matrix": lambda: np.array([[1.0, 2.0], [3.0, 4.0]]).view(np.matrix),
}

#: Each spoils a valid array.
SPOILT: dict[str, Callable[[np.ndarray], Any]] = {
    "transposed": lambda a: a.T,
    "one dimension more": lambda a: a[None],
    "first item": lambda a: a[0] if a.ndim else a,
    "no rows": lambda a: a[:0] if a.ndim else a,
    "no columns": lambda a: a[..., :0] if a.ndim else a,
    "a row less": lambda a: a[1:] if a.ndim else a,
    "a column less": lambda a: a[..., 1:] if a.ndim else a,
    "flat": lambda a: a.ravel(),
    "negative": lambda a: -1 - a.astype(float),
    "large whole numbers": lambda a: np.full(a.shape, 2**62),
    "uint64": lambda a: np.full(a.shape, 2**64 - 1, dtype=np.uint64),
    "NaN": lambda a: np.full(a.shape, np.nan),
    "inf": lambda a: np.full(a.shape, np.inf),
    "1e308": lambda a: np.full(a.shape, 1e308),
    "texts": lambda a: a.astype(str),
    "objects": lambda a: a.astype(object),
    "objects of no kind": lambda a: np.full(a.shape, None),
    "complex": lambda a: a.astype(complex),
    "masked": _masked,
    "dates": lambda a: np.zeros(a.shape, dtype="datetime64[D]"),
    "booleans": lambda a: np.ones(a.shape, dtype=bool),
    "float16": lambda a: a.astype(np.float16),
}


def _flipped(a: np.ndarray) -> np.ndarray:
    """Return an array of the same values whose steps in memory go backwards."""
    backwards = (slice(None, None, -1),) * a.ndim
    return a[backwards].copy()[backwards]


def _strided(a: np.ndarray) -> np.ndarray:
    wide = np.zeros((*a.shape[:-1], 2 * a.shape[-1]), dtype=a.dtype)
    wide[..., ::2] = a
    return wide[..., ::2]


def _read_only(a: np.ndarray) -> np.ndarray:
    copy = a.copy()
    copy.flags.writeable = False
    return copy


#: Each makes the same array in another guise, which must give what the plain one gives.
GUISES: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "column order": np.asfortranarray,
    "view of a transposed one": lambda a: a.T.copy().T,
    "flipped view": _flipped,
    "strided view": _strided,
    "read-only": _read_only,
    "subclass": lambda a: a.copy().view(Subclassed),
    "masked without a mask": lambda a: np.ma.masked_array(a.copy()),
    "swapped bytes": lambda a: a.astype(a.dtype.newbyteorder()),
}
