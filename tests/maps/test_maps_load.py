from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pymoo_gridpath.errors import GridError, GridPathError, MapError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.maps import MAP_FORMATS, format_of, load_map

FUZZ = Path(__file__).resolve().parents[2] / "benchmarks" / "fuzz"

CELLS = [[0, 0, 1], [0, 0, 0]]


def npy() -> bytes:
    stream = io.BytesIO()
    np.save(stream, np.array(CELLS, bool))
    return stream.getvalue()


PGM = b"P5\n3 2\n255\n" + bytes([255, 255, 255, 255, 255, 0])
YAML = b"image: m.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
MOVINGAI = b"type octile\nheight 2\nwidth 3\nmap\n...\n..T\n"
TEXT = b"resolution: 1\n...\n..#\n"
SCEN = b"version 1\n0\tm.map\t3\t2\t0\t0\t1\t0\t1\n"
KINDS = {"npy": npy(), "pgm": PGM, "yaml": YAML, "map": MOVINGAI, "txt": TEXT}


@pytest.mark.parametrize("kind", list(KINDS))
def test_every_format_by_its_usual_name(write, kind):
    write("m.pgm", PGM)
    assert load_map(write(f"m.{kind}", KINDS[kind])).occupied.astype(int).tolist() == CELLS


@pytest.mark.parametrize("kind", list(KINDS))
@pytest.mark.parametrize("name", ["m", "m.dat", "m.txt"])
def test_content_goes_before_the_suffix(write, kind, name):
    write("m.pgm", PGM)
    assert load_map(write(name, KINDS[kind])).occupied.astype(int).tolist() == CELLS


@pytest.mark.parametrize("kind", list(KINDS))
def test_common_options(write, kind):
    write("m.pgm", PGM)
    path = write(f"m.{kind}", KINDS[kind])
    assert load_map(path, corner_cutting=True).corner_cutting
    assert not load_map(path, corner_cutting=None).corner_cutting
    assert load_map(path, corner_cutting="one side").corner_cutting == "one side"
    assert (load_map(path, moves=4).moves, load_map(path).moves) == (4, 8)
    with pytest.raises(GridError, match="moves is 5, expected 4 or 8"):
        load_map(path, moves=5)
    if kind != "yaml":
        grid = load_map(path, resolution=0.5, origin=(1, 2), unknown=None)
        assert (grid.resolution, grid.origin) == (0.5, (1.0, 2.0, 0.0))
        assert load_map(path).resolution == (1.0 if kind == "txt" else None), "only what the file or the caller states"
        if kind != "txt":
            with pytest.raises(MapError, match=r"origin is \(1, 2\), in metres, and no resolution is given"):
                load_map(path, origin=(1, 2))


@pytest.mark.parametrize("kind", ["yaml", "pgm"])
def test_an_option_without_effect_is_said(write, kind, recwarn):
    write("m.pgm", PGM)
    path = write(f"m.{kind}", KINDS[kind])
    load_map(path, unknown=None)
    before = len(recwarn)
    load_map(path, unknown="occupied")
    (said,) = [item for item in recwarn.list[before:] if "effect" in str(item.message)]
    assert said.filename == __file__
    assert str(said.message) == f"{path}: the map has no unknown cell, so that the option 'unknown' has no effect"


@pytest.mark.parametrize(
    ("kind", "options"),
    [
        ("yaml", {"resolution": 1}),
        ("yaml", {"threshold": 1}),
        ("map", {"unknown": "free"}),
        ("npy", {"unknown": "free"}),
        ("txt", {"threshold": 0.5}),
        ("pgm", {"radius": 1}),
    ],
)
def test_an_option_that_the_format_does_not_know_is_refused(write, refused, kind, options):
    write("m.pgm", PGM)
    refused(load_map, write(f"m.{kind}", KINDS[kind]), None, *options, "does not take", "corner_cutting", **options)


@pytest.mark.parametrize(
    ("name", "content", "line", "words"),
    [
        ("m.png", b"hello", None, ["image"]),
        ("m.npy", b"hello", None, ["NumPy"]),
        ("m.map", b"....\n", 1, ["type octile"]),
        ("m.yaml", b"....\n", None, ["mapping"]),
        ("m.txt", b"hello\n", 1, ["'h'"]),
        ("m.dat", b"PK\x03\x04\x00\x00", None, ["binary"]),
        ("m.txt", b"\xff\xfe.", 1, ["UTF-8"]),
        ("m.txt", b"", None, ["no row"]),
        ("m.scen", SCEN, None, ["read_scen"]),
        ("m.3dmap", b"voxel 3 2 4\n0 1 2\n", None, ["voxel map", "three dimensions"]),
        ("m.txt", b"voxel 3 2 4\n0 1 2\n", None, ["voxel map"]),
        ("m.3dmap", b"", None, ["voxel map"]),
    ],
)
def test_what_is_no_map_is_refused(write, refused, name, content, line, words):
    refused(load_map, write(name, content), line, *words)


