"""What image files declare against what they hold, looked at before a decoder believes it or after one did.

Decoders leave at zero, which is black, what a file declares and does not hold, or need minutes for it.
"""

from __future__ import annotations

import io
import math
import os
import re
import struct
import zlib
from typing import Any, BinaryIO

from PIL import Image

from pymoo_gridpath.errors import MapError
from pymoo_gridpath.maps._files import MAX_CELLS

# Of more strips or tiles, Pillow makes lists that take seconds and hundreds of megabytes.
MAX_STRIPS = 100_000
MAX_TAGS, MAX_VALUES, MAX_EXIF = 4096, 250_000, 1_000_000
# Images with more parts (chunks, segments, blocks, runs) than this take seconds, however small they are.
MAX_READS = 1_000_000
# Plain (ASCII) PNM is decoded at 8 MB/s.
MAX_PLAIN = 16_000_000
# A progressive JPEG is gone through once for each of its scans.
MAX_SCANNED = 1_000_000_000
# A block of 64 cells takes a bit at least.
JPEG_CELLS_PER_BYTE = 512

WIDTH, HEIGHT, BITS, COMPRESSION, PHOTOMETRIC, SAMPLES, ROWS, PLANAR = 256, 257, 258, 259, 262, 277, 278, 284
STRIPS, TILE_WIDTH, TILE_LENGTH, TILES, SAMPLE_FORMAT, GDAL_NODATA = 273, 322, 323, 324, 339, 42113
# What says where a raster lies: the keys that GDAL writes with any place, the side of a pixel, and a matrix.
PLACE = (34735, 33550, 34264)
Tags = dict[int, Any]
"""The values of a TIFF's tags: a tuple of whole numbers, or bytes."""

_TIFF = rb"II[*+]\0|MM\0[*+]"

_KINDS = {1: "B", 2: "s", 3: "H", 4: "I", 16: "Q"}
# How many bytes a byte of the file can stand for at most. Facsimile codes need a bit for each row instead.
_RATIOS = {1: 1, 5: 2730, 7: 3 * JPEG_CELLS_PER_BYTE, 8: 1040, 32946: 1040, 32773: 64}
# Directories within directories: EXIF, GPS, interoperability.
_DIRECTORIES = (34665, 34853, 40965)
_FACSIMILE = (2, 3, 4)


class CountedReader(io.BufferedReader):
    """A file that raises OSError when it is read in too many parts, each of which costs a decoder a step in Python."""

    def __init__(self, path: str | os.PathLike[str]):
        super().__init__(io.FileIO(path))
        self.left = MAX_READS

    def read(self, size: int | None = -1, /) -> bytes:
        self.left -= 1
        if self.left < 0:
            raise OSError("too many parts")
        return super().read(size)


def check_before(path, file: BinaryIO) -> Tags:
    """Raise MapError where a file declares what it cannot hold, or would take too long; return the tags if it is a TIFF."""
    head = file.read(4)
    size = os.fstat(file.fileno()).st_size
    tags = {}
    if re.match(rb"P[123]\s", head) and size > MAX_PLAIN:
        raise MapError(
            path, f"the file has {size} bytes of numbers as text, expected at most {MAX_PLAIN}, or a binary PNM file"
        )
    if re.match(_TIFF, head):
        try:
            tags = _read_tags(path, file, ">" if head[:1] == b"M" else "<", b"+" in head)
        except (struct.error, OverflowError):
            raise MapError(path, "the image is damaged or cut short, expected a whole image file") from None
        _check_tiff(path, tags, size)
    file.seek(0)
    return tags


def tags_of_tiff(path: str | os.PathLike[str]) -> Tags:
    """Return the tags of a TIFF as far as they are whole numbers or text, of others their kind; none if it is no sound one."""
    try:
        with open(path, "rb") as file:
            head = file.read(4)
            if not re.match(_TIFF, head):
                return {}
            end, big = ">" if head[:1] == b"M" else "<", b"+" in head
            tags = _read_tags(path, file, end, big)
            file.seek(8 if big else 4)
            known = _entries(path, file, end, big, _unpack(file, end + ("Q" if big else "I"))[0])
            return {tag: (kind,) for tag, kind, *_ in known} | tags
    except (OSError, MapError, struct.error, OverflowError):
        return {}


def _read_tags(path, file: BinaryIO, end: str, big: bool) -> Tags:
    """Read the tags of whole numbers and of text in the first directory of a TIFF file; of strips and tiles, as many zeros."""
    file.seek(8 if big else 4)
    tags = {}
    pointer = end + ("Q" if big else "I")
    for tag, kind, number, value in _entries(path, file, end, big, _unpack(file, pointer)[0]):
        if tag in (STRIPS, TILES) and number > MAX_STRIPS:
            raise MapError(path, f"the image is in {number} parts, expected at most {MAX_STRIPS} strips or tiles")
        if tag in _DIRECTORIES:
            # Pillow reads these as well.
            for nested, *_, place in _entries(path, file, end, big, struct.unpack_from(pointer, value)[0]):
                if nested in _DIRECTORIES:
                    _entries(path, file, end, big, struct.unpack_from(pointer, place)[0])
        if tag in (STRIPS, TILES):
            tags[tag] = (0,) * number
        elif kind in _KINDS and number:
            form = f"{end}{number}{_KINDS[kind]}"
            if struct.calcsize(form) > len(value):
                _go(file, struct.unpack(pointer, value)[0])
                value = file.read(struct.calcsize(form))
            values = struct.unpack(form, value[: struct.calcsize(form)])
            tags[tag] = values[0] if kind == 2 else values
    return tags


