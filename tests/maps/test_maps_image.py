from __future__ import annotations

import struct

import numpy as np
import pytest
from PIL import Image, TiffImagePlugin

from pymoo_gridpath.errors import MapWarning
from pymoo_gridpath.maps import _declared, _files, load_map, read_image, read_ros
from pymoo_gridpath.maps import image as image_reader


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


def test_decompression_bombs_are_refused_unread(write, refused, png, monkeypatch):
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 1000)
    refused(read_image, write("bomb.png", png(3000, 1, 8, 0, [b""])), None, "too large", f"at most {_files.MAX_CELLS}")
    # Where Pillow only warns, the largest number of cells decides.
    assert read_image(write("m.png", png(1500, 1, 8, 0, [bytes(1500)]))).n_occupied == 1500
    monkeypatch.setattr(_files, "MAX_CELLS", 1499)
    refused(read_image, write("m.png", png(1500, 1, 8, 0, [bytes(1500)])), None, "1500 x 1", "1499")


def test_the_size_is_checked_before_the_pixels(write, refused, png, monkeypatch):
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", None)
    # There are no pixels in this file: a reader that decoded it would call it damaged.
    path = write("bomb.png", png(20_000, 5_001, 8, 0, [b""]))
    refused(read_image, path, None, "20000 x 5001", f"at most {_files.MAX_CELLS}")


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("threshold", 1.5),
        ("threshold", "0.5"),
        ("threshold", "dark"),
        ("threshold", float("nan")),
        ("unknown", "grey"),
    ],
)
def test_bad_options_are_refused(write, refused, option, value):
    path = write("m.pgm", b"P5\n1 1\n255\n\0")
    refused(read_image, path, None, option, value, **{option: value})


def test_a_threshold_of_any_size_is_refused(write, refused):
    refused(read_image, write("m.pgm", b"P5\n1 1\n255\n\0"), None, "threshold", "expected", threshold=10**400)


# -- what is declared and what is there --------------------------------------------------------------------------------


def tiff(tags: dict[int, tuple[int, ...] | bytes], data: bytes) -> bytes:
    """A TIFF built by hand; the data stand behind the tags, and where a tag holds -1, their place is put in."""
    entries, later = b"", b""
    start = 8 + 2 + 12 * len(tags) + 4
    for tag, values in sorted(tags.items()):
        kind, size = (2, len(values)) if isinstance(values, bytes) else (4, 4 * len(values))
        where = start + sum(len(v) if isinstance(v, bytes) else 4 * len(v) for v in tags.values())
        packed = (
            values if isinstance(values, bytes) else struct.pack(f"<{len(values)}I", *(where if v == -1 else v for v in values))
        )
        entries += struct.pack("<HHI", tag, kind, len(values))
        entries += packed.ljust(4, b"\0") if size <= 4 else struct.pack("<I", start + len(later))
        later = later + packed
    return b"II*\0" + struct.pack("<IH", 8, len(tags)) + entries + bytes(4) + later + data


def grey_tiff(width, height, data, compression=1, strips=1, **more) -> bytes:
    tags = {
        256: (width,),
        257: (height,),
        258: (8,),
        259: (compression,),
        262: (1,),
        273: (-1,) * strips,
        277: (1,),
        278: (height,),
    }
    return tiff({**tags, 279: (len(data),) * strips, **{int(k[1:]): v for k, v in more.items()}}, data)


def test_a_tiff_is_believed_with_the_bytes_behind_it(write, refused):
    assert cells(read_image(write("a.tif", grey_tiff(3, 2, bytes([0, 255, 255, 255, 0, 0]))))) == [[1, 0, 0], [0, 1, 1]]
    declared = "9 x 8781830"
    refused(read_image, write("b.tif", grey_tiff(9, 8_781_830, bytes(20))), None, declared, "too few")
    refused(read_image, write("c.tif", grey_tiff(9, 8_781_830, bytes(18), t278=(2,))), None, declared, "1 of them")
    refused(read_image, write("d.tif", grey_tiff(9, 8_781_830, bytes(18), compression=8)), None, declared, "too few")
    refused(read_image, write("e.tif", grey_tiff(9, 8_781_830, bytes(18), compression=4, t258=(1,))), None, declared, "too few")
    refused(read_image, write("f.tif", grey_tiff(3, 6, bytes(6) * 9, t278=(2,))), None, "3 parts", "1 of them")
    refused(read_image, write("g.tif", grey_tiff(1, 200_000, bytes(200_000), strips=200_000, t278=(1,))), None, "200000 parts")
    tiles = {"t322": (4096,), "t323": (4096,), "t324": (-1,), "t325": (9,)}
    refused(read_image, write("h.tif", grey_tiff(3, 3, bytes(9), **tiles)), None, "tiles of 4096 x 4096")


