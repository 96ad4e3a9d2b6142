from __future__ import annotations

import struct

import numpy as np
import pytest
from PIL import Image, TiffImagePlugin

from pymoo_gridpath.errors import MapWarning
from pymoo_gridpath.maps import _files, read_image


def cells(grid) -> list[list[int]]:
    """Occupied cells with the top row first, as one sees the image."""
    return grid.occupied[::-1].astype(int).tolist()


def test_the_top_row_is_the_highest(write):
    grid = read_image(write("m.pgm", b"P5\n3 2\n255\n" + bytes([0, 255, 255, 255, 255, 0])))
    assert grid.occupied.astype(int).tolist() == [[0, 0, 1], [1, 0, 0]]
    assert not grid.is_free((0, 1)) and not grid.is_free((2, 0)) and grid.name == "m"


@pytest.mark.parametrize("threshold", [0.0, 0.2, 0.5, 0.8, 1.0])
def test_dark_means_below_the_threshold(write, threshold):
    # 51 / 255 is 0.2 and 204 / 255 is 0.8 exactly.
    values = [0, 50, 51, 52, 127, 128, 203, 204, 205, 255]
    grid = read_image(write("m.pgm", b"P5\n10 1\n255\n" + bytes(values)), threshold=threshold)
    assert cells(grid) == [[int(value < round(255 * threshold, 6)) for value in values]]


def test_colours_are_averaged(write, png):
    # Sums of 382 and 383 of 765 lie on either side of one half.
    rows = [bytes([255, 127, 0, 255, 128, 0, 255, 0, 0])]
    assert cells(read_image(write("m.png", png(3, 1, 8, 2, rows)))) == [[1, 0, 1]]


def test_one_bit_and_palette(write, png):
    assert cells(read_image(write("a.png", png(4, 1, 1, 0, [bytes([0b01010000])])))) == [[1, 0, 1, 0]]
    palette = (b"PLTE", bytes([0, 0, 0, 255, 255, 255, 200, 200, 200]))
    assert cells(read_image(write("b.png", png(3, 1, 8, 3, [bytes([2, 0, 1])], palette)))) == [[0, 1, 0]]
    assert cells(read_image(write("c.pbm", b"P1\n3 1\n1 0 1\n"))) == [[1, 0, 1]]


def test_sixteen_bits_keep_their_low_byte(write, png):
    values = [0, 32767, 32768, 65535]
    rows = [struct.pack(">4H", *values)]
    assert cells(read_image(write("m.png", png(4, 1, 16, 0, rows)))) == [[1, 1, 0, 0]]
    # 13107 / 65535 is 0.2 exactly; an 8-bit reading could not tell these apart.
    rows = [struct.pack(">4H", 13106, 13107, 13108, 0)]
    assert cells(read_image(write("n.png", png(4, 1, 16, 0, rows)), threshold=0.2)) == [[1, 0, 0, 1]]
    pgm = b"P5\n2 1\n65535\n" + struct.pack(">2H", 13106, 13107)
    assert cells(read_image(write("o.pgm", pgm), threshold=0.2)) == [[1, 0]]


@pytest.mark.parametrize(("unknown", "clear"), [("free", 0), ("occupied", 1)])
def test_transparent_pixels(write, png, unknown, clear):
    # Black of alpha 0 shows nothing; of alpha 127 over white it is 128 / 255, of alpha 128 it is 127 / 255.
    alphas = [0, 127, 128, 255]
    grey = [b"".join(bytes([0, alpha]) for alpha in alphas)]
    assert cells(read_image(write("la.png", png(4, 1, 8, 4, grey)), unknown=unknown)) == [[clear, 0, 1, 1]]
    colour = [b"".join(bytes([0, 0, 0, alpha]) for alpha in alphas)]
    assert cells(read_image(write("rgba.png", png(4, 1, 8, 6, colour)), unknown=unknown)) == [[clear, 0, 1, 1]]


@pytest.mark.parametrize(("unknown", "clear"), [("free", 0), ("occupied", 1)])
def test_a_transparent_colour(write, png, unknown, clear):
    key = (b"tRNS", struct.pack(">H", 7))
    assert cells(read_image(write("a.png", png(3, 1, 8, 0, [bytes([7, 8, 255])], key)), unknown=unknown)) == [[clear, 1, 0]]
    rows = [struct.pack(">3H", 7, 8, 65535)]
    assert cells(read_image(write("b.png", png(3, 1, 16, 0, rows, key)), unknown=unknown)) == [[clear, 1, 0]]
    chunks = [(b"PLTE", bytes([0, 0, 0, 255, 255, 255])), (b"tRNS", bytes([0]))]
    assert cells(read_image(write("c.png", png(2, 1, 8, 3, [bytes([0, 1])], *chunks)), unknown=unknown)) == [[clear, 0]]


