"""Maps drawn as images: dark is occupied, light is free."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image, UnidentifiedImageError

from pymoo_gridpath.errors import MapError, visible
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.maps._files import check_size, check_unknown, make_grid, require_file, shorten, warn
from pymoo_gridpath.maps._ros_yaml import yaml_of_image

# Raster formats only: Pillow would hand some others, such as EPS, to outside programs.
FORMATS = ("PNG", "PPM", "BMP", "GIF", "JPEG", "TIFF", "WEBP")

_WHITE_16 = 2**16 - 1
_GDAL_NODATA = 42113
# Thousandths of red, green and blue.
_LUMINANCE = np.array([299, 587, 114], dtype=np.uint32)
# Pixels that are turned into grey together, which bounds the memory that it takes.
_BLOCK = 2**20


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

    def sums(self) -> tuple[np.ndarray, int]:
        """Return the sum of the channels of each pixel, and that of white: their quotient is the mean from 0 to 1."""
        if self.channels.ndim == 2:
            return self.channels, self.white
        return self.channels.sum(axis=2, dtype=np.uint16 if self.white == 255 else np.uint32), 3 * self.white

    def grey(self) -> np.ndarray:
        """Return the luminance of each pixel by Rec. 601, uint8, rounded as GraphicsMagick with 16 bits a value does."""
        to_16_bits = _WHITE_16 // self.white
        height, width = self.channels.shape[:2]
        grey = np.empty((height, width), np.uint8)
        n_rows = max(_BLOCK // width, 1)
        for k in range(0, height, n_rows):
            values = self.channels[k : k + n_rows].astype(np.uint32)
            if values.ndim == 3:
                values = (values @ _LUMINANCE * to_16_bits + 500) // 1000
            else:
                values *= to_16_bits
            grey[k : k + n_rows] = values // 257
        return grey


def read_image(
    path: str | os.PathLike[str],
    threshold: float = 0.5,
    unknown: str = "free",
    corner_cutting: bool = False,
    resolution: float = 1.0,
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
    corner_cutting : bool, default False
        Whether a diagonal step may touch an occupied cell.
    resolution : float, default 1.0
        Side of a cell in metres.
    origin : (float, float) or (float, float, float), default (0, 0, 0)
        Pose of the grid in metres and radians.

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
    if not _is_fraction(threshold):
        raise MapError(path, f"the option threshold is {shorten(threshold)}, expected a number from 0 to 1")
    pixels = read_pixels(path)
    shade, white = pixels.sums()
    if pixels.alpha is None:
        occupied = (_grey_levels(white) < threshold)[shade]
        unseen = np.zeros_like(occupied)
    else:
        # Over white, in whole numbers so that a grey value equal to the threshold stays equal.
        alpha = pixels.alpha.astype(np.uint32)
        over_white = shade * alpha + white * (pixels.opaque - alpha)
        occupied = over_white / (white * pixels.opaque) < threshold
        unseen = alpha == 0
        occupied[unseen] = unknown == "occupied"
    if (described := yaml_of_image(path)) is not None:
        warn(
            path,
            f"{visible(described.name)} beside it describes this image as a ROS map and was not read; read that file for its "
            "resolution, origin, thresholds and unknown cells",
        )
    return make_grid(
        path, occupied[::-1], corner_cutting=corner_cutting, resolution=resolution, origin=origin, unknown=unseen[::-1]
    )


def read_pixels(path: str | os.PathLike[str]) -> Pixels:
    """Decode an image; the one place that opens images.

    Values of more than 8 bits are taken as 16-bit ones. Colours of 16 bits a channel are read as 8-bit ones.

    Raises
    ------
    MapError
        If the file is not an image of one of `FORMATS`, is damaged or has too many pixels.
    """
    require_file(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        warnings.simplefilter("error", Image.DecompressionBombWarning)
        try:
            with Image.open(path, formats=FORMATS) as image:
                check_size(path, *image.size)  # before decoding
                return _decode(path, image)
        except (MapError, MemoryError):
            raise
        except (Image.DecompressionBombError, Image.DecompressionBombWarning):
            raise MapError(path, f"the image is too large, expected at most {Image.MAX_IMAGE_PIXELS} pixels") from None
        except UnidentifiedImageError:
            raise MapError(path, f"no image can be recognised, expected one of {', '.join(FORMATS)}") from None
        except Exception:
            # A damaged file can raise almost anything: OSError, SyntaxError, ValueError, struct.error, zlib.error ...
            raise MapError(path, "the image is damaged or cut short, expected a whole image file") from None


def _decode(path, image: Image.Image) -> Pixels:
    mode = image.mode
    if mode.startswith("F"):
        raise MapError(path, f"the pixels are floating-point numbers (mode {mode}), expected whole numbers of 8 or 16 bits")
    if mode.startswith("I"):
        return _decode_16_bit(path, image)
    if mode in ("LA", "La", "PA", "RGBA", "RGBa") or "transparency" in image.info:
        channels = np.asarray(image.convert("RGBA"))
        return Pixels(channels[..., :3], 255, channels[..., 3])
    alpha = _alpha_of_nodata(image)
    if mode in ("1", "L"):
        return Pixels(np.asarray(image.convert("L")), 255, alpha)
    return Pixels(np.asarray(image.convert("RGB")), 255, alpha)


def _decode_16_bit(path, image: Image.Image) -> Pixels:
    values, white = np.asarray(image), _WHITE_16
    low, high = int(values.min()), int(values.max())
    if low < 0 or high > white:
        raise MapError(path, f"the pixels range from {low} to {high}, expected whole numbers of 8 or 16 bits")
    key = image.info.get("transparency")
    alpha = np.where(values == key, 0, 255).astype(np.uint8) if isinstance(key, int) else _alpha_of_nodata(image)
    return Pixels(values.astype(np.uint16), white, alpha)


def _alpha_of_nodata(image: Image.Image) -> np.ndarray | None:
    """Return which pixels of a TIFF hold no data by GDAL's tag, as an alpha channel, or None if it has no such tag."""
    try:
        nodata = float(getattr(image, "tag_v2", {})[_GDAL_NODATA])
    except (KeyError, TypeError, ValueError):
        return None
    values = np.asarray(image)
    empty = values == nodata
    return np.where(empty.all(axis=2) if empty.ndim == 3 else empty, 0, 255).astype(np.uint8)


def _grey_levels(white: int) -> np.ndarray:
    return np.arange(white + 1) / white


def _is_fraction(value) -> bool:
    try:
        return 0 <= float(value) <= 1
    except (TypeError, ValueError):
        return False
