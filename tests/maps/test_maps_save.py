"""Maps that are written, read back, and by others; matrices of numbers."""

from __future__ import annotations

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from pymoo_gridpath import OccupancyGrid, load_map
from pymoo_gridpath.errors import MapError
from pymoo_gridpath.maps import _matrix, save_map

numbers = st.floats(-1e6, 1e6).filter(lambda value: value == 0 or abs(value) > 1e-9)


@st.composite
def grids(draw, metres=False):
    shape = draw(st.integers(1, 9)), draw(st.integers(1, 9))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    occupied = rng.random(shape) < 0.4
    unknown = draw(st.sampled_from([None, occupied & (rng.random(shape) < 0.5)]))
    in_metres = metres or draw(st.booleans())
    return OccupancyGrid(
        occupied,
        resolution=draw(st.floats(1e-6, 1e6)) if in_metres else None,
        origin=(draw(numbers), draw(numbers), draw(st.floats(-4, 4))) if in_metres else (0, 0),
        corner_cutting=draw(st.sampled_from([False, True, "one side"])),
        name=draw(st.sampled_from(["grid", "a b", "K\u00f6ln: 1", "'\"", "1e-5"])),
        unknown=unknown,
        moves=draw(st.sampled_from([8, 4])),
    )


@settings(max_examples=60)
@given(grids(), st.sampled_from([".yaml", ".yml", ".txt", ".map", ".npy"]))
def test_what_is_written_is_read_back(tmp_path_factory, grid, suffix):
    file = tmp_path_factory.mktemp("maps") / ("m\u00e4p 1" + suffix)
    if grid.resolution is None and suffix in (".yaml", ".yml"):
        with pytest.raises(MapError, match="in cells, expected one with a resolution, which a ROS map states"):
            save_map(grid, file)
        assert not list(file.parent.iterdir())
        return
    path = save_map(grid, file)
    same = load_map(path)
    assert np.array_equal(same.occupied, grid.occupied)
    if suffix in (".yaml", ".yml", ".txt"):
        assert (same.resolution, same.origin) == (grid.resolution, grid.origin)
    if suffix == ".txt":
        assert (same.name, same.corner_cutting, same.moves) == (grid.name, grid.corner_cutting, grid.moves)
    if suffix in (".yaml", ".yml"):
        expected = np.zeros(grid.shape, dtype=bool) if grid.unknown is None else grid.unknown
        assert np.array_equal(same.unknown, expected)
        if expected.any():
            assert np.array_equal(load_map(path, unknown="free").occupied, grid.occupied & ~expected)


@settings(max_examples=30)
@given(grids(metres=True))
def test_others_read_what_is_written_for_ros(tmp_path_factory, grid):
    """PyYAML, which map servers of ROS 1 use, and Pillow."""
    path = save_map(grid, tmp_path_factory.mktemp("maps") / "map.yaml")
    settings = yaml.safe_load(path.read_text(encoding="utf-8"))
    assert (settings["resolution"], tuple(settings["origin"])) == (grid.resolution, grid.origin)
    with Image.open(path.with_name(settings["image"])) as image:
        grey = np.asarray(image)[::-1]
    p = (255 - grey) / 255
    unknown = np.zeros(grid.shape, dtype=bool) if grid.unknown is None else grid.unknown
    assert np.array_equal(p > settings["occupied_thresh"], grid.occupied & ~unknown)
    assert np.array_equal(p < settings["free_thresh"], ~grid.occupied & ~unknown)


def test_a_suffix_that_nothing_is_written_for_is_refused(tmp_path):
    grid = OccupancyGrid([[0, 1]])
    with pytest.raises(MapError, match=r"no map format of the suffix '\.doc', expected one of \.map, \.npy, \.txt, \.yaml"):
        save_map(grid, tmp_path / "map.doc")
    with pytest.raises(MapError, match="format 'image' are read and not written"):
        save_map(grid, tmp_path / "map.png")
    with pytest.raises(MapError, match="three dimensions are not written"):
        save_map(grid, tmp_path / "map.3dmap")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("arguments", [{}, {"fmt": "%d"}, {"fmt": "%d", "delimiter": ","}, {"fmt": "%g", "delimiter": " ; "}])
def test_matrices_of_savetxt_are_read(tmp_path, arguments):
    occupied = np.random.default_rng(1).random((7, 5)) < 0.4
    np.savetxt(tmp_path / "map.txt", occupied[::-1], **arguments)
    assert np.array_equal(load_map(tmp_path / "map.txt").occupied, occupied)
    text = (tmp_path / "map.txt").read_text()
    (tmp_path / "header.txt").write_text(f"resolution: 0.05\n\n{text}")
    grid = load_map(tmp_path / "header.txt")
    assert np.array_equal(grid.occupied, occupied) and grid.resolution == 0.05


@pytest.mark.parametrize("block", [1, 7, 1000])
@pytest.mark.parametrize("write", ["{:d}", "{:.1f}", "{:e}", "0{:d}"])
def test_matrices_are_read_alike_in_blocks_of_any_size(tmp_path, monkeypatch, block, write):
    occupied = np.random.default_rng(2).random((9, 4)) < 0.5
    rows = [" ".join(map(write.format, row)) for row in occupied[::-1].astype(int)]
    path = tmp_path / "map.txt"
    monkeypatch.setattr(_matrix, "_BLOCK", block)
    path.write_text("\n".join(rows))
    assert np.array_equal(load_map(path).occupied, occupied)
    for wrong, said in (("0 1 0", "3 numbers"), ("0 1 0 1 0", "5 numbers"), ("", "0 numbers"), ("0 1 0 2", "'2' in column 4")):
        path.write_text("\n".join([*rows[:6], wrong, *rows[7:]]))
        with pytest.raises(MapError, match=f"line 7: .*{said}"):
            load_map(path)


def test_a_row_of_too_many_bytes_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(_matrix, "_LONGEST_ROW", 9)
    monkeypatch.setattr(_matrix, "_BLOCK", 2)
    path = tmp_path / "map.txt"
    path.write_text("0 1 0 1 0\n0 0 0 0 0")
    assert load_map(path).shape == (2, 5)
    for text, line in (("0 1 0 1 00\n0 0 0 0 0", 1), ("0 1 0 1 0\n0 0 0 0 0\n0 0 0 0 0 0 0 0 0", 3)):
        path.write_text(text)
        with pytest.raises(MapError, match=f"line {line}: the row has 1[07] bytes, expected at most 9"):
            load_map(path)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("0 1 0\n0 2 0\n", "line 2: found '2' in column 2, expected 0"),
        ("0 1 0\n0 1\n", "line 2: the row has 2 numbers, expected 3"),
        ("0 1 0\n\n0 1 0\n", "line 2: the row has 0 numbers, expected 3"),
        ("0,1,0\n0,x,0\n", "line 2: found 'x' in column 2"),
        ("0,1,0\n0,nan,0\n", "line 2: found 'nan' in column 2"),
    ],
)
def test_other_matrices_are_refused_with_the_line(tmp_path, text, said):
    (tmp_path / "map.txt").write_text(text)
    with pytest.raises(MapError, match=said):
        load_map(tmp_path / "map.txt")