@pytest.mark.parametrize("at", [2**63 - 1, 2**63, 2**64 - 1])
def test_a_tiff_with_its_directory_beyond_every_file_is_refused(write, refused, at):
    """Where a number of 64 bits says that it lies."""
    path = write("a.tif", b"II+\0\x08\0\0\0" + struct.pack("<Q", at) + bytes(40))
    refused(read_image, path, None, "damaged or cut short")
    refused(load_map, path, None, "damaged or cut short")


@pytest.mark.parametrize("compression", [1, 5, 8, 32773])
def test_tiffs_of_every_usual_kind_are_believed(tmp_path, compression):
    expected = np.random.default_rng(compression).random((300, 200)) < 0.3
    names = {1: None, 5: "tiff_lzw", 8: "tiff_adobe_deflate", 32773: "packbits"}
    Image.fromarray(np.where(expected, 0, 255).astype(np.uint8)).save(tmp_path / "m.tif", compression=names[compression])
    assert np.array_equal(cells(read_image(tmp_path / "m.tif")), expected)
    Image.new("1", (4000, 5000), 1).save(tmp_path / "blank.tif", compression="group4")
    assert read_image(tmp_path / "blank.tif").n_occupied == 0


@pytest.mark.parametrize("interlaced", [0, 1])
def test_a_png_whose_pixels_end_early_is_refused(write, refused, png, interlaced):
    """Pillow leaves them black, without a word."""
    whole = png(10, 10, 8, 0, [bytes([255] * 10)] * 10)
    assert read_image(write("a.png", whole)).n_occupied == 0
    for rows in (7, 9):
        short = png(10, 10, 8, 0, [bytes([255] * 10)] * rows, interlaced=interlaced)
        refused(read_image, write("b.png", short), None, "damaged" if interlaced else f"{11 * (10 - rows)} bytes early")
    # Black to the last row is a map like others.
    assert read_image(write("c.png", png(10, 10, 8, 0, [bytes(10)] * 10))).n_occupied == 100


def test_other_images_are_believed_with_the_bytes_behind_them(tmp_path, write, refused):
    image = Image.new("L", (100, 100), 255)
    image.save(tmp_path / "a.jpg")
    data = bytearray((tmp_path / "a.jpg").read_bytes())
    struct.pack_into(">HH", data, data.index(b"\xff\xc0") + 5, 9000, 9000)
    refused(read_image, write("b.jpg", bytes(data)), None, "9000 x 9000", "too few")
    image.save(tmp_path / "a.gif")
    data = bytearray((tmp_path / "a.gif").read_bytes())
    struct.pack_into("<HH", data, 6, 9000, 9000)
    refused(read_image, write("b.gif", bytes(data)), None, "10000 of 9000 x 9000")


def test_images_that_take_too_long_are_refused(tmp_path, write, refused, png, monkeypatch):
    monkeypatch.setattr(_declared, "MAX_READS", 300)
    assert read_image(write("a.png", png(1, 1, 8, 0, [b"\xff"], *[(b"abCd", b"")] * 20))).n_occupied == 0
    refused(read_image, write("b.png", png(1, 1, 8, 0, [b"\xff"], *[(b"abCd", b"")] * 200)), None, "image")
    monkeypatch.setattr(_declared, "MAX_PLAIN", 50)
    refused(read_image, write("c.pgm", b"P2 30 1 1" + b" 1" * 30), None, "69 bytes", "at most 50", "binary")
    Image.new("L", (64, 64)).save(tmp_path / "d.jpg", progressive=True)
    assert read_image(tmp_path / "d.jpg").n_occupied == 64 * 64
    monkeypatch.setattr(_declared, "MAX_SCANNED", 64 * 64 * 3)
    refused(read_image, tmp_path / "d.jpg", None, "scans", "not progressive")
    monkeypatch.setattr(image_reader, "MAX_DECODED", 7999)
    refused(read_image, write("e.ppm", b"P6 50 20 255\n" + bytes(3000)), None, "8000 bytes", "7999")
    assert read_image(write("f.pgm", b"P5 50 20 255\n" + bytes(1000))).n_occupied == 1000
    rows = [bytes([9]) * 20 * 8] * 50
    refused(read_image, write("g.png", png(20, 50, 16, 6, rows)), None, "16000 bytes")
    monkeypatch.setattr(image_reader, "MAX_DECODED", 8000)
    assert read_image(write("h.png", png(20, 50, 8, 6, [row[:80] for row in rows]))).shape == (50, 20)


