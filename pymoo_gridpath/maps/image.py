"""Maps drawn as images: dark is occupied, light is free."""

from __future__ import annotations

import bisect
import os
import re
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image, ImageFile, UnidentifiedImageError

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError, MapError, visible
from pymoo_gridpath.grid import CornerCutting, OccupancyGrid
from pymoo_gridpath.maps._declared import (
    PLACE,
    CountedReader,
    Tags,
    check_before,
    check_exif,
    check_jpeg,
    check_png,
    nodata_of,
    tags_of_tiff,
)
from pymoo_gridpath.maps._files import MAX_CELLS, blocks, check_size, check_unknown, make_grid, require_file, warn
from pymoo_gridpath.maps._ros_yaml import yaml_of_image
from pymoo_gridpath.maps.formats import MAP_FORMATS, MapFormat

# Raster formats only: Pillow would hand some others, such as EPS, to outside programs.
FORMATS = ("PNG", "PPM", "BMP", "GIF", "JPEG", "TIFF", "WEBP")
_MAGIC = re.compile(rb"\x89PNG|GIF8|\xff\xd8\xff|BM|II\*\0|MM\0\*|RIFF....WEBP|P[1-6]\s", re.DOTALL)
WITH_ALPHA = ("LA", "La", "PA", "RGBA", "RGBa")

_WHITE_16 = 2**16 - 1
# Thousandths of red, green and blue.
_LUMINANCE = np.array([299, 587, 114], dtype=np.uint32)

MAX_DECODED = 900_000_000
"""The largest number of bytes that an image may take while it is decoded."""

# EXIF's number for how an image is turned, and what turns it back.
ORIENTATION = 0x0112
TURNS: dict[int, Callable[[np.ndarray], np.ndarray]] = {
    2: lambda a: a[:, ::-1],
    3: lambda a: a[::-1, ::-1],
    4: lambda a: a[::-1],
    5: lambda a: a.swapaxes(0, 1),
    6: lambda a: a.swapaxes(0, 1)[:, ::-1],
    7: lambda a: a[::-1, ::-1].swapaxes(0, 1),
    8: lambda a: a.swapaxes(0, 1)[::-1],
}


@dataclass(frozen=True)
class Pixels:
    """The decoded pixels of an image, row 0 at the top.

    Parameters
    ----------
    channels : numpy.ndarray of unsigned int, shape (height, width) or (height, width, 3)
        Grey, or red, green and blue; 0 for black.
    white : int
        The value of white in each channel: 255, or 65535 for 16 bits.
    alpha : numpy.ndarray of unsigned int, shape (height, width), or None
        0 for transparent. None if every pixel is opaque.
    opaque : int
        The alpha of an opaque pixel.
    """

    channels: np.ndarray
    white: int
    alpha: np.ndarray | None = None
    opaque: int = 255

    def below(self, threshold: float, unseen: bool) -> np.ndarray:
        """Return where the mean of the channels, laid over white, is below a threshold; ``unseen`` where nothing is shown."""
        white = self.white if self.channels.ndim == 2 else 3 * self.white
        # In whole numbers, so that a grey value equal to the threshold stays equal.
        first, whole = _first_from(threshold, white), white * self.opaque
        most = whole - _first_from(threshold, whole)
        height, width = self.channels.shape[:2]
        below = np.empty((height, width), dtype=bool)
        for rows in blocks(height, width):
            shade = self.channels[rows]
            if shade.ndim == 3:
                # Three times as fast as `sum`, whose inner loop would be over three values.
                red, green, blue = np.moveaxis(shade, 2, 0)
                shade = red.astype(np.uint32) + green + blue
            if self.alpha is None:
                below[rows] = shade < first
            else:
                alpha = self.alpha[rows]
                below[rows] = alpha * (white - shade.astype(np.uint32)) > most
                below[rows][alpha == 0] = unseen
        return below

    def grey(self) -> np.ndarray:
        """Return the luminance of each pixel by Rec. 601, uint8, rounded as GraphicsMagick with 16 bits a value does."""
        if self.channels.dtype == np.uint8 and self.channels.ndim == 2:
            return self.channels
        to_16_bits = _WHITE_16 // self.white
        height, width = self.channels.shape[:2]
        grey = np.empty((height, width), np.uint8)
        for rows in blocks(height, width):
            values = self.channels[rows].astype(np.uint32)
            if values.ndim == 3:
                values = (values @ _LUMINANCE * to_16_bits + 500) // 1000
            else:
                values *= to_16_bits
            grey[rows] = values // 257
        return grey


