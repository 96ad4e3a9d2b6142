from __future__ import annotations

import io
import struct

import numpy as np
import pytest

from pymoo_gridpath.maps import _files, read_npy


def saved(array, **options) -> bytes:
    stream = io.BytesIO()
    np.save(stream, array, **options)
    return stream.getvalue()


def with_header(header: str, data: bytes = b"") -> bytes:
    """A .npy file built by hand."""
    text = header.encode() + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + data


def test_row_zero_is_the_bottom_row(write):
    data = with_header("{'descr': '|u1', 'fortran_order': False, 'shape': (2, 3)}", bytes([0, 0, 1, 1, 0, 0]))
    grid = read_npy(write("m.npy", data))
    assert grid.occupied.tolist() == [[False, False, True], [True, False, False]]
    assert not grid.is_free((2, 0)) and grid.is_free((2, 1)) and grid.name == "m"


@pytest.mark.parametrize("dtype", ["?", "<i8", ">i2", "u1", "<f4", ">f8"])
@pytest.mark.parametrize("order", ["C", "F"])
def test_booleans_and_numbers_of_any_kind(write, dtype, order):
    expected = [[0, 1, 1], [1, 0, 0]]
    grid = read_npy(write("m.npy", saved(np.array(expected).astype(dtype, order=order))), corner_cutting=True, resolution=2)
    assert grid.occupied.astype(int).tolist() == expected
    assert grid.corner_cutting and grid.resolution == 2


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", ["NumPy"]),
        (b"....", ["NumPy"]),
        (saved(np.zeros((2, 2)))[:-1], ["whole .npy file"]),
        (saved(np.zeros((2, 2)))[:30], ["whole .npy file"]),
        (with_header("{'descr'"), ["whole .npy file"]),
        (saved(np.zeros(3)), ["1 dimensions", "2"]),
        (saved(np.zeros((2, 2, 2))), ["3 dimensions", "2"]),
        (saved(np.zeros((0, 3))), ["3 x 0"]),
        (saved(np.array([[0, 1], [0, 2]])), ["(1, 1)", "holds 2"]),
        (saved(np.array([[0, np.nan], [0, 0]])), ["(1, 0)", "nan"]),
        (saved(np.array([["a"]])), ["<U1", "booleans"]),
        (saved(np.array([[1j]])), ["complex128", "booleans"]),
        (with_header("{'descr': '|u1', 'fortran_order': False, 'shape': (99999999, 99999999)}"), ["99999999 x 99999999"]),
    ],
)
def test_bad_arrays_are_refused(write, refused, data, words):
    refused(read_npy, write("bad.npy", data), None, *words)


class Trap:
    sprung = False

    def __reduce__(self):
        return setattr, (Trap, "sprung", True)


def test_pickled_objects_are_never_loaded(write, refused):
    data = saved(np.array([[Trap()]]), allow_pickle=True)
    refused(read_npy, write("trap.npy", data), None, "object", "booleans")
    assert not Trap.sprung


def test_too_large_arrays_are_refused(write, refused, monkeypatch):
    path = write("m.npy", saved(np.zeros((3, 3), bool)))
    monkeypatch.setattr(_files, "MAX_CELLS", 8)
    refused(read_npy, path, None, "3 x 3", "at most 8 cells")