def _entries(path, file: BinaryIO, end: str, big: bool, at: int) -> list[tuple[int, int, int, bytes]]:
    """Return the tags of a directory with their kind, count and value, or raise MapError where they are too many."""
    _go(file, at)
    (count,) = _unpack(file, end + ("Q" if big else "H"))
    if count > MAX_TAGS:
        raise MapError(path, f"the image has {count} tags, expected at most {MAX_TAGS}")
    entry = struct.Struct(end + ("HHQ8s" if big else "HHI4s"))
    entries = [entry.unpack(file.read(entry.size)) for _ in range(count)]
    for tag, kind, number, _ in entries:
        # Bytes stay bytes; of other kinds, Pillow makes a number each.
        if number > MAX_VALUES and kind not in (1, 2, 7):
            raise MapError(path, f"the tag {tag} of the image has {number} values, expected at most {MAX_VALUES}")
    return entries


def _go(file: BinaryIO, at: int) -> None:
    """Go to where a file says that there is more, or raise OverflowError where no file can have any."""
    if at >= 2**63:
        raise OverflowError(f"byte {at} of a file")
    file.seek(at)


def _unpack(file: BinaryIO, form: str) -> tuple[int, ...]:
    return struct.unpack(form, file.read(struct.calcsize(form)))


def _check_tiff(path, tags, size: int) -> None:
    def first(tag: int, default: int) -> int:
        return tags[tag][0] if isinstance(tags.get(tag), tuple) else default

    width, height = first(WIDTH, 0), first(HEIGHT, 0)
    samples = max(first(SAMPLES, 1), 1)
    bits = first(BITS, 1)
    if bits == 8 and 2 in tags.get(SAMPLE_FORMAT, ()):
        raise MapError(path, "the pixels are signed numbers of 8 bits, expected whole numbers of 8 or 16 bits, zero or more")
    if not (width and height) or width * height > MAX_CELLS:
        return  # Whatever opens it says so.
    cells = f"the image declares {width} x {height} cells"
    down, across = first(ROWS, height), width
    if TILES in tags:
        down, across = first(TILE_LENGTH, 0), first(TILE_WIDTH, 0)
        if down * across > 4 * width * height + 2**20:
            raise MapError(path, f"{cells} in tiles of {across} x {down}, expected tiles no larger than the image")
    if down and across:
        parts = math.ceil(height / down) * math.ceil(width / across) * (samples if first(PLANAR, 1) == 2 else 1)
        found = len(tags.get(TILES, tags.get(STRIPS, ())))
        if found < parts:
            raise MapError(path, f"{cells} in {parts} parts and has {found} of them, expected a whole image file")
    compression = first(COMPRESSION, 1)
    if compression in _FACSIMILE:
        needed = height // 8
    else:
        needed = width * height * samples * bits // 8 // _RATIOS.get(compression, 50_000)
    if size < needed:
        raise MapError(path, f"{cells}, for which {size} bytes are too few, expected a whole image file")


def nodata_of(tags: Tags, mode: str) -> int | None:
    """Return the value of pixels that GDAL marks as without data, as Pillow gives it in this mode, or None."""
    try:
        value = float(tags[GDAL_NODATA].split(b"\0")[0])
        number = int(value)
    except (KeyError, AttributeError, ValueError, OverflowError):
        return None
    if number != value:
        return None
    if mode in ("1", "L") and tags.get(PHOTOMETRIC) == (0,):
        # White is zero.
        return (1 if mode == "1" else 255) - number
    return number


def check_exif(path, image: Image.Image) -> None:
    """Raise MapError where a loaded image has more of EXIF than cameras write, because Pillow makes a number of two bytes."""
    size = max(len(image.info.get(key, b"")) for key in ("exif", "Raw profile type exif"))
    if size > MAX_EXIF:
        raise MapError(path, f"the EXIF data have {size} bytes, expected at most {MAX_EXIF}")


def check_jpeg(path, file: BinaryIO, width: int, height: int) -> None:
    """Raise MapError where a JPEG file is too short for its size or has too many scans."""
    size, cells, scans = os.fstat(file.fileno()).st_size, width * height, 0
    if cells > JPEG_CELLS_PER_BYTE * size:
        raise MapError(
            path, f"the image declares {width} x {height} cells, for which {size} bytes are too few, expected a whole one"
        )
    at, last = file.tell(), b""
    file.seek(0)
    while block := file.read(1 << 20):
        scans += (last + block).count(b"\xff\xda")
        last = b"\xff" if block.endswith(b"\xff") else b""
    file.seek(at)
    if scans * cells > MAX_SCANNED and scans > 1:
        raise MapError(
            path, f"the image has {width} x {height} cells in {scans} scans, expected a JPEG file that is not progressive"
        )


def check_png(path) -> None:
    """Raise MapError where the pixels of a PNG file end early, which its decoder takes as black."""
    with open(path, "rb") as file:
        file.seek(16)
        width, height, depth, colour, _, _, interlaced = _unpack(file, ">IIBBBBB")
        channels = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[colour]
        passes = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2)]
        needed = 0
        for x, y, dx, dy in passes if interlaced else [(0, 0, 1, 1)]:
            columns, rows = max(math.ceil((width - x) / dx), 0), max(math.ceil((height - y) / dy), 0)
            needed += rows * (1 + math.ceil(columns * depth * channels / 8)) if columns else 0
        stream = zlib.decompressobj()
        file.seek(8)
        while needed > 0:
            length, kind = struct.unpack(">I4s", file.read(8))
            if kind == b"IDAT":
                data = file.read(length)
                while needed > 0 and data:
                    needed -= len(stream.decompress(data, 1 << 20))
                    data = stream.unconsumed_tail
            elif kind == b"IEND":
                raise MapError(path, f"the pixels end {needed} bytes early, expected a whole image file")
            else:
                file.seek(length, 1)
            file.seek(4, 1)