def read_image(
    path: str | os.PathLike[str],
    threshold: float = 0.5,
    unknown: str = "free",
    corner_cutting: CornerCutting = False,
    resolution: float | None = None,
    origin: Sequence[float] = (0.0, 0.0, 0.0),
) -> OccupancyGrid:
    """Read a map from an image, one cell per pixel.

    The grey value of a pixel is the mean of its colour channels from 0 (black) to 1 (white). A pixel that is partly
    transparent is laid over white; one that is wholly transparent, or that the tag of GDAL in a TIFF calls nodata, shows
    nothing, and ``unknown`` says what it is.

    Parameters
    ----------
    path : str or path-like
        A PNG, PGM, PPM, PBM, BMP, GIF, JPEG, TIFF or WebP image; of several frames the first is read.
    threshold : float, default 0.5
        A pixel is occupied if its grey value is below this, and free from it on. From 0 to 1.
    unknown : {"free", "occupied"}, default "free"
        What wholly transparent pixels and those without data are. ``"free"`` is what a drawing on a transparent background
        means.
    corner_cutting : bool or "one side", default False
        Whether a diagonal step may touch an occupied cell.
    resolution : float, optional
        Side of a cell in metres; without it the map is one in cells.
    origin : (float, float) or (float, float, float), default (0, 0, 0)
        Pose of the grid in metres and radians, beside a resolution only.

    Returns
    -------
    OccupancyGrid
        The top row of the image is the highest row of the grid.

    Raises
    ------
    MapError
        If the file cannot be read as an image, has too many pixels, or an option is out of its range.

    Warns
    -----
    MapWarning
        If the YAML file of a ROS map lies beside the image and names it.
    """
    check_unknown(path, unknown)
    try:
        threshold = checks.number("the option threshold", threshold, 0.0, 1.0, expected="a number from 0 to 1")
    except GridPathError as error:
        raise MapError(path, str(error)) from None
    pixels = read_pixels(path)
    occupied = pixels.below(threshold, unknown == "occupied")
    unseen = np.zeros_like(occupied) if pixels.alpha is None else pixels.alpha == 0
    if (described := yaml_of_image(path)) is not None:
        warn(
            path,
            f"{visible(described.name)} beside it describes this image as a ROS map and was not read; read that file for its "
            "resolution, origin, thresholds and unknown cells",
        )
    return make_grid(
        path, occupied[::-1], corner_cutting=corner_cutting, resolution=resolution, origin=origin, unknown=unseen[::-1]
    )


@MAP_FORMATS.register
class ImageFormat(MapFormat):
    """Drawn maps, see `read_image`."""

    name = "image"
    suffixes = (".png", ".pgm", ".pbm", ".ppm", ".pnm", ".bmp", ".gif", ".jpg", ".jpeg", ".tif", ".tiff", ".webp")
    read = staticmethod(read_image)  # pyright: ignore[reportAssignmentType]

    def matches(self, head, path):
        # A raster that says where it lies is no mere drawing.
        return _MAGIC.match(head) is not None and tags_of_tiff(path).keys().isdisjoint(PLACE)


def read_pixels(path: str | os.PathLike[str], turn: bool = True) -> Pixels:
    """Decode an image; the one place that opens images.

    Values of more than 8 bits are taken as 16-bit ones. Colours of 16 bits a channel are read as 8-bit ones. Pixels that the
    tag of GDAL in a TIFF calls nodata are transparent.

    Parameters
    ----------
    path : str or path-like
    turn : bool, default True
        Whether an image whose EXIF orientation says that it is turned or mirrored is turned as it says, or else refused.

    Raises
    ------
    MapError
        If the file is not an image of one of `FORMATS`, is damaged or has too many pixels.
    """
    require_file(path)
    with warnings.catch_warnings():
        # Pillow warns of 89 million pixels, but `check_size` decides.
        warnings.simplefilter("ignore")
        try:
            with CountedReader(path) as file:
                tags = check_before(path, file)
                with Image.open(file, formats=FORMATS) as image:
                    check_size(path, *image.size)  # before decoding
                    _check_cost(path, file, image)
                    tiff = image.format == "TIFF"
                    turned = tiff and tags.get(ORIENTATION, (1,))[0] in TURNS
                    image.load()
                    check_exif(path, image)
                    # Pillow has turned a TIFF by now, and older ones still say that it is to be turned.
                    orientation = 1 if tiff else image.getexif().get(ORIENTATION, 1)
                    pixels = _decode(path, image, tags)
        except (MapError, MemoryError):
            raise
        except Image.DecompressionBombError:
            raise MapError(path, f"the image is too large, expected at most {MAX_CELLS} pixels") from None
        except UnidentifiedImageError:
            raise MapError(path, f"no image can be recognised, expected one of {', '.join(FORMATS)}") from None
        except Exception:
            # A damaged file can raise almost anything: OSError, SyntaxError, ValueError, struct.error, zlib.error ...
            raise MapError(path, "the image is damaged or cut short, expected a whole image file") from None
    turned |= orientation in TURNS
    if turned and not turn:
        raise MapError(
            path, "the image says that it is turned (EXIF orientation), which map servers ignore; expected one that is not"
        )
    return _turned(pixels, TURNS[orientation]) if orientation in TURNS else pixels


