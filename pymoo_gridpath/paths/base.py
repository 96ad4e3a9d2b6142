"""What column paths and cell paths share."""

from __future__ import annotations

from typing import Any

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.fields import BoxedField


def sums_of(values: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """Return the sum of the values of each path, which begin at its offset, shape (N,)."""
    return np.add.reduceat(values, offsets[:-1]) if len(offsets) > 1 else values[:0]


def check_summed(field: np.ndarray | BoxedField, *shapes: tuple[int, ...]) -> Any:
    """Return a prepared field if it has one of the shapes, or is known in a box."""
    if isinstance(field, BoxedField) or (type(field) is np.ndarray and field.shape in shapes and field.dtype.kind in "iuf"):
        return field
    expected = f"numbers of shape {' or '.join(map(str, shapes))}, as the representation prepares them"
    field = checks.array("field", field, expected=expected)
    if field.shape not in shapes:
        raise GridPathError(f"field is {checks.shown(field)}, expected {expected}")
    return field


def check_chosen(index, n_paths: int):
    """Return a slice, a mask or an array of indices if it chooses among so many paths."""
    if isinstance(index, slice):
        return index
    expected = f"a slice, a mask or an array of indices of {n_paths} paths"
    chosen = checks.array("index", index, (None,), "biu", expected=expected)
    if chosen.dtype.kind == "b" and len(chosen) == n_paths:
        return chosen
    if chosen.dtype.kind == "b" or not checks.within(chosen, -n_paths, n_paths - 1):
        raise IndexError(f"index is {checks.shown(index)}, expected {expected}")
    return chosen.astype(np.int64, copy=False)


def check_place(index: int, n_paths: int) -> int:
    """Return the index of one path, counted from the end where it is negative, from the start."""
    return checks.whole("index", index, -n_paths, n_paths - 1) % n_paths
