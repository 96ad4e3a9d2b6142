"""Valid maps of every format for the fuzzer, each with the cells that it was written from."""

from __future__ import annotations

import io
import struct
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from PIL import Image


@dataclass
class Written:
    """A map as files, the one to read first, the cells it says, and what else it says of the grid."""

    format: str
    files: dict[str, bytes]
    occupied: np.ndarray
    says: dict[str, object] = field(default_factory=dict)

    @property
    def main(self) -> bytes:
        return next(iter(self.files.values()))


def _cells(rng: np.random.Generator, least: int = 1) -> np.ndarray:
    height, width = rng.integers(least, 14, 2)
    return rng.random((height, width)) < rng.choice([0.0, 0.3, 1.0], p=[0.1, 0.8, 0.1])


def _letters(rng, occupied: np.ndarray, free: str, full: str) -> bytes:
    kinds = np.where(occupied, rng.choice(list(full), occupied.shape), rng.choice(list(free), occupied.shape))
    return b"".join("".join(row).encode() + b"\n" for row in kinds[::-1])


def text(rng) -> Written:
    occupied = _cells(rng)
    header, says = b"", {}
    if rng.random() < 0.7:
        header, says = b"name: yard\nresolution: 0.25\norigin: 1, -2 0.5\n\n", {"resolution": 0.25, "origin": (1.0, -2.0, 0.5)}
    return Written("text", {"m.txt": header + _letters(rng, occupied, ".0", "#@X1")}, occupied, says)


def movingai(rng) -> Written:
    occupied = _cells(rng)
    height, width = occupied.shape
    header = f"type octile\nheight {height}\nwidth {width}\nmap\n".encode()
    return Written("MovingAI", {"m.map": header + _letters(rng, occupied, ".GSgs", "@OTWotw")}, occupied)


def scen(rng) -> Written:
    lines = "".join(f"{k}\tm.map\t9\t9\t{rng.integers(9)}\t{rng.integers(9)}\t1\t2\t3.5\n" for k in range(rng.integers(1, 9)))
    return Written("scen", {"m.scen": b"version 1\n" + lines.encode()}, np.zeros((0, 0), bool))


def npy(rng) -> Written:
    occupied = _cells(rng)
    stream = io.BytesIO()
    array = occupied.astype(rng.choice(["?", "u1", "<i2", ">f4", "f8"]))
    np.save(stream, np.asfortranarray(array) if rng.random() < 0.3 else array)
    return Written("npy", {"m.npy": stream.getvalue()}, occupied)


def _image(format: str, suffix: str, modes: tuple[str, ...], **options) -> Callable[..., Written]:
    def write(rng) -> Written:
        occupied = _cells(rng)
        dark = np.where(occupied[::-1], 0, 255).astype(np.uint8)
        mode = str(rng.choice(modes))
        picture = Image.fromarray(dark.astype(np.uint16) * 257) if mode == "I;16" else Image.fromarray(dark).convert(mode)
        stream = io.BytesIO()
        picture.save(stream, format, **options)
        return Written(f"{suffix} {mode}", {f"m.{suffix}": stream.getvalue()}, occupied)

    return write


def turned(rng) -> Written:
    occupied = _cells(rng)
    seen = np.where(occupied[::-1], 0, 255).astype(np.uint8)
    orientation = int(rng.integers(1, 9))
    # How the pixels lie so that the orientation turns them into what is seen.
    back = {6: 90, 3: 180, 8: 270}
    picture = Image.fromarray(seen)
    if orientation in (2, 4, 5, 7):
        flips = {2: Image.Transpose.FLIP_LEFT_RIGHT, 4: Image.Transpose.FLIP_TOP_BOTTOM}
        flips |= {5: Image.Transpose.TRANSPOSE, 7: Image.Transpose.TRANSVERSE}
        picture = picture.transpose(flips[orientation])
    elif orientation in back:
        picture = picture.rotate(back[orientation], expand=True)
    exif = Image.Exif()
    exif[0x0112] = orientation
    stream = io.BytesIO()
    format = ("PNG", "TIFF")[rng.integers(2)]
    picture.save(stream, format, exif=exif)
    return Written("EXIF", {"m.png" if format == "PNG" else "m.tif": stream.getvalue()}, occupied)