def _check_cost(path, file: CountedReader, image: ImageFile.ImageFile) -> None:
    """Raise MapError for an image that covers only a part of its size, or would take too much memory or time."""
    cells = image.width * image.height
    boxes = [tile[1] or (0, 0, *image.size) for tile in image.tile]
    covered = sum((right - left) * (lower - upper) for left, upper, right, lower in boxes)
    if boxes and covered < cells:
        raise MapError(path, f"the image has {covered} of {image.width} x {image.height} cells, expected all of them")
    size = {"1": 2, "L": 2, "P": 4, "I;16": 4}.get(image.mode, 8)
    if image.format == "JPEG":
        check_jpeg(path, file, *image.size)
        size += 2 * len(image.getbands()) if image.info.get("progressive") else 0
    elif image.format == "WEBP":
        size = 22
    elif image.format == "PNG" and size == 8 and str(image.tile[0][3]).endswith(";16B"):
        # Colours of 16 bits are made into others of 8, which takes its time.
        size += 8
    if size * cells > MAX_DECODED:
        raise MapError(
            path,
            f"the image takes {size * cells} bytes when it is decoded, expected at most {MAX_DECODED}; a grey PNG takes less",
        )


def _decode(path, image: Image.Image, tags: Tags) -> Pixels:
    """Return the pixels of a loaded image, a block of rows at a time, because an image is large in every form."""
    if image.mode.startswith("F"):
        kind = f"floating-point numbers (mode {image.mode})"
        raise MapError(path, f"the pixels are {kind}, expected whole numbers of 8 or 16 bits")
    wide = image.mode.startswith("I")
    key, nodata = image.info.get("transparency"), nodata_of(tags, image.mode)
    own_alpha = not wide and (image.mode in WITH_ALPHA or key is not None)
    grey = image.mode in ("1", "L") and not own_alpha
    shape = (image.height, image.width)
    channels = np.empty(shape if wide or grey else (*shape, 3), np.uint16 if wide else np.uint8)
    alpha = None
    if own_alpha or nodata is not None or (wide and isinstance(key, int)):
        alpha = np.full(shape, 255, np.uint8)
    low, high = 0, 0
    for rows in blocks(*shape):
        part = image.crop((0, rows.start, image.width, rows.stop))
        values = np.asarray(part) if wide or nodata is not None else np.empty(0)
        if own_alpha:
            if key is not None:
                part.info["transparency"] = key
            coloured = np.asarray(part if part.mode == "RGBA" else part.convert("RGBA"))
            channels[rows] = coloured[..., :3]
            alpha[rows] = coloured[..., 3]  # pyright: ignore[reportOptionalSubscript]
        elif wide:
            clear = np.isin(values, [value for value in (key, nodata) if isinstance(value, int)])
            known = values[~clear]
            low, high = int(known.min(initial=low)), int(known.max(initial=high))
            channels[rows] = np.where(clear, 0, values)
            if alpha is not None:
                alpha[rows][clear] = 0
        else:
            channels[rows] = np.asarray(part.convert("L" if grey else "RGB"))
        if nodata is not None and not wide:
            empty = values == nodata
            alpha[rows][empty.all(axis=2) if empty.ndim == 3 else empty] = 0  # pyright: ignore[reportOptionalSubscript]
    if low < 0 or high > _WHITE_16:
        raise MapError(path, f"the pixels range from {low} to {high}, expected whole numbers of 8 or 16 bits")
    # What a PNG file lacks ends up as zeros in the last row, or where it is interlaced in the last but one.
    last = np.asarray(image.crop((0, max(image.height - 2, 0), image.width, image.height)))
    if image.format == "PNG" and not all(row.any() for row in last):
        check_png(path)
    return Pixels(channels, _WHITE_16 if wide else 255, alpha)


def _turned(pixels: Pixels, turn: Callable[[np.ndarray], np.ndarray]) -> Pixels:
    alpha = None if pixels.alpha is None else turn(pixels.alpha)
    return Pixels(turn(pixels.channels), pixels.white, alpha, pixels.opaque)


def _first_from(threshold: float, white: int) -> int:
    """Return the first whole number whose quotient by ``white`` is not below a threshold."""
    return bisect.bisect_left(range(white + 1), True, key=lambda value: value / white >= threshold)