def test_what_shows_nothing_is_unknown(write, png):
    rows = [bytes([0, 0, 255, 127]), bytes([0, 255, 255, 0])]
    for choice in ("free", "occupied"):
        grid = read_image(write("la.png", png(2, 2, 8, 4, rows)), unknown=choice)
        assert grid.unknown.tolist() == [[False, True], [True, False]]
    assert not read_image(write("l.png", png(2, 1, 8, 0, [bytes([0, 205])]))).unknown.any()


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_nodata_of_gdal_is_unknown(tmp_path, dtype):
    path = tmp_path / "m.tif"
    tags = TiffImagePlugin.ImageFileDirectory_v2()
    tags[42113] = "7"
    white = np.iinfo(dtype).max
    Image.fromarray(np.array([[0, 7, white]], dtype)).save(path, tiffinfo=tags)
    for unknown, clear in (("free", 0), ("occupied", 1)):
        grid = read_image(path, unknown=unknown)
        assert cells(grid) == [[1, clear, 0]] and cells(grid.replace(occupied=grid.unknown)) == [[0, 1, 0]]
    # A value that no pixel can have changes nothing.
    tags[42113] = "-9999"
    Image.fromarray(np.array([[0, 7, white]], dtype)).save(path, tiffinfo=tags)
    assert cells(read_image(path)) == [[1, 1, 0]] and not read_image(path).unknown.any()


YAML = "image: {}\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("room.yaml", YAML.format("room.pgm"), True),
        ("other.yml", YAML.format("'./room.pgm'"), True),
        ("room.yaml", "image:\troom.pgm\n", True),
        ("room.yaml", YAML.format("hall.pgm"), False),
        ("room.yaml", YAML.format("no.pgm"), False),
        ("room.yaml", "image: [\n", False),
        ("room.yaml", "image: room.pgm\n# " + "x" * 70_000, False),
        ("room.txt", YAML.format("room.pgm"), False),
    ],
)
def test_the_yaml_file_of_a_map_beside_its_image_is_named(write, recwarn, name, text, said):
    path = write("room.pgm", b"P5\n2 1\n255\n\0\xff")
    write("hall.pgm", b"P5\n2 1\n255\n\0\xff")
    write(name, text)
    read_image(path)
    messages = [str(item.message) for item in recwarn if item.category is MapWarning]
    assert len(messages) == said
    assert all(message.startswith(f"{path}: {name} ") for message in messages)


@pytest.mark.parametrize("name", ["m.bmp", "m.gif", "m.tif", "m.webp", "m.jpg"])
def test_other_formats(tmp_path, name):
    image = Image.new("L", (32, 16), 255)
    image.paste(0, (0, 0, 16, 8))
    image.save(tmp_path / name)
    grid = read_image(tmp_path / name, corner_cutting=True, resolution=0.1, origin=(1, 2, 3))
    assert grid.n_occupied == 128 and grid.occupied[8:, :16].all()
    assert (grid.corner_cutting, grid.resolution, grid.origin) == (True, 0.1, (1.0, 2.0, 3.0))


@pytest.mark.parametrize(
    ("mode", "words"), [("F", ["floating-point"]), ("I", ["70000", "16 bits"])], ids=["floating-point", "32 bits"]
)
def test_pixels_of_no_known_range_are_refused(tmp_path, refused, mode, words):
    path = tmp_path / "m.tif"
    Image.new(mode, (2, 2), 70000).save(path)
    refused(read_image, path, None, *words)


@pytest.mark.parametrize("content", [b"", b"hello", b"\x89PNG\r\n\x1a\n", b"P5\n"])
def test_what_is_no_image_is_refused(write, refused, content):
    refused(read_image, write("bad.png", content), None, "image")


def test_formats_that_pillow_hands_to_other_programs_are_not_opened(write, refused):
    eps = b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\n%%EndComments\n"
    refused(read_image, write("drawing.png", eps), None, "no image can be recognised")


def test_a_truncated_image_is_refused(write, refused, png):
    refused(read_image, write("a.pgm", b"P5\n3 2\n255\n" + bytes(5)), None, "cut short")
    refused(
        read_image, write("b.png", png(64, 64, 8, 0, [bytes(range(k, k + 64)) for k in range(64)])[:-30]), None, "cut short"
    )
    refused(read_image, write("c.png", png(0, 0, 8, 0, [])), None, "image")
    refused(read_image, write("d.pgm", b"P5\n0 0\n255\n"), None, "image")


@pytest.mark.parametrize("factor", [1.5, 3.0], ids=["where Pillow warns", "where Pillow raises"])
def test_decompression_bombs_are_refused_unread(write, refused, png, monkeypatch, factor):
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 1000)
    path = write("bomb.png", png(int(1000 * factor), 1, 8, 0, [b""]))
    refused(read_image, path, None, "too large", "1000 pixels")


def test_the_size_is_checked_before_the_pixels(write, refused, png, monkeypatch):
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", None)
    # There are no pixels in this file: a reader that decoded it would call it damaged.
    path = write("bomb.png", png(20_000, 5_001, 8, 0, [b""]))
    refused(read_image, path, None, "20000 x 5001", f"at most {_files.MAX_CELLS}")


@pytest.mark.parametrize(
    ("option", "value"), [("threshold", 1.5), ("threshold", "dark"), ("threshold", float("nan")), ("unknown", "grey")]
)
def test_bad_options_are_refused(write, refused, option, value):
    path = write("m.pgm", b"P5\n1 1\n255\n\0")
    refused(read_image, path, None, option, value, **{option: value})