def nodata(rng) -> Written:
    """A TIFF whose tag of GDAL says that 7 is no data; an image's unknown cells are free."""
    occupied = _cells(rng)
    values = np.where(occupied[::-1], 0, rng.choice([7, 255], occupied.shape)).astype(np.uint8)
    stream = io.BytesIO()
    compression = (None, "tiff_deflate", "tiff_lzw", "packbits")[rng.integers(4)]
    Image.fromarray(values).save(stream, "TIFF", tiffinfo={42113: "7"}, compression=compression)
    return Written("GDAL", {"m.tif": stream.getvalue()}, occupied)


def yaml(rng) -> Written:
    occupied = _cells(rng)
    height, width = occupied.shape
    pixels = np.where(occupied[::-1], 0, 254).astype(np.uint8).tobytes()
    lines = [
        "image: m.pgm",
        "resolution: 0.05",
        "origin: [-1.5, 2, 0]",
        "negate: 0",
        "occupied_thresh: 0.65",
        "free_thresh: 0.196",
    ]
    content = ("\n".join(rng.permutation(lines)) + "\n").encode()
    files = {"m.yaml": content, "m.pgm": b"P5\n%d %d\n255\n" % (width, height) + pixels}
    return Written("YAML", files, occupied, {"resolution": 0.05, "origin": (-1.5, 2.0, 0.0)})


def message(rng) -> Written:
    """A message nav_msgs/OccupancyGrid, its list in one line or one a line, as rostopic and ros2 topic print it."""
    occupied = _cells(rng)
    height, width = occupied.shape
    values = np.where(occupied, rng.choice([-1, 65, 100], occupied.shape), rng.choice([0, 25], occupied.shape)).ravel().tolist()
    data = f"data: {values}\n" if rng.random() < 0.5 else "data:\n" + "".join(f"- {value}\n" for value in values)
    content = (
        f"header:\n  frame_id: map\ninfo:\n  resolution: 0.05000000074505806\n  width: {width}\n  height: {height}\n"
        "  origin:\n    position: {x: -1.5, y: 2.0, z: 0.0}\n    orientation: {x: 0.0, y: 0.0, z: 0.0, w: 1.0}\n"
    )
    return Written("message", {"m.yaml": (content + data).encode()}, occupied, {"resolution": 0.05, "origin": (-1.5, 2.0, 0.0)})


FORMATS: dict[str, Callable[[np.random.Generator], Written]] = {
    "text": text,
    "MovingAI": movingai,
    "scen": scen,
    "npy": npy,
    "yaml": yaml,
    "message": message,
    "png": _image("PNG", "png", ("1", "L", "LA", "RGB", "RGBA", "P", "I;16")),
    "gif": _image("GIF", "gif", ("L", "P", "1")),
    "bmp": _image("BMP", "bmp", ("1", "L", "RGB")),
    "pnm": _image("PPM", "pnm", ("1", "L", "RGB")),
    "webp": _image("WEBP", "webp", ("RGB", "RGBA"), lossless=True),
    "tiff": _image("TIFF", "tif", ("1", "L", "RGB", "RGBA", "I;16")),
    "deflated tiff": _image("TIFF", "tif", ("L", "RGB"), compression="tiff_adobe_deflate"),
    "fax tiff": _image("TIFF", "tif", ("1",), compression="group4"),
    "EXIF": turned,
    "GDAL": nodata,
}


def chunks(png: bytes) -> list[tuple[bytes, bytes]]:
    """Return the chunks of a PNG file as pairs of their kind and their data."""
    found, at = [], 8
    while at + 8 <= len(png):
        length, kind = struct.unpack_from(">I4s", png, at)
        found.append((kind, png[at + 8 : at + 8 + length]))
        at += 12 + length
    return found
