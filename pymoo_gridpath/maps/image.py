"""Maps drawn as images: dark is occupied, light is free."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image, UnidentifiedImageError

from pymoo_gridpath.errors import MapError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.maps._files import check_size, check_unknown, make_grid, require_file, shorten

# Raster formats only: Pillow would hand some others, such as EPS, to outside programs.
FORMATS = ("PNG", "PPM", "BMP", "GIF", "JPEG", "TIFF", "WEBP")


@dataclass(frozen=True)
class Pixels:
    """The decoded pixels of an image, row 0 at the top.

    Parameters
    ----------
    shade : numpy.ndarray of unsigned int, shape (height, width)
        Sum of the colour channels, 0 for black.
    white : int
        The shade of white, so that ``shade / white`` is the mean of the colour channels from 0 to 1.
    alpha : numpy.ndarray of unsigned int, shape (height, width), or None
        0 for transparent. None if every pixel is opaque.
    opaque : int
        The alpha of an opaque pixel.
    """

    shade: np.ndarray
    white: int
    alpha: np.ndarray | None = None
    opaque: int = 255


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
    transparent is laid over white; one that is wholly transparent shows nothing, and ``unknown`` says what it is.

    Parameters
    ----------
    path : str or path-like
        A PNG, PGM, PPM, PBM, BMP, GIF, JPEG, TIFF or WebP image; of several frames the first is read.
    threshold : float, default 0.5
        A pixel is occupied if its grey value is below this, and free from it on. From 0 to 1.
    unknown : {"free", "occupied"}, default "free"
        What wholly transparent pixels are. ``"free"`` is what a drawing on a transparent background means.
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
    """
    check_unknown(path, unknown)
    if not _is_fraction(threshold):
        raise MapError(path, f"the option threshold is {shorten(threshold)}, expected a number from 0 to 1")
    pixels = read_pixels(path)
    if pixels.alpha is None:
        occupied = _grey_levels(pixels.white)[pixels.shade] < threshold
    else:
        # Over white, in whole numbers so that a grey value equal to the threshold stays equal.
        alpha = pixels.alpha.astype(np.uint32)
        over_white = pixels.shade * alpha + pixels.white * (pixels.opaque - alpha)
        occupied = over_white / (pixels.white * pixels.opaque) < threshold
        occupied[alpha == 0] = unknown == "occupied"
    return make_grid(path, occupied[::-1], corner_cutting=corner_cutting, resolution=resolution, origin=origin)


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
        return Pixels(channels[..., :3].sum(axis=2, dtype=np.uint16), 3 * 255, channels[..., 3])
    if mode in ("1", "L"):
        return Pixels(np.asarray(image.convert("L")), 255)
    return Pixels(np.asarray(image.convert("RGB")).sum(axis=2, dtype=np.uint16), 3 * 255)


def _decode_16_bit(path, image: Image.Image) -> Pixels:
    values, white = np.asarray(image), 2**16 - 1
    low, high = int(values.min()), int(values.max())
    if low < 0 or high > white:
        raise MapError(path, f"the pixels range from {low} to {high}, expected whole numbers of 8 or 16 bits")
    key = image.info.get("transparency")
    alpha = np.where(values == key, 0, 255).astype(np.uint8) if isinstance(key, int) else None
    return Pixels(values.astype(np.uint16), white, alpha)


def _grey_levels(white: int) -> np.ndarray:
    return np.arange(white + 1) / white


def _is_fraction(value) -> bool:
    try:
        return 0 <= float(value) <= 1
    except (TypeError, ValueError):
        return False