def test_what_is_no_file_is_refused(tmp_path, refused):
    refused(load_map, tmp_path, None, "directory")
    refused(load_map, tmp_path / "no.yaml", None, "no such file")
    refused(load_map, tmp_path / "no", None, "no such file")
    with pytest.raises(GridPathError, match=r"path is 'bad\\x00name.map', expected the path of a file"):
        load_map("bad\0name.map")
    with pytest.raises(GridPathError, match=r"path is 'x+\.\.\.x+', expected the path of a file"):
        load_map("x" * 5000)


def test_unknown_names_list_the_shipped_maps(refused):
    refused(load_map, "warehosue", None, "did you mean 'warehouse'", "office, paper16, warehouse")
    error = refused(load_map, "moon", None, "office, paper16, warehouse")
    assert "did you mean" not in str(error)
    refused(load_map, "warehouse", None, "unknown", "does not take", unknown="free")


def test_a_file_goes_before_a_shipped_map_and_that_before_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "office").mkdir()
    assert load_map("office").shape == (40, 60)
    (tmp_path / "warehouse").write_text("..\n")
    assert load_map("warehouse").shape == (1, 2)


# -- whatever the bytes are, there is a grid or one clean error ---------------------------------------------------------

SUFFIXES = [".map", ".yaml", ".yml", ".png", ".pgm", ".gif", ".tif", ".npy", ".txt", ".dat", ""]
fuzz = settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


def loads_or_refuses(path, content: bytes) -> None:
    path.write_bytes(content)
    try:
        grid = load_map(path)
    except MapError as error:
        assert "\n" not in str(error).removeprefix(str(path)) and "expected" in str(error)
    else:
        assert isinstance(grid, OccupancyGrid)


@fuzz
@given(content=st.binary(max_size=200), suffix=st.sampled_from(SUFFIXES))
def test_random_bytes(tmp_path, content, suffix):
    loads_or_refuses(tmp_path / f"fuzz{suffix}", content)


@fuzz
@given(content=st.text(alphabet=".#01@TWS \n\t:,[]{}&*!-'\"image type map é\0", max_size=100), suffix=st.sampled_from(SUFFIXES))
def test_random_text(tmp_path, content, suffix):
    loads_or_refuses(tmp_path / f"fuzz{suffix}", content.encode())


@fuzz
@given(data=st.data())
def test_damaged_maps(tmp_path, png, data):
    (tmp_path / "m.pgm").write_bytes(PGM)
    kinds = {**KINDS, "png": png(3, 2, 16, 0, [bytes(6)] * 2), "rgba.png": png(1, 1, 8, 6, [bytes(4)])}
    kind = data.draw(st.sampled_from(sorted(kinds)))
    content = bytearray(kinds[kind])
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(content) - 1))
        content[at : at + data.draw(st.integers(0, 3))] = data.draw(st.binary(max_size=3))
        content = content or bytearray(b"\n")
    loads_or_refuses(tmp_path / f"fuzz.{kind}", bytes(content))


def test_the_fuzzer_writes_maps_of_every_format(tmp_path, monkeypatch):
    if not FUZZ.is_dir():
        pytest.skip("the benchmarks are not beside the tests")
    monkeypatch.syspath_prepend(FUZZ)
    import map_files

    seen = set()
    for name, write in map_files.FORMATS.items():
        for written in map(write, (np.random.default_rng(seed) for seed in range(3))):
            (tmp_path / name).mkdir(exist_ok=True)
            for file, content in written.files.items():
                (tmp_path / name / file).write_bytes(content)
            if written.format != "scen":
                path = tmp_path / name / next(iter(written.files))
                seen.add(type(format_of(path)))
                np.testing.assert_array_equal(load_map(path).occupied, written.occupied)
    ours = {kind for kind in MAP_FORMATS.values() if kind.__module__.startswith("pymoo_gridpath.")}
    assert ours <= seen
