"""What every map format must do, as a class of tests."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pymoo_gridpath.errors import GridPathError, MapError, visible
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.maps import MAP_FORMATS, MapFormat, Query, _files, format_of, load_map, query_of
from pymoo_gridpath.testing.global_state import global_state

# Heights and widths: no map looks like its mirror image or its transpose.
SHAPES = ((1, 1), (1, 7), (6, 1), (5, 9), (12, 4))

# Files of other kinds, which no format may take for its own by their content.
FOREIGN = {
    "numpy": b"\x93NUMPY\x01\x00v\x00{'descr': '|b1', 'fortran_order': False, 'shape': (1, 2), }".ljust(127) + b"\n\x00\x01",
    "image": b"P5\n2 1\n255\n\x00\xff",
    "movingai": b"type octile\nheight 1\nwidth 2\nmap\n.@\n",
    "ros": b"image: m.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n",
    "text": b"name: m\n\n.#\n..\n",
    "no map": b"\x00\x01\x02 of no format at all \xff\xfe",
}

GARBAGE = (b"", b"\n", b"\x00" * 64, bytes(range(256)), b"\xff\xfe\xfa" * 40, b"-1 -1\n" * 9)

# What an option is set to, and how the grid says that it took effect.
OPTIONS: dict[str, tuple[Any, Any]] = {
    "corner_cutting": (True, True),
    "resolution": (0.25, 0.25),
    "origin": ((1.5, -2.0), (1.5, -2.0, 0.0)),
}

# An origin is one in metres.
BESIDE = {"origin": {"resolution": 0.25}}


class MapFormatSuite:
    """Tests that every `MapFormat` must pass; inherit from it, and set `format` and `write`.

    Attributes
    ----------
    format : type of MapFormat

    Examples
    --------
    >>> from pymoo_gridpath.maps.text import TextFormat
    >>> class TestText(MapFormatSuite):
    ...     format = TextFormat
    ...
    ...     def write(self, path, grid):
    ...         path.write_text("\\n".join("".join(".#"[cell] for cell in row) for row in grid.occupied[::-1].astype(int)))
    """

    format: type[MapFormat]

    def write(self, path: Path, grid: OccupancyGrid) -> None:
        """Write which cells of a grid are occupied to a file of this format, without calling its reader."""
        raise NotImplementedError("the suite needs a method write(self, path, grid) that writes a file of the format")

    def write_query(self, path: Path, grid: OccupancyGrid, query: Query) -> None:
        """Write a grid and the query that its file names; needed where the format has a `query` of its own."""
        raise NotImplementedError("the suite needs a method write_query(self, path, grid, query), since the format has a query")

    # -- helpers ------------------------------------------------------------------------------------------------------

    def _made(self, folder: Path, grid: OccupancyGrid, name: str = "map") -> Path:
        path = folder / f"{name}{self.format.suffixes[0]}"
        self.write(path, grid)
        return path

    def _read_or_refused(self, path: Path) -> OccupancyGrid | None:
        """Return what is read, or None if it is refused as it should be."""
        try:
            return self.format().read(path)
        except MapError as error:
            message, named = str(error), Path(error.path)
            # Or of a file that the map consists of.
            own = named == path or (named.parent == path.parent and named.is_file())
            assert own and message.startswith(visible(named)), f"the message does not begin with the file's name: {message}"
            assert "expected" in message and "\n" not in message, f"not one line that says what was expected: {message}"
            return None

    # -- tests --------------------------------------------------------------------------------------------------------

    def test_it_is_registered(self):
        assert MAP_FORMATS[self.format.name] is self.format
        assert self.format.suffixes and all(one == one.lower() and one.startswith(".") for one in self.format.suffixes)

    def test_what_is_written_is_read(self, tmp_path):
        """Row 0 is the bottom row, column 0 the left one."""
        for k, grid in enumerate(_grids()):
            path = self._made(tmp_path, grid, f"map{k}")
            for given in (path, os.fspath(path)):
                found = self.format().read(given)
                assert isinstance(found, OccupancyGrid)
                assert found.shape == grid.shape
                assert np.array_equal(found.occupied, grid.occupied)

    def test_it_is_found_by_what_it_is(self, tmp_path):
        grid = _grids()[-1]
        path = self._made(tmp_path, grid)
        assert type(format_of(path)) is self.format
        assert np.array_equal(load_map(path).occupied, grid.occupied)
        if self.format().matches(path.read_bytes()[:4096], path):
            # What the content tells holds whatever the name.
            other = path.with_suffix(".other")
            path.rename(other)
            assert self.format().matches(other.read_bytes()[:4096], other)
            assert type(format_of(other)) is self.format

    def test_it_takes_no_files_of_others(self, tmp_path):
        for name, content in FOREIGN.items():
            if name in MAP_FORMATS and issubclass(self.format, MAP_FORMATS[name]):
                continue
            path = tmp_path / "foreign.other"
            path.write_bytes(content)
            assert self.format().matches(content, path) is False, f"takes a file of the format {name!r} for its own"

    def test_its_options_have_an_effect(self, tmp_path):
        path = self._made(tmp_path, _grids()[-1])
        options = self.format().options
        assert "corner_cutting" in options
        for name, (value, expected) in OPTIONS.items():
            if name in options:
                beside = {key: one for key, one in BESIDE.get(name, {}).items() if key in options}
                assert getattr(load_map(path), name) != expected
                assert getattr(load_map(path, **beside, **{name: value}), name) == expected

    def test_options_that_it_does_not_know_are_refused(self, tmp_path):
        path = self._made(tmp_path, _grids()[-1])
        with pytest.raises(MapError, match="does not take the option 'no_such_option', expected one of "):
            load_map(path, no_such_option=1)

    def test_bad_options_are_refused(self, tmp_path):
        path = self._made(tmp_path, _grids()[-1])
        for name in ("corner_cutting", "resolution", "origin"):
            if name in self.format().options:
                with pytest.raises(GridPathError):
                    load_map(path, **dict[str, Any]({name: "nonsense"}))

    def test_garbage_is_refused(self, tmp_path):
        for k, content in enumerate(GARBAGE):
            path = tmp_path / f"garbage{k}{self.format.suffixes[0]}"
            path.write_bytes(content)
            assert self._read_or_refused(path) is None, f"reads {content[:9]!r}... as a map"

    def test_damaged_files_are_read_or_refused(self, tmp_path):
        """In whatever way a file is cut short or changed, there is a grid or one clean error."""
        path = self._made(tmp_path, _grids()[-1])
        content, rng = path.read_bytes(), np.random.default_rng(1)
        cuts = [content[:end] for end in range(0, len(content), max(len(content) // 30, 1))]
        changes = []
        for _ in range(60):
            changed = bytearray(content)
            changed[rng.integers(len(content))] = rng.integers(256)
            changes.append(bytes(changed))
        for damaged in cuts + changes:
            path.write_bytes(damaged)
            self._read_or_refused(path)

    def test_what_is_no_file_is_refused(self, tmp_path):
        for path in (tmp_path / f"missing{self.format.suffixes[0]}", tmp_path):
            assert self._read_or_refused(path) is None

    def test_maps_that_are_too_large_are_refused(self, tmp_path, monkeypatch):
        path = self._made(tmp_path, _grids()[-1])
        n_cells = _grids()[-1].occupied.size
        monkeypatch.setattr(_files, "MAX_CELLS", n_cells)
        assert self._read_or_refused(path) is not None
        monkeypatch.setattr(_files, "MAX_CELLS", n_cells - 1)
        assert self._read_or_refused(path) is None, "reads more than MAX_CELLS cells; check_size refuses them"

    def test_reading_changes_nothing(self, tmp_path):
        path = self._made(tmp_path, _grids()[-1])
        before = {file: file.read_bytes() for file in tmp_path.iterdir()}
        folder, state = os.getcwd(), global_state()
        first = self.format().read(path)
        kept = first.occupied.copy()
        assert self.format().read(path) == first
        self.format().query(path)
        assert {file: file.read_bytes() for file in tmp_path.iterdir()} == before
        assert os.getcwd() == folder
        assert global_state() == state
        # The grid is no view of the file.
        path.write_bytes(bytes(len(before[path])))
        assert np.array_equal(first.occupied, kept)

    def test_its_query_is_that_of_the_file(self, tmp_path):
        path = tmp_path / f"map{self.format.suffixes[0]}"
        if self.format.query is MapFormat.query:
            self.write(path, _grids()[-1])
            assert query_of(path) == Query()
            return
        grid = OccupancyGrid(np.zeros((4, 6)))
        query = Query((1, 0), (4, 3), 0.75)
        self.write_query(path, grid, query)
        found = query_of(path)
        assert (found.start, found.goal) == (query.start, query.goal)
        # Not all formats say a radius.
        assert found.radius in (query.radius, 0.0)
        assert np.array_equal(load_map(path).occupied, grid.occupied)


def _grids() -> list[OccupancyGrid]:
    rng = np.random.default_rng(7)
    return [OccupancyGrid(rng.random(shape) < 0.4) for shape in SHAPES]