def test_tags_and_exif_of_too_many_values_are_refused(write, refused, png, monkeypatch):
    monkeypatch.setattr(_declared, "MAX_VALUES", 50)
    refused(read_image, write("a.tif", grey_tiff(3, 1, bytes(3), t37500=(0,) * 51)), None, "tag 37500", "51 values")
    nested = struct.pack("<HHHII", 1, 37500, 3, 999, 0)
    data = grey_tiff(3, 1, bytes(3) + nested, t34665=(0,))
    place = struct.pack("<HHI", 34665, 4, 1)
    data = data.replace(place + bytes(4), place + struct.pack("<I", len(data) - len(nested)))
    refused(read_image, write("b.tif", data), None, "tag 37500", "999 values")
    monkeypatch.setattr(_declared, "MAX_EXIF", 103)
    refused(read_image, write("c.png", png(1, 1, 8, 0, [b"\0"], (b"eXIf", b"II*\0" + bytes(96)))), None, "106 bytes", "EXIF")
    assert read_image(write("d.png", png(1, 1, 8, 0, [b"\0"], (b"eXIf", b"II*\0" + bytes(90))))).n_occupied == 1


def test_signed_pixels_are_refused(write, refused):
    data = grey_tiff(3, 1, bytes([255, 0, 100]), t339=(2,))
    refused(read_image, write("a.tif", data), None, "signed", "8 bits")
    wide = grey_tiff(3, 1, struct.pack("<3h", -1, 0, 100), t258=(16,), t339=(2,))
    refused(read_image, write("b.tif", wide), None, "from -1 to 100")


@pytest.mark.parametrize(("unknown", "clear"), [("free", 0), ("occupied", 1)])
def test_nodata_is_unknown_whatever_the_pixels_are(write, unknown, clear):
    def read(data):
        grid = read_image(write("m.tif", data), unknown=unknown)
        assert grid.unknown[::-1].astype(int).tolist() == [[0, 1, 0]]
        return cells(grid)

    assert read(grey_tiff(3, 1, bytes([0, 7, 255]), t42113=b"7\0")) == [[1, clear, 0]]
    assert read(grey_tiff(3, 1, bytes([0, 7, 255]), t262=(0,), t42113=b"7\0")) == [[0, clear, 1]]
    signed = grey_tiff(3, 1, struct.pack("<3h", 0, -9999, 32767), t258=(16,), t339=(2,), t42113=b"-9999\0")
    assert read(signed) == [[1, clear, 1]]


@pytest.mark.parametrize("name", ["m.jpg", "m.png", "m.webp", "m.tif"])
@pytest.mark.parametrize("orientation", range(1, 9))
def test_exif_orientation_is_applied(tmp_path, refused, name, orientation):
    """A corner of the image, named in the text of EXIF by the place of row 0 and column 0."""
    image = Image.new("L", (48, 32), 255)
    image.paste(0, (0, 0, 16, 16))
    exif = Image.Exif()
    exif[0x0112] = orientation
    image.save(
        tmp_path / name, exif=exif, **({"quality": 100} if name == "m.jpg" else {"lossless": True} if "webp" in name else {})
    )
    seen = np.array(cells(read_image(tmp_path / name)))
    assert seen.shape == ((32, 48) if orientation < 5 else (48, 32))
    top = orientation in (1, 2, 5, 6)
    left = orientation in (1, 4, 5, 8)
    corner = seen[:16] if top else seen[-16:]
    assert (corner[:, :16] if left else corner[:, -16:]).all() and seen.sum() == 256
    yaml = "image: {}\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.19\n"
    (tmp_path / "m.yaml").write_text(yaml.format(name))
    if orientation == 1:
        assert read_ros(tmp_path / "m.yaml").n_occupied == 256
    else:
        refused(lambda _: read_ros(tmp_path / "m.yaml"), tmp_path / name, None, "EXIF orientation")


def test_images_are_read_alike_in_blocks_of_any_size(write, png, monkeypatch):
    rng = np.random.default_rng(5)
    files = [
        write("a.png", png(7, 9, 8, 0, [rng.bytes(7) for _ in range(9)])),
        write("b.png", png(7, 9, 8, 6, [rng.bytes(28) for _ in range(9)])),
        write("c.png", png(7, 9, 16, 0, [rng.bytes(14) for _ in range(9)], (b"tRNS", b"\0\7"))),
        write("d.png", png(7, 9, 8, 0, [rng.bytes(7) for _ in range(9)], (b"tRNS", b"\0\7"))),
        write("e.tif", grey_tiff(7, 9, rng.bytes(63), t42113=b"7\0")),
    ]
    expected = [read_image(file) for file in files]
    for block in (1, 7, 20):
        monkeypatch.setattr(_files, "BLOCK", block)
        assert [read_image(file) for file in files] == expected
