"""Fuzz the map readers: valid maps of every format, damaged in many ways, must give a grid or one sentence that names the file.

    python benchmarks/fuzz/maps.py --count 50000 --jobs 2
    python benchmarks/fuzz/maps.py --planted

Besides what every fuzzer asks (see `harness`), a map that was not damaged is what it was written from, what must not matter
does not, and what must matter does.
"""

from __future__ import annotations

import atexit
import contextlib
import multiprocessing
import os
import shutil
import sys
import tempfile
from pathlib import Path
from unittest import mock

import map_files
import map_mutations
import numpy as np
from harness import main

from pymoo_gridpath.errors import MapError, visible
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.maps import (
    _declared,
    _files,
    array,
    format_of,
    image,
    load_map,
    movingai,
    read_scen,
    read_text_header,
    ros,
    text,
)

_FOLDER = Path(tempfile.mkdtemp(prefix="fuzzed-maps-"))
atexit.register(shutil.rmtree, _FOLDER, ignore_errors=True)


def make(seed: int):
    """Return the kind of a seed's case and the case: a map of one format, whole or damaged in one to three ways."""
    rng = np.random.default_rng(seed)
    written = map_files.FORMATS[list(map_files.FORMATS)[rng.integers(len(map_files.FORMATS))]](rng)
    mutation, files, must = map_mutations.mutate(written, rng)
    kind = f"{written.format}, {mutation}"

    def case():
        # One folder for each process; files of an earlier case would be found by names in YAML.
        folder = _FOLDER / str(os.getpid())
        if not folder.is_dir():
            folder.mkdir()
            _silence_libtiff()
        for old in folder.iterdir():
            old.unlink()
        for name, content in files.items():
            (folder / name).write_bytes(content)
        path = folder / next(iter(files))
        grid, error = _read(path, folder)
        if must == "same":
            assert grid is not None, f"a valid map was refused: {error}"
            assert np.array_equal(grid.occupied, written.occupied), "read as another map than was written"
            for key, value in written.says.items():
                assert getattr(grid, key) == value, f"{key} is {getattr(grid, key)}, written as {value}"
        elif must == "refused":
            assert grid is None, "read, though it is no such map"
        elif must == "other":
            assert grid is None or not np.array_equal(grid.occupied, written.occupied), "a change had no effect"
        if error is not None:
            raise error
        return grid

    return kind, case


def _silence_libtiff() -> None:
    """In a worker, drop what libtiff writes to the standard error about every damaged file."""
    if multiprocessing.parent_process() is not None:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)


def _read(path: Path, folder: Path) -> tuple[OccupancyGrid | None, MapError | None]:
    """Read a file with every function that takes one; return what `load_map` makes of it."""
    for reader in (format_of, read_text_header, read_scen):
        try:
            reader(path)
        except MapError as error:
            _check_error(error, folder)
    try:
        grid = load_map(path)
    except MapError as error:
        _check_error(error, folder)
        return None, error
    assert isinstance(grid, OccupancyGrid)
    return grid, None


def _check_error(error: MapError, folder: Path) -> None:
    assert str(error).startswith(visible(folder)), "names no file"
    assert "expected" in str(error) or "read_scen" in str(error), f"says not what was expected: {str(error)[:200]}"


# -- faults that are planted ------------------------------------------------------------------------------------------


def _replaced(owner, name: str, change):
    """A fault: a function of the product replaced by what ``change`` makes of it."""
    return lambda: mock.patch.object(owner, name, change(getattr(owner, name)))


def _rows_upside_down(real):
    return lambda *arguments: real(*arguments)[::-1]


def _letters_unchecked(real):
    def parse(path, body, first_line, size, free, occupied):
        everything = "".join(map(chr, range(33, 127)))
        return real(path, body, first_line, size, "".join(set(everything) - set(occupied)), occupied)

    return parse


def _with_traceback():
    real = array.NumpyFormat.read

    def read(path, **options):
        try:
            return real(path, **options)
        except MapError:
            raise KeyError("header") from None

    return mock.patch.object(array.NumpyFormat, "read", staticmethod(read))


def _last_key_wins(real):
    def init(self, path):
        content = Path(path).read_bytes().split(b"\n")
        kept = {line.partition(b":")[0]: line for line in content if b":" in line}
        Path(path).write_bytes(b"\n".join(kept.values()))
        real(self, path)

    return init


def _hungry(real):
    def read(path, *arguments):
        data = real(path, *arguments)
        return bytes(bytearray(1_200_000_000))[:0] + data if data.count(b"\n\n\n") else data

    return read


def _slow(real):
    def size(path, width, height, line=None):
        for _ in range(min(width * height, 10**9) if width * height > 10**8 else 0):
            pass
        return real(path, width, height, line)

    return size


@contextlib.contextmanager
def _declared_is_believed():
    with mock.patch.object(image, "check_png", lambda path: None), mock.patch.object(_declared, "_check_tiff", lambda *a: None):
        yield


PLANTED = {
    "rows upside down": _replaced(text, "parse_rows", _rows_upside_down),
    "unknown letters are free": _replaced(movingai, "parse_rows", _letters_unchecked),
    "a traceback for a bad array": _with_traceback,
    "of two equal keys the last wins": _replaced(ros.Keys, "__init__", _last_key_wins),
    "a gigabyte for empty lines": _replaced(text, "read_text_bytes", _hungry),
    "seconds for a giant number": _replaced(movingai, "check_size", _slow),
    "giant numbers in full": _replaced(
        _files, "plain", lambda real: lambda number: str(number) * 40 if number > 10**9 else str(number)
    ),
    "a message without its file": _replaced(movingai, "_read_header", lambda real: lambda path, data: real("a file", data)),
    "declared pixels are black": _declared_is_believed,
    "orientation ignored": _replaced(image, "TURNS", lambda real: {}),
    "nodata ignored": _replaced(image, "nodata_of", lambda real: lambda tags, mode: None),
}

if __name__ == "__main__":
    sys.exit(main(make, PLANTED, count=50_000))
