from __future__ import annotations

import io
import struct

import numpy as np
import pytest

from pymoo_gridpath.errors import MapError
from pymoo_gridpath.maps import _files, array, read_npy


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


@pytest.mark.parametrize("block", [1, 5, 1 << 22])
def test_views_are_read_as_their_contiguous_copies(write, monkeypatch, block):
    monkeypatch.setattr(array, "BLOCK", block)
    base = np.random.default_rng(1).random((6, 7)) < 0.4
    frozen = base.copy()
    frozen.flags.writeable = False
    for view in (base.T, base[::-1], base[:, ::-1], base[::2, 1::3], np.asfortranarray(base), frozen, base.astype(">f2").T):
        assert np.array_equal(read_npy(write("m.npy", saved(view))).occupied, view.astype(bool))
    wrong = np.asfortranarray(base.astype("u1"))
    wrong[4, 2] = 9
    for layout in "CF":
        with pytest.raises(MapError, match=r"cell \(2, 4\) holds 9"):
            read_npy(write("m.npy", saved(np.array(wrong, order=layout))))


def test_what_a_header_declares_is_not_believed(write, refused):
    """Neither more cells than bytes, nor numbers and types that would fill the screen."""
    header = "{{'descr': {}, 'fortran_order': False, 'shape': ({}, {})}}".format
    refused(read_npy, write("a.npy", with_header(header("'<f8'", 9000, 9000), bytes(99))), None, "99 bytes", "648000000")
    error = refused(read_npy, write("b.npy", with_header(header("'|u1'", "9" * 4000, 1))), None, "over 10^15")
    assert len(str(error)) < 400
    wide = "[" + ", ".join(f"('field{k}', '<i4')" for k in range(400)) + "]"
    error = refused(read_npy, write("c.npy", with_header(header(wide, 1, 1))), None, "booleans")
    assert len(str(error)) < 400
