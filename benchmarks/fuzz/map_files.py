"""Valid maps of every format for the fuzzer, each with the cells that it was written from."""

from __future__ import annotations

import io
import struct
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from PIL import Image
from PIL.TiffImagePlugin import ImageFileDirectory_v2
from rosbags import rosbag1, rosbag2
from rosbags.typesys import Stores, get_typestore


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


def matrix(rng) -> Written:
    occupied = _cells(rng, 2)
    stream = io.BytesIO()
    np.savetxt(stream, occupied[::-1], fmt=str(rng.choice(["%d", "%.1f", "%e"])), delimiter=str(rng.choice([" ", ",", ";"])))
    return Written("matrix", {"m.txt": stream.getvalue()}, occupied)


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


def bag(rng) -> Written:
    """The same in a bag of ROS 1 or 2, beside an older one, written by another library."""
    occupied = _cells(rng)
    first = rng.random() < 0.5
    store = Stores.ROS1_NOETIC if first else Stores.ROS2_HUMBLE
    typestore, kind = get_typestore(store), "nav_msgs/msg/OccupancyGrid"
    types = typestore.types
    time = types["builtin_interfaces/msg/Time"](sec=3, nanosec=5)
    header = types["std_msgs/msg/Header"](stamp=time, frame_id="map", **({"seq": 7} if first else {}))
    turned = types["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=0.0, w=1.0)
    pose = types["geometry_msgs/msg/Pose"](types["geometry_msgs/msg/Point"](-1.5, 2.0, 0.0), turned)
    info = types["nav_msgs/msg/MapMetaData"](time, 0.05, occupied.shape[1], occupied.shape[0], pose)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / ("m.bag" if first else "m")
        writer = rosbag1.Writer(path) if first else rosbag2.Writer(path, version=9, storage_plugin=rosbag2.StoragePlugin.MCAP)
        with writer:
            connection = writer.add_connection("/map", kind, typestore=typestore)
            for k, cells in enumerate((~occupied, occupied)):
                message = types[kind](header, info, np.where(cells, 100, 0).astype(np.int8).ravel())
                raw = typestore.serialize_ros1(message, kind) if first else typestore.serialize_cdr(message, kind)
                writer.write(connection, k, raw)
        content = (path if first else path / "m.mcap").read_bytes()
    name = "bag" if first else "mcap"
    return Written(name, {f"m.{name}": content}, occupied, {"resolution": 0.05, "origin": (-1.5, 2.0, 0.0)})


def geotiff(rng) -> Written:
    """A raster of percents whose tags say where it lies, in metres of a zone of UTM."""
    occupied = _cells(rng)
    tags = ImageFileDirectory_v2()
    values = {
        33550: (12, (0.5, 0.5, 0.0)),
        33922: (12, (0.0, 0.0, 0.0, 1000.0, 2000.0, 0.0)),
        34735: (3, (1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 32632)),
    }
    for tag, (kind, value) in values.items():
        tags.tagtype[tag] = kind
        tags[tag] = value
    stream = io.BytesIO()
    compression = (None, "tiff_deflate", "tiff_lzw")[rng.integers(3)]
    Image.fromarray(np.where(occupied[::-1], 100, 0).astype(np.uint8)).save(
        stream, "TIFF", tiffinfo=tags, compression=compression
    )
    says = {"resolution": 0.5, "origin": (1000.0, 2000.0 - 0.5 * len(occupied), 0.0)}
    return Written("geotiff", {"m.tif": stream.getvalue()}, occupied, says)


FORMATS: dict[str, Callable[[np.random.Generator], Written]] = {
    "text": text,
    "matrix": matrix,
    "MovingAI": movingai,
    "scen": scen,
    "npy": npy,
    "yaml": yaml,
    "message": message,
    "bag": bag,
    "geotiff": geotiff,
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
